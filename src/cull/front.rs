//! The front of prioritized-layered projection: a priority queue over cells, and the heuristics that order it.
//!
//! **Layer** (Correa, Klosowski and Silva 2002): a cell is one layer farther than the neighbour that brought it into the front.
//!
//! **Accumulated solidity** (after Klosowski and Silva 2000, *The prioritized-layered projection algorithm for visible set
//! estimation*, which accumulates the solidity of projected cells across the faces that they share, weighed by how much the
//! face looks along the view): for a cell B in the front, the mean over its projected neighbours A
//!
//! ```text
//! eta(B) = sum c(A, B) (eta(A) + rho(A)) / sum c(A, B),   c(A, B) = max(0, n . v)^2
//! ```
//!
//! where n is the normal of what A and B share (of a face an axis, of an edge or a corner the mean of its axes), v the direction in which
//! B is seen, and rho(A) the covered share of A along v (`scene/solidity.rs`), 0 to 1. A neighbour that B is not behind says
//! nothing about B; a cell of which none is known that it is behind has the eta of the one that brought it. So eta
//! estimates how many solid layers stand before a cell. The least goes first, ties by layer, then by time stamp.
//! Sums are f32 in the order of projection: equal on every machine.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::Vec3;

use super::plp_parameters::Heuristic;
use crate::geometry::Aabb;
use crate::scene::share_along;

/// What has become of a cell in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum CellState {
    /// Not met.
    #[default]
    Clean,
    /// Waits in the front.
    Enqueued,
    /// Its objects were taken, and its neighbours met.
    Projected,
    /// Shows no sample: outside of the frustum, or found hidden. What is hidden stays so while the frame is drawn.
    Unseen,
}

#[derive(Debug, Clone, Copy, Default)]
struct Cell {
    state: CellState,
    layer: u32,
    stamp: u32,
    /// Weighed sum of what stands before it, and of the weights.
    sum: f32,
    weight: f32,
    /// Where nothing is known to stand before it.
    brought: f32,
}

impl Cell {
    /// Accumulated solidity.
    fn eta(&self) -> f32 {
        if self.weight > 0.0 { self.sum / self.weight } else { self.brought }
    }
}

/// Where a view looks from: directions to points.
#[derive(Debug, Clone, Copy)]
pub(super) enum Sight {
    /// From an eye, about the scene's origin.
    Eye(Vec3),
    /// Along a direction.
    Parallel(Vec3),
}

impl Sight {
    fn toward(self, point: Vec3) -> Vec3 {
        match self {
            Sight::Eye(eye) => (point - eye).normalize_or_zero(),
            Sight::Parallel(direction) => direction,
        }
    }
}

/// Solidity bits, layer, time stamp, cell: the least first.
type Key = (u32, u32, u32, u32);

/// The front of one frame.
#[derive(Debug)]
pub(super) struct Front {
    heuristic: Heuristic,
    sight: Sight,
    cells: Vec<Cell>,
    heap: BinaryHeap<Reverse<Key>>,
    stamp: u32,
}

impl Front {
    pub fn new() -> Front {
        let (heuristic, sight) = (Heuristic::default(), Sight::Parallel(Vec3::ZERO));
        Front { heuristic, sight, cells: Vec::new(), heap: BinaryHeap::new(), stamp: 0 }
    }

    pub fn begin(&mut self, cells: usize, heuristic: Heuristic, sight: Sight) {
        (self.heuristic, self.sight, self.stamp) = (heuristic, sight, 0);
        self.heap.clear();
        self.cells.clear();
        self.cells.resize(cells, Cell::default());
    }

    pub fn state(&self, cell: u32) -> CellState {
        self.cells[cell as usize].state
    }

    pub fn set_state(&mut self, cell: u32, state: CellState) {
        self.cells[cell as usize].state = state;
    }

    /// A cell that the view begins in, or begins anew in.
    pub fn seed(&mut self, cell: u32) {
        self.enqueue(cell, 0, 0.0);
    }

    fn enqueue(&mut self, cell: u32, layer: u32, brought: f32) {
        let (state, stamp) = (CellState::Enqueued, self.stamp);
        self.cells[cell as usize] = Cell { state, layer, stamp, brought, ..Cell::default() };
        self.stamp += 1;
    }

    /// The next cell, which is still [`CellState::Enqueued`].
    pub fn pop(&mut self) -> Option<u32> {
        while let Some(Reverse(key)) = self.heap.pop() {
            if self.state(key.3) == CellState::Enqueued && self.key(key.3) == key {
                return Some(key.3);
            }
        }
        None
    }

    /// Puts a cell that was popped back.
    pub fn put_back(&mut self, cell: u32) {
        self.set_state(cell, CellState::Enqueued);
        self.push(cell);
    }

    pub fn push(&mut self, cell: u32) {
        self.heap.push(Reverse(self.key(cell)));
    }

    fn key(&self, number: u32) -> Key {
        let cell = &self.cells[number as usize];
        let solidity = match self.heuristic {
            Heuristic::Solidity => cell.eta().to_bits(),
            Heuristic::Layer => 0,
        };
        (solidity, cell.layer, cell.stamp, number)
    }

    /// A projected cell tells a neighbour, clean or in the front, that it stands before it.
    pub fn reach(&mut self, from: u32, shares: &[f32; 3], a: Aabb, to: u32, b: Aabb) {
        let source = self.cells[from as usize];
        let clean = self.state(to) == CellState::Clean;
        if clean {
            self.enqueue(to, source.layer + 1, source.eta());
        } else if self.heuristic == Heuristic::Layer {
            return;
        }
        if self.heuristic == Heuristic::Solidity {
            let direction = self.sight.toward(b.center());
            let aligned = normal(a, b).dot(direction).max(0.0);
            let weight = aligned * aligned;
            if weight > 0.0 {
                let cell = &mut self.cells[to as usize];
                cell.sum += weight * (source.eta() + share_along(shares, direction));
                cell.weight += weight;
            } else if !clean {
                return;
            }
        }
        self.push(to);
    }
}

/// The direction across what two boxes share, from the first to the second, a unit vector: of boxes that overlap, from middle to
/// middle.
fn normal(a: Aabb, b: Aabb) -> Vec3 {
    let side = |axis: usize| {
        let (above, below) = (b.min[axis] >= a.max[axis], b.max[axis] <= a.min[axis]);
        f32::from(u8::from(above)) - f32::from(u8::from(below))
    };
    let across = Vec3::new(side(0), side(1), side(2));
    if across == Vec3::ZERO { (b.center() - a.center()).normalize_or_zero() } else { across.normalize() }
}
