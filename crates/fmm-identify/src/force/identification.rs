//! The fit of a law to measured forces along measured motions.

use std::fmt;

use fmm_fit::{EvaluationError, Fit, Options, Residuals, solve};
use fmm_friction::Role;

use crate::error::IdentifyError;
use crate::finding::name_width;
use crate::finding::{Finding, Origin, Source};
use crate::force::model::naming;
use crate::force::problem::ForceProblem;
use crate::force::start::starts;
use crate::force::{ForceModel, ForceRecord};
use crate::linear_algebra::inverse_of_products;
use crate::residuals::noise::{ResidualNoise, Series};
use crate::residuals::structure::{Covariance, ResidualStructure};
use crate::warning::Warning;
use crate::warning::write_warnings;

/// Friction parameters out of forces along motions, with their uncertainty.
///
/// `Display` gives the report.
#[derive(Debug, Clone)]
pub struct ForceIdentification {
    model: ForceModel,
    fit: Fit,
    findings: Vec<Finding>,
    warnings: Vec<Warning>,
    structure: ResidualStructure,
    force: f64,
    /// Units of position and of force.
    units: [String; 2],
    counted: usize,
}

/// How well a model predicts the forces of a record to which it was not fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validation {
    /// Root mean square of what it predicts less the force, in the unit of the force.
    pub rms: f64,
    /// Standard deviation of the force, in its unit.
    pub force: f64,
}

impl Validation {
    /// The one over the other (1); `None` if the force does not change.
    pub fn share(&self) -> Option<f64> {
        (self.force > 0.0).then(|| self.rms / self.force)
    }
}

/// Iterations after which a fit that has not ended is led by something else than the records.
const MOST_ITERATIONS: usize = 100;
/// What rounding of doubles alone makes of a force, as a share of its deviation (1).
const ROUNDING: f64 = 1e-9;

