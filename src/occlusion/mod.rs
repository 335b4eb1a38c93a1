//! The occlusion representation: what occluders cover, and how deep.
//!
//! Coverage is one bit a sample; the opacity of an 8x8 block is a population count, and averaging blocks gives the
//! hierarchical occlusion maps ([`Pyramid`], Zhang 1998, chapter 4). Depth is kept beside it, apart: an object is
//! occluded when its rectangle is covered (overlap test) and it lies behind what covers it (depth test).
//! [`OcclusionBuffer`] is the face of it, all that an engine needs.

mod assess;
mod boxes;
mod buffer;
mod clip_box;
mod contrast;
mod depth;
mod depth_estimation;
mod depth_plane;
mod far_rectangle;
mod inspect;
mod layers;
mod map;
mod overlap;
mod progressive;
mod project;
mod pyramid;
mod pyramid_build;
mod query;
mod submit;
mod test;
mod thresholds;
mod verdict;

pub use assess::Assessment;
#[cfg(feature = "bvh")]
pub(crate) use boxes::{BoxGroup, CUT, NEAR};
pub use boxes::{BoxSet, ProjectedBox, ProjectedBoxes};
pub use buffer::{Occluder, Occluders, OcclusionBuffer, OcclusionSettings};
pub use contrast::relative_luminance;
pub use depth::DepthRepresentation;
pub use depth_estimation::{DepthEstimationBuffer, Partitions};
pub use layers::optical_depth;
#[cfg(feature = "bvh")]
pub(crate) use map::{MapView, OccluderSink};
pub(crate) use map::{SampleDepths, take};
pub use overlap::{ActiveLevels, OverlapStatistics};
pub(crate) use progressive::PlacedRows;
pub use progressive::{ProgressiveJob, ProgressiveResult};
#[cfg(feature = "bvh")]
pub(crate) use project::{ALL_PLANES, BoxView, Edges, Project, ROUNDING, planes_left, project_lanes};
pub use pyramid::{Pyramid, PyramidShape};
pub use query::DepthReading;
pub use submit::BandJob;
#[cfg(feature = "bvh")]
pub(crate) use test::{AtOnce, test_box};
pub use thresholds::{
    DEFAULT_DISTRIBUTION, Thresholds, next_opacity_threshold, opacity_threshold, raised_by_contrast,
    transparency_threshold,
};
pub use verdict::{Hidden, Verdict, Visible};
