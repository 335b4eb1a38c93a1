//! Convex polygons: large triangles, and what clipping leaves. Drawn in windows of 4x4 tiles of 4x4 blocks, sixteen of each at a time.
//!
//! Edge functions are exact in f64 from tile to tile (products of at most 50 bits) and in 32 bits within a tile: a tile's first
//! value is clamped to +-2^30, beyond which no sample of the tile can change sign while 31 (|a| + |b|) < 2^30, to
//! which the guard band sees.
//!
//! What costs is not arithmetic but branches that no predictor can know. So a window is drawn in three flat loops: over its
//! tiles, where whole blocks are done and the others are listed; over that list; and over the tiles again, for their floors.

use homcull_simd::{Mask, Simd};

use super::each::each;
use super::engine::Engine;
use super::grid::TILE;
use super::plane::{Depths, Plane};
use super::sink::{Sink, shows, tile_lanes};
use super::transform::lanes_mut;

/// Corners of a polygon, at most: a triangle cut by five planes.
pub(crate) const MOST_CORNERS: usize = 8;

/// A convex polygon of at most `N` edges, ready to be drawn. Unused edges hold everything inside.
pub(crate) struct Convex<const N: usize> {
    /// Change of each edge function from sample to sample.
    pub a: [i32; N],
    pub b: [i32; N],
    /// Its value at the first sample of the viewport: an integer; at least 0 is inside.
    pub c: [f64; N],
    pub plane: Plane,
    /// Blocks that it may touch in the band: x0, y0, x1, y1, both ends inclusive.
    pub blocks: [i32; 4],
    pub id: u32,
}

/// Room for the blocks of a window, and for the lanes beyond the last.
pub(crate) const LISTED: usize = 256 + 16;

/// The blocks of a window that a polygon covers in part, or of which every sample is asked.
#[repr(C, align(64))]
pub(crate) struct PartialBlocks {
    len: usize,
    /// The edge functions at each block's first sample.
    edges: [[i32; LISTED]; MOST_CORNERS],
    /// The unclamped depth there.
    first: [f32; LISTED],
    /// 32 times the tile, plus the block, plus 16 if the whole block is inside.
    place: [i32; LISTED],
}

impl PartialBlocks {
    pub fn new() -> PartialBlocks {
        PartialBlocks { len: 0, edges: [[0; LISTED]; MOST_CORNERS], first: [0.0; LISTED], place: [0; LISTED] }
    }
}

/// 4x4 tiles, from tile (x, y) on.
struct Window<const N: usize> {
    x: i32,
    y: i32,
    /// The tiles that the polygon may touch, and where it may show.
    touched: Mask,
    /// The edge functions at the first sample of each tile, clamped.
    edges: [[i32; 16]; N],
    /// The unclamped depths there.
    first: [f32; 16],
}

