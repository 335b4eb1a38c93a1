//! The conservative levels of one closed part: fewer and fewer triangles, all inside, each level worth its triangles.
//!
//! Candidates are the part drawn in ([`inset`](super::inset)), its edge collapses ([`collapse`](super::collapse)), and
//! sheets ([`sheets`](super::sheets)); of all pairs of triangles and covered area the upper hull is kept. So from level
//! to level the area that a triangle brings falls, and one *price*, in area a triangle, chooses the levels of all parts
//! of a scene alike.

use glam::Vec3;

use super::collapse::Collapse;
use super::enclosure::Enclosure;
use super::inset::inset;
use super::sheets::{Triangle, drop_order, fins, half_axes};
use super::silhouettes::Frames;
use super::unfold::unfold;
use super::walls::without_inner_walls;

/// Triangles up to which they are dropped one by one.
const DROP: usize = 32;

/// A conservative stand-in for a closed part.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Each strictly inside the part; to be drawn from both sides.
    pub triangles: Vec<[Vec3; 3]>,
    /// Mean area that they cover, over 26 directions, sampled; in square units of the mesh.
    pub area: f64,
    /// What each triangle brings over the next coarser level: area a triangle.
    pub price: f64,
}

/// The levels of a closed part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartLevels {
    /// Triangles of the part itself.
    pub triangles: usize,
    /// Mean area that the part covers.
    pub area: f64,
    /// Mean area that one triangle inside it covers, at most.
    pub most_a_triangle: f64,
    /// From few triangles to many; the price falls. Empty where nothing fits inside.
    pub levels: Vec<Level>,
}

impl PartLevels {
    /// Of a closed, outward oriented part.
    pub(super) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> PartLevels {
        let (positions, triangles) = own(positions, triangles);
        // Two boxes that share a wall are one room: nothing could pass through the wall, though nobody sees it.
        let outer = without_inner_walls(&positions, &triangles);
        let enclosure = Enclosure::new(&positions, &outer);
        let frames = Frames::around(positions.iter().copied());
        let corners = |t: &[u32; 3]| t.map(|i| positions[i as usize]);
        let area = frames.area(&frames.cover(triangles.iter().map(corners)));
        let mut found = Candidates { frames: &frames, points: Vec::new() };
        for heap in fins(&enclosure, &positions, &outer) {
            found.offer(heap);
        }
        let start = inset(&enclosure, &positions, &unfold(&positions, &outer));
        let mut collapse = Collapse::new(&enclosure, start);
        let (mut left, mut target) = (triangles.len(), triangles.len());
        loop {
            found.offer(collapse.surface().proven().collect());
            if target <= 4 {
                break;
            }
            target = (target * 17 / 20).max(4);
            let now = collapse.run(target);
            if now == left && now > target {
                break;
            }
            left = now;
        }
        let most_a_triangle = frames.most_a_triangle(half_axes(&positions, &triangles)).min(area);
        PartLevels { triangles: triangles.len(), area, most_a_triangle, levels: found.hull() }
    }

    /// The finest level whose triangles each bring at least `price`; `None` if the part is better left out.
    pub fn at(&self, price: f64) -> Option<&Level> {
        self.levels.iter().take_while(|level| level.price >= price).last()
    }
}

/// The positions that triangles use, and the triangles with indices into them.
fn own(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let slot = |i: u32| used.partition_point(|&u| u < i) as u32;
    let triangles = triangles.iter().map(|t| t.map(slot)).collect();
    (used.iter().map(|&i| positions[i as usize]).collect(), triangles)
}

/// What was found so far.
struct Candidates<'a> {
    frames: &'a Frames,
    points: Vec<(Vec<Triangle>, f64)>,
}

impl Candidates<'_> {
    fn offer(&mut self, triangles: Vec<Triangle>) {
        if triangles.len() > DROP {
            let area = self.frames.area(&self.frames.cover(triangles.iter().copied()));
            self.points.push((triangles, area));
            return;
        }
        let order = drop_order(self.frames, &triangles);
        for (dropped, &(_, area)) in order.iter().enumerate() {
            let mut kept: Vec<usize> = order[dropped..].iter().map(|&(t, _)| t).collect();
            kept.sort_unstable();
            self.points.push((kept.into_iter().map(|t| triangles[t]).collect(), area));
        }
    }

    /// The upper hull of area over triangles, from nothing on.
    fn hull(mut self) -> Vec<Level> {
        self.points.sort_by(|p, q| p.0.len().cmp(&q.0.len()).then(q.1.total_cmp(&p.1)));
        let mut hull: Vec<Level> = Vec::new();
        for (triangles, area) in self.points {
            let last = |hull: &[Level]| hull.last().map_or((0, 0.0), |l| (l.triangles.len(), l.area));
            if area <= last(&hull).1 {
                continue;
            }
            let price = |(n, a): (usize, f64)| (area - a) / (triangles.len() - n).max(1) as f64;
            while hull.last().is_some_and(|l| l.triangles.len() == triangles.len() || price(last(&hull)) >= l.price) {
                hull.pop();
            }
            let price = price(last(&hull));
            hull.push(Level { triangles, area, price });
        }
        hull
    }
}
