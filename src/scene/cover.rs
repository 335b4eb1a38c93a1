//! Proof that opaque triangles cover a rectangle of an axis-aligned plane, from both sides.
//!
//! Triangles whose corners have the very coordinate of the plane are turned counter-clockwise; the number of them over a point is then the
//! winding number of their edges (only ever too small, should a sliver be turned wrongly). The rectangle is cut into a grid along
//! the ends of these edges. Edges along the axes lie on grid lines, so that no cell is cut by one and T-junctions do not matter. Of the
//! others, those that two triangles share cancel; a cell that one of the rest may touch counts as open. So what is
//! not listed as open is covered, point for point. Cost: rows of the grid times edges.

use std::collections::HashMap;

use glam::DVec3;

use super::{Facing, PlacedTriangles, PreparedScene};

/// A point of a plane: along the axis after its own, and the one after that.
pub(super) type Point = [f64; 2];

/// A rectangle of a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rect {
    pub min: Point,
    pub max: Point,
}

impl Rect {
    pub fn area(&self) -> f64 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }

    /// The rectangle around this and another.
    pub fn around(&self, other: &Rect) -> Rect {
        Rect { min: [0, 1].map(|k| self.min[k].min(other.min[k])), max: [0, 1].map(|k| self.max[k].max(other.max[k])) }
    }
}

/// A triangle in a plane, counter-clockwise, and the sides that it is seen from: 1 from above, 2 from below.
#[derive(Debug, Clone, Copy)]
pub(super) struct Flat {
    pub corners: [Point; 3],
    pub sides: u8,
}

/// Grid lines of a rectangle in each direction, at most: beyond it nothing is claimed.
const LINES: usize = 800;
/// Open rectangles of a face, at most: of more, the one around them is taken.
const OPEN: usize = 4;
/// Two open rectangles are joined when the part of the whole that was not open is at most this.
const WASTE: f64 = 0.25;
/// What slanted edges count as wider than they are, of the size of their coordinates.
const SLANTED: f64 = 1e-9;

/// The opaque triangles of a scene that lie in some axis-aligned planes, about the scene's origin.
pub(super) struct Walls {
    /// By axis and the bits of the plane's place.
    planes: [HashMap<u64, Vec<Flat>>; 3],
}

/// The area of the opaque triangles in each axis-aligned plane of a scene, those of one side half: area, axis and place about the
/// scene's origin, in no order.
pub(super) fn plane_areas(scene: &PreparedScene) -> Vec<(f64, usize, f64)> {
    let mut areas: [HashMap<u64, f64>; 3] = Default::default();
    each_flat(scene, |axis, at, flat| {
        *areas[axis].entry(key(at)).or_insert(0.0) += flat.area() * flat.share();
    });
    let list = |(axis, of): (usize, HashMap<u64, f64>)| {
        of.into_iter().map(move |(bits, area)| (area, axis, f64::from_bits(bits)))
    };
    areas.into_iter().enumerate().flat_map(list).collect()
}

/// Calls with every opaque triangle that lies in an axis-aligned plane: axis, place, the triangle.
fn each_flat(scene: &PreparedScene, mut found: impl FnMut(usize, f64, Flat)) {
    let mut placed = PlacedTriangles::new(scene);
    for (object, occluder) in (0..).zip(&scene.occluders) {
        if !occluder.opaque || !scene.bounds[object as usize].is_finite() {
            continue;
        }
        placed.load(object);
        for triangle in 0..scene.triangles(object) {
            let corners = placed.get(object, triangle);
            let [a, b, c] = corners;
            let Some(axis) = (0..3).find(|&k| a[k] == b[k] && b[k] == c[k]) else { continue };
            if let Some(flat) = flat(corners, axis, occluder.facing) {
                found(axis, a[axis], flat);
            }
        }
    }
}

impl Walls {
    /// Looks at every triangle for those in planes at given places along each axis.
    pub fn new(scene: &PreparedScene, places: &[Vec<f64>; 3]) -> Walls {
        let empty = |of: &Vec<f64>| of.iter().map(|&at| (key(at), Vec::new())).collect();
        let mut planes: [HashMap<u64, Vec<Flat>>; 3] = [0, 1, 2].map(|k| empty(&places[k]));
        each_flat(scene, |axis, at, flat| {
            if let Some(flats) = planes[axis].get_mut(&key(at)) {
                flats.push(flat);
            }
        });
        Walls { planes }
    }

