//! [`Entry`]: how a scene describes itself, and [`scene!`], which writes it and the type of its Hamiltonian
//! from one table of parameters.

use crate::parameter::{Parameter, Value};

/// A scene with the type of its Hamiltonian; the catalogue makes a [`Scene`](crate::Scene) of it, which says
/// what the fields are.
pub(crate) struct Entry<M> {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) formula: &'static str,
    pub(crate) source: &'static str,
    pub(crate) parameters: &'static [Parameter],
    pub(crate) invariants: &'static str,
    pub(crate) solution: &'static str,
    pub(crate) hard: &'static str,
    pub(crate) units: &'static str,
    pub(crate) period: &'static str,
    /// The Hamiltonian for values of the parameters, in their order.
    pub(crate) build: fn(&[Value]) -> M,
}

/// A Hamiltonian as a type whose fields are the parameters of its scene, and the scene's entry `SCENE`. A row
/// for each parameter: name, type, default, range (by a function of `Range`), meaning.
macro_rules! scene {
    (
        $(#[$about:meta])*
        pub struct $model:ident {
            $($name:ident: $type:ty = $default:literal in $range:ident($($end:expr),*), $meaning:literal;)*
        }
        $($text:ident: $words:expr,)*
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy)]
        pub struct $model {
            $(#[doc = $meaning] pub $name: $type,)*
        }

        pub(crate) const SCENE: $crate::entry::Entry<$model> = $crate::entry::Entry {
            $($text: $words,)*
            parameters: &[$($crate::parameter::Parameter {
                name: stringify!($name),
                meaning: $meaning,
                default: $default,
                range: $crate::parameter::Range::$range($($end),*),
                integer: <$type as $crate::parameter::Field>::IS_WHOLE,
            }),*],
            build: |values| {
                let [$($name),*] = values else {
                    unreachable!("every parameter has a value")
                };
                $model { $($name: $crate::parameter::Field::of($name)),* }
            },
        };
    };
}
pub(crate) use scene;
