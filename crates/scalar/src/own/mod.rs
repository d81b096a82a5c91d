//! [`Own`]: a user-defined floating-point type. The user implements only its arithmetic.
//!
//! An implementation of [`Arithmetic`] turns a type with + − × ÷ and negation into a [`Float`](crate::Float).
//! It takes ten lines: the limits of the type and conversions from and to `f64`. Everything else has a
//! default:
//!
//! ```
//! use equip_scalar::{Arithmetic, Float, Own};
//!
//! struct Single;
//!
//! impl Arithmetic for Single {
//!     type Number = f32;
//!     const NAME: &'static str = "f32";
//!     const MANTISSA_BITS: u32 = 24;
//!     const EPSILON: f32 = f32::EPSILON;
//!     const MAX: f32 = f32::MAX;
//!     const MIN_POSITIVE: f32 = f32::MIN_POSITIVE;
//!     const INFINITY: f32 = f32::INFINITY;
//!     const NAN: f32 = f32::NAN;
//!     fn from_f64(x: f64) -> f32 {
//!         x as f32
//!     }
//!     fn to_f64(x: f32) -> f64 {
//!         x.into()
//!     }
//! }
//!
//! let x = Own::<Single>::decimal("0.1")?;
//! assert_eq!(x.exp().0, 0.1_f32.exp());
//! # Ok::<(), equip_scalar::ParseFloatError>(())
//! ```
//!
//! The defaults have errors of a few ε, for any ε down to 2⁻³¹⁸. After argument reduction, doubles give the
//! first digits, and a series or one step of high order the others. Each default takes some tens of products
//! and quotients; a type with its own functions can replace them. Decimals are read and written exactly, in
//! the range of doubles. Tables and closures in H have 31 digits.

mod constants;
mod float;
mod functions;
mod number;

use functions::{arcs, error_function, exponential, roots, trigonometric};

/// Functions of a number with their defaults.
macro_rules! functions {
    ($($(#[$doc:meta])* $f:ident($($x:ident),*) = $default:path;)*) => {$(
        $(#[$doc])*
        fn $f($($x: Self::Number),*) -> Self::Number {
            $default($(Own::<Self>($x)),*).0
        }
    )*};
}

/// The part of a floating-point type that the user implements: numbers with arithmetic, and their limits.
///
/// Sums and products of `Number` have a relative error of about [`EPSILON`](Self::EPSILON) or less. So have
/// quotients, unless [`over`](Self::over) replaces them.
pub trait Arithmetic: Sized + 'static {
    /// The number itself.
    type Number: Copy
        + Send
        + Sync
        + std::fmt::Debug
        + PartialOrd
        + std::ops::Add<Output = Self::Number>
        + std::ops::Sub<Output = Self::Number>
        + std::ops::Mul<Output = Self::Number>
        + std::ops::Div<Output = Self::Number>
        + std::ops::Neg<Output = Self::Number>
        + 'static;

    /// Name for people and files.
    const NAME: &'static str;
    /// Bits of the significand, at most 318.
    const MANTISSA_BITS: u32;
    /// The unit in which relative errors of arithmetic are counted.
    const EPSILON: Self::Number;
    /// Largest finite number.
    const MAX: Self::Number;
    /// Smallest positive number at which full relative precision is still reached.
    const MIN_POSITIVE: Self::Number;
    /// Positive infinity.
    const INFINITY: Self::Number;
    /// Not a number.
    const NAN: Self::Number;

    /// The value of the given double, exactly as far as the significand reaches.
    fn from_f64(x: f64) -> Self::Number;
    /// The nearest double, or one next to it.
    fn to_f64(x: Self::Number) -> f64;

    /// x/y.
    #[inline(always)]
    fn over(x: Self::Number, y: Self::Number) -> Self::Number {
        x / y
    }
    /// xⁿ.
    fn powi(x: Self::Number, n: i32) -> Self::Number {
        roots::powi(Own::<Self>(x), n).0
    }

    functions! {
        /// √x.
        sqrt(x) = roots::sqrt;
        /// ∛x.
        cbrt(x) = roots::cbrt;
        /// √(x² + y²).
        hypot(x, y) = roots::hypot;
        /// eˣ.
        exp(x) = exponential::exp;
        /// 2ˣ.
        exp2(x) = exponential::exp2;
        /// eˣ − 1.
        exp_m1(x) = exponential::exp_m1;
        /// ln x.
        ln(x) = exponential::ln;
        /// ln(1 + x).
        ln_1p(x) = exponential::ln_1p;
        /// xʸ.
        powf(x, y) = exponential::powf;
        /// sin x.
        sin(x) = trigonometric::sin;
        /// cos x.
        cos(x) = trigonometric::cos;
        /// tan x.
        tan(x) = trigonometric::tan;
        /// arcsin x.
        asin(x) = arcs::asin;
        /// arccos x.
        acos(x) = arcs::acos;
        /// arctan x.
        atan(x) = arcs::atan;
        /// Angle of the point (x, y), y being the first argument.
        atan2(y, x) = arcs::atan2;
        /// sinh x.
        sinh(x) = exponential::sinh;
        /// cosh x.
        cosh(x) = exponential::cosh;
        /// tanh x.
        tanh(x) = exponential::tanh;
        /// arsinh x.
        asinh(x) = exponential::asinh;
        /// arcosh x.
        acosh(x) = exponential::acosh;
        /// artanh x.
        atanh(x) = exponential::atanh;
        /// Error function.
        erf(x) = error_function::erf;
        /// 1 − erf x.
        erfc(x) = error_function::erfc;
    }
}

/// The float with the arithmetic `A`.
#[repr(transparent)]
pub struct Own<A: Arithmetic>(pub A::Number);
