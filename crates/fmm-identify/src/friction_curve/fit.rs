//! The fit of a friction curve: linearised again at its mean until it stays.

use std::ops::ControlFlow;
use std::time::Instant;

use fmm_fit::{EvaluationError, Minimizer, Options, Residuals, autocorrelation_time};
use fmm_friction::CoulombViscous;
use nalgebra::DVector;

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::parts::averaged;
use crate::experiment::{Experiment, scaled};
use crate::fit::stages::{Begin, fit_begun};
use crate::friction_curve::levels::{KNOTS, LEVELS, Levels, STATIC, TOP_SPEED};
use crate::friction_curve::likelihood::{Likelihood, Linearised};
use crate::friction_curve::mixture::{Posterior, Prior};
use crate::friction_curve::path::Path;
use crate::friction_curve::rules::{ASTRAY, MOST_ASTRAY, MOST_STEPS, PARAMETER, SETTLED, STATIC_EXCESSES};
use crate::friction_curve::sources::Sources;
use crate::law::naming::Form;
use crate::machine::{Machine, Terms};
use crate::problem::Problem;
use crate::quantities::rows::Place;
use crate::residuals::noise::ResidualNoise;
use crate::residuals::rules::{CORRELATION_TIME, EXCESS};
use crate::threads::is_past;

/// A fitted friction curve in the units of its problem.
pub(super) struct CurveFit {
    pub(super) top: f64,
    /// Friction in which the posterior is relative.
    pub(super) scale: f64,
    pub(super) posterior: Posterior,
    pub(super) sources: Sources,
    /// ν of the noise (1).
    pub(super) freedom: f64,
    /// f₀ (Hz); 0 without a spring.
    pub(super) frequency: f64,
    /// Weights of the levels in the mean over the path.
    pub(super) path: [f64; LEVELS],
    /// Speed at or below which half of the half cycles have a sample.
    pub(super) slowest: f64,
    /// Residual over noise, if it is too large and no noise.
    pub(super) excess: Option<f64>,
    /// Reason not to take the curve near rest for friction over the speed.
    pub(super) limit_near_rest: Option<&'static str>,
}

/// Limits of a curve near rest where a drive goes on.
const HOLDS_MORE: &str = "the contact holds more than it slides with: a static level is fitted beside the curve, and \
                          near rest the record hardly tells one from the other";
const STATIC_LEVEL_OPEN: &str = "no fit of a static level beside the curve has ended: if the contact holds more than \
                                 it slides with, the curve near rest is wrong";

/// The problem of levels, about the fit by Coulomb and viscous friction.
pub(super) struct Levelled<'a> {
    /// With the static level held at the level at rest.
    pub(super) problem: Problem<'a>,
    /// With the static level fitted; `None` where no drive goes on.
    holding: Option<Problem<'a>>,
    pub(super) values: Vec<f64>,
    pub(super) top: f64,
    /// Mean friction over the path.
    pub(super) scale: f64,
    /// The fit by Coulomb and viscous friction, with the same terms beside it.
    pub(super) line: Vec<f64>,
    /// Sum of squares of that fit.
    pub(super) line_squares: f64,
}

impl<'a> Levelled<'a> {
    /// The problem of `experiments` on `machine`, with forces in this `form` and these terms beside the levels.
    pub(super) fn of(
        form: Form,
        machine: &Machine,
        beside: &Terms,
        experiments: &'a [Experiment],
        end: Option<Instant>,
    ) -> Result<Self, IdentifyError> {
        let simple = Candidate::of::<CoulombViscous>().with(beside.clone());
        let simple = Problem::in_form(form, &simple, *machine, experiments)?;
        let options = Options::default();
        let mut observer =
            |_: &Minimizer| if is_past(end) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let line = fit_begun(&simple, Begin::Anywhere, &options, &mut observer)?;
        let failure = |error: EvaluationError| IdentifyError::simulation("friction_curve", error);
        let path = Path::of(&simple, line.values()).map_err(failure)?;
        let top = path.top();
        let (first, shared) = (simple.table.law, simple.table.shared);
        let [level, slope] = [line.values()[first], line.values()[first + 1]];
        let mean = path.weights(top).map(f64::from);
        let scale: f64 = mean.iter().zip(KNOTS).map(|(weight, s)| weight * (level + slope * s * top)).sum();
        if !(top > 0.0 && scale > 0.0 && scale.is_finite()) {
            return Err(IdentifyError::not_seen("the motion loses no energy, so there is no friction over speed"));
        }
        let (problem, holding) = problems_of_levels(form, machine, beside, experiments, top)?;
        let mut values = line.values()[..first].to_vec();
        values.extend(KNOTS.map(|s| level + slope * s * top));
        values.push(top);
        values.extend(holding.as_ref().map(|_| 0.0));
        // After the blow of a hammer the contact slides until it rests.
        let goes_on = |one: &Experiment| one.drive().is_some() && one.impact.is_none();
        let holding = holding.filter(|_| experiments.iter().any(goes_on));
        values.extend_from_slice(&line.values()[shared..]);
        let (line, line_squares) = (line.values().to_vec(), line.sum_of_squares());
        Ok(Self { problem, holding, values, top, scale, line, line_squares })
    }
}

