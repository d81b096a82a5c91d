//! Mathematical constants in a float of any precision, computed once for each type.

use super::functions::exponential::ln_2_words;
use super::functions::sum;
use super::{Arithmetic, Own};
use num_traits::FloatConst;
use std::any::{Any, TypeId};
use std::sync::{PoisonError, RwLock};

/// π to 104 decimals.
const PI: &str = "3.14159265358979323846264338327950288419716939937510\
    582097494459230781640628620899862803482534211706798214";
/// ln 10 to 104 decimals.
const LN_10: &str = "2.30258509299404568401799145468436420760110148862877\
    297603332790096757260967735248023599720508959829834197";

/// Those that take more than a few operations.
struct Kept<A: Arithmetic> {
    pi: Own<A>,
    root_pi: Own<A>,
    root_2: Own<A>,
    e: Own<A>,
    ln_2: Own<A>,
    ln_10: Own<A>,
}

impl<A: Arithmetic> Kept<A> {
    fn new() -> Self {
        let read = |text: &str| text.parse().unwrap_or(Own(A::NAN));
        let pi: Own<A> = read(PI);
        Kept {
            pi,
            root_pi: pi.sqrt(),
            root_2: Own::small(2.0).sqrt(),
            e: Own::small(1.0).exp(),
            ln_2: sum(ln_2_words()),
            ln_10: read(LN_10),
        }
    }

    fn get() -> &'static Self {
        type OfTypes = Vec<(TypeId, &'static (dyn Any + Send + Sync))>;
        static ALL: RwLock<OfTypes> = RwLock::new(Vec::new());
        let found = |all: &OfTypes| {
            let mut own = all.iter().filter(|(id, _)| *id == TypeId::of::<A>());
            own.find_map(|(_, kept)| kept.downcast_ref::<Self>())
        };
        if let Some(kept) = found(&ALL.read().unwrap_or_else(PoisonError::into_inner)) {
            return kept;
        }
        let new: &'static Self = Box::leak(Box::new(Self::new()));
        let mut all = ALL.write().unwrap_or_else(PoisonError::into_inner);
        all.push((TypeId::of::<A>(), new));
        new
    }
}

macro_rules! constants {
    ($($c:ident = |$k:ident| $value:expr;)*) => {$(
        fn $c() -> Self {
            let $k = Kept::<A>::get();
            $value
        }
    )*};
}

impl<A: Arithmetic> FloatConst for Own<A> {
    constants! {
        E = |k| k.e;
        PI = |k| k.pi;
        TAU = |k| k.pi + k.pi;
        FRAC_PI_2 = |k| k.pi * Self::small(0.5);
        FRAC_PI_3 = |k| k.pi / Self::small(3.0);
        FRAC_PI_4 = |k| k.pi * Self::small(0.25);
        FRAC_PI_6 = |k| k.pi / Self::small(6.0);
        FRAC_PI_8 = |k| k.pi * Self::small(0.125);
        FRAC_1_PI = |k| k.pi.recip();
        FRAC_2_PI = |k| Self::small(2.0) / k.pi;
        FRAC_2_SQRT_PI = |k| Self::small(2.0) / k.root_pi;
        SQRT_2 = |k| k.root_2;
        FRAC_1_SQRT_2 = |k| k.root_2 * Self::small(0.5);
        LN_2 = |k| k.ln_2;
        LN_10 = |k| k.ln_10;
        LOG2_E = |k| k.ln_2.recip();
        LOG10_E = |k| k.ln_10.recip();
        LOG10_2 = |k| k.ln_2 / k.ln_10;
        LOG2_10 = |k| k.ln_10 / k.ln_2;
    }
}
