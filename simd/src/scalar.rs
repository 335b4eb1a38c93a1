//! The scalar level: the reference for all others.

use crate::{Kernel, Level, Mask, Simd};

/// The token of the scalar level; every CPU has it.
#[derive(Debug, Clone, Copy)]
pub struct Scalar;

#[inline(always)]
fn zip<T: Copy, U: Copy, R>(a: [T; 16], b: [U; 16], f: impl Fn(T, U) -> R) -> [R; 16] {
    std::array::from_fn(|i| f(a[i], b[i]))
}

#[inline(always)]
fn mask(f: impl Fn(usize) -> bool) -> Mask {
    let mut k = 0;
    for i in 0..16 {
        k |= u16::from(f(i)) << i;
    }
    k
}

#[inline(always)]
fn select<T: Copy>(k: Mask, a: [T; 16], b: [T; 16]) -> [T; 16] {
    std::array::from_fn(|i| if k >> i & 1 != 0 { b[i] } else { a[i] })
}

#[inline(always)]
fn compress<T: Copy>(k: Mask, a: [T; 16], to: &mut [T; 16]) {
    let mut n = 0;
    for (i, &v) in a.iter().enumerate() {
        to[n & 15] = v;
        n += usize::from(k >> i & 1);
    }
}

/// What the conversion instructions give: `i32::MIN` where the value does not fit.
#[inline(always)]
fn to_i32(v: f32) -> i32 {
    if v.abs() < 2_147_483_648.0 { v as i32 } else { i32::MIN }
}

macro_rules! zipped {
    ($($name:ident $ty:ident |$a:ident, $b:ident| $body:expr;)*) => { $(
        #[inline(always)]
        fn $name(self, a: Self::$ty, b: Self::$ty) -> Self::$ty { zip(a, b, |$a, $b| $body) }
    )* };
}

macro_rules! compared {
    ($($name:ident $ty:ident |$a:ident, $b:ident| $body:expr;)*) => { $(
        #[inline(always)]
        fn $name(self, a: Self::$ty, b: Self::$ty) -> Mask { mask(|i| { let ($a, $b) = (a[i], b[i]); $body }) }
    )* };
}

impl Simd for Scalar {
    const LEVEL: Level = Level::Scalar;
    type F = [f32; 16];
    type I = [i32; 16];
    type D = [f64; 16];

