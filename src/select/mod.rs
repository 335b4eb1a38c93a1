//! Occluder selection (Zhang 1998, chapter 7): what may occlude at all, and what does so in a view.

mod baked;
mod database;
mod order;
mod prisms;
mod redundancy;
mod stand_ins;
mod statics;
mod temporal;
mod view_grid;

pub(crate) use baked::{BACK_SIDES, ENCLOSED, HEADER, checksum, write_bake};
pub use baked::{BakeHeader, BakedVisibility, Sight};
pub use database::{OccluderDatabase, WalkMemory};
pub use order::{DEFAULT_TRIANGLES, Measure, Order};
pub use prisms::Prisms;
pub use stand_ins::{DEFAULT_OCCLUDER_LOD, DEFAULT_SHARE, OccluderGeometry, StandIns};
pub use statics::{Criterion, StaticCriteria, StaticSelection};
pub use temporal::{Occluded, temporal_candidates};
pub use view_grid::{MAX_CELLS, ViewGrid};
