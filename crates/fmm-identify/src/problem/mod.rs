//! The least-squares problem of an identification: these experiments by that law.

use std::borrow::Cow;
use std::ops::Range;

use fmm_fit::{Block, EvaluationError, Fit, Residuals};
use fmm_model::{Parameter, Scalar};
use fmm_sim::{Channels, Sampling, Trajectory};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::sight::{Seen, Sight};
use crate::experiment::{Experiment, Experiments, scaled};
use crate::law::naming::{Form, Units};
use crate::law::{Law, Motion, Simulate};
use crate::machine::term::Term;
use crate::machine::{Machine, Scale, Terms};
use crate::problem::force::Forces;
use crate::problem::idle::{Idle, Simulated};
use crate::quantities::prior::Prior;
use crate::quantities::rows::Place;
use crate::quantities::table::Table;

mod declared;
pub(crate) mod force;
mod idle;
mod motion;
pub(crate) mod parts;
mod residuals;
pub(crate) mod starts;
pub(crate) mod tangent;

/// The residuals "model less record" of one or several experiments by a law, with exact derivatives.
///
/// Machine and law are shared by all experiments; initial state, drive, offset and sensor are each record's own. The
/// initial velocity is never taken from the data: fixing it at a noisy maximum biases the friction by up to 0.8 %.
/// A mass, a stiffness, a damping or a drive known to an uncertainty is a parameter as well, and its knowledge a
/// residual in the unit of the noise.
///
/// Anything that takes [`Residuals`] can be applied to it; [`identify`](crate::identify) is what most want.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    pub(crate) machine: Machine,
    experiments: Cow<'a, [Experiment]>,
    parameters: Vec<Parameter>,
    pub(crate) table: Table,
    pub(crate) prior: Prior,
    blocks: Vec<Block>,
    /// Factors of the residuals of each record (1).
    weights: Vec<f64>,
    /// Standard deviation of the noise in the unit of the residuals.
    pub(crate) noise: f64,
    /// Relative tolerance (1) of simulations that integrate, if not the engine's own.
    tolerance: Option<f64>,
    /// Simulation without derivatives in place of that of the law.
    euler: Option<Euler>,
    /// Values with which a fit begins, where they are declared.
    declared: Vec<f64>,
    /// Forces along motions in place of the experiments.
    forces: Option<Forces<'a>>,
    idle: Idle,
}

/// A simulation without derivatives.
type Euler = fn(&Motion<f64>, &Sampling, &mut Trajectory) -> Result<(), EvaluationError>;

/// Samples simulated at a time: memory beyond the solver's own stays below 4 MB however long the record.
const WINDOW: usize = 1 << 16;

/// A direction that no number carries, which makes a value a constant.
const NO_DIRECTION: usize = usize::MAX;

impl<'a> Problem<'a> {
    /// The problem of `experiments` on `machine` by a law with its terms.
    ///
    /// # Errors
    /// [`IdentifyError::Missing`], [`IdentifyError::WrongRecord`], [`IdentifyError::Contradiction`],
    /// [`IdentifyError::UnknownName`] and [`IdentifyError::OutOfRange`].
    pub fn of(
        candidate: &Candidate,
        machine: Machine,
        experiments: impl Into<Experiments<'a>>,
    ) -> Result<Self, IdentifyError> {
        let experiments = match experiments.into() {
            Experiments::Vibrations(experiments) => experiments,
            Experiments::Forces(records) => return Self::of_forces(candidate, machine, records),
        };
        Self::in_form(Table::form(&machine), candidate, machine, experiments)
    }

    /// The problem of vibrations with forces in this `form`.
    pub(crate) fn in_form(
        form: Form,
        candidate: &Candidate,
        machine: Machine,
        experiments: &'a [Experiment],
    ) -> Result<Self, IdentifyError> {
        require_together(&machine, experiments)?;
        let (table, parameters) = Table::by(form, candidate, &machine, experiments)?;
        Ok(Self::by(machine, Cow::Borrowed(experiments), table, parameters))
    }

