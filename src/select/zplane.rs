//! Selection by a plane at a distance (Zhang 1998, 7.3.1): everything wholly or partly on its near side.
//!
//! Inexpensive, but it does not bound the triangles selected; the thesis says so, and so do we.

use glam::Vec3;

use crate::geometry::Aabb;

/// Chooses the candidates whose boxes reach nearer than `distance` along `forward` (a unit vector) from `eye`, in the candidates' order.
pub fn select_by_z_plane(
    candidates: impl Iterator<Item = u32>,
    bounds: &[Aabb],
    eye: Vec3,
    forward: Vec3,
    distance: f32,
    chosen: &mut Vec<u32>,
) {
    chosen.clear();
    chosen.extend(candidates.filter(|&id| {
        let b = bounds[id as usize];
        let nearest = Vec3::select(forward.cmpge(Vec3::ZERO), b.min, b.max);
        (nearest - eye).dot(forward) < distance
    }));
}