impl<'a, S: Simd, K: Sink<'a>> Engine<'_, S, K> {
    /// Draws one convex polygon.
    #[inline(always)]
    pub(crate) fn draw_convex<const N: usize>(&mut self, t: &Convex<N>) {
        let s = self.simd;
        self.counts.large += 1;
        let depths = Depths::new(s, t.plane);
        let steps = Steps::new(s, t);
        let [x0, y0, x1, y1] = each!(4, i => t.blocks[i] >> 2);
        let mut y = y0;
        while y <= y1 {
            let mut x = x0;
            while x <= x1 {
                let columns = 0x1111 * ((2_u32 << (x1 - x).min(3)) - 1);
                let rows = (0x10_u32 << (4 * (y1 - y).min(3))) - 1;
                let window = self.window(t, &depths, &steps, x, y, (columns & rows) as Mask);
                if window.touched != 0 {
                    self.list_blocks(t, &depths, &steps, &window);
                    self.draw_listed(t, &depths, &steps);
                    self.raise_tiles(&window);
                }
                x += 4;
            }
            y += 4;
        }
    }

    /// Sorts out the tiles of a window.
    #[inline(always)]
    fn window<const N: usize>(
        &mut self,
        t: &Convex<N>,
        depths: &Depths<S>,
        steps: &Steps<S, N>,
        x: i32,
        y: i32,
        tiles: Mask,
    ) -> Window<N> {
        let s = self.simd;
        let mut window = Window { x, y, touched: 0, edges: [[0; 16]; N], first: [0.0; 16] };
        let near = s.splat_f(t.plane.near);
        let surface = self.sink.surface();
        let (columns, rows) = (s.load_i(&TILE_X), s.load_i(&TILE_Y));
        let stride = s.splat_i(surface.band.grid.tile_stride() as i32);
        let at = s.add_i(s.splat_i(surface.tile_place(x, y) as i32), s.add_i(s.mul_i(rows, stride), columns));
        let floors = s.gather_f(tiles, surface.tiles, at, near);
        let mut touched =
            tiles & if K::EXACT { shows::<S, true>(s, near, floors) } else { shows::<S, false>(s, near, floors) };
        if touched == 0 {
            return window;
        }
        let (zero, most) = (s.splat_d(0.0), s.splat_d(f64::from(1 << 30)));
        let least = s.sub_d(zero, most);
        for q in 0..N {
            let from = t.c[q]
                + f64::from(t.a[q]) * f64::from(x * TILE as i32)
                + f64::from(t.b[q]) * f64::from(y * TILE as i32);
            let e = s.add_d(s.splat_d(from), steps.tiles[q]);
            touched &= !s.gt_d(zero, s.add_d(e, s.splat_d(steps.reach[q])));
            s.store_i(s.i_from_d(s.max_d(s.min_d(e, most), least)), &mut window.edges[q]);
        }
        s.store_f(depths.tiles(s, s.add_i(s.splat_i(x), columns), s.add_i(s.splat_i(y), rows)), &mut window.first);
        window.touched = touched;
        window
    }

    /// Raises the whole blocks of a window, and lists those that are left.
    #[inline(always)]
    fn list_blocks<const N: usize>(&mut self, t: &Convex<N>, depths: &Depths<S>, steps: &Steps<S, N>, w: &Window<N>) {
        let s = self.simd;
        let numbers = s.load_i(&NUMBER);
        let mut len = 0;
        let mut tiles = w.touched;
        while tiles != 0 {
            let i = tiles.trailing_zeros() as usize;
            tiles &= tiles - 1;
            let (tx, ty) = (w.x + (i as i32 & 3), w.y + (i as i32 >> 2));
            let mut touched = tile_lanes(t.blocks, tx, ty);
            let mut inside = touched;
            let mut e = steps.blocks;
            for q in 0..N {
                e[q] = s.add_i(s.splat_i(w.edges[q][i]), e[q]);
                touched &= !s.sign_i(s.add_i(e[q], s.splat_i(steps.most[q])));
                inside &= !s.sign_i(s.add_i(e[q], s.splat_i(steps.least[q])));
            }
            let tile = self.sink.surface().tile(tx, ty);
            let mut floors = s.load_f(&self.sink.surface().blocks[tile]);
            let first = depths.tile(s, w.first[i]);
            let (far, near) = depths.range(s, first);
            let mut listed =
                touched & if K::EXACT { shows::<S, true>(s, near, floors) } else { shows::<S, false>(s, near, floors) };
            if !K::EXACT {
                let whole = touched & inside & shows::<S, false>(s, far, floors);
                floors = self.sink.whole(s, tile, whole, floors, far);
                s.store_f(floors, &mut self.sink.surface().blocks[tile]);
                listed &= !inside;
            }
            let list = &mut self.queues.partial;
            let to = len..len + 16;
            for q in 0..N {
                s.compress_i(listed, e[q], lanes_mut(&mut list.edges[q][to.clone()]));
            }
            s.compress_f(listed, first, lanes_mut(&mut list.first[to.clone()]));
            let mut place = s.add_i(s.splat_i((tile as i32) << 5), numbers);
            if K::EXACT {
                place = s.blend_i(inside, place, s.add_i(place, s.splat_i(16)));
            }
            s.compress_i(listed, place, lanes_mut(&mut list.place[to]));
            len += listed.count_ones() as usize;
        }
        self.queues.partial.len = len;
    }

    /// Draws the listed blocks, sample by sample.
    #[inline(always)]
    fn draw_listed<const N: usize>(&mut self, t: &Convex<N>, depths: &Depths<S>, steps: &Steps<S, N>) {
        let s = self.simd;
        for i in 0..self.queues.partial.len {
            let list = &self.queues.partial;
            let ahead = list.place[(i + AHEAD).min(list.len - 1)];
            self.sink.expect(ahead as usize >> 5, ahead as usize & 15);
            let place = list.place[i] as usize;
            let (tile, block) = (place >> 5, place & 15);
            let word = if K::EXACT && place & 16 != 0 { !0 } else { steps.word(s, &list.edges, i) };
            let z = depths.block(s, list.first[i]);
            let floor = self.emit(tile, block, word, z, t.id, t.plane.far);
            let old = &mut self.sink.surface().blocks[tile][block];
            *old = if floor > *old { floor } else { *old };
        }
    }

    /// Takes the floors of a window's tiles from those of their blocks.
    #[inline(always)]
    fn raise_tiles<const N: usize>(&mut self, w: &Window<N>) {
        let s = self.simd;
        let mut tiles = w.touched;
        while tiles != 0 {
            let i = tiles.trailing_zeros() as i32;
            tiles &= tiles - 1;
            let surface = self.sink.surface();
            let (tx, ty) = (w.x + (i & 3), w.y + (i >> 2));
            let floors = s.load_f(&surface.blocks[surface.tile(tx, ty)]);
            let at = surface.tile_place(tx, ty);
            surface.tiles[at] = s.reduce_min_f(floors);
        }
    }
}

