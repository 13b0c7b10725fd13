//! Diagnostics of residuals: tests against noise.

mod diagnostics_summary;
mod normality;
mod residual_diagnostics;
mod runs_test;

pub use diagnostics_summary::ResidualDiagnostics;
pub use normality::{NormalityTest, anderson_darling};
pub use residual_diagnostics::{autocorrelation, autocorrelation_time, durbin_watson, effective_count};
pub use runs_test::{RunsTest, runs_test};
