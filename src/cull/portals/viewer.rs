//! The viewer: where the rays of a view begin, and which of them pass a portal.
//!
//! Nothing nearer than the near plane is drawn, so rays begin on the *near rectangle*, not in the eye: a wall between the two is not
//! there, and a near rectangle that reaches through a doorway's plane begins in both cells. The frustum is never clipped
//! by hand: the rays through a portal are the cone over it, whose four planes hold before and behind the eye alike.
//!
//! **The margin.** A drawn corner differs from the exact one by half a subpixel of snapping and the transform's
//! rounding, at most `32 u (S_x + |x| S_w) / w` (`occlusion/project.rs`). If all corners of a portal are in front of the eye, its edges
//! move outwards by the largest of these. Else the lines through the eye and its edges are cross products of corners, and their
//! coefficients are widened by what such differences make of them.

use glam::{DVec3, DVec4};

use super::region::Region;
use crate::occlusion::ROUNDING;
use crate::scene::{Cell, Cells, Portal};
use crate::view::View;

/// Samples around the viewport whose rays count, in subpixels.
const AROUND: f64 = 256.0;
/// How far regions reach beyond where rays begin in a cell, in subpixels.
const WIDER: f64 = 2.0;
/// Half a subpixel of snapping, and as much again.
const SNAP: f64 = 1.0;
/// A portal is seen edge-on when the eye is this near to its plane, as a part of the distance to its farthest corner: some 160 roundings of
/// f32. Both its cells are then seen as one.
const EDGE_ON: f64 = 1e-5;
/// Of the near rectangle, how much must lie in cells. The rest would be less than a thousandth of a sample.
const COVERED: f64 = 1.0 - 1e-10;
/// How far outside its box a cell still takes rays, as a part of its size.
const WIDENING: f64 = 1e-9;

/// Where rays come from, about the eye.
#[derive(Debug, Clone, Copy)]
enum Rays {
    /// From a point.
    From(DVec3),
    /// All in one unit direction.
    Along(DVec3),
}

/// A view as portals see it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Viewer<'v> {
    view: &'v View,
    rays: Rays,
    /// Greatest x and y of a sample whose ray counts, in subpixels.
    sides: [f64; 2],
}

