//! [`hamiltonian!`](crate::hamiltonian): the static route in the words of the closure route.

// The names that its text is written with.
#[doc(hidden)]
pub use equip_scalar::{Constant, Num, Scalar};

/// A Hamiltonian with compiled derivatives from closure-like text: `hamiltonian!(m, |q, p| H)`, or with
/// parameters `hamiltonian!(m; parameters; |q, p| H)`.
///
/// It writes a type with one generic method (see [`Energy`](crate::Energy)), which, other than a closure,
/// sees nothing of its surroundings but its parameters. Each parameter is one of
///
/// - `mu` or `mu = value`: an `f64`, [`Constant`](equip_scalar::Constant) or `DoubleDouble`; inside H it is
///   a number like `q[0]`, as exact as the float type H is computed in;
/// - `count: usize = value`: anything `Copy + 'static`, seen inside H as it is. Arrays of masses and loop
///   bounds go here.
///
/// The result is `Result<Hamiltonian<Static<_>>, BuildError>`.
///
/// ```
/// use equip_autodiff::{Evaluate, System, hamiltonian};
/// use equip_scalar::ratio;
///
/// // No parameters.
/// let henon_heiles = hamiltonian!(2, |q, p| {
///     let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]);
///     let quadratic = 0.5 * (q[0] * q[0] + q[1] * q[1]);
///     kinetic + quadratic + q[0] * q[0] * q[1] - ratio(1, 3) * q[1].powi(3)
/// })?;
/// assert_eq!(henon_heiles.structure().degree, Some(3));
///
/// // Numbers.
/// let mu = 1.0;
/// let kepler = hamiltonian!(2; mu, half = ratio(1, 2); |q, p| {
///     half * (p[0] * p[0] + p[1] * p[1]) - mu / q[0].hypot(q[1])
/// })?;
/// assert_eq!(kepler.evaluator::<f64>().value(&[3.0, 4.0, 0.0, 0.0]), -0.2);
///
/// // Anything else.
/// let chain = hamiltonian!(3; stiffness: [f64; 2] = [1.0, 4.0], beta = 0.25; |q, p| {
///     let mut h = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / 2.0;
///     for i in 0..2 {
///         let stretch = q[i + 1] - q[i];
///         h += stiffness[i] * stretch.powi(2) / 2.0 + beta * stretch.powi(4);
///     }
///     h
/// })?;
/// assert_eq!(chain.structure().hessian.len(), 3 + 7);
/// # Ok::<(), equip_autodiff::BuildError>(())
/// ```
#[macro_export]
macro_rules! hamiltonian {
    ($m:expr, |$q:ident, $p:ident| $h:expr) => {
        $crate::hamiltonian!(@write [$m] [] [$q $p $h])
    };
    ($m:expr; |$q:ident, $p:ident| $h:expr) => {
        $crate::hamiltonian!(@write [$m] [] [$q $p $h])
    };
    ($m:expr; $($rest:tt)+) => {
        $crate::hamiltonian!(@parse [$m] [] $($rest)+)
    };

    // One parameter after the other, up to the closure.
    (@parse [$m:expr] [$($done:tt)*] ; |$q:ident, $p:ident| $h:expr) => {
        $crate::hamiltonian!(@write [$m] [$($done)*] [$q $p $h])
    };
    (@parse [$m:expr] [$($done:tt)*] , ; $($rest:tt)+) => {
        $crate::hamiltonian!(@parse [$m] [$($done)*] ; $($rest)+)
    };
    (@parse [$m:expr] [$($done:tt)*] , $($rest:tt)+) => {
        $crate::hamiltonian!(@parse [$m] [$($done)*] $($rest)+)
    };
    (@parse [$m:expr] [$($done:tt)*] $name:ident : $kind:ty = $value:expr, $($rest:tt)+) => {
        $crate::hamiltonian!(@parse [$m] [$($done)* {$name [$kind] [$value] [as_is]}] $($rest)+)
    };
    (@parse [$m:expr] [$($done:tt)*] $name:ident : $kind:ty = $value:expr; $($rest:tt)+) => {
        $crate::hamiltonian!(@parse [$m] [$($done)* {$name [$kind] [$value] [as_is]}] ; $($rest)+)
    };
    (@parse [$m:expr] [$($done:tt)*] $name:ident = $value:expr, $($rest:tt)+) => {
        $crate::hamiltonian!(@parse [$m] [$($done)*
            {$name [$crate::macros::Constant] [$crate::macros::Constant::from($value)] [number]}
        ] $($rest)+)
    };
    (@parse [$m:expr] [$($done:tt)*] $name:ident = $value:expr; $($rest:tt)+) => {
        $crate::hamiltonian!(@parse [$m] [$($done)*
            {$name [$crate::macros::Constant] [$crate::macros::Constant::from($value)] [number]}
        ] ; $($rest)+)
    };
    (@parse [$m:expr] [$($done:tt)*] $name:ident $($rest:tt)+) => {
        $crate::hamiltonian!(@parse [$m] [$($done)*
            {$name [$crate::macros::Constant] [$crate::macros::Constant::from($name)] [number]}
        ] $($rest)+)
    };

    (@write [$m:expr]
        [$({$name:ident [$kind:ty] [$value:expr] [$how:ident]})*]
        [$q:ident $p:ident $h:expr]
    ) => {{
        #[derive(Clone, Copy)]
        struct Written {
            degrees_of_freedom: usize,
            parameters: ($($kind,)*),
        }

        impl $crate::Energy for Written {
            fn degrees_of_freedom(&self) -> usize {
                self.degrees_of_freedom
            }

            #[inline(always)]
            fn energy<S: $crate::macros::Scalar>(
                &self,
                $q: &[$crate::macros::Num<S>],
                $p: &[$crate::macros::Num<S>],
            ) -> $crate::macros::Num<S> {
                let ($($name,)*) = self.parameters;
                $(let $name = $crate::hamiltonian!(@parameter $how S $name);)*
                $h
            }
        }

        $crate::Hamiltonian::from_energy(Written {
            degrees_of_freedom: $m,
            parameters: ($($value,)*),
        })
    }};

    (@parameter as_is $s:ident $name:ident) => { $name };
    (@parameter number $s:ident $name:ident) => { $crate::macros::Num::<$s>::from($name) };
}
