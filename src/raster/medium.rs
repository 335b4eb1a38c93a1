//! Triangles of middle size, those of at most 2x8, 4x4 or 8x2 blocks: their blocks are listed sixteen triangles at a time, wherever their
//! tiles lie, and then drawn in one flat loop.
//!
//! What a triangle of that size costs as a polygon (`convex.rs`) is mostly the window around it. Here it has none: a lane is a
//! block, floors are gathered. Edge functions fit 32 bits: they change by at most 2^14 from sample to sample, and the blocks
//! reach at most 8 samples beyond the corners.

use homcull_simd::{Mask, Simd};

use super::convex::{AHEAD, Convex, LISTED, SAMPLE_X, SAMPLE_Y, coverage};
use super::engine::Engine;
use super::plane::Depths;
use super::sink::{Sink, shows};
use super::transform::lanes_mut;

/// Width and height of a triangle of middle size, in subpixels, at most.
pub(crate) const MEDIUM_EXTENT: i32 = 64 << 8;

/// Blocks of up to sixteen triangles, to be drawn sample by sample.
#[repr(C, align(64))]
pub(crate) struct MediumBlocks {
    len: usize,
    /// The edge functions at each block's first sample.
    edges: [[i32; LISTED]; 3],
    /// The unclamped depth there.
    first: [f32; LISTED],
    /// 16 times the tile, plus the block.
    place: [i32; LISTED],
    /// Which of the triangles it is a block of.
    whose: [i32; LISTED],
    triangles: [Triangle; 16],
}

/// What a triangle's blocks have in common.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Triangle {
    /// The edge functions from a block's first sample to those of its first two rows.
    samples: [[i32; 16]; 3],
    /// The depths from a block's first sample to all of them, two rows a vector.
    depths: [[f32; 16]; 4],
    /// How the edge functions change within two rows.
    rows: [i32; 3],
    near: f32,
    far: f32,
    id: u32,
}

impl MediumBlocks {
    pub fn new() -> MediumBlocks {
        let none = Triangle { samples: [[0; 16]; 3], depths: [[0.0; 16]; 4], rows: [0; 3], near: 0.0, far: 0.0, id: 0 };
        MediumBlocks {
            len: 0,
            edges: [[0; LISTED]; 3],
            first: [0.0; LISTED],
            place: [0; LISTED],
            whose: [0; LISTED],
            triangles: [none; 16],
        }
    }
}

/// Sixteen blocks: their columns and rows.
struct Shape {
    column: [i32; 16],
    row: [i32; 16],
}

/// 2x8, 4x4 and 8x2 blocks: by the logarithm of the columns, less one.
const SHAPES: [Shape; 3] = [
    Shape {
        column: [0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1],
        row: [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7],
    },
    Shape {
        column: [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3],
        row: [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3],
    },
    Shape {
        column: [0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7],
        row: [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1],
    },
];

