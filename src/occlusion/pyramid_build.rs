//! Filling the pyramid from the coverage words (Zhang 1998, 4.3).
//!
//! Only tiles that changed are looked at, and above them only the pixels over those: the cost of an update is proportional
//! to what changed, beside a glance at one flag a tile. At 8x8 samples a pixel is one word, and levels 0 to 2 of a tile depend
//! on that tile alone: sixteen population counts, added up while they are in registers. Other blocks are cut out of the
//! words that they touch, at some nanoseconds a word.

use homcull_simd::{Kernel, Mask, Simd, prefetch};

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
            let columns = pyramid.grid.tiles_x();
            let mut levels = TileLevels::new(pyramid);
            for &tile in &lists.changed {
                let (x, y) = place(tile);
                levels.update(s, coverage, columns, x, y);
            }
            // Tiles are pixels of level 2.
            level = 3;
            if lists.changed.len() == dirty.len() {
                while level < pyramid.levels() {
                    add_all(pyramid, level);
                    level += 1;
                }
            }
        } else {
            lists.climb_to_pixels(pyramid);
            for &pixel in &lists.changed {
                let (x, y) = place(pixel);
                count_pixel(pyramid, coverage, luminance, x, y);
            }
        }
        while level < pyramid.levels() {
            lists.climb(pyramid.size(level).0);
            add_children(pyramid, level, &lists.changed);
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

/// Levels 0, 1 and 2 where tiles fill them; levels that are not there are empty.
struct TileLevels<'a> {
    finest: &'a mut [u8],
    size: (usize, usize),
    level_1: &'a mut [u32],
    size_1: (usize, usize),
    level_2: &'a mut [u32],
    width_2: usize,
}

