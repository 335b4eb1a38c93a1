//! The AVX2 level: sixteen lanes are two registers.

use std::arch::x86_64::*;

use crate::{Kernel, Level, Mask, Simd};

/// The token of the AVX2 level: whoever holds one runs on a CPU that has all its features.
#[derive(Debug, Clone, Copy)]
pub struct Avx2(());

impl Avx2 {
    /// `Some` when the CPU has every feature of the level.
    #[inline]
    pub fn new() -> Option<Avx2> {
        let has = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has.then_some(Avx2(()))
    }
}

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn enter<K: Kernel>(token: Avx2, kernel: K) -> K::Output {
    kernel.run(token)
}

type F = [__m256; 2];
type I = [__m256i; 2];
type D = [__m256d; 4];

/// Sixteen mask bits as full lanes.
#[inline(always)]
unsafe fn spread(k: Mask) -> I {
    // SAFETY: called by methods of the token alone, which exists only where `Avx2::new` saw AVX2.
    unsafe {
        let k = _mm256_set1_epi32(i32::from(k));
        let low = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        let high = _mm256_slli_epi32::<8>(low);
        [_mm256_cmpeq_epi32(_mm256_and_si256(k, low), low), _mm256_cmpeq_epi32(_mm256_and_si256(k, high), high)]
    }
}

/// The bits of both registers as floats.
#[inline(always)]
unsafe fn as_f(v: I) -> F {
    // SAFETY: called by methods of the token alone, which exists only where `Avx2::new` saw AVX2.
    unsafe { [_mm256_castsi256_ps(v[0]), _mm256_castsi256_ps(v[1])] }
}

/// The sign bits of both registers.
#[inline(always)]
unsafe fn signs(v: F) -> Mask {
    // SAFETY: called by methods of the token alone, which exists only where `Avx2::new` saw AVX2.
    unsafe { _mm256_movemask_ps(v[0]) as u16 | (_mm256_movemask_ps(v[1]) as u16) << 8 }
}

/// The sign bits of all four registers.
#[inline(always)]
unsafe fn signs_d(v: D) -> Mask {
    let mut k = 0;
    for (i, r) in v.into_iter().enumerate() {
        // SAFETY: called by methods of the token alone, which exists only where `Avx2::new` saw AVX2.
        k |= (unsafe { _mm256_movemask_pd(r) } as u16) << (4 * i);
    }
    k
}

#[inline(always)]
fn compress<T: Copy>(k: Mask, a: &[T; 16], to: &mut [T; 16]) {
    let (mut k, mut n) = (k, 0);
    while k != 0 {
        to[n] = a[k.trailing_zeros() as usize];
        k &= k - 1;
        n += 1;
    }
}

macro_rules! methods {
    ($($name:ident($($arg:ident: $ty:ty),*) $(-> $ret:ty)? { $($body:tt)* })*) => { $(
        #[inline(always)]
        fn $name(self, $($arg: $ty),*) $(-> $ret)? {
            // SAFETY: the token exists only where `Avx2::new` saw every feature that these intrinsics need; loads and
            // stores go through references to arrays of exactly the size that is moved.
            unsafe { $($body)* }
        }
    )* };
}

/// `$op` on both registers of two vectors.
macro_rules! both {
    ($op:ident, $a:ident, $b:ident) => {
        [$op($a[0], $b[0]), $op($a[1], $b[1])]
    };
}

/// `$op` on all four registers of two vectors of doubles.
macro_rules! four {
    ($op:ident, $a:ident, $b:ident) => {
        [$op($a[0], $b[0]), $op($a[1], $b[1]), $op($a[2], $b[2]), $op($a[3], $b[3])]
    };
}

impl Simd for Avx2 {
    const LEVEL: Level = Level::Avx2;
    type F = F;
    type I = I;
    type D = D;

