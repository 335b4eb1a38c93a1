//! Triangles that cross the near plane or the guard band, one by one.
//!
//! Clipping is watertight: a new corner is computed from its edge's end points in an order of their own, so that both
//! triangles at an edge get the same one; corners that need no clipping keep their snapped positions; what is left is drawn
//! as one convex polygon, not a fan, but where snapping has bent its outline: there corners are cut off first. The depth stays that of the whole triangle's plane.

use std::cmp::Ordering;

use homcull_simd::{Mask, Simd};

use super::convex::{Convex, MOST_CORNERS};
use super::each::each;
use super::engine::{Engine, Placement};
use super::facing::Facing;
use super::grid::Grid;
use super::plane::{Plane, Planes};
use super::queue::Lanes;
use super::sink::Sink;
use super::transform::{GUARD, ScreenVertices};

/// A corner before the division, and its snapped position if it is one of the triangle's own inside all planes.
#[derive(Clone, Copy)]
struct Corner {
    /// x, y, w, depth, near.
    clip: [f64; 5],
    snapped: Option<[i32; 2]>,
}

/// A convex polygon on the way through the planes.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [Corner; MOST_CORNERS],
    len: usize,
}

impl<'a, S: Simd, K: Sink<'a>> Engine<'_, S, K> {
    #[inline(always)]
    pub(crate) fn clip_lanes(
        &mut self,
        lanes: Mask,
        corners: &[[u8; 16]; 3],
        numbers: &[i32; 16],
        placement: &Placement<'_>,
    ) {
        let mut lanes = lanes;
        while lanes != 0 {
            let l = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let id = placement.first_triangle.wrapping_add(numbers[l] as u32);
            self.run_clipped(corners.map(|c| usize::from(c[l])), placement.facing, id);
        }
    }

    #[inline(always)]
    pub(crate) fn draw_clipped(&mut self, corners: [usize; 3], facing: Facing, id: u32) {
        let Some((mut outline, area)) = clipped_outline(&self.queues.vertices, corners) else { return };
        let mut corners = corners;
        let shown = match facing {
            Facing::Front => area > 0,
            Facing::Back => area < 0,
            Facing::Both => area != 0,
        };
        if !shown {
            return;
        }
        if area < 0 {
            outline.reverse();
            corners.swap(1, 2);
        }
        let side = |axis: usize| {
            let all = outline.iter().map(|p| p[axis]);
            (all.clone().min().unwrap_or(0), all.max().unwrap_or(0))
        };
        let ((x0, x1), (y0, y1)) = (side(0), side(1));
        let band = self.sink.surface().band;
        let (sx0, first_row) = (((x0 + 127) >> 8).max(0), ((y0 + 127) >> 8).max(0));
        let sy0 = first_row.max(band.first_row());
        let (sx1, sy1) = (((x1 - 128) >> 8).min(band.grid.width() - 1), ((y1 - 128) >> 8).min(band.last_row()));
        if sx0 > sx1 || sy0 > sy1 {
            return;
        }
        self.counts.clipped += 1;
        let v = &self.queues.vertices;
        let whole: [[f64; 5]; 3] = corners.map(|k| std::array::from_fn(|c| f64::from(v.clip[c][k])));
        let (near, far) = (screen_near(&whole, band.grid), far_depth(v, corners));
        let near = near.max(far);
        let lanes = self.one_triangle(corners, near, far);
        let s = self.simd;
        let plane = Planes::new(s, &lanes, s.splat_i(sx0), s.splat_i(first_row)).lane(0, near, far);
        let blocks = [sx0 >> 3, sy0 >> 3, sx1 >> 3, sy1 >> 3];
        loop {
            let ear = outline.cut_ear();
            self.draw_outline(ear.as_ref().map_or(&outline, |e| e), plane, blocks, id);
            if ear.is_none() {
                break;
            }
        }
    }

    #[inline(always)]
    fn draw_outline(&mut self, outline: &[[i32; 2]], plane: Plane, blocks: [i32; 4], id: u32) {
        let mut convex = Convex::<MOST_CORNERS> {
            a: [0; MOST_CORNERS],
            b: [0; MOST_CORNERS],
            c: [f64::from(1 << 30); MOST_CORNERS],
            plane,
            blocks,
            id,
        };
        for (q, p) in outline.iter().enumerate() {
            let r = outline[(q + 1) % outline.len()];
            let (a, b) = (p[1] - r[1], r[0] - p[0]);
            let c = i64::from(a) * i64::from(128 - p[0]) + i64::from(b) * i64::from(128 - p[1]);
            let owns = a > 0 || a == 0 && b > 0;
            (convex.a[q], convex.b[q], convex.c[q]) = (a, b, ((c - i64::from(!owns)) >> 8) as f64);
        }
        self.draw_convex(&convex);
    }

    /// One triangle in all lanes, for its plane.
    #[inline(always)]
    fn one_triangle(&self, corners: [usize; 3], near: f32, far: f32) -> Lanes<S> {
        let s = self.simd;
        let v = &self.queues.vertices;
        let zero = s.splat_i(0);
        Lanes {
            x: [zero; 3],
            y: [zero; 3],
            near: s.splat_f(near),
            far: s.splat_f(far),
            clip: each!(4, c => each!(3, q => s.splat_f(v.clip[c][corners[q]]))),
            id: zero,
        }
    }
}

