//! The planes along which a scene may be parted: those of its largest opaque axis-aligned faces, and how much of them is covered where.
//!
//! The planes cut the box around the scene into a grid. Covered areas are summed over the faces of the grid (summed-area tables, Crow
//! 1984), so that the covered part of any rectangle of faces is four look-ups. They count triangles that overlap in a face
//! up to its area: good enough to choose by; what is closed is proven by [`Walls::open_parts`]. All places are about the scene's
//! origin. Cost: a step a triangle and face that meet, and 24 bytes a box of the grid.

use glam::DVec3;

use super::PreparedScene;
use super::cover::{Rect, Walls, area_within, plane_areas};

/// Boxes of the grid, at most.
const BOXES: usize = 1 << 21;
/// Planes across an axis, at most.
const PLANES: usize = 500;
/// Planes with less opaque area than this part of the scene's largest section are not taken.
const LEAST_AREA: f64 = 3e-4;
/// Planes as near as this to a larger one are not taken, as a part of the scene's longest side.
const NEAREST: f64 = 1e-5;
/// What f64 tells apart in the world, with some thousands to spare.
const WORLD: f64 = 1e-12;

/// A grid of planes.
pub(super) struct PlaneGrid {
    /// Places of the planes across each axis, in order; the first and last are around the scene.
    pub lines: [Vec<f64>; 3],
    /// The triangles in them.
    pub walls: Walls,
    /// By axis: covered area of the faces before (plane, u, v), with u the axis after.
    sums: [Vec<f64>; 3],
}

impl PlaneGrid {
    /// Chooses planes, the largest covered area first; `None` for a scene without anything in finite boxes.
    pub fn new(scene: &PreparedScene) -> Option<PlaneGrid> {
        let boxes = scene.bounds.iter().filter(|b| b.is_finite());
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = boxes.fold(none, |(low, high), b| (low.min(b.min.as_dvec3()), high.max(b.max.as_dvec3())));
        if !min.cmple(max).all() {
            return None;
        }
        let world = (min + scene.origin).abs().max((max + scene.origin).abs()).max_element();
        let size = (max - min).max_element();
        // A little around, so that nothing flat is without volume.
        let around = DVec3::splat((size * 1e-3).max(world * WORLD * 1e3).max(1e-6));
        let lines = lines(scene, min - around, max + around, (size * NEAREST).max(world * WORLD));
        let walls = Walls::new(scene, &lines);
        let sums = [0, 1, 2].map(|axis| sums(&walls, axis, &lines));
        Some(PlaneGrid { lines, walls, sums })
    }

    /// Boxes along each axis.
    pub fn steps(&self) -> [usize; 3] {
        [0, 1, 2].map(|k| self.lines[k].len() - 1)
    }

    /// Of a plane, between lines of the two axes after its own: the rectangle.
    pub fn rect(&self, axis: usize, low: [usize; 2], high: [usize; 2]) -> Rect {
        let (us, vs) = (&self.lines[(axis + 1) % 3], &self.lines[(axis + 2) % 3]);
        Rect { min: [us[low[0]], vs[low[1]]], max: [us[high[0]], vs[high[1]]] }
    }

    /// The part of such a rectangle that is about covered, 0 to 1.
    pub fn covered(&self, axis: usize, plane: usize, low: [usize; 2], high: [usize; 2]) -> f64 {
        let (rows, columns) = (self.lines[(axis + 1) % 3].len(), self.lines[(axis + 2) % 3].len());
        let at = |u: usize, v: usize| self.sums[axis][(plane * rows + u) * columns + v];
        let sum = at(high[0], high[1]) - at(low[0], high[1]) - at(high[0], low[1]) + at(low[0], low[1]);
        sum / self.rect(axis, low, high).area()
    }
}

fn lines(scene: &PreparedScene, min: DVec3, max: DVec3, nearest: f64) -> [Vec<f64>; 3] {
    let mut lines = [0, 1, 2].map(|axis| vec![min[axis], max[axis]]);
    let size = max - min;
    let largest = (size.x * size.y).max(size.y * size.z).max(size.z * size.x);
    let mut planes = plane_areas(scene);
    planes.retain(|(area, ..)| *area >= largest * LEAST_AREA);
    planes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)).then(a.2.total_cmp(&b.2)));
    for (_, axis, at) in planes {
        if lines[axis].len() > PLANES || lines[axis].iter().any(|l| (l - at).abs() <= nearest) {
            continue;
        }
        lines[axis].push(at);
        if lines.iter().map(|l| l.len() - 1).product::<usize>() >= BOXES {
            break;
        }
    }
    lines.iter_mut().for_each(|l| l.sort_by(f64::total_cmp));
    lines
}

/// Summed-area tables of all planes across an axis.
fn sums(walls: &Walls, axis: usize, lines: &[Vec<f64>; 3]) -> Vec<f64> {
    let (us, vs) = (&lines[(axis + 1) % 3], &lines[(axis + 2) % 3]);
    let (columns, size) = (vs.len(), us.len() * vs.len());
    let mut out = vec![0.0; lines[axis].len() * size];
    for (&at, sums) in lines[axis].iter().zip(out.chunks_exact_mut(size)) {
        for flat in walls.at(axis, at) {
            let around = flat.around();
            let steps = |lines: &[f64], k: usize| {
                let first = lines.partition_point(|&p| p <= around.min[k]).saturating_sub(1);
                first..lines.partition_point(|&p| p < around.max[k]).min(lines.len() - 1)
            };
            for u in steps(us, 0) {
                for v in steps(vs, 1) {
                    let face = Rect { min: [us[u], vs[v]], max: [us[u + 1], vs[v + 1]] };
                    sums[(u + 1) * columns + v + 1] += area_within(&flat.corners, &face) * flat.share();
                }
            }
        }
        for u in 1..us.len() {
            for v in 1..vs.len() {
                let face = (us[u] - us[u - 1]) * (vs[v] - vs[v - 1]);
                let before = |u: usize, v: usize| sums[u * columns + v];
                let rest = before(u - 1, v) + before(u, v - 1) - before(u - 1, v - 1);
                sums[u * columns + v] = before(u, v).min(face) + rest;
            }
        }
    }
    out
}
