//! Forces along motions in a problem: their residuals and derivatives.

use std::borrow::Cow;
use std::ops::Range;

use fmm_fit::{Block, EvaluationError};
use fmm_model::{Bounds, Dual, Parameter, Scalar};

use super::Problem;
use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::force::{AveragedNoise, ForceRecord};
use crate::law::along::{Alignment, SampleLocation, locations};
use crate::law::{DIRECTIONS, Law};
use crate::machine::Machine;
use crate::machine::term::Term;
use crate::quantities::rows::Place;
use crate::quantities::table::Table;
use crate::threads::Pool;

/// Forces along motions of one problem.
#[derive(Debug, Clone)]
pub(crate) struct Forces<'a> {
    pub(super) records: &'a [ForceRecord],
    /// Samples of each record that are compared: those whose motion was measured, whatever the delay.
    pub(crate) samples: Vec<Range<usize>>,
    /// Index of the first shape, behind the rows of the law. A shape is a term that is one factor times a measured
    /// series.
    pub(crate) first_shape: usize,
    shapes: Vec<Place>,
    asymmetry: Option<usize>,
    load_offset: Option<usize>,
    pub(crate) delay: Option<usize>,
    idle: Pool<Buffers>,
}

#[derive(Debug, Default)]
struct Buffers {
    locations: Vec<SampleLocation>,
    plain: Vec<f64>,
    seeded: Vec<Dual<DIRECTIONS>>,
}

/// Motion, load and channels at a sample.
struct Sample<'p> {
    /// x, v and a where the motion was.
    motion: [f64; 3],
    channels: &'p [(String, Vec<f64>)],
    row: usize,
    load: f64,
    /// True where the law has a value of friction.
    counts: bool,
}

impl Sample<'_> {
    /// A shape there, and its slopes by x, v and a.
    fn of(&self, shape: Place) -> (f64, [f64; 3]) {
        let [x, v, a] = self.motion;
        match shape {
            Place::Channel(number) => (self.channels[number].1[self.row], [0.0; 3]),
            Place::Term(Term::LinearDamping) => (v, [0.0, 1.0, 0.0]),
            Place::Term(Term::QuadraticDamping) => (v.abs() * v, [0.0, 2.0 * v.abs(), 0.0]),
            Place::Term(Term::CubicDamping) => (v * v * v, [0.0, 3.0 * v * v, 0.0]),
            Place::Term(Term::Inertia) => (a, [0.0, 0.0, 1.0]),
            Place::Term(Term::Stiffness) => (x, [1.0, 0.0, 0.0]),
            Place::Term(Term::Gravity) => (x.sin(), [x.cos(), 0.0, 0.0]),
            Place::Term(Term::GravityCosine) => (x.cos(), [-x.sin(), 0.0, 0.0]),
            // The zero of the force: no other term is a shape.
            _ => (1.0, [0.0; 3]),
        }
    }
}

impl<'a> Problem<'a> {
    /// The problem of forces along the motions of `records`.
    pub(super) fn of_forces(
        candidate: &Candidate,
        machine: Machine,
        records: &'a [ForceRecord],
    ) -> Result<Self, IdentifyError> {
        if machine != Machine::per_unit_mass() {
            return Err(IdentifyError::contradiction(
                "a force along a motion does not depend on what is known of a machine; give Machine::per_unit_mass(), \
                 and a normal load with the record",
            ));
        }
        let (table, parameters) = Table::of_forces(candidate, records)?;
        let longest = table.terms.longest_delay.unwrap_or(0.0);
        let mut samples = Vec::with_capacity(records.len());
        for record in records {
            let times = record.times();
            let (begin, last) = (times[0] + longest, times[times.len() - 1] - longest);
            let range = times.partition_point(|time| *time < begin)..times.partition_point(|time| *time <= last);
            if range.len() <= parameters.len() {
                return Err(IdentifyError::too_short(range.len(), parameters.len() + 1));
            }
            samples.push(range);
        }
        let own = |term: Term| table.shared(Place::Term(term));
        let (asymmetry, load_offset, delay) = (own(Term::Asymmetry), own(Term::LoadOffset), own(Term::Delay));
        let first_shape = candidate.law.fitted().count();
        let others = [asymmetry, load_offset, delay].into_iter().flatten().count();
        let shapes = table.rows[first_shape..table.shared - others].iter().map(|row| row.place).collect();
        let block = |(record, samples): (usize, &Range<usize>)| {
            Block::new(samples.len(), table.of_record(record).collect::<Vec<_>>())
        };
        let blocks = samples.iter().enumerate().map(block).collect();
        let idle = Pool::default();
        let forces = Forces { records, samples, first_shape, shapes, asymmetry, load_offset, delay, idle };
        let problem = Self::by(machine, Cow::Borrowed(&[]), table, parameters);
        Ok(Self { blocks, forces: Some(forces), ..problem })
    }

