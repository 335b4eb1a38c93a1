//! The sample grid: 8x8 blocks, tiles of 4x4 blocks, and bands of tile rows.
//!
//! All per-block and per-sample storage is tile-major: the sixteen blocks of a tile lie together, so that a tile's depths
//! are one vector, and a band of tile rows is one contiguous piece that a thread can own.

use crate::view::Viewport;

/// Samples along a side of a block; a block's coverage is one 64-bit word, bit `8 y + x`.
pub const BLOCK: usize = 8;
/// Blocks along a side of a tile.
pub const TILE_BLOCKS: usize = 4;
/// Samples along a side of a tile.
pub const TILE: usize = BLOCK * TILE_BLOCKS;

/// How a viewport is cut into tiles and blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    width: i32,
    height: i32,
    tiles_x: usize,
    tiles_y: usize,
}

impl Grid {
    /// The grid over a viewport.
    pub fn new(viewport: Viewport) -> Grid {
        let (width, height) = (viewport.width() as usize, viewport.height() as usize);
        Grid {
            width: width as i32,
            height: height as i32,
            tiles_x: width.div_ceil(TILE),
            tiles_y: height.div_ceil(TILE),
        }
    }

    /// Width in samples.
    pub fn width(self) -> i32 {
        self.width
    }

    /// Height in samples.
    pub fn height(self) -> i32 {
        self.height
    }

    /// Tiles in a row.
    pub fn tiles_x(self) -> usize {
        self.tiles_x
    }

    /// Rows of tiles.
    pub fn tiles_y(self) -> usize {
        self.tiles_y
    }

    /// Blocks in a row that hold a sample of the viewport.
    pub fn blocks_x(self) -> usize {
        (self.width as usize).div_ceil(BLOCK)
    }

    /// Rows of blocks that hold a sample of the viewport.
    pub fn blocks_y(self) -> usize {
        (self.height as usize).div_ceil(BLOCK)
    }

    /// Floats in a row of per-tile depths: whole vectors of sixteen.
    pub(crate) fn tile_stride(self) -> usize {
        self.tiles_x.next_multiple_of(16)
    }

    /// Where block (bx, by) lies: its tile, and its place among the tile's sixteen.
    pub fn place(self, bx: usize, by: usize) -> (usize, usize) {
        let tile = (by / TILE_BLOCKS) * self.tiles_x + bx / TILE_BLOCKS;
        (tile, (by % TILE_BLOCKS) * TILE_BLOCKS + bx % TILE_BLOCKS)
    }

    /// The samples of block (bx, by) that lie outside the viewport, as a coverage word.
    pub fn padding(self, bx: usize, by: usize) -> u64 {
        let inside = |side: i32, block: usize| (side - (block * BLOCK) as i32).clamp(0, BLOCK as i32) as u32;
        let (columns, rows) = (inside(self.width, bx), inside(self.height, by));
        if columns == 0 || rows == 0 {
            return !0;
        }
        let row = 0xFF_u64 >> (8 - columns);
        let all = 0x0101_0101_0101_0101_u64.wrapping_mul(row);
        !(all & (!0 >> (64 - 8 * rows)))
    }

    /// The tile rows cut into `count` bands as even as they come; none is empty.
    pub(crate) fn bands(self, count: usize) -> impl Iterator<Item = Band> {
        let count = count.clamp(1, self.tiles_y);
        (0..count).map(move |i| Band {
            grid: self,
            tile_y0: i * self.tiles_y / count,
            tile_y1: (i + 1) * self.tiles_y / count,
        })
    }
}

/// Some rows of tiles: the part of the screen that one thread works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Band {
    pub grid: Grid,
    /// First row of tiles.
    pub tile_y0: usize,
    /// One past the last row of tiles.
    pub tile_y1: usize,
}

impl Band {
    pub fn whole(grid: Grid) -> Band {
        Band { grid, tile_y0: 0, tile_y1: grid.tiles_y }
    }

    /// The band's first row of samples.
    pub fn first_row(self) -> i32 {
        (self.tile_y0 * TILE) as i32
    }

    /// The band's last row of samples inside the viewport.
    pub fn last_row(self) -> i32 {
        ((self.tile_y1 * TILE) as i32).min(self.grid.height) - 1
    }

    pub fn tiles(self) -> usize {
        (self.tile_y1 - self.tile_y0) * self.grid.tiles_x
    }
}
