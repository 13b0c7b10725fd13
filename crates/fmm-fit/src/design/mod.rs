//! Design of experiments: which measurements tell most about the parameters, before they are made.

pub(crate) mod design_case;
pub(crate) mod exchange;
pub(crate) mod information;
pub(crate) mod search;
