//! Friction parameters of one law out of blows.

use std::ops::ControlFlow;

use fmm_fit::{EvaluationError, Fit};
use fmm_friction::{Coulomb, LawFamily, Role};

use crate::error::IdentifyError;
use crate::experiment::{ImpactSummary, ImpactTrial};
use crate::finding::Source;
use crate::finding::{Finding, Origin};
use crate::fit::stages::best_fit;
use crate::identification::FittedMotion;
use crate::impact::covariance::ImpactCovariance;
use crate::impact::parameters::{DAMPING, LAW, LOAD, MASS, RESPONSE_GAIN, STIFFNESS};
use crate::impact::simulation::ImpactLaw;
use crate::impact::{ImpactDomain, ImpactMachine, ImpactOptions, ImpactProblem, warnings};
use crate::law::dimension::is_coefficient;
use crate::law::naming::{Level, Units};
use crate::warning::Warning;

/// Friction parameters of one law out of blows, with their uncertainty and what limits them.
///
/// `Display` gives the report.
#[derive(Debug, Clone)]
pub struct ImpactIdentification {
    law: ImpactLaw,
    machine: ImpactMachine,
    options: ImpactOptions,
    fit: Fit,
    findings: Vec<Finding>,
    trials: Vec<ImpactSummary>,
    motions: Vec<FittedMotion>,
    closed_forms: Vec<Option<f64>>,
    warnings: Vec<Warning>,
    residual: f64,
    chi: f64,
}

/// Identifies the parameters of law family `F` from blows on one machine.
///
/// No start values are needed: they come from the height of the receptance peaks ([`ImpactProblem::closed_form`]). Laws
/// with more than one level continue a fit of dry friction; a fit to the time record continues one to the mobility,
/// which is quick.
///
/// Standard uncertainties hold the noise of the velocity, as the residuals show it; what the samples of the force leave
/// open of each pulse, and the calibration of the hammer, as far as the motion does not tell; and the uncertainty of
/// everything held: mass, stiffness, damping and load of the machine, the calibration of the velocity channel, and the
/// offset taken from each velocity (JCGM 100:2008, 5.1.2).
///
/// A decay shows friction with little help of the impulse, so that a coarse pulse or a hammer of unknown calibration
/// widens the uncertainty of friction twofold at most; mass and load set its scale.
///
/// # Errors
/// As for [`ImpactProblem::new`], and [`IdentifyError::Fit`] if the fit cannot begin. How it *ends* is in the result.
///
/// ```
/// use fmm_friction::Coulomb;
/// use fmm_identify::{ImpactMachine, ImpactOptions, ImpactTrial, Known, identify_impact};
/// use fmm_record::{Quantity, Record};
/// # use fmm_model::{Damping, Oscillator};
/// # use fmm_sim::{Engine, Exact, Excitation, Sampling, Scenario};
///
/// // A blow of 450 N and 3.4 ms on the machine of the thesis, μ = 0.113 under 6.67 N; 3 s at 10 kHz. Here it is simulated.
/// # let pulse = |i: i32| (f64::from(i - 100) / 34.0 * std::f64::consts::PI).sin() * 453.0;
/// # let force: Vec<f64> = (0..30_000).map(|i| if (100..=134).contains(&i) { pulse(i) } else { 0.0 }).collect();
/// # let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::linear(0.275)?);
/// # let scenario = Scenario::new(machine, Coulomb::new(0.113)?, 6.67)?;
/// # let scenario = scenario.driven_by(Excitation::sampled_force(1e-4, force.clone())?);
/// # let velocity = Exact.run(&scenario, &Sampling::uniform(1e-4, 30_000)?)?.velocity().values().to_vec();
/// let force = Record::new(0.0, 1e-4, force, Quantity::Force, "N")?;
/// let velocity = Record::new(0.0, 1e-4, velocity, Quantity::Velocity, "m/s")?;
/// let trial = ImpactTrial::prepare(&force, &velocity)?;
///
/// let machine = ImpactMachine::new(Known::exact(10.391)?, Known::exact(1982.0)?)?
///     .with_damping(Known::exact(0.275)?)?
///     .with_normal_load(Known::new(6.67, 0.01)?)?;
/// let found = identify_impact::<Coulomb>(&machine, &[trial], &ImpactOptions::default())?;
/// let mu = found.finding("coefficient").unwrap();
/// assert!((mu.value() - 0.113).abs() < 1e-8);
/// // Only μ N shows in the motion, so that u(μ)/μ = u(N)/N.
/// assert!((mu.uncertainty().unwrap() - 0.113 * 0.01 / 6.67).abs() < 1e-6);
/// assert!(found.finding("friction_force").unwrap().uncertainty().unwrap() < 1e-6);
/// println!("{found}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify_impact<F: LawFamily>(
    machine: &ImpactMachine,
    trials: &[ImpactTrial],
    options: &ImpactOptions,
) -> Result<ImpactIdentification, IdentifyError> {
    identify_by(ImpactLaw::of::<F>(), machine, trials, options)
}

