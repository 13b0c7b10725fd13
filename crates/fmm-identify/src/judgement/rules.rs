//! Rules of the judgement: every number that decides something, with its unit and its origin.
//!
//! "Chosen" means that there is no derivation: the number was chosen on simulated records, and the study of
//! `docs/study.md` measures the judgement as a whole.

/// p below which a law is excluded (1). Origin: chosen so that the true law is excluded in no more than one record of a
/// hundred, as the best of several others is a little better than one other.
pub(crate) const EXCLUDED: f64 = 0.002;

/// p below which a law is not preferred to a more general one (1). Origin: 0.05 over 4; the best of a dozen laws is
/// better than one other by chance about four times as often as that one.
pub(crate) const UNFIT: f64 = 0.0125;

/// p of the preferred law below which more general laws are its rivals (1). Origin: the usual one in twenty.
pub(crate) const DOUBTED: f64 = 0.05;

/// Difference of scores within which a law with more parameters is a rival (1). Origin: a twentieth of the likelihood,
/// 2 ln 20.
pub(crate) const CLOSE: f64 = 6.0;

/// Difference of misfits below which two laws fit equally well, in variances of the noise (1). Origin: rounding.
pub(crate) const EQUAL_MISFIT: f64 = 1e-6;

/// Relative difference of two sums of squares that is rounding (1).
pub(crate) const ROUNDING_OF_SQUARES: f64 = 1e-9;

/// Factor of the error of the best prediction (1) up to which another is as good: that of 5 000 independent residuals
/// is known to a hundredth.
pub(crate) const EQUAL_PREDICTION: f64 = 1.01;

/// Relative uncertainty above which extra damping cannot be excluded (1). Origin: chosen.
pub(crate) const BADLY_KNOWN: f64 = 0.004;

/// Ratio of an uncertainty with extra damping to that without, above which the damping causes it (1). Origin: chosen.
pub(crate) const DUE_TO_DAMPING: f64 = 2.0;

/// Independent residuals in the criterion of Schwarz at least (1). Origin: its penalty, ln 8, is then no smaller than
/// that of Akaike.
pub(crate) const LEAST_COUNT: f64 = 8.0;

/// Damping over its critical value up to which a machine without a damper may have any beforehand (1). Origin: flexures
/// and structures of metal have 0.001 to 0.01.
pub(crate) const USUAL_DAMPING: f64 = 0.01;

/// Factor of an uncertainty, widened for other laws, that is worth a warning (1). Origin: chosen.
pub(crate) const NOTABLE_WIDENING: f64 = 2.0;

/// Residuals over those of the preferred law above which a law does not describe the record (1). Origin: chosen.
pub(crate) const FAR: f64 = 2.0;

/// Friction at rest over that of the preferred law below which another law misleads (1). Origin: chosen.
pub(crate) const MISLEADING: f64 = 0.5;

/// Level over its standard uncertainty above which there is friction (1). Origin: one record in 44 by chance.
pub(crate) const SHOWN: f64 = 2.0;

/// Presliding over the amplitude below which no record shows it (1). Origin: chosen.
pub(crate) const LEAST_PRESLIDING: f64 = 2e-3;

/// Steps of a converter that presliding must exceed to be seen (1). Origin: chosen; steps look like presliding.
pub(crate) const STEPS_OF_PRESLIDING: f64 = 3.0;

/// Presliding over its standard uncertainty above which laws with presliding are tried (1). Origin: one record in 44 by
/// chance, on one side.
pub(crate) const SEEN_PRESLIDING: f64 = 2.0;

/// Misfit and two for each parameter, beside the best law of the friction over the speed, above which a law is not
/// fitted (1). Origin: a law that is left has less than 20 by its fit; chosen above.
pub(crate) const ALLOWED: f64 = 30.0;

