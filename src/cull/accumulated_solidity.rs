//! Accumulated solidity: what prioritized-layered projection expects to see of an object, from what it met before it.
//!
//! Klosowski and Silva (2000, *The prioritized-layered projection algorithm for visible set estimation*) give each node a *solidity*, the
//! chance that it hides what is behind it, and accumulate it from node to node along the view. Accumulated through the faces of nodes
//! it diffuses: a ray beside a wall is charged for the wall. So it is accumulated here where rays are kept apart, in 32x32 tiles
//! of the screen. With `open` the share of a tile that is still open, 1 at first, an object with the rectangle R on the screen
//!
//! ```text
//! solidity   rho = min(1, sum |v_i| area_i / sum |v_i| side_i)      v the way in which it is seen, area what it shows along each axis
//!                                                                    (scene/solidity.rs), side its box's faces
//! share      s   = rho min(1, samples(box) / samples(R'))            of R that it covers; samples(box) = sum |J_i| side_i, R' is R
//!                                                                    as it would be if the screen did not cut it
//! expected   E   = s sum over R of open                              samples that are expected to show it
//! then, in each tile that R meets with the share o:  open *= 1 - s o
//! ```
//!
//! where J is the cross product of the gradients of the screen's x and y at the middle of the box: the samples that a unit of area
//! takes. The accumulated solidity of a direction is 1 - open: independent coverings multiply. Objects must come nearest first.
//! What touches the near plane, or the plane of the eye, has no such rectangle: it may show in all that is open, and hides nothing. Nothing is drawn or
//! read back. Sums are in one order, in f32 and f64 without fused steps: equal on every machine.
//!
//! **Cost**: the tiles under each rectangle, twice.

use std::ops::Range;

use glam::{BVec3, DVec2, DVec3, DVec4, Vec3};

use crate::geometry::{Aabb, SampleRect};
use crate::occlusion::{CUT, NEAR, ProjectedBox};
use crate::view::{View, Viewport};

/// Tiles along each side of the screen: of 32, 64 and 128 none shows more on the plant.
const SIDE: usize = 32;

/// Solidity along a view.
#[derive(Debug, Clone, Default)]
pub(super) struct AccumulatedSolidity {
    /// The open share of each tile, row by row.
    open: Vec<f32>,
    screen: Screen,
}

/// Rows of the view, in samples, about the scene's origin.
#[derive(Debug, Clone, Copy, Default)]
struct Screen {
    x: DVec4,
    y: DVec4,
    w: DVec4,
    width: i32,
    height: i32,
}

/// The tiles that a rectangle meets, and how much of each column and row of them.
struct Spans {
    columns: Range<usize>,
    rows: Range<usize>,
    x: [f32; SIDE],
    y: [f32; SIDE],
}

impl AccumulatedSolidity {
    /// Begins a view: all is open.
    pub fn begin(&mut self, view: &View, origin: DVec3) {
        self.open.clear();
        self.open.resize(SIDE * SIDE, 1.0);
        let [x, y, w, ..] = *view.rows();
        let moved = |r: DVec4| r.truncate().extend(r.w + r.truncate().dot(origin - view.eye()));
        let viewport: Viewport = view.viewport();
        self.screen = Screen {
            x: moved(x) / 256.0,
            y: moved(y) / 256.0,
            w: moved(w),
            width: viewport.width() as i32,
            height: viewport.height() as i32,
        };
    }

    /// The share of a box's rectangle that is open; of one that touches the near plane, that of the screen.
    pub fn open_share(&self, b: &ProjectedBox) -> f32 {
        let spans = self.spans(b);
        let tiles =
            spans.x[spans.columns.clone()].iter().sum::<f32>() * spans.y[spans.rows.clone()].iter().sum::<f32>();
        self.open_tiles(&spans) / tiles
    }

    /// Samples that are expected to show an object in a box, which shows these areas along the axes. If it is opaque, it stands before all
    /// that comes.
    pub fn meet(&mut self, b: &ProjectedBox, bounds: Aabb, areas: Vec3, opaque: bool) -> f32 {
        let size = bounds.size().as_dvec3();
        let sides = DVec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
        let (along, w) = self.screen.direction(bounds.center());
        let of_box = along.dot(sides);
        let rho = chance(along.dot(areas.as_dvec3()) / of_box);
        let spans = self.spans(b);
        let open = self.open_tiles(&spans) * self.screen.samples_a_tile();
        let uncut = match b.tag & (NEAR | CUT) {
            0 => Some(f64::from(b.x1 - b.x0 + 1) * f64::from(b.y1 - b.y0 + 1)),
            CUT => self.screen.samples(bounds),
            _ => None,
        };
        let Some(uncut) = uncut else { return rho * open };
        let share = rho * chance(of_box / (w * w * w).abs() / uncut);
        if opaque && share > 0.0 {
            self.close(&spans, share);
        }
        share * open
    }

