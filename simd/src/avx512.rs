//! The AVX-512 level: sixteen lanes are one register.

use std::arch::x86_64::*;

use crate::{Kernel, Level, Mask, Simd};

/// The token of the AVX-512 level: whoever holds one runs on a CPU that has all its features.
#[derive(Debug, Clone, Copy)]
pub struct Avx512(());

impl Avx512 {
    /// `Some` when the CPU has every feature of the level.
    #[inline]
    pub fn new() -> Option<Avx512> {
        let has = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has.then_some(Avx512(()))
    }
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn enter<K: Kernel>(token: Avx512, kernel: K) -> K::Output {
    kernel.run(token)
}

macro_rules! methods {
    ($($name:ident($($arg:ident: $ty:ty),*) $(-> $ret:ty)? { $($body:tt)* })*) => { $(
        #[inline(always)]
        fn $name(self, $($arg: $ty),*) $(-> $ret)? {
            // SAFETY: the token exists only where `Avx512::new` saw every feature that these intrinsics need; loads and
            // stores go through references to arrays of exactly the size that is moved.
            unsafe { $($body)* }
        }
    )* };
}

type F = __m512;
type I = __m512i;
type D = [__m512d; 2];

impl Simd for Avx512 {
    const LEVEL: Level = Level::Avx512;
    type F = F;
    type I = I;
    type D = D;

    #[inline]
    fn vectorize<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: the token exists only where `Avx512::new` saw every feature that `enter` enables.
        unsafe { enter(self, kernel) }
    }