    /// The problem of `experiments` by a `table`.
    fn by(machine: Machine, experiments: Cow<'a, [Experiment]>, table: Table, parameters: Vec<Parameter>) -> Self {
        // Forces that one hammer measures share its calibration.
        let calibration = |index: usize| {
            let row = table.rows[index];
            let drive = row.record.and_then(|record| experiments.get(record)?.drive());
            drive.filter(|_| row.place == Place::DriveGain).map_or(0.0, |drive| drive.calibration_uncertainty)
        };
        let prior = Prior::of(&table.rows, |i, j| calibration(i) * calibration(j));
        let weights: Vec<f64> = scaled(&experiments).map(|(_, weight)| weight).collect();
        let noise = scaled(&experiments).map(|(experiment, weight)| weight * experiment.least_noise());
        let noise = noise.filter(|noise| noise.is_finite()).fold(0.0, f64::max);
        let mut problem = Self {
            machine,
            experiments,
            parameters,
            table,
            prior,
            blocks: Vec::new(),
            weights,
            noise,
            tolerance: None,
            euler: None,
            declared: Vec::new(),
            forces: None,
            idle: Idle::default(),
        };
        problem.blocks = problem.blocks_of_records();
        problem
    }

    /// One block per record, and one of what is known beforehand.
    fn blocks_of_records(&self) -> Vec<Block> {
        let of_record = |(record, experiment): (usize, &Experiment)| {
            Block::new(experiment.rows(), self.table.of_record(record).collect::<Vec<_>>())
        };
        let known = (self.prior.len() > 0).then(|| Block::new(self.prior.len(), self.prior.indices.clone()));
        self.experiments.iter().enumerate().map(of_record).chain(known).collect()
    }

    fn law(&self) -> &Law {
        &self.table.family
    }