/// The problem of levels up to the speed `top`, with the static level held at that at rest; and that with the static
/// level fitted, where the motion may show one.
pub(super) fn problems_of_levels<'a>(
    form: Form,
    machine: &Machine,
    beside: &Terms,
    experiments: &'a [Experiment],
    top: f64,
) -> Result<(Problem<'a>, Option<Problem<'a>>), IdentifyError> {
    let by = |candidate: &Candidate| Problem::in_form(form, candidate, *machine, experiments);
    let candidate = Candidate::of::<Levels>().with(beside.clone().holding(TOP_SPEED, top)?);
    let problem = by(&candidate)?;
    match problem.parameters()[..problem.table.shared].get(problem.table.law + STATIC) {
        Some(level) => Ok((by(&candidate.holding(level.name(), 0.0)?)?, Some(problem))),
        None => Ok((problem, None)),
    }
}

impl CurveFit {
    /// The curve that `experiments` on `machine` share, in this `form` with these terms beside it, found until the
    /// `end`.
    pub(super) fn of(
        form: Form,
        machine: &Machine,
        beside: &Terms,
        experiments: &[Experiment],
        end: Option<Instant>,
    ) -> Result<Self, IdentifyError> {
        Self::of_means(form, machine, beside, experiments, &averaged(experiments), end)
    }

    /// The curve that `experiments` share by their `means`.
    fn of_means(
        form: Form,
        machine: &Machine,
        beside: &Terms,
        experiments: &[Experiment],
        means: &[Experiment],
        end: Option<Instant>,
    ) -> Result<Self, IdentifyError> {
        let Levelled { ref problem, ref holding, mut values, top, scale, .. } =
            Levelled::of(form, machine, beside, means, end)?;
        let failure = |error: EvaluationError| IdentifyError::simulation("friction_curve", error);
        if let Some(thinned) = problem.thinned() {
            // Means tell more of the levels than a rough simulation does.
            let are_samples = means.iter().zip(experiments).all(|(means, one)| means.rows() == one.rows());
            let few = |problem: &Problem<'_>| {
                let few = problem.with_records(&thinned);
                if are_samples { few.simulated_roughly() } else { few }
            };
            // What does not settle with few samples does not with all of them.
            let holding = holding.as_ref().map(few);
            values = Settled::with_static(&few(problem), holding.as_ref(), values, scale, end)?.0.values;
        }
        let (Settled { values, near, likelihood, posterior, .. }, limit_near_rest) =
            Settled::with_static(problem, holding.as_ref(), values, scale, end)?;
        // Speeds at the samples of the records.
        let path = Path::of(&problem.with_records(experiments), &values).map_err(failure)?;
        Ok(Self {
            top,
            scale,
            sources: Sources::of(&posterior, &likelihood.precision, &likelihood.by_declared, scale),
            posterior,
            freedom: likelihood.freedom,
            frequency: problem.table.shared(Place::Frequency).map_or(0.0, |index| values[index]),
            path: path.weights(top),
            slowest: path.slowest(),
            excess: near.excess(problem),
            limit_near_rest,
        })
    }
}

fn not_settled() -> IdentifyError {
    IdentifyError::not_seen(
        "no curve of friction over speed was found that explains itself: something beside friction over speed acts, or \
         the record does not tell",
    )
}

/// End of the linearisations of a problem.
pub(super) struct Settled {
    pub(super) values: Vec<f64>,
    pub(super) near: Linearised,
    pub(super) likelihood: Likelihood,
    posterior: Posterior,
    /// The mean of the posterior is the curve about which it was linearised.
    has_ended: bool,
}

