//! AVX-512, mostly on 256-bit registers, with masks as integers.
#![expect(unsafe_code, reason = "intrinsics, proved by `Avx512::detect`")]

use std::arch::x86_64::*;

use super::avx2::Avx2;
use super::lanes::SimdKernel;
use super::real::BitMask;
use super::registers::Registers;
use super::wide::Sixteen;
use super::zmm::{WideRegisters, Zmm};

/// Proof that the CPU has AVX2, AVX-512F and AVX-512VL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx512(());

impl Avx512 {
    /// Returns the proof if the CPU has the instructions.
    pub fn detect() -> Option<Self> {
        let is_available =
            is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
        Avx2::detect().filter(|_| is_available).map(|_| Self(()))
    }

    /// Runs the kernel with these instructions.
    #[inline]
    pub fn run<K: SimdKernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,avx512f,avx512vl")]
        fn with_avx512<K: SimdKernel>(set: Avx512, kernel: K) -> K::Output {
            kernel.run(set)
        }
        // SAFETY: `self` proves the features of `Avx2`, AVX-512F and AVX-512VL.
        unsafe { with_avx512(self, kernel) }
    }
}

impl WideRegisters for Avx512 {}

impl Registers for Avx512 {
    type Mask = BitMask<u8>;
    type Wide = Zmm<Self>;

    #[inline(always)]
    fn wide_of(self, value: f32) -> Zmm<Self> {
        Zmm::splat(self, value)
    }

    #[inline(always)]
    fn wide_from(self, numbers: &Sixteen, _: usize) -> Zmm<Self> {
        Zmm::load(self, numbers)
    }

    #[inline(always)]
    fn wide_mask_of(self, bits: u16) -> BitMask<u16> {
        BitMask(bits)
    }

    #[inline(always)]
    fn mask_of(self, bits: u8) -> BitMask<u8> {
        BitMask(bits)
    }

    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> BitMask<u8> {
        // SAFETY: `self` proves AVX-512.
        BitMask(unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b) })
    }

    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> BitMask<u8> {
        // SAFETY: `self` proves AVX-512.
        BitMask(unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b) })
    }

    #[inline(always)]
    fn select(self, mask: BitMask<u8>, this: __m256, other: __m256) -> __m256 {
        // SAFETY: `self` proves AVX-512.
        unsafe { _mm256_mask_blend_ps(mask.0, other, this) }
    }

    #[inline(always)]
    fn compress(self, mask: BitMask<u8>, lanes: __m256) -> __m256 {
        // SAFETY: `self` proves AVX-512.
        unsafe { _mm256_maskz_compress_ps(mask.0, lanes) }
    }
}
