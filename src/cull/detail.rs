//! Detail culling, or screen-size culling (Moeller; Russin's lecture, *Detail culling*): while the view moves, what covers
//! next to nothing of the screen is left out.
//!
//! A filter over projected boxes. What it drops may have been seen: it is approximate, and its error is to be measured. It
//! is off when the view stands still, that is, when it equals the view before to the bit; so a picture at rest is whole.
//! The area is that of the box's rectangle in samples, which is never smaller than that of the box or of what is in it. A box that
//! touches the near plane, or that reaches out of the viewport, is kept: how large it is cannot be told from the part
//! within. No state, no allocation, a product a box.

use homcull_simd::Level;

use super::VisibleSet;
use super::vfc::{VfcMemory, World};
use crate::occlusion::{CUT, NEAR, ProjectedBox, ProjectedBoxes};
use crate::view::View;

/// Samples of projected area below which an object is dropped, unless told otherwise: a square of two samples a side.
pub const DEFAULT_DETAIL_PIXELS: u32 = 4;

/// Whether the view is the one before, so that nothing is dropped. Without one before it, a view is taken to move.
pub fn stands_still(view: &View, before: Option<&View>) -> bool {
    before == Some(view)
}

/// Whether a box, of an object or of a node of the hierarchy, has a projected area of fewer than `pixels` samples, and all that
/// is in it with it. No box is below 0 samples; a box without a sample is below 1.
pub fn is_detail(b: &ProjectedBox, pixels: u32) -> bool {
    if b.tag & (NEAR | CUT) != 0 {
        return false;
    }
    let rect = b.rect();
    let side = |low: i32, high: i32| i64::from(high) - i64::from(low) + 1;
    let area = if rect.is_empty() { 0 } else { side(rect.x0, rect.x1) * side(rect.y0, rect.y1) };
    area < i64::from(pixels)
}

/// Drops the boxes that are detail, unless the view stands still; gives the others in their order, and how many were dropped.
/// The boxes are those of this view, projected: what only has a distance is kept.
pub fn cull(boxes: ProjectedBoxes, pixels: u32, view: &View, before: Option<&View>) -> (ProjectedBoxes, u32) {
    let mut boxes = boxes;
    if stands_still(view, before) {
        return (boxes, 0);
    }
    let mut kept = 0;
    for i in 0..boxes.boxes.len() {
        if !is_detail(&boxes.boxes[i], pixels) {
            boxes.boxes.swap(kept, i);
            boxes.distances.swap(kept, i);
            kept += 1;
        }
    }
    let dropped = boxes.boxes.len() - kept;
    boxes.boxes.truncate(kept);
    boxes.distances.truncate(kept);
    (boxes, dropped as u32)
}

/// What a walk keeps for detail culling.
#[derive(Default)]
pub struct DetailMemory {
    vfc: VfcMemory,
    /// The view of the frame before.
    pub before: Option<View>,
}

/// What is in the frustum and no detail, nearest first: the method by itself, or a first stage.
pub fn keep(world: &World<'_>, level: Level, view: &View, pixels: u32, memory: &mut DetailMemory) -> VisibleSet {
    let DetailMemory { vfc, before } = memory;
    world.collect(level, view, true, &mut vfc.stack, &mut vfc.boxes);
    let all = world.all_of(&vfc.boxes);
    let (boxes, _) = cull(std::mem::take(&mut vfc.boxes), pixels, view, before.as_ref());
    let kept = world.all_of(&boxes);
    (vfc.boxes, *before) = (boxes, Some(*view));
    VisibleSet { in_frustum: all.in_frustum, triangles_in_frustum: all.triangles_in_frustum, ..kept }
}
