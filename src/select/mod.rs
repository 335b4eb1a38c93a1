//! Occluder selection at run time (Zhang 1998, 7.3, 7.4).

mod distance;
mod temporal;
mod zplane;

pub use distance::{DEFAULT_TRIANGLES, Measure, select_by_distance};
pub use temporal::{Occluded, temporal_candidates};
pub use zplane::select_by_z_plane;