impl Settled {
    /// The end for `problem`, or where a drive goes on that with a static level, which belongs to the uncertainty of the
    /// curve near rest however little of it is shown; and the limit that follows.
    fn with_static(
        problem: &Problem<'_>,
        holding: Option<&Problem<'_>>,
        mut values: Vec<f64>,
        scale: f64,
        end: Option<Instant>,
    ) -> Result<(Self, Option<&'static str>), IdentifyError> {
        let of = |problem: &Problem<'_>, values| Self::of(problem, values, scale, MOST_STEPS, end);
        let ended = |settled: Self| if settled.has_ended { Ok(settled) } else { Err(not_settled()) };
        let Some(holding) = holding else {
            return Ok((ended(of(problem, values)?)?, None));
        };
        let excess = holding.table.law + STATIC;
        let known = std::mem::take(&mut values[excess]);
        let plain = of(problem, values)?;
        // A motion that is nowhere held does not change with a small excess: fits begin far from none.
        let starts = if known > 0.0 { vec![known] } else { STATIC_EXCESSES.map(|share| share * scale).to_vec() };
        let begun = starts.into_iter().filter_map(|start| {
            let mut values = plain.values.clone();
            values[excess] = start;
            of(holding, values).ok().filter(|settled| settled.has_ended)
        });
        let held = begun.min_by(|a, b| a.squares().total_cmp(&b.squares()));
        let least = plain.squares() - PARAMETER * plain.likelihood.variance;
        match held {
            // The intervals hold near the curve about which the record was linearised, and nowhere else.
            None => Ok((ended(plain)?, Some(STATIC_LEVEL_OPEN))),
            Some(held) if !plain.has_ended || held.squares() < least => Ok((held, Some(HOLDS_MORE))),
            Some(held) => Ok((held, None)),
        }
    }

    fn squares(&self) -> f64 {
        self.near.sum_of_squares()
    }

    /// Linearises `problem` from these `values` on until the mean of the posterior stays, at `most` so often and before
    /// the `end`, first for white noise, then for that of the residuals.
    pub(super) fn of(
        problem: &Problem<'_>,
        mut values: Vec<f64>,
        scale: f64,
        most: usize,
        end: Option<Instant>,
    ) -> Result<Self, IdentifyError> {
        let failure = |error: EvaluationError| IdentifyError::simulation("friction_curve", error);
        let (mut least, mut above) = (f64::INFINITY, 0);
        let levels = problem.table.law..problem.table.law + LEVELS;
        let (prior, mut noise, mut steps) = (Prior::new(), None, 0);
        loop {
            if is_past(end) {
                return Err(not_settled());
            }
            let near = Linearised::of(problem, &values, levels.start).map_err(failure)?;
            let (mut likelihood, mut posterior) = near.posterior(problem, &values, scale, &prior, noise.as_ref())?;
            let is_near = |posterior: &Posterior| {
                let step = step_of_levels(posterior, &values[levels.clone()], scale);
                let deviations = posterior.deviations();
                step.iter().zip(deviations).all(|(step, deviation)| step.abs() <= SETTLED * scale * deviation)
            };
            let mut has_ended = is_near(&posterior);
            let squares = near.sum_of_squares();
            least = least.min(squares);
            above = if squares > ASTRAY * least { above + 1 } else { 0 };
            if has_ended && noise.is_none() {
                noise = near.noise(problem, &values);
                if noise.is_some() {
                    (likelihood, posterior) = near.posterior(problem, &values, scale, &prior, noise.as_ref())?;
                    has_ended = is_near(&posterior);
                }
            }
            steps += 1;
            let step = likelihood.step(&step_of_levels(&posterior, &values[levels.clone()], scale));
            let is_last = has_ended || steps > most || above == MOST_ASTRAY;
            match (!is_last).then(|| moved(problem, &near, &values, &step, likelihood.variance)).flatten() {
                Some(moved) => values = moved,
                None => return Ok(Self { values, near, likelihood, posterior, has_ended }),
            }
        }
    }
}

/// Change of the levels from `levels` to the mean of the `posterior`; no level falls below zero.
fn step_of_levels(posterior: &Posterior, levels: &[f64], scale: f64) -> DVector<f64> {
    let mean = posterior.mean();
    DVector::from_fn(LEVELS, |i, _| (mean[i] * scale).max(0.0) - levels[i])
}

/// The `values` after as much of `step` as the residuals follow nearly as they were linearised; `None` if they follow
/// none of it.
fn moved(problem: &Problem<'_>, near: &Linearised, values: &[f64], step: &[f64], variance: f64) -> Option<Vec<f64>> {
    /// Share of the predicted change, and variances, by which the sum of squares may differ from the prediction.
    const WRONG: (f64, f64) = (0.3, 3.0);
    /// Share of a static excess that is left after a step, at least: where it is gone nothing is held, and no derivative
    /// leads back.
    const LEFT: f64 = 0.5;
    let excess = problem.table.law + STATIC;
    let is_fitted = excess < problem.table.shared && !problem.parameters()[excess].bounds().is_fixed();
    let mut residuals = vec![0.0; problem.len()];
    let mut share = 1.0;
    while share > 1e-3 {
        let mut trial = problem.clamped(&near.moved(values, step, share));
        if is_fitted {
            trial[excess] = trial[excess].max(LEFT * values[excess]);
        }
        let scaled: Vec<f64> = step.iter().map(|by| share * by).collect();
        let predicted = near.predicted(&scaled);
        if problem.evaluate(&trial, &mut residuals, None).is_ok() {
            let found: f64 = residuals.iter().map(|residual| residual * residual).sum();
            let allowed = WRONG.0 * (near.sum_of_squares() - predicted).abs() + WRONG.1 * variance;
            if found - predicted <= allowed {
                return Some(trial);
            }
        }
        share *= 0.5;
    }
    None
}

