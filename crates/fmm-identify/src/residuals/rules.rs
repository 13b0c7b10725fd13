//! Rules of the residuals: every number that decides something, with its unit and its origin.
//!
//! Numbers without another origin have no derivation: they were chosen on simulated records, and the study of
//! `docs/study.md` measures their effect as a whole.

/// Rounding of doubles over the amplitude of a record without noise (1). Origin: chosen, far above
/// the rounding of a simulation (1e-12) and far below any noise.
pub(crate) const ROUNDING_OF_RECORD: f64 = 1e-9;

/// Residual over noise above which a law leaves something out (1). Origin: chosen; the noise of a short record is known
/// to some tens of percent.
pub(crate) const EXCESS: f64 = 1.5;

/// Autocorrelation time above which residuals are not independent (samples). Origin: chosen.
pub(crate) const CORRELATION_TIME: f64 = 3.0;

/// Degrees of freedom of an estimate at least (1). Origin: chosen; Student's factor grows without bound
/// below.
pub(crate) const LEAST_DEGREES_OF_FREEDOM: f64 = 1.5;

/// Order of an autoregression at most (1). Origin: chosen; the lines of the periodogram correct what is left.
pub(crate) const HIGHEST_ORDER: usize = 16;

/// Residuals for each coefficient of an autoregression at least (1). Origin: chosen.
pub(crate) const RESIDUALS_PER_COEFFICIENT: usize = 20;

/// Decrease of n ln σ² that a further coefficient must reach (1). Origin: twice Akaike's 2, so that white noise
/// seldom has one.
pub(crate) const PENALTY_OF_COEFFICIENT: f64 = 4.0;

/// Factor up to which lower and higher frequencies are averaged over a line of the periodogram (1). Origin: chosen.
pub(crate) const SPREAD: f64 = 2.5;

/// Ordinates of the periodogram in such an average at least (1). Origin: twelve tell a density to 29 %, 1/√12.
pub(crate) const FEWEST_ORDINATES: f64 = 12.0;

/// Standard errors above one at which an average of the periodogram is no chance (1). Origin: one in 44 by chance.
pub(crate) const SIGNIFICANT_DENSITY: f64 = 2.0;

/// Steps in which the part of the noise that the parameters took is put back (1). Origin: chosen.
pub(crate) const RESTORATIONS: usize = 3;

/// Residuals below which a series is taken as white (1). Origin: chosen.
pub(crate) const FEWEST_RESIDUALS: usize = 32;

/// Rows above which neighbours are taken together (1). Origin: memory and time of the transform.
pub(crate) const MOST_ROWS: usize = 1 << 17;

/// Groups that a period of the motion keeps at least (1). Origin: chosen; faster noise moves no parameter.
pub(crate) const GROUPS_PER_PERIOD: f64 = 64.0;

/// Share of the mean of a plateau, taken by the parameters, above which the mean says nothing of its error (1). Origin:
/// chosen; the variance is then raised fivefold at most.
pub(crate) const MOST_TAKEN: f64 = 0.8;

/// Gain in the logarithm of the likelihood that a growth of the noise must reach (1). Origin: chance reaches it in one
/// record of a thousand.
pub(crate) const EVIDENCE_OF_GROWTH: f64 = 6.0;

/// Steps of Fisher's scoring for the variances of a growing noise (1). Origin: chosen.
pub(crate) const SCORING_STEPS: usize = 4;

/// Floor of a growing noise, as a share of the mean square of the residuals (1). Origin: variances must stay positive.
pub(crate) const LEAST_FLOOR: f64 = 1e-4;

/// Standard uncertainties above which a score test is no chance (1). Origin: one in 370 on two sides, so that of the
/// questions to a clean record one in about a hundred records answers one by chance.
pub(crate) const SIGNIFICANT: f64 = 3.0;

/// The same of presliding, which has an expected sign (1). Origin: one in 370 on one side.
pub(crate) const SIGNIFICANT_PRESLIDING: f64 = 2.78;

/// The same of what friction is expected to do: to fall with the speed, or to look like a negative damping (1). Origin:
/// one in a hundred on one side; what falls and is not seen moves a level by several of its uncertainties.
pub(crate) const SIGNIFICANT_FALL: f64 = 2.33;

/// Probability that noise alone looks like a drift (1). Origin: chosen.
pub(crate) const CHANCE_OF_DRIFT: f64 = 1e-3;

/// Residual over noise, without a drift, below which a drift may be all that is left (1). Origin: chosen; the
/// parameters of the motion follow the drift by a little.
pub(crate) const NEAR_NOISE: f64 = 2.0;

/// Frequencies between the harmonics of the motion that show its noise, in natural frequencies (1).
pub(crate) const BETWEEN_HARMONICS: [f64; 6] = [1.5, 2.5, 3.5, 4.5, 5.5, 6.5];
