//! Adaptive number of trials.

use crate::error::UncertaintyError;
use crate::monte_carlo::block::BLOCK_TRIALS;
use crate::validation::{Validation, valid_digits};

/// Share of δ that a Monte Carlo may be wrong by if it is to validate another result (JCGM 101:2008, 8.2).
const VALIDATION: f64 = 0.2;

/// Kind of interval of a given coverage probability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub enum IntervalKind {
    /// Equal probabilities on both sides.
    #[default]
    Symmetric,
    /// The shortest one.
    Shortest,
}

/// The adaptive procedure of JCGM 101:2008, 7.9: sequences of M = max(10⁴, 100/(1 − p)) trials until estimate, standard
/// uncertainty and both ends of the coverage interval are stable, for every output.
///
/// ```text
/// s_z² = Σ (z_h − z̄)²/(h (h − 1)),   stop when 2 s_z ≤ δ for all four z      (JCGM 101:2008, 7.9.4)
/// ```
///
/// The ends stated are those of the interval of all trials. Those of a symmetric interval scatter as s_z says; those
/// of a shortest interval settle only as M^(−1/3), and are judged by the scatter of batches that grow with the run.
/// They take more trials, eight times as many in the guide's examples, and a flat density, of which
/// all intervals are equally short, ends in [`UncertaintyError::TooFewTrials`].
///
/// At least ten sequences are made: two may agree by chance. The stop succeeds in about nine of ten runs, since it
/// waits for a favourable estimate of s_z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    target: Target,
    share: f64,
    pub(super) level: f64,
    pub(super) kind: IntervalKind,
    pub(super) most_trials: u64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Target {
    Digits(u32),
    Tolerance(f64),
}

impl Adaptive {
    /// Results stable to `digits` significant digits of u(y), with a symmetric interval of 95 % and at most 10⁸
    /// trials.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless there are 1 to 15 digits.
    pub fn to_digits(digits: u32) -> Result<Self, UncertaintyError> {
        Ok(Self::new(Target::Digits(valid_digits(digits)?)))
    }

    /// Results stable to `tolerance` δ (unit of the outputs, which share it).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless it is positive and finite.
    pub fn to_tolerance(tolerance: f64) -> Result<Self, UncertaintyError> {
        if tolerance > 0.0 && tolerance.is_finite() {
            Ok(Self::new(Target::Tolerance(tolerance)))
        } else {
            let (option, must_be) = ("numerical tolerance", "positive and finite");
            Err(UncertaintyError::out_of_range(option, tolerance, must_be))
        }
    }

    const fn new(target: Target) -> Self {
        Self { target, share: 1.0, level: 0.95, kind: IntervalKind::Symmetric, most_trials: 100_000_000 }
    }

    /// The same with an interval of the given kind and coverage probability.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 < level < 1.
    pub fn with_interval(mut self, kind: IntervalKind, level: f64) -> Result<Self, UncertaintyError> {
        (self.kind, self.level) = (kind, UncertaintyError::require_level(level)?);
        Ok(self)
    }

    /// The same to a fifth of the tolerance, as the validation of another result needs it (JCGM 101:2008, 8.2).
    #[must_use]
    pub const fn for_validation(mut self) -> Self {
        self.share = VALIDATION;
        self
    }

    /// The same with another largest number of trials, which a run never exceeds: it ends with the last whole sequence
    /// that fits.
    #[must_use]
    pub const fn with_most_trials(mut self, trials: u64) -> Self {
        self.most_trials = trials;
        self
    }

    pub(crate) fn trials_of_sequence(&self) -> u64 {
        self.blocks_of_sequence().saturating_mul(BLOCK_TRIALS as u64)
    }

    /// Tolerance of all figures of an output with this uncertainty (unit of the output).
    pub(crate) fn tolerance(&self, standard_uncertainty: f64) -> Result<f64, UncertaintyError> {
        let tolerance = match self.target {
            Target::Digits(digits) => Validation::tolerance_of(standard_uncertainty, digits)?,
            Target::Tolerance(tolerance) => tolerance,
        };
        Ok(self.share * tolerance)
    }

    /// Blocks of a sequence.
    pub(crate) fn blocks_of_sequence(&self) -> u64 {
        let trials = (100.0 / (1.0 - self.level)).ceil().max(1e4);
        (trials / BLOCK_TRIALS as f64).ceil() as u64
    }
}
