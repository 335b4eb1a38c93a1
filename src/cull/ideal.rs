//! The ideal (Zhang 1998, 8.3.1): draws exactly the objects that the item buffer shows. Its set is computed beforehand
//! and not timed, so its frame is the draw alone: what no method can beat.

use super::VisibleSet;
use super::vfc::World;

/// The visible objects of an exact item buffer, in the order of `in_frustum` (nearest first).
pub fn cull(world: &World<'_>, in_frustum: &[u32], visible_samples: &[u32]) -> VisibleSet {
    let objects: Vec<u32> = in_frustum.iter().copied().filter(|&o| visible_samples[o as usize] > 0).collect();
    VisibleSet {
        objects,
        in_frustum: in_frustum.len() as u32,
        triangles_in_frustum: world.triangles(in_frustum),
        ..VisibleSet::default()
    }
}
