//! Triangles that are not small: set up sixteen at a time, each then drawn as a convex polygon (`convex.rs`).

use homcull_simd::Simd;

use super::convex::Convex;
use super::each::each;
use super::engine::Engine;
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