    /// Name of the law.
    pub(crate) fn name(&self) -> &'static str {
        self.law().name
    }

    /// True if the spring is fitted as one with a stop or a gap.
    pub(crate) fn has_corners(&self) -> bool {
        self.terms().has(Term::Stop) || self.terms().has(Term::Gap)
    }

    /// True if terms of the spring are fitted.
    pub(crate) fn has_spring(&self) -> bool {
        self.terms().has_spring()
    }

    fn terms(&self) -> &Terms {
        &self.table.terms
    }

    pub(crate) fn experiments(&self) -> &[Experiment] {
        &self.experiments
    }

    /// Its experiments, or the forces along motions in place of them.
    pub(crate) fn records(&self) -> Experiments<'_> {
        match &self.forces {
            Some(forces) => Experiments::Forces(forces.records),
            None => Experiments::Vibrations(&self.experiments),
        }
    }

    /// The law with its terms.
    pub(crate) fn candidate(&self) -> Candidate {
        Candidate { law: self.table.family, terms: self.table.terms.clone() }
    }

    /// Factor of the residuals of `record` (1).
    #[cfg(feature = "sampler")]
    pub(crate) fn weight(&self, record: usize) -> f64 {
        self.weights[record]
    }

    /// Number of residuals of records; those of prior knowledge follow.
    pub(crate) fn measured(&self) -> usize {
        self.row_ranges().map(|rows| rows.len()).sum()
    }

    /// The same problem without residuals of what is known beforehand.
    pub(crate) fn without_prior(mut self) -> Self {
        self.prior = Prior::default();
        self.blocks = self.blocks_of_records();
        self
    }

    /// The motion of `record` in numbers of type `D`, of which each of `directions` is one parameter.
    fn motion<D: Scalar>(&self, record: usize, p: &[f64], directions: &[usize]) -> Result<Motion<D>, EvaluationError> {
        let value = |direction: usize| {
            let index = self.table.index(record, direction);
            D::variable(p[index], directions.iter().position(|one| *one == index).unwrap_or(NO_DIRECTION))
        };
        let values: Vec<D> = (0..self.table.directions(record)).map(value).collect();
        let motion = self.table.motion(&self.machine, record, &self.experiments[record], &values)?;
        Ok(Motion { tolerance: self.tolerance, ..motion })
    }

    /// Simulates a motion by the law, without derivatives.
    fn plain(
        &self,
        motion: &Motion<f64>,
        sampling: &Sampling,
        trajectory: &mut Trajectory,
    ) -> Result<(), EvaluationError> {
        self.law().members.simulate(motion, sampling, trajectory)
    }

    /// Simulates `record` by `simulate` once, window by window; `visit` gets, for each of `ranges` in a window, the
    /// number of samples of the ranges before it, its samples' indices in the record, and those among the simulated
    /// samples.
    fn simulate<D: Simulated>(
        &self,
        simulate: Simulate<'_, D>,
        record: usize,
        p: &[f64],
        directions: &[usize],
        ranges: &[Range<usize>],
        mut visit: impl FnMut(usize, Range<usize>, Range<usize>, &Seen<'_, D>),
    ) -> Result<(), EvaluationError> {
        let (Some(first_range), Some(last_range)) = (ranges.first(), ranges.last()) else { return Ok(()) };
        let experiment = &self.experiments[record];
        let motion = self.motion::<D>(record, p, directions)?;
        let mut sight = Sight::of(experiment, self.corner(record, p));
        let sampling = experiment.sampling()?.keeping(sight.channels());
        let mut before = 0;
        self.idle.lend(|trajectory| {
            // A filter sees all samples in turn.
            let (mut next, mut start) = (0, if sight.is_filtered() { 0 } else { first_range.start });
            while start < last_range.end {
                let end = last_range.end.min(start + WINDOW);
                let Some(window) = sampling.window(start..end) else { break };
                simulate(&motion, &window, trajectory)?;
                let seen = sight.see(trajectory);
                while let Some(range) = ranges.get(next) {
                    let samples = range.start.max(start)..range.end.min(end);
                    if !samples.is_empty() {
                        let count = samples.len();
                        let inside = samples.start - start..samples.end - start;
                        visit(before, samples, inside, &seen);
                        before += count;
                    }
                    if range.end > end {
                        break;
                    }
                    next += 1;
                }
                start = end;
            }
            Ok(())
        })
    }

    /// The motion of the first record by these values.
    pub(crate) fn trace(
        &self,
        p: &[f64],
        sampling: &Sampling,
        trajectory: &mut Trajectory,
    ) -> Result<(), EvaluationError> {
        self.plain(&self.motion(0, p, &[])?, sampling, trajectory)
    }

    /// Velocities of `record` by these values.
    pub(crate) fn velocities(
        &self,
        record: usize,
        p: &[f64],
        sampling: &Sampling,
    ) -> Result<Vec<f64>, EvaluationError> {
        let mut trajectory = Trajectory::new();
        let sampling = sampling.clone().keeping(Channels::Velocity);
        self.plain(&self.motion(record, p, &[])?, &sampling, &mut trajectory)?;
        Ok(trajectory.velocity().values().to_vec())
    }

    /// The events of `record` up to its end.
    pub(crate) fn events(&self, record: usize, p: &[f64]) -> Result<Trajectory, EvaluationError> {
        let mut trajectory = Trajectory::new();
        let ends = Sampling::uniform(self.experiments[record].record().duration(), 2)?.keeping(Channels::Position);
        self.plain(&self.motion(record, p, &[])?, &ends, &mut trajectory)?;
        Ok(trajectory)
    }

    /// Model at every sample of `record`, its offset included.
    pub(crate) fn model(&self, record: usize, p: &[f64]) -> Result<Vec<f64>, EvaluationError> {
        let count = self.experiments[record].record().len();
        let offset = self.offset(record, p);
        let mut model = vec![0.0; count];
        let all = 0..count;
        let plain: Simulate<'_, f64> = &|motion, sampling, trajectory| self.plain(motion, sampling, trajectory);
        self.simulate(plain, record, p, &[], std::slice::from_ref(&all), |_, samples, inside, seen| {
            for (out, value) in model[samples].iter_mut().zip(&seen.values()[inside]) {
                *out = value + offset;
            }
        })?;
        for (size, shape) in self.disturbances(record, p) {
            model.iter_mut().zip(shape).for_each(|(out, shape)| *out += size * shape);
        }
        Ok(model)
    }

    /// Corner frequency (Hz) of the sensor of `record`, if it has a filter.
    fn corner(&self, record: usize, p: &[f64]) -> Option<f64> {
        let fitted = self.table.own(record, Place::Corner).map(|index| p[index]);
        fitted.or_else(|| self.experiments[record].first_corner())
    }

    fn offset(&self, record: usize, p: &[f64]) -> f64 {
        let fitted = self.table.own(record, Place::Offset).map(|index| p[index]);
        fitted.or_else(|| self.experiments[record].summary().held_offset).unwrap_or(0.0)
    }

    /// Size and shape of the disturbances of `record`.
    fn disturbances<'s>(&'s self, record: usize, p: &'s [f64]) -> impl Iterator<Item = (f64, &'s [f64])> {
        let first = self.table.first_disturbance(record);
        let shapes = &self.experiments[record].shapes;
        shapes.iter().enumerate().map(move |(at, shape)| (p[first + at], shape.as_slice()))
    }

    /// The rows of each record among the residuals.
    pub(crate) fn row_ranges(&self) -> impl Iterator<Item = Range<usize>> {
        let records = self.blocks.len() - usize::from(self.prior.len() > 0);
        let mut end = 0;
        self.blocks[..records].iter().map(move |block| {
            let begin = end;
            end += block.rows();
            begin..end
        })
    }

    /// The derivatives of all residuals by each of the `wanted` parameters.
    pub(crate) fn columns(&self, p: &[f64], wanted: &[usize]) -> Result<Vec<Vec<f64>>, EvaluationError> {
        let elements = self.blocks.iter().map(|block| block.rows() * block.parameters().len()).sum();
        let mut jacobian = vec![0.0; elements];
        self.evaluate(p, &mut vec![0.0; self.len()], Some(&mut jacobian))?;
        let mut columns = vec![Vec::new(); wanted.len()];
        let mut end = self.len();
        // From the end on, so that what is in a column is given back at once.
        for block in self.blocks.iter().rev() {
            for parameter in block.parameters().iter().rev() {
                let part = jacobian.split_off(jacobian.len() - block.rows());
                jacobian.shrink_to_fit();
                let Some(index) = wanted.iter().position(|wanted| wanted == parameter) else { continue };
                let column = &mut columns[index];
                if block.rows() == self.len() {
                    *column = part;
                } else {
                    column.resize(self.len(), 0.0);
                    column[end - block.rows()..end].copy_from_slice(&part);
                }
            }
            end -= block.rows();
        }
        Ok(columns)
    }

    /// The signal of `record` without its offset at each of its rows, as `fit` has it; empty for lines of a spectrum.
    pub(crate) fn signal(&self, record: usize, fit: &Fit) -> Vec<f64> {
        self.signal_by(record, fit.values(), fit.residuals())
    }

    /// The same by these values and their residuals.
    pub(crate) fn signal_by(&self, record: usize, p: &[f64], residuals: &[f64]) -> Vec<f64> {
        let experiment = &self.experiments[record];
        let Some(rows) = self.row_ranges().nth(record).filter(|_| experiment.lines().is_none()) else {
            return Vec::new();
        };
        let offset = self.offset(record, p);
        let measured = experiment.kept().iter().flat_map(|range| &experiment.record().values()[range.clone()]);
        let mut signal: Vec<f64> = residuals[rows]
            .iter()
            .zip(measured)
            .map(|(residual, measured)| residual / self.weights[record] + measured - offset)
            .collect();
        for (size, shape) in self.disturbances(record, p) {
            let kept = experiment.kept().iter().flat_map(|range| &shape[range.clone()]);
            signal.iter_mut().zip(kept).for_each(|(value, shape)| *value -= size * shape);
        }
        signal
    }
}

