//! Edge collapses that never leave the solid (thesis 7.2, conservative occlusion-preserving simplification, our own
//! construction).
//!
//! Quadric error metrics (Garland and Heckbert 1997) order the collapses and propose where the corner goes; a collapse
//! is done only if every triangle that it makes or moves is proven to lie strictly inside the part ([`Enclosure`]).
//! Since it shares a corner with a triangle that is proven, *no point in common with the surface* is enough. Topology
//! is not looked after: any heap of such triangles is conservative. Invariant: triangles marked as inside are. Cost: n
//! log n collapses, each a dozen containment tests or a few dozen.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::{DMat3, DVec3, Vec3};

use super::enclosure::Enclosure;
use super::inset::Surface;

/// Places that are tried for the corner of a collapsed edge.
const PLACES: usize = 5;
/// Triangles that a collapse may move: a corner of more is left alone, so that no part costs the square of its triangles.
const MOST_MOVED: usize = 128;

/// Sum of squared distances to planes, weighted by area: v A v + 2 b v + c.
#[derive(Debug, Clone, Copy)]
struct Quadric {
    a: DMat3,
    b: DVec3,
    c: f64,
}

impl Quadric {
    const ZERO: Quadric = Quadric { a: DMat3::ZERO, b: DVec3::ZERO, c: 0.0 };

    /// Of the plane of a triangle, about an origin.
    fn plane([p, q, r]: [DVec3; 3]) -> Quadric {
        let cross = (q - p).cross(r - p);
        let area = cross.length() * 0.5;
        let n = cross.normalize_or_zero();
        let d = -n.dot(p);
        Quadric { a: DMat3::from_cols(n * n.x, n * n.y, n * n.z) * area, b: n * (d * area), c: d * d * area }
    }

    fn add(&mut self, other: &Quadric) {
        self.a += other.a;
        self.b += other.b;
        self.c += other.c;
    }

    fn error(&self, v: DVec3) -> f64 {
        (v.dot(self.a * v) + 2.0 * self.b.dot(v) + self.c).max(0.0)
    }

    /// The point of least error, if the planes determine one.
    fn best(&self) -> Option<DVec3> {
        let scale = (self.a.x_axis.x + self.a.y_axis.y + self.a.z_axis.z) / 3.0;
        let stiff = self.a.determinant() > 1e-4 * scale * scale * scale;
        stiff.then(|| self.a.inverse() * -self.b).filter(|v| v.is_finite())
    }
}

/// An edge and one of its places, waiting.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    error: f64,
    edge: [u32; 2],
    /// Versions of its ends when it was judged; older ones are out of date.
    versions: [u32; 2],
    /// Which of its places, from the least error up.
    place: usize,
}

impl Candidate {
    fn key(&self) -> (u64, [u32; 2], usize) {
        // Errors are not negative, so their bits are in order.
        (self.error.to_bits(), self.edge, self.place)
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Candidate) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Candidate) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    /// The least error is the greatest, for the heap.
    fn cmp(&self, other: &Candidate) -> Ordering {
        other.key().cmp(&self.key())
    }
}

/// A surface that is being simplified inside its part.
pub(super) struct Collapse<'a> {
    enclosure: &'a Enclosure,
    surface: Surface,
    alive: Vec<bool>,
    /// Triangles around each corner, dead ones among them.
    around: Vec<Vec<u32>>,
    quadrics: Vec<Quadric>,
    versions: Vec<u32>,
    heap: BinaryHeap<Candidate>,
    left: usize,
    origin: DVec3,
}

impl<'a> Collapse<'a> {
    pub fn new(enclosure: &'a Enclosure, surface: Surface) -> Collapse<'a> {
        let [min, max] = enclosure.bounds();
        let (corners, triangles) = (surface.positions.len(), surface.triangles.len());
        let mut collapse = Collapse {
            enclosure,
            alive: vec![true; triangles],
            around: vec![Vec::new(); corners],
            quadrics: vec![Quadric::ZERO; corners],
            versions: vec![0; corners],
            heap: BinaryHeap::new(),
            left: triangles,
            origin: (min + max) * 0.5,
            surface,
        };
        let mut edges = Vec::new();
        for t in 0..triangles {
            let corners = collapse.surface.triangles[t];
            let quadric = Quadric::plane(corners.map(|i| collapse.at(i)));
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                collapse.around[corners[i] as usize].push(t as u32);
                collapse.quadrics[corners[i] as usize].add(&quadric);
                edges.push([corners[i].min(corners[j]), corners[i].max(corners[j])]);
            }
        }
        edges.sort_unstable();
        edges.dedup();
        edges.into_iter().for_each(|edge| collapse.offer(edge, 0));
        collapse
    }