    #[inline]
    fn vectorize<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: the token exists only where `Avx2::new` saw every feature that `enter` enables.
        unsafe { enter(self, kernel) }
    }

    methods! {
        splat_f(v: f32) -> F { [_mm256_set1_ps(v); 2] }
        load_f(v: &[f32; 16]) -> F { [_mm256_loadu_ps(v.as_ptr()), _mm256_loadu_ps(v.as_ptr().add(8))] }
        store_f(v: F, to: &mut [f32; 16]) { _mm256_storeu_ps(to.as_mut_ptr(), v[0]); _mm256_storeu_ps(to.as_mut_ptr().add(8), v[1]); }
        add_f(a: F, b: F) -> F { both!(_mm256_add_ps, a, b) }
        sub_f(a: F, b: F) -> F { both!(_mm256_sub_ps, a, b) }
        mul_f(a: F, b: F) -> F { both!(_mm256_mul_ps, a, b) }
        div_f(a: F, b: F) -> F { both!(_mm256_div_ps, a, b) }
        min_f(a: F, b: F) -> F { both!(_mm256_min_ps, a, b) }
        max_f(a: F, b: F) -> F { both!(_mm256_max_ps, a, b) }
        abs_f(a: F) -> F {
            let sign = _mm256_set1_ps(-0.0);
            [_mm256_andnot_ps(sign, a[0]), _mm256_andnot_ps(sign, a[1])]
        }
        gt_f(a: F, b: F) -> Mask { signs([_mm256_cmp_ps::<_CMP_GT_OQ>(a[0], b[0]), _mm256_cmp_ps::<_CMP_GT_OQ>(a[1], b[1])]) }
        ge_f(a: F, b: F) -> Mask { signs([_mm256_cmp_ps::<_CMP_GE_OQ>(a[0], b[0]), _mm256_cmp_ps::<_CMP_GE_OQ>(a[1], b[1])]) }
        eq_f(a: F, b: F) -> Mask { signs([_mm256_cmp_ps::<_CMP_EQ_OQ>(a[0], b[0]), _mm256_cmp_ps::<_CMP_EQ_OQ>(a[1], b[1])]) }
        blend_f(k: Mask, a: F, b: F) -> F {
            let k = spread(k);
            [_mm256_blendv_ps(a[0], b[0], _mm256_castsi256_ps(k[0])), _mm256_blendv_ps(a[1], b[1], _mm256_castsi256_ps(k[1]))]
        }
        reduce_min_f(a: F) -> f32 {
            let v = _mm256_min_ps(a[0], a[1]);
            let v = _mm_min_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps::<1>(v));
            let v = _mm_min_ps(v, _mm_movehl_ps(v, v));
            _mm_cvtss_f32(_mm_min_ss(v, _mm_shuffle_ps::<1>(v, v)))
        }
        reduce_max_f(a: F) -> f32 {
            let v = _mm256_max_ps(a[0], a[1]);
            let v = _mm_max_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps::<1>(v));
            let v = _mm_max_ps(v, _mm_movehl_ps(v, v));
            _mm_cvtss_f32(_mm_max_ss(v, _mm_shuffle_ps::<1>(v, v)))
        }
        round_i(a: F) -> I {
            const NEAREST: i32 = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;
            [_mm256_cvttps_epi32(_mm256_round_ps::<NEAREST>(a[0])), _mm256_cvttps_epi32(_mm256_round_ps::<NEAREST>(a[1]))]
        }
        floor_i(a: F) -> I { [_mm256_cvttps_epi32(_mm256_floor_ps(a[0])), _mm256_cvttps_epi32(_mm256_floor_ps(a[1]))] }
        f_from_i(a: I) -> F { [_mm256_cvtepi32_ps(a[0]), _mm256_cvtepi32_ps(a[1])] }
        f_from_bits(a: I) -> F { [_mm256_castsi256_ps(a[0]), _mm256_castsi256_ps(a[1])] }
        bits_of_f(a: F) -> I { [_mm256_castps_si256(a[0]), _mm256_castps_si256(a[1])] }

        splat_i(v: i32) -> I { [_mm256_set1_epi32(v); 2] }
        load_i(v: &[i32; 16]) -> I { [_mm256_loadu_si256(v.as_ptr().cast()), _mm256_loadu_si256(v.as_ptr().add(8).cast())] }
        load_u8(v: &[u8; 16]) -> I {
            let v = _mm_loadu_si128(v.as_ptr().cast());
            [_mm256_cvtepu8_epi32(v), _mm256_cvtepu8_epi32(_mm_srli_si128::<8>(v))]
        }
        store_i(v: I, to: &mut [i32; 16]) {
            _mm256_storeu_si256(to.as_mut_ptr().cast(), v[0]);
            _mm256_storeu_si256(to.as_mut_ptr().add(8).cast(), v[1]);
        }
        add_i(a: I, b: I) -> I { both!(_mm256_add_epi32, a, b) }
        sub_i(a: I, b: I) -> I { both!(_mm256_sub_epi32, a, b) }
        mul_i(a: I, b: I) -> I { both!(_mm256_mullo_epi32, a, b) }
        min_i(a: I, b: I) -> I { both!(_mm256_min_epi32, a, b) }
        max_i(a: I, b: I) -> I { both!(_mm256_max_epi32, a, b) }
        and_i(a: I, b: I) -> I { both!(_mm256_and_si256, a, b) }
        or_i(a: I, b: I) -> I { both!(_mm256_or_si256, a, b) }
        gt_i(a: I, b: I) -> Mask { signs(as_f(both!(_mm256_cmpgt_epi32, a, b))) }
        eq_i(a: I, b: I) -> Mask { signs(as_f(both!(_mm256_cmpeq_epi32, a, b))) }
        sign_i(a: I) -> Mask { signs(as_f(a)) }
        blend_i(k: Mask, a: I, b: I) -> I {
            let k = spread(k);
            [_mm256_blendv_epi8(a[0], b[0], k[0]), _mm256_blendv_epi8(a[1], b[1], k[1])]
        }
        reduce_min_i(a: I) -> i32 {
            let v = _mm256_min_epi32(a[0], a[1]);
            let v = _mm_min_epi32(_mm256_castsi256_si128(v), _mm256_extracti128_si256::<1>(v));
            let v = _mm_min_epi32(v, _mm_shuffle_epi32::<0b01_00_11_10>(v));
            _mm_cvtsi128_si32(_mm_min_epi32(v, _mm_shuffle_epi32::<1>(v)))
        }
        reduce_max_i(a: I) -> i32 {
            let v = _mm256_max_epi32(a[0], a[1]);
            let v = _mm_max_epi32(_mm256_castsi256_si128(v), _mm256_extracti128_si256::<1>(v));
            let v = _mm_max_epi32(v, _mm_shuffle_epi32::<0b01_00_11_10>(v));
            _mm_cvtsi128_si32(_mm_max_epi32(v, _mm_shuffle_epi32::<1>(v)))
        }
        lookup_i(table: &[i32; 32], index: I) -> I {
            // Every index is masked to the table's 32 places before the gather.
            let last = [_mm256_set1_epi32(31); 2];
            let index = both!(_mm256_and_si256, index, last);
            [_mm256_i32gather_epi32::<4>(table.as_ptr(), index[0]), _mm256_i32gather_epi32::<4>(table.as_ptr(), index[1])]
        }
        lookup_f(table: &[f32; 32], index: I) -> F {
            // Every index is masked to the table's 32 places before the gather.
            let last = [_mm256_set1_epi32(31); 2];
            let index = both!(_mm256_and_si256, index, last);
            [_mm256_i32gather_ps::<4>(table.as_ptr(), index[0]), _mm256_i32gather_ps::<4>(table.as_ptr(), index[1])]
        }

        splat_d(v: f64) -> D { [_mm256_set1_pd(v); 4] }
        store_d(v: D, to: &mut [f64; 16]) {
            for (i, r) in v.into_iter().enumerate() {
                _mm256_storeu_pd(to.as_mut_ptr().add(4 * i), r);
            }
        }
        add_d(a: D, b: D) -> D { four!(_mm256_add_pd, a, b) }
        sub_d(a: D, b: D) -> D { four!(_mm256_sub_pd, a, b) }
        mul_d(a: D, b: D) -> D { four!(_mm256_mul_pd, a, b) }
        div_d(a: D, b: D) -> D { four!(_mm256_div_pd, a, b) }
        min_d(a: D, b: D) -> D { four!(_mm256_min_pd, a, b) }
        max_d(a: D, b: D) -> D { four!(_mm256_max_pd, a, b) }
        floor_d(a: D) -> D { [_mm256_floor_pd(a[0]), _mm256_floor_pd(a[1]), _mm256_floor_pd(a[2]), _mm256_floor_pd(a[3])] }
        gt_d(a: D, b: D) -> Mask { signs_d(std::array::from_fn(|i| _mm256_cmp_pd::<_CMP_GT_OQ>(a[i], b[i]))) }
        eq_d(a: D, b: D) -> Mask { signs_d(std::array::from_fn(|i| _mm256_cmp_pd::<_CMP_EQ_OQ>(a[i], b[i]))) }
        blend_d(k: Mask, a: D, b: D) -> D {
            let bits = _mm256_setr_epi64x(1, 2, 4, 8);
            std::array::from_fn(|i| {
                let k = _mm256_and_si256(_mm256_set1_epi64x(i64::from(k >> (4 * i))), bits);
                _mm256_blendv_pd(a[i], b[i], _mm256_castsi256_pd(_mm256_cmpeq_epi64(k, bits)))
            })
        }
        d_from_f(a: F) -> D {
            [_mm256_cvtps_pd(_mm256_castps256_ps128(a[0])), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(a[0])),
             _mm256_cvtps_pd(_mm256_castps256_ps128(a[1])), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(a[1]))]
        }
        d_from_i(a: I) -> D {
            [_mm256_cvtepi32_pd(_mm256_castsi256_si128(a[0])), _mm256_cvtepi32_pd(_mm256_extracti128_si256::<1>(a[0])),
             _mm256_cvtepi32_pd(_mm256_castsi256_si128(a[1])), _mm256_cvtepi32_pd(_mm256_extracti128_si256::<1>(a[1]))]
        }
        i_from_d(a: D) -> I {
            [_mm256_set_m128i(_mm256_cvtpd_epi32(a[1]), _mm256_cvtpd_epi32(a[0])), _mm256_set_m128i(_mm256_cvtpd_epi32(a[3]), _mm256_cvtpd_epi32(a[2]))]
        }
        f_from_d(a: D) -> F {
            [_mm256_set_m128(_mm256_cvtpd_ps(a[1]), _mm256_cvtpd_ps(a[0])), _mm256_set_m128(_mm256_cvtpd_ps(a[3]), _mm256_cvtpd_ps(a[2]))]
        }
        coverage_16(a: [i16; 3], b: [i16; 3], c: [i16; 3]) -> u64 {
            let column = _mm256_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
            let row = _mm256_setr_epi16(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1);
            let mut out = [_mm256_setzero_si256(); 4];
            for q in 0..3 {
                let across = _mm256_adds_epi16(_mm256_set1_epi16(c[q]), _mm256_mullo_epi16(_mm256_set1_epi16(a[q]), column));
                let mut down = _mm256_mullo_epi16(_mm256_set1_epi16(b[q]), row);
                let two = _mm256_set1_epi16(b[q].wrapping_mul(2));
                for o in &mut out {
                    *o = _mm256_or_si256(*o, _mm256_adds_epi16(across, down));
                    down = _mm256_add_epi16(down, two);
                }
            }
            // Saturated packing keeps the signs; the permutation undoes its interleaving of halves.
            let sixteen = |p, q| _mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_packs_epi16(p, q));
            let upper = _mm256_movemask_epi8(sixteen(out[0], out[1])) as u32;
            let lower = _mm256_movemask_epi8(sixteen(out[2], out[3])) as u32;
            !(u64::from(upper) | u64::from(lower) << 32)
        }
    }

    #[inline(always)]
    fn shl_i<const N: u32>(self, a: I) -> I {
        let n = N as i32;
        // SAFETY: the token exists only where `Avx2::new` saw AVX2.
        unsafe { [_mm256_sll_epi32(a[0], _mm_cvtsi32_si128(n)), _mm256_sll_epi32(a[1], _mm_cvtsi32_si128(n))] }
    }
    #[inline(always)]
    fn shr_i<const N: u32>(self, a: I) -> I {
        let n = N as i32;
        // SAFETY: the token exists only where `Avx2::new` saw AVX2.
        unsafe { [_mm256_sra_epi32(a[0], _mm_cvtsi32_si128(n)), _mm256_sra_epi32(a[1], _mm_cvtsi32_si128(n))] }
    }
    #[inline(always)]
    fn compress_i(self, k: Mask, a: I, to: &mut [i32; 16]) {
        let mut lanes = [0; 16];
        self.store_i(a, &mut lanes);
        compress(k, &lanes, to);
    }
    #[inline(always)]
    fn compress_f(self, k: Mask, a: F, to: &mut [f32; 16]) {
        let mut lanes = [0.0; 16];
        self.store_f(a, &mut lanes);
        compress(k, &lanes, to);
    }
    #[inline(always)]
    fn gather_f(self, k: Mask, table: &[f32], index: I, or: F) -> F {
        let length = i32::try_from(table.len()).unwrap_or(i32::MAX);
        let inside = self.gt_i(self.splat_i(length), index) & !self.sign_i(index);
        assert!(inside & k == k, "gather: an index is out of range");
        // SAFETY: the token exists only where `Avx2::new` saw AVX2; lanes under the mask index inside the table, and the
        // others are not read.
        unsafe {
            let k = spread(k);
            let lane =
                |i: usize| _mm256_mask_i32gather_ps::<4>(or[i], table.as_ptr(), index[i], _mm256_castsi256_ps(k[i]));
            [lane(0), lane(1)]
        }
    }
    #[inline(always)]
    fn gather_i(self, k: Mask, table: &[i32], index: I, or: I) -> I {
        let length = i32::try_from(table.len()).unwrap_or(i32::MAX);
        let inside = self.gt_i(self.splat_i(length), index) & !self.sign_i(index);
        assert!(inside & k == k, "gather: an index is out of range");
        // SAFETY: the token exists only where `Avx2::new` saw AVX2; lanes under the mask index inside the table, and the
        // others are not read.
        unsafe {
            let k = spread(k);
            let lane = |i: usize| _mm256_mask_i32gather_epi32::<4>(or[i], table.as_ptr(), index[i], k[i]);
            [lane(0), lane(1)]
        }
    }
}
