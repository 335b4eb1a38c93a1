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
//! share      s   = rho min(1, samples(box) / samples(R))             of R that it covers; samples(box) = sum |J_i| side_i
//! expected   E   = s sum over R of open                              samples that are expected to show it
//! then, in each tile that R meets with the share o:  open *= 1 - s o
//! ```
//!
//! where J is the cross product of the gradients of the screen's x and y at the middle of the box: the samples that a unit of area
//! takes. The accumulated solidity of a direction is 1 - open: independent coverings multiply. Objects must come nearest first.
//! What touches the near plane has no rectangle: it may show in all that is open, and hides nothing. Nothing is drawn or
//! read back. Sums are in one order, in f32 and f64 without fused steps: equal on every machine.
//!
//! **Cost**: the tiles under each rectangle, twice.

use std::ops::Range;

use glam::{DVec3, DVec4, Vec3};

use crate::geometry::{Aabb, SampleRect};
use crate::occlusion::{CUT, ProjectedBox};
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

/// What is expected of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Expected {
    /// Samples that show it.
    pub samples: f32,
    /// The share of its rectangle that it covers; 0 of what touches the near plane.
    share: f32,
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

    /// Samples of a box's rectangle that are open; of one that touches the near plane, those of the screen.
    pub fn open_samples(&self, b: &ProjectedBox) -> f32 {
        let spans = self.spans(b);
        let row = |y: usize| {
            let tiles = &self.open[y * SIDE..(y + 1) * SIDE];
            spans.y[y] * spans.columns.clone().map(|x| spans.x[x] * tiles[x]).sum::<f32>()
        };
        let tiles: f32 = spans.rows.clone().map(row).sum();
        tiles * (self.screen.width as f32 / SIDE as f32) * (self.screen.height as f32 / SIDE as f32)
    }

    /// Samples of a box's rectangle; of one that touches the near plane, those of the screen.
    pub fn samples(&self, b: &ProjectedBox) -> f32 {
        let r = self.rect(b);
        ((r.x1 - r.x0 + 1) * (r.y1 - r.y0 + 1)) as f32
    }

    /// What is expected of an object in a box that shows these areas along the axes.
    pub fn expect(&self, b: &ProjectedBox, bounds: Aabb, areas: Vec3) -> Expected {
        let size = bounds.size().as_dvec3();
        let sides = DVec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
        let (along, w) = self.screen.direction(bounds.center());
        let of_box = along.dot(sides);
        let rho = chance(along.dot(areas.as_dvec3()) / of_box);
        let open = self.open_samples(b);
        if b.touches_near_plane() {
            return Expected { samples: rho * open, share: 0.0 };
        }
        // Of a box that the screen cuts only a part is in the rectangle.
        let cut = b.tag & CUT != 0;
        let filled = if cut { 1.0 } else { chance(of_box / (w * w * w).abs() / f64::from(self.samples(b))) };
        Expected { samples: rho * filled * open, share: rho * filled }
    }

    /// An object now stands before all that comes.
    pub fn add(&mut self, b: &ProjectedBox, expected: Expected) {
        if expected.share == 0.0 {
            return;
        }
        let spans = self.spans(b);
        for y in spans.rows.clone() {
            let share = expected.share * spans.y[y];
            let tiles = &mut self.open[y * SIDE..(y + 1) * SIDE];
            for x in spans.columns.clone() {
                tiles[x] *= 1.0 - share * spans.x[x];
            }
        }
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
    /// The way in which a point is seen, absolute values by axis, and the point's w: over w^3 it is the samples that a unit of area takes
    /// there, by the axis that it faces.
    fn direction(&self, p: Vec3) -> (DVec3, f64) {
        let p = p.as_dvec3().extend(1.0);
        let (x, y, w) = (self.x.dot(p), self.y.dot(p), self.w.dot(p));
        let [a, b, c] = [self.x, self.y, self.w].map(DVec4::truncate);
        ((b.cross(c) * x + c.cross(a) * y + a.cross(b) * w).abs(), w)
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
