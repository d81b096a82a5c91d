//! Failures: every kind typed, with a sentence that says what to change, and the state intact.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

mod on_the_way;
mod refused;

use equip_integrate::{IntegrateError, Integrator, RunFailure};
use equip_scalar::Float;
use equip_tests::kepler;

/// The failure of a Kepler run over 0..=1, with its text.
fn kepler_failure<T: Float>(options: &Integrator<T>) -> (IntegrateError<T>, String) {
    kepler_failure_until(options, T::int(1))
}

fn kepler_failure_until<T: Float>(options: &Integrator<T>, end: T) -> (IntegrateError<T>, String) {
    let (h, start) = kepler::<T>(6);
    let interval = T::int(0)..=end;
    let RunFailure { error, .. } = options
        .integrate(&h, &start.q, &start.p, interval)
        .unwrap_err();
    let text = error.to_string();
    (error, text)
}

#[track_caller]
fn says(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "`{word}` is not in: {text}");
    }
}