impl<'v> Viewer<'v> {
    /// `None` when it cannot be said where the rays of a view come from.
    pub fn new(view: &'v View) -> Option<Viewer<'v>> {
        let [x, y, w, _, near] = *view.rows();
        let sides = [view.viewport().width(), view.viewport().height()].map(|s| f64::from(s) * 256.0 + AROUND);
        let rays = match view.center() {
            Some(center) => Rays::From(center),
            None if w.truncate() == DVec3::ZERO => {
                let along = x.truncate().cross(y.truncate());
                Rays::Along((along * along.dot(near.truncate()).signum()).try_normalize()?)
            }
            None => return None,
        };
        Some(Viewer { view, rays, sides })
    }

    /// The rows x, y and w of the view.
    pub fn rows(&self) -> [DVec4; 3] {
        let [x, y, w, ..] = *self.view.rows();
        [x, y, w]
    }

    /// The eye in the world.
    pub fn eye(&self) -> DVec3 {
        self.view.eye()
    }

    /// What rounding may move vertices of a box by, along x and y, in subpixels times w; the box is about the eye.
    pub fn slack(&self, min: DVec3, max: DVec3) -> [f64; 2] {
        let reach = min.abs().max(max.abs());
        let size = self.rows().map(|r| r.truncate().abs().dot(reach) + r.w.abs());
        [0, 1].map(|k| f64::from(ROUNDING) * (size[k] + self.sides[k] * size[2]))
    }

    /// The rays of `region` that pass a portal, upwards along its axis or downwards; `None` when there are none.
    pub fn through(&self, portal: &Portal, upwards: bool, region: &Region) -> Option<Region> {
        let corners = corners(portal).map(|p| p - self.eye());
        match self.facing(portal, &corners, upwards) {
            Facing::Away => return None,
            Facing::EdgeOn => return Some(*region),
            Facing::Open => {}
        }
        let points = corners.map(|p| self.rows().map(|r| r.truncate().dot(p) + r.w));
        let sizes = corners.map(|p| self.rows().map(|r| r.truncate().abs().dot(p.abs()) + r.w.abs()));
        let margin = screen_margin(&points, &sizes);
        let middle = points.iter().fold(DVec3::ZERO, |sum, p| sum + DVec3::from_array(*p));
        let mut out = *region;
        for i in 0..4 {
            let (p, q) = (DVec3::from_array(points[i]), DVec3::from_array(points[(i + 1) % 4]));
            let line = p.cross(q);
            let mut line = if line.dot(middle) < 0.0 { -line } else { line };
            let outwards = line.x.abs() + line.y.abs();
            line.z += match margin {
                Some(margin) => margin * outwards,
                None => SNAP * outwards + self.line_margin(sizes[i], sizes[(i + 1) % 4]),
            };
            out = out.cut(line)?;
        }
        Some(out)
    }

    fn facing(&self, portal: &Portal, corners: &[DVec3; 4], upwards: bool) -> Facing {
        let (axis, sign) = (portal.axis(), if upwards { 1.0 } else { -1.0 });
        let (towards, reach) = match self.rays {
            Rays::From(center) => {
                let reach = corners.iter().map(|p| (*p - center).length()).fold(0.0, f64::max);
                ((corners[0][axis] - center[axis]) * sign, reach)
            }
            Rays::Along(way) => (way[axis] * sign, 1.0),
        };
        match towards {
            t if t > EDGE_ON * reach => Facing::Open,
            t if t < -EDGE_ON * reach => Facing::Away,
            _ => Facing::EdgeOn,
        }
    }

    /// What differences of two corners may add to the line through them, at any sample.
    fn line_margin(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let cross = |i: usize, j: usize| 2.0 * f64::from(ROUNDING) * (a[i] * b[j] + a[j] * b[i]);
        cross(1, 2) * self.sides[0] + cross(2, 0) * self.sides[1] + cross(0, 1)
    }

    /// Calls with every cell in which rays begin, and the part of the screen where they do. False when some begin in no cell: then it
    /// is not known what they see.
    ///
    /// Two rectangles are looked at, a little nearer and a little farther than the near plane: by as much as
    /// rounding may move what lies in the cells.
    pub fn begin(&self, cells: &Cells, candidates: &mut Vec<u32>, mut found: impl FnMut(u32, Region)) -> bool {
        let (min, max) = cells.bounds();
        let near = self.view.rows()[4];
        let reach = (min - self.eye()).abs().max((max - self.eye()).abs());
        let bound = f64::from(ROUNDING) * (near.truncate().abs().dot(reach) + near.w.abs());
        if !bound.is_finite() {
            return false;
        }
        // Not behind the eye, where nothing is drawn.
        let least = match self.rays {
            Rays::From(center) => (near.truncate().dot(center) + near.w) * 0.999,
            Rays::Along(_) => f64::NEG_INFINITY,
        };
        [least.max(-bound), bound].into_iter().all(|at| self.begin_at(cells, at, candidates, &mut found))
    }

    fn begin_at(&self, cells: &Cells, at: f64, candidates: &mut Vec<u32>, found: &mut impl FnMut(u32, Region)) -> bool {
        let [right, bottom] = self.sides;
        let screen = [[-AROUND, -AROUND], [right, -AROUND], [right, bottom], [-AROUND, bottom]];
        let mut near = Outline::EMPTY;
        for [x, y] in screen {
            let Some(p) = self.view.near_point(x, y, at) else { return false };
            if self.screen(p).is_none() {
                return false;
            }
            near.push(p);
        }
        let points = &near.points[..near.len];
        let (low, high) = points.iter().fold((points[0], points[0]), |(a, b), p| (a.min(*p), b.max(*p)));
        candidates.clear();
        // About the eye, where the rectangle may be small beside its distance from the origin.
        let about = |c: &Cell, wide: f64| {
            let out = DVec3::splat((c.max - c.min).max_element() * wide);
            (c.min - out - self.eye(), c.max + out - self.eye())
        };
        let meets = |c: &Cell| {
            let (min, max) = about(c, WIDENING);
            low.cmple(max).all() && min.cmple(high).all()
        };
        candidates.extend((0..).zip(cells.cells()).filter(|(_, c)| meets(c)).map(|(i, _)| i));
        let mut covered = 0.0;
        for &number in candidates.iter() {
            let cell = &cells.cells()[number as usize];
            covered += self.area(&near.within(about(cell, 0.0)));
            let wide = near.within(about(cell, WIDENING));
            let parts = wide.points[..wide.len].iter().filter_map(|&p| self.screen(p));
            let none = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            let (low, high) = parts.fold(none, |(low, high), p| {
                ([low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])])
            });
            if low[0] <= high[0] {
                found(number, Region::rectangle(low.map(|v| v - WIDER), high.map(|v| v + WIDER)));
            }
        }
        covered >= COVERED * (right + AROUND) * (bottom + AROUND)
    }

    /// Where a point, about the eye, is on the screen; `None` when it is not in front.
    fn screen(&self, p: DVec3) -> Option<[f64; 2]> {
        let [x, y, w] = self.rows().map(|r| r.truncate().dot(p) + r.w);
        (w > 0.0).then(|| [x / w, y / w])
    }

    /// The area of an outline on the screen.
    fn area(&self, outline: &Outline) -> f64 {
        let at = |i: usize| self.screen(outline.points[i % outline.len.max(1)]).unwrap_or_default();
        let twice = |i: usize| at(i)[0] * at(i + 1)[1] - at(i)[1] * at(i + 1)[0];
        (0..outline.len).map(twice).sum::<f64>().abs() * 0.5
    }
}

