//! Building the octree: the fullest leaf is halved next, until each has few enough triangles.
//!
//! What lies in a node is a list of objects. One whose box lies in a single child goes there as a whole; of the others each
//! triangle is tested against the children that it reaches, and the list says which of them touch.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use super::overlap::touches;
use super::{Cube, LEAF, Lists, MAX_OCTREE_DEPTH, Octree, OctreeLimits};
use crate::geometry::Aabb;
use crate::scene::PreparedScene;
use crate::scene::placed_triangles::PlacedTriangles;

/// Leaves, at most: the octree then stays under half a gigabyte.
const MOST_LEAVES: usize = 1 << 20;
/// References to triangles, at most, as a multiple of the scene's triangles.
const MOST_REFERENCES: u64 = 8;
/// Halving that leaves more than this many times the references does not part what is there, such as a stack of large sheets.
const MOST_GROWTH: u64 = 4;
/// A cube is at least this part of its distance from the origin, so that its planes are apart in f32.
const LEAST_SIDE: f64 = 1.0 / 1024.0;

/// In [`Item::triangles`]: all of the object's.
const WHOLE: u32 = u32::MAX;

/// An object in a node.
struct Item {
    object: u32,
    /// How many of its triangles are listed, or [`WHOLE`].
    triangles: u32,
}

/// What lies in a node.
#[derive(Default)]
struct Contents {
    /// Ascending by object.
    items: Vec<Item>,
    /// The listed triangles, item after item, by their numbers in the object.
    listed: Vec<u32>,
    /// References to triangles: listed ones and those of whole objects.
    references: u64,
}

impl Octree {
    /// Builds the octree over the objects that have finite boxes.
    pub fn build(scene: &PreparedScene, limits: &OctreeLimits) -> Octree {
        let finite = |id: &u32| scene.bounds[*id as usize].is_finite();
        let placed: Vec<u32> = (0..scene.bounds.len() as u32).filter(finite).collect();
        let around = placed.iter().fold(Aabb::EMPTY, |b, &id| b.union(scene.bounds[id as usize]));
        if placed.is_empty() {
            return Octree::default();
        }
        let octree = Octree { planes: planes(around), ..Octree::default() };
        let items = placed.iter().map(|&object| Item { object, triangles: WHOLE }).collect();
        let references = placed.iter().map(|&id| u64::from(scene.triangles(id))).sum();
        let root = Contents { items, listed: Vec::new(), references };
        let mut growth = Growth::new(scene, octree, limits, root);
        growth.grow();
        growth.finish()
    }
}

/// Planes of the deepest level in the cube around a box.
fn planes(around: Aabb) -> [Vec<f32>; 3] {
    let (min, max) = (around.min.as_dvec3(), around.max.as_dvec3());
    let (middle, far) = ((min + max) * 0.5, min.abs().max(max.abs()).max_element());
    let side = ((max - min).max_element() * (1.0 + LEAST_SIDE)).max(far * LEAST_SIDE).max(1e-30);
    let n = Cube::ROOT.side;
    let plane = |axis: usize, k: u32| (middle[axis] + side * (f64::from(k) / f64::from(n) - 0.5)) as f32;
    // Rounding to f32 must not bring a side in.
    let widened = |axis: usize, k: u32| match k {
        0 => plane(axis, k).min(around.min[axis]).next_down(),
        k if k == n => plane(axis, k).max(around.max[axis]).next_up(),
        k => plane(axis, k),
    };
    [0, 1, 2].map(|axis| (0..=n).map(|k| widened(axis, k).clamp(f32::MIN, f32::MAX)).collect())
}

struct Growth<'s> {
    limits: OctreeLimits,
    scene: &'s PreparedScene,
    triangles: PlacedTriangles<'s>,
    octree: Octree,
    /// By node.
    cubes: Vec<Cube>,
    /// What lies in the nodes that are leaves, so far.
    contents: Vec<Option<Contents>>,
    leaves: usize,
    references: u64,
    most_references: u64,
    queue: BinaryHeap<(u64, Reverse<u32>)>,
}

