//! What the tests share: every check is a generic function that runs in each float type.

/// Runs each check in `f64`.
macro_rules! in_every_float {
    ($($check:ident),* $(,)?) => {
        mod in_f64 {
            $(#[test]
            fn $check() {
                super::$check::<f64>();
            })*
        }
    };
}
pub(crate) use in_every_float;
