//! The cells that prioritized-layered projection walks: leaves of the octree, or of the bounding volume hierarchy.
//!
//! Made once a scene and kind, read by any number of frames. Octree leaves have lists of their neighbours. Leaves of the hierarchy
//! overlap as they like, and a large one may touch all others, so neighbours are looked up: down the tree through what
//! touches and still has a cell that was not met. That keeps a frame's look-ups near linear on any scene.

use std::sync::Arc;

use glam::Vec3;

use crate::geometry::Aabb;
use crate::occlusion::BoxSet;
use crate::scene::{Hierarchy, Octree, OctreeLimits, PreparedScene, shown_areas};

use super::plp_parameters::{CellKind, PlpParameters};

/// Cells over a scene.
#[derive(Debug, Clone)]
pub struct PlpCells {
    pub(super) bounds: Vec<Aabb>,
    /// The same boxes, ready to be projected.
    pub(super) boxes: BoxSet,
    /// The area that each object shows along each axis.
    pub(super) areas: Vec<Vec3>,
    partition: Partition,
    /// [`PreparedScene::hash`] of the scene.
    scene: u64,
}

#[derive(Debug, Clone)]
enum Partition {
    Octree { octree: Octree, limits: OctreeLimits },
    Leaves(Leaves),
}

/// The leaves of a hierarchy, numbered in the order of their nodes.
#[derive(Debug, Clone)]
struct Leaves {
    tree: Hierarchy,
    /// The node of each cell.
    nodes: Vec<u32>,
    /// The cell of each node that is a leaf.
    cells: Vec<u32>,
    /// Of each node but the root.
    parents: Vec<u32>,
    /// Cells at or below each node.
    below: Vec<u32>,
}

/// Which cells of a hierarchy a frame has not met yet.
#[derive(Debug, Default)]
pub(super) struct Unmet {
    below: Vec<u32>,
    stack: Vec<u32>,
}

impl PlpCells {
    /// Makes the cells that the parameters ask for. A second or more for ten million triangles.
    pub fn new(scene: &PreparedScene, parameters: &PlpParameters) -> PlpCells {
        let (bounds, partition) = match parameters.cells {
            CellKind::Octree => {
                let limits = limits(parameters);
                let octree = Octree::build(scene, &limits);
                (octree.bounds().to_vec(), Partition::Octree { octree, limits })
            }
            CellKind::Bvh => {
                let leaves = Leaves::new(scene);
                let bounds: Vec<Aabb> = leaves.nodes.iter().map(|&n| leaves.tree.nodes[n as usize].bounds).collect();
                (bounds, Partition::Leaves(leaves))
            }
        };
        PlpCells { boxes: BoxSet::new(&bounds), bounds, areas: shown_areas(scene), partition, scene: scene.hash }
    }

    /// Whether these are the cells of that scene under those parameters.
    pub fn are_of(&self, scene: &PreparedScene, parameters: &PlpParameters) -> bool {
        let agrees = match (&self.partition, parameters.cells) {
            (Partition::Octree { limits: made, .. }, CellKind::Octree) => *made == limits(parameters),
            (Partition::Leaves(_), CellKind::Bvh) => true,
            _ => false,
        };
        agrees && self.scene == scene.hash
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.bounds.len()
    }

    /// True when no object has a box.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_empty()
    }

    /// The octree whose leaves the cells are.
    pub fn octree(&self) -> Option<&Octree> {
        match &self.partition {
            Partition::Octree { octree, .. } => Some(octree),
            Partition::Leaves(_) => None,
        }
    }

    /// Objects of a cell.
    pub(super) fn objects(&self, cell: u32) -> &[u32] {
        match &self.partition {
            Partition::Octree { octree, .. } => octree.objects(cell),
            Partition::Leaves(leaves) => leaves.objects(cell),
        }
    }

    pub(super) fn begin(&self, unmet: &mut Unmet) {
        unmet.below.clear();
        if let Partition::Leaves(leaves) = &self.partition {
            unmet.below.extend_from_slice(&leaves.below);
        }
    }

    /// A cell is met: it will not be looked for again.
    pub(super) fn meet(&self, cell: u32, unmet: &mut Unmet) {
        let Partition::Leaves(leaves) = &self.partition else { return };
        let mut node = leaves.nodes[cell as usize];
        loop {
            unmet.below[node as usize] -= 1;
            if node == 0 {
                return;
            }
            node = leaves.parents[node as usize];
        }
    }

    /// The neighbours of a cell; of leaves of the hierarchy those alone that were not met.
    pub(super) fn neighbours(&self, cell: u32, unmet: &mut Unmet, out: &mut Vec<u32>) {
        out.clear();
        match &self.partition {
            Partition::Octree { octree, .. } => out.extend_from_slice(octree.neighbours(cell)),
            Partition::Leaves(leaves) => leaves.touching(self.bounds[cell as usize], unmet, out),
        }
    }
}

fn limits(parameters: &PlpParameters) -> OctreeLimits {
    OctreeLimits { triangles: parameters.leaf, ..OctreeLimits::default() }
}

impl Leaves {
    fn new(scene: &PreparedScene) -> Leaves {
        let tree = Hierarchy::build(&scene.bounds);
        let nodes: Vec<u32> = (0..tree.nodes.len() as u32).filter(|&n| tree.nodes[n as usize].is_leaf()).collect();
        let (mut cells, mut parents) = (vec![0; tree.nodes.len()], vec![0; tree.nodes.len()]);
        for (cell, &node) in nodes.iter().enumerate() {
            cells[node as usize] = cell as u32;
        }
        let mut below = vec![0; tree.nodes.len()];
        // Children follow their parents.
        for (n, node) in tree.nodes.iter().enumerate().rev() {
            let first = node.first as usize;
            if node.is_leaf() {
                below[n] = 1;
            } else {
                below[n] = below[first] + below[first + 1];
                parents[first..first + 2].fill(n as u32);
            }
        }
        Leaves { tree, nodes, cells, parents, below }
    }

    fn objects(&self, cell: u32) -> &[u32] {
        let node = &self.tree.nodes[self.nodes[cell as usize] as usize];
        &self.tree.objects[node.first as usize..(node.first + node.count) as usize]
    }

    fn touching(&self, b: Aabb, unmet: &mut Unmet, out: &mut Vec<u32>) {
        unmet.stack.clear();
        unmet.stack.push(0);
        while let Some(n) = unmet.stack.pop() {
            let node = &self.tree.nodes[n as usize];
            let touches = node.bounds.min.cmple(b.max).all() && b.min.cmple(node.bounds.max).all();
            if unmet.below[n as usize] == 0 || !touches {
                continue;
            }
            if node.is_leaf() {
                out.push(self.cells[n as usize]);
            } else {
                unmet.stack.extend([node.first + 1, node.first]);
            }
        }
    }
}

/// Cells that several methods have in common.
#[derive(Debug, Default)]
pub struct SharedCells(Vec<Arc<PlpCells>>);

impl SharedCells {
    /// The cells of a scene under these parameters, made if none agree.
    pub fn of(&mut self, scene: &PreparedScene, parameters: &PlpParameters) -> Arc<PlpCells> {
        if let Some(cells) = self.0.iter().find(|c| c.are_of(scene, parameters)) {
            return cells.clone();
        }
        let cells = Arc::new(PlpCells::new(scene, parameters));
        self.0.push(cells.clone());
        cells
    }
}