    /// The triangles in a plane.
    pub fn at(&self, axis: usize, at: f64) -> &[Flat] {
        self.planes[axis].get(&key(at)).map_or(&[], Vec::as_slice)
    }

    /// Rectangles that together hold every point of a rectangle which is not covered, from one side or the other.
    pub fn open_parts(&self, axis: usize, at: f64, rect: Rect) -> Vec<Rect> {
        let near: Vec<&Flat> = self.at(axis, at).iter().filter(|f| meets(&f.corners, &rect)).collect();
        if near.is_empty() {
            return vec![rect];
        }
        let edges = [1, 2].map(|side| edges(near.iter().filter(|f| f.sides & side != 0).map(|f| &f.corners)));
        let lines = [0, 1].map(|k| {
            let ends = edges.iter().flatten().flat_map(|(a, b)| [a[k], b[k]]);
            let mut lines: Vec<f64> = ends.filter(|&p| rect.min[k] < p && p < rect.max[k]).collect();
            lines.extend([rect.min[k], rect.max[k]]);
            lines.sort_by(f64::total_cmp);
            lines.dedup();
            lines
        });
        if lines.iter().any(|l| l.len() > LINES) {
            return vec![rect];
        }
        let mut open = vec![false; (lines[0].len() - 1) * (lines[1].len() - 1)];
        edges.iter().for_each(|edges| mark_open(edges, &lines, &mut open));
        rectangles(&lines, open)
    }
}

/// The bits of a place; both zeros are one.
fn key(at: f64) -> u64 {
    (at + 0.0).to_bits()
}

/// A triangle as it lies in a plane; `None` without area.
fn flat(corners: [DVec3; 3], axis: usize, facing: Facing) -> Option<Flat> {
    let [a, b, c] = corners.map(|p| [p[(axis + 1) % 3], p[(axis + 2) % 3]]);
    let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let up = twice > 0.0;
    let sides = match facing {
        Facing::Both => 3,
        Facing::Front => 2 - u8::from(up),
        Facing::Back => 1 + u8::from(up),
    };
    (twice != 0.0).then_some(Flat { corners: if up { [a, b, c] } else { [a, c, b] }, sides })
}

impl Flat {
    fn area(&self) -> f64 {
        let [a, b, c] = self.corners;
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    }

    /// How much of a wall it is: half of one when it is seen from one side alone.
    pub fn share(&self) -> f64 {
        f64::from(self.sides.count_ones()) * 0.5
    }

    /// The rectangle around it.
    pub fn around(&self) -> Rect {
        let [a, b, c] = self.corners;
        Rect { min: [0, 1].map(|k| a[k].min(b[k]).min(c[k])), max: [0, 1].map(|k| a[k].max(b[k]).max(c[k])) }
    }
}

fn meets(corners: &[Point; 3], rect: &Rect) -> bool {
    (0..2).all(|k| {
        let [a, b, c] = corners.map(|p| p[k]);
        a.min(b).min(c) < rect.max[k] && a.max(b).max(c) > rect.min[k]
    })
}

/// The edges of triangles, without slanted ones that are there in both directions.
fn edges<'a>(triangles: impl Iterator<Item = &'a [Point; 3]>) -> Vec<(Point, Point)> {
    let (mut out, mut slanted) = (Vec::new(), HashMap::new());
    let bits = |p: Point| p.map(|v| (v + 0.0).to_bits());
    for [a, b, c] in triangles {
        for (p, q) in [(*a, *b), (*b, *c), (*c, *a)] {
            if p[0] == q[0] || p[1] == q[1] {
                out.push((p, q));
                continue;
            }
            let opposite = (bits(q), bits(p));
            match slanted.get_mut(&opposite) {
                Some((count, _)) if *count > 0 => *count -= 1,
                _ => slanted.entry((bits(p), bits(q))).or_insert((0, (p, q))).0 += 1,
            }
        }
    }
    let mut left: Vec<_> = slanted.into_values().flat_map(|(count, edge)| vec![edge; count]).collect();
    left.sort_by(|(a, b), (c, d)| {
        let order = [a[0].total_cmp(&c[0]), a[1].total_cmp(&c[1]), b[0].total_cmp(&d[0]), b[1].total_cmp(&d[1])];
        order.into_iter().fold(std::cmp::Ordering::Equal, |a, b| a.then(b))
    });
    out.extend(left);
    out
}

