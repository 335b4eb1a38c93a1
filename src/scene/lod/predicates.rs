//! Exact questions about points, segments and triangles.
//!
//! Signs come from Shewchuk's adaptive predicates (crate `robust`): exact for any f32 coordinates, which are f64
//! without rounding, and whose triple products neither overflow nor underflow there. Every answer that could let a
//! triangle out of a solid is one-sided: *disjoint* is said only if proven, and touching is not disjoint.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// A triangle's corners.
pub(super) type Corners = [DVec3; 3];

/// On which side of the plane through `a`, `b`, `c` the point `p` lies: 1 where they are seen counter-clockwise, -1
/// behind, 0 on it.
pub(super) fn side([a, b, c]: Corners, p: DVec3) -> i32 {
    let coordinates = |v: DVec3| Coord3D { x: v.x, y: v.y, z: v.z };
    let below = orient3d(coordinates(a), coordinates(b), coordinates(c), coordinates(p));
    i32::from(below < 0.0) - i32::from(below > 0.0)
}

/// Which way a triangle turns, seen along an axis from its positive end: 1 counter-clockwise, -1 clockwise, 0 for a
/// line.
pub(super) fn turn(a: DVec3, b: DVec3, c: DVec3, axis: usize) -> i32 {
    let flat = |v: DVec3| Coord { x: v[(axis + 1) % 3], y: v[(axis + 2) % 3] };
    let turn = orient2d(flat(a), flat(b), flat(c));
    i32::from(turn > 0.0) - i32::from(turn < 0.0)
}

/// How the line through `p` and `q` passes the three edges of a triangle: all of one sign, it goes through the inside;
/// two opposite signs, it misses.
pub(super) fn passes([a, b, c]: Corners, p: DVec3, q: DVec3) -> [i32; 3] {
    [side([p, q, a], b), side([p, q, b], c), side([p, q, c], a)]
}

/// Whether two closed triangles are proven to have no point in common.
///
/// Where two triangles meet and are not coplanar they meet in a segment, whose ends lie on edges of one in the other:
/// so it is enough that no edge of either meets the other. Coplanar ones, and edges in the plane of the other, give
/// zeros only, which is *not proven*.
pub(super) fn disjoint(s: &Corners, t: &Corners) -> bool {
    let of_s = t.map(|p| side(*s, p));
    if one_sided(of_s) {
        return true;
    }
    let of_t = s.map(|p| side(*t, p));
    if one_sided(of_t) {
        return true;
    }
    (0..3).all(|i| {
        let j = (i + 1) % 3;
        edge_misses(s, (t[i], of_s[i]), (t[j], of_s[j])) && edge_misses(t, (s[i], of_t[i]), (s[j], of_t[j]))
    })
}

fn one_sided(sides: [i32; 3]) -> bool {
    sides == [1; 3] || sides == [-1; 3]
}

/// Whether a segment, its ends with their sides, is proven to miss a closed triangle.
fn edge_misses(triangle: &Corners, (p, p_side): (DVec3, i32), (q, q_side): (DVec3, i32)) -> bool {
    if p_side * q_side > 0 {
        return true;
    }
    let passes = passes(*triangle, p, q);
    passes.contains(&1) && passes.contains(&-1)
}
