//! Pictures: SVG by hand, panels with axes, and what runs are drawn as.

pub(crate) mod growth;
pub(crate) mod panel;
pub(crate) mod run;
pub(crate) mod samples;
pub(crate) mod svg;
