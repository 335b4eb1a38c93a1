//! Level 0 of the occlusion map, with the no-background Z-buffer: coverage words, blockwise floors, depths of samples.
//!
//! The state commutes (SEMANTICS, *What "conservative" covers*): a triangle that covers a whole block raises the block's floor
//! to its farthest depth there; one that covers it in part sets coverage bits and raises the depths of those samples; once all 64
//! samples are covered, their minimum raises the floor too. The *effective* depth of a sample, the larger of the floor and its
//! own, is a maximum over what was drawn: the same bits in any order, under any early-out, on any number of threads.

use homcull_simd::{Mask, Simd, prefetch};

use crate::raster::{Band, Grid, Sink, Surface};

/// Depths of a tile's samples, block by block, two rows of a block a vector. Where a block has no coverage bit, its depths are
/// left over from an earlier frame and mean nothing: they are never cleared.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct TileSamples(pub [[[f32; 16]; 4]; 16]);

/// A tile that keeps the depths of its samples: the occlusion map's, or the final draw's, which keeps more.
pub(crate) trait SampleDepths {
    /// The depths of a block, two rows a vector.
    fn block(&self, block: usize) -> &[[f32; 16]; 4];
}

impl SampleDepths for TileSamples {
    #[inline(always)]
    fn block(&self, block: usize) -> &[[f32; 16]; 4] {
        &self.0[block]
    }
}

/// The state of one view.
pub(crate) struct OcclusionMap {
    pub grid: Grid,
    /// Floors of the blocks, sixteen a tile.
    pub floors: Vec<[f32; 16]>,
    /// The least floor of each tile, in rows of `grid.tile_stride()`; padding is +infinity.
    pub tiles: Vec<f32>,
    /// Samples covered in part; a block with a floor above 0 is covered whole, whatever its word says.
    pub cover: Vec<[u64; 16]>,
    pub samples: Vec<TileSamples>,
    /// Tiles whose coverage changed since the pyramid was last brought up to date.
    pub dirty: Vec<bool>,
}

impl OcclusionMap {
    pub fn new(grid: Grid) -> OcclusionMap {
        let tiles = grid.tiles_x() * grid.tiles_y();
        let mut map = OcclusionMap {
            grid,
            floors: vec![[0.0; 16]; tiles],
            tiles: vec![f32::INFINITY; grid.tile_stride() * grid.tiles_y()],
            cover: vec![[0; 16]; tiles],
            samples: vec![TileSamples([[[0.0; 16]; 4]; 16]); tiles],
            dirty: vec![true; tiles],
        };
        map.clear();
        map
    }

    /// Bytes of the state at a size, samples included.
    pub fn bytes(grid: Grid) -> usize {
        let tile = 16 * 4 + 16 * 8 + size_of::<TileSamples>() + 1;
        grid.tiles_x() * grid.tiles_y() * tile + grid.tile_stride() * grid.tiles_y() * 4
    }

    /// Nothing covers anything; samples outside the viewport are covered, at +infinity.
    pub fn clear(&mut self) {
        self.floors.fill([0.0; 16]);
        self.cover.fill([0; 16]);
        self.dirty.fill(true);
        let (columns, stride) = (self.grid.tiles_x(), self.grid.tile_stride());
        for row in self.tiles.chunks_mut(stride) {
            row[..columns].fill(0.0);
        }
        let (last_x, last_y) = (columns - 1, self.grid.tiles_y() - 1);
        for x in 0..columns {
            self.pad_tile(x, last_y);
        }
        for y in 0..last_y {
            self.pad_tile(last_x, y);
        }
    }

    fn pad_tile(&mut self, tile_x: usize, tile_y: usize) {
        for block in 0..16 {
            let (bx, by) = (tile_x * 4 + block % 4, tile_y * 4 + block / 4);
            let padding = self.grid.padding(bx, by);
            let (tile, block) = self.grid.place(bx, by);
            if padding == !0 {
                self.floors[tile][block] = f32::INFINITY;
            } else if padding != 0 {
                self.cover[tile][block] = padding;
                for (i, z) in self.samples[tile].0[block].as_flattened_mut().iter_mut().enumerate() {
                    *z = if padding >> i & 1 != 0 { f32::INFINITY } else { 0.0 };
                }
            }
        }
    }

    /// The map cut into sinks for `count` bands, or for as many as there are rows of tiles.
    pub fn sinks(&mut self, count: usize) -> impl Iterator<Item = OccluderSink<'_>> {
        let grid = self.grid;
        let (mut floors, mut tiles) = (&mut self.floors[..], &mut self.tiles[..]);
        let (mut cover, mut samples, mut dirty) = (&mut self.cover[..], &mut self.samples[..], &mut self.dirty[..]);
        grid.bands(count).map(move |band| {
            let n = band.tiles();
            let strips = (band.tile_y1 - band.tile_y0) * grid.tile_stride();
            OccluderSink {
                surface: Surface { band, blocks: take(&mut floors, n), tiles: take(&mut tiles, strips) },
                cover: take(&mut cover, n),
                samples: take(&mut samples, n),
                dirty: take(&mut dirty, n),
            }
        })
    }

    /// The map as one sink.
    pub fn sink(&mut self) -> OccluderSink<'_> {
        OccluderSink {
            surface: Surface { band: Band::whole(self.grid), blocks: &mut self.floors, tiles: &mut self.tiles },
            cover: &mut self.cover,
            samples: &mut self.samples,
            dirty: &mut self.dirty,
        }
    }

    /// The map to be read.
    pub fn view(&self) -> MapView<'_> {
        MapView {
            band: Band::whole(self.grid),
            floors: &self.floors,
            tiles: &self.tiles,
            cover: &self.cover,
            samples: &self.samples,
        }
    }
}

