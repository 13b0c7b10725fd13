//! Reasons to distrust a sampled posterior.

use std::fmt;

use fmm_model::Rounded;

/// A reason to distrust a sampled posterior. `Display` gives it in words, with what to do.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PosteriorWarning {
    /// The chains do not agree: R̂ exceeds 1.01.
    ChainsDiffer {
        /// Name of the quantity in which they differ most.
        quantity: String,
        /// R̂ (1).
        r_hat: f64,
    },
    /// Fewer than 400 effective draws.
    FewEffectiveDraws {
        /// Name of the quantity with the fewest.
        quantity: String,
        /// Their number, in the middle or in the tails (1).
        effective: f64,
    },
    /// Trajectories that could not be followed, where the density bends more than the steps can.
    Divergences {
        /// Their number.
        count: usize,
        /// Number of all draws.
        draws: usize,
    },
    /// A random walk without gradients finds another moment, in the unit of the parameter.
    Disagrees {
        /// Name of the parameter.
        parameter: String,
        /// True for the standard deviation, false for the mean.
        is_deviation: bool,
        /// The moment by the sampler with gradients.
        with_gradient: f64,
        /// The moment by random-walk steps.
        without_gradient: f64,
        /// Standard error of the difference.
        standard_error: f64,
    },
}

impl fmt::Display for PosteriorWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ChainsDiffer { quantity, r_hat } => write!(
                f,
                "the chains do not agree on {quantity}: R-hat is {r_hat:.3} and should be below 1.01; ask for more \
                 draws, and look for a second minimum"
            ),
            Self::FewEffectiveDraws { quantity, effective } => write!(
                f,
                "{quantity} has {effective:.0} effective draws, fewer than 400: its interval is uncertain; ask for \
                 more draws"
            ),
            Self::Divergences { count, draws } => write!(
                f,
                "{count} of {draws} trajectories diverged: the density bends sharply there, and the draws may avoid \
                 that region; compare with the profile intervals"
            ),
            Self::Disagrees { parameter, is_deviation, with_gradient, without_gradient, standard_error } => {
                let moment = if *is_deviation { "standard deviation" } else { "mean" };
                let [with, without] =
                    [with_gradient, without_gradient].map(|value| Rounded::new(*value, Some(*standard_error)));
                write!(
                    f,
                    "a random walk without gradients does not agree: the {moment} of {parameter} is {without} by it \
                     and {with} by the sampler; the residuals may have kinks or several minima"
                )
            }
        }
    }
}
