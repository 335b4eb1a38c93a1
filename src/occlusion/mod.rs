//! The occlusion representation: what occluders cover, and how deep.
//!
//! Coverage is one bit a sample; the opacity of an 8x8 block is a population count, and averaging blocks gives the
//! hierarchical occlusion maps ([`Pyramid`], Zhang 1998, chapter 4). Depth is kept beside it, apart: an object is
//! occluded when its rectangle is covered (overlap test) and it lies behind what covers it (depth test).
//! [`OcclusionBuffer`] is the face of it, all that an engine needs.

mod boxes;
mod buffer;
mod clip_box;
mod inspect;
mod map;
mod overlap;
mod progressive;
mod project;
mod pyramid;
mod query;
mod submit;
mod test;
mod verdict;

#[cfg(feature = "bvh")]
pub(crate) use boxes::{BoxGroup, NEAR};
pub use boxes::{BoxSet, ProjectedBox, ProjectedBoxes};
pub use buffer::{Occluder, Occluders, OcclusionBuffer, OcclusionSettings};
pub(crate) use map::take;
pub use overlap::Thresholds;
#[cfg(feature = "bvh")]
pub(crate) use progressive::OccluderSinkRef;
pub(crate) use progressive::PlacedRows;
pub use progressive::{ProgressiveJob, ProgressiveResult};
#[cfg(feature = "bvh")]
pub(crate) use project::{ALL_PLANES, BoxView, Edges, planes_left, project_lanes};
pub use pyramid::{Level as PyramidLevel, Pyramid};
pub use query::DepthReading;
pub use submit::BandJob;
#[cfg(feature = "bvh")]
pub(crate) use test::{AtOnce, test_box};
pub use verdict::{Hidden, Verdict, Visible};
