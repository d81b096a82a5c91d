//! [`InstructionSet`]: SIMD instructions selected at run time, without build flags.
//!
//! A [`Kernel`] is compiled once for each instruction set, because its `run` is inlined into a function that
//! may use that set. The processor determines which one is called. Every set computes the same bits: lanes
//! are independent, sums keep their order, and Rust never contracts a product and a sum. Fused products are
//! explicit calls of [`f64::mul_add`]: an instruction for AVX2 and AVX-512, a function call in plain builds
//! of x86-64.
//!
//! The environment variable `EQUIP_SIMD` (`none`, `avx2` or `avx512`), read once in a program, limits the
//! choice.

use std::sync::OnceLock;

/// A computation that is compiled for every instruction set. Mark `run`, and all functions that it calls,
/// `#[inline(always)]`: a function that is not inlined uses the instructions of the plain build.
///
/// The kernel is passed by reference. A moved struct of slices would be copied in pieces larger than those
/// just written, and the processor would wait for all earlier results (100 cycles per stage iteration).
pub trait Kernel {
    /// What it returns.
    type Output;
    /// The computation.
    fn run(&mut self) -> Self::Output;

    /// The same for sets with 16 registers of at most four doubles, where AVX-512 has 32 of eight: for
    /// kernels that keep more in registers than fits there.
    #[inline(always)]
    fn run_narrow(&mut self) -> Self::Output {
        self.run()
    }
}

/// The widest vector instructions that are used. A value of this type is proof that the processor has them.
///
/// ```
/// use equip_scalar::{InstructionSet, Kernel};
/// struct Sum<'a>(&'a [f64]);
/// impl Kernel for Sum<'_> {
///     type Output = f64;
///     #[inline(always)]
///     fn run(&mut self) -> f64 {
///         self.0.iter().sum()
///     }
/// }
/// for set in InstructionSet::available() {
///     assert_eq!(set.run(&mut Sum(&[0.1, 0.2])), 0.1 + 0.2);
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct InstructionSet(Level);

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl InstructionSet {
    /// The instructions of every processor of the target; on x86-64 two doubles at a time.
    pub const PORTABLE: Self = InstructionSet(Level::Portable);

    /// AVX2 with fused multiply-add, which nearly all processors with AVX2 have: four doubles at a time.
    pub fn avx2() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            return Some(InstructionSet(Level::Avx2));
        }
        None
    }

    /// AVX-512 F, VL and DQ: eight doubles at a time.
    pub fn avx512() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512dq")
        {
            return Some(InstructionSet(Level::Avx512));
        }
        None
    }

    /// The instruction sets of this processor, narrowest first.
    pub fn available() -> impl Iterator<Item = Self> {
        [Some(Self::PORTABLE), Self::avx2(), Self::avx512()]
            .into_iter()
            .flatten()
    }

    /// The widest instruction set of this processor, limited by `EQUIP_SIMD`. Any other value of this
    /// variable has no effect.
    pub fn best() -> Self {
        static BEST: OnceLock<InstructionSet> = OnceLock::new();
        *BEST.get_or_init(|| {
            let avx2 = || Self::avx2().unwrap_or(Self::PORTABLE);
            match std::env::var("EQUIP_SIMD").as_deref() {
                Ok("none") => Self::PORTABLE,
                Ok("avx2") => avx2(),
                _ => Self::avx512().unwrap_or_else(avx2),
            }
        })
    }

    /// Runs the kernel if these instructions are wider than those of the plain build. For generic kernels
    /// whose compilation pays only with wide vectors.
    #[inline(always)]
    #[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables))]
    pub fn run_wide<K: Kernel>(self, kernel: &mut K) -> Option<K::Output> {
        match self.0 {
            Level::Portable => None,
            #[cfg(target_arch = "x86_64")]
            level => Some(x86_64::run_wide(level, kernel)),
        }
    }

    /// Runs the kernel with these instructions.
    #[inline(always)]
    pub fn run<K: Kernel>(self, kernel: &mut K) -> K::Output {
        match self.run_wide(kernel) {
            Some(output) => output,
            None => kernel.run_narrow(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    //! The one place where functions compiled for further instructions are called.
    #![allow(unsafe_code)]

    use super::{Kernel, Level};

    #[target_feature(enable = "avx2,fma")]
    fn avx2<K: Kernel>(kernel: &mut K) -> K::Output {
        kernel.run_narrow()
    }

    #[target_feature(enable = "avx512f,avx512vl,avx512dq,fma")]
    fn avx512<K: Kernel>(kernel: &mut K) -> K::Output {
        kernel.run()
    }

    /// The level is not that of the plain build.
    #[inline(always)]
    pub(super) fn run_wide<K: Kernel>(level: Level, kernel: &mut K) -> K::Output {
        match level {
            Level::Portable => unreachable!("the plain build has no wide vectors"),
            // SAFETY: the level is private and made in `InstructionSet::avx2` only, after the processor was
            // asked.
            Level::Avx2 => unsafe { avx2(kernel) },
            // SAFETY: the same, in `InstructionSet::avx512`.
            Level::Avx512 => unsafe { avx512(kernel) },
        }
    }
}
