//! Identification of forces along motions, and the forces that it predicts.

use fmm_fit::{EvaluationError, Fit, Options, Residuals, solve};

use crate::error::IdentifyError;
use crate::experiment::force::{AveragedNoise, ForceRecord, deviation};
use crate::finding::{Finding, Source};
use crate::identification::Identification;
use crate::problem::Problem;
use crate::problem::force::ForceProblem;
use crate::problem::tangent::Tangent;
use crate::warning::Warning;

/// Results of a fit to forces, beside those of every identification.
#[derive(Debug, Clone)]
pub(super) struct ForceResults {
    /// Standard deviation of the forces, in their unit.
    pub(super) deviation: f64,
    /// Units of position and of force.
    units: [String; 2],
    /// One flag per residual: it counts.
    counts: Vec<bool>,
    /// Samples of all records that have a residual, and the number of all samples.
    places: Vec<usize>,
    samples: usize,
    /// Friction in the mean of the way of the record that a force drives, in the unit of the force, if there is one.
    driving: Option<f64>,
    /// The largest noise of the motions that was averaged, if there was any.
    noise_of_motion: Option<AveragedNoise>,
    /// Root mean square of the force that this leaves in the residuals.
    by_motion: f64,
    /// Degrees of freedom of all residuals over those of the counting ones (1).
    pub(super) spread: f64,
}

/// Residuals over those that noise explains (1) up to which a law leaves nothing out.
const EXPLAINED: f64 = 1.5;

/// Agreement of a model with the forces of a record to which it was not fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validation {
    /// Root mean square of the predicted force less the measured one, in the unit of the force.
    pub rms: f64,
    /// Standard deviation of the force, in its unit; of a motion that goes one way, its root mean square.
    pub force: f64,
}

impl Validation {
    /// The one over the other (1); `None` if the force does not change.
    pub fn share(&self) -> Option<f64> {
        (self.force > 0.0).then(|| self.rms / self.force)
    }

    /// The warning about a prediction by `law` that is no better than none, if it is not.
    pub fn warning(&self, law: &str) -> Option<Warning> {
        self.worse_than_none(law, false)
    }

    fn worse_than_none(&self, law: &str, is_fitted: bool) -> Option<Warning> {
        let share = self.share().filter(|share| *share >= 1.0)?;
        Some(Warning::WorseThanNone { law: law.to_owned(), share, is_fitted })
    }
}

impl ForceResults {
    /// Those of a `fit` of `forces`.
    pub(super) fn of(forces: &ForceProblem<'_>, fit: &Fit, motion: &MotionNoise) -> Self {
        let (counts, records) = (forces.counts(fit.values()), forces.records());
        // Samples that do not count leave no residual, but look like rows without noise.
        let (all, counted) = (counts.len(), counts.iter().filter(|counts| **counts).count());
        let rank = fit.rank().min(counted.saturating_sub(1));
        let spread = (all - fit.rank().min(all)) as f64 / (counted - rank).max(1) as f64;
        let units = [records[0].position_unit(), records[0].force_unit()].map(str::to_owned);
        let (mut places, mut samples) = (Vec::with_capacity(all), 0);
        for (record, compared) in records.iter().zip(&forces.forces.samples) {
            places.extend(compared.clone().map(|row| samples + row));
            samples += record.len();
        }
        let driving = records.iter().find_map(ForceRecord::driving_friction);
        let noise_of_motion = forces.noise_of_motion();
        let (deviation, by_motion) = (deviation(records), motion.residual);
        Self { deviation, units, counts, places, samples, driving, noise_of_motion, by_motion, spread }
    }

    /// The `residuals` that count, each at its sample among those of all records.
    pub(super) fn at_samples(&self, residuals: &[f64]) -> Vec<Option<f64>> {
        let mut all = vec![None; self.samples];
        for ((place, residual), counts) in self.places.iter().zip(residuals).zip(&self.counts) {
            all[*place] = counts.then_some(*residual);
        }
        all
    }

    /// Samples of all records that have a residual.
    pub(super) fn places(&self) -> &[usize] {
        &self.places
    }
}

/// Effect of the noise of a measured motion, and of its averaging, on a fit of forces: it bends what is not
/// proportional to the motion, turns directions, and makes factors too small where squares of it are summed.
#[derive(Debug, Clone, Default)]
pub(super) struct MotionNoise {
    /// Steps by which the fit would follow the other motions that the records may be along, all values each; their
    /// squares are summed.
    steps: Vec<Vec<f64>>,
    /// Root mean square of the force that it leaves in the residuals.
    residual: f64,
}

