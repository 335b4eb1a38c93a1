//! Occluder selection at run time (Zhang 1998, 7.3).

mod distance;
mod zplane;

pub use distance::{DEFAULT_TRIANGLES, Measure, select_by_distance};
pub use zplane::select_by_z_plane;