    /// Collapses until at most `target` triangles are left, or none can be; says how many are.
    pub fn run(&mut self, target: usize) -> usize {
        while self.left > target {
            let Some(next) = self.heap.pop() else { break };
            if next.versions != next.edge.map(|i| self.versions[i as usize]) {
                continue;
            }
            let place = self.places(next.edge)[next.place].1;
            if self.may(next.edge, place) {
                self.collapse(next.edge, place);
            } else if next.place + 1 < PLACES {
                self.offer(next.edge, next.place + 1);
            }
        }
        self.left
    }

    /// What is there now.
    pub fn surface(&self) -> Surface {
        let kept = || (0..self.alive.len()).filter(|&t| self.alive[t]);
        Surface {
            positions: self.surface.positions.clone(),
            triangles: kept().map(|t| self.surface.triangles[t]).collect(),
            inside: kept().map(|t| self.surface.inside[t]).collect(),
        }
    }

    fn at(&self, i: u32) -> DVec3 {
        self.surface.positions[i as usize].as_dvec3() - self.origin
    }

    fn offer(&mut self, edge: [u32; 2], place: usize) {
        let error = self.places(edge)[place].0;
        if error.is_finite() {
            let versions = edge.map(|i| self.versions[i as usize]);
            self.heap.push(Candidate { error, edge, versions, place });
        }
    }

    /// Where the corner of a collapsed edge may go, from the least error up.
    fn places(&self, [a, b]: [u32; 2]) -> [(f64, Vec3); PLACES] {
        let mut quadric = self.quadrics[a as usize];
        quadric.add(&self.quadrics[b as usize]);
        let (p, q) = (self.at(a), self.at(b));
        let middle = (p + q) * 0.5;
        let best = quadric.best().filter(|v| v.distance(middle) <= 2.0 * p.distance(q)).unwrap_or(middle);
        let rounded = |v: DVec3| {
            let v = (v + self.origin).as_vec3();
            (quadric.error(v.as_dvec3() - self.origin), v)
        };
        let ends = [a, b].map(|i| (quadric.error(self.at(i)), self.surface.positions[i as usize]));
        let mut places = [ends[0], ends[1], rounded(best), rounded((best + middle) * 0.5), rounded(middle)];
        places.sort_by(|x, y| x.0.total_cmp(&y.0));
        places
    }

    /// Triangles that stay when an edge goes.
    fn moved(&self, [a, b]: [u32; 2]) -> impl Iterator<Item = u32> + '_ {
        let both = self.around[a as usize].iter().chain(&self.around[b as usize]).copied();
        both.filter(move |&t| {
            let corners = self.surface.triangles[t as usize];
            self.alive[t as usize] && !(corners.contains(&a) && corners.contains(&b))
        })
    }

    /// Whether all triangles stay proven, none turns over and none becomes a needle of no area.
    fn may(&self, edge: [u32; 2], place: Vec3) -> bool {
        let moved_corners = |t: u32| {
            self.surface.triangles[t as usize]
                .map(|i| if edge.contains(&i) { place } else { self.surface.positions[i as usize] })
        };
        let normal = |t: [Vec3; 3]| {
            let [a, b, c] = t.map(Vec3::as_dvec3);
            (b - a).cross(c - a)
        };
        let keeps_side = |t: u32| {
            let (old, new) =
                (normal(self.surface.corners(self.surface.triangles[t as usize])), normal(moved_corners(t)));
            old.dot(new) > 0.1 * old.length() * new.length()
        };
        let proven = |t: u32| {
            let corners = moved_corners(t);
            self.enclosure.misses(corners)
        };
        let anchored = self.moved(edge).any(|t| self.surface.inside[t as usize])
            || self.enclosure.winding(place).is_some_and(|w| w >= 1);
        let few = self.moved(edge).nth(MOST_MOVED).is_none();
        few && anchored && self.moved(edge).all(keeps_side) && self.moved(edge).all(proven)
    }

    fn collapse(&mut self, [a, b]: [u32; 2], place: Vec3) {
        let moved: Vec<u32> = self.moved([a, b]).collect();
        for &t in self.around[a as usize].iter().chain(&self.around[b as usize]) {
            let corners = self.surface.triangles[t as usize];
            if self.alive[t as usize] && corners.contains(&a) && corners.contains(&b) {
                self.alive[t as usize] = false;
                self.left -= 1;
            }
        }
        self.surface.positions[a as usize] = place;
        let gone = self.quadrics[b as usize];
        self.quadrics[a as usize].add(&gone);
        for &t in &moved {
            self.surface.inside[t as usize] = true;
            self.surface.triangles[t as usize].iter_mut().filter(|i| **i == b).for_each(|i| *i = a);
        }
        self.around[b as usize].clear();
        self.around[a as usize] = moved;
        self.versions[b as usize] += 1;
        self.versions[a as usize] += 1;
        let triangles = self.around[a as usize].iter().map(|&t| self.surface.triangles[t as usize]);
        let mut neighbours: Vec<u32> = triangles.flatten().filter(|&i| i != a).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours.into_iter().for_each(|i| self.offer([a.min(i), a.max(i)], 0));
    }
}
