//! Fits of the same records, near which another fit may begin.

use fmm_fit::Fit;

use crate::law::Law;
use crate::machine::Terms;

/// A fit by a law with terms beside it.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    pub(crate) law: Law,
    pub(crate) terms: Terms,
    pub(crate) fit: Fit,
}

impl Fitted {
    /// Root mean square of the residuals, in their unit.
    pub(crate) fn rms_residual(&self) -> f64 {
        (self.fit.sum_of_squares() / self.fit.residuals().len() as f64).sqrt()
    }
}

/// Friction that falls with the speed, as residuals ask for it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fall {
    /// Speed over which it falls by 1/e, as a share of the largest (1).
    pub(crate) speed: f64,
    /// Fall over the level of friction (1).
    pub(crate) size: f64,
    /// Fall over its standard uncertainty (1).
    pub(crate) significance: f64,
}