enum Facing {
    /// Rays may pass it this way.
    Open,
    /// They may pass the other way alone.
    Away,
    /// Its plane goes through the eye, as far as can be told.
    EdgeOn,
}

/// The corners of a portal, in turn.
fn corners(portal: &Portal) -> [DVec3; 4] {
    let (u, v) = ((portal.axis() + 1) % 3, (portal.axis() + 2) % 3);
    [[false, false], [true, false], [true, true], [false, true]].map(|[far_u, far_v]| {
        let mut p = portal.min;
        p[u] = if far_u { portal.max[u] } else { p[u] };
        p[v] = if far_v { portal.max[v] } else { p[v] };
        p
    })
}

/// How far corners may be drawn from where they are, in subpixels; `None` unless all are well in front of the eye.
fn screen_margin(points: &[[f64; 3]; 4], sizes: &[[f64; 3]; 4]) -> Option<f64> {
    let mut margin = 0.0f64;
    for (p, s) in points.iter().zip(sizes) {
        if p[2] <= 0.0 {
            return None;
        }
        for k in 0..2 {
            margin = margin.max(f64::from(ROUNDING) * (s[k] + (p[k] / p[2]).abs() * s[2]) / p[2]);
        }
    }
    (margin < 256.0).then_some(margin + SNAP)
}

/// A flat convex outline: four corners, and one more for each side of a box.
#[derive(Clone, Copy)]
struct Outline {
    points: [DVec3; 10],
    len: usize,
}

impl Outline {
    const EMPTY: Outline = Outline { points: [DVec3::ZERO; 10], len: 0 };

    fn push(&mut self, p: DVec3) {
        if self.len < self.points.len() {
            self.points[self.len] = p;
            self.len += 1;
        }
    }

    /// The part in a box.
    fn within(&self, (min, max): (DVec3, DVec3)) -> Outline {
        let mut out = *self;
        for k in 0..3 {
            out = out.cut(|p| p[k] - min[k]).cut(|p| max[k] - p[k]);
        }
        out
    }

    fn cut(&self, side: impl Fn(DVec3) -> f64) -> Outline {
        let mut out = Outline::EMPTY;
        let points = &self.points[..self.len];
        let Some(mut last) = points.last().copied() else { return out };
        for &p in points {
            let (a, b) = (side(last), side(p));
            if (a < 0.0) != (b < 0.0) {
                out.push(last + (p - last) * (a / (a - b)));
            }
            if b >= 0.0 {
                out.push(p);
            }
            last = p;
        }
        out
    }
}
