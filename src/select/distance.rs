//! Distance-based selection (Zhang 1998, 7.3.2): the nearest objects, until their triangles would exceed a limit.

use glam::Vec3;

use crate::geometry::Aabb;

/// Triangles of the selected occluders, at most.
pub const DEFAULT_TRIANGLES: u64 = 25_000;

/// How far away a box is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// Distance to the centre of the box, the thesis's own.
    #[default]
    Center,
    /// Distance to its nearest point: mends the thesis's failure with large polygons, whose boxes have their centres far away.
    Nearest,
}

/// Chooses among candidates (object ids with opaque triangles in the frustum): the nearest first, ties by id. Stops before
/// the limit would be passed; the first is always taken. `bounds` are the objects' boxes about an origin, `eye` is about the same.
pub fn select_by_distance(
    candidates: impl Iterator<Item = u32>,
    bounds: &[Aabb],
    eye: Vec3,
    measure: Measure,
    triangles: impl Fn(u32) -> u64,
    limit: u64,
    chosen: &mut Vec<u32>,
) {
    let distance = |id: u32| {
        let b = bounds[id as usize];
        match measure {
            Measure::Center => (b.center() - eye).length_squared(),
            Measure::Nearest => b.distance_squared(eye),
        }
    };
    // Squared distances are not negative: their bits sort as they do.
    let mut keys: Vec<(u32, u32)> = candidates.map(|id| (distance(id).to_bits(), id)).collect();
    chosen.clear();
    let mut total = 0;
    // Few are taken of many: the nearest part is sorted alone, and grows while the limit allows more.
    let (mut sorted, mut part) = (0, 256);
    while sorted < keys.len() {
        let rest = &mut keys[sorted..];
        let n = part.min(rest.len());
        if n < rest.len() {
            rest.select_nth_unstable(n - 1);
        }
        rest[..n].sort_unstable();
        for &(_, id) in &rest[..n] {
            total += triangles(id);
            if total > limit && !chosen.is_empty() {
                return;
            }
            chosen.push(id);
        }
        (sorted, part) = (sorted + n, part * 2);
    }
}
