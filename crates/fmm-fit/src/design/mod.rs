//! Design of experiments: the measurements with the most information, before they are made.

pub(crate) mod design_case;
pub(crate) mod exchange;
pub(crate) mod information;
pub(crate) mod search;
