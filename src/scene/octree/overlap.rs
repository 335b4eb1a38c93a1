//! Whether a triangle touches a box, by separating axes (Akenine-Moeller 2001), in f64.
//!
//! Invariant: never false when they share a point. What rounding may hide is given away: an axis separates only beyond a
//! tolerance some hundred times the rounding of its sums. Where a triangle has no area, its plane separates nothing.

use glam::DVec3;

/// Hundreds of rounding steps of f64, relative to the greatest coordinate about the box's middle.
const TOLERANCE: f64 = 1e-13;

/// Whether a triangle and a closed box share a point, or may.
pub(super) fn touches(triangle: &[DVec3; 3], middle: DVec3, half: DVec3) -> bool {
    let v = triangle.map(|p| p - middle);
    let (low, high) = (v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2]));
    // Coordinates were rounded about the origin, not about the box.
    let scale = low.abs().max(high.abs()).max(half).max_element();
    let slack = TOLERANCE * (scale + middle.abs().max_element());
    let half = half + DVec3::splat(slack);
    if low.cmpgt(half).any() || high.cmplt(-half).any() {
        return false;
    }
    let edges = [v[1] - v[0], v[2] - v[1], v[0] - v[2]];
    let normal = edges[0].cross(edges[1]);
    let reach = normal.abs().dot(half) + TOLERANCE * scale * scale * scale;
    if normal.dot(v[0]).abs() > reach {
        return false;
    }
    let tolerance = TOLERANCE * scale * scale;
    !edges
        .iter()
        .any(|&edge| [DVec3::X, DVec3::Y, DVec3::Z].iter().any(|&a| separates(edge.cross(a), &v, half, tolerance)))
}

fn separates(axis: DVec3, v: &[DVec3; 3], half: DVec3, tolerance: f64) -> bool {
    let at = v.map(|p| axis.dot(p));
    let reach = axis.abs().dot(half) + tolerance;
    at[0].min(at[1]).min(at[2]) > reach || at[0].max(at[1]).max(at[2]) < -reach
}
