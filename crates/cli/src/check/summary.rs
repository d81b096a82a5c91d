//! [`Summary`]: what the rows came to.

use super::measure::Row;
use super::verdict::Word;
use std::time::Instant;

/// What the rows came to.
#[derive(Debug, Clone, Copy, Default, serde::Serialize)]
pub(crate) struct Summary {
    pub(crate) rows: usize,
    pub(crate) passed: usize,
    pub(crate) expected_errors: usize,
    pub(crate) explained: usize,
    pub(crate) known_deficits: usize,
    pub(crate) failed: usize,
    pub(crate) seconds: f64,
}

impl Summary {
    pub(crate) fn of(rows: &[Row<'_>], begun: Instant) -> Self {
        let count = |word| rows.iter().filter(|r| r.verdict.word == word).count();
        Summary {
            rows: rows.len(),
            passed: count(Word::Pass),
            expected_errors: count(Word::ExpectedError),
            explained: count(Word::Explained),
            known_deficits: count(Word::KnownDeficit),
            failed: count(Word::Fail),
            seconds: begun.elapsed().as_secs_f64(),
        }
    }
}