    /// The forces of this problem, if it is one of forces.
    pub(crate) fn forces(&self) -> Option<ForceProblem<'_>> {
        let forces = self.forces.as_ref()?;
        Some(ForceProblem { forces, table: &self.table, parameters: &self.parameters })
    }

    /// This problem with all rows that records share fixed at `values`.
    pub(crate) fn with_shared(mut self, values: &[f64]) -> Result<Self, IdentifyError> {
        for (parameter, value) in self.parameters.iter_mut().zip(values).take(self.table.shared) {
            *parameter = parameter.clone().bounded(Bounds::new(*value, *value)?);
        }
        Ok(self)
    }
}

/// The residuals "model less force" of records, one after the other, by the table of their problem.
///
/// At rest and at a turning point, friction by a law of the speed that leaps there lies anywhere between the levels:
/// such a sample does not count, and its residual is zero.
#[derive(Clone, Copy)]
pub(crate) struct ForceProblem<'p> {
    pub(crate) forces: &'p Forces<'p>,
    table: &'p Table,
    pub(crate) parameters: &'p [Parameter],
}

impl<'p> ForceProblem<'p> {
    pub(crate) fn records(&self) -> &'p [ForceRecord] {
        self.forces.records
    }

    /// The largest noise of a motion that was averaged, if there was any.
    pub(crate) fn noise_of_motion(&self) -> Option<AveragedNoise> {
        let noise = self.records().iter().filter_map(ForceRecord::noise_of_motion);
        noise.max_by(|a, b| a.share.total_cmp(&b.share))
    }

    pub(crate) fn law(&self) -> &'p Law {
        &self.table.family
    }

    /// Residuals of all records.
    fn len(&self) -> usize {
        self.forces.samples.iter().map(Range::len).sum()
    }

    /// Index of the deflection at the beginning of `record`, if it is fitted.
    fn deflection(&self, record: usize) -> Option<usize> {
        self.table.own(record, Place::Deflection)
    }

    fn value(p: &[f64], index: Option<usize>) -> f64 {
        index.map_or(0.0, |index| p[index])
    }

    fn alignment<'g, D: Scalar>(
        &self,
        record: usize,
        delay: D,
        deflection: D,
        locations: &'g [SampleLocation],
    ) -> Alignment<'g, D>
    where
        'p: 'g,
    {
        Alignment {
            motion: &self.records()[record].motion,
            delay,
            has_delay: self.forces.delay.is_some(),
            deflection,
            first: self.forces.samples[record].start,
            locations,
        }
    }

    #[inline]
    fn sample(&self, record: usize, p: &[f64], leaps: bool, row: usize, location: SampleLocation) -> Sample<'p> {
        let data = &self.records()[record];
        let alignment = self.alignment(record, Self::value(p, self.forces.delay), 0.0, &[]);
        let elapsed = alignment.elapsed(row, location);
        let motion = [&data.motion.positions, &data.motion.velocities, &data.motion.accelerations]
            .map(|series| alignment.between(series, location, elapsed));
        let load = data.loads.as_ref().map_or(1.0, |loads| loads[row]) + Self::value(p, self.forces.load_offset);
        Sample { motion, channels: &data.channels, row, load, counts: location.slides || !leaps }
    }

    /// The shapes with their factors.
    fn shapes<'s>(&'s self, p: &'s [f64]) -> impl Iterator<Item = (Place, f64)> + 's {
        self.forces.shapes.iter().copied().zip(p[self.forces.first_shape..].iter().copied())
    }

    /// Residual of a sample with this `friction` coefficient, and its slopes by that coefficient at a load of one and
    /// by the force beside friction.
    #[inline]
    fn residual(&self, p: &[f64], sample: &Sample<'_>, friction: f64, force: f64) -> (f64, f64, f64) {
        if !sample.counts {
            return (0.0, 0.0, 0.0);
        }
        let beside: f64 = self.shapes(p).map(|(shape, factor)| factor * sample.of(shape).0).sum();
        let slope = 1.0 + Self::value(p, self.forces.asymmetry) * friction.signum();
        (sample.load * slope * friction + beside - force, slope, 1.0)
    }

    /// Residuals, and the series to which the force is proportional: friction, then the shapes, each a column.
    pub(crate) fn linear(&self, p: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), EvaluationError> {
        let mut residuals = Vec::with_capacity(self.len());
        let mut columns = vec![Vec::with_capacity(self.len()); 1 + self.forces.shapes.len()];
        let leaps = self.leaps(p);
        self.forces.idle.lend(|buffers| {
            for (record, data) in self.records().iter().enumerate() {
                self.follow(record, p, buffers)?;
                let rows = self.forces.samples[record].clone().zip(&buffers.locations).zip(&buffers.plain);
                for ((row, location), friction) in rows {
                    let sample = self.sample(record, p, leaps, row, *location);
                    let (residual, by_friction, by_rest) = self.residual(p, &sample, *friction, data.forces[row]);
                    residuals.push(residual);
                    columns[0].push(sample.load * by_friction * friction);
                    for (column, shape) in columns[1..].iter_mut().zip(&self.forces.shapes) {
                        column.push(by_rest * sample.of(*shape).0);
                    }
                }
            }
            Ok((residuals, columns))
        })
    }

    /// The deflections with which a fit begins, by their indices: the bristles have come the way they go on.
    pub(crate) fn first_deflections(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let first = |record: &ForceRecord| {
            let moving = record.velocities().iter().find(|velocity| velocity.abs() > record.motion.rest_speed);
            moving.map_or(0.0, |velocity| velocity.signum())
        };
        let records = self.records().iter().enumerate();
        records.filter_map(move |(number, record)| Some((self.deflection(number)?, first(record))))
    }

    /// One flag per residual: it counts.
    pub(crate) fn counts(&self, p: &[f64]) -> Vec<bool> {
        let (leaps, mut at) = (self.leaps(p), Vec::new());
        let mut counts = Vec::with_capacity(self.len());
        for (record, samples) in self.records().iter().zip(&self.forces.samples) {
            locations(&record.motion, samples.clone(), Self::value(p, self.forces.delay), &mut at);
            counts.extend(at.iter().map(|location| location.slides || !leaps));
        }
        counts
    }

    /// True for a law of the speed that leaps where the contact comes to rest.
    fn leaps(&self, p: &[f64]) -> bool {
        let at_rest = || self.law().steady(&p[..self.forces.first_shape], 0.0, false);
        self.law().is_of_speed() && at_rest().is_some_and(|level| level > 0.0)
    }

    fn follow(&self, record: usize, p: &[f64], buffers: &mut Buffers) -> Result<(), EvaluationError> {
        let delay = Self::value(p, self.forces.delay);
        locations(&self.records()[record].motion, self.forces.samples[record].clone(), delay, &mut buffers.locations);
        let deflection = Self::value(p, self.deflection(record));
        let alignment = self.alignment(record, delay, deflection, &buffers.locations);
        self.law().members.along(&self.law().values(&p[..self.forces.first_shape]), alignment, &mut buffers.plain)
    }

    /// Derivatives of friction in up to [`DIRECTIONS`] of the parameters of law, delay and deflection.
    fn follow_seeded(
        &self,
        record: usize,
        p: &[f64],
        columns: &[usize],
        buffers: &mut Buffers,
    ) -> Result<(), EvaluationError> {
        let seeded = |j: usize| Dual::variable(p[j], columns.iter().position(|c| *c == j).unwrap_or(DIRECTIONS));
        let fitted: Vec<Dual<DIRECTIONS>> = (0..self.forces.first_shape).map(seeded).collect();
        let delay = self.forces.delay.map_or(Dual::from(0.0), seeded);
        let deflection = self.deflection(record).map_or(Dual::from(0.0), seeded);
        let alignment = self.alignment(record, delay, deflection, &buffers.locations);
        self.law().members.along(&self.law().values(&fitted), alignment, &mut buffers.seeded)
    }

    /// Fills the residuals, and the derivatives of each record by its rows of the table.
    pub(super) fn evaluate(
        &self,
        p: &[f64],
        mut residuals: &mut [f64],
        jacobian: Option<&mut [f64]>,
    ) -> Result<(), EvaluationError> {
        let leaps = self.leaps(p);
        let mut jacobian = jacobian;
        self.forces.idle.lend(|buffers| {
            for (record, samples) in self.forces.samples.iter().enumerate() {
                let (own, others) = std::mem::take(&mut residuals).split_at_mut(samples.len());
                residuals = others;
                match jacobian.take() {
                    None => {
                        self.follow(record, p, buffers)?;
                        let forces = &self.records()[record].forces;
                        let rows = samples.clone().zip(&buffers.locations).zip(&buffers.plain);
                        for (out, ((row, location), friction)) in own.iter_mut().zip(rows) {
                            let sample = self.sample(record, p, leaps, row, *location);
                            *out = self.residual(p, &sample, *friction, forces[row]).0;
                        }
                    }
                    Some(all) => {
                        let elements = samples.len() * self.table.of_record(record).count();
                        let (columns, further) = all.split_at_mut(elements);
                        self.differentiate(record, p, leaps, (own, columns), buffers)?;
                        jacobian = Some(further);
                    }
                }
            }
            Ok(())
        })
    }

    /// Fills residuals and derivatives of one record.
    fn differentiate(
        &self,
        record: usize,
        p: &[f64],
        leaps: bool,
        (residuals, jacobian): (&mut [f64], &mut [f64]),
        buffers: &mut Buffers,
    ) -> Result<(), EvaluationError> {
        let is_free = |j: &usize| !self.parameters[*j].bounds().is_fixed();
        let (forces, samples, rows) = (self.forces, self.forces.samples[record].clone(), residuals.len());
        // A deflection is the only row of a record alone.
        let column = |j: usize| rows * j.min(self.table.shared);
        let data = &self.records()[record];
        jacobian.fill(0.0);
        let of_law = (0..forces.first_shape).chain(forces.delay).chain(self.deflection(record));
        let of_law: Vec<usize> = of_law.filter(is_free).collect();
        locations(&data.motion, samples.clone(), Self::value(p, forces.delay), &mut buffers.locations);
        if of_law.is_empty() {
            self.follow(record, p, buffers)?;
            buffers.seeded.clear();
            buffers.seeded.extend(buffers.plain.iter().map(|friction| Dual::from(*friction)));
        }
        let passes = of_law.chunks(DIRECTIONS).map(Some).chain(of_law.is_empty().then_some(None));
        for (pass, columns) in passes.enumerate() {
            let columns = columns.unwrap_or(&[]);
            if !columns.is_empty() {
                self.follow_seeded(record, p, columns, buffers)?;
            }
            let samples = samples.clone().zip(&buffers.locations).zip(&buffers.seeded);
            for (at, ((row, location), friction)) in samples.enumerate() {
                let sample = self.sample(record, p, leaps, row, *location);
                let (residual, by_friction, by_rest) = self.residual(p, &sample, friction.value(), data.forces[row]);
                for (direction, j) in columns.iter().enumerate() {
                    jacobian[column(*j) + at] += sample.load * by_friction * friction.partial(direction);
                }
                if pass > 0 {
                    continue;
                }
                residuals[at] = residual;
                if by_rest == 0.0 {
                    continue;
                }
                for (j, shape) in (forces.first_shape..).zip(&forces.shapes) {
                    jacobian[column(j) + at] = sample.of(*shape).0;
                }
                if let Some(j) = forces.asymmetry {
                    jacobian[column(j) + at] = sample.load * friction.value().abs();
                }
                if let Some(j) = forces.load_offset {
                    jacobian[column(j) + at] = by_friction * friction.value();
                }
                if let Some(j) = forces.delay.filter(is_free) {
                    jacobian[column(j) + at] -= self.rate_beside(record, p, location.node, &sample);
                }
            }
        }
        Ok(())
    }

    /// True if residuals and derivatives together cost little more than residuals alone: most of a pass with
    /// derivatives is the passage of the motion, and nearly every step is taken.
    pub(super) fn is_cheaper_combined(&self) -> bool {
        self.forces.first_shape <= DIRECTIONS
    }

    /// Rate of the force beside friction (force per s) between a sample and the next.
    fn rate_beside(&self, record: usize, p: &[f64], node: usize, sample: &Sample<'_>) -> f64 {
        let data = &self.records()[record];
        let duration = data.motion.times[node + 1] - data.motion.times[node];
        let rates = [&data.motion.positions, &data.motion.velocities, &data.motion.accelerations]
            .map(|series| (series[node + 1] - series[node]) / duration);
        let slope = |shape: Place| -> f64 { sample.of(shape).1.iter().zip(rates).map(|(a, b)| a * b).sum() };
        self.shapes(p).map(|(shape, factor)| factor * slope(shape)).sum()
    }
}

