//! [`object!`]: JSON objects whose members are written once.

/// A value that serialises as an object, its members in the order in which they stand.
macro_rules! object {
    ($($name:ident: $value:expr),* $(,)?) => {{
        // Each member has a type of its own, which is named like it.
        #[allow(non_camel_case_types)]
        let object = {
            #[derive(serde::Serialize)]
            struct Object<$($name),*> { $($name: $name),* }
            Object { $($name: $value),* }
        };
        object
    }};
}
pub(crate) use object;