/// Marks the cells of a grid, row by row, that edges do not prove covered.
fn mark_open(edges: &[(Point, Point)], lines: &[Vec<f64>; 2], open: &mut [bool]) {
    let [xs, ys] = lines;
    let columns = xs.len() - 1;
    let mut steps = vec![0i32; columns + 1];
    for row in 0..ys.len() - 1 {
        let (y0, y1) = (ys[row], ys[row + 1]);
        steps.fill(0);
        let cells = &mut open[row * columns..(row + 1) * columns];
        for &(a, b) in edges {
            let (low, high) = if a[1] < b[1] { (a, b) } else { (b, a) };
            // Ends are grid lines or outside: an edge that enters the row goes through it.
            if low[1] > y0 || high[1] < y1 {
                continue;
            }
            let (x0, x1) = if a[0] == b[0] { (a[0], a[0]) } else { crossing(low, high, y0, y1) };
            // Cells wholly left of it, and those not wholly right of it.
            let left = xs.partition_point(|&x| x <= x0).saturating_sub(1);
            let right = xs.partition_point(|&x| x < x1).min(columns);
            if a[0] != b[0] {
                cells[left.min(columns)..right.max(left.min(columns))].fill(true);
            }
            steps[left.min(columns)] += if b[1] > a[1] { 1 } else { -1 };
        }
        // The winding number of a cell counts the edges to its right.
        let mut winding = 0;
        for column in (0..columns).rev() {
            winding += steps[column + 1];
            cells[column] |= winding < 1;
        }
    }
}

/// The range of x of a slanted edge between two heights, widened, but not beyond its ends.
fn crossing(low: Point, high: Point, y0: f64, y1: f64) -> (f64, f64) {
    let at = |y: f64| low[0] + (high[0] - low[0]) * ((y - low[1]) / (high[1] - low[1]));
    let (p, q) = (at(y0), at(y1));
    let wide = SLANTED * (low[0].abs().max(high[0].abs()) + low[1].abs().max(high[1].abs()));
    ((p.min(q) - wide).max(low[0].min(high[0])), (p.max(q) + wide).min(low[0].max(high[0])))
}

/// The marked cells of a grid as a few rectangles that hold them all.
fn rectangles(lines: &[Vec<f64>; 2], mut open: Vec<bool>) -> Vec<Rect> {
    let [columns, rows] = [lines[0].len() - 1, lines[1].len() - 1];
    let mut out: Vec<Rect> = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            if !open[row * columns + column] {
                continue;
            }
            let end = (column..columns).find(|&c| !open[row * columns + c]).unwrap_or(columns);
            let whole = |r: usize| open[r * columns + column..r * columns + end].iter().all(|&o| o);
            let bottom = (row..rows).find(|&r| !whole(r)).unwrap_or(rows);
            (row..bottom).for_each(|r| open[r * columns + column..r * columns + end].fill(false));
            out.push(Rect { min: [lines[0][column], lines[1][row]], max: [lines[0][end], lines[1][bottom]] });
            join_cheapest(&mut out);
        }
    }
    out
}

/// Joins the two rectangles whose joining adds the least area, while that is little or there are more than [`OPEN`].
fn join_cheapest(rects: &mut Vec<Rect>) {
    loop {
        let mut best: Option<(f64, usize, usize)> = None;
        for (i, a) in rects.iter().enumerate() {
            for (j, b) in rects.iter().enumerate().take(i) {
                let around = a.around(b).area();
                let added = around - a.area() - b.area();
                let wanted = rects.len() > OPEN || added <= around * WASTE;
                if wanted && best.is_none_or(|(least, ..)| added < least) {
                    best = Some((added, j, i));
                }
            }
        }
        let Some((_, i, j)) = best else { return };
        let other = rects.swap_remove(j);
        rects[i] = rects[i].around(&other);
    }
}

