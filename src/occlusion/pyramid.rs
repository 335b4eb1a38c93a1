//! The hierarchical occlusion maps: exact hole counts, 2x2 above level 0 (Zhang 1998, 4.2 and 4.3).
//!
//! A level-0 pixel is one 8x8 block of samples. What is stored is the number of samples that nothing covers, exact at every
//! level; opacity is one minus their share. Samples outside the viewport count as covered. Levels 0 to 2 of a tile depend on
//! that tile alone, so only tiles that changed are computed anew, and above them only the pixels over those.

use super::map::MapView;
use crate::raster::{BLOCK, Grid};

/// One map of the pyramid, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Level {
    width: usize,
    height: usize,
    /// Samples that a pixel stands for, along a side.
    side: usize,
    holes: Vec<u32>,
}

impl Level {
    /// Width in pixels of this level.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels of this level.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Samples along a side of a pixel.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Samples of pixel (x, y) that nothing covers.
    #[inline]
    pub fn holes(&self, x: usize, y: usize) -> u32 {
        self.holes[y * self.width + x]
    }
}

/// The pyramid, level 0 first: the finest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pyramid {
    grid: Grid,
    /// Level 0: at most 64 holes a pixel.
    finest: Vec<u8>,
    /// Levels 1 and up, to a map of one pixel.
    coarser: Vec<Level>,
    /// Pixels of level 2, one a tile, that changed in the current update, and so on upwards.
    changed: Vec<bool>,
}

impl Pyramid {
    pub(crate) fn new(grid: Grid) -> Pyramid {
        let (mut width, mut height, mut side) = (grid.blocks_x(), grid.blocks_y(), BLOCK);
        let finest = vec![0; width * height];
        let mut coarser = Vec::new();
        while width > 1 || height > 1 {
            (width, height, side) = (width.div_ceil(2), height.div_ceil(2), side * 2);
            coarser.push(Level { width, height, side, holes: vec![0; width * height] });
        }
        Pyramid { grid, finest, coarser, changed: Vec::new() }
    }

    /// Levels, at least one.
    pub fn levels(&self) -> usize {
        1 + self.coarser.len()
    }

    /// Width and height of a level, in pixels.
    pub fn size(&self, level: usize) -> (usize, usize) {
        match level {
            0 => (self.grid.blocks_x(), self.grid.blocks_y()),
            _ => (self.coarser[level - 1].width, self.coarser[level - 1].height),
        }
    }

    /// Samples of pixel (x, y) of a level that nothing covers.
    #[inline]
    pub fn holes(&self, level: usize, x: usize, y: usize) -> u32 {
        match level {
            0 => self.finest[y * self.grid.blocks_x() + x].into(),
            _ => self.coarser[level - 1].holes(x, y),
        }
    }

    /// Samples along a side of a pixel of a level.
    pub fn side(&self, level: usize) -> usize {
        BLOCK << level
    }

    /// The share of a pixel's samples inside the viewport that are covered, 0 to 1.
    pub fn opacity(&self, level: usize, x: usize, y: usize) -> f64 {
        let side = self.side(level);
        let inside = |size: i32, at: usize| (size as usize - at * side).min(side);
        let samples = inside(self.grid.width(), x) * inside(self.grid.height(), y);
        1.0 - f64::from(self.holes(level, x, y)) / samples as f64
    }

    /// Bytes of all levels.
    pub fn bytes(&self) -> usize {
        self.finest.len() + self.coarser.iter().map(|l| l.holes.len() * 4).sum::<usize>()
    }

    /// Brings the pyramid in step with the map; `dirty` names the tiles that changed, and is cleared.
    pub(crate) fn update(&mut self, map: MapView<'_>, dirty: &mut [bool]) {
        let columns = self.grid.tiles_x();
        for (tile, dirty) in dirty.iter().enumerate() {
            if *dirty {
                self.update_tile(map, tile, tile % columns, tile / columns);
            }
        }
        self.changed.clear();
        self.changed.extend_from_slice(dirty);
        dirty.fill(false);
        let (mut width, mut height) = (columns, self.grid.tiles_y());
        for level in 3..self.levels() {
            (width, height) = self.update_level(level, width, height);
        }
    }

    /// Levels 0, 1 and 2 of one tile.
    fn update_tile(&mut self, map: MapView<'_>, tile: usize, tile_x: usize, tile_y: usize) {
        let (blocks_x, blocks_y) = (self.grid.blocks_x(), self.grid.blocks_y());
        let mut quarter = [0; 4];
        for block in 0..16 {
            let (bx, by) = (4 * tile_x + block % 4, 4 * tile_y + block / 4);
            if bx < blocks_x && by < blocks_y {
                let holes = map.word(tile, block).count_zeros();
                self.finest[by * blocks_x + bx] = holes as u8;
                quarter[block / 8 * 2 + block % 4 / 2] += holes;
            }
        }
        for (i, holes) in quarter.into_iter().enumerate() {
            self.set(1, 2 * tile_x + i % 2, 2 * tile_y + i / 2, holes);
        }
        self.set(2, tile_x, tile_y, quarter.iter().sum());
    }

    fn set(&mut self, level: usize, x: usize, y: usize, holes: u32) {
        if let Some(l) = self.coarser.get_mut(level - 1)
            && x < l.width
            && y < l.height
        {
            l.holes[y * l.width + x] = holes;
        }
    }

    /// One level above the tiles, where the level below it (of that size) changed.
    fn update_level(&mut self, level: usize, below_width: usize, below_height: usize) -> (usize, usize) {
        let (width, height) = self.size(level);
        for y in 0..height {
            for x in 0..width {
                let children = || {
                    (0..4).map(|i| (2 * x + i % 2, 2 * y + i / 2)).filter(|&(x, y)| x < below_width && y < below_height)
                };
                let changed = children().any(|(x, y)| self.changed[y * below_width + x]);
                if changed {
                    let holes = children().map(|(x, y)| self.holes(level - 1, x, y)).sum();
                    self.set(level, x, y, holes);
                }
                // The flags of this level overwrite those below: (x, y) is read before any child that lies behind it.
                self.changed[y * width + x] = changed;
            }
        }
        (width, height)
    }
}
