//! The final draw on the CPU, and the exact item buffer.
//!
//! It is order-independent: each sample keeps the nearest triangle, of equals the one with the lower object id, then the
//! lower number (SEMANTICS, *Depth, ties*). Triangles are numbered object by object, so one number is both; what a sample
//! shows, and the exact visible set, are read off it. One light, flat normals, a colour an object.

mod canvas;
mod sink;

pub use canvas::{BACKGROUND, Canvas, DrawJob};
#[cfg(feature = "bvh")]
pub(crate) use canvas::{BandDraw, clear, shade};
#[cfg(feature = "bvh")]
pub(crate) use sink::DrawSink;
