//! Filling the pyramid from the coverage words (Zhang 1998, 4.3).
//!
//! Only tiles that changed are looked at, and above them only the pixels over those: the cost of an update is proportional
//! to what changed, beside a glance at one flag a tile. At 8x8 samples a pixel is one word, and levels 0 to 2 of a tile depend
//! on that tile alone: sixteen population counts, added up while they are in registers. Other blocks are cut out of the
//! words that they touch, at some nanoseconds a word.

use homcull_simd::{Kernel, Mask, Simd};

use super::contrast::Luminance;
use super::map::MapView;
use super::pyramid::{Lists, Pyramid};
use super::query::rect_word;
use crate::raster::{BLOCK, TILE};

/// What covers samples: occluders, and translucent layers that are opaque together.
#[derive(Clone, Copy)]
pub(crate) struct Coverage<'a> {
    pub map: MapView<'a>,
    /// One word a block, tile-major; `None` where layers are not fused.
    pub fused: Option<&'a [[u64; 16]]>,
}

impl Coverage<'_> {
    /// Covered samples of a block; those outside the viewport count as covered.
    #[inline(always)]
    pub fn word(&self, tile: usize, block: usize) -> u64 {
        self.map.word(tile, block) | self.fused.map_or(0, |words| words[tile][block])
    }

    /// Covered samples of block (bx, by).
    #[inline(always)]
    pub fn word_at(&self, bx: i32, by: i32) -> u64 {
        self.word(self.map.tile(bx >> 2, by >> 2), ((by & 3) * 4 + (bx & 3)) as usize)
    }
}

/// Brings a pyramid in step with the map.
pub(crate) struct UpdatePyramid<'a> {
    pub pyramid: &'a mut Pyramid,
    pub coverage: Coverage<'a>,
    /// One a block, tile-major, where contrast is asked for.
    pub luminance: Option<&'a [[Luminance; 16]]>,
    /// Tiles that changed; cleared.
    pub dirty: &'a mut [bool],
}

impl Kernel for UpdatePyramid<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let UpdatePyramid { pyramid, coverage, luminance, dirty } = self;
        let mut lists = std::mem::take(&mut pyramid.lists);
        lists.take_tiles(dirty, pyramid.grid.tiles_x());
        let mut level = 1;
        if pyramid.shape.block == [BLOCK as u32; 2] && luminance.is_none() {
            for &tile in &lists.changed {
                let (x, y) = place(tile);
                update_tile(s, pyramid, coverage, x, y);
            }
            // Tiles are pixels of level 2.
            level = 3;
        } else {
            lists.climb_to_pixels(pyramid);
            for &pixel in &lists.changed {
                let (x, y) = place(pixel);
                count_pixel(pyramid, coverage, luminance, x, y);
            }
        }
        while level < pyramid.levels() {
            lists.climb(pyramid.size(level).0);
            for &pixel in &lists.changed {
                let (x, y) = place(pixel);
                add_children(pyramid, level, x, y);
            }
            level += 1;
        }
        pyramid.lists = lists;
    }
}

#[inline(always)]
fn place(pixel: u32) -> (usize, usize) {
    ((pixel & 0xFFFF) as usize, (pixel >> 16) as usize)
}

impl Lists {
    /// Lists the tiles that changed, and clears their flags.
    #[inline(always)]
    fn take_tiles(&mut self, dirty: &mut [bool], columns: usize) {
        self.changed.clear();
        for (i, group) in dirty.chunks_mut(64).enumerate() {
            let mut any = false;
            for &flag in group.iter() {
                any |= flag;
            }
            if any {
                let (mut x, mut y) = (64 * i % columns, 64 * i / columns);
                for flag in group.iter_mut() {
                    if std::mem::take(flag) {
                        self.changed.push((y << 16 | x) as u32);
                    }
                    x += 1;
                    if x == columns {
                        (x, y) = (0, y + 1);
                    }
                }
            }
        }
    }

    /// From tiles to the level-0 pixels that touch them.
    #[inline(always)]
    fn climb_to_pixels(&mut self, pyramid: &Pyramid) {
        let ((width, height), (m, n)) = (pyramid.size(0), pyramid.pixel(0));
        for i in 0..self.changed.len() {
            let (x, y) = place(self.changed[i]);
            for py in y * TILE / n..=((y * TILE + TILE - 1) / n).min(height - 1) {
                for px in x * TILE / m..=((x * TILE + TILE - 1) / m).min(width - 1) {
                    self.list(width, px, py);
                }
            }
        }
        self.turn(width);
    }

    /// From pixels to those over them, in a level of that width.
    #[inline(always)]
    fn climb(&mut self, width: usize) {
        for i in 0..self.changed.len() {
            let (x, y) = place(self.changed[i]);
            self.list(width, x / 2, y / 2);
        }
        self.turn(width);
    }

    #[inline(always)]
    fn list(&mut self, width: usize, x: usize, y: usize) {
        let listed = &mut self.listed[y * width + x];
        if !*listed {
            *listed = true;
            self.over.push((y << 16 | x) as u32);
        }
    }

