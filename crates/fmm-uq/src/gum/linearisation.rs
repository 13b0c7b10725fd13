//! Linearisation: validity of a first-order uncertainty.

use crate::SecondOrder;
use crate::gum::second_order::{Curvature, TOLERATED};

/// The verdict on the linear approximation of a model within the uncertainties of its inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Linearisation {
    /// Curvature changes neither u(y) nor y by as much as 5 % of u(y), and neither does what the model does √3 standard
    /// uncertainties away along each of its inputs (or at their limits). It holds also for a result that cannot vary,
    /// such as the difference of two fully correlated inputs of the same uncertainty.
    ///
    /// The model was asked at points: what lies between them or only concerns several inputs far away together is not
    /// seen.
    Adequate,
    /// u(y) is zero to first order although inputs are uncertain: the model is flat at the estimates or its slopes
    /// cancel, and a linear approximation cannot see what the inputs do. x² at x = 0 is the plainest case.
    ZeroUncertainty,
    /// The second-order terms change u(y) by 5 % or more.
    UncertaintyDiffers(SecondOrder),
    /// The second-order terms move the estimate by 5 % of u(y) or more.
    EstimateShifts(SecondOrder),
    /// The model is not what its expansion says within the uncertainties of its inputs: a kink, a high power or a range
    /// that ends there; or the second-order terms are not finite, or so large that they make the variance negative.
    NotExpandable,
    /// The second-order terms were not asked for.
    Unchecked,
}

impl Linearisation {
    /// Whether the uncertainty should not be reported without a Monte Carlo to confirm it.
    pub const fn is_suspect(self) -> bool {
        !matches!(self, Self::Adequate | Self::Unchecked)
    }

    /// The verdict; the curvature is known if it was asked for.
    pub(crate) fn judge(first_order: f64, inputs_vary: bool, curvature: Option<Curvature>) -> Self {
        if first_order == 0.0 && inputs_vary && !curvature.is_some_and(|curvature| curvature.cancels) {
            return Self::ZeroUncertainty;
        }
        match curvature.map(|curvature| curvature.terms) {
            None => Self::Unchecked,
            Some(None) => Self::NotExpandable,
            Some(Some(_)) if first_order == 0.0 => Self::Adequate,
            Some(Some(terms)) => {
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