impl Linearised {
    /// Residual over noise, if it is too large and no noise.
    pub(super) fn excess(&self, problem: &Problem<'_>) -> Option<f64> {
        let residual = (self.sum_of_squares() / problem.len() as f64).sqrt();
        let expected = scaled(problem.experiments()).map(|(one, weight)| weight * one.least_noise());
        let ratio = residual / expected.fold(f64::MIN_POSITIVE, f64::max);
        (ratio > EXCESS && self.correlation() > CORRELATION_TIME).then_some(ratio)
    }

    /// Correlation time of the residuals of the records (1).
    pub(super) fn correlation(&self) -> f64 {
        autocorrelation_time(self.residuals()).unwrap_or(1.0)
    }

    /// Likelihood and posterior near the values `p`, relative to `scale`.
    fn posterior(
        &self,
        problem: &Problem<'_>,
        p: &[f64],
        scale: f64,
        prior: &Prior,
        noise: Option<&ResidualNoise>,
    ) -> Result<(Likelihood, Posterior), IdentifyError> {
        let undetermined =
            || IdentifyError::not_seen("the record does not determine the motion that friction slows down");
        let likelihood = self.likelihood(problem, p, noise).ok_or_else(undetermined)?;
        let (precision, information) = (&likelihood.precision * (scale * scale), &likelihood.information * scale);
        let posterior = prior.posterior(&precision, &information);
        if posterior.is_finite() { Ok((likelihood, posterior)) } else { Err(undetermined()) }
    }
}

#[cfg(test)]
mod tests {
    use fmm_friction::Stribeck;
    use fmm_model::Oscillator;
    use fmm_record::{Quantity, Record};
    use fmm_sim::{Sampling, Scenario, simulate};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Normal};

    use super::*;
    use crate::experiment::Preparation;

    /// Samples at 40 kHz of a motion of 2 Hz with friction that falls over the speed, with noise of this share of the
    /// largest value.
    fn ring_down(quantity: Quantity, noise: f64) -> Experiment {
        let law = Stribeck::new(0.3, 0.4, 0.05, 2.0, 0.2).unwrap();
        let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
        let sampling = Sampling::uniform(2.5e-5, 100_000).unwrap();
        let motion = simulate(&scenario.starting_at(0.03, 0.0).unwrap(), &sampling).unwrap();
        let (samples, largest, unit) = match quantity {
            Quantity::Displacement => (motion.position(), 0.03, "m"),
            _ => (motion.velocity(), 0.35, "m/s"),
        };
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let normal = Normal::new(0.0, noise * largest).unwrap();
        let values = samples.values().iter().map(|value| value + normal.sample(&mut random)).collect();
        let record = Record::new(0.0, 2.5e-5, values, quantity, unit).unwrap();
        Experiment::ring_down(&record, &Preparation::default()).unwrap()
    }

    /// The curve does not depend on the means: a tenth of the uncertainty at most.
    #[test]
    fn means_tell_what_samples_tell() {
        for (quantity, noise) in [
            (Quantity::Velocity, 0.02),
            (Quantity::Velocity, 2e-3),
            (Quantity::Velocity, 1e-4),
            (Quantity::Displacement, 2e-3),
        ] {
            let experiments = [ring_down(quantity, noise)];
            let means = [experiments[0].averaged().unwrap()];
            let machine = Machine::per_unit_mass();
            let [few, all] = [&means, &experiments]
                .map(|of| CurveFit::of_means(Form::PerMass, &machine, &Terms::NONE, &experiments, of, None).unwrap());
            assert!(means[0].record().len() <= 50_000, "{quantity} {noise}");
            let spread = all.posterior.deviations();
            for (i, (own, other)) in few.posterior.mean().iter().zip(&all.posterior.mean()).enumerate() {
                let change = (few.scale * own / all.scale - other) / spread[i];
                assert!(change.abs() < 0.1, "{quantity} with noise of {noise}: level {i} by {change} u");
                let ratio = few.posterior.deviations()[i] * few.scale / (all.scale * spread[i]);
                assert!((ratio - 1.0).abs() < 0.02, "{quantity} with noise of {noise}: u of level {i} by {ratio}");
            }
            assert!(few.slowest < 1e-4, "samples down to {} m/s", few.slowest);
        }
    }
}
