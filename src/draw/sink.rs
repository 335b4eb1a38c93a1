//! The sink of the final draw: depth and triangle number of every sample.

use homcull_simd::{Mask, Simd, prefetch};

#[cfg(feature = "bvh")]
use crate::occlusion::MapView;
use crate::occlusion::SampleDepths;
use crate::raster::{Sink, Surface};

/// Depths and triangle numbers of a tile's samples. Where a block's coverage word has no bit they are left over from
/// an earlier frame and mean nothing: they are never cleared.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct TileItems {
    pub depth: [[[f32; 16]; 4]; 16],
    pub item: [[[i32; 16]; 4]; 16],
}

impl TileItems {
    pub const EMPTY: TileItems = TileItems { depth: [[[0.0; 16]; 4]; 16], item: [[[0; 16]; 4]; 16] };
}

impl SampleDepths for TileItems {
    #[inline(always)]
    fn block(&self, block: usize) -> &[[f32; 16]; 4] {
        &self.depth[block]
    }
}

pub(crate) struct DrawSink<'a> {
    pub surface: Surface<'a>,
    pub cover: &'a mut [[u64; 16]],
    pub items: &'a mut [TileItems],
}

impl DrawSink<'_> {
    /// What has been drawn so far, to be tested against between draws.
    #[inline(always)]
    #[cfg(feature = "bvh")]
    pub fn view(&self) -> MapView<'_, TileItems> {
        MapView {
            band: self.surface.band,
            floors: self.surface.blocks,
            tiles: self.surface.tiles,
            cover: self.cover,
            samples: self.items,
        }
    }
}

impl<'a> Sink<'a> for DrawSink<'a> {
    const EXACT: bool = true;

    #[inline(always)]
    fn surface(&mut self) -> &mut Surface<'a> {
        &mut self.surface
    }

    #[inline(always)]
    fn expect(&self, tile: usize, block: usize) {
        let items = &self.items[tile];
        for (depth, item) in items.depth[block].iter().zip(&items.item[block]) {
            prefetch(depth, 0);
            prefetch(item, 0);
        }
    }

    #[inline(always)]
    fn whole<S: Simd>(&mut self, _s: S, _tile: usize, _blocks: Mask, floors: S::F, _far: S::F) -> S::F {
        floors
    }

    #[inline(always)]
    fn samples<S: Simd>(&mut self, s: S, tile: usize, block: usize, word: u64, depths: [S::F; 4], id: u32) -> f32 {
        let before = self.cover[tile][block];
        let items = &mut self.items[tile];
        let number = s.splat_i(id as i32);
        let (mut least, mut any) = (s.splat_f(f32::INFINITY), 0);
        for i in 0..4 {
            let z = depths[i];
            let (depth, item) = (&mut items.depth[block][i], &mut items.item[block][i]);
            let old = s.blend_f((before >> (16 * i)) as Mask, s.splat_f(0.0), s.load_f(depth));
            let old_item = s.load_i(item);
            let wins = (word >> (16 * i)) as Mask & (s.gt_f(z, old) | s.eq_f(z, old) & s.gt_i(old_item, number));
            let new = s.blend_f(wins, old, z);
            s.store_f(new, depth);
            s.store_i(s.blend_i(wins, old_item, number), item);
            least = s.min_f(least, new);
            any |= wins;
        }
        let covered = before | word;
        self.cover[tile][block] = covered;
        if covered == !0 && any != 0 { s.reduce_min_f(least) } else { -1.0 }
    }
}

/// Counts the samples that triangles cover, hidden or not: nothing is dropped early, since no floor is ever raised.
pub(crate) struct CountSink<'a> {
    pub surface: Surface<'a>,
    pub fragments: u64,
}

impl CountSink<'_> {
    /// The samples of a block that lie inside the viewport.
    #[inline(always)]
    fn inside(&self, tile: usize, block: usize) -> u64 {
        let grid = self.surface.band.grid;
        let (tile_x, tile_y) = (tile % grid.tiles_x(), tile / grid.tiles_x() + self.surface.band.tile_y0);
        !grid.padding(4 * tile_x + block % 4, 4 * tile_y + block / 4)
    }
}

impl<'a> Sink<'a> for CountSink<'a> {
    const EXACT: bool = false;

    #[inline(always)]
    fn surface(&mut self) -> &mut Surface<'a> {
        &mut self.surface
    }

    #[inline(always)]
    fn expect(&self, _tile: usize, _block: usize) {}

    #[inline(always)]
    fn whole<S: Simd>(&mut self, _s: S, tile: usize, blocks: Mask, floors: S::F, _far: S::F) -> S::F {
        let mut blocks = blocks;
        while blocks != 0 {
            let block = blocks.trailing_zeros() as usize;
            blocks &= blocks - 1;
            self.fragments += u64::from(self.inside(tile, block).count_ones());
        }
        floors
    }

    #[inline(always)]
    fn samples<S: Simd>(&mut self, _s: S, tile: usize, block: usize, word: u64, _depths: [S::F; 4], _id: u32) -> f32 {
        self.fragments += u64::from((word & self.inside(tile, block)).count_ones());
        -1.0
    }
}
