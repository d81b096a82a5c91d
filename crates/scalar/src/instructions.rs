//! [`InstructionSet`]: SIMD instructions chosen when the program runs, without build flags.
//!
//! A kernel is compiled once for each set, because its `run` is inlined into a function that may use the
//! set's instructions. Which of them is called is decided by what the processor has. Every set computes the same bits:
//! lanes are independent, sums keep their order, and Rust never contracts a product and a sum into one rounding.

use std::sync::OnceLock;

/// A computation to be compiled for every instruction set. Mark `run`, and all it calls, `#[inline(always)]`: a function that
/// is not inlined keeps the instructions of the plain build.
pub trait Kernel {
    /// What it returns.
    type Output;
    /// The computation.
    fn run(self) -> Self::Output;
}

/// The widest vector instructions that are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum InstructionSet {
    /// What every processor of the target has (on x86-64: two doubles at a time).
    Portable,
    /// Four doubles at a time.
    Avx2,
    /// Eight doubles at a time.
    Avx512,
}

impl InstructionSet {
    /// All sets, narrowest first.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The widest set of this processor, at most that named by the environment variable `EQUIP_SIMD` (`none`, `avx2` or
    /// `avx512`; any other text is as if it were not set). Determined once in a program.
    pub fn best() -> Self {
        static BEST: OnceLock<InstructionSet> = OnceLock::new();
        *BEST.get_or_init(|| {
            let limit = match std::env::var("EQUIP_SIMD").as_deref() {
                Ok("none") => Self::Portable,
                Ok("avx2") => Self::Avx2,
                _ => Self::Avx512,
            };
            let usable = |set: &Self| *set <= limit && set.is_available();
            Self::ALL
                .into_iter()
                .rev()
                .find(usable)
                .unwrap_or(Self::Portable)
        })
    }

    /// Whether this processor has the instructions.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512dq")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }
}
