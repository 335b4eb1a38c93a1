//! The levels, and the choice among them at run time.

use crate::{Scalar, Simd};

/// A SIMD level. A 128-bit level will stand between `Scalar` and `Avx2`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Level {
    /// No explicit SIMD: every target.
    Scalar,
    /// AVX2 with BMI1, BMI2, LZCNT and POPCNT.
    Avx2,
    /// AVX-512 F, BW, DQ and VL, and all that [`Level::Avx2`] asks for.
    Avx512,
}

/// A computation that runs at any level. Mark `run`, and all generic functions below it, `#[inline(always)]`: only what
/// is inlined into the level's entry function is compiled with the level's instructions.
pub trait Kernel {
    /// What it gives.
    type Output;
    /// The computation.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

impl Level {
    /// All levels that this crate has, whether the CPU does or not, lowest first.
    pub const ALL: [Level; 3] = [Level::Scalar, Level::Avx2, Level::Avx512];

    /// The highest level of this CPU.
    pub fn best() -> Level {
        Level::ALL.into_iter().rev().find(|l| l.is_available()).unwrap_or(Level::Scalar)
    }

    /// True when the CPU (and the operating system) has every feature of the level.
    pub fn is_available(self) -> bool {
        match self {
            Level::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => crate::Avx2::new().is_some(),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => crate::Avx512::new().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Level::Scalar => "scalar",
            Level::Avx2 => "avx2",
            Level::Avx512 => "avx512",
        }
    }

    /// The level of a name; `None` for an unknown one.
    pub fn from_name(name: &str) -> Option<Level> {
        Level::ALL.into_iter().find(|l| l.name() == name)
    }

    /// Runs a kernel at this level.
    ///
    /// # Panics
    /// When the CPU lacks the level: ask [`Level::is_available`] first.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Level::Scalar => Scalar.vectorize(kernel),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => crate::Avx2::new().expect("this CPU has no AVX2").vectorize(kernel),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => crate::Avx512::new().expect("this CPU has no AVX-512").vectorize(kernel),
            #[cfg(not(target_arch = "x86_64"))]
            _ => panic!("this CPU has no x86 levels"),
        }
    }
}