/// Fits `model` to the forces of `records`, which share all parameters.
///
/// Levels and what else the force is proportional to begin where a linear fit puts them, shapes where a search on a few
/// scales of the motion does. Standard uncertainties hold for noise with the correlation that the residuals show.
///
/// At rest, and between two samples with velocities of opposite signs, a law of the speed that leaps there says no more
/// than between which levels friction lies: such a sample does not count, and a static level is held at the sliding
/// one. A law with internal state says friction there too; where its bristles are at the beginning of a record is
/// fitted.
///
/// ```
/// use fmm_identify::{ForceModel, ForceRecord, identify_force};
///
/// // A slide driven to and fro, 40 mm at 0.5 Hz; 12 N and 30 N s/m of friction, and a sensor whose zero is 3 N off.
/// let times: Vec<f64> = (0..400).map(|i| 0.01 * f64::from(i)).collect();
/// let turn = std::f64::consts::PI;
/// let positions: Vec<f64> = times.iter().map(|t| 0.02 * (turn * t).sin()).collect();
/// let velocities: Vec<f64> = times.iter().map(|t| 0.02 * turn * (turn * t).cos()).collect();
/// let forces: Vec<f64> = velocities.iter().map(|v| 12.0 * v.signum() + 30.0 * v + 3.0).collect();
///
/// let record = ForceRecord::of_positions(&times, &positions, &forces)?.with_velocities(&velocities)?;
/// let found = identify_force(&ForceModel::named("coulomb + linear + zero")?, &[record])?;
/// assert!((found.finding("friction_force").unwrap().value() - 12.0).abs() < 1e-9);
/// assert!((found.finding("damping").unwrap().value() - 30.0).abs() < 1e-7);
/// assert!((found.finding("zero").unwrap().value() - 3.0).abs() < 1e-9);
/// println!("{found}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`IdentifyError::Missing`] without a record, [`IdentifyError::WrongRecord`] and [`IdentifyError::Contradiction`] if
/// the records do not go together, [`IdentifyError::TooFew`], and [`IdentifyError::Simulation`] or
/// [`IdentifyError::Fit`] if the fit cannot begin.
pub fn identify_force(model: &ForceModel, records: &[ForceRecord]) -> Result<ForceIdentification, IdentifyError> {
    let model = model.settled(records);
    let problem = ForceProblem::new(&model, records)?;
    let law = problem.law().name;
    let failure = |error: EvaluationError| IdentifyError::simulation(law, error);
    let noise = records.iter().map(ForceRecord::noise).fold(0.0, f64::max);
    let forces = deviation(records);
    let mut best: Option<Fit> = None;
    let beginnings: Option<Vec<ForceRecord>> = records.iter().map(ForceRecord::beginning).collect();
    let found = match &beginnings {
        Some(beginnings) => starts(&ForceProblem::new(&model, beginnings)?),
        None => starts(&problem),
    };
    for start in found.map_err(failure)? {
        let options = Options::default().with_max_iterations(MOST_ITERATIONS);
        let fit = solve(&problem, &start, &options).map_err(|source| IdentifyError::Fit { law, source })?;
        // What is explained to its noise has no lower minimum.
        let is_explained = !ResidualStructure::beside(&fit, noise, ROUNDING * forces).is_structured();
        if best.as_ref().is_none_or(|best| fit.sum_of_squares() < best.sum_of_squares()) {
            best = Some(fit);
        }
        if is_explained && best.as_ref().is_some_and(|best| best.outcome().is_success()) {
            break;
        }
    }
    let fit = best.ok_or_else(|| IdentifyError::missing("a model without a parameter cannot be fitted"))?;
    // Samples that do not count leave no residual, but look like rows without noise.
    let counted = problem.counted(fit.values());
    let rank = fit.rank().min(counted.saturating_sub(1));
    let spread =
        (fit.residuals().len() - fit.rank().min(fit.residuals().len())) as f64 / (counted - rank).max(1) as f64;
    let mut structure = ResidualStructure::beside(&fit, noise, ROUNDING * forces);
    structure.residual *= spread.sqrt();
    let covariance = covariance(&problem, &fit, &structure).map_err(failure)?;
    let findings = fit.estimates().iter().enumerate().map(|(index, estimate)| {
        let at_bound = estimate.status().is_at_bound();
        let variance = covariance.get(index, index).map(|variance| spread * variance);
        Finding::new(
            estimate.parameter().clone(),
            estimate.value(),
            variance.map(|variance| vec![(Source::Residuals, variance)]),
            covariance.degrees_of_freedom(index),
            Origin::Fitted(estimate.status()),
            problem.is_of_record(index),
        )
        .at_bound(
            covariance.relaxed(index).filter(|_| at_bound).map(|variance| (spread * variance).sqrt()),
            covariance.degrees_of_freedom(index),
        )
    });
    let mut findings: Vec<Finding> = findings.collect();
    findings.extend(levels_above(&problem, &fit, &covariance, spread));
    let units = [records[0].position_unit(), records[0].force_unit()].map(str::to_owned);
    let mut warnings = Vec::new();
    if structure.is_structured() {
        warnings.push(Warning::StructuredResiduals {
            residual: structure.residual,
            noise: structure.noise,
            unit: units[1].clone(),
            inflation: covariance.inflation(),
        });
    }
    warnings.extend(structure.coloured_noise(covariance.inflation()));
    Warning::of_fit(&fit, &mut warnings);
    warnings.extend(
        problem
            .law()
            .held_breakaway()
            .map(|held| Warning::StaticLevelHeld { parameter: held.parameter().name().to_owned() }),
    );
    Ok(ForceIdentification { model, fit, findings, warnings, structure, force: forces, units, counted })
}

/// What is stated as an excess over the sliding level, as the level that it makes with it; variances are larger by
/// `spread`.
fn levels_above(problem: &ForceProblem<'_>, fit: &Fit, covariance: &Covariance, spread: f64) -> Vec<Finding> {
    let law = problem.law();
    let Some(level) = law.level() else { return Vec::new() };
    let is_above = |role: Role| matches!(role, Role::LevelAbove | Role::Breakaway);
    let above = law.fitted().enumerate().filter(|(_, parameter)| is_above(parameter.role()));
    let stated = above.map(|(place, parameter)| {
        let value = fit.values()[level] + fit.values()[place];
        let variance = [(level, level), (level, place), (level, place), (place, place)]
            .iter()
            .map(|(i, j)| covariance.get(*i, *j))
            .sum::<Option<f64>>()
            .map(|variance| spread * variance);
        let (units, as_level) = naming(problem.records());
        let parameter = units.stated(parameter, as_level);
        let mut gradient = vec![0.0; fit.values().len()];
        gradient[level] = 1.0;
        gradient[place] = 1.0;
        let freedom = covariance.degrees_of_freedom_along(&gradient);
        let parts = variance.map(|variance| vec![(Source::Residuals, variance)]);
        Finding::new(parameter, value, parts, freedom, Origin::Derived, false)
    });
    stated.collect()
}