fn identify_by(
    law: ImpactLaw,
    machine: &ImpactMachine,
    trials: &[ImpactTrial],
    options: &ImpactOptions,
) -> Result<ImpactIdentification, IdentifyError> {
    let problem = ImpactProblem::of(law, machine, trials, options)?;
    let fit = fit_in_stages(&problem, options)?;
    let failure = |error: EvaluationError| IdentifyError::simulation(problem.law().name, error);
    let motion = |trial: usize| {
        let trajectory = problem.motion(trial, fit.values())?;
        Ok(FittedMotion::of_events(trials[trial].summary().begin, trials[trial].interval(), &trajectory))
    };
    let motions = (0..trials.len()).map(motion).collect::<Result<Vec<_>, _>>().map_err(failure)?;
    let closed_forms = (0..trials.len()).map(|trial| problem.closed_form(trial)).collect();
    let covariance =
        ImpactCovariance::of(problem.fitting(options.domain), &fit, options.force_gain_uncertainty).map_err(failure)?;
    let findings = findings(&problem, &fit, &covariance);
    let friction = problem.law().level().map(|level| fit.values()[LOAD] * fit.values()[LAW + level]);
    let warnings = warnings::of(&fit, &covariance, trials, &motions, friction);
    Ok(ImpactIdentification {
        law,
        machine: *machine,
        options: options.clone(),
        fit,
        findings,
        trials: trials.iter().map(|trial| trial.summary().clone()).collect(),
        motions,
        closed_forms,
        warnings,
        residual: covariance.residual,
        chi: covariance.remainder / covariance.noise,
    })
}

/// Searches in the band, where residuals are few, and ends in the domain asked for.
fn fit_in_stages(problem: &ImpactProblem<'_>, options: &ImpactOptions) -> Result<Fit, IdentifyError> {
    let mut observe = |_: &fmm_fit::Progress<'_>| ControlFlow::Continue(());
    let mut coefficient = problem.coefficient_without_fit();
    let band = problem.fitting(ImpactDomain::Mobility);
    let name = problem.law().name;
    if problem.law().fitted().count() > 1 {
        // The best dry friction is a better begin for other laws than the closed form, which has errors of its own.
        let dry = ImpactOptions { band: options.band, ..ImpactOptions::default() };
        let dry = ImpactProblem::new::<Coulomb>(problem.machine(), problem.trials(), &dry)?;
        if let Ok(fit) = best_fit(&dry, dry.law().name, &dry.starts(coefficient), &options.solver, &mut observe) {
            coefficient = fit.values()[LAW];
        }
    }
    let starts = problem.starts(coefficient);
    let found = best_fit(&band, name, &starts, &options.solver, &mut observe);
    match (problem.domain(), found) {
        (ImpactDomain::Mobility, found) => found,
        (_, Ok(found)) => best_fit(problem, name, &[found.values().to_vec()], &options.solver, &mut observe),
        // A band of few lines may not determine what the time record does.
        (_, Err(_)) => best_fit(problem, name, &starts, &options.solver, &mut observe),
    }
}

