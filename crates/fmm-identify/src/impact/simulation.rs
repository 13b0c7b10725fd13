//! Simulation of a blow by a law, as samples and lines, with derivatives.

use std::sync::Arc;

use fmm_fit::EvaluationError;
use fmm_friction::LawFamily;
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Channels, Excitation, Sampling, Trajectory};

use crate::impact::lines::Scratch;
use crate::impact::parameters::{LAW, RESPONSE_GAIN};
use crate::impact::{ImpactDomain, ImpactProblem};
use crate::law::{DIRECTIONS as MANY, Law, Motion, Simulate};

/// Directions of derivative that one simulation carries if no more are wanted; [`MANY`] if so.
pub(crate) const FEW: usize = 2;

/// A law with its simulation in few directions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImpactLaw {
    pub(crate) law: Law,
    with_few: Simulate<Dual<FEW>>,
}

impl ImpactLaw {
    /// Family `F`.
    pub(crate) const fn of<F: LawFamily>() -> Self {
        Self { law: Law::of::<F>(), with_few: Motion::simulate::<F> }
    }

    /// Name of the law.
    pub(crate) fn name(&self) -> &'static str {
        self.law.name
    }
}

/// The numbers of a simulation before those of the law: mass, stiffness, damping, load.
const MACHINE: usize = 4;

/// Memory for the evaluation of a trial.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    plain: Trajectory,
    few: Trajectory<Dual<FEW>>,
    many: Trajectory<Dual<MANY>>,
    seen: Seen,
}

/// Memory for what is seen of a series.
#[derive(Debug, Default)]
struct Seen {
    scratch: Scratch,
    /// Samples and lines, and the same of the rate of change.
    rows: Vec<f64>,
    rates: Vec<f64>,
}

/// The residuals of a trial and their derivatives, column by column.
struct Out<'a> {
    residuals: &'a mut [f64],
    columns: &'a mut [f64],
}

impl Out<'_> {
    /// Adds `factor` times `rows` to column `index`.
    fn add(&mut self, index: usize, factor: f64, rows: &[f64]) {
        let column = self.columns[index * rows.len()..][..rows.len()].iter_mut();
        column.zip(rows).for_each(|(out, row)| *out += factor * row);
    }
}

