//! Small triangles, sixteen at a time: those for which edge functions fit 16 bits.
//!
//! For occluders such a triangle counts with its farthest corner everywhere: the second economy beside whole blocks, never
//! nearer than what is drawn. An exact sink gets every sample's own depth.

use homcull_simd::{Mask, Simd};

use super::engine::Engine;
use super::plane::{Depths, Planes};
use super::queue::Lanes;
use super::sink::{Sink, shows};

/// Width plus height of a small triangle, in subpixels, at most: `7 (|a| + |b|)` of every edge then fits 16 bits.
pub(crate) const SMALL_EXTENT: i32 = 4681;

/// The sixteen triangles as plain numbers: edges at the first sample of the first block, in whole samples.
struct Sixteen {
    a: [[i32; 16]; 3],
    b: [[i32; 16]; 3],
    c: [[i32; 16]; 3],
    block_x: [i32; 16],
    block_y: [i32; 16],
    far: [f32; 16],
}

impl<'a, S: Simd, K: Sink<'a>> Engine<'_, S, K> {
    /// Draws the first sixteen small triangles of the queue.
    #[inline(always)]
    pub(crate) fn draw_small(&mut self) {
        let s = self.simd;
        let (lanes, t) =
            if K::EXACT { self.queues.small.pop::<S, true>(s) } else { self.queues.small.pop::<S, false>(s) };
        let [sx0, sy0, sx1, sy1] = self.sample_bounds(&t.x, &t.y);
        let (bx0, by0, bx1, by1) = (s.shr_i::<3>(sx0), s.shr_i::<3>(sy0), s.shr_i::<3>(sx1), s.shr_i::<3>(sy1));
        // Which blocks may show: at most 4x4, since a small triangle spans at most 18 samples.
        let key = if K::EXACT { t.near } else { t.far };
        let (nx, ny) = (s.sub_i(bx1, bx0), s.sub_i(by1, by0));
        let mut may_show: [[Mask; 4]; 4] = [[0; 4]; 4];
        let mut any = 0;
        for j in 0..4 {
            let kj = lanes & !s.gt_i(s.splat_i(j as i32), ny);
            if kj == 0 {
                break;
            }
            for i in 0..4 {
                let k = kj & !s.gt_i(s.splat_i(i as i32), nx);
                if k == 0 {
                    break;
                }
                let at = self.block_numbers(s.add_i(bx0, s.splat_i(i as i32)), s.add_i(by0, s.splat_i(j as i32)));
                let floors = s.gather_f(k, self.sink.surface().blocks.as_flattened(), at, key);
                may_show[j][i] =
                    k & if K::EXACT { shows::<S, true>(s, key, floors) } else { shows::<S, false>(s, key, floors) };
                any |= may_show[j][i];
            }
        }
        if any == 0 {
            return;
        }
        self.counts.small += u64::from(any.count_ones());
        let sixteen = edges(s, &t, bx0, by0);
        if K::EXACT {
            let rx = s.max_i(sx0, s.splat_i(0));
            let planes = Planes::new(s, &t, rx, self.viewport_first_row(&t.y));
            self.exact_lanes(any, &may_show, &sixteen, &planes, &t);
        } else {
            self.flat_lanes(any, &may_show, &sixteen);
        }
    }

    /// Hands the blocks of each triangle to the sink, at the depth of its farthest corner.
    #[inline(always)]
    fn flat_lanes(&mut self, lanes: Mask, may_show: &[[Mask; 4]; 4], t: &Sixteen) {
        let s = self.simd;
        let mut lanes = lanes;
        while lanes != 0 {
            let l = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let depth = [s.splat_f(t.far[l]); 4];
            let mut places = places_of(may_show, l);
            while places != 0 {
                let place = places.trailing_zeros() as i32;
                places &= places - 1;
                let word = t.word(s, l, place);
                if word != 0 {
                    let (tile, block) = self.place(t, l, place);
                    let floor = self.sink.samples(s, tile, block, word, depth, 0);
                    self.sink.surface().raise(s, tile, block, floor);
                }
            }
        }
    }

    /// The same with every sample's own depth.
    #[inline(always)]
    fn exact_lanes(
        &mut self,
        lanes: Mask,
        may_show: &[[Mask; 4]; 4],
        t: &Sixteen,
        planes: &Planes,
        triangles: &Lanes<S>,
    ) {
        let s = self.simd;
        let near = self.screen_nears(lanes, planes.steep, triangles);
        let mut id = [0; 16];
        s.store_i(triangles.id, &mut id);
        let mut lanes = lanes;
        while lanes != 0 {
            let l = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let depths = Depths::new(s, planes.lane(l, near[l], t.far[l]));
            let mut places = places_of(may_show, l);
            while places != 0 {
                let place = places.trailing_zeros() as i32;
                places &= places - 1;
                let word = t.word(s, l, place);
                if word != 0 {
                    let (tile, block) = self.place(t, l, place);
                    let (tile_x, tile_y) = ((t.block_x[l] + (place & 3)) >> 2, (t.block_y[l] + (place >> 2)) >> 2);
                    let mut first = [0.0; 16];
                    s.store_f(depths.tile(s, depths.tile_first(tile_x, tile_y)), &mut first);
                    let z = depths.block(s, first[block]);
                    let floor = self.emit(tile, block, word, z, id[l] as u32, t.far[l]);
                    self.sink.surface().raise(s, tile, block, floor);
                }
            }
        }
    }

    /// The tile and the block of a place in a triangle's 4x4 blocks.
    #[inline(always)]
    fn place(&mut self, t: &Sixteen, l: usize, place: i32) -> (usize, usize) {
        let (bx, by) = (t.block_x[l] + (place & 3), t.block_y[l] + (place >> 2));
        (self.sink.surface().tile(bx >> 2, by >> 2), ((by & 3) * 4 + (bx & 3)) as usize)
    }
}

