//! The bounding volume hierarchy over a scene's objects, built by obvhs (PLOC, Meister and Bittner 2018).
//!
//! obvhs is quadratic where many boxes tie: 10,000 equal boxes take seconds and nest 9,993 deep. So it is given boxes that
//! are scaled to the bulk of the scene and moved by a deterministic hash; the exact boxes are put back afterwards. Should a
//! tree still nest deeper than [`MAX_DEPTH`], a median split replaces it. Invariants: every object that has a finite box is
//! in exactly one leaf; the objects below a node are contiguous in [`Hierarchy::objects`]; children follow their parents;
//! a node's box is the exact union of its objects' boxes. About 30 ms and 40 bytes a node for 100,000 objects.

use glam::{DVec3, Vec3};
use obvhs::bvh2::{Bvh2, leaf_collapser::collapse, reinsertion::ReinsertionOptimizer};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::random::mix;
use crate::geometry::Aabb;

/// No tree nests deeper; a walk's stack of this size plus one never grows.
pub const MAX_DEPTH: usize = 64;
/// Objects in a leaf, at most. Testing the boxes of four objects costs as much as the inner nodes that they save.
const LEAF: usize = 4;

/// A node of a [`Hierarchy`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The exact union of the boxes below.
    pub bounds: Aabb,
    /// For an inner node its first child, the second is at `first + 1`; for a leaf its first place in
    /// [`Hierarchy::objects`].
    pub first: u32,
    /// How many objects a leaf has; 0 for an inner node.
    pub count: u32,
}

impl Node {
    /// True when the node holds objects and not nodes.
    pub fn is_leaf(&self) -> bool {
        self.count > 0
    }
}

/// A binary tree of boxes over objects.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Hierarchy {
    /// The root is first; no nodes when no object has a box.
    pub nodes: Vec<Node>,
    /// Object ids, leaf by leaf; the objects below any node are contiguous.
    pub objects: Vec<u32>,
    /// Ids of objects whose box is empty, infinite or not a number: they are in no leaf.
    pub unplaced: Vec<u32>,
}

impl Hierarchy {
    /// The hierarchy over boxes, one for each object id, about one origin.
    pub fn build(boxes: &[Aabb]) -> Hierarchy {
        let (placed, unplaced): (Vec<u32>, Vec<u32>) =
            (0..boxes.len() as u32).partition(|&id| boxes[id as usize].is_finite());
        let mut hierarchy = Hierarchy { unplaced, ..Hierarchy::default() };
        if placed.is_empty() {
            return hierarchy;
        }
        let tree = if placed.len() > LEAF { build_jittered(boxes, &placed) } else { None };
        let complete = tree.is_some_and(|tree| hierarchy.take_over(&tree, &placed));
        if !complete {
            hierarchy.split_at_medians(boxes, placed);
        }
        hierarchy.refit(boxes);
        hierarchy
    }

    /// Fits the tree to boxes that have moved; ids and structure stay. An object whose box is not finite any more makes
    /// no node larger and stays where it is: rebuild to have it unplaced. Cost: a pass over nodes and boxes.
    pub fn refit(&mut self, boxes: &[Aabb]) {
        for index in (0..self.nodes.len()).rev() {
            let node = self.nodes[index];
            let first = node.first as usize;
            let bounds = if node.is_leaf() {
                let ids = &self.objects[first..first + node.count as usize];
                let finite = ids.iter().filter_map(|&id| boxes.get(id as usize)).filter(|b| b.is_finite());
                finite.fold(Aabb::EMPTY, |a, &b| a.union(b))
            } else {
                self.nodes[first].bounds.union(self.nodes[first + 1].bounds)
            };
            self.nodes[index].bounds = bounds;
        }
    }

    /// Levels of nodes: 1 for a single leaf, 0 for an empty tree.
    pub fn depth(&self) -> usize {
        let mut depths = vec![1; self.nodes.len()];
        for (index, node) in self.nodes.iter().enumerate().filter(|(_, n)| !n.is_leaf()) {
            depths[node.first as usize] = depths[index] + 1;
            depths[node.first as usize + 1] = depths[index] + 1;
        }
        depths.into_iter().max().unwrap_or(0)
    }

    /// Copies the shape of obvhs's tree in stack order, which puts the objects of each subtree side by side. False, and
    /// nothing copied, when that tree nests too deep or has lost an object.
    fn take_over(&mut self, tree: &Bvh2, placed: &[u32]) -> bool {
        let mut nodes = vec![EMPTY_NODE];
        let mut objects = Vec::with_capacity(placed.len());
        let mut stack = vec![(0usize, 0usize, 1usize)];
        while let Some((from, to, depth)) = stack.pop() {
            let Some(source) = tree.nodes.get(from).filter(|_| depth <= MAX_DEPTH && nodes.len() <= 2 * placed.len())
            else {
                return false;
            };
            let first = source.first_index as usize;
            if source.is_leaf() {
                let ids = tree.primitive_indices.get(first..first + source.prim_count as usize);
                nodes[to] = Node { first: objects.len() as u32, count: source.prim_count, ..EMPTY_NODE };
                objects.extend(ids.unwrap_or_default().iter().filter_map(|&i| placed.get(i as usize)));
            } else {
                nodes[to].first = nodes.len() as u32;
                stack.push((first + 1, nodes.len() + 1, depth + 1));
                stack.push((first, nodes.len(), depth + 1));
                nodes.extend([EMPTY_NODE; 2]);
            }
        }
        let mut ids = objects.clone();
        ids.sort_unstable();
        let complete = ids == placed;
        if complete {
            (self.nodes, self.objects) = (nodes, objects);
        }
        complete
    }