    #[inline(never)]
    fn vectorize<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }

    zipped! {
        add_f F |a, b| a + b; sub_f F |a, b| a - b; mul_f F |a, b| a * b; div_f F |a, b| a / b;
        min_f F |a, b| if a < b { a } else { b }; max_f F |a, b| if a > b { a } else { b };
        add_i I |a, b| a.wrapping_add(b); sub_i I |a, b| a.wrapping_sub(b); mul_i I |a, b| a.wrapping_mul(b);
        min_i I |a, b| a.min(b); max_i I |a, b| a.max(b); and_i I |a, b| a & b; or_i I |a, b| a | b;
        add_d D |a, b| a + b; sub_d D |a, b| a - b; mul_d D |a, b| a * b; div_d D |a, b| a / b;
        min_d D |a, b| if a < b { a } else { b }; max_d D |a, b| if a > b { a } else { b };
    }
    compared! {
        gt_f F |a, b| a > b; ge_f F |a, b| a >= b; eq_f F |a, b| a == b;
        gt_i I |a, b| a > b; eq_i I |a, b| a == b;
        gt_d D |a, b| a > b; eq_d D |a, b| a == b;
    }

    #[inline(always)]
    fn splat_f(self, v: f32) -> [f32; 16] {
        [v; 16]
    }
    #[inline(always)]
    fn load_f(self, v: &[f32; 16]) -> [f32; 16] {
        *v
    }
    #[inline(always)]
    fn store_f(self, v: [f32; 16], to: &mut [f32; 16]) {
        *to = v;
    }
    #[inline(always)]
    fn abs_f(self, a: [f32; 16]) -> [f32; 16] {
        a.map(f32::abs)
    }
    #[inline(always)]
    fn blend_f(self, k: Mask, a: [f32; 16], b: [f32; 16]) -> [f32; 16] {
        select(k, a, b)
    }
    #[inline(always)]
    fn reduce_min_f(self, a: [f32; 16]) -> f32 {
        a.into_iter().fold(f32::INFINITY, |x, y| if x < y { x } else { y })
    }
    #[inline(always)]
    fn reduce_max_f(self, a: [f32; 16]) -> f32 {
        a.into_iter().fold(f32::NEG_INFINITY, |x, y| if x > y { x } else { y })
    }
    #[inline(always)]
    fn round_i(self, a: [f32; 16]) -> [i32; 16] {
        a.map(|v| to_i32(v.round_ties_even()))
    }
    #[inline(always)]
    fn floor_i(self, a: [f32; 16]) -> [i32; 16] {
        a.map(|v| to_i32(v.floor()))
    }
    #[inline(always)]
    fn f_from_i(self, a: [i32; 16]) -> [f32; 16] {
        a.map(|v| v as f32)
    }
    #[inline(always)]
    fn f_from_bits(self, a: [i32; 16]) -> [f32; 16] {
        a.map(|v| f32::from_bits(v as u32))
    }
    #[inline(always)]
    fn bits_of_f(self, a: [f32; 16]) -> [i32; 16] {
        a.map(|v| v.to_bits() as i32)
    }

    #[inline(always)]
    fn splat_i(self, v: i32) -> [i32; 16] {
        [v; 16]
    }
    #[inline(always)]
    fn load_i(self, v: &[i32; 16]) -> [i32; 16] {
        *v
    }
    #[inline(always)]
    fn load_u8(self, v: &[u8; 16]) -> [i32; 16] {
        v.map(i32::from)
    }
    #[inline(always)]
    fn store_i(self, v: [i32; 16], to: &mut [i32; 16]) {
        *to = v;
    }
    #[inline(always)]
    fn shl_i<const N: u32>(self, a: [i32; 16]) -> [i32; 16] {
        a.map(|v| v << N)
    }
    #[inline(always)]
    fn shr_i<const N: u32>(self, a: [i32; 16]) -> [i32; 16] {
        a.map(|v| v >> N)
    }
    #[inline(always)]
    fn sign_i(self, a: [i32; 16]) -> Mask {
        mask(|i| a[i] < 0)
    }
    #[inline(always)]
    fn blend_i(self, k: Mask, a: [i32; 16], b: [i32; 16]) -> [i32; 16] {
        select(k, a, b)
    }
    #[inline(always)]
    fn reduce_min_i(self, a: [i32; 16]) -> i32 {
        a.into_iter().fold(i32::MAX, i32::min)
    }
    #[inline(always)]
    fn reduce_max_i(self, a: [i32; 16]) -> i32 {
        a.into_iter().fold(i32::MIN, i32::max)
    }
    #[inline(always)]
    fn compress_i(self, k: Mask, a: [i32; 16], to: &mut [i32; 16]) {
        compress(k, a, to);
    }
    #[inline(always)]
    fn compress_f(self, k: Mask, a: [f32; 16], to: &mut [f32; 16]) {
        compress(k, a, to);
    }
    #[inline(always)]
    fn lookup_i(self, table: &[i32; 32], index: [i32; 16]) -> [i32; 16] {
        index.map(|i| table[(i & 31) as usize])
    }
    #[inline(always)]
    fn lookup_f(self, table: &[f32; 32], index: [i32; 16]) -> [f32; 16] {
        index.map(|i| table[(i & 31) as usize])
    }
    #[inline(always)]
    fn gather_f(self, k: Mask, table: &[f32], index: [i32; 16], or: [f32; 16]) -> [f32; 16] {
        std::array::from_fn(|i| if k >> i & 1 != 0 { table[index[i] as usize] } else { or[i] })
    }

    #[inline(always)]
    fn gather_i(self, k: Mask, table: &[i32], index: [i32; 16], or: [i32; 16]) -> [i32; 16] {
        std::array::from_fn(|i| if k >> i & 1 != 0 { table[index[i] as usize] } else { or[i] })
    }

    #[inline(always)]
    fn splat_d(self, v: f64) -> [f64; 16] {
        [v; 16]
    }
    #[inline(always)]
    fn store_d(self, v: [f64; 16], to: &mut [f64; 16]) {
        *to = v;
    }
    #[inline(always)]
    fn floor_d(self, a: [f64; 16]) -> [f64; 16] {
        a.map(f64::floor)
    }
    #[inline(always)]
    fn blend_d(self, k: Mask, a: [f64; 16], b: [f64; 16]) -> [f64; 16] {
        select(k, a, b)
    }
    #[inline(always)]
    fn d_from_f(self, a: [f32; 16]) -> [f64; 16] {
        a.map(f64::from)
    }
    #[inline(always)]
    fn d_from_i(self, a: [i32; 16]) -> [f64; 16] {
        a.map(f64::from)
    }
    #[inline(always)]
    fn i_from_d(self, a: [f64; 16]) -> [i32; 16] {
        a.map(|v| v as i32)
    }
    #[inline(always)]
    fn f_from_d(self, a: [f64; 16]) -> [f32; 16] {
        a.map(|v| v as f32)
    }

    #[inline(always)]
    fn coverage_16(self, a: [i16; 3], b: [i16; 3], c: [i16; 3]) -> u64 {
        let mut out = 0u64;
        for q in 0..3 {
            for y in 0..8i16 {
                let row = b[q].wrapping_mul(y);
                for x in 0..8i16 {
                    let e = c[q].saturating_add(a[q].wrapping_mul(x)).saturating_add(row);
                    out |= u64::from(e < 0) << (8 * y + x);
                }
            }
        }
        !out
    }
}
