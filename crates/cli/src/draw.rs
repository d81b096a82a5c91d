//! Pictures: SVG by hand, panels with axes, charts of them, and what is kept of a run to draw it.

pub(crate) mod chart;
pub(crate) mod growth;
pub(crate) mod panel;
pub(crate) mod samples;
pub(crate) mod svg;
