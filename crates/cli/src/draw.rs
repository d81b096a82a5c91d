//! Pictures: SVG by hand, panels with axes, charts of them, pages, and what is kept of a run to draw it.

pub(crate) mod chart;
pub(crate) mod figure;
pub(crate) mod page;
pub(crate) mod panel;
pub(crate) mod samples;
pub(crate) mod svg;
