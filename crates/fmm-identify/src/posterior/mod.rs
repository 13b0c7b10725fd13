//! Posterior of an identification: probable values of all its findings.

mod intervals;
mod predictive;
mod report;
#[cfg(feature = "serde")]
mod serialised;

pub use intervals::IntervalComparison;
pub use predictive::PredictiveCheck;

use fmm_fit::FitError;
use fmm_fit::posterior::{Marginal, Posterior, Sampler};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::experiment::clock::Clock;
use crate::finding::Origin;
use crate::identification::Identification;
use crate::posterior::intervals::{LEVEL, compared};
use crate::posterior::predictive::predicted;
use crate::quantities::derived::values_of_findings;

/// The posterior of all findings of an identification beside the intervals of other kinds, with predictive checks.
///
/// The parameters of the fit have flat priors within their bounds unless the [`Sampler`] has others. Mass, stiffness,
/// load and gains have normal priors by the standard uncertainties of the [`Machine`](crate::Machine) and of the
/// records.
///
/// `Display` gives the report.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentificationPosterior {
    law: String,
    posterior: Posterior,
    findings: Vec<Marginal>,
    intervals: Vec<IntervalComparison>,
    checks: Vec<PredictiveCheck>,
}

impl IdentificationPosterior {
    /// Name of the law, with the terms beside it.
    pub fn law(&self) -> &str {
        &self.law
    }

    /// The posterior of the parameters of the fit and of the noise, with its warnings.
    pub fn posterior(&self) -> &Posterior {
        &self.posterior
    }

    /// The marginal posterior of each finding that is not held, in the order of the
    /// [findings](Identification::findings).
    pub fn findings(&self) -> &[Marginal] {
        &self.findings
    }

    /// The marginal posterior of the finding of this name, such as `"mu"`.
    pub fn finding(&self, name: &str) -> Option<&Marginal> {
        self.findings.iter().find(|marginal| marginal.parameter().name() == name)
    }

    /// The 95 % intervals of each finding that all records share: by its standard uncertainty, from the profile, from
    /// the posterior.
    pub fn intervals(&self) -> &[IntervalComparison] {
        &self.intervals
    }

    /// All intervals agree: value ± u is enough.
    pub fn agrees(&self) -> bool {
        self.intervals.iter().all(IntervalComparison::agrees)
    }

    /// Features of records from the posterior beside the measured ones; empty for driven motions.
    pub fn checks(&self) -> &[PredictiveCheck] {
        &self.checks
    }
}

impl Identification {
    /// The request for a posterior that suits the residuals of this identification: correlated ones if neighbours are
    /// alike.
    pub fn sampler(&self) -> Sampler {
        let sampler = Sampler::default();
        if self.structure.is_correlated() { sampler.with_correlated_residuals() } else { sampler }
    }

    /// The posterior of everything found, for the `experiments` of the identification; see [`sampler`](Self::sampler).
    ///
    /// ```
    /// # use fmm_friction::CoulombViscous;
    /// # use fmm_identify::{Experiment, Machine, Preparation, identify};
    /// # use fmm_model::Oscillator;
    /// # use fmm_record::{Quantity, Record};
    /// # use fmm_sim::{Engine, Exact, Sampling, Scenario};
    /// # let scenario = Scenario::new(Oscillator::per_unit_mass(2.0)?, CoulombViscous::new(0.3, 0.05)?, 1.0)?;
    /// # let motion = Exact.run(&scenario.starting_at(0.02, 0.0)?, &Sampling::uniform(1e-3, 2000)?)?;
    /// # let noise = |i: usize| 1e-3 * ((i * i) as f64 * 0.618_034).sin();
    /// # let velocity = motion.velocity().values().iter().enumerate().map(|(i, v)| v + noise(i)).collect();
    /// let record = Record::new(0.0, 1e-3, velocity, Quantity::Velocity, "m/s")?; // F/m = 0.3 m/s²
    /// let decays = [Experiment::ring_down(&record, &Preparation::default())?];
    /// let found = identify::<CoulombViscous>(&Machine::per_unit_mass(), &decays)?;
    /// let posterior = found.posterior(&decays, &found.sampler().with_draws(250))?;
    ///
    /// let friction = posterior.finding("friction_per_mass").expect("the law has it");
    /// assert!((friction.mean() - 0.3).abs() < 3.0 * friction.standard_deviation());
    /// println!("{posterior}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::Posterior`] if there is no posterior, and errors as for [`identify`](crate::identify) if the
    /// `experiments` are others than those of the identification.
    pub fn posterior(
        &self,
        experiments: &[Experiment],
        sampler: &Sampler,
    ) -> Result<IdentificationPosterior, IdentifyError> {
        let profiles = self.profiles(experiments, LEVEL)?;
        let experiments = self.experiments(experiments)?;
        let problem = self.problem(&experiments)?;
        let failed = |source: FitError| IdentifyError::Posterior { law: self.law().to_owned(), source };
        let posterior = sampler.sample(&problem, self.fit()).map_err(failed)?;
        let gain = experiments.iter().map(|experiment| experiment.summary().gain_uncertainty).fold(0.0, f64::max);
        let clock = Clock::of(&experiments);
        let mut random = ChaCha8Rng::seed_from_u64(sampler.seed());
        // Behind the streams of the chains.
        random.set_stream(u64::MAX);
        // Scale, load and gain multiply the fitted values; inputs of the motion itself are among the draws.
        let with_known = |draw: &[f64]| {
            let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
            // A gain that is wrong by more than its own size is no gain.
            let gain = (1.0 + gain * normal()).max(f64::EPSILON);
            let machine = self.machine().with_scale_and_load_moved([normal(), normal()]);
            let pace =
                if clock.uncertainty > 0.0 { (1.0 + clock.uncertainty * normal()).max(f64::EPSILON) } else { 1.0 };
            let table = &problem.table;
            let by_clock =
                |(index, value): (usize, &f64)| value * pace.powf(table.power_of_clock(index, draw, clock.order));
            let draw: Vec<f64> = draw.iter().enumerate().map(by_clock).collect();
            values_of_findings(self.findings(), &machine, table, &draw, gain)
        };
        let draws: Vec<Vec<f64>> = posterior.draws().map(with_known).collect();
        let is_fixed = |origin: Origin| origin == Origin::Fitted(fmm_fit::EstimateStatus::Fixed);
        let mut findings = Vec::new();
        for (index, finding) in self.findings().iter().enumerate().filter(|(_, finding)| !is_fixed(finding.origin())) {
            let values = draws.iter().map(|draw| draw[index]).collect();
            findings.extend(Marginal::new(finding.parameter().clone(), values, posterior.chains()));
        }
        let intervals = compared(self, &profiles, &findings);
        let checks = predicted(&problem, &posterior, &mut random)
            .map_err(|error| IdentifyError::simulation(problem.name(), error))?;
        Ok(IdentificationPosterior { law: self.law().to_owned(), posterior, findings, intervals, checks })
    }
}
