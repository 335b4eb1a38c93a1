//! Axis-aligned boxes and screen rectangles.

mod aabb;
mod rect;

pub use aabb::Aabb;
pub use rect::SampleRect;