    fn open_tiles(&self, spans: &Spans) -> f32 {
        // By columns: sums that do not wait for each other.
        let columns = spans.columns.clone();
        let mut sums = [0.0; SIDE];
        for y in spans.rows.clone() {
            let share = spans.y[y];
            for (sum, open) in sums[columns.clone()].iter_mut().zip(&self.row(y)[columns.clone()]) {
                *sum += share * open;
            }
        }
        spans.x[columns.clone()].iter().zip(&sums[columns]).map(|(share, sum)| share * sum).sum()
    }

    fn close(&mut self, spans: &Spans, share: f32) {
        for y in spans.rows.clone() {
            let (share, columns) = (share * spans.y[y], spans.columns.clone());
            let row = &mut self.open[y * SIDE..(y + 1) * SIDE];
            for (open, of_column) in row[columns.clone()].iter_mut().zip(&spans.x[columns]) {
                *open *= 1.0 - share * of_column;
            }
        }
    }

    fn row(&self, y: usize) -> &[f32] {
        &self.open[y * SIDE..(y + 1) * SIDE]
    }

    fn rect(&self, b: &ProjectedBox) -> SampleRect {
        if b.touches_near_plane() {
            SampleRect { x0: 0, y0: 0, x1: self.screen.width - 1, y1: self.screen.height - 1 }
        } else {
            b.rect()
        }
    }

    fn spans(&self, b: &ProjectedBox) -> Spans {
        let r = self.rect(b);
        let (columns, x) = span(r.x0, r.x1, self.screen.width);
        let (rows, y) = span(r.y0, r.y1, self.screen.height);
        Spans { columns, rows, x, y }
    }
}

impl Screen {
    fn samples_a_tile(&self) -> f32 {
        (self.width as f32 / SIDE as f32) * (self.height as f32 / SIDE as f32)
    }

    /// The way in which a point is seen, absolute values by axis, and the point's w: over w^3 it is the samples that a unit of area takes
    /// there, by the axis that it faces.
    fn direction(&self, p: Vec3) -> (DVec3, f64) {
        let p = p.as_dvec3().extend(1.0);
        let (x, y, w) = (self.x.dot(p), self.y.dot(p), self.w.dot(p));
        let [a, b, c] = [self.x, self.y, self.w].map(DVec4::truncate);
        ((b.cross(c) * x + c.cross(a) * y + a.cross(b) * w).abs(), w)
    }

    /// Samples of a box's rectangle on a screen without end; `None` for a box that reaches the plane of the eye.
    fn samples(&self, bounds: Aabb) -> Option<f64> {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in 0..8 {
            let upper = BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
            let p = Vec3::select(upper, bounds.max, bounds.min).as_dvec3().extend(1.0);
            let w = self.w.dot(p);
            if w <= 0.0 {
                return None;
            }
            let at = DVec2::new(self.x.dot(p), self.y.dot(p)) / w;
            (low, high) = (low.min(at), high.max(at));
        }
        Some((high - low).element_product())
    }
}

/// A share from 0 to 1; of what is no number, 1.
fn chance(share: f64) -> f32 {
    if share.is_nan() { 1.0 } else { share.clamp(0.0, 1.0) as f32 }
}

/// The tiles that samples `from` to `to` of `n` meet along a side, and the shares of them.
fn span(from: i32, to: i32, n: i32) -> (Range<usize>, [f32; SIDE]) {
    let scale = SIDE as f32 / n as f32;
    let (low, high) = (from as f32 * scale, (to + 1) as f32 * scale);
    let first = (low as usize).min(SIDE - 1);
    let end = (high.ceil() as usize).clamp(first + 1, SIDE);
    let mut shares = [0.0; SIDE];
    for (tile, share) in shares.iter_mut().enumerate().take(end).skip(first) {
        *share = (high.min(tile as f32 + 1.0) - low.max(tile as f32)).clamp(0.0, 1.0);
    }
    (first..end, shares)
}