/// Refuses experiments that cannot be fitted together, or not on this machine.
fn require_together(machine: &Machine, experiments: &[Experiment]) -> Result<(), IdentifyError> {
    let describe = |experiment: &Experiment| {
        let record = experiment.record();
        format!("{} in {}", record.quantity(), record.unit())
    };
    let first = experiments.first().ok_or(IdentifyError::no_record())?;
    let length = |experiment: &Experiment| Units::of(experiment.record()).position;
    if let Some(other) = experiments.iter().find(|experiment| length(experiment) != length(first)) {
        return Err(IdentifyError::wrong_record(format!(
            "records fitted together must agree in quantity and unit: one is {}, another {}",
            describe(first),
            describe(other)
        )));
    }
    let is_forced = experiments.iter().any(Experiment::is_forced);
    if is_forced && machine.scale() == Scale::PerUnitMass {
        return Err(IdentifyError::contradiction(
            "a measured force tells the mass: give Machine::unknown() to find mass and stiffness, or a mass or a \
             stiffness that is known",
        ));
    }
    if is_forced && !Units::of(first.record()).is_metric() {
        let expected = "a force in N beside responses in m, m/s or m/s²";
        return Err(IdentifyError::drive(expected, &format!("beside a {}", describe(first))));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use fmm_friction::CoulombViscous;
    use fmm_model::Oscillator;
    use fmm_record::Quantity;
    use fmm_record::Record;
    use fmm_sim::{Engine, Exact, Scenario};

    use super::*;
    use crate::experiment::Preparation;

    /// Two velocity records of a machine of 2 Hz, c/m = 0.05 1/s, F/m = 0.3 m/s², of different length.
    pub(super) fn decays() -> Vec<Experiment> {
        [(0.02, 2000), (0.025, 2300)]
            .map(|(position, samples)| {
                let law = CoulombViscous::new(0.3, 0.05).unwrap();
                let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
                let sampling = Sampling::uniform(1e-3, samples).unwrap();
                let motion = Exact.run(&scenario.starting_at(position, 0.0).unwrap(), &sampling).unwrap();
                let noise = |i: usize| 1e-4 * (((i * 7919) % 1009) as f64 / 1009.0 - 0.5);
                let values = motion.velocity().values().iter().enumerate().map(|(i, v)| v + noise(i)).collect();
                let record = Record::new(0.0, 1e-3, values, Quantity::Velocity, "m/s").unwrap();
                Experiment::ring_down(&record, &Preparation::default()).unwrap()
            })
            .to_vec()
    }

    /// Requires derivatives at `p` that are those of differences.
    pub(super) fn require_derivatives(problem: &Problem<'_>, p: &[f64]) {
        let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
        let mut jacobian = vec![0.0; elements];
        problem.evaluate(p, &mut vec![0.0; problem.len()], Some(&mut jacobian)).unwrap();
        let at = |j: usize, by: f64| {
            let mut moved = p.to_vec();
            moved[j] += by;
            let mut residuals = vec![0.0; problem.len()];
            problem.evaluate(&moved, &mut residuals, None).unwrap();
            residuals
        };
        let mut columns = jacobian.as_slice();
        let mut row = 0;
        for block in problem.blocks() {
            for &j in block.parameters() {
                let h = 1e-6;
                let (above, below) = (at(j, h), at(j, -h));
                let (column, rest) = columns.split_at(block.rows());
                let difference = |i: usize| (above[row + i] - below[row + i]) / (2.0 * h);
                let scale = column.iter().fold(0.0f64, |scale, d| scale.max(d.abs()));
                // A reversal may cross a sample within h, which spoils its difference: one sample per half swing at
                // most.
                let off = (0..block.rows()).filter(|&i| (column[i] - difference(i)).abs() > 1e-5 * scale).count();
                let name = problem.parameters()[j].name();
                assert!(scale > 0.0 && off < 20, "{name}: {off} of {} samples differ", block.rows());
                columns = rest;
            }
            row += block.rows();
        }
        assert_eq!((row, columns.len()), (problem.len(), 0));
    }

    #[test]
    fn derivatives_of_joint_records_are_those_of_differences() {
        let decays = decays();
        let problem = Problem::of(&Candidate::of::<CoulombViscous>(), Machine::per_unit_mass(), &decays).unwrap();
        // Off the bounds, so that differences have room.
        let p: Vec<f64> = problem.starts()[0].iter().map(|value| value + 1e-3).collect();
        require_derivatives(&problem, &p);
    }
}
