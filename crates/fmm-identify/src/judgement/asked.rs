//! Size of a term that the residuals of a fit without it ask for.

use crate::candidate::Candidate;
use crate::experiment::Experiment;
use crate::identification::Identification;
use crate::judgement::rules::LEAST_CHANGE;
use crate::machine::term::Term;
use crate::problem::Problem;
use crate::problem::tangent::Tangent;
use crate::quantities::rows::Place;

/// Size w of a term beside a law that leaves it out, by one step of least squares from the fit without it:
///
/// ```text
/// w = −dᵀr/dᵀd,     u² = dᵀΣd/(dᵀd)²,     d = (1 − J(JᵀJ)⁻¹Jᵀ) ∂m/∂w
/// ```
///
/// with the residuals r, their noise Σ and the derivatives J of the fit, and m the motion.
pub(super) struct Asked {
    pub(super) value: f64,
    pub(super) uncertainty: f64,
    /// Relative error of the level of friction over the size; zero for a law whose level is zero.
    pub(super) moved: f64,
}

impl Asked {
    /// Size of the `term` of the `extended` law that the residuals of `found` ask for; `None` for driven motions, and
    /// where the parameters can follow it.
    pub(super) fn of(
        found: &Identification,
        experiments: &[Experiment],
        extended: &Candidate,
        term: Term,
    ) -> Option<Self> {
        if experiments.iter().any(|experiment| experiment.drive().is_some()) || !found.structure.is_noisy() {
            return None;
        }
        let fit = found.fit();
        let base = found.problem(experiments).ok()?;
        let problem = Problem::of(extended, *found.machine(), experiments).ok()?;
        let index = problem.table.shared(Place::Term(term))?;
        let mut direction = problem.columns(&problem.extended(fit), &[index]).ok()?.pop()?;
        let tangent = Tangent::of(&base, fit)?;
        let before: f64 = direction.iter().map(|d| d * d).sum();
        let level = found.family().level().map(|level| base.table.law + level);
        let relative = |level: usize| tangent.step(level, &direction) / fit.values()[level];
        let moved = level.filter(|level| fit.values()[*level] > 0.0).map_or(0.0, relative);
        tangent.span.take_out(&mut direction);
        let square: f64 = direction.iter().map(|d| d * d).sum();
        let noise = found.covariance.noise.product(&direction, &direction);
        if !(square > LEAST_CHANGE * before && noise > 0.0) {
            return None;
        }
        let product: f64 = direction.iter().zip(fit.residuals()).map(|(d, r)| d * r).sum();
        Some(Self { value: -product / square, uncertainty: noise.sqrt() / square, moved })
    }
}
