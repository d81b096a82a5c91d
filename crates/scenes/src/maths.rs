//! Closed forms and seeded numbers that several scenes need.

pub(crate) mod anomaly;
pub(crate) mod elliptic;
pub(crate) mod seeded;
