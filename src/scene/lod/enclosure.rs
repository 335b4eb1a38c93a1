//! What a closed part encloses, and whether a triangle lies in it: the proof on which conservative simplification
//! rests.
//!
//! *Claim.* Let S be a closed part and t a triangle that has no point in common with S, one point of which S winds
//! about at least once. Then every ray that starts outside the part's box and ends in t passes a front face of S
//! before. *Proof.* The winding number is constant on what is connected off S; t is, so it is at least 1 all over t.
//! Along the ray it begins with 0, falls and rises by the back and front faces that are passed, and ends at 1 or more:
//! more front faces than back faces were passed. So where t is seen from outside, S is seen before it, at every point
//! and from every such viewpoint, whichever side of S is drawn as long as its front is. Nothing is asked of t's
//! neighbours: any heap of such triangles will do, holes and all.
//!
//! Both conditions are decided exactly ([`predicates`](super::predicates)), on the f32 positions that are drawn. A
//! doubt is a *no*. Cost: a walk through a tree of boxes a question, the logarithm of the part's triangles where the
//! question is local.

use glam::{DVec3, Vec3};

use super::super::Mesh;
use super::parts::{Open, Parts};
use super::predicates::{Corners, disjoint, passes, side};
use crate::raster::Facing;

/// Triangles in a leaf of the tree.
const LEAF: usize = 4;

/// A closed part, ready to be asked what it encloses.
#[derive(Debug, Clone)]
pub struct Enclosure {
    /// In the order of the tree's leaves.
    triangles: Vec<Corners>,
    nodes: Vec<Node>,
    /// Lowest and highest corner.
    bounds: [DVec3; 2],
}

#[derive(Debug, Clone)]
struct Node {
    min: DVec3,
    max: DVec3,
    /// Triangles of a leaf; of an inner node the second child and 0: the first follows its parent.
    first: u32,
    count: u32,
}

impl Enclosure {
    /// Of a mesh all of whose parts are closed, for objects that are drawn with `facing`: then what is contained is
    /// seen by no viewer outside the mesh's box who does not see the mesh before it.
    ///
    /// # Errors
    /// Why a part is open; [`Open::Orientation`] for meshes drawn from the back.
    pub fn of(mesh: &Mesh, facing: Facing) -> Result<Enclosure, Open> {
        let Parts { positions, parts } = Parts::new(mesh, facing == Facing::Both);
        if facing == Facing::Back {
            return Err(Open::Orientation);
        }
        match parts.iter().find_map(|part| part.open) {
            Some(open) => Err(open),
            None => {
                let all: Vec<[u32; 3]> = parts.into_iter().flat_map(|part| part.triangles).collect();
                Ok(Enclosure::new(&positions, &all))
            }
        }
    }

    /// Of a closed, outward oriented part: nobody checks again that it is one. Triangles are corners into `positions`.
    pub(super) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Enclosure {
        let mut triangles: Vec<Corners> =
            triangles.iter().map(|t| t.map(|i| positions[i as usize].as_dvec3())).collect();
        let mut nodes = Vec::with_capacity(triangles.len());
        if !triangles.is_empty() {
            build(&mut nodes, &mut triangles, 0);
        }
        let bounds = nodes.first().map_or([DVec3::ZERO; 2], |n| [n.min, n.max]);
        Enclosure { triangles, nodes, bounds }
    }

    /// Whether the closed triangle is proven to lie where the part winds about at least once: strictly inside.
    pub fn contains(&self, triangle: [Vec3; 3]) -> bool {
        self.misses(triangle) && self.winding(triangle[0]).is_some_and(|w| w >= 1)
    }

    /// Whether the closed triangle is proven to have no point in common with the part's surface.
    pub fn misses(&self, triangle: [Vec3; 3]) -> bool {
        let t = triangle.map(Vec3::as_dvec3);
        let (min, max) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
        self.all(min, max, |s| disjoint(s, &t))
    }

    /// How often the surface winds about a point; `None` on the surface, and in the doubt that several rays leave.
    pub fn winding(&self, point: Vec3) -> Option<i32> {
        let p = point.as_dvec3();
        let [min, max] = self.bounds;
        if p.cmplt(min).any() || p.cmpgt(max).any() {
            return Some(0);
        }
        let size = (max - min).max_element();
        // Nearly along an axis, so that boxes part; tilted, so that edges of axis-aligned models are not met.
        let tilts = [(0.0123, 0.0071), (-0.0091, 0.0137), (0.0049, -0.0173), (-0.0211, -0.0037), (0.0303, 0.0219)];
        (0..15).find_map(|k| {
            let (u, v) = tilts[k / 3];
            let way = [DVec3::new(1.0, u, v), DVec3::new(v, 1.0, u), DVec3::new(u, v, 1.0)][k % 3];
            self.crossings(p, p + way * (2.0 * size))
        })
    }

    /// Front faces less back faces that a point passes on its way in from `q`, outside, to `p`; `None` if an edge or
    /// `p` itself is met.
    fn crossings(&self, p: DVec3, q: DVec3) -> Option<i32> {
        let mut sum = 0;
        let clear = self.all(p.min(q), p.max(q), |s| {
            let (from, to) = (side(*s, q), side(*s, p));
            if from * to > 0 {
                return true;
            }
            let passes = passes(*s, p, q);
            if passes.contains(&1) && passes.contains(&-1) {
                return true;
            }
            sum += from;
            from * to < 0 && !passes.contains(&0)
        });
        clear.then_some(sum)
    }

    /// Whether `holds` for every triangle whose box touches the given one; stops at the first for which it does not.
    fn all(&self, min: DVec3, max: DVec3, mut holds: impl FnMut(&Corners) -> bool) -> bool {
        let mut at = 0;
        let mut later = Vec::new();
        while let Some(node) = self.nodes.get(at) {
            let apart = node.min.cmpgt(max).any() || node.max.cmplt(min).any();
            if !apart && node.count == 0 {
                later.push(node.first as usize);
                at += 1;
                continue;
            }
            let leaf = &self.triangles[node.first as usize..(node.first + node.count) as usize];
            if !apart && !leaf.iter().all(&mut holds) {
                return false;
            }
            match later.pop() {
                Some(next) => at = next,
                None => return true,
            }
        }
        true
    }

    /// Lowest and highest corner of the part.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }
}

/// Splits at the middle of the longest side of the centroids' box, by count: depth is the logarithm of the number.
fn build(nodes: &mut Vec<Node>, triangles: &mut [Corners], first: usize) {
    let corners = triangles.iter().flatten();
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (min, max) = corners.fold(start, |(a, b), &p| (a.min(p), b.max(p)));
    let at = nodes.len();
    nodes.push(Node { min, max, first: first as u32, count: triangles.len() as u32 });
    if triangles.len() <= LEAF {
        return;
    }
    let sum = |t: &Corners| t[0] + t[1] + t[2];
    let (low, high) = triangles.iter().map(sum).fold(start, |(a, b), p| (a.min(p), b.max(p)));
    let size = (high - low).to_array();
    let axis = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
    let middle = triangles.len() / 2;
    triangles.select_nth_unstable_by(middle, |s, t| sum(s)[axis].total_cmp(&sum(t)[axis]));
    let (left, right) = triangles.split_at_mut(middle);
    build(nodes, left, first);
    nodes[at].first = nodes.len() as u32;
    nodes[at].count = 0;
    build(nodes, right, first + middle);
}
