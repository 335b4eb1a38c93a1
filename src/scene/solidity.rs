//! How much of a box the triangles in it cover, looked at along each axis: the solidity of prioritized-layered projection
//! (Klosowski and Silva 2000 estimate it by the number of primitives; here it is the covered share of the box's face).
//!
//! A face is looked at through 8x8 points, one word: triangles that overlap on the face count once, and the two sides of a
//! solid as one. Cost: about ten operations a triangle and axis, and as many for each point under it.

use glam::{DVec3, Vec3};

use crate::geometry::Aabb;

/// Points along a side of a face.
const SIDE: usize = 8;

/// Coverage of one box, gathered triangle by triangle.
pub(crate) struct BoxCoverage {
    min: DVec3,
    /// Points a unit along each axis; 0 where the box is flat.
    scale: DVec3,
    covered: [u64; 3],
}

impl BoxCoverage {
    pub fn new(bounds: Aabb) -> BoxCoverage {
        let (min, size) = (bounds.min.as_dvec3(), bounds.max.as_dvec3() - bounds.min.as_dvec3());
        let scale = DVec3::from_array([0, 1, 2].map(|a| if size[a] > 0.0 { SIDE as f64 / size[a] } else { 0.0 }));
        BoxCoverage { min, scale, covered: [0; 3] }
    }

    /// Adds a triangle about the same origin as the box.
    pub fn add(&mut self, triangle: &[DVec3; 3]) {
        let p = triangle.map(|p| (p - self.min) * self.scale);
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            if self.covered[axis] != !0 && self.scale[u] > 0.0 && self.scale[v] > 0.0 {
                self.covered[axis] |= points_under(p.map(|p| [p[u], p[v], p[axis]]));
            }
        }
    }

    /// Covered shares along each axis, 0 to 1.
    pub fn shares(&self) -> [f32; 3] {
        self.covered.map(|word| word.count_ones() as f32 / (SIDE * SIDE) as f32)
    }
}

/// The points of a face that a triangle covers inside the box; corners are in points, the depth last.
fn points_under(t: [[f64; 3]; 3]) -> u64 {
    let range = |c: usize| {
        let (low, high) = (t[0][c].min(t[1][c]).min(t[2][c]), t[0][c].max(t[1][c]).max(t[2][c]));
        let first = (low - 0.5).ceil().clamp(0.0, SIDE as f64) as usize;
        let end = ((high - 0.5).floor() + 1.0).clamp(0.0, SIDE as f64) as usize;
        first..end
    };
    let (columns, rows) = (range(0), range(1));
    let edge = |a: [f64; 3], b: [f64; 3], x: f64, y: f64| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    let area = edge(t[0], t[1], t[2][0], t[2][1]);
    if columns.is_empty() || rows.is_empty() || area == 0.0 {
        return 0;
    }
    let mut word = 0;
    for row in rows {
        for column in columns.clone() {
            let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
            let weights = [edge(t[1], t[2], x, y), edge(t[2], t[0], x, y), edge(t[0], t[1], x, y)].map(|e| e / area);
            let depth: f64 = (0..3).map(|i| weights[i] * t[i][2]).sum();
            let inside = weights.iter().all(|&w| w >= 0.0) && (-1e-6..=SIDE as f64 + 1e-6).contains(&depth);
            word |= u64::from(inside) << (row * SIDE + column);
        }
    }
    word
}

/// A box's share along a direction, which need not be a unit vector: faces count by the square of its cosines.
pub(crate) fn share_along(shares: &[f32; 3], direction: Vec3) -> f32 {
    let square = direction * direction;
    let sum = square.x + square.y + square.z;
    if sum > 0.0 { square.dot(Vec3::from_array(*shares)) / sum } else { 0.0 }
}