impl ImpactProblem<'_> {
    /// Index among the parameters of number `number` of a simulation.
    fn index(number: usize) -> usize {
        if number < MACHINE { number } else { LAW + number - MACHINE }
    }

    /// The number, after those of the law, by which all numbers of the machine are multiplied: reading by force.
    fn scale_number(&self) -> usize {
        MACHINE + self.layout().shared - LAW
    }

    /// The numbers of a simulation of `trial` by which derivatives are needed.
    pub(crate) fn directions(&self, trial: usize) -> Vec<usize> {
        let layout = self.layout();
        let has_scale = self.is_wanted(layout.gain(trial)) || self.is_wanted(layout.impulse_error(trial));
        let scale = self.scale_number();
        (0..scale).filter(|number| self.is_wanted(Self::index(*number))).chain(has_scale.then_some(scale)).collect()
    }

    /// Simulates `trial` by `simulate` from the beginning of its blow on, with derivatives by the numbers of a
    /// simulation in `directions`, as far as its residuals need it.
    fn simulate<D: Scalar>(
        &self,
        simulate: Simulate<D>,
        trial: usize,
        p: &[f64],
        directions: &[usize],
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), EvaluationError> {
        let layout = self.layout();
        let variable = |value: f64, number: usize| {
            // What has no direction gets one that no number carries, which makes it a constant.
            D::variable(value, directions.iter().position(|d| *d == number).unwrap_or(usize::MAX))
        };
        let by_force = p[layout.gain(trial)] * (1.0 + p[layout.impulse_error(trial)]);
        let scale = variable(by_force, self.scale_number());
        let of_machine = |number: usize| scale * variable(p[Self::index(number)], number);
        let oscillator = Oscillator::new(of_machine(0), of_machine(1))?.with_damping(Damping::linear(of_machine(2))?);
        let law: Vec<D> = (LAW..layout.shared).map(|index| variable(p[index], index - LAW + MACHINE)).collect();
        let trial = &self.trials()[trial];
        let force: Arc<[D]> = trial.force().iter().map(|force| D::from(*force)).collect();
        let scenario = Motion {
            oscillator,
            law: self.law().values(&law),
            normal_load: of_machine(3),
            initial: [D::from(0.0); 2],
            force: Some(Excitation::sampled_force(trial.interval(), force)?),
            tolerance: None,
        };
        let (motion, all) = (trial.motion().len(), trial.velocity().len() - trial.begin());
        let sampling = Sampling::uniform(trial.interval(), all)?.keeping(Channels::Velocity);
        simulate(&scenario, &sampling.window(0..motion).unwrap_or_else(|| sampling.clone()), trajectory)?;
        if self.domain() != ImpactDomain::Time && motion < all && trajectory.rest().is_none() {
            simulate(&scenario, &sampling, trajectory)?;
        }
        Ok(())
    }

    /// Samples and lines of a `series` that begins with the blow of `trial`, `delay` (s) later than it says.
    fn observe(&self, trial: usize, series: &[f64], delay: f64, seen: &mut Seen) -> Result<(), EvaluationError> {
        let Seen { scratch, rows, rates } = seen;
        let (samples, lines) = self.rows(trial);
        rows.clear();
        rows.extend_from_slice(&series[..samples]);
        rows.resize(samples + lines, 0.0);
        if lines > 0 {
            self.lines(trial).transform(self.trials()[trial].begin(), series, scratch, &mut rows[samples..])?;
        }
        rates.clear();
        if delay != 0.0 || self.is_wanted(self.layout().pulse_delay(trial)) {
            rates.resize(rows.len(), 0.0);
            write_rates(&rows[..samples], self.trials()[trial].interval(), &mut rates[..samples]);
            self.lines(trial).write_rates(&rows[samples..], &mut rates[samples..]);
            // A delay is a small part of an interval, so that this is all of it.
            rows.iter_mut().zip(&*rates).for_each(|(row, rate)| *row -= delay * rate);
        }
        for samples in [rows, rates].into_iter().filter(|samples| !samples.is_empty()) {
            self.leave_contact_out(trial, samples);
        }
        Ok(())
    }

    /// Writes zeros for the samples during which the hammer of `trial` is in contact: there the velocity depends on the
    /// course of a force of which only the samples are known, afterwards on its impulse and its time.
    fn leave_contact_out(&self, trial: usize, rows: &mut [f64]) {
        let (samples, _) = self.rows(trial);
        for hit in self.trials()[trial].hits() {
            rows[hit.start.min(samples)..(hit.end + 1).min(samples)].fill(0.0);
        }
    }

    /// Residuals of `trial` from what its model shows.
    fn write_residuals(&self, trial: usize, p: &[f64], model: &[f64], residuals: &mut [f64]) {
        let (gain, offset) = (p[RESPONSE_GAIN], p[self.layout().offset(trial)]);
        let (samples, _) = self.rows(trial);
        let of_trial = &self.trials()[trial];
        let measured = of_trial.velocity()[of_trial.motion()].iter().take(samples);
        for ((out, model), measured) in residuals.iter_mut().zip(model).zip(measured) {
            *out = gain * model + offset - measured;
        }
        self.leave_contact_out(trial, residuals);
        // A constant has no part in any line but that of zero frequency.
        for ((out, model), measured) in residuals.iter_mut().zip(model).skip(samples).zip(self.spectrum(trial)) {
            *out = gain * model - measured;
        }
    }

    /// Writes the residuals of `trial`.
    pub(crate) fn simulate_residuals(
        &self,
        trial: usize,
        p: &[f64],
        Memory { plain, seen, .. }: &mut Memory,
        residuals: &mut [f64],
    ) -> Result<(), EvaluationError> {
        self.simulate(self.law().plain, trial, p, &[], plain)?;
        self.observe(trial, plain.velocity().values(), p[self.layout().pulse_delay(trial)], seen)?;
        self.write_residuals(trial, p, &seen.rows, residuals);
        Ok(())
    }

    /// Writes the residuals of `trial` and their derivatives, into columns of zeros.
    pub(crate) fn differentiate(
        &self,
        trial: usize,
        p: &[f64],
        Memory { few, many, seen, .. }: &mut Memory,
        residuals: &mut [f64],
        columns: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let directions = self.directions(trial);
        let mut out = Out { residuals, columns };
        if directions.len() <= FEW {
            let run = (self.family().with_few, few);
            self.differentiate_by(run, trial, p, &directions, seen, &mut out)?;
        } else {
            for directions in directions.chunks(MANY) {
                let run = (self.law().with_derivatives, &mut *many);
                self.differentiate_by(run, trial, p, directions, seen, &mut out)?;
            }
        }
        let (samples, lines) = self.rows(trial);
        let column = self.layout().offset(trial) - self.layout().gain(trial) + self.layout().shared;
        let column = &mut out.columns[column * (samples + lines)..][..samples];
        column.fill(1.0);
        self.leave_contact_out(trial, column);
        Ok(())
    }

    /// The same from one simulation with derivatives in `directions`.
    fn differentiate_by<const N: usize>(
        &self,
        (simulate, trajectory): (Simulate<Dual<N>>, &mut Trajectory<Dual<N>>),
        trial: usize,
        p: &[f64],
        directions: &[usize],
        seen: &mut Seen,
        out: &mut Out<'_>,
    ) -> Result<(), EvaluationError> {
        self.simulate(simulate, trial, p, directions, trajectory)?;
        let layout = self.layout();
        // Columns of a trial: what is shared, then its own.
        let [by_gain, by_impulse, by_delay] =
            [layout.gain(trial), layout.impulse_error(trial), layout.pulse_delay(trial)]
                .map(|index| index - layout.gain(trial) + layout.shared);
        let (gain, error, delay) =
            (p[layout.gain(trial)], p[layout.impulse_error(trial)], p[layout.pulse_delay(trial)]);
        let simulated = trajectory.velocity();
        self.observe(trial, simulated.values(), delay, seen)?;
        self.write_residuals(trial, p, &seen.rows, out.residuals);
        // What several runs see alike is written by each of them.
        for index in [RESPONSE_GAIN, by_delay] {
            out.columns[index * seen.rows.len()..][..seen.rows.len()].fill(0.0);
        }
        out.add(RESPONSE_GAIN, 1.0, &seen.rows);
        if !seen.rates.is_empty() {
            out.add(by_delay, -p[RESPONSE_GAIN], &seen.rates);
        }
        for (direction, &number) in directions.iter().enumerate() {
            let Some(partial) = simulated.partial(direction) else { continue };
            self.observe(trial, partial, delay, seen)?;
            if number == self.scale_number() {
                out.add(by_gain, p[RESPONSE_GAIN] * (1.0 + error), &seen.rows);
                out.add(by_impulse, p[RESPONSE_GAIN] * gain, &seen.rows);
            } else {
                out.add(Self::index(number), p[RESPONSE_GAIN], &seen.rows);
            }
        }
        Ok(())
    }

    /// What the model says for every sample of the record of `trial`, its offset left out.
    ///
    /// # Errors
    /// [`EvaluationError`] if the motion cannot be simulated with values `p`.
    pub(crate) fn model(&self, trial: usize, p: &[f64]) -> Result<Vec<f64>, EvaluationError> {
        let trajectory = self.motion(trial, p)?;
        let of_trial = &self.trials()[trial];
        let mut model = vec![0.0; of_trial.velocity().len()];
        let simulated = trajectory.velocity().values();
        let mut rates = vec![0.0; simulated.len()];
        write_rates(simulated, of_trial.interval(), &mut rates);
        let delay = p[self.layout().pulse_delay(trial)];
        for (out, (value, rate)) in model[of_trial.begin()..].iter_mut().zip(simulated.iter().zip(&rates)) {
            *out = p[RESPONSE_GAIN] * (value - delay * rate);
        }
        Ok(model)
    }

    /// The motion of `trial`, with its events counted from the beginning of the blow.
    pub(crate) fn motion(&self, trial: usize, p: &[f64]) -> Result<Trajectory, EvaluationError> {
        let mut trajectory = Trajectory::new();
        self.simulate(self.law().plain, trial, p, &[], &mut trajectory)?;
        Ok(trajectory)
    }
}

/// Writes the rate of change of a `series` that begins at rest, by central differences.
fn write_rates(series: &[f64], interval: f64, rates: &mut [f64]) {
    for (i, rate) in rates.iter_mut().enumerate() {
        let before = i.checked_sub(1).map_or(0.0, |before| series[before]);
        *rate = series.get(i + 1).map_or(0.0, |after| (after - before) / (2.0 * interval));
    }
}
