//! One tiled rasterizer; what a covered block does is a *sink*.
//!
//! A frame's way: positions and indices are prepared once into clusters ([`PreparedMeshes`]); an object's clusters are
//! transformed vertex by vertex (`transform`), its triangles sorted out sixteen at a time (`triangle`): facing, those
//! that hit no sample, those to be clipped (`clip`). What is left goes through one of two kernels, for small triangles
//! (`small`) and for all others (`large`, `convex`); both take the depth from one function (`plane`) and hand 8x8 blocks of
//! samples, as 64-bit words, to the sink.
//!
//! Coverage is the exact integer evaluation at vertices snapped to 1/256 sample, with the top-left rule. Screens are cut into
//! 32x32 tiles of 4x4 blocks, stored tile by tile ([`Grid`]); threads get bands of tile rows, and no state is shared.

mod clip;
mod convex;
mod each;
mod engine;
mod facing;
mod grid;
mod large;
mod medium;
mod mesh;
mod plane;
mod queue;
mod sink;
mod small;
mod transform;
mod triangle;

pub(crate) use each::each;
pub(crate) use engine::{Engine, prefetch_mesh};
pub use engine::{Placement, RasterCounts};
pub use facing::Facing;
pub(crate) use grid::Band;
pub use grid::{BLOCK, Grid, TILE, TILE_BLOCKS};
pub use mesh::{MAX_CLUSTER_TRIANGLES, MAX_CLUSTER_VERTICES, MeshId, PreparedMeshes};
pub(crate) use queue::Queues;
pub(crate) use sink::{Sink, Surface, range_mask, tile_lanes};
pub use transform::ObjectRows;
pub(crate) use transform::lanes;
