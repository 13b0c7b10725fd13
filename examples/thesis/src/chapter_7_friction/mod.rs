//! Chapter 7: four laws of friction, their tables and curves.
//!
//! No raw data are published. What a table says is taken as the truth of a simulated ring-down, which is then fitted as
//! in the thesis, but with the motion located exactly and the initial velocity free. Where the thesis' own program does
//! something else than the thesis says, both are computed.

mod acceleration;
mod berger;
mod coulomb;
mod loads;
mod power_law;
mod tanh;

use fmm_fit::{Estimate, Fit, Options, solve};
use fmm_friction::LawFamily;
use fmm_identify::Problem;
use fmm_model::Bounds;
use fmm_record::Record;
use fmm_sim::Sampling;

use crate::ring_down::{INTERVAL, Viscous, machine, motion, over_time, scenario, velocity_record, with_noise};
use crate::{Chapter, Found, Settings, printed};
use fmm_cli::figure::{Panel, Role};

/// The numbers of chapter 7 beside ours.
///
/// # Errors
/// If a simulation or a fit cannot be done.
pub fn chapter(settings: &Settings<'_>) -> Found<Chapter> {
    let mut chapter = Chapter::new("7 Friction");
    loads::add(&mut chapter)?;
    settings.done(0.05);
    coulomb::add(&mut chapter, settings)?;
    settings.done(0.35);
    power_law::add(&mut chapter)?;
    acceleration::add(&mut chapter, settings)?;
    settings.done(0.5);
    berger::add(&mut chapter, settings)?;
    settings.done(0.85);
    tanh::add(&mut chapter, settings)?;
    settings.done(1.0);
    Ok(chapter)
}

/// Normal load that Table 4 goes with (N).
const LOAD_4: f64 = printed::LOADS[0];
/// Normal load that Table 5 goes with (N).
const LOAD_5: f64 = printed::LOADS[1];

/// Law, machine, load and release of a ring-down.
#[derive(Debug, Clone, Copy)]
struct Release<'a> {
    viscous: Viscous,
    /// Values of the law's parameters.
    law: &'a [f64],
    /// Normal load (N).
    load: f64,
    /// Initial displacement (mm).
    displacement: f64,
}

impl Release<'_> {
    /// Highest velocity after the release (m/s).
    fn peak<F: LawFamily>(&self) -> Found<f64> {
        // Within half a step of the top the velocity is lower by (ω h)²/8, 2e-7 of it.
        let sampling = Sampling::uniform(1e-4, 2000)?;
        Ok(motion::<F>(&self.scenario::<F>()?, &sampling)?.velocity().values().iter().copied().fold(0.0, f64::max))
    }

    /// Velocity (m/s) at 1 kHz from the highest sample on, as the thesis cuts its records, until it has rested for 0.1
    /// s.
    fn velocity<F: LawFamily>(&self) -> Found<Vec<f64>> {
        let sampling = Sampling::uniform(INTERVAL, 2500)?;
        let motion = motion::<F>(&self.scenario::<F>()?, &sampling)?;
        let values = motion.velocity().values();
        let highest = (0..values.len()).max_by(|&i, &j| values[i].total_cmp(&values[j])).unwrap_or(0);
        let rest = motion.rest().ok_or("the contact does not stop the motion")?.time;
        let end = ((rest + 0.1) / INTERVAL) as usize;
        Ok(values[highest..end.min(values.len())].to_vec())
    }

    /// [`velocity`](Self::velocity) as a record with white noise (m/s).
    fn record<F: LawFamily>(&self, noise: f64, seed: u64) -> Found<Record> {
        velocity_record(with_noise(&self.velocity::<F>()?, noise, seed)?)
    }

    /// As [`record`](Self::record), from the release on.
    fn before_top<F: LawFamily>(&self, noise: f64, seed: u64) -> Found<Record> {
        let motion = motion::<F>(&self.scenario::<F>()?, &Sampling::uniform(INTERVAL, 1600)?)?;
        velocity_record(with_noise(motion.velocity().values(), noise, seed)?)
    }

    fn scenario<F: LawFamily>(&self) -> Found<fmm_sim::Scenario<f64, F::At<f64>>> {
        scenario::<F>(machine(self.viscous)?, self.law, self.load, (-1e-3 * self.displacement, 0.0))
    }
}