impl<'a, S: Simd, K: Sink<'a>> Engine<'_, S, K> {
    /// Raises the whole blocks of a triangle, and lists those that it covers in part, or of which every sample is asked.
    #[inline(always)]
    pub(crate) fn list_medium(&mut self, t: &Convex<3>, l: usize) {
        let s = self.simd;
        self.counts.large += 1;
        let [x0, y0, x1, y1] = t.blocks;
        let shape = &SHAPES[usize::from(x1 - x0 > 1) + usize::from(x1 - x0 > 3)];
        let (column, row) = (s.load_i(&shape.column), s.load_i(&shape.row));
        let mut touched = !(s.gt_i(column, s.splat_i(x1 - x0)) | s.gt_i(row, s.splat_i(y1 - y0)));
        let (bx, by) = (s.add_i(s.splat_i(x0), column), s.add_i(s.splat_i(y0), row));
        let place = self.block_numbers(bx, by);
        let near = s.splat_f(t.plane.near);
        let floors = s.gather_f(touched, self.sink.surface().blocks.as_flattened(), place, near);
        touched &= if K::EXACT { shows::<S, true>(s, near, floors) } else { shows::<S, false>(s, near, floors) };
        if touched == 0 {
            return;
        }
        let mut inside = touched;
        let depths = Depths::new(s, t.plane);
        let first = depths.blocks(s, bx, by);
        let (far, near) = depths.range(s, first);
        let (sx, sy) = (s.load_i(&SAMPLE_X), s.load_i(&SAMPLE_Y));
        let (across, down) = (s.shl_i::<3>(column), s.shl_i::<3>(row));
        let mut e = [s.splat_i(0); 3];
        let list = &mut self.queues.medium;
        let own = &mut list.triangles[l];
        for q in 0..3 {
            let from = t.c[q] + f64::from(t.a[q]) * f64::from(8 * x0) + f64::from(t.b[q]) * f64::from(8 * y0);
            let (a, b) = (s.splat_i(t.a[q]), s.splat_i(t.b[q]));
            e[q] = s.add_i(s.splat_i(from as i32), s.add_i(s.mul_i(a, across), s.mul_i(b, down)));
            s.store_i(s.add_i(s.mul_i(a, sx), s.mul_i(b, sy)), &mut own.samples[q]);
            own.rows[q] = 2 * t.b[q];
            let (most, least) = (7 * (t.a[q].max(0) + t.b[q].max(0)), 7 * (t.a[q].min(0) + t.b[q].min(0)));
            touched &= !s.sign_i(s.add_i(e[q], s.splat_i(most)));
            inside &= !s.sign_i(s.add_i(e[q], s.splat_i(least)));
        }
        (own.near, own.far, own.id) = (t.plane.near, t.plane.far, t.id);
        depths.store_samples(s, &mut own.depths);
        let mut listed =
            touched & if K::EXACT { shows::<S, true>(s, near, floors) } else { shows::<S, false>(s, near, floors) };
        if !K::EXACT {
            listed &= !inside;
            self.raise_blocks(inside & shows::<S, false>(s, far, floors), place, far);
        }
        let list = &mut self.queues.medium;
        let to = list.len..list.len + 16;
        for q in 0..3 {
            s.compress_i(listed, e[q], lanes_mut(&mut list.edges[q][to.clone()]));
        }
        s.compress_f(listed, first, lanes_mut(&mut list.first[to.clone()]));
        s.compress_i(listed, place, lanes_mut(&mut list.place[to.clone()]));
        s.store_i(s.splat_i(l as i32), lanes_mut(&mut list.whose[to]));
        list.len += listed.count_ones() as usize;
    }

    /// Raises whole blocks, wherever they are.
    #[inline(always)]
    fn raise_blocks(&mut self, blocks: Mask, place: S::I, far: S::F) {
        let s = self.simd;
        if blocks == 0 {
            return;
        }
        let (mut places, mut fars) = ([0; 16], [0.0; 16]);
        s.store_i(place, &mut places);
        s.store_f(far, &mut fars);
        let mut left = blocks;
        while left != 0 {
            let i = left.trailing_zeros() as usize;
            left &= left - 1;
            let (tile, block) = (places[i] as usize >> 4, places[i] & 15);
            let floors = s.load_f(&self.sink.surface().blocks[tile]);
            let floors = self.sink.whole(s, tile, 1 << block, floors, s.splat_f(fars[i]));
            self.sink.surface().set_blocks(s, tile, floors);
        }
    }

    /// Draws the listed blocks, sample by sample.
    #[inline(always)]
    pub(crate) fn draw_medium(&mut self) {
        let s = self.simd;
        let len = std::mem::take(&mut self.queues.medium.len);
        for i in 0..len {
            let list = &self.queues.medium;
            let ahead = list.place[(i + AHEAD).min(len - 1)];
            self.sink.expect(ahead as usize >> 4, ahead as usize & 15);
            let (tile, block) = (list.place[i] as usize >> 4, list.place[i] as usize & 15);
            let own = &list.triangles[list.whose[i] as usize & 15];
            let mut e = [s.splat_i(0); 3];
            let mut rows = e;
            for q in 0..3 {
                e[q] = s.add_i(s.splat_i(list.edges[q][i]), s.load_i(&own.samples[q]));
                rows[q] = s.splat_i(own.rows[q]);
            }
            let word = coverage(s, e, &rows);
            let (near, far) = (s.splat_f(own.near), s.splat_f(own.far));
            let first = s.splat_f(list.first[i]);
            let mut z = [near; 4];
            for k in 0..4 {
                z[k] = s.min_f(s.max_f(s.add_f(first, s.load_f(&own.depths[k])), far), near);
            }
            let (id, far) = (own.id, own.far);
            let floor = self.emit(tile, block, word, z, id, far);
            self.sink.surface().raise(s, tile, block, floor);
        }
    }
}