    methods! {
        splat_f(v: f32) -> F { _mm512_set1_ps(v) }
        load_f(v: &[f32; 16]) -> F { _mm512_loadu_ps(v.as_ptr()) }
        store_f(v: F, to: &mut [f32; 16]) { _mm512_storeu_ps(to.as_mut_ptr(), v) }
        add_f(a: F, b: F) -> F { _mm512_add_ps(a, b) }
        sub_f(a: F, b: F) -> F { _mm512_sub_ps(a, b) }
        mul_f(a: F, b: F) -> F { _mm512_mul_ps(a, b) }
        div_f(a: F, b: F) -> F { _mm512_div_ps(a, b) }
        min_f(a: F, b: F) -> F { _mm512_min_ps(a, b) }
        max_f(a: F, b: F) -> F { _mm512_max_ps(a, b) }
        abs_f(a: F) -> F { _mm512_abs_ps(a) }
        gt_f(a: F, b: F) -> Mask { _mm512_cmp_ps_mask::<_CMP_GT_OQ>(a, b) }
        ge_f(a: F, b: F) -> Mask { _mm512_cmp_ps_mask::<_CMP_GE_OQ>(a, b) }
        eq_f(a: F, b: F) -> Mask { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, b) }
        blend_f(k: Mask, a: F, b: F) -> F { _mm512_mask_blend_ps(k, a, b) }
        reduce_min_f(a: F) -> f32 { _mm512_reduce_min_ps(a) }
        reduce_max_f(a: F) -> f32 { _mm512_reduce_max_ps(a) }
        round_i(a: F) -> I { _mm512_cvt_roundps_epi32::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a) }
        floor_i(a: F) -> I { _mm512_cvt_roundps_epi32::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a) }
        f_from_i(a: I) -> F { _mm512_cvtepi32_ps(a) }
        f_from_bits(a: I) -> F { _mm512_castsi512_ps(a) }
        bits_of_f(a: F) -> I { _mm512_castps_si512(a) }

        splat_i(v: i32) -> I { _mm512_set1_epi32(v) }
        load_i(v: &[i32; 16]) -> I { _mm512_loadu_si512(v.as_ptr().cast()) }
        load_u8(v: &[u8; 16]) -> I { _mm512_cvtepu8_epi32(_mm_loadu_si128(v.as_ptr().cast())) }
        store_i(v: I, to: &mut [i32; 16]) { _mm512_storeu_si512(to.as_mut_ptr().cast(), v) }
        add_i(a: I, b: I) -> I { _mm512_add_epi32(a, b) }
        sub_i(a: I, b: I) -> I { _mm512_sub_epi32(a, b) }
        mul_i(a: I, b: I) -> I { _mm512_mullo_epi32(a, b) }
        min_i(a: I, b: I) -> I { _mm512_min_epi32(a, b) }
        max_i(a: I, b: I) -> I { _mm512_max_epi32(a, b) }
        and_i(a: I, b: I) -> I { _mm512_and_si512(a, b) }
        or_i(a: I, b: I) -> I { _mm512_or_si512(a, b) }
        gt_i(a: I, b: I) -> Mask { _mm512_cmpgt_epi32_mask(a, b) }
        eq_i(a: I, b: I) -> Mask { _mm512_cmpeq_epi32_mask(a, b) }
        sign_i(a: I) -> Mask { _mm512_movepi32_mask(a) }
        blend_i(k: Mask, a: I, b: I) -> I { _mm512_mask_blend_epi32(k, a, b) }
        reduce_min_i(a: I) -> i32 { _mm512_reduce_min_epi32(a) }
        reduce_max_i(a: I) -> i32 { _mm512_reduce_max_epi32(a) }
        compress_i(k: Mask, a: I, to: &mut [i32; 16]) { _mm512_storeu_si512(to.as_mut_ptr().cast(), _mm512_maskz_compress_epi32(k, a)) }
        compress_f(k: Mask, a: F, to: &mut [f32; 16]) { _mm512_storeu_ps(to.as_mut_ptr(), _mm512_maskz_compress_ps(k, a)) }
        lookup_i(table: &[i32; 32], index: I) -> I {
            _mm512_permutex2var_epi32(_mm512_loadu_si512(table.as_ptr().cast()), index, _mm512_loadu_si512(table.as_ptr().add(16).cast()))
        }
        lookup_f(table: &[f32; 32], index: I) -> F {
            _mm512_permutex2var_ps(_mm512_loadu_ps(table.as_ptr()), index, _mm512_loadu_ps(table.as_ptr().add(16)))
        }

        splat_d(v: f64) -> D { [_mm512_set1_pd(v); 2] }
        store_d(v: D, to: &mut [f64; 16]) { _mm512_storeu_pd(to.as_mut_ptr(), v[0]); _mm512_storeu_pd(to.as_mut_ptr().add(8), v[1]); }
        add_d(a: D, b: D) -> D { [_mm512_add_pd(a[0], b[0]), _mm512_add_pd(a[1], b[1])] }
        sub_d(a: D, b: D) -> D { [_mm512_sub_pd(a[0], b[0]), _mm512_sub_pd(a[1], b[1])] }
        mul_d(a: D, b: D) -> D { [_mm512_mul_pd(a[0], b[0]), _mm512_mul_pd(a[1], b[1])] }
        div_d(a: D, b: D) -> D { [_mm512_div_pd(a[0], b[0]), _mm512_div_pd(a[1], b[1])] }
        min_d(a: D, b: D) -> D { [_mm512_min_pd(a[0], b[0]), _mm512_min_pd(a[1], b[1])] }
        max_d(a: D, b: D) -> D { [_mm512_max_pd(a[0], b[0]), _mm512_max_pd(a[1], b[1])] }
        floor_d(a: D) -> D {
            const DOWN: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
            [_mm512_roundscale_pd::<DOWN>(a[0]), _mm512_roundscale_pd::<DOWN>(a[1])]
        }
        gt_d(a: D, b: D) -> Mask {
            u16::from(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(a[0], b[0])) | u16::from(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(a[1], b[1])) << 8
        }
        eq_d(a: D, b: D) -> Mask {
            u16::from(_mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a[0], b[0])) | u16::from(_mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a[1], b[1])) << 8
        }
        blend_d(k: Mask, a: D, b: D) -> D {
            [_mm512_mask_blend_pd(k as u8, a[0], b[0]), _mm512_mask_blend_pd((k >> 8) as u8, a[1], b[1])]
        }
        d_from_f(a: F) -> D {
            [_mm512_cvtps_pd(_mm512_castps512_ps256(a)), _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(a))]
        }
        d_from_i(a: I) -> D {
            [_mm512_cvtepi32_pd(_mm512_castsi512_si256(a)), _mm512_cvtepi32_pd(_mm512_extracti64x4_epi64::<1>(a))]
        }
        i_from_d(a: D) -> I {
            _mm512_inserti64x4::<1>(_mm512_castsi256_si512(_mm512_cvtpd_epi32(a[0])), _mm512_cvtpd_epi32(a[1]))
        }
        f_from_d(a: D) -> F {
            _mm512_insertf32x8::<1>(_mm512_castps256_ps512(_mm512_cvtpd_ps(a[0])), _mm512_cvtpd_ps(a[1]))
        }
        coverage_16(a: [i16; 3], b: [i16; 3], c: [i16; 3]) -> u64 {
            let column = _mm512_set1_epi64(0);
            let column = _mm512_or_si512(column, _mm512_broadcast_i32x4(_mm_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7)));
            let row = _mm512_setr_epi64(0, 0, 0x0001_0001_0001_0001, 0x0001_0001_0001_0001,
                0x0002_0002_0002_0002, 0x0002_0002_0002_0002, 0x0003_0003_0003_0003, 0x0003_0003_0003_0003);
            let mut upper = _mm512_setzero_si512();
            let mut lower = upper;
            for q in 0..3 {
                let across = _mm512_adds_epi16(_mm512_set1_epi16(c[q]), _mm512_mullo_epi16(_mm512_set1_epi16(a[q]), column));
                let down = _mm512_mullo_epi16(_mm512_set1_epi16(b[q]), row);
                let four = _mm512_set1_epi16(b[q].wrapping_mul(4));
                upper = _mm512_or_si512(upper, _mm512_adds_epi16(across, down));
                lower = _mm512_or_si512(lower, _mm512_adds_epi16(across, _mm512_add_epi16(down, four)));
            }
            !(u64::from(_mm512_movepi16_mask(upper)) | u64::from(_mm512_movepi16_mask(lower)) << 32)
        }
    }

    #[inline(always)]
    fn shl_i<const N: u32>(self, a: I) -> I {
        // SAFETY: the token exists only where `Avx512::new` saw AVX-512 F.
        unsafe { _mm512_slli_epi32::<N>(a) }
    }
    #[inline(always)]
    fn shr_i<const N: u32>(self, a: I) -> I {
        // SAFETY: the token exists only where `Avx512::new` saw AVX-512 F.
        unsafe { _mm512_srai_epi32::<N>(a) }
    }
    #[inline(always)]
    fn gather_f(self, k: Mask, table: &[f32], index: I, or: F) -> F {
        let length = i32::try_from(table.len()).unwrap_or(i32::MAX);
        // SAFETY: the token exists only where `Avx512::new` saw AVX-512 F; no lane under the mask that passed the
        // unsigned comparison lies outside the table, and the others are not read.
        unsafe {
            let inside = _mm512_mask_cmplt_epu32_mask(k, index, _mm512_set1_epi32(length));
            assert!(inside == k, "gather: an index is out of range");
            _mm512_mask_i32gather_ps::<4>(or, k, index, table.as_ptr())
        }
    }
    #[inline(always)]
    fn gather_i(self, k: Mask, table: &[i32], index: I, or: I) -> I {
        let length = i32::try_from(table.len()).unwrap_or(i32::MAX);
        // SAFETY: the token exists only where `Avx512::new` saw AVX-512 F; no lane under the mask that passed the
        // unsigned comparison lies outside the table, and the others are not read.
        unsafe {
            let inside = _mm512_mask_cmplt_epu32_mask(k, index, _mm512_set1_epi32(length));
            assert!(inside == k, "gather: an index is out of range");
            _mm512_mask_i32gather_epi32::<4>(or, k, index, table.as_ptr())
        }
    }
}
