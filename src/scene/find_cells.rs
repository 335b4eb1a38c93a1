//! Cells found in a scene that brings none: boxes that grow from wall to wall in the grid of the scene's large opaque faces.
//!
//! Cells and portals of architectural models are mostly found by splitting space top down along walls (Teller 1992; Haumont et al.
//! 2003); but the section of a building that one plane cuts is mostly open, whatever is covered. So boxes grow from the bottom up: the
//! largest free box of the grid ([`PlaneGrid`]) takes layer after layer, always through its openest side, until each
//! next layer lies behind a wall, has a wall within, or is taken. What is left goes on the same way.
//!
//! Invariant: the cells tile the box around the scene, and a common face of two is a portal but for what is proven covered by opaque
//! triangles (`cover`), whatever the planes and the order. So the result is never wrong: at worst it shows too much. Cost: a
//! few seconds for a million triangles.

use std::collections::BTreeSet;

use glam::DVec3;

use super::cover::Rect;
use super::plane_grid::PlaneGrid;
use super::{Cell, Cells, Portal, PreparedScene};

/// The part of a face above which it is a wall, and nothing grows through it.
const WALL: f64 = 0.2;
/// Cells that stop at walls; what is then left is filled without regard to them.
const MOST: usize = 2048;
/// A box of the grid that is in no cell yet.
const FREE: u32 = u32::MAX;

/// Cells, and how good they are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FoundCells {
    /// Cells and portals, numbered in no order worth knowing, the same on every machine. None for a scene without triangles.
    pub cells: Cells,
    /// Of the area of all faces between cells, the part that is no portal, 0 to 1.
    pub covered: f64,
}

/// Finds cells and portals.
pub fn find_cells(scene: &PreparedScene) -> FoundCells {
    let Some(grid) = PlaneGrid::new(scene) else { return FoundCells::default() };
    let tiling = Tiling::new(&grid);
    let (portals, covered) = tiling.portals(scene.origin);
    let corner = |p: [usize; 3]| tiling.corner(p) + scene.origin;
    let cell = |(i, b): (usize, &Block)| Cell { name: i.to_string(), min: corner(b.low), max: corner(b.high) };
    let cells = tiling.blocks.iter().enumerate().map(cell).collect();
    FoundCells { cells: Cells::from_checked(cells, portals), covered }
}

/// A box of the grid's boxes.
#[derive(Debug, Clone, Copy)]
struct Block {
    low: [usize; 3],
    high: [usize; 3],
}

impl Block {
    /// Its rectangle across an axis, in the two axes after.
    fn section(&self, axis: usize) -> [[usize; 2]; 2] {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        [[self.low[u], self.low[v]], [self.high[u], self.high[v]]]
    }

    /// The layer next to it, and the plane between; `None` at the end of the grid.
    fn layer(&self, axis: usize, up: bool, steps: [usize; 3]) -> Option<(Block, usize)> {
        let plane = if up { self.high[axis] } else { self.low[axis] };
        if plane == if up { steps[axis] } else { 0 } {
            return None;
        }
        let mut layer = *self;
        layer.low[axis] = if up { plane } else { plane - 1 };
        layer.high[axis] = layer.low[axis] + 1;
        Some((layer, plane))
    }

    fn join(&self, other: &Block) -> Block {
        Block {
            low: [0, 1, 2].map(|k| self.low[k].min(other.low[k])),
            high: [0, 1, 2].map(|k| self.high[k].max(other.high[k])),
        }
    }
}

/// The grid's boxes, shared out among cells.
struct Tiling<'g> {
    grid: &'g PlaneGrid,
    /// The cell of each box, or [`FREE`].
    owner: Vec<u32>,
    blocks: Vec<Block>,
}

