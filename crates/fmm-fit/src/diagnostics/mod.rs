//! Diagnostics of residuals: tests against noise.

pub(crate) mod diagnostics_summary;
pub(crate) mod normality;
pub(crate) mod residual_diagnostics;
pub(crate) mod runs_test;