impl<'a> TileLevels<'a> {
    #[inline(always)]
    fn new(pyramid: &'a mut Pyramid) -> TileLevels<'a> {
        let Pyramid { finest, maps, .. } = pyramid;
        let (level_0, coarser) = maps.split_at_mut(1);
        let (level_1, coarser) = coarser.split_at_mut(coarser.len().min(1));
        let size = (level_0[0].width, level_0[0].height);
        let mut levels = TileLevels { finest, size, level_1: &mut [], size_1: (0, 0), level_2: &mut [], width_2: 0 };
        if let Some(map) = level_1.first_mut() {
            (levels.size_1, levels.level_1) = ((map.width, map.height), &mut map.holes);
        }
        if let Some(map) = coarser.first_mut() {
            (levels.width_2, levels.level_2) = (map.width, &mut map.holes);
        }
        levels
    }

    /// One tile.
    #[inline(always)]
    fn update<S: Simd>(&mut self, s: S, coverage: Coverage<'_>, columns: usize, tile_x: usize, tile_y: usize) {
        let rows = tile_holes(s, coverage, tile_y * columns + tile_x);
        let (x, y) = (4 * tile_x, 4 * tile_y);
        // At most 128 a byte: two rows of blocks are added up without a carry, then two columns, 16 bits each.
        let mut sums = [rows[0] + rows[1], rows[2] + rows[3]];
        for pair in &mut sums {
            *pair = (*pair & 0x00FF_00FF) + (*pair >> 8 & 0x00FF_00FF);
        }
        if let Some(to) = self.level_2.get_mut(tile_y * self.width_2 + tile_x) {
            *to = (sums[0] & 0xFFFF) + (sums[0] >> 16) + (sums[1] & 0xFFFF) + (sums[1] >> 16);
        }
        let (width, height) = self.size;
        if x + 4 <= width && y + 4 <= height {
            for i in 0..4 {
                let at = (y + i) * width + x;
                self.finest[at..at + 4].copy_from_slice(&rows[i].to_le_bytes());
            }
        } else {
            for i in 0..(height - y).min(4) {
                let (at, columns) = ((y + i) * width + x, (width - x).min(4));
                self.finest[at..at + columns].copy_from_slice(&rows[i].to_le_bytes()[..columns]);
            }
        }
        let (width, height) = self.size_1;
        for i in 0..2 {
            let (x, y) = (2 * tile_x, 2 * tile_y + i);
            let at = y * width + x;
            if y < height && x + 2 <= width {
                self.level_1[at..at + 2].copy_from_slice(&[sums[i] & 0xFFFF, sums[i] >> 16]);
            } else if y < height {
                self.level_1[at] = sums[i] & 0xFFFF;
            }
        }
    }
}

/// Tiles whose memory is asked for ahead: they lie beyond the nearest cache.
const AHEAD: usize = 6;

/// The bytes of blocks that are not covered whole, by four bits of a mask of those that are.
const NOT_WHOLE: [u32; 16] = {
    let mut table = [0; 16];
    let mut bits = 0;
    while bits < 16 {
        let mut block = 0;
        while block < 4 {
            if bits >> block & 1 == 0 {
                table[bits] |= 0xFF << (8 * block);
            }
            block += 1;
        }
        bits += 1;
    }
    table
};

/// Holes of a tile's blocks, four a row, a byte each.
#[inline(always)]
fn tile_holes<S: Simd>(s: S, coverage: Coverage<'_>, tile: usize) -> [u32; 4] {
    prefetch(coverage.map.floors, tile + AHEAD);
    for half in 0..2 {
        prefetch(coverage.map.cover.as_flattened(), 16 * (tile + AHEAD) + 8 * half);
    }
    let whole: Mask = s.gt_f(s.load_f(&coverage.map.floors[tile]), s.splat_f(0.0));
    let mut rows = [0; 4];
    if whole == !0 {
        return rows;
    }
    let cover = &coverage.map.cover[tile];
    let mut holes = [0_u8; 16];
    match coverage.fused {
        None => {
            for block in 0..16 {
                holes[block] = cover[block].count_zeros() as u8;
            }
        }
        Some(fused) => {
            let fused = &fused[tile];
            for block in 0..16 {
                holes[block] = (cover[block] | fused[block]).count_zeros() as u8;
            }
        }
    }
    for row in 0..4 {
        let four = [holes[4 * row], holes[4 * row + 1], holes[4 * row + 2], holes[4 * row + 3]];
        rows[row] = u32::from_le_bytes(four) & NOT_WHOLE[usize::from(whole >> (4 * row) & 15)];
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
    let map = &mut pyramid.maps[0];
    let at = y * map.width + x;
    if map.holes.is_empty() {
        pyramid.finest[at] = holes as u8;
    } else {
        map.holes[at] = holes;
    }
    if let Some(to) = map.luminance.get_mut(at) {
        *to = light;
    }
}

/// All pixels of a level above level 1, without luminance: a pixel has a child in the first row and column at least.
#[inline(always)]
fn add_all(pyramid: &mut Pyramid, level: usize) {
    let (below, from) = pyramid.maps.split_at_mut(level);
    let (below, to) = (&below[level - 1], &mut from[0]);
    for (y, to) in to.holes.chunks_exact_mut(to.width).enumerate() {
        let upper = &below.holes[2 * y * below.width..][..below.width];
        let lower =
            if 2 * y + 1 < below.height { &below.holes[(2 * y + 1) * below.width..][..below.width] } else { &[] };
        for (x, to) in to.iter_mut().enumerate() {
            *to = 0;
            for row in [upper, lower] {
                if let Some(&[a, b]) = row.get(2 * x..2 * x + 2) {
                    *to += a + b;
                } else if let Some(&a) = row.get(2 * x) {
                    *to += a;
                }
            }
        }
    }
}

/// Pixels of a level above level 0, from the four below each.
#[inline(always)]
fn add_children(pyramid: &mut Pyramid, level: usize, pixels: &[u32]) {
    let Pyramid { finest, maps, .. } = pyramid;
    let (below, from) = maps.split_at_mut(level);
    let (below, to) = (&below[level - 1], &mut from[0]);
    let (width, height) = (below.width, below.height);
    for &pixel in pixels {
        let (x, y) = place(pixel);
        let columns = 2 * x..(2 * x + 2).min(width);
        let mut holes = 0;
        for cy in 2 * y..(2 * y + 2).min(height) {
            let row = cy * width + columns.start..cy * width + columns.end;
            if below.holes.is_empty() {
                for &h in &finest[row] {
                    holes += u32::from(h);
                }
            } else {
                for &h in &below.holes[row] {
                    holes += h;
                }
            }
        }
        to.holes[y * to.width + x] = holes;
        if !to.luminance.is_empty() {
            let mut light = Luminance::default();
            for cy in 2 * y..(2 * y + 2).min(height) {
                for cx in columns.clone() {
                    light += below.luminance[cy * width + cx];
                }
            }
            to.luminance[y * to.width + x] = light;
        }
    }
}