/// Covariance of the estimates by the noise that the residuals of each record show.
fn covariance(
    problem: &ForceProblem<'_>,
    fit: &Fit,
    structure: &ResidualStructure,
) -> Result<Covariance, EvaluationError> {
    let rows = problem.len();
    let mut jacobian = vec![0.0; rows * fit.values().len()];
    problem.evaluate(fit.values(), &mut vec![0.0; rows], Some(&mut jacobian))?;
    let columns: Vec<Vec<f64>> =
        Covariance::known(fit).into_iter().map(|j| jacobian[j * rows..][..rows].to_vec()).collect();
    let weights = inverse_of_products(&columns);
    let series: Vec<Series<'_>> = problem
        .series()
        .iter()
        .zip(problem.records())
        .map(|(rows, record)| Series {
            rows: rows.clone(),
            signal: None,
            period: record.period(),
            columns: &columns,
            weights: &weights,
            plateaus: Vec::new(),
        })
        .collect();
    let noise = ResidualNoise::of(fit.residuals(), &series);
    Ok(Covariance::of_noise(fit, structure, &columns, noise))
}

/// Standard deviation of the forces of all `records`, in their unit.
fn deviation(records: &[ForceRecord]) -> f64 {
    let forces = || records.iter().flat_map(ForceRecord::forces);
    let count = forces().count() as f64;
    let mean = forces().sum::<f64>() / count;
    (forces().map(|force| (force - mean).powi(2)).sum::<f64>() / count).sqrt()
}

impl ForceIdentification {
    /// Name of the model.
    pub fn model(&self) -> String {
        self.model.name()
    }

    /// The fit behind the findings.
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// Everything found.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// The finding of this name, such as `"friction_force"` or `"delay"`.
    pub fn finding(&self, name: &str) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.parameter().name() == name)
    }

    /// What limits the findings.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Root mean square of the residuals, in the unit of the force.
    pub fn rms_residual(&self) -> f64 {
        self.structure.residual
    }

    /// Standard deviation of the forces, in their unit.
    pub fn force_deviation(&self) -> f64 {
        self.force
    }

    /// Root mean square of the residuals over the standard deviation of the forces (1); `None` if these do not change.
    fn share(&self) -> Option<f64> {
        Validation { rms: self.rms_residual(), force: self.force }.share()
    }

    /// The force that was found at each sample of `record`, to which nothing is fitted but where its bristles begin;
    /// `None` where a delay asks for a motion before or after what was measured, and at a sample that [does not
    /// count](identify_force).
    ///
    /// # Errors
    /// As for [`identify_force`], of a record beside those that were fitted.
    pub fn predict(&self, record: &ForceRecord) -> Result<Vec<Option<f64>>, IdentifyError> {
        record.require_units([&self.units[0], &self.units[1]])?;
        let mut model = self.model.clone();
        for finding in self.findings.iter().filter(|finding| !finding.is_of_record()) {
            if matches!(finding.origin(), Origin::Fitted(_)) {
                model = model.holding(finding.parameter().name(), finding.value())?;
            }
        }
        let records = std::slice::from_ref(record);
        let problem = ForceProblem::new(&model, records)?;
        let law = problem.law().name;
        let mut values = self.fit.values()[..problem.parameters().len()].to_vec();
        for (place, deflection) in problem.first_deflections() {
            values[place] = deflection;
        }
        if values.iter().zip(problem.parameters()).any(|(_, parameter)| !parameter.bounds().is_fixed()) {
            let fit = solve(&problem, &values, &Options::default());
            values = fit.map_err(|source| IdentifyError::Fit { law, source })?.values().to_vec();
        }
        let predicted = problem.predicted(0, &values).map_err(|error| IdentifyError::simulation(law, error))?;
        let mut all = vec![None; record.len()];
        all[problem.rows()[0].clone()].copy_from_slice(&predicted);
        Ok(all)
    }

    /// How well it predicts the forces of a record to which it was not fitted.
    ///
    /// # Errors
    /// As for [`identify_force`], and [`IdentifyError::NotSeen`] if no sample of it counts.
    pub fn validate_on(&self, record: &ForceRecord) -> Result<Validation, IdentifyError> {
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

impl fmt::Display for ForceIdentification {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fit = self.fit();
        writeln!(f, "Force along a motion by {}", self.model())?;
        writeln!(
            f,
            "  {}; {} samples, rank {} of {}, rms residual {:.4e} {}{}",
            fit.outcome(),
            self.counted,
            fit.rank(),
            fit.free_count(),
            self.rms_residual(),
            self.units[1],
            self.share().map_or_else(String::new, |share| format!(", {:.1} % of the force", 100.0 * share))
        )?;
        let width = name_width(self.findings());
        for finding in self.findings() {
            writeln!(f, "  {:<width$} = {finding}", finding.parameter().name())?;
        }
        write_warnings(f, self.warnings())
    }
}
