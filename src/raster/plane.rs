//! The one depth function: the plane of a triangle, and its value at a sample.
//!
//! The plane comes from the homogeneous corners in f64, never from divided ones (SEMANTICS, *Depth, ties, and what
//! "visible" means*): with corners (X, Y, W, Z) before the division, depth is `A x + B y + C` where `A X + B Y + C W = Z` for
//! all three, which Cramer's rule gives also for corners behind the eye. X and Y are first moved to the first sample of
//! the triangle's rectangle, so that nothing is extrapolated from the screen's corner.
//!
//! A sample's depth is summed in f32 from its tile's, its block's and its own part, on the fixed grid of tiles, and
//! clamped to the range of the corners. Rounding is monotone, so the farthest depth of a block is that of one of its corner
//! samples, exactly.

use homcull_simd::{Mask, Simd};

use super::each::each;
use super::grid::TILE;
use super::queue::Lanes;

/// The planes of sixteen triangles.
pub(crate) struct Planes {
    /// Depth at the reference sample, and its change from sample to sample.
    pub z0: [f64; 16],
    pub zx: [f64; 16],
    pub zy: [f64; 16],
    /// The reference sample.
    pub sample_x: [i32; 16],
    pub sample_y: [i32; 16],
    /// Triangles whose depth changes so fast that f32 sums of it may err by more than its own bound: only the range of the
    /// corners holds those, and it must be that of the part on the screen.
    pub steep: Mask,
}

/// The plane of one triangle.
#[derive(Clone, Copy)]
pub(crate) struct Plane {
    pub z0: f64,
    pub zx: f64,
    pub zy: f64,
    pub sample_x: i32,
    pub sample_y: i32,
    /// The range of the corners: larger is nearer.
    pub near: f32,
    pub far: f32,
}

impl Planes {
    /// Planes of triangles whose rectangles begin at the samples `x`, `y`. A triangle without a finite plane (seen edge-on)
    /// is flat, at its farthest corner.
    #[inline(always)]
    pub fn new<S: Simd>(s: S, t: &Lanes<S>, x: S::I, y: S::I) -> Planes {
        let (cx, cy) = (center(s, x), center(s, y));
        let w: [S::D; 3] = each!(3, q => s.d_from_f(t.clip[2][q]));
        let z: [S::D; 3] = each!(3, q => s.d_from_f(t.clip[3][q]));
        let px: [S::D; 3] = each!(3, q => s.sub_d(s.d_from_f(t.clip[0][q]), s.mul_d(cx, w[q])));
        let py: [S::D; 3] = each!(3, q => s.sub_d(s.d_from_f(t.clip[1][q]), s.mul_d(cy, w[q])));
        let (mx, my, mz) = (minors(s, &py, &w), minors(s, &w, &px), minors(s, &px, &py));
        let inverse = s.div_d(s.splat_d(1.0), dot(s, &px, &mx));
        let per_sample = s.mul_d(inverse, s.splat_d(256.0));
        let (zx, zy) = (s.mul_d(dot(s, &z, &mx), per_sample), s.mul_d(dot(s, &z, &my), per_sample));
        let z0 = s.mul_d(dot(s, &z, &mz), inverse);
        let ok = finite(s, zx) & finite(s, zy) & finite(s, z0);
        let zero = s.splat_d(0.0);
        let change = s.mul_d(s.add_d(magnitude(s, zx), magnitude(s, zy)), s.splat_d(31.0));
        let steep = ok & s.gt_d(change, s.mul_d(s.d_from_f(t.far), s.splat_d(4.0)));
        let mut out =
            Planes { z0: [0.0; 16], zx: [0.0; 16], zy: [0.0; 16], sample_x: [0; 16], sample_y: [0; 16], steep };
        s.store_d(s.blend_d(ok, zero, zx), &mut out.zx);
        s.store_d(s.blend_d(ok, zero, zy), &mut out.zy);
        s.store_d(s.blend_d(ok, s.d_from_f(t.far), z0), &mut out.z0);
        s.store_i(x, &mut out.sample_x);
        s.store_i(y, &mut out.sample_y);
        out
    }

    #[inline(always)]
    pub fn lane(&self, l: usize, near: f32, far: f32) -> Plane {
        let (sample_x, sample_y) = (self.sample_x[l], self.sample_y[l]);
        Plane { z0: self.z0[l], zx: self.zx[l], zy: self.zy[l], sample_x, sample_y, near, far }
    }
}

/// Lanes that f32 can work with; a NaN is not among them.
#[inline(always)]
fn finite<S: Simd>(s: S, v: S::D) -> Mask {
    s.gt_d(s.splat_d(1e30), magnitude(s, v))
}

#[inline(always)]
fn magnitude<S: Simd>(s: S, v: S::D) -> S::D {
    s.max_d(v, s.sub_d(s.splat_d(0.0), v))
}

/// Sample numbers to their centres, in subpixels.
#[inline(always)]
fn center<S: Simd>(s: S, sample: S::I) -> S::D {
    s.d_from_i(s.add_i(s.shl_i::<8>(sample), s.splat_i(128)))
}

/// The cross product of two columns.
#[inline(always)]
fn minors<S: Simd>(s: S, a: &[S::D; 3], b: &[S::D; 3]) -> [S::D; 3] {
    each!(3, q => s.sub_d(s.mul_d(a[(q + 1) % 3], b[(q + 2) % 3]), s.mul_d(a[(q + 2) % 3], b[(q + 1) % 3])))
}