#[cfg(test)]
mod tests {
    use fmm_fit::{Residuals, check_jacobian};

    use super::*;

    /// A motion to and fro at unequal steps under a load, with a force that need not fit.
    fn record() -> ForceRecord {
        let times: Vec<f64> = (0..300).map(|i| 0.01 * f64::from(i) + 1e-3 * f64::from(i % 3)).collect();
        let column = |value: &dyn Fn(f64) -> f64| -> Vec<f64> { times.iter().map(|time| value(*time)).collect() };
        let record =
            ForceRecord::of_positions(&times, &column(&|t| 0.1 * (3.0 * t).sin()), &column(&|t| (2.9 * t).cos()))
                .unwrap();
        record.under_loads(&column(&|t| 5.0 + t)).unwrap()
    }

    /// Every parameter of a law with state and of one of the speed, with all that can stand beside it, in two records.
    #[test]
    fn derivatives_are_those_of_the_residuals() {
        let beside = "quadratic + cubic + zero + inertia + stiffness + gravity + asymmetry + load offset + delay";
        for (law, values) in [
            ("dahl", vec![0.2, 150.0, 1.3]),
            ("lugre", vec![0.2, 0.1, 0.05, 1.5, 150.0, 0.3, 0.1]),
            ("maxwell_slip_2", vec![0.1, 200.0, 0.2, 30.0]),
            ("gms_2", vec![0.2, 0.1, 0.05, 1.5, 0.1, 2.0, 200.0, 30.0, 0.7]),
            ("stribeck", vec![0.2, 0.1, 0.05, 1.5, 0.1]),
            ("makkar_dixon", vec![0.2, 40.0, 9.0, 0.1, 30.0, 0.1]),
        ] {
            let candidate = Candidate::named(&format!("{law} + {beside}")).unwrap();
            let records = [record(), record()];
            let problem = Problem::of(&candidate, Machine::per_unit_mass(), &records).unwrap();
            let mut p = values;
            p.extend([0.3, 0.2, 0.05, 0.4, 2.0, 0.1, -0.2, 0.15, 0.7, 2.3e-3]);
            p.resize(problem.parameters().len(), 0.4);
            let doubt = check_jacobian(&problem, &p).unwrap();
            assert!(doubt.is_empty(), "{}: {doubt:?}", candidate.law_name());
        }
    }
}