/// Share of the misfit of Coulomb and viscous friction by which those of other laws may be wrong before they are
/// fitted (1). Origin: chosen; a law that rises within the first two levels, as regularised ones do, has 0.21 where
/// it is true.
pub(crate) const INEXACT: f64 = 0.3;

/// Iterations of a fit that begins on the friction over the speed (1). Origin: those that end take 5 to 30; one that
/// needs more creeps along a valley that the noise fills.
pub(crate) const MOST_ITERATIONS: usize = 40;

/// Fall of the misfit in one step, in variances of the noise, below which the fit of a further law ends (1). Origin: it
/// moves no finding by more than 0.01 standard uncertainties.
pub(crate) const ENOUGH_TO_JUDGE: f64 = 1e-4;

/// Iterations of a fit with friction that changes (1). Origin: chosen; twice as many as from a closer start.
pub(crate) const MOST_ITERATIONS_OF_CHANGE: usize = 80;

/// Iterations of a fit by a law with presliding (1). Origin: chosen; its motion takes long to simulate.
pub(crate) const MOST_ITERATIONS_WITH_STATE: usize = 40;

/// Speeds over the largest one over which friction may fall in a score test (1). Origin: chosen, a factor of about 3
/// apart.
pub(crate) const FALLS: [f64; 4] = [0.02, 0.06, 0.2, 0.5];

/// Size of an extension that is simulated (1). Origin: small enough to be proportional, large enough not to be
/// rounding.
pub(crate) const STEP: f64 = 0.01;

/// Share of a change that no parameter can follow, below which it is rounding and curvature (1).
pub(crate) const LEAST_CHANGE: f64 = 1e-6;

/// Standard uncertainties above which a change of the friction during a record is no chance (1). Origin: one in 370 on
/// two sides, as every record is asked.
pub(crate) const SHOWN_CHANGE: f64 = 3.0;

/// Rise of the friction to the largest deflection, over its mean, from which on one step of least squares tells nothing of
/// it (1). Origin: friction that has doubled; another cause has residuals that ask for several times as much.
pub(crate) const MOST_RISE: f64 = 1.0;

/// Standard uncertainties beyond the best value up to which a change or a damping that is not shown may reach (1).
/// Origin: one in 44 on one side.
pub(crate) const REACH: f64 = 2.0;

/// Standard uncertainties above which a law with damping is preferred to the same without (1). Origin: those of
/// [`UNFIT`] on two sides.
pub(crate) const SHOWN_DAMPING: f64 = 2.5;

/// Standard uncertainties above which a change is fitted, and its misfit decides (1). Origin: one in 22 on two sides;
/// of changes of three uncertainties five in six reach it.
pub(crate) const ASKED_CHANGE: f64 = 2.0;

/// Order of the filter of a sensor that is tried (1). Origin: most sensors with a filter have one of second order.
pub(crate) const FILTER_ORDER: usize = 2;

/// Corner frequency over its uncertainty above which a record shows a filter (1). Origin: chosen.
pub(crate) const SHOWN_CORNER: f64 = 5.0;

/// Residuals behind a filter over those of the preferred law that explain the record as well (1). Origin: chosen.
pub(crate) const AS_GOOD: f64 = 1.02;

/// Residual over noise above which a filter may explain something (1). Origin: chosen; less than the excess of a law
/// that leaves something out, as a filter acts for a short time only.
pub(crate) const EXCESS_OF_FILTER: f64 = 1.1;

/// Samples of a period that show the rounding by a filter (1). Origin: chosen, for speed.
pub(crate) const ENOUGH_SAMPLES: f64 = 400.0;

/// Iterations of the fit behind a filter (1). Origin: chosen; a filter that needs more is no simple explanation.
pub(crate) const MOST_ITERATIONS_OF_FILTER: usize = 60;

/// Probability of the intervals that decide whether friction is in proportion to the load (1). Origin: the usual 95 %.
pub(crate) const LEVEL: f64 = 0.95;
