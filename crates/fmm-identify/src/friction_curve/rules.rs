//! Rules of the friction curve: every number that decides something, with its unit and its origin.
//!
//! Numbers without another origin were chosen on simulated records; the study of `docs/friction-curve.md` measures
//! their effect on other records.

/// Standard deviation of the constant and of the straight part of a curve beforehand, over the mean friction (1).
/// Origin: no curve of friction with this mean lies beyond.
pub(super) const LEVEL_AND_LINE: f64 = 3.0;

/// Probability beforehand that a curve has no falling shape of the catalogue (1). Origin: as probable as each of the
/// four families; with one half, bands hold a Gaussian fall in three of four records with noise of 5 %.
pub(super) const SHAPELESS: f64 = 0.2;

/// Fall speeds of the shapes over the top speed (1), equal factors apart. Origin: a sharper fall lies between rest and
/// the first knots, a flatter one is nearly a line.
pub(super) const FALL_SPEEDS: [f64; 14] =
    [0.02, 0.026, 0.035, 0.047, 0.062, 0.083, 0.11, 0.147, 0.196, 0.26, 0.35, 0.46, 0.62, 0.82];

/// Standard deviations of the size of a falling shape over the mean friction (1). Origin: static levels of dry contacts
/// lie up to twice above the sliding ones.
pub(super) const AMPLITUDES: [f64; 3] = [0.15, 0.3, 0.6];

/// Deviations τ of the second differences of the remainder over ln(1 + s/s₀), over the mean friction (1). Origin: from
/// nothing that a record shows to a curve without any shape.
pub(super) const REMAINDERS: [f64; 8] = [1e-3, 3e-3, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32];

/// Speed s₀ over the top speed (1), above which a curve is smooth over the logarithm of the speed. Origin: the knots.
pub(super) const SMOOTH_FROM: f64 = 0.05;

/// Weight over the largest one below which a part of the mixture is left out (1). Origin: all that are left out weigh
/// less than 1 %.
pub(super) const LEAST_WEIGHT: f64 = 1e-5;

/// Linearisations at most. Origin: chosen; three to six are the rule.
pub(super) const MOST_STEPS: usize = 20;

/// Sum of squares over the least one above which linearisations go astray, and so many of them in turn after which they
/// do not come back (1). Origin: chosen; a record with something beside a curve sends them from one side to the other.
pub(super) const ASTRAY: f64 = 1.1;
pub(super) const MOST_ASTRAY: usize = 5;

/// The same before laws are projected (1). Origin: the misfits of laws are then known better than they have to be.
pub(super) const MOST_STEPS_OF_PROJECTION: usize = 8;

/// Difference of misfits that makes none (1). Origin: the chance of one parameter.
pub(super) const EVEN: f64 = 1.0;

/// Iterations of a law on the friction that is shown, and the relative fall of its misfit below which it ends (1).
/// Origin: chosen; a fit to the record follows.
pub(super) const MOST_ITERATIONS: usize = 60;
pub(super) const ENOUGH: f64 = 1e-4;

/// Precision of a combination of levels over the greatest below which the record does not tell it (1). Origin:
/// rounding of products.
pub(super) const LOST: f64 = 1e-12;

/// Change of a level over its standard uncertainty below which the curve has settled (1). Origin: chosen, far below
/// anything that is stated.
pub(super) const SETTLED: f64 = 0.05;

/// Fall of −2 ln L by each term beside the curve above which the records show it (1). Origin: chosen; that of a
/// parameter of no effect is above it once in 100 000 records.
pub(super) const EXPLAINED: f64 = 20.0;

/// The same, as one step of least squares promises it, below which terms are not tried (1). Origin: of 66 that were
/// tried none fell by more than 17 times as much as was promised.
pub(super) const PROMISED: f64 = 1.0;

/// Fall of the misfit, in variances of the noise, above which a static level is shown (1). Origin: Akaike's cost of one
/// parameter.
pub(super) const PARAMETER: f64 = 2.0;

/// Static level above the level at rest over the mean friction with which fits of a driven motion begin (1). Origin:
/// chosen; static levels of dry contacts lie up to twice above the sliding ones.
pub(super) const STATIC_EXCESSES: [f64; 2] = [0.1, 0.4];

/// Distance of a law from the curve over its standard uncertainty above which one of the two is wrong (1). Origin: of a
/// law that is just not excluded, a level may lie four of them away.
pub(super) const APART: f64 = 5.0;

/// Draws behind a simultaneous band. Origin: its reach is known to 1 %.
pub(super) const DRAWS: usize = 4000;

/// Samples of the motion in a period by which the path is weighed. Origin: weights to 1e-4.
pub(super) const SAMPLES_PER_PERIOD: f64 = 400.0;

/// Such samples at most. Origin: time.
pub(super) const MOST_SAMPLES: usize = 200_000;
