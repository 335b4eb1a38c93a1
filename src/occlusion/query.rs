//! The two tests in one pass, for an opacity threshold of 1: is every sample of a rectangle covered by something strictly
//! nearer?
//!
//! At that threshold the overlap test asks for coverage of every sample, and the depth test for a nearer depth at
//! every covered one: together, for an effective depth above the box's at every sample. Tiles answer for their blocks, blocks
//! for their samples.

use homcull_simd::{Mask, Simd};

use super::map::{MapView, SampleDepths};
use crate::geometry::SampleRect;
use crate::raster::{lanes, range_mask, tile_lanes};

/// How the no-background Z-buffer is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthReading {
    /// `depth=nbz`: each sample's own effective depth (thesis 6.4).
    #[default]
    PerSample,
    /// `depth=nbz-block`: the farthest effective depth of each 8x8 block's covered samples.
    PerBlock,
}

/// The samples of block (bx, by) inside a rectangle, as a coverage word.
#[inline(always)]
pub(crate) fn rect_word(r: SampleRect, bx: i32, by: i32) -> u64 {
    let (x0, x1) = ((r.x0 - 8 * bx).max(0), (r.x1 - 8 * bx).min(7));
    let (y0, y1) = ((r.y0 - 8 * by).max(0), (r.y1 - 8 * by).min(7));
    let columns = ((0xFF_u64 << x0) & (0xFF >> (7 - x1))).wrapping_mul(0x0101_0101_0101_0101);
    columns & (!0_u64 << (8 * y0)) & (!0_u64 >> (8 * (7 - y1)))
}