impl MotionNoise {
    /// Noise of the motion in a `fit` of `problem`; none for vibrations.
    pub(super) fn of(problem: &Problem<'_>, fit: &Fit) -> Self {
        let Some(forces) = problem.forces() else { return Self::default() };
        let others: Vec<Vec<(f64, ForceRecord)>> = forces.records().iter().map(ForceRecord::along_others).collect();
        let own = Tangent::of(problem, fit).map(|tangent| tangent.all_steps(fit.residuals()));
        let (Some(own), Some(count)) = (own, others.iter().map(Vec::len).max()) else { return Self::default() };
        let mut noise = Self::default();
        for number in 0..count {
            let weight = others.iter().filter_map(|of| of.get(number)).map(|(weight, _)| *weight).fold(0.0, f64::max);
            let pairs = others.iter().zip(forces.records());
            let records: Vec<ForceRecord> =
                pairs.map(|(of, own)| of.get(number).map_or(own, |(_, other)| other).clone()).collect();
            let Some((steps, residuals)) = along(problem, fit, &records) else { continue };
            let steps: Vec<f64> = steps.iter().zip(&own).map(|(step, own)| weight * (step - own)).collect();
            let changes = residuals.iter().zip(fit.residuals()).map(|(other, own)| (weight * (other - own)).powi(2));
            let change = changes.sum::<f64>() / residuals.len() as f64;
            if change.is_finite() && steps.iter().all(|step| step.is_finite()) {
                noise.residual = noise.residual.hypot(change.sqrt());
                noise.steps.push(steps);
            }
        }
        noise
    }

    /// Standard uncertainty by it of what has this `gradient` over the first of the fitted values.
    pub(super) fn along(&self, gradient: &[f64]) -> f64 {
        let along = |steps: &Vec<f64>| steps.iter().zip(gradient).map(|(step, slope)| step * slope).sum::<f64>();
        self.steps.iter().map(|steps| along(steps).powi(2)).sum::<f64>().sqrt()
    }
}

/// The steps by which a `fit` of `problem` would follow these `records` in the place of its own, and its residuals.
fn along(problem: &Problem<'_>, fit: &Fit, records: &[ForceRecord]) -> Option<(Vec<f64>, Vec<f64>)> {
    let problem = Problem::of(&problem.candidate(), problem.machine, records).ok()?;
    let mut residuals = vec![0.0; problem.len()];
    problem.evaluate(fit.values(), &mut residuals, None).ok()?;
    Some((Tangent::of(&problem, fit)?.all_steps(&residuals), residuals))
}

impl Warning {
    /// Limits of an `identification` of forces in this `unit`.
    pub(super) fn of_force(identification: &Identification, unit: &str) -> Vec<Self> {
        let (structure, inflation) = (identification.structure, identification.covariance.inflation);
        let mut warnings = Vec::new();
        if let Some(forces) = &identification.forces {
            let driving = forces.driving.map(|friction| Self::DrivesMotion { friction, unit: unit.to_owned() });
            warnings.extend(driving);
            let fitted = Validation { rms: identification.rms_residual(), force: forces.deviation };
            warnings.extend(fitted.worse_than_none(identification.law(), true));
            warnings.extend(Self::of_motion_noise(identification, forces.noise_of_motion));
        }
        let forces = identification.forces.as_ref();
        let by_motion = forces.map_or(0.0, |forces| forces.by_motion);
        // What noise of the motion leaves is nothing that the law leaves out.
        if structure.is_structured() && structure.residual > EXPLAINED * by_motion.hypot(structure.noise) {
            let (residual, noise, unit) = (structure.residual, structure.noise, unit.to_owned());
            warnings.push(Self::StructuredResiduals { residual, noise, unit, inflation });
        }
        warnings.extend(structure.coloured_noise(inflation));
        Self::of_fit(identification.fit(), &mut warnings);
        warnings
    }

    /// Warning about `noise` of the motion, or about samples that are too far apart, on which findings are more
    /// uncertain than by the residuals, if any is.
    fn of_motion_noise(identification: &Identification, noise: Option<AveragedNoise>) -> Option<Self> {
        let findings = identification.findings.iter();
        let rests_on = |finding: &&Finding| finding.part(Source::Motion) > finding.part(Source::Residuals);
        let names: Vec<&str> = findings.filter(rests_on).map(|finding| finding.parameter().name()).collect();
        let parameters = names.join(", ");
        (!names.is_empty()).then_some(match noise {
            Some(AveragedNoise { quantity, share, samples }) => {
                Self::NoisyMotion { quantity, share, samples, parameters }
            }
            None => Self::CoarseMotion { parameters },
        })
    }
}

impl Identification {
    /// Unit of the force; `None` for an identification of vibrations.
    pub(crate) fn force_unit(&self) -> Option<&str> {
        self.forces.as_ref().map(|forces| forces.units[1].as_str())
    }

