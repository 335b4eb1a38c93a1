//! A box clipped to the whole frustum, before its nearest depth is taken: a long wall beside the eye then reaches no
//! nearer than where it enters the view (SEMANTICS, *Depth, ties*).
//!
//! Slow and in f64: done only for boxes that touch the near plane or leave the viewport, and only when the quick test calls them
//! visible.

use super::project::{BoxView, ROUNDING};
use crate::geometry::{Aabb, SampleRect};

/// The part of a box inside the frustum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ClippedBox {
    /// It touches the near plane, or cannot be bounded.
    Near,
    /// Nothing of it is inside.
    Outside,
    /// The samples that it may touch, and its nearest depth, raised by its bound.
    Inside(SampleRect, f32),
}

/// Six quads, by corner number: bit `axis` chooses the greater side.
const FACES: [[usize; 4]; 6] = [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];

/// The frustum is taken a quarter of a sample wider, in subpixels: nothing that rounding moves in by less is cut away. No
/// sample lies that close to the edge of the viewport.
const AROUND: f64 = 64.0;

/// x, y, w, depth, near.
type Point = [f64; 5];

pub(crate) fn clip_box(view: &BoxView, b: Aabb) -> ClippedBox {
    let rows = view.rows.rows.map(|r| r.map(f64::from));
    let low: [f64; 3] = std::array::from_fn(|i| f64::from(b.min[i]) - f64::from(view.rows.eye[i]));
    let high: [f64; 3] = std::array::from_fn(|i| f64::from(b.max[i]) - f64::from(view.rows.eye[i]));
    let reach: [f64; 3] = std::array::from_fn(|i| low[i].abs().max(high[i].abs()));
    let size = rows.map(|r| (0..3).map(|i| r[i].abs() * reach[i]).sum::<f64>() + r[3].abs());
    if !b.is_finite() || !size.iter().all(|v| v.is_finite()) {
        return ClippedBox::Near;
    }
    // The middle is about the eye, the box about the eye as rounded to f32: half a step of it apart at most.
    let slack = |i: usize| reach[i] * 1e-6 + f64::from(view.rows.eye[i]).abs() / 16_777_216.0;
    if view.near_center.is_none_or(|c| (0..3).all(|i| low[i] - slack(i) <= c[i] && c[i] <= high[i] + slack(i))) {
        return ClippedBox::Near;
    }
    let corner = |n: usize| -> Point {
        let p: [f64; 3] = std::array::from_fn(|i| if n >> i & 1 != 0 { high[i] } else { low[i] });
        rows.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3])
    };
    let corners: [Point; 8] = std::array::from_fn(corner);
    let sides = [f64::from(view.grid.width()) * 256.0, f64::from(view.grid.height()) * 256.0];
    let rounding = f64::from(ROUNDING);
    let distances = corners.map(|p| std::array::from_fn::<f64, 5, _>(|plane| distance(&p, plane, sides)));
    let part = clipped_part(&corners, &distances, sides);
    if part.least_near <= rounding * size[4] {
        return ClippedBox::Near;
    }
    if part.w == f64::INFINITY {
        return ClippedBox::Outside;
    }
    // The bound of `project`, at the part's least w.
    let bound = |r: usize, most: f64| rounding * (size[r] + most * size[2]) / part.w;
    let (mx, my) = (bound(0, sides[0]) + 0.5, bound(1, sides[1]) + 0.5);
    if mx.max(my) > AROUND {
        return ClippedBox::Near;
    }
    let range = |[low, high]: [f64; 2], margin: f64, side: f64| {
        let first = ((low - margin + 127.0) / 256.0).floor().max(0.0) as i32;
        let last = ((high + margin - 128.0) / 256.0).floor().min(side / 256.0 - 1.0) as i32;
        (first, last)
    };
    let ((x0, x1), (y0, y1)) = (range(part.x, mx, sides[0]), range(part.y, my, sides[1]));
    let depth = part.depth + bound(3, part.depth.abs());
    ClippedBox::Inside(SampleRect { x0, y0, x1, y1 }, (depth as f32).next_up())
}

/// Clips the faces, each against those planes alone that it crosses.
fn clipped_part(corners: &[Point; 8], distances: &[[f64; 5]; 8], sides: [f64; 2]) -> Part {
    let mut part = Part::NONE;
    let mut buffers = [Outline::EMPTY, Outline::EMPTY];
    for face in FACES {
        let outside = |plane: usize| face.iter().filter(|&&n| distances[n][plane] < 0.0).count();
        let [from, to] = &mut buffers;
        for (to, n) in from.points.iter_mut().zip(face) {
            *to = corners[n];
        }
        from.len = 4;
        let (mut from, mut to) = (from, to);
        for plane in 0..5 {
            match outside(plane) {
                0 => {}
                4 => from.len = 0,
                _ => {
                    from.clip(|p| distance(p, plane, sides), to);
                    std::mem::swap(&mut from, &mut to);
                }
            }
        }
        for p in &from.points[..from.len] {
            part.add(p);
        }
    }
    part
}

/// Signed distance from a plane of the frustum, at least 0 inside: near, left, right, top, bottom.
fn distance(p: &Point, plane: usize, sides: [f64; 2]) -> f64 {
    match plane {
        0 => p[4],
        1 => p[0] + AROUND * p[2],
        2 => (sides[0] + AROUND) * p[2] - p[0],
        3 => p[1] + AROUND * p[2],
        _ => (sides[1] + AROUND) * p[2] - p[1],
    }
}

/// Four corners, and one more for each of five planes.
struct Outline {
    points: [Point; 9],
    len: usize,
}

impl Outline {
    const EMPTY: Outline = Outline { points: [[0.0; 5]; 9], len: 0 };

    fn push(&mut self, p: Point) {
        if self.len < 9 {
            self.points[self.len] = p;
            self.len += 1;
        }
    }

    /// The part where `distance` is at least 0.
    fn clip(&self, distance: impl Fn(&Point) -> f64, out: &mut Outline) {
        out.len = 0;
        let Some(last) = self.points[..self.len].last() else { return };
        let (mut p, mut dp) = (last, distance(last));
        for q in &self.points[..self.len] {
            let dq = distance(q);
            if (dp < 0.0) != (dq < 0.0) {
                let t = dp / (dp - dq);
                out.push(std::array::from_fn(|c| p[c] + t * (q[c] - p[c])));
            }
            if dq >= 0.0 {
                out.push(*q);
            }
            (p, dp) = (q, dq);
        }
    }
}

/// Ranges over the clipped faces' corners.
struct Part {
    x: [f64; 2],
    y: [f64; 2],
    depth: f64,
    w: f64,
    least_near: f64,
}

impl Part {
    const NONE: Part = Part {
        x: [f64::INFINITY, f64::NEG_INFINITY],
        y: [f64::INFINITY, f64::NEG_INFINITY],
        depth: f64::NEG_INFINITY,
        w: f64::INFINITY,
        least_near: f64::INFINITY,
    };

    fn add(&mut self, p: &Point) {
        let (x, y) = (p[0] / p[2], p[1] / p[2]);
        self.x = [self.x[0].min(x), self.x[1].max(x)];
        self.y = [self.y[0].min(y), self.y[1].max(y)];
        self.depth = self.depth.max(p[3] / p[2]);
        self.w = self.w.min(p[2]);
        self.least_near = self.least_near.min(p[4]);
    }
}