/// Known quantities of the machine in a fit: its damping and the normal load (N).
#[derive(Debug, Clone, Copy)]
struct Known {
    viscous: Viscous,
    load: f64,
}

impl Known {
    /// Law `F` and the position at the first sample, with m, k and c of the tables, as a problem that begins at the
    /// law's values in `law`, of which those in `free` are to be found.
    fn problem<F: LawFamily>(self, record: &Record, law: &[(&str, f64)], free: &[&str]) -> Found<Problem<'static>> {
        let [mass, stiffness, _] = printed::MACHINE;
        let [linear, quadratic] = self.viscous.coefficients();
        let mut values = vec![
            ("mass", mass),
            ("stiffness", stiffness),
            ("damping", linear),
            ("quadratic_damping", quadratic),
            ("normal_load", self.load),
            ("initial_position", 1e-4),
            ("initial_velocity", record.values()[0]),
        ];
        values.extend(law);
        let mut problem =
            Problem::declared::<F>(record, &values)?.free_within("initial_position", Bounds::new(-2e-3, 2e-3)?)?;
        for name in free {
            problem = problem.free(name)?;
        }
        Ok(problem)
    }

    /// All of `law` fitted from these values and the position at the first sample; the velocity is held at that sample,
    /// as in the thesis.
    fn fit_holding_velocity<F: LawFamily>(self, record: &Record, law: &[(&str, f64)]) -> Found<Fit> {
        self.fit_holding::<F>(record, record.values()[0], law)
    }

    /// The same with this velocity (m/s).
    fn fit_holding<F: LawFamily>(self, record: &Record, velocity: f64, law: &[(&str, f64)]) -> Found<Fit> {
        let free: Vec<&str> = law.iter().map(|(name, _)| *name).collect();
        let values = [law, &[("initial_velocity", velocity)]].concat();
        let problem = self.problem::<F>(record, &values, &free)?;
        Ok(solve(&problem, problem.values(), &Options::default())?)
    }

    /// All of `law` fitted from these values, position and velocity at the first sample with it.
    fn fit<F: LawFamily>(self, record: &Record, law: &[(&str, f64)]) -> Found<Fit> {
        let free: Vec<&str> = law.iter().map(|(name, _)| *name).chain(["initial_velocity"]).collect();
        let problem = self.problem::<F>(record, law, &free)?;
        Ok(solve(&problem, problem.values(), &Options::default())?)
    }
}

/// The value that `fit` found for the parameter of this name.
fn value(fit: &Fit, name: &str) -> Found<f64> {
    Ok(fit.estimate(name).map(Estimate::value).ok_or_else(|| format!("no parameter {name}"))?)
}

/// A seed for test `test` of row `row` of what has this `number`.
fn seed(settings: &Settings<'_>, number: u64, row: usize, test: usize) -> u64 {
    settings.seed().wrapping_mul(1_000_003).wrapping_add(10_000 * number + 100 * row as u64 + test as u64)
}

/// Root mean square.
fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Largest magnitude.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// A record with what was fitted to it, and what the fit leaves below.
fn fit_panels(record: &Record, fit: &Fit) -> [Panel; 2] {
    let left: Vec<f64> = fit.residuals().iter().map(|left| -left).collect();
    let fitted: Vec<f64> = record.values().iter().zip(&left).map(|(v, left)| v - left).collect();
    let velocities = Panel::new("time / s", "velocity / (mm/s)", 280.0)
        .with(Role::Measured, "simulated record", over_time(record.values(), 1e3))
        .with(Role::Fitted, "fit", over_time(&fitted, 1e3));
    let residuals =
        Panel::new("time / s", "record − fit / (mm/s)", 180.0).with(Role::Residual, "residual", over_time(&left, 1e3));
    [velocities, residuals]
}