/// The farthest depth that the triangle can have: of its corners beyond the near plane.
fn far_depth(v: &ScreenVertices, corners: [usize; 3]) -> f32 {
    corners.iter().filter(|&&k| v.outside[k] & 1 == 0).map(|&k| v.depth[k]).fold(f32::INFINITY, f32::min)
}

/// The nearest depth of the part of a triangle on the screen, a quarter of a sample around it included; -infinity when there is none. What
/// is drawn is clamped to it where corners lie elsewhere: so a box clipped to the frustum bounds its triangles.
pub(crate) fn screen_near(corners: &[[f64; 5]; 3], grid: Grid) -> f32 {
    const AROUND: f64 = 64.0;
    let start = corners.map(|clip| Corner { clip, snapped: None });
    let mut polygon = Polygon { corners: [start[0]; MOST_CORNERS], len: 3 };
    polygon.corners[..3].copy_from_slice(&start);
    let (right, bottom) = (f64::from(grid.width()) * 256.0 + AROUND, f64::from(grid.height()) * 256.0 + AROUND);
    for plane in 0..5 {
        polygon = polygon.clipped(|c: &[f64; 5]| match plane {
            0 => c[4],
            1 => c[0] + AROUND * c[2],
            2 => right * c[2] - c[0],
            3 => c[1] + AROUND * c[2],
            _ => bottom * c[2] - c[1],
        });
    }
    let nearest =
        polygon.corners[..polygon.len].iter().map(|c| c.clip[3] / c.clip[2]).fold(f64::NEG_INFINITY, f64::max);
    (nearest as f32).next_up()
}

/// What is left of a triangle inside all planes, snapped, without repeated corners, and twice its area in square
/// subpixels; `None` when nothing is, or when a corner's position overflows.
fn clipped_outline(v: &ScreenVertices, corners: [usize; 3]) -> Option<(Vec2List, i64)> {
    let start = corners.map(|k| Corner {
        clip: std::array::from_fn(|c| f64::from(v.clip[c][k])),
        snapped: (v.outside[k] == 0).then_some([v.x[k], v.y[k]]),
    });
    if start.iter().flat_map(|c| c.clip).any(|x| !x.is_finite()) {
        return None;
    }
    let mut polygon = Polygon { corners: [start[0]; MOST_CORNERS], len: 3 };
    polygon.corners[..3].copy_from_slice(&start);
    for plane in 0..5 {
        polygon = polygon.clipped(|c: &[f64; 5]| guard_distance(c, plane));
        if polygon.len < 3 {
            return None;
        }
    }
    let mut outline = Vec2List::new();
    for corner in &polygon.corners[..polygon.len] {
        outline.push_new(corner.snapped.unwrap_or_else(|| snap(&corner.clip)));
    }
    let area = outline.twice_area();
    Some((outline, area))
}

/// Signed distance from a plane, at least 0 inside: near, left, right, top, bottom of the guard band.
fn guard_distance(c: &[f64; 5], plane: usize) -> f64 {
    let reach = f64::from(GUARD) * c[2];
    match plane {
        0 => c[4],
        1 => reach + c[0],
        2 => reach - c[0],
        3 => reach + c[1],
        _ => reach - c[1],
    }
}

impl Polygon {
    fn clipped(&self, distance: impl Fn(&[f64; 5]) -> f64) -> Polygon {
        let mut out = Polygon { corners: self.corners, len: 0 };
        for i in 0..self.len {
            let (p, q) = (&self.corners[i], &self.corners[(i + 1) % self.len]);
            let (dp, dq) = (distance(&p.clip), distance(&q.clip));
            if dp >= 0.0 {
                out.push(*p);
            }
            if (dp < 0.0) != (dq < 0.0) {
                out.push(intersection(p, q, &distance));
            }
        }
        out
    }

    /// A convex polygon gains at most one corner a plane, so there is room; rounding that says otherwise is not believed.
    fn push(&mut self, corner: Corner) {
        if self.len < MOST_CORNERS {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }
}

/// Where an edge meets a plane, from its end points in the order of their coordinates.
fn intersection(p: &Corner, q: &Corner, distance: impl Fn(&[f64; 5]) -> f64) -> Corner {
    let order = p.clip.iter().zip(&q.clip).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne());
    let (p, q) = if order == Some(Ordering::Greater) { (q, p) } else { (p, q) };
    let (dp, dq) = (distance(&p.clip), distance(&q.clip));
    // Two weights, not one difference: an end 1e30 away would swallow the other.
    let (s, t) = (dq / (dq - dp), dp / (dp - dq));
    Corner { clip: std::array::from_fn(|i| p.clip[i] * s + q.clip[i] * t), snapped: None }
}

