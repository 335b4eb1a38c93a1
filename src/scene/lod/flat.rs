//! Coplanar merging: fewer triangles for the same set of points (SEMANTICS, *What "conservative" covers*).
//!
//! A corner goes if its neighbours fill the same flat region without it: in one plane, all
//! around it (an *inner* corner), or on a straight edge between two planes or along a border (an *outline* corner). All
//! of that is decided exactly, so nothing moves. Without an outline corner dropped, regions keep every corner of their
//! outlines, and the result covers the same samples wherever the original does not fold by snapping; with one dropped,
//! samples within 1/256 pixel of an original edge may differ. Cost: linear in corners times the square of their
//! neighbours.

use glam::{DVec3, Vec3};

use super::super::polygon::triangulate;
use super::predicates::{side, turn};

/// Triangles around a corner that may go; with more it stays.
const MOST_AROUND: usize = 64;

/// How much is merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Merge {
    /// Inner corners alone: sample-exact.
    Inner,
    /// Outline corners on straight edges as well: the same set of points.
    Outline,
}

/// Merged triangles, and whether a corner of an outline was dropped.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Merged {
    /// Corners into the same positions.
    pub triangles: Vec<[u32; 3]>,
    /// Inner corners that went.
    pub inner: usize,
    /// Outline corners that went.
    pub outline: usize,
}

/// Merges coplanar neighbours. Triangles are corners into `positions`, none with two equal ones.
pub fn merge_coplanar(positions: &[Vec3], triangles: &[[u32; 3]], merge: Merge) -> Merged {
    let mut work = Work {
        positions,
        triangles: triangles.iter().map(|&t| Some(t)).collect(),
        around: vec![Vec::new(); positions.len()],
    };
    for (t, corners) in triangles.iter().enumerate() {
        corners.iter().for_each(|&i| work.around[i as usize].push(t as u32));
    }
    let mut merged = Merged::default();
    let mut queue: Vec<u32> = (0..positions.len() as u32).rev().collect();
    let mut waiting = vec![true; positions.len()];
    while let Some(v) = queue.pop() {
        waiting[v as usize] = false;
        let Some(removal) = work.removal(v, merge) else { continue };
        match removal.outline {
            true => merged.outline += 1,
            false => merged.inner += 1,
        }
        for i in work.apply(v, removal) {
            if !waiting[i as usize] {
                waiting[i as usize] = true;
                queue.push(i);
            }
        }
    }
    merged.triangles = work.triangles.into_iter().flatten().collect();
    merged
}

/// A corner's triangles without it.
struct Removal {
    instead: Vec<[u32; 3]>,
    outline: bool,
}

struct Work<'a> {
    positions: &'a [Vec3],
    triangles: Vec<Option<[u32; 3]>>,
    around: Vec<Vec<u32>>,
}