impl Tiling<'_> {
    fn new(grid: &PlaneGrid) -> Tiling<'_> {
        let [nx, ny, nz] = grid.steps();
        let mut tiling = Tiling { grid, owner: vec![FREE; nx * ny * nz], blocks: Vec::new() };
        let place = |i: u32| [i as usize / (ny * nz), i as usize / nz % ny, i as usize % nz];
        let volume = |p: [usize; 3]| (0..3).map(|k| grid.lines[k][p[k] + 1] - grid.lines[k][p[k]]).product::<f64>();
        let volumes: Vec<f64> = (0..tiling.owner.len() as u32).map(|i| volume(place(i))).collect();
        let mut seeds: Vec<u32> = (0..tiling.owner.len() as u32).collect();
        seeds.sort_unstable_by(|&a, &b| volumes[b as usize].total_cmp(&volumes[a as usize]).then(a.cmp(&b)));
        for seed in seeds {
            if tiling.owner[seed as usize] == FREE {
                let low = place(seed);
                let block = tiling.grow(Block { low, high: low.map(|v| v + 1) });
                let number = tiling.blocks.len() as u32;
                tiling.boxes(&block).for_each(|i| tiling.owner[i] = number);
                tiling.blocks.push(block);
            }
        }
        tiling
    }

    /// Numbers of the boxes of a block.
    fn boxes(&self, block: &Block) -> impl Iterator<Item = usize> + use<> {
        let (Block { low, high }, [_, ny, nz]) = (*block, self.grid.steps());
        (low[0]..high[0]).flat_map(move |x| {
            (low[1]..high[1]).flat_map(move |y| (low[2]..high[2]).map(move |z| (x * ny + y) * nz + z))
        })
    }

    /// A block with all layers that it can take.
    fn grow(&self, mut block: Block) -> Block {
        let sides = (0..3).flat_map(|axis| [(axis, false), (axis, true)]);
        loop {
            let layers = sides.clone().filter_map(|(axis, up)| self.wanted(&block, axis, up));
            // The openest side; of equals, where most is won.
            let best = layers.min_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
            match best {
                Some((.., layer)) => block = block.join(&layer),
                None => return block,
            }
        }
    }

    /// The layer on a side of a block, if it shall take that: what of its face is covered, its volume, the layer.
    fn wanted(&self, block: &Block, axis: usize, up: bool) -> Option<(f64, f64, Block)> {
        let (layer, plane) = block.layer(axis, up, self.grid.steps())?;
        let [low, high] = block.section(axis);
        let covered = self.grid.covered(axis, plane, low, high);
        let stops = self.blocks.len() < MOST && (covered > WALL || self.has_wall(&layer));
        if stops || self.boxes(&layer).any(|i| self.owner[i] != FREE) {
            return None;
        }
        let size = self.corner(layer.high) - self.corner(layer.low);
        Some((covered.max(0.0), size.element_product(), layer))
    }

    /// Whether a plane within a block is a wall there.
    fn has_wall(&self, block: &Block) -> bool {
        (0..3).any(|axis| {
            let [low, high] = block.section(axis);
            (block.low[axis] + 1..block.high[axis]).any(|plane| self.grid.covered(axis, plane, low, high) > WALL)
        })
    }

    /// The corner where three lines meet, about the scene's origin.
    fn corner(&self, p: [usize; 3]) -> DVec3 {
        let lines = &self.grid.lines;
        DVec3::new(lines[0][p[0]], lines[1][p[1]], lines[2][p[2]])
    }

    /// The open parts of all common faces, in the world, and the part of their area that is not open.
    fn portals(&self, origin: DVec3) -> (Vec<Portal>, f64) {
        let (mut out, mut all, mut open) = (Vec::new(), 0.0, 0.0);
        for (low, block) in self.blocks.iter().enumerate() {
            for axis in 0..3 {
                let Some((layer, plane)) = block.layer(axis, true, self.grid.steps()) else { continue };
                let beyond: BTreeSet<u32> = self.boxes(&layer).map(|i| self.owner[i]).collect();
                for high in beyond {
                    let rect = self.common(block, &self.blocks[high as usize], axis);
                    all += rect.area();
                    for part in self.grid.walls.open_parts(axis, self.grid.lines[axis][plane], rect) {
                        open += part.area();
                        let cells = [low as u32, high];
                        let [min, max] = self.in_world(axis, plane, part, rect, origin);
                        out.push(Portal { cells, min, max });
                    }
                }
            }
        }
        (out, if all > 0.0 { (1.0 - open / all).max(0.0) } else { 0.0 })
    }

    /// What the sections of two blocks have in common.
    fn common(&self, a: &Block, b: &Block, axis: usize) -> Rect {
        let ([a_low, a_high], [b_low, b_high]) = (a.section(axis), b.section(axis));
        let low = [0, 1].map(|k| a_low[k].max(b_low[k]));
        let high = [0, 1].map(|k| a_high[k].min(b_high[k]));
        self.grid.rect(axis, low, high)
    }

    /// The corners of an open part of a face, in the world. A sliver that numbers there do not tell from a line becomes as
    /// wide as the face.
    fn in_world(&self, axis: usize, plane: usize, part: Rect, face: Rect, origin: DVec3) -> [DVec3; 2] {
        let (mut min, mut max) = (origin, origin);
        min[axis] += self.grid.lines[axis][plane];
        max[axis] = min[axis];
        for (k, along) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().enumerate() {
            let is_line = origin[along] + part.min[k] == origin[along] + part.max[k];
            let ends = if is_line { face } else { part };
            min[along] += ends.min[k];
            max[along] += ends.max[k];
        }
        [min, max]
    }
}
