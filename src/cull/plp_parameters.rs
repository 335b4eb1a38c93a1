//! Parameters of prioritized-layered projection, as they are written on the command line: `plp:budget=140000,heuristic=layer`.

use crate::error::{Error, Result};
use crate::scene::DEFAULT_LEAF_TRIANGLES;

/// Triangles a frame: what the gem walked the power plant with. Its code's own default is 10,000. A budget is what a machine
/// draws in time, not a share of the scene.
pub const DEFAULT_BUDGET: u64 = 140_000;

/// What decides which cell of the front is projected next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Heuristic {
    /// The fewest layers of cells from where the view begins (Correa, Klosowski and Silva 2002).
    Layer,
    /// The nearest cell, as long as the accumulated solidity before it lets it show; then the objects that are expected to show most
    /// samples a triangle (after Klosowski and Silva 2000): shows more than layers, as measured.
    #[default]
    Solidity,
}

/// What is projected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CellKind {
    /// Leaves of an octree: they fill space.
    #[default]
    Octree,
    /// Leaves of the bounding volume hierarchy, neighbours where their boxes touch: approximate, not for cPLP.
    Bvh,
}

/// Parameters of `plp` and `cplp`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlpParameters {
    /// Triangles of the visible set, at most; the first object is always taken. In cPLP, of the first guess.
    pub budget: u64,
    /// What is projected next.
    pub heuristic: Heuristic,
    /// What is projected.
    pub cells: CellKind,
    /// Triangles of an octree's leaf.
    pub leaf: u32,
}

impl Default for PlpParameters {
    fn default() -> Self {
        PlpParameters {
            budget: DEFAULT_BUDGET,
            heuristic: Heuristic::default(),
            cells: CellKind::default(),
            leaf: DEFAULT_LEAF_TRIANGLES,
        }
    }
}

impl PlpParameters {
    /// Sets one by name. `unknown` makes the error for a key that is none of them.
    pub(super) fn set(&mut self, key: &str, value: &str, unknown: impl Fn() -> Error) -> Result<()> {
        let bad = |reason: &str| Error::parameter(key, value, reason);
        match (key, value) {
            ("budget", _) => self.budget = value.parse().map_err(|_| bad("a number of triangles"))?,
            ("heuristic", "solidity") => self.heuristic = Heuristic::Solidity,
            ("heuristic", "layer") => self.heuristic = Heuristic::Layer,
            ("heuristic", _) => return Err(bad("solidity or layer")),
            ("cells", "octree") => self.cells = CellKind::Octree,
            ("cells", "bvh") => self.cells = CellKind::Bvh,
            ("cells", _) => return Err(bad("octree or bvh")),
            ("leaf", _) => {
                let leaf = value.parse().ok().filter(|&n: &u32| n > 0);
                self.leaf = leaf.ok_or_else(|| bad("triangles of an octree's leaf, 1 to 4294967295"))?;
            }
            _ => return Err(unknown()),
        }
        Ok(())
    }

    /// All with their values.
    pub(super) fn list(&self) -> Vec<(String, String)> {
        let heuristic = match self.heuristic {
            Heuristic::Solidity => "solidity",
            Heuristic::Layer => "layer",
        };
        let mut out = vec![("budget", self.budget.to_string()), ("heuristic", heuristic.into())];
        match self.cells {
            CellKind::Octree => out.extend([("cells", "octree".into()), ("leaf", self.leaf.to_string())]),
            CellKind::Bvh => out.push(("cells", "bvh".into())),
        }
        out.into_iter().map(|(k, v)| (k.to_owned(), v)).collect()
    }

    /// Whether cPLP can be had with them.
    ///
    /// # Errors
    /// [`Error::Parameter`] for cells that do not fill space: what lies between them would stop the front.
    pub fn check_conservative(&self) -> Result<()> {
        match self.cells {
            CellKind::Octree => Ok(()),
            CellKind::Bvh => Err(Error::parameter("cells", "bvh", "cplp needs cells that fill space: octree")),
        }
    }
}