/// The nearest subpixel, inside the guard band.
fn snap(c: &[f64; 5]) -> [i32; 2] {
    let guard = f64::from(GUARD);
    [c[0] / c[2], c[1] / c[2]].map(|v| v.round_ties_even().clamp(-guard, guard) as i32)
}

/// A few snapped points.
struct Vec2List {
    points: [[i32; 2]; MOST_CORNERS],
    len: usize,
}

impl Vec2List {
    fn new() -> Vec2List {
        Vec2List { points: [[0; 2]; MOST_CORNERS], len: 0 }
    }

    /// Adds a point unless it repeats the one before it; the last may yet repeat the first, see `twice_area`.
    fn push_new(&mut self, p: [i32; 2]) {
        if self.last() != Some(&p) {
            self.points[self.len] = p;
            self.len += 1;
        }
    }

    /// Twice the signed area; drops a last point that repeats the first.
    fn twice_area(&mut self) -> i64 {
        if self.len > 1 && self.points[self.len - 1] == self.points[0] {
            self.len -= 1;
        }
        let at = |i: usize| self.points[i % self.len].map(i64::from);
        (0..self.len).map(|i| (at(i), at(i + 1))).map(|(p, q)| p[0] * q[1] - q[0] * p[1]).sum()
    }
}

impl Vec2List {
    /// Cuts a corner off while the outline (of positive area) is not convex: snapping can bend it where two corners lie a
    /// subpixel apart, and half planes alone would then lose all beyond the bend.
    fn cut_ear(&mut self) -> Option<[[i32; 2]; 3]> {
        let n = self.len;
        let at = |i: usize| self.points[i % n].map(i64::from);
        let turn =
            |p: [i64; 2], q: [i64; 2], r: [i64; 2]| (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]);
        if n <= 3 || (0..n).all(|i| turn(at(i), at(i + 1), at(i + 2)) >= 0) {
            return None;
        }
        let ear = (0..n).find(|&i| {
            let (p, q, r) = (at(i), at(i + 1), at(i + 2));
            let holds = |v: [i64; 2]| turn(p, q, v) >= 0 && turn(q, r, v) >= 0 && turn(r, p, v) >= 0;
            turn(p, q, r) > 0 && (i + 3..i + n).all(|k| !holds(at(k)))
        })?;
        let cut = [0, 1, 2].map(|k| self.points[(ear + k) % n]);
        self.points.copy_within((ear + 1) % n + 1..n, (ear + 1) % n);
        self.len -= 1;
        Some(cut)
    }
}

impl std::ops::Deref for Vec2List {
    type Target = [[i32; 2]];
    fn deref(&self) -> &[[i32; 2]] {
        &self.points[..self.len]
    }
}

impl std::ops::DerefMut for Vec2List {
    fn deref_mut(&mut self) -> &mut [[i32; 2]] {
        &mut self.points[..self.len]
    }
}

impl<'a, S: Simd, K: Sink<'a>> Engine<'_, S, K> {
    /// The nearest depths of the triangles, tightened for those that are steep and partly off the screen.
    #[inline(always)]
    pub(crate) fn screen_nears(&mut self, lanes: Mask, steep: Mask, t: &Lanes<S>) -> [f32; 16] {
        let s = self.simd;
        let mut nears = [0.0; 16];
        s.store_f(t.near, &mut nears);
        let grid = self.sink.surface().band.grid;
        let mut tighten = lanes & steep & (leaves(s, &t.x, grid.width()) | leaves(s, &t.y, grid.height()));
        if tighten != 0 {
            let mut clip = [[[0.0; 16]; 3]; 4];
            for c in 0..4 {
                for q in 0..3 {
                    s.store_f(t.clip[c][q], &mut clip[c][q]);
                }
            }
            while tighten != 0 {
                let l = tighten.trailing_zeros() as usize;
                tighten &= tighten - 1;
                // Triangles that get here lie beyond the near plane: nothing is to be clipped there.
                let corner = |k: usize| -> [f64; 5] {
                    std::array::from_fn(|c| if c < 4 { f64::from(clip[c][k][l]) } else { 0.0 })
                };
                nears[l] = nears[l].min(screen_near(&[corner(0), corner(1), corner(2)], grid));
            }
        }
        nears
    }
}

/// The triangles with a corner before 0 or beyond `side` samples.
#[inline(always)]
fn leaves<S: Simd>(s: S, v: &[S::I; 3], side: i32) -> Mask {
    let (low, high) = (s.min_i(s.min_i(v[0], v[1]), v[2]), s.max_i(s.max_i(v[0], v[1]), v[2]));
    s.sign_i(low) | s.gt_i(high, s.splat_i(side * 256))
}