/// The area of the part of a triangle in a rectangle.
pub(super) fn area_within(corners: &[Point; 3], rect: &Rect) -> f64 {
    let mut points: Vec<Point> = corners.to_vec();
    for k in 0..2 {
        for (sign, bound) in [(1.0, rect.min[k]), (-1.0, rect.max[k])] {
            let side = |p: &Point| (p[k] - bound) * sign;
            let mut out = Vec::with_capacity(points.len() + 1);
            for (i, p) in points.iter().enumerate() {
                let last = &points[(i + points.len() - 1) % points.len()];
                let (a, b) = (side(last), side(p));
                if (a < 0.0) != (b < 0.0) {
                    let t = a / (a - b);
                    out.push([0, 1].map(|c| last[c] + t * (p[c] - last[c])));
                }
                if b >= 0.0 {
                    out.push(*p);
                }
            }
            points = out;
        }
    }
    let twice = |i: usize| {
        let (p, q) = (points[i], points[(i + 1) % points.len()]);
        p[0] * q[1] - p[1] * q[0]
    };
    (0..points.len()).map(twice).sum::<f64>() * 0.5
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    /// Whether a point lies in a triangle, by three signs.
    fn within(p: Point, t: &[Point; 3]) -> bool {
        let left = |a: Point, b: Point| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0.0;
        left(t[0], t[1]) && left(t[1], t[2]) && left(t[2], t[0])
    }

    fn walls(triangles: &[[Point; 3]]) -> Walls {
        let turned = triangles.iter().filter_map(|t| flat(t.map(|p| DVec3::new(0.5, p[0], p[1])), 0, Facing::Both));
        let mut planes: [HashMap<u64, Vec<Flat>>; 3] = Default::default();
        planes[0].insert(key(0.5), turned.collect());
        Walls { planes }
    }

    #[test]
    fn a_wall_with_a_door_is_open_at_the_door() {
        let quad =
            |x0: f64, y0: f64, x1: f64, y1: f64| [[[x0, y0], [x1, y0], [x1, y1]], [[x0, y0], [x1, y1], [x0, y1]]];
        // Left, right and above of the door, with T-junctions.
        let parts = [quad(0.0, 0.0, 2.0, 3.0), quad(3.0, 0.0, 5.0, 3.0), quad(1.5, 2.0, 3.0, 3.0)].concat();
        let rect = |x0, y0, x1, y1| Rect { min: [x0, y0], max: [x1, y1] };
        let walls = walls(&parts);
        assert_eq!(walls.open_parts(0, 0.5, rect(0.0, 0.0, 5.0, 3.0)), [rect(2.0, 0.0, 3.0, 2.0)]);
        assert_eq!(walls.open_parts(0, 0.5, rect(0.5, 0.0, 1.5, 3.0)), []);
        assert_eq!(walls.open_parts(0, 0.5, rect(4.0, 1.0, 6.0, 2.0)), [rect(5.0, 1.0, 6.0, 2.0)]);
        assert_eq!(walls.open_parts(0, 0.25, rect(0.0, 0.0, 5.0, 3.0)), [rect(0.0, 0.0, 5.0, 3.0)]);
    }

    #[test]
    fn what_is_not_open_is_covered() {
        let mut r = Random::keyed(1, 1);
        let mut covered = 0;
        for round in 0..400 {
            // On a coarse grid, so that edges and corners meet; half of them as the two halves of rectangles.
            let point = |r: &mut Random| [r.below(7) as f64, r.below(7) as f64];
            let mut triangles = Vec::new();
            for _ in 0..1 + r.below(12) {
                let (a, b, c) = (point(&mut r), point(&mut r), point(&mut r));
                if r.chance(0.5) {
                    triangles.extend([[a, [b[0], a[1]], b], [a, b, [a[0], b[1]]]]);
                } else {
                    triangles.push([a, b, c]);
                }
            }
            let walls = walls(&triangles);
            let rect = Rect { min: [1.0, 0.5], max: [5.5, 6.0] };
            let open = walls.open_parts(0, 0.5, rect);
            for _ in 0..300 {
                let p = [r.range(rect.min[0], rect.max[0]), r.range(rect.min[1], rect.max[1])];
                let is_open = open.iter().any(|o| (0..2).all(|k| o.min[k] <= p[k] && p[k] <= o.max[k]));
                let hit = walls.at(0, 0.5).iter().any(|f| within(p, &f.corners));
                assert!(is_open || hit, "round {round}: {p:?} is neither open nor covered");
                covered += u32::from(!is_open);
            }
        }
        assert!(covered > 5_000, "{covered}");
    }

    #[test]
    fn joined_rectangles_hold_all_that_they_were_made_of() {
        let mut r = Random::keyed(2, 1);
        for _ in 0..200 {
            let lines = [0, 1].map(|_| (0..9).map(f64::from).collect::<Vec<_>>());
            let open: Vec<bool> = (0..64).map(|_| r.chance(0.4)).collect();
            let rects = rectangles(&lines, open.clone());
            assert!(rects.len() <= OPEN);
            for (i, _) in open.iter().enumerate().filter(|(_, o)| **o) {
                let (u, v) = ((i % 8) as f64 + 0.5, (i / 8) as f64 + 0.5);
                assert!(rects.iter().any(|q| q.min[0] < u && u < q.max[0] && q.min[1] < v && v < q.max[1]));
            }
        }
    }
}
