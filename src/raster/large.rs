//! All other triangles, and clipped polygons: set up sixteen at a time, drawn tile by tile.
//!
//! Edge functions are exact in f64 from tile to tile (products of at most 50 bits) and in 32 bits within a tile: a tile's first
//! value is clamped to +-2^30, beyond which no sample of the tile can change sign while 31 (|a| + |b|) < 2^30, to
//! which the guard band sees.

use homcull_simd::Simd;

use super::each::each;
use super::engine::Engine;
use super::grid::TILE;
use super::plane::{Depths, Plane, Planes};
use super::queue::Lanes;
use super::sink::{Sink, range_mask, shows, tile_lanes};

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

impl<'a, S: Simd, K: Sink<'a>> Engine<'_, S, K> {
    /// Draws the first sixteen large triangles of the queue.
    #[inline(always)]
    pub(crate) fn draw_large(&mut self) {
        let s = self.simd;
        let (mut lanes, t) = self.queues.large.pop::<S, true>(s);
        let bounds = self.sample_bounds(&t.x, &t.y);
        let zero = s.splat_i(0);
        let (rx, ry) = (s.max_i(bounds[0], zero), s.max_i(self.viewport_first_row(&t.y), zero));
        let planes = Planes::new(s, &t, rx, ry);
        let Edges { a, b, c } = edges(s, &t);
        let mut blocks = [[0; 16]; 4];
        for i in 0..4 {
            s.store_i(s.shr_i::<3>(bounds[i]), &mut blocks[i]);
        }
        let near = self.screen_nears(lanes, planes.steep, &t);
        let (mut far, mut id) = ([0.0; 16], [0; 16]);
        s.store_f(t.far, &mut far);
        s.store_i(t.id, &mut id);
        while lanes != 0 {
            let l = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let convex = Convex::<3> {
                a: each!(3, q => a[q][l]),
                b: each!(3, q => b[q][l]),
                c: each!(3, q => c[q][l]),
                plane: planes.lane(l, near[l], far[l]),
                blocks: each!(4, i => blocks[i][l]),
                id: id[l] as u32,
            };
            self.draw_convex(&convex);
        }
    }

    /// Draws one convex polygon, tile by tile.
    #[inline(always)]
    pub(crate) fn draw_convex<const N: usize>(&mut self, t: &Convex<N>) {
        let s = self.simd;
        self.counts.large += 1;
        let depths = Depths::new(s, t.plane);
        let steps = Steps::new(s, t);
        let near = s.splat_f(t.plane.near);
        let (tx0, tx1) = (t.blocks[0] >> 2, t.blocks[2] >> 2);
        for ty in t.blocks[1] >> 2..=t.blocks[3] >> 2 {
            let mut row = [0.0; N];
            for q in 0..N {
                row[q] = t.c[q] + f64::from(t.b[q]) * f64::from(ty * TILE as i32);
            }
            let mut group = tx0 & !15;
            while group <= tx1 {
                let surface = self.sink.surface();
                let at = surface.tile_group(group, ty);
                let floors = s.load_f(super::transform::lanes(&surface.tiles[at..at + 16]));
                let shows =
                    if K::EXACT { shows::<S, true>(s, near, floors) } else { shows::<S, false>(s, near, floors) };
                let mut k = shows & range_mask(tx0 - group, tx1 - group);
                while k != 0 {
                    let tx = group + k.trailing_zeros() as i32;
                    k &= k - 1;
                    self.draw_tile(t, &depths, &steps, &row, tx, ty);
                }
                group += 16;
            }
        }
    }

    #[inline(always)]
    fn draw_tile<const N: usize>(
        &mut self,
        t: &Convex<N>,
        depths: &Depths<S>,
        steps: &Steps<S, N>,
        row: &[f64; N],
        tx: i32,
        ty: i32,
    ) {
        let s = self.simd;
        let mut first = [0.0; N];
        let mut outside = false;
        for q in 0..N {
            first[q] = row[q] + f64::from(t.a[q]) * f64::from(tx * TILE as i32);
            outside |= first[q] + steps.reach[q] < 0.0;
        }
        if outside {
            return;
        }
        let limit = f64::from(1 << 30);
        let mut touched = tile_lanes(t.blocks, tx, ty);
        let mut inside = touched;
        let mut corner = [[0; 16]; N];
        for q in 0..N {
            let e = s.add_i(s.splat_i(first[q].clamp(-limit, limit) as i32), steps.blocks[q]);
            touched &= !s.sign_i(s.add_i(e, s.splat_i(steps.most[q])));
            inside &= !s.sign_i(s.add_i(e, s.splat_i(steps.least[q])));
            s.store_i(e, &mut corner[q]);
        }
        let tile = self.sink.surface().tile(tx, ty);
        let mut floors = s.load_f(&self.sink.surface().blocks[tile]);
        let mut raised = 0;
        let z = depths.tile(s, tx, ty);
        let (far, near) = depths.range(s, z);
        let mut partial =
            touched & if K::EXACT { shows::<S, true>(s, near, floors) } else { shows::<S, false>(s, near, floors) };
        if !K::EXACT {
            let whole = touched & inside & shows::<S, false>(s, far, floors);
            if whole != 0 {
                floors = self.sink.whole(s, tile, whole, floors, far);
                raised = whole;
            }
            partial &= !inside;
        }
        let mut expected = partial;
        while expected != 0 {
            self.sink.expect(tile, expected.trailing_zeros() as usize);
            expected &= expected - 1;
        }
        let mut firsts = [0.0; 16];
        s.store_f(z, &mut firsts);
        while partial != 0 {
            let l = partial.trailing_zeros() as usize;
            partial &= partial - 1;
            let word = if inside >> l & 1 != 0 { !0 } else { steps.word(s, &corner, l) };
            if word != 0 {
                let floor = self.emit(tile, l, word, depths.block(s, firsts[l]), t.id, t.plane.far);
                if floor > 0.0 {
                    floors = s.blend_f(1 << l, floors, s.max_f(floors, s.splat_f(floor)));
                    raised |= 1 << l;
                }
            }
        }
        if raised != 0 {
            self.sink.surface().set_blocks(s, tile, floors);
        }
    }
}