#[inline(always)]
fn dot<S: Simd>(s: S, a: &[S::D; 3], b: &[S::D; 3]) -> S::D {
    s.add_d(s.add_d(s.mul_d(a[0], b[0]), s.mul_d(a[1], b[1])), s.mul_d(a[2], b[2]))
}

/// A plane's depths by tile, block and sample.
pub(crate) struct Depths<S: Simd> {
    plane: Plane,
    /// What each of a tile's sixteen blocks adds.
    blocks: S::F,
    /// What each of a block's 64 samples adds, two rows a vector.
    samples: [S::F; 4],
    /// The least and the greatest of them.
    farther: f32,
    nearer: f32,
}

/// Columns and rows, in samples: of a tile's blocks, and of the samples in the first two rows of a block.
const BLOCK_X: [f32; 16] = [0., 8., 16., 24., 0., 8., 16., 24., 0., 8., 16., 24., 0., 8., 16., 24.];
const BLOCK_Y: [f32; 16] = [0., 0., 0., 0., 8., 8., 8., 8., 16., 16., 16., 16., 24., 24., 24., 24.];
const SAMPLE_X: [f32; 16] = [0., 1., 2., 3., 4., 5., 6., 7., 0., 1., 2., 3., 4., 5., 6., 7.];
const SAMPLE_Y: [f32; 16] = [0., 0., 0., 0., 0., 0., 0., 0., 1., 1., 1., 1., 1., 1., 1., 1.];
impl<S: Simd> Depths<S> {
    #[inline(always)]
    pub fn new(s: S, plane: Plane) -> Depths<S> {
        let (zx, zy) = (plane.zx as f32, plane.zy as f32);
        let (vx, vy) = (s.splat_f(zx), s.splat_f(zy));
        let across = s.mul_f(vx, s.load_f(&SAMPLE_X));
        let row = s.load_f(&SAMPLE_Y);
        Depths {
            plane,
            blocks: s.add_f(s.mul_f(vx, s.load_f(&BLOCK_X)), s.mul_f(vy, s.load_f(&BLOCK_Y))),
            samples: each!(4, i => s.add_f(across, s.mul_f(vy, s.add_f(row, s.splat_f(2.0 * i as f32))))),
            farther: (zx * 7.0).min(0.0) + (zy * 7.0).min(0.0),
            nearer: (zx * 7.0).max(0.0) + (zy * 7.0).max(0.0),
        }
    }

    /// The unclamped depths of the first samples of sixteen tiles.
    #[inline(always)]
    pub fn tiles(&self, s: S, tile_x: S::I, tile_y: S::I) -> S::F {
        let p = &self.plane;
        let dx = s.d_from_i(s.sub_i(s.shl_i::<5>(tile_x), s.splat_i(p.sample_x)));
        let dy = s.d_from_i(s.sub_i(s.shl_i::<5>(tile_y), s.splat_i(p.sample_y)));
        let rise = s.add_d(s.mul_d(s.splat_d(p.zx), dx), s.mul_d(s.splat_d(p.zy), dy));
        s.f_from_d(s.add_d(s.splat_d(p.z0), rise))
    }

    /// The unclamped depths of the first samples of a tile's blocks, from that of the tile.
    #[inline(always)]
    pub fn tile(&self, s: S, first: f32) -> S::F {
        s.add_f(s.splat_f(first), self.blocks)
    }

    /// The unclamped depths of the first samples of sixteen blocks, wherever their tiles are.
    #[inline(always)]
    pub fn blocks(&self, s: S, x: S::I, y: S::I) -> S::F {
        let three = s.splat_i(3);
        let across = s.f_from_i(s.shl_i::<3>(s.and_i(x, three)));
        let down = s.f_from_i(s.shl_i::<3>(s.and_i(y, three)));
        let (zx, zy) = (s.splat_f(self.plane.zx as f32), s.splat_f(self.plane.zy as f32));
        let within = s.add_f(s.mul_f(zx, across), s.mul_f(zy, down));
        s.add_f(self.tiles(s, s.shr_i::<2>(x), s.shr_i::<2>(y)), within)
    }

    /// What each of a block's samples adds to the first.
    #[inline(always)]
    pub fn store_samples(&self, s: S, to: &mut [[f32; 16]; 4]) {
        for i in 0..4 {
            s.store_f(self.samples[i], &mut to[i]);
        }
    }

    /// The unclamped depth of the first sample of a tile.
    #[inline(always)]
    pub fn tile_first(&self, tile_x: i32, tile_y: i32) -> f32 {
        let p = &self.plane;
        let (dx, dy) = (tile_x * TILE as i32 - p.sample_x, tile_y * TILE as i32 - p.sample_y);
        (p.z0 + (p.zx * f64::from(dx) + p.zy * f64::from(dy))) as f32
    }

    /// The farthest and the nearest depth in each block of a tile.
    #[inline(always)]
    pub fn range(&self, s: S, tile: S::F) -> (S::F, S::F) {
        (self.clamp(s, s.add_f(tile, s.splat_f(self.farther))), self.clamp(s, s.add_f(tile, s.splat_f(self.nearer))))
    }

    /// The depths of a block's 64 samples, from the unclamped depth of its first.
    #[inline(always)]
    pub fn block(&self, s: S, first: f32) -> [S::F; 4] {
        let first = s.splat_f(first);
        each!(4, i => self.clamp(s, s.add_f(first, self.samples[i])))
    }

    #[inline(always)]
    fn clamp(&self, s: S, z: S::F) -> S::F {
        s.min_f(s.max_f(z, s.splat_f(self.plane.far)), s.splat_f(self.plane.near))
    }
}