/// What was found and what was held of the machine, then what follows.
fn findings(problem: &ImpactProblem<'_>, fit: &Fit, covariance: &ImpactCovariance) -> Vec<Finding> {
    let layout = problem.layout();
    let mut findings = Vec::new();
    let freedom = covariance.degrees_of_freedom();
    let law = LAW..layout.shared;
    let machine = [DAMPING, MASS, STIFFNESS, LOAD];
    let others = std::iter::once(RESPONSE_GAIN).chain(layout.shared..layout.all.len());
    let others = others.filter(|&index| !layout.is_held(index) && !layout.has_prior[index]);
    for index in law.clone().chain(machine).chain(others) {
        let estimate = &fit.estimates()[index];
        let variances = if layout.is_held(index) {
            problem.known(index).map(|known| (0.0, known.uncertainty().powi(2)))
        } else {
            covariance.variances(index)
        };
        let (parameter, origin) = (estimate.parameter().clone(), Origin::Fitted(estimate.status()));
        let parts = variances.map(told_apart);
        findings.push(Finding::new(parameter, estimate.value(), parts, freedom, origin, index >= layout.shared));
    }
    let is_one = |index: usize| layout.values[index] == 1.0 && layout.uncertainties[index] == 0.0;
    if layout.is_held(LOAD) && !is_one(LOAD) {
        for (index, parameter) in law.zip(problem.law().fitted()) {
            if matches!(parameter.role(), Role::Level | Role::Excess) && is_coefficient(parameter) {
                let value = fit.values()[LOAD] * fit.values()[index];
                let variances = covariance.variances_times_load(index, fit.values());
                let force = Units::new("m", "N").stated(parameter, Level::Force);
                let parts = variances.map(told_apart);
                findings.push(Finding::new(force, value, parts, freedom, Origin::Derived, false));
            }
        }
    }
    findings
}

/// The variance by the residuals, and the rest of that of `all`.
fn told_apart((random, all): (f64, f64)) -> Vec<(Source, f64)> {
    vec![(Source::Residuals, random), (Source::Held, (all - random).max(0.0))]
}

impl ImpactIdentification {
    /// Name of the law.
    pub fn law(&self) -> &'static str {
        self.law.name()
    }

    /// What was known of the machine.
    pub fn machine(&self) -> &ImpactMachine {
        &self.machine
    }

    /// How it was fitted.
    pub fn options(&self) -> &ImpactOptions {
        &self.options
    }

    /// The fit behind the findings. Its own uncertainties are those of independent residuals, and all else known
    /// exactly.
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// What was found: parameters of the law, the machine, whatever else was set free, and what follows from them.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// The finding of this name, such as `"coefficient"` or `"friction_force"`.
    pub fn finding(&self, name: &str) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.parameter().name() == name)
    }

    /// The interval that covers the finding of this name with probability `level`, [`Finding::interval`].
    pub fn interval(&self, name: &str, level: f64) -> Option<(f64, f64)> {
        self.finding(name)?.interval(level)
    }

    /// What each trial is and what was done to it.
    pub fn trials(&self) -> &[ImpactSummary] {
        &self.trials
    }

    /// The fitted motion of each trial, on the time axis of its record.
    pub fn motions(&self) -> &[FittedMotion] {
        &self.motions
    }

    /// For each trial the friction force (N) that its receptance peak gives without a fit,
    /// [`ImpactProblem::closed_form`].
    pub fn closed_forms(&self) -> &[Option<f64>] {
        &self.closed_forms
    }

    /// What limits the findings.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Root mean square of the residuals (m/s), of samples or of scaled lines.
    pub fn rms_residual(&self) -> f64 {
        self.residual
    }

    /// χ (1), what remains of the residuals by the noise of the velocity, when the pulses and all that was held may be
    /// off within what is known of them: about 1 if the law describes the blows. Of a time record it is that of all
    /// samples or of the lines in the band, whichever is larger.
    pub fn chi(&self) -> f64 {
        self.chi
    }

    /// Velocity (m/s) that the law gives for every sample of `trial`, which must be one of the `trials` of the
    /// identification; `None` for another number.
    pub fn model(&self, trials: &[ImpactTrial], trial: usize) -> Option<Vec<f64>> {
        if trial >= trials.len() || trials.len() != self.trials.len() {
            return None;
        }
        let problem = ImpactProblem::of(self.law, &self.machine, trials, &self.options).ok()?;
        problem.model(trial, self.fit.values()).ok()
    }
}