    #[inline(always)]
    fn turn(&mut self, width: usize) {
        for &pixel in &self.over {
            let (x, y) = place(pixel);
            self.listed[y * width + x] = false;
        }
        std::mem::swap(&mut self.changed, &mut self.over);
        self.over.clear();
    }
}

impl Pyramid {
    /// Sets a count; pixels and levels that are not there are passed over.
    #[inline(always)]
    fn set(&mut self, level: usize, x: usize, y: usize, holes: u32) {
        let bytes = level == 0 && !self.finest.is_empty();
        if level >= self.maps.len() {
            return;
        }
        let map = &mut self.maps[level];
        if x < map.width && y < map.height {
            let at = y * map.width + x;
            if bytes {
                self.finest[at] = holes as u8;
            } else {
                map.holes[at] = holes;
            }
        }
    }
}

/// Levels 0, 1 and 2 of one tile.
#[inline(always)]
fn update_tile<S: Simd>(s: S, pyramid: &mut Pyramid, coverage: Coverage<'_>, tile_x: usize, tile_y: usize) {
    let (width, height) = pyramid.size(0);
    let tile = tile_y * pyramid.grid.tiles_x() + tile_x;
    let rows = tile_holes(s, coverage, tile);
    let (x, y) = (4 * tile_x, 4 * tile_y);
    let columns = (width - x).min(4);
    for (i, row) in rows.iter().enumerate().take((height - y).min(4)) {
        let at = (y + i) * width + x;
        if columns == 4 {
            pyramid.finest[at..at + 4].copy_from_slice(&row.to_le_bytes());
        } else {
            pyramid.finest[at..at + columns].copy_from_slice(&row.to_le_bytes()[..columns]);
        }
    }
    // At most 128 a byte: two rows of two blocks are added up without a carry.
    let mut all = 0;
    for i in 0..2 {
        let pair = rows[2 * i] + rows[2 * i + 1];
        let left = (pair & 0xFF) + (pair >> 8 & 0xFF);
        let right = (pair >> 16 & 0xFF) + (pair >> 24);
        pyramid.set(1, 2 * tile_x, 2 * tile_y + i, left);
        pyramid.set(1, 2 * tile_x + 1, 2 * tile_y + i, right);
        all += left + right;
    }
    pyramid.set(2, tile_x, tile_y, all);
}

/// Holes of a tile's blocks, four a row, a byte each.
#[inline(always)]
fn tile_holes<S: Simd>(s: S, coverage: Coverage<'_>, tile: usize) -> [u32; 4] {
    let floors = s.load_f(&coverage.map.floors[tile]);
    let whole: Mask = s.gt_f(floors, s.splat_f(0.0));
    let mut rows = [0; 4];
    if whole == !0 {
        return rows;
    }
    let cover = &coverage.map.cover[tile];
    let mut words = *cover;
    if let Some(fused) = coverage.fused {
        for block in 0..16 {
            words[block] |= fused[tile][block];
        }
    }
    for row in 0..4 {
        for column in 0..4 {
            let block = 4 * row + column;
            let holes = if whole >> block & 1 != 0 { 0 } else { words[block].count_zeros() };
            rows[row] |= holes << (8 * column);
        }
    }
    rows
}

/// One level-0 pixel, from the words of the blocks that it touches.
#[inline(always)]
fn count_pixel(
    pyramid: &mut Pyramid,
    coverage: Coverage<'_>,
    luminance: Option<&[[Luminance; 16]]>,
    x: usize,
    y: usize,
) {
    let r = pyramid.rect(0, x, y);
    let (mut holes, mut light) = (0, Luminance::default());
    for by in r.y0 >> 3..=r.y1 >> 3 {
        for bx in r.x0 >> 3..=r.x1 >> 3 {
            let (tile, block) = pyramid.grid.place(bx as usize, by as usize);
            holes += (rect_word(r, bx, by) & !coverage.word(tile, block)).count_ones();
            if let Some(luminance) = luminance {
                light += luminance[tile][block];
            }
        }
    }
    pyramid.set(0, x, y, holes);
    let map = &mut pyramid.maps[0];
    if let Some(to) = map.luminance.get_mut(y * map.width + x) {
        *to = light;
    }
}

/// One pixel above level 0.
#[inline(always)]
fn add_children(pyramid: &mut Pyramid, level: usize, x: usize, y: usize) {
    let (width, height) = pyramid.size(level - 1);
    let (mut holes, mut light) = (0, Luminance::default());
    for cy in 2 * y..(2 * y + 2).min(height) {
        for cx in 2 * x..(2 * x + 2).min(width) {
            holes += pyramid.holes(level - 1, cx, cy);
            if let Some(&l) = pyramid.maps[level - 1].luminance.get(cy * width + cx) {
                light += l;
            }
        }
    }
    pyramid.set(level, x, y, holes);
    let map = &mut pyramid.maps[level];
    if let Some(to) = map.luminance.get_mut(y * map.width + x) {
        *to = light;
    }
}
