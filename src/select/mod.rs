//! Occluder selection (Zhang 1998, chapter 7): what may occlude at all, and what does so in a view.

mod baked;
mod database;
mod distance;
mod redundancy;
mod stand_ins;
mod statics;
mod temporal;
mod view_grid;
mod zplane;

pub(crate) use baked::{BACK_SIDES, ENCLOSED, HEADER, checksum, write_bake};
pub use baked::{BakeHeader, BakedVisibility, Sight};
pub use database::{OccluderDatabase, Order, WalkMemory};
pub use distance::{DEFAULT_TRIANGLES, Measure, select_by_distance};
pub use stand_ins::{DEFAULT_OCCLUDER_LOD, DEFAULT_SHARE, OccluderGeometry, StandIns};
pub use statics::{Criterion, StaticCriteria, StaticSelection};
pub use temporal::{Occluded, temporal_candidates};
pub use view_grid::{MAX_CELLS, ViewGrid};
pub use zplane::select_by_z_plane;
