//! Decimals of a float: exact to print, and read to the nearest number.

/// Of a type with `expansion`, `nearest` (of a decimal), and `digits`, of which a decimal always has as many.
macro_rules! text_glue {
    ([$($g:tt)*] $t:ty) => {
        impl<$($g)*> std::str::FromStr for $t {
            type Err = $crate::ParseFloatError;

            /// Accepts what the parser of `f64` accepts.
            fn from_str(text: &str) -> Result<Self, $crate::ParseFloatError> {
                if let Some(decimal) = $crate::double_double::text::parse::Decimal::read(text) {
                    return Ok(Self::nearest(&decimal));
                }
                // What is left for the parser of f64 are the words for infinity and NaN.
                let special = text.parse::<f64>().map(<$t>::small);
                special.map_err(|_| $crate::ParseFloatError { text: text.into() })
            }
        }
        text_glue!(@print [$($g)*] $t; Display false, LowerExp true);
    };
    (@print $g:tt $t:ty; $($trait:ident $scientific:literal),*) => {$(
        text_glue!(@one $g $t; $trait $scientific);
    )*};
    (@one [$($g:tt)*] $t:ty; $trait:ident $scientific:literal) => {
        impl<$($g)*> std::fmt::$trait for $t {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let words = $crate::Float::expansion(*self);
                let same = |decimal: &_| <$t>::nearest(decimal) == *self;
                $crate::double_double::text::print::print(&words, <$t>::digits(), $scientific, same, f)
            }
        }
    };
}