/// How many blocks ahead memory is asked for.
pub(crate) const AHEAD: usize = 8;

/// Columns and rows of a window's tiles, and of a tile's blocks.
const TILE_X: [i32; 16] = [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3];
const TILE_Y: [i32; 16] = [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3];
const NUMBER: [i32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
/// Columns and rows, in samples: of a tile's blocks, and of the samples in the first two rows of a block.
const BLOCK_X: [i32; 16] = [0, 8, 16, 24, 0, 8, 16, 24, 0, 8, 16, 24, 0, 8, 16, 24];
const BLOCK_Y: [i32; 16] = [0, 0, 0, 0, 8, 8, 8, 8, 16, 16, 16, 16, 24, 24, 24, 24];
pub(crate) const SAMPLE_X: [i32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7];
pub(crate) const SAMPLE_Y: [i32; 16] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1];

/// How the edge functions change within a tile.
struct Steps<S: Simd, const N: usize> {
    /// From a window's first sample to the first of each tile.
    tiles: [S::D; N],
    /// From a tile's first sample to the first of each block.
    blocks: [S::I; N],
    /// From a block's first sample to those of its first two rows.
    samples: [S::I; N],
    /// Two rows further.
    rows: [S::I; N],
    /// The greatest and the least change within a block, and the greatest within a tile.
    most: [i32; N],
    least: [i32; N],
    reach: [f64; N],
}

impl<S: Simd, const N: usize> Steps<S, N> {
    #[inline(always)]
    fn new(s: S, t: &Convex<N>) -> Steps<S, N> {
        let (x, y) = (s.load_i(&SAMPLE_X), s.load_i(&SAMPLE_Y));
        let (block_x, block_y) = (s.load_i(&BLOCK_X), s.load_i(&BLOCK_Y));
        let (tile_x, tile_y) =
            (s.d_from_i(s.shl_i::<5>(s.load_i(&TILE_X))), s.d_from_i(s.shl_i::<5>(s.load_i(&TILE_Y))));
        let zero = [s.splat_i(0); N];
        let mut out = Steps {
            tiles: [s.splat_d(0.0); N],
            blocks: zero,
            samples: zero,
            rows: zero,
            most: [0; N],
            least: [0; N],
            reach: [0.0; N],
        };
        for q in 0..N {
            let (a, b) = (s.splat_i(t.a[q]), s.splat_i(t.b[q]));
            let (da, db) = (s.splat_d(f64::from(t.a[q])), s.splat_d(f64::from(t.b[q])));
            out.tiles[q] = s.add_d(s.mul_d(tile_x, da), s.mul_d(tile_y, db));
            out.blocks[q] = s.add_i(s.mul_i(block_x, a), s.mul_i(block_y, b));
            out.samples[q] = s.add_i(s.mul_i(x, a), s.mul_i(y, b));
            out.rows[q] = s.splat_i(2 * t.b[q]);
            out.most[q] = 7 * (t.a[q].max(0) + t.b[q].max(0));
            out.least[q] = 7 * (t.a[q].min(0) + t.b[q].min(0));
            out.reach[q] = 31.0 * (f64::from(t.a[q].max(0)) + f64::from(t.b[q].max(0)));
        }
        out
    }

    /// The coverage of a block, from the edge functions at the first sample of each.
    #[inline(always)]
    fn word(&self, s: S, first: &[[i32; LISTED]; MOST_CORNERS], block: usize) -> u64 {
        let mut e = self.samples;
        for q in 0..N {
            e[q] = s.add_i(s.splat_i(first[q][block]), e[q]);
        }
        coverage(s, e, &self.rows)
    }
}

/// The coverage of a block, from the edge functions at its first two rows of samples, and their change in two rows.
#[inline(always)]
pub(crate) fn coverage<S: Simd, const N: usize>(s: S, mut edges: [S::I; N], rows: &[S::I; N]) -> u64 {
    let mut outside = 0;
    for two_rows in 0..4 {
        let mut signs = edges[0];
        for q in 1..N {
            signs = s.or_i(signs, edges[q]);
        }
        outside |= u64::from(s.sign_i(signs)) << (16 * two_rows);
        for q in 0..N {
            edges[q] = s.add_i(edges[q], rows[q]);
        }
    }
    !outside
}