/// A triangle's blocks that may show, as bits `4 row + column`.
#[inline(always)]
fn places_of(may_show: &[[Mask; 4]; 4], l: usize) -> u32 {
    let mut places = 0;
    for (i, k) in may_show.as_flattened().iter().enumerate() {
        places |= u32::from(k >> l & 1) << i;
    }
    places
}

impl Sixteen {
    /// The coverage of one of a triangle's blocks. Edge functions beyond 16 bits saturate: their signs are the same.
    #[inline(always)]
    fn word<S: Simd>(&self, s: S, l: usize, place: i32) -> u64 {
        let (x, y) = (8 * (place & 3), 8 * (place >> 2));
        let (mut a, mut b, mut c) = ([0; 3], [0; 3], [0; 3]);
        for q in 0..3 {
            let (ea, eb) = (self.a[q][l], self.b[q][l]);
            let ec = self.c[q][l] + ea * x + eb * y;
            (a[q], b[q]) = (ea as i16, eb as i16);
            c[q] = ec.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
        }
        s.coverage_16(a, b, c)
    }
}

/// Edge functions `a x + b y + c` over whole samples from the first sample of block (bx, by); a sample is inside where all
/// three are at least 0.
#[inline(always)]
fn edges<S: Simd>(s: S, t: &Lanes<S>, bx: S::I, by: S::I) -> Sixteen {
    let (ox, oy) = (s.add_i(s.shl_i::<11>(bx), s.splat_i(128)), s.add_i(s.shl_i::<11>(by), s.splat_i(128)));
    let zero = s.splat_i(0);
    let mut out = Sixteen {
        a: [[0; 16]; 3],
        b: [[0; 16]; 3],
        c: [[0; 16]; 3],
        block_x: [0; 16],
        block_y: [0; 16],
        far: [0.0; 16],
    };
    for q in 0..3 {
        let r = (q + 1) % 3;
        let a = s.sub_i(t.y[q], t.y[r]);
        let b = s.sub_i(t.x[r], t.x[q]);
        let c = s.add_i(s.mul_i(a, s.sub_i(ox, t.x[q])), s.mul_i(b, s.sub_i(oy, t.y[q])));
        // Left edges, and top edges, own the samples that lie on them.
        let owns = s.gt_i(a, zero) | s.eq_i(a, zero) & s.gt_i(b, zero);
        let c = s.shr_i::<8>(s.add_i(c, s.blend_i(owns, s.splat_i(-1), zero)));
        s.store_i(a, &mut out.a[q]);
        s.store_i(b, &mut out.b[q]);
        s.store_i(c, &mut out.c[q]);
    }
    s.store_i(bx, &mut out.block_x);
    s.store_i(by, &mut out.block_y);
    s.store_f(t.far, &mut out.far);
    out
}
