//! Triangles sixteen at a time: which are facing, hit a sample, need clipping; and to which kernel the others go.

use homcull_simd::{Mask, Simd};

use super::each::each;
use super::engine::{Engine, Placement};
use super::mesh::PreparedMeshes;
use super::queue::Lanes;
use super::sink::Sink;
use super::small::SMALL_EXTENT;

impl<'a, S: Simd, K: Sink<'a>> Engine<'_, S, K> {
    #[inline(always)]
    pub(crate) fn draw_batch(&mut self, meshes: &PreparedMeshes, batch: usize, placement: &Placement<'_>) {
        let s = self.simd;
        let indices = &meshes.batches[batch].corners;
        let mut corner: [S::I; 3] = each!(3, q => s.load_u8(&indices[q]));
        let v = &self.queues.vertices;
        let mut x: [S::I; 3] = each!(3, q => s.lookup_i(&v.x, corner[q]));
        let mut y: [S::I; 3] = each!(3, q => s.lookup_i(&v.y, corner[q]));
        let any_outside = v.any_outside;
        let [sx0, sy0, sx1, sy1] = self.sample_bounds(&x, &y);
        let mut keep = !(s.gt_i(sx0, sx1) | s.gt_i(sy0, sy1));
        if any_outside {
            let code: [S::I; 3] = each!(3, q => s.lookup_i(&self.queues.vertices.outside, corner[q]));
            let zero = s.splat_i(0);
            let clean = s.eq_i(s.or_i(s.or_i(code[0], code[1]), code[2]), zero);
            let crossing = !clean & s.eq_i(s.and_i(s.and_i(code[0], code[1]), code[2]), zero);
            keep &= clean;
            self.clip_lanes(crossing, &meshes.batches[batch].corners, &meshes.numbers[batch], placement);
        }
        let (w, h) = (extent(s, &x), extent(s, &y));
        let (positive, negative) = self.area_signs(&x, &y, keep & s.gt_i(s.max_i(w, h), s.splat_i(32767)));
        let (front, back) = placement.facing.masks();
        let flip = keep & negative & back;
        keep &= positive & front | flip;
        if keep == 0 {
            return;
        }
        if flip != 0 {
            swap_last_two(s, flip, &mut x);
            swap_last_two(s, flip, &mut y);
            swap_last_two(s, flip, &mut corner);
        }
        let small = keep & !s.gt_i(s.add_i(w, h), s.splat_i(SMALL_EXTENT));
        let large = keep & !small;
        let exact = K::EXACT || large != 0;
        let t = self.fetch(x, y, &corner, exact, &meshes.numbers[batch], placement.first_triangle);
        if small != 0 {
            if K::EXACT {
                self.queues.small.push::<S, true>(s, small, &t);
            } else {
                self.queues.small.push::<S, false>(s, small, &t);
            }
            if self.queues.small.len >= 16 {
                self.run_small();
            }
        }
        let large = if large != 0 { self.large_may_show(large, &t, [sx0, sy0, sx1, sy1]) } else { 0 };
        if large != 0 {
            self.queues.large.push::<S, true>(s, large, &t);
            if self.queues.large.len >= 16 {
                self.run_large();
            }
        }
    }

    /// Which triangles have positive, which negative area. `wide` ones are looked at in f64, where products of 25 bits are exact.
    #[inline(always)]
    fn area_signs(&self, x: &[S::I; 3], y: &[S::I; 3], wide: Mask) -> (Mask, Mask) {
        let s = self.simd;
        let (ax, ay, bx, by) = (s.sub_i(x[1], x[0]), s.sub_i(y[1], y[0]), s.sub_i(x[2], x[0]), s.sub_i(y[2], y[0]));
        let (p, q) = (s.mul_i(ax, by), s.mul_i(bx, ay));
        let (mut positive, mut negative) = (s.gt_i(p, q), s.gt_i(q, p));
        if wide != 0 {
            let (p, q) = (s.mul_d(s.d_from_i(ax), s.d_from_i(by)), s.mul_d(s.d_from_i(bx), s.d_from_i(ay)));
            positive = positive & !wide | s.gt_d(p, q) & wide;
            negative = negative & !wide | s.gt_d(q, p) & wide;
        }
        (positive, negative)
    }

    /// The depths of the corners; if `exact`, also what planes need, and the triangles' numbers.
    #[inline(always)]
    fn fetch(
        &self,
        x: [S::I; 3],
        y: [S::I; 3],
        corner: &[S::I; 3],
        exact: bool,
        numbers: &[i32; 16],
        first: u32,
    ) -> Lanes<S> {
        let s = self.simd;
        let v = &self.queues.vertices;
        let z: [S::F; 3] = each!(3, q => s.lookup_f(&v.depth, corner[q]));
        let zero = s.splat_f(0.0);
        let mut t = Lanes {
            x,
            y,
            near: s.max_f(s.max_f(z[0], z[1]), z[2]),
            far: s.min_f(s.min_f(z[0], z[1]), z[2]),
            clip: [[zero; 3]; 4],
            id: s.splat_i(0),
        };
        if exact {
            t.clip = each!(4, c => each!(3, q => s.lookup_f(&v.clip[c], corner[q])));
            t.id = s.add_i(s.load_i(numbers), s.splat_i(first as i32));
        }
        t
    }

    /// Drops large triangles of at most 2x2 tiles that lie behind all of them, before they are set up.
    #[inline(always)]
    fn large_may_show(&mut self, large: Mask, t: &Lanes<S>, bounds: [S::I; 4]) -> Mask {
        let s = self.simd;
        let [tx0, ty0, tx1, ty1] = each!(4, i => s.shr_i::<5>(bounds[i]));
        let one = s.splat_i(1);
        let few = large & !s.gt_i(s.sub_i(tx1, tx0), one) & !s.gt_i(s.sub_i(ty1, ty0), one);
        if few == 0 {
            return large;
        }
        let surface = self.sink.surface();
        let (first, stride) = (surface.band.tile_y0 as i32, surface.band.grid.tile_stride() as i32);
        let (first, stride) = (s.splat_i(first), s.splat_i(stride));
        let (r0, r1) = (s.mul_i(s.sub_i(ty0, first), stride), s.mul_i(s.sub_i(ty1, first), stride));
        let far = s.splat_f(f32::INFINITY);
        let corners = [s.add_i(r0, tx0), s.add_i(r0, tx1), s.add_i(r1, tx0), s.add_i(r1, tx1)];
        let floor: [S::F; 4] = each!(4, i => s.gather_f(few, surface.tiles, corners[i], far));
        let floors = s.min_f(s.min_f(floor[0], floor[1]), s.min_f(floor[2], floor[3]));
        let shows = if K::EXACT { s.ge_f(t.near, floors) } else { s.gt_f(t.near, floors) };
        large & !(few & !shows)
    }
}

/// The greatest difference of three positions.
#[inline(always)]
fn extent<S: Simd>(s: S, v: &[S::I; 3]) -> S::I {
    s.sub_i(s.max_i(s.max_i(v[0], v[1]), v[2]), s.min_i(s.min_i(v[0], v[1]), v[2]))
}

#[inline(always)]
fn swap_last_two<S: Simd>(s: S, k: Mask, v: &mut [S::I; 3]) {
    (v[1], v[2]) = (s.blend_i(k, v[1], v[2]), s.blend_i(k, v[2], v[1]));
}
