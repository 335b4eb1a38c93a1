//! The space-filling octree of prioritized-layered projection (Correa, Klosowski and Silva 2002; Klosowski and Silva 2000).
//!
//! A cube around the scene's box is halved along all three axes until a leaf has few triangles. **Invariants**: the leaves fill the
//! cube, empty ones included; leaves meet in planes of equal numbers, so that what touches is known exactly; a leaf knows
//! every leaf that it shares a face, an edge or a corner with, on whatever level; an object is in every leaf that one of
//! its triangles touches, by a test that errs towards touching (`overlap.rs`). An object may be in many leaves.
//!
//! **Cost**: a triangle is looked at once on each level where its object does not lie in one child. The plant's 12.7 million
//! triangles take three seconds of one core; references to triangles are held to a fixed multiple of the scene's, so that no
//! input makes it grow without end. Boxes are about the scene's origin, in f32.

mod build;
mod overlap;

use glam::Vec3;

use crate::geometry::Aabb;

/// When a leaf is halved no more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OctreeLimits {
    /// Triangles of a leaf, at most, unless another limit, or halving that does not part them, ends it earlier.
    pub triangles: u32,
    /// Levels below the root, 0 to [`MAX_OCTREE_DEPTH`]; more count as that.
    pub depth: u32,
}

/// Planes of the deepest level stay apart in f32 wherever the scene stands.
pub const MAX_OCTREE_DEPTH: u32 = 10;

/// Triangles of a leaf: some forty objects of the plant. Of 250, 1000, 4000, 16,000 and 64,000 the one with which layers show most there,
/// at a budget of 140,000; accumulated solidity shows the same with all of them, and is faster with few leaves.
pub const DEFAULT_LEAF_TRIANGLES: u32 = 16_000;

impl Default for OctreeLimits {
    fn default() -> Self {
        OctreeLimits { triangles: DEFAULT_LEAF_TRIANGLES, depth: MAX_OCTREE_DEPTH }
    }
}

/// A cube of the octree, by planes of the deepest level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Cube {
    /// The number of its lower plane, along each axis.
    low: [u32; 3],
    /// Planes to its upper side.
    side: u32,
}

impl Cube {
    const ROOT: Cube = Cube { low: [0; 3], side: 1 << MAX_OCTREE_DEPTH };

    /// The part in an octant; bit `axis` of its number chooses the upper half.
    fn octant(self, n: usize) -> Cube {
        let half = self.side / 2;
        Cube { low: std::array::from_fn(|axis| self.low[axis] + if n >> axis & 1 != 0 { half } else { 0 }), side: half }
    }

    /// Whether they share a point.
    fn touches(self, other: Cube) -> bool {
        (0..3).all(|a| self.low[a] <= other.low[a] + other.side && other.low[a] <= self.low[a] + self.side)
    }
}

/// Where a node's link leads: to the first of eight children, or, with this bit, to a leaf.
const LEAF: u32 = 1 << 31;

/// An octree over a prepared scene.
#[derive(Debug, Clone, Default)]
pub struct Octree {
    /// Links, root first; none when no object has a box.
    nodes: Vec<u32>,
    cubes: Vec<Cube>,
    bounds: Vec<Aabb>,
    /// Coordinates of the planes along each axis.
    planes: [Vec<f32>; 3],
    /// Triangles that touch each leaf.
    triangles: Vec<u64>,
    objects: Lists,
    neighbours: Lists,
}

/// A list of numbers for each of many things, end to end.
#[derive(Debug, Clone, Default)]
struct Lists {
    /// One more than there are lists.
    begins: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    fn push(&mut self, list: impl IntoIterator<Item = u32>) {
        if self.begins.is_empty() {
            self.begins.push(0);
        }
        self.items.extend(list);
        self.begins.push(self.items.len() as u32);
    }

    fn get(&self, n: u32) -> &[u32] {
        &self.items[self.begins[n as usize] as usize..self.begins[n as usize + 1] as usize]
    }
}

impl Octree {
    /// How many leaves there are; none when no object has a finite box.
    pub fn len(&self) -> usize {
        self.cubes.len()
    }

    /// True when no object has a finite box.
    pub fn is_empty(&self) -> bool {
        self.cubes.is_empty()
    }

    /// The whole cube, about the scene's origin; [`Aabb::EMPTY`] when there is none.
    pub fn cube(&self) -> Aabb {
        if self.is_empty() { Aabb::EMPTY } else { self.bounds_of(Cube::ROOT) }
    }

    /// The boxes of all leaves, about the scene's origin.
    pub fn bounds(&self) -> &[Aabb] {
        &self.bounds
    }

    /// Objects of which a triangle touches the leaf, ascending.
    pub fn objects(&self, leaf: u32) -> &[u32] {
        self.objects.get(leaf)
    }

    /// The leaves that share a face, an edge or a corner with this one, ascending.
    pub fn neighbours(&self, leaf: u32) -> &[u32] {
        self.neighbours.get(leaf)
    }

    /// Triangles that touch the leaf.
    pub fn triangles(&self, leaf: u32) -> u64 {
        self.triangles[leaf as usize]
    }

    /// The sides of the whole cube that a leaf lies at: bit `axis` for the lower one, bit `axis + 3` for the upper.
    pub fn boundary(&self, leaf: u32) -> u8 {
        let cube = self.cubes[leaf as usize];
        (0..3).fold(0, |sides, axis| {
            let (lower, upper) = (cube.low[axis] == 0, cube.low[axis] + cube.side == Cube::ROOT.side);
            sides | u8::from(lower) << axis | u8::from(upper) << (axis + 3)
        })
    }

    /// The leaf that holds a point about the scene's origin: of those that meet there, the upper one. `None` outside of the cube.
    pub fn leaf_at(&self, point: Vec3) -> Option<u32> {
        let whole = self.cube();
        if !(point.cmpge(whole.min).all() && point.cmple(whole.max).all()) {
            return None;
        }
        let (mut node, mut cube) = (0, Cube::ROOT);
        loop {
            let link = self.nodes[node];
            if link & LEAF != 0 {
                return Some(link & !LEAF);
            }
            let middle = self.bounds_of(cube.octant(7)).min;
            let n = point.cmpge(middle).bitmask() as usize;
            (node, cube) = (link as usize + n, cube.octant(n));
        }
    }

    /// Levels below the root that there are.
    pub fn depth(&self) -> u32 {
        self.cubes.iter().map(|c| (Cube::ROOT.side / c.side).ilog2()).max().unwrap_or(0)
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let lists = [&self.objects, &self.neighbours].map(|l| 4 * (l.begins.len() + l.items.len()));
        self.nodes.len() * 4 + self.cubes.len() * (16 + 24 + 8) + lists.iter().sum::<usize>()
    }

    fn bounds_of(&self, cube: Cube) -> Aabb {
        let plane = |axis: usize, n: u32| self.planes[axis][n as usize];
        let corner = |up: u32| Vec3::from_array([0, 1, 2].map(|a| plane(a, cube.low[a] + up * cube.side)));
        Aabb { min: corner(0), max: corner(1) }
    }
}
