//! homcull answers *what can this viewer see?* on the CPU alone.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "bvh")]
pub mod cull;
pub mod draw;
pub mod error;
pub mod geometry;
pub mod hash;
pub mod measure;
pub mod occlusion;
pub mod raster;
pub mod scene;
#[cfg(feature = "bvh")]
pub mod select;
pub mod view;
pub mod workers;

pub use error::{Error, Result};
