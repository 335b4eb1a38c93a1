//! What a covered block does.

use homcull_simd::{Mask, Simd};

use super::grid::Band;

/// The nearest depth that is certainly hidden, by block and by tile: what all early-outs ask.
///
/// A block's floor is the farthest effective depth of its samples, 0 while one is uncovered; padding outside the
/// viewport is +infinity.
pub(crate) struct Surface<'a> {
    pub band: Band,
    /// Sixteen a tile, tile-major, of the band alone.
    pub blocks: &'a mut [[f32; 16]],
    /// The least floor of each tile, in rows of [`Grid::tile_stride`](super::Grid).
    pub tiles: &'a mut [f32],
}

impl Surface<'_> {
    /// The tile's place in the band.
    #[inline(always)]
    pub fn tile(&self, tile_x: i32, tile_y: i32) -> usize {
        (tile_y as usize - self.band.tile_y0) * self.band.grid.tiles_x() + tile_x as usize
    }

    /// Where sixteen tiles of a row begin in `tiles`; `tile_x` is a multiple of sixteen.
    #[inline(always)]
    pub fn tile_group(&self, tile_x: i32, tile_y: i32) -> usize {
        (tile_y as usize - self.band.tile_y0) * self.band.grid.tile_stride() + tile_x as usize
    }

    /// Where a tile stands in `tiles`.
    #[inline(always)]
    pub fn tile_place(&self, tile_x: i32, tile_y: i32) -> usize {
        self.tile_group(tile_x, tile_y)
    }

    /// Takes the new floors of a tile.
    #[inline(always)]
    pub fn set_blocks<S: Simd>(&mut self, s: S, tile: usize, floors: S::F) {
        s.store_f(floors, &mut self.blocks[tile]);
        self.set_tile(tile, s.reduce_min_f(floors));
    }

    #[inline(always)]
    fn set_tile(&mut self, tile: usize, floor: f32) {
        let (columns, stride) = (self.band.grid.tiles_x(), self.band.grid.tile_stride());
        let at = if columns == stride { tile } else { tile / columns * stride + tile % columns };
        self.tiles[at] = floor;
    }

    /// Raises the floor of one block, if `floor` is above it.
    #[inline(always)]
    pub fn raise<S: Simd>(&mut self, s: S, tile: usize, block: usize, floor: f32) {
        if floor > self.blocks[tile][block] {
            let floors = s.load_f(&self.blocks[tile]);
            self.set_blocks(s, tile, s.blend_f(1 << block, floors, s.splat_f(floor)));
        }
    }

    /// True when something at depth `z` may show in a rectangle of blocks of the band. `TIES`: also at equal depth.
    #[inline(always)]
    pub fn may_show<S: Simd, const TIES: bool>(&self, s: S, blocks: [i32; 4], z: f32) -> bool {
        let [bx0, by0, bx1, by1] = blocks;
        let z = s.splat_f(z);
        let (tx0, tx1) = (bx0 >> 2, bx1 >> 2);
        for ty in by0 >> 2..=by1 >> 2 {
            let mut group = tx0 & !15;
            while group <= tx1 {
                let at = self.tile_group(group, ty);
                let floors = s.load_f(super::transform::lanes(&self.tiles[at..at + 16]));
                let mut k = shows::<S, TIES>(s, z, floors) & range_mask(tx0 - group, tx1 - group);
                while k != 0 {
                    let tx = group + k.trailing_zeros() as i32;
                    k &= k - 1;
                    let floors = s.load_f(&self.blocks[self.tile(tx, ty)]);
                    if shows::<S, TIES>(s, z, floors) & tile_lanes(blocks, tx, ty) != 0 {
                        return true;
                    }
                }
                group += 16;
            }
        }
        false
    }
}

/// Lanes where depth `z` is in front of the floor; with `TIES` also where it is equal.
#[inline(always)]
pub(crate) fn shows<S: Simd, const TIES: bool>(s: S, z: S::F, floors: S::F) -> Mask {
    if TIES { s.ge_f(z, floors) } else { s.gt_f(z, floors) }
}

/// The lanes `from..=to`, cut to 0..=15.
#[inline(always)]
pub(crate) fn range_mask(from: i32, to: i32) -> Mask {
    let (from, to) = (from.max(0), to.min(15));
    if from > to { 0 } else { ((0xFFFF_u32 << from) & (0xFFFF >> (15 - to))) as Mask }
}

/// The blocks of a tile that lie in a rectangle of blocks `[x0, y0, x1, y1]`, both ends inclusive.
#[inline(always)]
pub(crate) fn tile_lanes([bx0, by0, bx1, by1]: [i32; 4], tile_x: i32, tile_y: i32) -> Mask {
    let (c0, c1) = ((bx0 - 4 * tile_x).max(0), (bx1 - 4 * tile_x).min(3));
    let (r0, r1) = ((by0 - 4 * tile_y).max(0), (by1 - 4 * tile_y).min(3));
    if c0 > c1 || r0 > r1 {
        return 0;
    }
    let columns = (0xF_u32 << c0) & (0xF >> (3 - c1));
    let rows = (0xFFFF_u32 << (4 * r0)) & (0xFFFF >> (4 * (3 - r1)));
    ((columns * 0x1111) & rows) as Mask
}

/// What the rasterizer writes to.
pub(crate) trait Sink<'a> {
    /// True for a sink that keeps every sample's own depth and triangle: nothing is summed up by block, small triangles get
    /// their plane, and ties are looked at. False for occluders, where farther is always right.
    const EXACT: bool;

    fn surface(&mut self) -> &mut Surface<'a>;

    /// Blocks of one tile, each wholly covered with the given farthest depths, all in front of their floors. Gives the floors
    /// as they are now; the caller stores them. Not called on `EXACT` sinks.
    fn whole<S: Simd>(&mut self, s: S, tile: usize, blocks: Mask, floors: S::F, far: S::F) -> S::F;

    /// Asks for the memory of a block whose samples will be given soon.
    fn expect(&self, tile: usize, block: usize);

    /// One block, covered where `word` has bits, with the depths of its 64 samples, two rows a vector. Gives the
    /// farthest effective depth of the block if all of it is covered now, else something below 0; the caller raises the floor.
    fn samples<S: Simd>(&mut self, s: S, tile: usize, block: usize, word: u64, depths: [S::F; 4], id: u32) -> f32;
}
