//! Whether a first-order uncertainty may be believed.

use crate::SecondOrder;

/// What the curvature may change, relative to u(y), before the linear approximation is doubted. An uncertainty is stated
/// to two digits, of which the last is worth 5 % at least once in ten times that much.
const TOLERATED: f64 = 0.05;

/// The verdict on the linear approximation of a model within the uncertainties of its inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Linearisation {
    /// Curvature changes neither u(y) nor y by as much as 5 % of u(y).
    Adequate,
    /// u(y) is zero to first order although inputs are uncertain: the model is flat at the estimates or its slopes
    /// cancel, and a linear approximation cannot see what the inputs do. x² at x = 0 is the plainest case.
    ZeroUncertainty,
    /// The second-order terms change u(y) by 5 % or more.
    UncertaintyDiffers(SecondOrder),
    /// The second-order terms move the estimate by 5 % of u(y) or more.
    EstimateShifts(SecondOrder),
    /// The second-order terms are not finite, or so large that they make the variance negative.
    NotExpandable,
    /// The second-order terms were not asked for.
    Unchecked,
}

impl Linearisation {
    /// Whether the uncertainty should not be reported without a Monte Carlo to confirm it.
    pub const fn is_suspect(self) -> bool {
        !matches!(self, Self::Adequate | Self::Unchecked)
    }

    /// The verdict; `asked` says whether second-order terms were.
    pub(crate) fn judge(first_order: f64, inputs_vary: bool, asked: bool, terms: Option<SecondOrder>) -> Self {
        if first_order == 0.0 && inputs_vary {
            return Self::ZeroUncertainty;
        }
        match terms {
            None if asked => Self::NotExpandable,
            None => Self::Unchecked,
            Some(terms) => {
                let tolerated = TOLERATED * first_order;
                if (terms.standard_uncertainty - first_order).abs() > tolerated {
                    Self::UncertaintyDiffers(terms)
                } else if terms.correction.abs() > tolerated {
                    Self::EstimateShifts(terms)
                } else {
                    Self::Adequate
                }
            }
        }
    }
}