impl<'s> Growth<'s> {
    fn new(scene: &'s PreparedScene, octree: Octree, limits: &OctreeLimits, root: Contents) -> Growth<'s> {
        let references = root.references;
        let mut growth = Growth {
            limits: *limits,
            scene,
            triangles: PlacedTriangles::new(scene),
            octree,
            cubes: Vec::new(),
            contents: Vec::new(),
            leaves: 1,
            references,
            most_references: references.saturating_mul(MOST_REFERENCES),
            queue: BinaryHeap::new(),
        };
        growth.push(Cube::ROOT, root);
        growth
    }

    fn push(&mut self, cube: Cube, contents: Contents) {
        let node = self.cubes.len() as u32;
        let deepest = Cube::ROOT.side >> self.limits.depth.min(MAX_OCTREE_DEPTH);
        if contents.references > u64::from(self.limits.triangles) && cube.side > deepest {
            self.queue.push((contents.references, Reverse(node)));
        }
        self.octree.nodes.push(LEAF);
        self.cubes.push(cube);
        self.contents.push(Some(contents));
    }

    fn grow(&mut self) {
        while let Some((_, Reverse(node))) = self.queue.pop() {
            let Some(contents) = self.contents[node as usize].take() else { continue };
            let cube = self.cubes[node as usize];
            let children = if self.leaves + 7 <= MOST_LEAVES { self.split(cube, &contents) } else { None };
            let Some(children) = children else {
                self.contents[node as usize] = Some(contents);
                continue;
            };
            self.references -= contents.references;
            self.references += children.iter().map(|c| c.references).sum::<u64>();
            self.leaves += 7;
            self.octree.nodes[node as usize] = self.cubes.len() as u32;
            for (n, child) in children.into_iter().enumerate() {
                self.push(cube.octant(n), child);
            }
        }
    }

    /// What lies in the eight children; `None` when that is too much.
    fn split(&mut self, cube: Cube, contents: &Contents) -> Option<[Contents; 8]> {
        let boxes: [Aabb; 8] = std::array::from_fn(|n| self.octree.bounds_of(cube.octant(n)));
        let middle = boxes[7].min;
        let room = (self.most_references + contents.references).saturating_sub(self.references);
        let most = room.min(contents.references.saturating_mul(MOST_GROWTH));
        let (mut children, mut listed) = (<[Contents; 8]>::default(), &contents.listed[..]);
        for item in &contents.items {
            let whole = item.triangles == WHOLE;
            let of_item;
            (of_item, listed) = listed.split_at(if whole { 0 } else { item.triangles as usize });
            let bounds = self.scene.bounds[item.object as usize];
            let reached = octants(bounds.min, bounds.max, middle);
            if whole && reached.is_power_of_two() {
                let child = &mut children[reached.trailing_zeros() as usize];
                child.references += u64::from(self.scene.triangles(item.object));
                child.items.push(Item { object: item.object, triangles: WHOLE });
                continue;
            }
            let before = children.each_ref().map(|c| c.listed.len());
            let all = 0..if whole { self.scene.triangles(item.object) } else { 0 };
            self.triangles.load(item.object);
            for t in of_item.iter().copied().chain(all) {
                let mut at = self.touched(item.object, t, middle, &boxes);
                while at != 0 {
                    children[at.trailing_zeros() as usize].listed.push(t);
                    at &= at - 1;
                }
            }
            for (child, before) in children.iter_mut().zip(before) {
                let triangles = child.listed.len() - before;
                if triangles > 0 {
                    child.references += triangles as u64;
                    child.items.push(Item { object: item.object, triangles: triangles as u32 });
                }
            }
            if children.iter().map(|c| c.references).sum::<u64>() > most {
                return None;
            }
        }
        Some(children)
    }

    /// The octants that a triangle, which touches their cube, touches.
    fn touched(&self, object: u32, t: u32, middle: Vec3, boxes: &[Aabb; 8]) -> u8 {
        let triangle = self.triangles.get(object, t);
        let (low, high) =
            triangle.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
        // Outwards: a corner on the plane between octants is in both.
        let reached =
            octants(low.as_vec3() - low.as_vec3().abs() * 1e-6, high.as_vec3() + high.as_vec3().abs() * 1e-6, middle);
        if reached.is_power_of_two() {
            return reached;
        }
        (0..8).filter(|n| reached >> n & 1 != 0).fold(0, |out, n| {
            let (min, max) = (boxes[n].min.as_dvec3(), boxes[n].max.as_dvec3());
            out | u8::from(touches(&triangle, (min + max) * 0.5, (max - min) * 0.5)) << n
        })
    }

    /// The leaves' lists, in the order of the nodes.
    fn finish(mut self) -> Octree {
        let contents = std::mem::take(&mut self.contents);
        for (node, contents) in contents.into_iter().enumerate() {
            let Some(contents) = contents else { continue };
            let leaf = self.octree.cubes.len() as u32;
            let cube = self.cubes[node];
            self.octree.nodes[node] = LEAF | leaf;
            self.octree.cubes.push(cube);
            self.octree.bounds.push(self.octree.bounds_of(cube));
            self.octree.triangles.push(contents.references);
            self.octree.objects.push(contents.items.iter().map(|i| i.object));
        }
        self.octree.neighbours = neighbours(&self.octree, &self.cubes);
        self.octree
    }
}

/// The octants around a point that a box reaches, a bit for each.
fn octants(min: Vec3, max: Vec3, middle: Vec3) -> u8 {
    /// Octants in the lower half along each axis; the upper half are the others.
    const LOWER: [u8; 3] = [0b0101_0101, 0b0011_0011, 0b0000_1111];
    (0..3).fold(!0, |mask, axis| {
        let lower = if min[axis] <= middle[axis] { LOWER[axis] } else { 0 };
        let upper = if max[axis] >= middle[axis] { !LOWER[axis] } else { 0 };
        mask & (lower | upper)
    })
}

/// For each leaf, the others that touch it: down from the root, through what touches.
fn neighbours(octree: &Octree, cubes: &[Cube]) -> Lists {
    let (mut out, mut stack, mut found) = (Lists::default(), Vec::new(), Vec::new());
    for (leaf, &cube) in octree.cubes.iter().enumerate() {
        stack.push(0);
        while let Some(node) = stack.pop() {
            match octree.nodes[node] {
                link if link & LEAF == 0 => {
                    let children = link as usize..link as usize + 8;
                    stack.extend(children.filter(|&child| cubes[child].touches(cube)));
                }
                link if link & !LEAF != leaf as u32 => found.push(link & !LEAF),
                _ => {}
            }
        }
        found.sort_unstable();
        out.push(found.drain(..));
    }
    out
}