/// Columns and rows, in samples: of a tile's blocks, and of the samples in the first two rows of a block.
const BLOCK_X: [i32; 16] = [0, 8, 16, 24, 0, 8, 16, 24, 0, 8, 16, 24, 0, 8, 16, 24];
const BLOCK_Y: [i32; 16] = [0, 0, 0, 0, 8, 8, 8, 8, 16, 16, 16, 16, 24, 24, 24, 24];
const SAMPLE_X: [i32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7];
const SAMPLE_Y: [i32; 16] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1];

/// How the edge functions change within a tile.
struct Steps<S: Simd, const N: usize> {
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
        let zero = [s.splat_i(0); N];
        let mut out = Steps { blocks: zero, samples: zero, rows: zero, most: [0; N], least: [0; N], reach: [0.0; N] };
        for q in 0..N {
            let (a, b) = (s.splat_i(t.a[q]), s.splat_i(t.b[q]));
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
    fn word(&self, s: S, first: &[[i32; 16]; N], block: usize) -> u64 {
        let mut e = self.samples;
        for q in 0..N {
            e[q] = s.add_i(s.splat_i(first[q][block]), e[q]);
        }
        let mut outside = 0;
        for two_rows in 0..4 {
            let mut signs = e[0];
            for q in 1..N {
                signs = s.or_i(signs, e[q]);
            }
            outside |= u64::from(s.sign_i(signs)) << (16 * two_rows);
            for q in 0..N {
                e[q] = s.add_i(e[q], self.rows[q]);
            }
        }
        !outside
    }
}

/// Edge functions of sixteen triangles, from the first sample of the viewport.
struct Edges {
    a: [[i32; 16]; 3],
    b: [[i32; 16]; 3],
    c: [[f64; 16]; 3],
}

#[inline(always)]
fn edges<S: Simd>(s: S, t: &Lanes<S>) -> Edges {
    let (mut ea, mut eb, mut ec) = ([[0; 16]; 3], [[0; 16]; 3], [[0.0; 16]; 3]);
    let (zero, half) = (s.splat_i(0), s.splat_i(128));
    for q in 0..3 {
        let r = (q + 1) % 3;
        let a = s.sub_i(t.y[q], t.y[r]);
        let b = s.sub_i(t.x[r], t.x[q]);
        let dx = s.d_from_i(s.sub_i(half, t.x[q]));
        let dy = s.d_from_i(s.sub_i(half, t.y[q]));
        let c = s.add_d(s.mul_d(s.d_from_i(a), dx), s.mul_d(s.d_from_i(b), dy));
        let owns = s.gt_i(a, zero) | s.eq_i(a, zero) & s.gt_i(b, zero);
        let bias = s.blend_d(owns, s.splat_d(-1.0), s.splat_d(0.0));
        s.store_d(s.floor_d(s.mul_d(s.add_d(c, bias), s.splat_d(1.0 / 256.0))), &mut ec[q]);
        s.store_i(a, &mut ea[q]);
        s.store_i(b, &mut eb[q]);
    }
    Edges { a: ea, b: eb, c: ec }
}
