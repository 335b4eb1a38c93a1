//! Sixteen lanes at every SIMD level, with the same bits.
//!
//! A kernel is written once, generic over [`Simd`], and always sees sixteen lanes: one register at AVX-512, two at AVX2
//! (four at a 128-bit level, whose place is beside `avx2.rs`), plain arrays at the scalar level. [`Level::run`] picks the
//! instructions at run time. A token of a level exists only where the CPU has *every* feature that the level uses, which
//! is what makes the intrinsics behind the safe methods sound.
//!
//! Only exact operations are offered, so that every level gives the same bits: no fused multiply-add, no reciprocal
//! approximations, one rule for NaN in `min` and `max` (the second operand is returned), one order in reductions that
//! could tell (there are none: minimum and maximum do not).

#![deny(unsafe_op_in_unsafe_fn)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod level;
mod prefetch;
mod scalar;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub use avx512::Avx512;
pub use level::{Kernel, Level};
pub use prefetch::prefetch;
pub use scalar::Scalar;

/// Lanes of a vector, at every level.
pub const LANES: usize = 16;

/// A mask over the sixteen lanes, lane 0 in the lowest bit.
pub type Mask = u16;

/// The operations of one level. `F` is sixteen f32, `I` sixteen i32, `D` sixteen f64.
///
/// Names end in the type they work on: `add_f`, `add_i`, `add_d`. Integer arithmetic wraps.
#[allow(missing_docs)] // the element-wise operations are what their names say
pub trait Simd: Copy + Send + Sync + 'static {
    /// Which level this is.
    const LEVEL: Level;
    type F: Copy;
    type I: Copy;
    type D: Copy;

    /// Runs a kernel compiled for this level.
    fn vectorize<K: Kernel>(self, kernel: K) -> K::Output;

    fn splat_f(self, v: f32) -> Self::F;
    fn load_f(self, v: &[f32; 16]) -> Self::F;
    fn store_f(self, v: Self::F, to: &mut [f32; 16]);
    fn add_f(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub_f(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul_f(self, a: Self::F, b: Self::F) -> Self::F;
    fn div_f(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a < b ? a : b`: `b` when either is NaN.
    fn min_f(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a > b ? a : b`: `b` when either is NaN.
    fn max_f(self, a: Self::F, b: Self::F) -> Self::F;
    fn abs_f(self, a: Self::F) -> Self::F;
    fn gt_f(self, a: Self::F, b: Self::F) -> Mask;
    fn ge_f(self, a: Self::F, b: Self::F) -> Mask;
    fn eq_f(self, a: Self::F, b: Self::F) -> Mask;
    /// `b` where the mask is set, else `a`.
    fn blend_f(self, k: Mask, a: Self::F, b: Self::F) -> Self::F;
    /// The smallest lane; no lane may be NaN.
    fn reduce_min_f(self, a: Self::F) -> f32;
    /// The largest lane; no lane may be NaN.
    fn reduce_max_f(self, a: Self::F) -> f32;
    /// To the nearest integer, ties to even. The lane is unspecified but the same at every level where |a| < 2^31 fails: `i32::MIN`.
    fn round_i(self, a: Self::F) -> Self::I;
    /// To the integer below; `i32::MIN` where it does not fit.
    fn floor_i(self, a: Self::F) -> Self::I;
    /// To the nearest f32.
    fn f_from_i(self, a: Self::I) -> Self::F;
    fn f_from_bits(self, a: Self::I) -> Self::F;
    fn bits_of_f(self, a: Self::F) -> Self::I;

    fn splat_i(self, v: i32) -> Self::I;
    fn load_i(self, v: &[i32; 16]) -> Self::I;
    /// Zero-extends sixteen bytes.
    fn load_u8(self, v: &[u8; 16]) -> Self::I;
    fn store_i(self, v: Self::I, to: &mut [i32; 16]);
    fn add_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn sub_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn mul_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn min_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn max_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn and_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn or_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn shl_i<const N: u32>(self, a: Self::I) -> Self::I;
    /// Arithmetic shift right.
    fn shr_i<const N: u32>(self, a: Self::I) -> Self::I;
    fn gt_i(self, a: Self::I, b: Self::I) -> Mask;
    fn eq_i(self, a: Self::I, b: Self::I) -> Mask;
    /// The lanes below zero.
    fn sign_i(self, a: Self::I) -> Mask;
    fn blend_i(self, k: Mask, a: Self::I, b: Self::I) -> Self::I;
    fn reduce_min_i(self, a: Self::I) -> i32;
    fn reduce_max_i(self, a: Self::I) -> i32;
    /// Packs the lanes of the mask to the front; the other places of `to` get unspecified values.
    fn compress_i(self, k: Mask, a: Self::I, to: &mut [i32; 16]);
    /// Packs the lanes of the mask to the front; the other places of `to` get unspecified values.
    fn compress_f(self, k: Mask, a: Self::F, to: &mut [f32; 16]);
    /// `table[index & 31]`.
    fn lookup_i(self, table: &[i32; 32], index: Self::I) -> Self::I;
    /// `table[index & 31]`.
    fn lookup_f(self, table: &[f32; 32], index: Self::I) -> Self::F;
    /// `table[index]` where the mask is set, else `or`.
    ///
    /// # Panics
    /// When an index under the mask is out of range.
    fn gather_f(self, k: Mask, table: &[f32], index: Self::I, or: Self::F) -> Self::F;

    /// As [`Simd::gather_f`].
    ///
    /// # Panics
    /// When an index under the mask is out of range.
    fn gather_i(self, k: Mask, table: &[i32], index: Self::I, or: Self::I) -> Self::I;

    fn splat_d(self, v: f64) -> Self::D;
    fn store_d(self, v: Self::D, to: &mut [f64; 16]);
    fn add_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn sub_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn mul_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn div_d(self, a: Self::D, b: Self::D) -> Self::D;
    /// `a < b ? a : b`: `b` when either is NaN.
    fn min_d(self, a: Self::D, b: Self::D) -> Self::D;
    /// `a > b ? a : b`: `b` when either is NaN.
    fn max_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn floor_d(self, a: Self::D) -> Self::D;
    fn gt_d(self, a: Self::D, b: Self::D) -> Mask;
    fn eq_d(self, a: Self::D, b: Self::D) -> Mask;
    fn blend_d(self, k: Mask, a: Self::D, b: Self::D) -> Self::D;
    fn d_from_f(self, a: Self::F) -> Self::D;
    fn d_from_i(self, a: Self::I) -> Self::D;
    /// Of integers that fit.
    fn i_from_d(self, a: Self::D) -> Self::I;
    /// To the nearest f32.
    fn f_from_d(self, a: Self::D) -> Self::F;

    /// Coverage of an 8x8 block from three edge functions in 16 bits: bit `8 y + x` is set when
    /// `c + a x + b y >= 0` for all three, with saturating sums. Exact while `7 (|a| + |b|) <= 32767` for each edge.
    fn coverage_16(self, a: [i16; 3], b: [i16; 3], c: [i16; 3]) -> u64;
}
