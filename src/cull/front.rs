//! The front of prioritized-layered projection (Correa, Klosowski and Silva 2002): a priority queue over cells.
//!
//! A cell has a rank when it joins: its **layer**, one more than that of the neighbour that brought it; or, for **accumulated solidity**,
//! its place among all cells, nearest first, so that what stands before a cell is known when its turn comes
//! (`accumulated_solidity.rs`). The least goes first, ties by time stamp. Cost: the logarithm of what waits, a cell.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// What has become of a cell in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum CellState {
    /// Not met.
    #[default]
    Clean,
    /// Waits in the front.
    Enqueued,
    /// Its objects were looked at, and its neighbours met.
    Projected,
    /// Shows no sample: outside of the frustum, or found hidden. What is hidden stays so while the frame is drawn.
    Unseen,
}

#[derive(Debug, Clone, Copy, Default)]
struct Cell {
    state: CellState,
    rank: u32,
    stamp: u32,
}

/// The front of one frame.
#[derive(Debug, Default)]
pub(super) struct Front {
    cells: Vec<Cell>,
    /// Rank, time stamp, cell: the least first.
    heap: BinaryHeap<Reverse<(u32, u32, u32)>>,
    stamp: u32,
}

impl Front {
    pub fn begin(&mut self, cells: usize) {
        self.stamp = 0;
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

    pub fn rank(&self, cell: u32) -> u32 {
        self.cells[cell as usize].rank
    }

    /// A clean cell joins.
    pub fn push(&mut self, cell: u32, rank: u32) {
        self.cells[cell as usize] = Cell { state: CellState::Enqueued, rank, stamp: self.stamp };
        self.stamp += 1;
        self.put_back(cell);
    }

    /// The next cell leaves, and is still [`CellState::Enqueued`].
    pub fn pop(&mut self) -> Option<u32> {
        self.heap.pop().map(|Reverse((_, _, cell))| cell)
    }

    /// A cell that left comes back.
    pub fn put_back(&mut self, cell: u32) {
        let Cell { rank, stamp, .. } = self.cells[cell as usize];
        self.heap.push(Reverse((rank, stamp, cell)));
    }
}