/// Splits the first `n` elements off.
pub(crate) fn take<'a, T>(slice: &mut &'a mut [T], n: usize) -> &'a mut [T] {
    let (head, tail) = std::mem::take(slice).split_at_mut(n);
    *slice = tail;
    head
}

/// The state of a band, to be read.
pub(crate) struct MapView<'a, T = TileSamples> {
    pub band: Band,
    pub floors: &'a [[f32; 16]],
    pub tiles: &'a [f32],
    pub cover: &'a [[u64; 16]],
    pub samples: &'a [T],
}

impl<T> Clone for MapView<'_, T> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for MapView<'_, T> {}

impl<T: SampleDepths> MapView<'_, T> {
    #[inline(always)]
    pub fn tile(&self, tile_x: i32, tile_y: i32) -> usize {
        (tile_y as usize - self.band.tile_y0) * self.band.grid.tiles_x() + tile_x as usize
    }

    /// Covered samples of a block; those outside the viewport count as covered.
    #[inline(always)]
    pub fn word(&self, tile: usize, block: usize) -> u64 {
        if self.floors[tile][block] > 0.0 { !0 } else { self.cover[tile][block] }
    }

    /// The effective depth of a sample: 0 where nothing covers it.
    pub fn effective(&self, tile: usize, block: usize, sample: usize) -> f32 {
        let floor = self.floors[tile][block];
        if self.cover[tile][block] >> sample & 1 != 0 {
            floor.max(self.samples[tile].block(block)[sample / 16][sample % 16])
        } else {
            floor
        }
    }
}

/// Occluders are drawn into this: coverage and depth.
pub(crate) struct OccluderSink<'a> {
    pub surface: Surface<'a>,
    cover: &'a mut [[u64; 16]],
    samples: &'a mut [TileSamples],
    dirty: &'a mut [bool],
}

impl OccluderSink<'_> {
    /// The same sink for a while.
    #[inline(always)]
    pub fn reborrow(&mut self) -> OccluderSink<'_> {
        let Surface { band, blocks, tiles } = &mut self.surface;
        OccluderSink {
            surface: Surface { band: *band, blocks, tiles },
            cover: self.cover,
            samples: self.samples,
            dirty: self.dirty,
        }
    }

    /// What has been drawn so far, to be read between draws.
    #[inline(always)]
    pub fn view(&self) -> MapView<'_> {
        MapView {
            band: self.surface.band,
            floors: self.surface.blocks,
            tiles: self.surface.tiles,
            cover: self.cover,
            samples: self.samples,
        }
    }
}

impl<'a> Sink<'a> for OccluderSink<'a> {
    const EXACT: bool = false;

    #[inline(always)]
    fn surface(&mut self) -> &mut Surface<'a> {
        &mut self.surface
    }

    #[inline(always)]
    fn expect(&self, tile: usize, block: usize) {
        for lane in &self.samples[tile].0[block] {
            prefetch(lane, 0);
        }
    }

    #[inline(always)]
    fn whole<S: Simd>(&mut self, s: S, tile: usize, blocks: Mask, floors: S::F, far: S::F) -> S::F {
        self.dirty[tile] = true;
        s.blend_f(blocks, floors, far)
    }

    #[inline(always)]
    fn samples<S: Simd>(&mut self, s: S, tile: usize, block: usize, word: u64, depths: [S::F; 4], _id: u32) -> f32 {
        self.dirty[tile] = true;
        let before = self.cover[tile][block];
        let covered = before | word;
        self.cover[tile][block] = covered;
        let stored = &mut self.samples[tile].0[block];
        let zero = s.splat_f(0.0);
        let mut new = depths;
        // Nothing here branches: which samples were covered before, and whether all are now, cannot be predicted.
        for i in 0..4 {
            let old = s.blend_f((before >> (16 * i)) as Mask, zero, s.load_f(&stored[i]));
            new[i] = s.blend_f((word >> (16 * i)) as Mask, old, s.max_f(old, depths[i]));
            s.store_f(new[i], &mut stored[i]);
        }
        let least = s.reduce_min_f(s.min_f(s.min_f(new[0], new[1]), s.min_f(new[2], new[3])));
        if covered == !0 { least } else { -1.0 }
    }
}

/// The occlusion map alone: coverage without depth.
pub(crate) struct CoverageSink<'a>(pub OccluderSink<'a>);

impl<'a> Sink<'a> for CoverageSink<'a> {
    const EXACT: bool = false;

    #[inline(always)]
    fn surface(&mut self) -> &mut Surface<'a> {
        &mut self.0.surface
    }

    #[inline(always)]
    fn expect(&self, _tile: usize, _block: usize) {}

    #[inline(always)]
    fn whole<S: Simd>(&mut self, s: S, tile: usize, blocks: Mask, floors: S::F, _far: S::F) -> S::F {
        self.0.whole(s, tile, blocks, floors, s.splat_f(f32::INFINITY))
    }

    #[inline(always)]
    fn samples<S: Simd>(&mut self, _s: S, tile: usize, block: usize, word: u64, _depths: [S::F; 4], _id: u32) -> f32 {
        self.0.dirty[tile] = true;
        let covered = self.0.cover[tile][block] | word;
        self.0.cover[tile][block] = covered;
        if covered == !0 { f32::INFINITY } else { -1.0 }
    }
}
