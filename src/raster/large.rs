//! Triangles that are not small: set up sixteen at a time. Those of few blocks then go together (`medium.rs`), each of the others is
//! drawn as a convex polygon (`convex.rs`).

use homcull_simd::{Mask, Simd};

use super::convex::Convex;
use super::each::each;
use super::engine::Engine;
use super::medium::MEDIUM_EXTENT;
use super::plane::Planes;
use super::queue::Lanes;
use super::sink::Sink;

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
        let mut sixteen = Sixteen { a, b, c, planes, blocks, near, far: [0.0; 16], id: [0; 16] };
        s.store_f(t.far, &mut sixteen.far);
        s.store_i(t.id, &mut sixteen.id);
        let mut middle = lanes & medium_lanes(s, &t, &bounds);
        lanes &= !middle;
        while middle != 0 {
            let l = middle.trailing_zeros() as usize;
            middle &= middle - 1;
            self.list_medium(&sixteen.lane(l), l);
        }
        self.draw_medium();
        while lanes != 0 {
            let l = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            self.draw_convex(&sixteen.lane(l));
        }
    }
}

/// Sixteen triangles, set up.
struct Sixteen {
    a: [[i32; 16]; 3],
    b: [[i32; 16]; 3],
    c: [[f64; 16]; 3],
    planes: Planes,
    blocks: [[i32; 16]; 4],
    near: [f32; 16],
    far: [f32; 16],
    id: [i32; 16],
}

impl Sixteen {
    #[inline(always)]
    fn lane(&self, l: usize) -> Convex<3> {
        Convex {
            a: each!(3, q => self.a[q][l]),
            b: each!(3, q => self.b[q][l]),
            c: each!(3, q => self.c[q][l]),
            plane: self.planes.lane(l, self.near[l], self.far[l]),
            blocks: each!(4, i => self.blocks[i][l]),
            id: self.id[l] as u32,
        }
    }
}

/// The difference of the largest and the smallest.
#[inline(always)]
fn extent<S: Simd>(s: S, v: &[S::I; 3]) -> S::I {
    s.sub_i(s.max_i(s.max_i(v[0], v[1]), v[2]), s.min_i(s.min_i(v[0], v[1]), v[2]))
}

/// Triangles of few blocks, whose corners are not far from them.
#[inline(always)]
fn medium_lanes<S: Simd>(s: S, t: &Lanes<S>, bounds: &[S::I; 4]) -> Mask {
    let (wide, high) = (
        s.sub_i(s.shr_i::<3>(bounds[2]), s.shr_i::<3>(bounds[0])),
        s.sub_i(s.shr_i::<3>(bounds[3]), s.shr_i::<3>(bounds[1])),
    );
    let most = s.splat_i(MEDIUM_EXTENT);
    !s.gt_i(extent(s, &t.x), most) & !s.gt_i(extent(s, &t.y), most) & fits(s, wide, high)
}

/// Where so many columns and rows, less one, fit 2x8, 4x4 or 8x2.
#[inline(always)]
fn fits<S: Simd>(s: S, wide: S::I, high: S::I) -> Mask {
    let (two, four, eight) = (s.splat_i(2), s.splat_i(4), s.splat_i(8));
    s.gt_i(two, wide) & s.gt_i(eight, high)
        | s.gt_i(four, wide) & s.gt_i(four, high)
        | s.gt_i(eight, wide) & s.gt_i(two, high)
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
