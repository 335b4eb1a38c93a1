//! The far bounding rectangle of an occluder: the samples that it may cover, at the farthest depth that it may have there
//! (Zhang 1998, 6.3.1). The depth estimation buffer and the single plane are built from these, never by rasterizing.
//!
//! **The bound.** No sample outside the rectangle is covered by the occluder, and no sample is drawn farther than the rectangle lies.
//! All that is drawn of a triangle are convex combinations of its vertices as they were transformed, and drawn depth is clamped
//! to that of its vertices beyond the near plane (`raster/plane.rs`, `raster/clip.rs`), so a bound for vertices will do. With the
//! names of `project.rs`, a row of a vertex, computed in f32, errs from that of a point of the box by at most `6 u S`, and a
//! rotation by `3 u S` more, `S` taking in how far the mesh reaches from its own origin. We take `d = 32 u S`, which
//! leaves room for the two roundings of the quotient. So a vertex beyond the near plane has a point of the box within `d` of
//! it, and that lies beyond the near plane moved out by its `d`: in the box's *part*. Its depth is at least
//! `(Z - d_Z) / (W + d_W)` there, and its place on the screen lies between `(X -+ d_X) / (W +- d_W)`, half a subpixel of
//! snapping aside. Those are least and greatest at corners of the part: corners of the box, and where its edges meet the
//! moved plane. What can't be bounded so (a point at or behind the eye's plane, numbers beyond f32) counts for the whole
//! screen at the farthest depth.
//!
//! Cost: eight corners in f64, an occluder.

use glam::{DMat3, DVec3, Mat3};

use super::project::ROUNDING;
use crate::geometry::{Aabb, SampleRect};
use crate::raster::{Grid, ObjectRows};

/// Samples of the viewport, and the farthest depth of what may cover them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FarRectangle {
    pub rect: SampleRect,
    /// Reversed, at least 0: samples beyond the far plane are never covered.
    pub depth: f32,
}

/// Sums beyond this may have left f32 in the rasterizer.
const LARGEST: f64 = 1e30;

impl FarRectangle {
    /// The rectangle of a mesh within `bounds`, in its own space, turned by `rotation`. `None` when it covers no sample.
    pub fn new(rows: &ObjectRows, rotation: Option<&Mat3>, bounds: Aabb, grid: Grid) -> Option<FarRectangle> {
        if bounds.is_empty() {
            return None;
        }
        let everywhere = SampleRect { x0: 0, y0: 0, x1: grid.width() - 1, y1: grid.height() - 1 };
        let Some(part) = Part::new(rows, rotation, bounds) else {
            return Some(FarRectangle { rect: everywhere, depth: 0.0 });
        };
        if part.is_empty() {
            return None;
        }
        let (x0, x1) = samples_between(part.x, grid.width());
        let (y0, y1) = samples_between(part.y, grid.height());
        let rect = SampleRect { x0, y0, x1, y1 };
        let depth = (part.far as f32).next_down().max(0.0);
        (!rect.is_empty()).then_some(FarRectangle { rect, depth })
    }
}

/// The samples of a side whose centres lie in a range of subpixels, widened by half of one for snapping.
fn samples_between([low, high]: [f64; 2], side: i32) -> (i32, i32) {
    let first = ((low - 0.5 - 128.0) / 256.0).ceil().clamp(0.0, f64::from(side));
    let last = ((high + 0.5 - 128.0) / 256.0).floor().clamp(-1.0, f64::from(side - 1));
    (first as i32, last as i32)
}

/// The part of a box beyond the near plane, as ranges over its corners, each widened by its bound.
struct Part {
    /// In subpixels.
    x: [f64; 2],
    y: [f64; 2],
    far: f64,
}

/// The five rows of a point: x, y, w, depth, near.
type Rows = [f64; 5];

impl Part {
    const NONE: Part =
        Part { x: [f64::INFINITY, f64::NEG_INFINITY], y: [f64::INFINITY, f64::NEG_INFINITY], far: f64::INFINITY };

    fn is_empty(&self) -> bool {
        self.far == f64::INFINITY
    }

    /// `None` when it can't be bounded.
    fn new(rows: &ObjectRows, rotation: Option<&Mat3>, bounds: Aabb) -> Option<Part> {
        let turn = rotation.map_or(DMat3::IDENTITY, Mat3::as_dmat3);
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let eye = DVec3::from_array(rows.eye.map(f64::from));
        let corners: [DVec3; 8] = std::array::from_fn(|n| {
            let side = |axis: usize| if n >> axis & 1 != 0 { high[axis] } else { low[axis] };
            turn * DVec3::new(side(0), side(1), side(2)) - eye
        });
        let reach = corners.iter().fold(DVec3::ZERO, |most, c| most.max(c.abs()));
        let from_origin = DMat3::from_cols(turn.x_axis.abs(), turn.y_axis.abs(), turn.z_axis.abs())
            * low.abs().max(high.abs())
            * f64::from(rotation.is_some());
        let rows = rows.rows.map(|r| r.map(f64::from));
        let reach = reach + from_origin;
        let bound = rows.map(|r| {
            let size = r[0].abs() * reach.x + r[1].abs() * reach.y + r[2].abs() * reach.z + r[3].abs();
            f64::from(ROUNDING) * size
        });
        if !bound.iter().all(|&b| b < LARGEST) || !corners.iter().all(|c| c.is_finite()) {
            return None;
        }
        let points = corners.map(|c| rows.map(|r| r[0] * c.x + r[1] * c.y + r[2] * c.z + r[3]));
        let mut part = Part::NONE;
        for (n, p) in points.iter().enumerate() {
            let near = p[4] + bound[4];
            if near >= 0.0 {
                part.add(p, &bound)?;
            }
            for axis in (0..3).filter(|axis| n >> axis & 1 == 0) {
                let q = &points[n | 1 << axis];
                let other = q[4] + bound[4];
                if (near < 0.0) != (other < 0.0) {
                    let t = near / (near - other);
                    part.add(&std::array::from_fn(|i| p[i] + t * (q[i] - p[i])), &bound)?;
                }
            }
        }
        Some(part)
    }

    /// Takes a corner in; `None` if it is not certainly before the eye.
    fn add(&mut self, p: &Rows, bound: &Rows) -> Option<()> {
        let [x, y, w, depth, _] = *p;
        let (nearer, farther) = (w - bound[2], w + bound[2]);
        if nearer <= 0.0 {
            return None;
        }
        let least = |v: f64| if v < 0.0 { v / nearer } else { v / farther };
        let greatest = |v: f64| if v < 0.0 { v / farther } else { v / nearer };
        self.x = [self.x[0].min(least(x - bound[0])), self.x[1].max(greatest(x + bound[0]))];
        self.y = [self.y[0].min(least(y - bound[1])), self.y[1].max(greatest(y + bound[1]))];
        self.far = self.far.min(least(depth - bound[3]));
        Some(())
    }
}