impl<T: SampleDepths> MapView<'_, T> {
    /// True when every sample of the rectangle (not empty, inside the band) is covered by something nearer than `z`.
    #[inline(always)]
    pub fn hides<S: Simd>(&self, s: S, r: SampleRect, z: f32, reading: DepthReading) -> bool {
        let blocks = [r.x0 >> 3, r.y0 >> 3, r.x1 >> 3, r.y1 >> 3];
        let (tx0, tx1) = (r.x0 >> 5, r.x1 >> 5);
        let depth = s.splat_f(z);
        for ty in r.y0 >> 5..=r.y1 >> 5 {
            let mut group = tx0 & !15;
            while group <= tx1 {
                let at = (ty as usize - self.band.tile_y0) * self.band.grid.tile_stride() + group as usize;
                let floors = s.load_f(lanes(&self.tiles[at..at + 16]));
                let mut open = s.ge_f(depth, floors) & range_mask(tx0 - group, tx1 - group);
                while open != 0 {
                    let tx = group + open.trailing_zeros() as i32;
                    open &= open - 1;
                    if !self.tile_hides(s, r, blocks, tx, ty, z, reading) {
                        return false;
                    }
                }
                group += 16;
            }
        }
        true
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // the rectangle, in samples and in blocks, and where it is looked at
    fn tile_hides<S: Simd>(
        &self,
        s: S,
        r: SampleRect,
        blocks: [i32; 4],
        tx: i32,
        ty: i32,
        z: f32,
        reading: DepthReading,
    ) -> bool {
        let tile = self.tile(tx, ty);
        let floors = s.load_f(&self.floors[tile]);
        let mut open = s.ge_f(s.splat_f(z), floors) & tile_lanes(blocks, tx, ty);
        while open != 0 {
            let l = open.trailing_zeros() as usize;
            open &= open - 1;
            let word = rect_word(r, 4 * tx + (l & 3) as i32, 4 * ty + (l >> 2) as i32);
            let covered = self.cover[tile][l];
            // A block whose floor does not decide is open unless its samples do. Read as one, it has no nearer ones.
            let floor_decides = reading == DepthReading::PerBlock && self.floors[tile][l] > 0.0;
            if floor_decides || covered & word != word || self.samples_in_front(s, tile, l, z, reading, word, covered) {
                return false;
            }
        }
        true
    }

    /// True when a sample of the word, or with the blockwise reading any covered one, is not nearer than `z`.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn samples_in_front<S: Simd>(
        &self,
        s: S,
        tile: usize,
        block: usize,
        z: f32,
        reading: DepthReading,
        word: u64,
        covered: u64,
    ) -> bool {
        let asked = match reading {
            DepthReading::PerSample => word,
            DepthReading::PerBlock => covered,
        };
        let depth = s.splat_f(z);
        let mut open = 0;
        let samples = self.samples[tile].block(block);
        for i in 0..4 {
            open |= s.ge_f(depth, s.load_f(&samples[i])) & (asked >> (16 * i)) as Mask;
        }
        open != 0
    }

    /// The depth test alone, without background: true when no covered sample of the rectangle is at `z` or farther.
    #[inline(always)]
    pub fn covered_is_nearer<S: Simd>(&self, s: S, r: SampleRect, z: f32, reading: DepthReading) -> bool {
        for by in r.y0 >> 3..=r.y1 >> 3 {
            for bx in r.x0 >> 3..=r.x1 >> 3 {
                let (tile, block) = (self.tile(bx >> 2, by >> 2), ((by & 3) * 4 + (bx & 3)) as usize);
                if self.floors[tile][block] > z {
                    continue;
                }
                if self.floors[tile][block] > 0.0 && self.cover[tile][block] == 0 {
                    return false;
                }
                let covered = self.word(tile, block);
                let word = rect_word(r, bx, by) & covered;
                if word & !self.cover[tile][block] != 0 {
                    return false;
                }
                if word != 0 && self.samples_in_front(s, tile, block, z, reading, word, covered) {
                    return false;
                }
            }
        }
        true
    }

    /// How many samples of the rectangle (not empty, inside the band) something at `z` may show at; beyond `enough` they are not counted on.
    #[inline(always)]
    #[cfg(feature = "bvh")]
    pub fn visible_samples<S: Simd>(&self, s: S, r: SampleRect, z: f32, enough: u32) -> u32 {
        let mut count = 0;
        let depth = s.splat_f(z);
        for by in r.y0 >> 3..=r.y1 >> 3 {
            for bx in r.x0 >> 3..=r.x1 >> 3 {
                let (tile, block) = (self.tile(bx >> 2, by >> 2), ((by & 3) * 4 + (bx & 3)) as usize);
                if self.floors[tile][block] > z {
                    continue;
                }
                let (word, covered) = (rect_word(r, bx, by), self.cover[tile][block]);
                let samples = self.samples[tile].block(block);
                for i in 0..4 {
                    let behind = s.gt_f(s.load_f(&samples[i]), depth) & (covered >> (16 * i)) as Mask;
                    count += ((word >> (16 * i)) as Mask & !behind).count_ones();
                }
                if count > enough {
                    return count;
                }
            }
        }
        count
    }

    /// True when a sample of the rectangle (not empty, inside the band) is not covered.
    #[inline(always)]
    pub fn is_open<S: Simd>(&self, s: S, r: SampleRect) -> bool {
        let blocks = [r.x0 >> 3, r.y0 >> 3, r.x1 >> 3, r.y1 >> 3];
        let zero = s.splat_f(0.0);
        for ty in r.y0 >> 5..=r.y1 >> 5 {
            for tx in r.x0 >> 5..=r.x1 >> 5 {
                let tile = self.tile(tx, ty);
                let mut open = !s.gt_f(s.load_f(&self.floors[tile]), zero) & tile_lanes(blocks, tx, ty);
                while open != 0 {
                    let l = open.trailing_zeros() as usize;
                    open &= open - 1;
                    let word = rect_word(r, 4 * tx + (l & 3) as i32, 4 * ty + (l >> 2) as i32);
                    if word & !self.cover[tile][l] != 0 {
                        return true;
                    }
                }
            }
        }
        false
    }
}