    /// One flag per residual: it counts; `None` if all do.
    pub(super) fn counts(&self) -> Option<&[bool]> {
        self.forces.as_ref().map(|forces| forces.counts.as_slice())
    }

    /// The residual at each sample of the records; `None` where a force along a motion has none that counts.
    pub(super) fn residuals_at_samples(&self) -> Vec<Option<f64>> {
        let residuals = self.fit().residuals();
        let all = || residuals.iter().copied().map(Some).collect();
        self.forces.as_ref().map_or_else(all, |forces| forces.at_samples(residuals))
    }

    /// The sample of each residual among those of the records; `None` if each has one.
    pub(super) fn places(&self) -> Option<&[usize]> {
        self.forces.as_ref().map(ForceResults::places)
    }

    /// Degrees of freedom of all residuals over those of the counting ones (1).
    pub(super) fn spread(&self) -> f64 {
        self.forces.as_ref().map_or(1.0, |forces| forces.spread)
    }

    /// Root mean square of the residuals over the standard deviation of the forces along motions (1), or over their
    /// root mean square if all go one way; `None` for an identification of vibrations, or if the forces do not change.
    pub fn share_of_force(&self) -> Option<f64> {
        let force = self.forces.as_ref()?.deviation;
        Validation { rms: self.rms_residual(), force }.share()
    }

    /// Force of the model at each sample of `record`, in its unit. Nothing is fitted to the record but the deflection
    /// of the bristles at its beginning.
    ///
    /// `None` stands at a sample that needs a motion before or after the measured one for its delay, and at one where
    /// the contact rests or turns and the law, a leap between two levels, has no value.
    ///
    /// # Errors
    /// [`IdentifyError::Contradiction`] for an identification of vibrations, [`IdentifyError::WrongRecord`] for a
    /// record in other units, with other channels or with a load in one of the two only, and as for
    /// [`identify`](crate::identify).
    pub fn predict(&self, record: &ForceRecord) -> Result<Vec<Option<f64>>, IdentifyError> {
        let forces = self.forces.as_ref().ok_or_else(|| {
            IdentifyError::contradiction("an identification of vibrations predicts no force along a motion")
        })?;
        record.require_units([&forces.units[0], &forces.units[1]])?;
        let (law, fit) = (self.family(), self.fit());
        let failure = |error: EvaluationError| IdentifyError::simulation(law.name, error);
        let problem = self.problem(std::slice::from_ref(record))?;
        let shared = problem.table.shared;
        let mut pairs = problem.parameters().iter().zip(fit.estimates()).take(shared);
        if let Some((own, fitted)) = pairs.find(|(own, fitted)| own.name() != fitted.name()) {
            return Err(IdentifyError::wrong_record(format!(
                "the record has the quantity {} in place of {}: give loads and channels as with the records of the \
                 identification",
                own.name(),
                fitted.name()
            )));
        }
        let problem = problem.with_shared(fit.values())?;
        let Some(forces) = problem.forces() else { return Ok(Vec::new()) };
        let mut values = fit.values()[..problem.parameters().len()].to_vec();
        for (place, deflection) in forces.first_deflections() {
            values[place] = deflection;
        }
        if values.len() > shared {
            let fit = solve(&problem, &values, &Options::default());
            values = fit.map_err(|source| IdentifyError::Fit { law: law.name, source })?.values().to_vec();
        }
        let mut residuals = vec![0.0; problem.len()];
        problem.evaluate(&values, &mut residuals, None).map_err(failure)?;
        let samples = forces.forces.samples[0].clone();
        let measured = residuals.iter().zip(&record.forces()[samples.clone()]).zip(forces.counts(&values));
        let predicted = measured.map(|((residual, force), counts)| counts.then_some(residual + force));
        let mut all = vec![None; record.len()];
        all[samples].iter_mut().zip(predicted).for_each(|(out, force)| *out = force);
        Ok(all)
    }

    /// Agreement with the forces of a record to which it was not fitted.
    ///
    /// # Errors
    /// Those of [`predict`](Self::predict), and [`IdentifyError::NotSeen`] if no sample of the record counts.
    pub fn validate(&self, record: &ForceRecord) -> Result<Validation, IdentifyError> {
        let predicted = self.predict(record)?;
        let both = || predicted.iter().zip(record.forces()).filter_map(|(said, force)| Some(((*said)?, *force)));
        if both().next().is_none() {
            return Err(IdentifyError::not_seen(
                "the contact slides at no sample of the record, so that the model predicts no force",
            ));
        }
        let squares: f64 = both().map(|(said, force)| (said - force).powi(2)).sum();
        let rms = (squares / both().count() as f64).sqrt();
        Ok(Validation { rms, force: deviation(std::slice::from_ref(record)) })
    }
}
