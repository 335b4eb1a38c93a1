//! Tests of a batch of boxes, as drivers need them: a flag each, and statistics where the pyramid is walked.

use std::ops::Range;

use crate::error::Result;
use crate::occlusion::{OcclusionBuffer, OverlapStatistics, ProjectedBoxes};
use crate::scene::PreparedScene;

/// Tests boxes of a scene's objects and says which are hidden; counts those that walked the pyramid.
pub(super) fn test_batch(
    buffer: &OcclusionBuffer,
    scene: &PreparedScene,
    boxes: &ProjectedBoxes,
    batch: Range<usize>,
    hidden: &mut Vec<bool>,
    statistics: &mut OverlapStatistics,
) -> Result<()> {
    let PreparedScene { bounds, occluders, origin, .. } = scene;
    if buffer.walks_pyramid() {
        buffer.test_projected_counted(boxes, batch, bounds, *origin, occluders, hidden, statistics)
    } else {
        buffer.test_projected(boxes, batch, bounds, *origin, hidden)
    }
}
