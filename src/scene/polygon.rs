//! Polygons to triangles: a fan where that is right, ear clipping where it is not (Meisters 1975).
//!
//! A fan over a concave polygon fills area outside it, which would be a false occluder. Work is in the polygon's dominant
//! plane, in f64: differences of f32 coordinates are all but exact there. No vertex is left out where its corner has area,
//! so neighbours stay joined. Cost: linear for a fan; for an ear a look at the reflex vertices of the same range of x.

use glam::{DVec2, DVec3, Vec3};

/// Appends the triangles of a polygon, given by indices into `positions` (all in range), with the polygon's orientation.
/// A polygon that crosses itself still gives triangles over all its vertices; one without area gives none.
pub(crate) fn triangulate(positions: &[Vec3], polygon: &[u32], out: &mut Vec<[u32; 3]>) {
    if let [a, b, c] = *polygon {
        out.push([a, b, c]);
        return;
    }
    let mut ring = polygon.to_vec();
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    if ring.len() < 3 {
        return;
    }
    let Some(points) = project(positions, &ring) else { return };
    if fan_is_right(&points) {
        out.extend((1..ring.len() - 1).map(|i| [ring[0], ring[i], ring[i + 1]]));
    } else {
        Clipper::new(&points).clip(&mut |a, b, c| out.push([ring[a], ring[b], ring[c]]));
    }
}

/// Twice the signed area of a triangle; positive when counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The ring in the plane of its two smaller normal components, counter-clockwise; `None` when it has no normal.
fn project(positions: &[Vec3], ring: &[u32]) -> Option<Vec<DVec2>> {
    let origin = positions[ring[0] as usize].as_dvec3();
    let at = |i: usize| positions[ring[i % ring.len()] as usize].as_dvec3() - origin;
    // Newell's normal: the sum over the edges is right for bent and concave rings alike.
    let normal: DVec3 = (0..ring.len()).map(|i| at(i).cross(at(i + 1))).sum();
    let size = normal.abs();
    let widest = size.max_element();
    let usable = widest > 0.0 && widest.is_finite();
    if !usable {
        return None;
    }
    let axis = if size.z == widest { 2 } else { usize::from(size.y == widest) };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let flip = normal[axis] < 0.0;
    let flat = |i: usize| if flip { DVec2::new(at(i)[v], at(i)[u]) } else { DVec2::new(at(i)[u], at(i)[v]) };
    Some((0..ring.len()).map(flat).collect())
}

/// True when every corner and every triangle of the fan turns left.
fn fan_is_right(p: &[DVec2]) -> bool {
    let n = p.len();
    (0..n).all(|i| area(p[i], p[(i + 1) % n], p[(i + 2) % n]) > 0.0)
        && (1..n - 1).all(|i| area(p[0], p[i], p[i + 1]) > 0.0)
}

/// A ring that loses ears.
struct Clipper<'a> {
    p: &'a [DVec2],
    previous: Vec<usize>,
    next: Vec<usize>,
    present: Vec<bool>,
    /// The vertices that were not convex at first, by x: no other can ever lie in an ear.
    reflex: Vec<usize>,
}

impl<'a> Clipper<'a> {
    fn new(p: &'a [DVec2]) -> Clipper<'a> {
        let n = p.len();
        let previous: Vec<usize> = (0..n).map(|i| (i + n - 1) % n).collect();
        let next: Vec<usize> = (0..n).map(|i| (i + 1) % n).collect();
        let mut reflex: Vec<usize> = (0..n).filter(|&i| area(p[previous[i]], p[i], p[next[i]]) <= 0.0).collect();
        reflex.sort_by(|&a, &b| p[a].x.total_cmp(&p[b].x));
        Clipper { p, previous, next, present: vec![true; n], reflex }
    }

    fn corner(&self, i: usize) -> f64 {
        area(self.p[self.previous[i]], self.p[i], self.p[self.next[i]])
    }

    fn is_ear(&self, i: usize) -> bool {
        let (a, b, c) = (self.p[self.previous[i]], self.p[i], self.p[self.next[i]]);
        if area(a, b, c) <= 0.0 {
            return false;
        }
        let (low, high) = (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
        let first = self.reflex.partition_point(|&r| self.p[r].x < low);
        let near = self.reflex[first..].iter().take_while(|&&r| self.p[r].x <= high);
        // A vertex on a corner of the ear does not block it: rings with a keyhole pass such points twice.
        !near
            .filter(|&&r| self.present[r])
            .map(|&r| self.p[r])
            .any(|q| q != a && q != b && q != c && area(a, b, q) >= 0.0 && area(b, c, q) >= 0.0 && area(c, a, q) >= 0.0)
    }

    fn remove(&mut self, i: usize) {
        let (before, after) = (self.previous[i], self.next[i]);
        self.next[before] = after;
        self.previous[after] = before;
        self.present[i] = false;
    }

    fn clip(mut self, emit: &mut impl FnMut(usize, usize, usize)) {
        let (mut at, mut left, mut passed) = (0, self.p.len(), 0);
        while left > 2 {
            let found = self.is_ear(at);
            if !found && passed < left {
                (at, passed) = (self.next[at], passed + 1);
                continue;
            }
            // No ear in a whole round: the ring touches or crosses itself. A corner without area goes first.
            let victim = if found { at } else { self.flattest(at) };
            if self.corner(victim) != 0.0 {
                emit(self.previous[victim], victim, self.next[victim]);
            }
            // Two steps on: ears in turn around the ring give rounder triangles than one corner eaten up.
            at = self.next[self.next[victim]];
            self.remove(victim);
            if !self.present[at] {
                at = self.next[at];
            }
            (left, passed) = (left - 1, 0);
        }
    }

    /// The vertex with the least area at its corner; a positive one where there is a choice between signs.
    fn flattest(&self, start: usize) -> usize {
        let rank = |i: usize| {
            let corner = self.corner(i);
            (corner < 0.0, corner.abs())
        };
        let (mut best, mut at) = (start, self.next[start]);
        while at != start {
            if rank(at) < rank(best) {
                best = at;
            }
            at = self.next[at];
        }
        best
    }
}