    /// The plain tree: halves by object count along the widest axis of the boxes' middles; depth at most 31.
    fn split_at_medians(&mut self, boxes: &[Aabb], mut ids: Vec<u32>) {
        self.nodes = vec![EMPTY_NODE];
        let mut stack = vec![(0usize, 0..ids.len())];
        while let Some((to, range)) = stack.pop() {
            if range.len() <= LEAF {
                self.nodes[to] = Node { first: range.start as u32, count: range.len() as u32, ..EMPTY_NODE };
                continue;
            }
            let part = &mut ids[range.clone()];
            let size = Aabb::around(part.iter().map(|&id| boxes[id as usize].center())).size();
            let axis = if size.x >= size.y.max(size.z) { 0 } else { 2 - usize::from(size.y >= size.z) };
            let key = |&id: &u32| boxes[id as usize].center()[axis];
            let middle = part.len() / 2;
            part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
            let split = range.start + middle;
            let first = self.nodes.len();
            self.nodes[to].first = first as u32;
            stack.push((first + 1, split..range.end));
            stack.push((first, range.start..split));
            self.nodes.extend([EMPTY_NODE; 2]);
        }
        self.objects = ids;
    }
}

const EMPTY_NODE: Node = Node { bounds: Aabb::EMPTY, first: 0, count: 0 };

/// obvhs's tree over scaled, jittered copies of the placed boxes; its ids are places in `placed`. `None` when it nests
/// too deep.
fn build_jittered(boxes: &[Aabb], placed: &[u32]) -> Option<Bvh2> {
    let (origin, scale) = bulk(boxes, placed);
    let strength = (1.0 / placed.len() as f64).clamp(1e-5, 1e-4);
    let primitives: Vec<obvhs::aabb::Aabb> = placed
        .iter()
        .map(|&id| {
            let shift = jitter(id, strength);
            let at = |p: Vec3| {
                let q = (p.as_dvec3() - origin) * scale;
                // Beyond 1e12 bulks areas would leave f32; a step of 2e-6 is some 16 units in the last place.
                let q = q.clamp(DVec3::splat(-1e12), DVec3::splat(1e12));
                (q + shift * (DVec3::ONE + q.abs() * (2e-6 / strength))).as_vec3a()
            };
            let (min, max) = (at(boxes[id as usize].min), at(boxes[id as usize].max));
            obvhs::aabb::Aabb { min: min.min(max), max: min.max(max) }
        })
        .collect();
    // The steps of `build_bvh2` with `BvhBuildParams::fast_build()`, apart because the later ones keep fixed-size stacks
    // and must not be given a tree that is too deep.
    let ids = (0..primitives.len() as u32).collect();
    let mut builder = PlocBuilder::with_capacity(primitives.len());
    let mut tree = builder.build(PlocSearchDistance::Low, &primitives, ids, SortPrecision::U64, 2);
    if tree_depth(&tree) > MAX_DEPTH {
        return None;
    }
    ReinsertionOptimizer::default().run(&mut tree, 0.02, None);
    collapse(&mut tree, LEAF as u32, 3.0);
    Some(tree)
}

/// Levels of obvhs's tree, no more than one beyond [`MAX_DEPTH`].
fn tree_depth(tree: &Bvh2) -> usize {
    let (mut deepest, mut stack) = (0, vec![(0, 1)]);
    while let Some((index, depth)) = stack.pop() {
        deepest = deepest.max(depth);
        let inner = tree.nodes.get(index).filter(|node| !node.is_leaf() && depth <= MAX_DEPTH);
        if let Some(node) = inner {
            let first = node.first_index as usize;
            stack.extend([(first, depth + 1), (first + 1, depth + 1)]);
        }
    }
    deepest
}

/// Where most of the scene is: the middle, and the scale that brings the box around the central nine tenths of the boxes'
/// middles, or failing that a typical box, to size 1. An outlier, such as a sky, then does not drown the rest.
fn bulk(boxes: &[Aabb], placed: &[u32]) -> (DVec3, f64) {
    let centers: Vec<Vec3> = placed.iter().map(|&id| boxes[id as usize].center()).collect();
    let spread = |values: &mut Vec<f32>| {
        let cut = values.len() / 20;
        let last = values.len() - 1 - cut;
        let low = f64::from(*values.select_nth_unstable_by(cut, f32::total_cmp).1);
        (low, f64::from(*values.select_nth_unstable_by(last, f32::total_cmp).1))
    };
    let mut origin = DVec3::ZERO;
    let mut size = DVec3::ZERO;
    for axis in 0..3 {
        let (low, high) = spread(&mut centers.iter().map(|c| c[axis]).collect());
        (origin[axis], size[axis]) = ((low + high) * 0.5, high - low);
    }
    let diagonal = |b: &Aabb| (b.max.as_dvec3() - b.min.as_dvec3()).length();
    let mut diagonals: Vec<f64> = placed.iter().map(|&id| diagonal(&boxes[id as usize])).collect();
    let middle = diagonals.len() / 2;
    let extent = size.length() + *diagonals.select_nth_unstable_by(middle, f64::total_cmp).1;
    (origin, if extent > 0.0 { 1.0 / extent } else { 1.0 })
}

/// A shift in -strength to strength on each axis, fixed by the id alone.
fn jitter(id: u32, strength: f64) -> DVec3 {
    let bits = mix(u64::from(id));
    let part = |shift: u32| ((bits >> shift) & 0x1f_ffff) as f64 / f64::from(1 << 20) - 1.0;
    DVec3::new(part(0), part(21), part(42)) * strength
}