impl Work<'_> {
    fn at(&self, i: u32) -> DVec3 {
        self.positions[i as usize].as_dvec3()
    }

    /// How corner `v` may go, if it may.
    fn removal(&self, v: u32, merge: Merge) -> Option<Removal> {
        let (link, closed) = self.link(v)?;
        if closed {
            let around: Vec<u32> = link.iter().chain(&link[..1]).copied().collect();
            if let Some(axis) = self.flat(v, &around) {
                let instead = self.fill(v, &link, axis);
                return instead.map(|instead| Removal { instead, outline: false });
            }
        }
        if merge == Merge::Inner {
            return None;
        }
        let instead = if closed { self.crease(v, &link) } else { self.border(v, &link) };
        instead.map(|instead| Removal { instead, outline: true })
    }

    /// The neighbours of `v` in order, and whether they go all around it; `None` unless its triangles form one fan.
    fn link(&self, v: u32) -> Option<(Vec<u32>, bool)> {
        if self.around[v as usize].len() > MOST_AROUND {
            return None;
        }
        let mut next: Vec<(u32, u32)> = Vec::new();
        for &t in &self.around[v as usize] {
            let corners = self.triangles[t as usize]?;
            let k = corners.iter().position(|&i| i == v)?;
            next.push((corners[(k + 1) % 3], corners[(k + 2) % 3]));
        }
        let starts: Vec<u32> = next.iter().map(|e| e.0).filter(|&a| next.iter().all(|e| e.1 != a)).collect();
        let closed = starts.is_empty();
        let first = *starts.first().or(next.first().map(|e| &e.0))?;
        let mut link = vec![first];
        for _ in 0..next.len() {
            let last = link[link.len() - 1];
            let mut onward = next.iter().filter(|e| e.0 == last);
            let (edge, fork) = (onward.next()?, onward.next());
            if fork.is_some() {
                return None;
            }
            link.push(edge.1);
        }
        if closed {
            (link.pop()? == first).then_some(())?;
        }
        let mut distinct = link.clone();
        distinct.sort_unstable();
        distinct.dedup();
        (distinct.len() == link.len() && link.len() >= 2 + usize::from(closed)).then_some((link, closed))
    }

    /// The axis along which the triangles `v`, a, b of consecutive neighbours project to triangles that all turn the
    /// same way, if they lie in one plane.
    fn flat(&self, v: u32, neighbours: &[u32]) -> Option<usize> {
        let plane = [self.at(v), self.at(neighbours[0]), self.at(neighbours[1])];
        if neighbours.iter().any(|&i| side(plane, self.at(i)) != 0) {
            return None;
        }
        let normal = (plane[1] - plane[0]).cross(plane[2] - plane[0]).abs().to_array();
        let axis = (0..3).max_by(|&i, &j| normal[i].total_cmp(&normal[j]))?;
        let turn = self.turn(v, neighbours[0], neighbours[1], axis);
        let alike = neighbours.windows(2).all(|e| self.turn(v, e[0], e[1], axis) == turn);
        (turn != 0 && alike).then_some(axis)
    }

    /// Which way a triangle turns, seen along an axis: 1, -1, or 0 for none.
    fn turn(&self, a: u32, b: u32, c: u32, axis: usize) -> i32 {
        turn(self.at(a), self.at(b), self.at(c), axis)
    }

    /// The ring of neighbours filled without `v`, by triangles that turn as those around `v` do.
    ///
    /// Then it is the same set of points: the edges that do not cancel are the same, so either set of triangles covers a point
    /// as often as the ring winds about it.
    fn fill(&self, v: u32, ring: &[u32], axis: usize) -> Option<Vec<[u32; 3]>> {
        let turn = self.turn(v, ring[0], ring[1], axis);
        let alike = |t: &[u32; 3]| self.turn(t[0], t[1], t[2], axis) == turn;
        let n = ring.len();
        let fan = |k: usize| -> Vec<[u32; 3]> {
            (1..n - 1).map(|i| [ring[k], ring[(k + i) % n], ring[(k + i + 1) % n]]).collect()
        };
        let by_ears = || {
            let mut ears = Vec::new();
            triangulate(self.positions, ring, &mut ears);
            (ears.len() == n - 2).then_some(ears)
        };
        let fans = (0..n).map(fan).find(|fan| fan.iter().all(alike));
        fans.or_else(by_ears).filter(|triangles| triangles.iter().all(alike))
    }

    /// The neighbours on one side of a straight edge on which `v` lies, filled without it.
    fn half(&self, v: u32, neighbours: &[u32]) -> Option<Vec<[u32; 3]>> {
        self.fill(v, neighbours, self.flat(v, neighbours)?)
    }

    /// `v` on a straight edge between two planes.
    fn crease(&self, v: u32, link: &[u32]) -> Option<Vec<[u32; 3]>> {
        let n = link.len();
        for i in 0..n {
            for j in i + 1..n {
                if !self.between(v, link[i], link[j]) {
                    continue;
                }
                let other: Vec<u32> = link[j..].iter().chain(&link[..=i]).copied().collect();
                let (one, two) = (self.half(v, &link[i..=j])?, self.half(v, &other)?);
                return Some([one, two].concat());
            }
        }
        None
    }

    /// `v` on a straight border.
    fn border(&self, v: u32, link: &[u32]) -> Option<Vec<[u32; 3]>> {
        if !self.between(v, link[0], link[link.len() - 1]) {
            return None;
        }
        self.half(v, link)
    }

    /// Whether `v` lies on the straight line between two others.
    fn between(&self, v: u32, a: u32, b: u32) -> bool {
        let (v, a, b) = (self.at(v), self.at(a), self.at(b));
        let within = |i: usize| a[i] < v[i] && v[i] < b[i] || b[i] < v[i] && v[i] < a[i];
        (0..3).any(within) && (0..3).all(|axis| turn(a, v, b, axis) == 0)
    }

    /// Replaces the triangles around `v`; returns the neighbours, whose surroundings have changed.
    fn apply(&mut self, v: u32, removal: Removal) -> Vec<u32> {
        let old = std::mem::take(&mut self.around[v as usize]);
        let mut touched: Vec<u32> = old.iter().filter_map(|&t| self.triangles[t as usize]).flatten().collect();
        touched.sort_unstable();
        touched.dedup();
        touched.retain(|&i| i != v);
        for &i in &touched {
            self.around[i as usize].retain(|t| !old.contains(t));
        }
        for (k, &t) in old.iter().enumerate() {
            self.triangles[t as usize] = removal.instead.get(k).copied();
            if let Some(corners) = removal.instead.get(k) {
                corners.iter().for_each(|&i| self.around[i as usize].push(t));
            }
        }
        touched
    }
}
