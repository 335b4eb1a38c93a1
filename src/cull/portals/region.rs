//! Convex regions of the screen: what of it one looks through into a cell.
//!
//! In subpixels from the top left, f64. Regions are only ever cut by lines that have been moved outwards by what snapping and
//! rounding may move an edge; what a region cannot hold, it leaves uncut.

use glam::{DVec3, DVec4};

/// Corners of a region, at most: one more for every second line or so that cuts it.
const MOST: usize = 16;
/// How far outside a region an object's vertices may be drawn by snapping alone, in subpixels: half, and as much again.
const SNAP: f64 = 1.0;
/// Edges shorter than this have no direction worth testing, in subpixels: what they would cut off is left in.
const SHORT: f64 = 0.25;
/// Subpixels of a sample.
const SAMPLE: f64 = 256.0;

/// A convex polygon with at least three corners, turning from x to y.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    points: [[f64; 2]; MOST],
    len: usize,
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Region {
    /// A rectangle.
    pub fn rectangle(low: [f64; 2], high: [f64; 2]) -> Region {
        let mut points = [[0.0; 2]; MOST];
        points[..4].copy_from_slice(&[low, [high[0], low[1]], high, [low[0], high[1]]]);
        Region { points, len: 4, low, high }
    }

    fn of(points: [[f64; 2]; MOST], len: usize) -> Region {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in &points[..len] {
            for k in 0..2 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        Region { points, len, low, high }
    }

    /// The rectangle around it.
    pub fn around(&self) -> Region {
        Region::rectangle(self.low, self.high)
    }

    /// The part where `line.x x + line.y y + line.z` is at least 0; `None` when nothing is left of it.
    pub fn cut(&self, line: DVec3) -> Option<Region> {
        let side = |p: &[f64; 2]| line.x * p[0] + line.y * p[1] + line.z;
        let points = &self.points[..self.len];
        let outside = points.iter().filter(|p| side(p) < 0.0).count();
        if outside == 0 {
            return Some(*self);
        }
        let (mut out, mut len) = ([[0.0; 2]; MOST], 0);
        let mut push = |p: [f64; 2]| {
            if len < MOST {
                out[len] = p;
            }
            len += 1;
        };
        let mut last = points[self.len - 1];
        let mut at_last = side(&last);
        for &p in points {
            let at = side(&p);
            if (at_last < 0.0) != (at < 0.0) {
                let t = at_last / (at_last - at);
                push([last[0] + t * (p[0] - last[0]), last[1] + t * (p[1] - last[1])]);
            }
            if at >= 0.0 {
                push(p);
            }
            (last, at_last) = (p, at);
        }
        match len {
            0..=2 => None,
            _ if len > MOST => Some(*self),
            _ => Some(Region::of(out, len)),
        }
    }

    /// Whether all of another region is in this one.
    pub fn contains(&self, other: &Region) -> bool {
        let in_box = |k: usize| self.low[k] <= other.low[k] && other.high[k] <= self.high[k];
        let inside = |a: [f64; 2], b: [f64; 2]| {
            let left = |p: &[f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0.0;
            other.points[..other.len].iter().all(left)
        };
        in_box(0) && in_box(1) && (0..self.len).all(|i| inside(self.points[i], self.points[(i + 1) % self.len]))
    }

    /// The rectangle around this and another region, grown to whole samples: so it can grow only so often.
    pub fn join(&self, other: &Region) -> Region {
        let low = [0, 1].map(|k| (self.low[k].min(other.low[k]) / SAMPLE).floor() * SAMPLE);
        let high = [0, 1].map(|k| (self.high[k].max(other.high[k]) / SAMPLE).ceil() * SAMPLE);
        Region::rectangle(low, high)
    }
}

/// The planes through the eye and the edges of a region: what boxes are tested against.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edges {
    rows: [DVec4; MOST],
    /// How much each row takes of the screen rows x and y, without sign.
    shares: [[f64; 2]; MOST],
    len: usize,
}

impl Edges {
    /// The edges of a region, as rows over (point - eye, 1) that are at least 0 inside; `x`, `y`, `w` are the view's.
    pub fn new(region: &Region, [x, y, w]: [DVec4; 3]) -> Edges {
        let mut edges = Edges { rows: [DVec4::ZERO; MOST], shares: [[0.0; 2]; MOST], len: 0 };
        for i in 0..region.len {
            let (a, b) = (region.points[i], region.points[(i + 1) % region.len]);
            let d = [b[0] - a[0], b[1] - a[1]];
            let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
            if length < SHORT {
                continue;
            }
            let n = [-d[1] / length, d[0] / length];
            let shares = n.map(f64::abs);
            let constant = SNAP * (shares[0] + shares[1]) - (n[0] * a[0] + n[1] * a[1]);
            edges.rows[edges.len] = x * n[0] + y * n[1] + w * constant;
            edges.shares[edges.len] = shares;
            edges.len += 1;
        }
        edges
    }

    /// Whether a box, about the eye, may be drawn in the region; `slack` is what rounding may move its vertices along x and y, in
    /// subpixels times w.
    pub fn may_meet(&self, min: DVec3, max: DVec3, slack: [f64; 2]) -> bool {
        let greatest = |row: &DVec4| {
            let way = row.truncate();
            way.dot(DVec3::select(way.cmplt(DVec3::ZERO), min, max)) + row.w
        };
        let rows = self.rows[..self.len].iter().zip(&self.shares);
        rows.into_iter().all(|(row, s)| {
            let most = greatest(row) + s[0] * slack[0] + s[1] * slack[1];
            // What is no number is not known to be outside.
            most >= 0.0 || most.is_nan()
        })
    }
}
