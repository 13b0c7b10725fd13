//! The least-squares problem of forces along motions.

use std::ops::Range;

use fmm_fit::{Derivatives, EvaluationError, Residuals};
use fmm_model::{Dual, Parameter, Scalar};

use crate::error::IdentifyError;
use crate::force::model::{Part, Shape};
use crate::force::{ForceModel, ForceRecord};
use crate::law::along::{Guide, Place, places};
use crate::law::{DIRECTIONS, Law};
use crate::threads::Pool;

/// The residuals "model less force" of records, one after the other.
///
/// Where the contact rests or turns, friction by a law of the speed that leaps there lies anywhere between the levels:
/// such a sample does not count.
#[derive(Debug)]
pub(crate) struct ForceProblem<'a> {
    records: &'a [ForceRecord],
    law: Law,
    parameters: Vec<Parameter>,
    /// Of each record the samples that are compared: those whose motion was measured, whatever the delay.
    rows: Vec<Range<usize>>,
    /// Of each record the residuals that are its.
    series: Vec<Range<usize>>,
    shapes: Vec<Shape>,
    layout: Places,
    idle: Pool<Buffers>,
}

/// Where parameters are among all.
#[derive(Debug, Clone, Copy)]
struct Places {
    /// The first after those of the law.
    shapes: usize,
    /// The deflection at the beginning of the first record; those of the others follow.
    deflection: Option<usize>,
    asymmetry: Option<usize>,
    load_offset: Option<usize>,
    delay: Option<usize>,
}

#[derive(Debug, Default)]
struct Buffers {
    places: Vec<Place>,
    plain: Vec<f64>,
    seeded: Vec<Dual<DIRECTIONS>>,
}

/// Friction at a sample, and what the force is made of beside it.
struct Parts<'p> {
    /// x, v and a where the motion was.
    motion: [f64; 3],
    /// What was measured beside the force, and the sample.
    channels: &'p [(String, Vec<f64>)],
    row: usize,
    load: f64,
    /// Whether the law says friction there.
    counts: bool,
}

impl Parts<'_> {
    /// A shape there, and its slopes by x, v and a.
    fn of(&self, shape: Shape) -> (f64, [f64; 3]) {
        shape.at(self.motion, |channel| self.channels[channel].1[self.row])
    }
}

impl<'a> ForceProblem<'a> {
    pub(crate) fn new(model: &ForceModel, records: &'a [ForceRecord]) -> Result<Self, IdentifyError> {
        let first = records
            .first()
            .ok_or_else(|| IdentifyError::missing("there is no record to identify; give at least one"))?;
        for record in records {
            record.require_units([first.position_unit(), first.force_unit()])?;
            let names = |record: &ForceRecord| record.channels.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
            if model.has(Part::Channels) && names(record) != names(first) {
                return Err(IdentifyError::contradiction(format!(
                    "the records have different channels beside the force: {:?} and {:?}",
                    names(first),
                    names(record)
                )));
            }
            if record.loads.is_some() != first.loads.is_some() {
                return Err(IdentifyError::contradiction(
                    "some of the records have a normal load and some have not; give all of them, or none",
                ));
            }
        }
        if model.has(Part::LoadOffset) && first.loads.is_none() {
            return Err(IdentifyError::missing("a load offset needs a normal load that was measured"));
        }
        if model.has(Part::Channels) && first.channels.is_empty() {
            return Err(IdentifyError::missing(
                "the model has channels beside the force, but none was given with a record",
            ));
        }
        let parameters = model.parameters(records)?;
        let place = |name: &str| parameters.iter().position(|parameter| parameter.name() == name);
        let law = *model.law.law();
        let first_deflection = parameters.len() - if model.fits_deflections() { records.len() } else { 0 };
        let layout = Places {
            shapes: law.fitted().count(),
            deflection: (first_deflection < parameters.len()).then_some(first_deflection),
            asymmetry: place("asymmetry").filter(|_| model.has(Part::Asymmetry)),
            load_offset: place("load_offset").filter(|_| model.has(Part::LoadOffset)),
            delay: place("delay").filter(|_| model.has(Part::Delay)),
        };
        let longest = model.longest_delay(records);
        let mut rows = Vec::with_capacity(records.len());
        let (mut series, mut end) = (Vec::with_capacity(records.len()), 0);
        for record in records {
            let times = record.times();
            let (begin, last) = (times[0] + longest, times[times.len() - 1] - longest);
            let range = times.partition_point(|time| *time < begin)..times.partition_point(|time| *time <= last);
            if range.len() <= parameters.len() {
                return Err(IdentifyError::too_short(range.len(), parameters.len() + 1));
            }
            series.push(end..end + range.len());
            end += range.len();
            rows.push(range);
        }
        Ok(Self { records, law, parameters, rows, series, shapes: model.shapes(first), layout, idle: Pool::default() })
    }

    pub(crate) fn records(&self) -> &'a [ForceRecord] {
        self.records
    }

    pub(crate) fn law(&self) -> &Law {
        &self.law
    }

    /// Where the parameters beside the law begin.
    pub(crate) fn first_shape(&self) -> usize {
        self.layout.shapes
    }

    /// The place of the deflection at the beginning of `record`; `None` if it is not fitted.
    fn deflection(&self, record: usize) -> Option<usize> {
        self.layout.deflection.map(|first| first + record)
    }

    /// Whether the parameter at `place` belongs to one record alone.
    pub(crate) fn is_of_record(&self, place: usize) -> bool {
        self.layout.deflection.is_some_and(|first| place >= first)
    }

    pub(crate) fn delay(&self) -> Option<usize> {
        self.layout.delay
    }

    /// Of each record the residuals that are its.
    pub(crate) fn series(&self) -> &[Range<usize>] {
        &self.series
    }

    /// Of each record the samples that are compared.
    pub(crate) fn rows(&self) -> &[Range<usize>] {
        &self.rows
    }

    fn value(p: &[f64], place: Option<usize>) -> f64 {
        place.map_or(0.0, |place| p[place])
    }

    fn guide<'g, D: Scalar>(&self, record: usize, delay: D, deflection: D, places: &'g [Place]) -> Guide<'g, D>
    where
        'a: 'g,
    {
        let has_delay = self.layout.delay.is_some();
        Guide {
            motion: &self.records[record].motion,
            delay,
            has_delay,
            deflection,
            first: self.rows[record].start,
            places,
        }
    }

    #[inline]
    fn parts(&self, record: usize, p: &[f64], leaps: bool, row: usize, place: Place) -> Parts<'a> {
        let data = &self.records[record];
        let guide = self.guide(record, Self::value(p, self.layout.delay), 0.0, &[]);
        let elapsed = guide.elapsed(row, place);
        let motion = [&data.motion.positions, &data.motion.velocities, &data.motion.accelerations]
            .map(|series| guide.between(series, place, elapsed));
        let load = data.loads.as_ref().map_or(1.0, |loads| loads[row]) + Self::value(p, self.layout.load_offset);
        Parts { motion, channels: &data.channels, row, load, counts: place.slides || !leaps }
    }

    /// What the shapes add to the force.
    fn beside(&self, p: &[f64], parts: &Parts<'_>) -> f64 {
        self.shapes.iter().zip(&p[self.layout.shapes..]).map(|(shape, factor)| factor * parts.of(*shape).0).sum()
    }

    /// Residual of a sample whose friction coefficient is `friction`, and its slopes by that coefficient at a load of
    /// one and by what stands beside friction.
    #[inline]
    fn residual(&self, p: &[f64], parts: &Parts<'_>, friction: f64, force: f64) -> (f64, f64, f64) {
        if !parts.counts {
            return (0.0, 0.0, 0.0);
        }
        let beside = self.beside(p, parts);
        let slope = 1.0 + Self::value(p, self.layout.asymmetry) * friction.signum();
        (parts.load * slope * friction + beside - force, slope, 1.0)
    }

    /// Residuals, and with them what the force is proportional to: friction, then the shapes, each a column.
    pub(crate) fn linear(&self, p: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), EvaluationError> {
        let mut residuals = vec![0.0; self.len()];
        let mut columns = vec![vec![0.0; self.len()]; 1 + self.shapes.len()];
        let leaps = self.leaps(p);
        self.idle.lend(|buffers| {
            for (record, series) in self.series.iter().enumerate() {
                self.follow(record, p, buffers)?;
                let forces = &self.records[record].forces;
                let rows = self.rows[record].clone().zip(&buffers.places).zip(&buffers.plain);
                for (at, ((row, place), friction)) in series.clone().zip(rows) {
                    let parts = self.parts(record, p, leaps, row, *place);
                    let (residual, by_friction, by_rest) = self.residual(p, &parts, *friction, forces[row]);
                    residuals[at] = residual;
                    columns[0][at] = parts.load * by_friction * friction;
                    for (column, shape) in columns[1..].iter_mut().zip(&self.shapes) {
                        column[at] = by_rest * parts.of(*shape).0;
                    }
                }
            }
            Ok((residuals, columns))
        })
    }

    /// The deflections with which a fit begins, by their places.
    pub(crate) fn first_deflections(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        (0..self.records.len()).filter_map(|record| Some((self.deflection(record)?, self.first_deflection(record))))
    }

    /// How many samples count.
    pub(crate) fn counted(&self, p: &[f64]) -> usize {
        let (leaps, mut at) = (self.leaps(p), Vec::new());
        let of_record = |(record, rows): (&ForceRecord, &Range<usize>)| {
            places(&record.motion, rows.clone(), Self::value(p, self.layout.delay), &mut at);
            at.iter().filter(|place| place.slides || !leaps).count()
        };
        self.records.iter().zip(&self.rows).map(of_record).sum()
    }

    /// What the model says of the force at the samples of `record` that are compared: `None` for a sample of which it
    /// says nothing.
    pub(crate) fn predicted(&self, record: usize, p: &[f64]) -> Result<Vec<Option<f64>>, EvaluationError> {
        let mut residuals = vec![0.0; self.len()];
        self.evaluate(p, &mut residuals, None)?;
        let (data, rows) = (&self.records[record], &self.rows[record]);
        let mut at = Vec::new();
        places(&data.motion, rows.clone(), Self::value(p, self.layout.delay), &mut at);
        let is_known = |place: &Place| place.slides || !self.leaps(p);
        let said = residuals[self.series[record].clone()].iter().zip(&data.forces[rows.clone()]).zip(&at);
        Ok(said.map(|((residual, force), place)| is_known(place).then_some(residual + force)).collect())
    }

    /// Whether the law is one of the speed that leaps where the contact comes to rest.
    fn leaps(&self, p: &[f64]) -> bool {
        let at_rest = || self.law.steady(&p[..self.layout.shapes], 0.0, false);
        self.law.is_of_speed() && at_rest().is_some_and(|level| level > 0.0)
    }

    /// Deflection of the bristles (1) at the first sample of `record` with which a fit begins: they have come the way
    /// they go on.
    fn first_deflection(&self, record: usize) -> f64 {
        let data = &self.records[record];
        data.motion
            .velocities
            .iter()
            .find(|velocity| velocity.abs() > data.motion.rest_speed)
            .map_or(0.0, |velocity| velocity.signum())
    }

    fn follow(&self, record: usize, p: &[f64], buffers: &mut Buffers) -> Result<(), EvaluationError> {
        let delay = Self::value(p, self.layout.delay);
        places(&self.records[record].motion, self.rows[record].clone(), delay, &mut buffers.places);
        let deflection = Self::value(p, self.deflection(record));
        let guide = self.guide(record, delay, deflection, &buffers.places);
        (self.law.along)(&self.law.values(&p[..self.layout.shapes]), guide, &mut buffers.plain)
    }

    /// Derivatives of friction in up to [`DIRECTIONS`] of the parameters of law and delay.
    fn follow_seeded(
        &self,
        record: usize,
        p: &[f64],
        columns: &[usize],
        buffers: &mut Buffers,
    ) -> Result<(), EvaluationError> {
        let seeded = |j: usize| Dual::variable(p[j], columns.iter().position(|c| *c == j).unwrap_or(DIRECTIONS));
        let fitted: Vec<Dual<DIRECTIONS>> = (0..self.layout.shapes).map(seeded).collect();
        let delay = self.layout.delay.map_or(Dual::from(0.0), seeded);
        let deflection = self.deflection(record).map_or(Dual::from(0.0), seeded);
        let guide = self.guide(record, delay, deflection, &buffers.places);
        (self.law.along_with_derivatives)(&self.law.values(&fitted), guide, &mut buffers.seeded)
    }

    /// Fills the residuals, without derivatives.
    fn simulate_residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        let leaps = self.leaps(p);
        self.idle.lend(|buffers| {
            for (record, series) in self.series.iter().enumerate() {
                self.follow(record, p, buffers)?;
                let forces = &self.records[record].forces;
                let rows = self.rows[record].clone().zip(&buffers.places).zip(&buffers.plain);
                for (out, ((row, place), friction)) in residuals[series.clone()].iter_mut().zip(rows) {
                    let parts = self.parts(record, p, leaps, row, *place);
                    *out = self.residual(p, &parts, *friction, forces[row]).0;
                }
            }
            Ok(())
        })
    }
}

impl Residuals for ForceProblem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.series.last().map_or(0, |series| series.end)
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let Some(jacobian) = jacobian else { return self.simulate_residuals(p, residuals) };
        let rows = self.len();
        let is_free = |j: &usize| !self.parameters[*j].bounds().is_fixed();
        jacobian.fill(0.0);
        let leaps = self.leaps(p);
        self.idle.lend(|buffers| {
            for (record, series) in self.series.iter().enumerate() {
                let delay = Self::value(p, self.layout.delay);
                let data = &self.records[record];
                let of_law = (0..self.layout.shapes).chain(self.layout.delay).chain(self.deflection(record));
                let of_law: Vec<usize> = of_law.filter(is_free).collect();
                places(&data.motion, self.rows[record].clone(), delay, &mut buffers.places);
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
                    let samples = self.rows[record].clone().zip(&buffers.places).zip(&buffers.seeded);
                    for (at, ((row, place), friction)) in series.clone().zip(samples) {
                        let parts = self.parts(record, p, leaps, row, *place);
                        let (residual, by_friction, by_rest) =
                            self.residual(p, &parts, friction.value(), data.forces[row]);
                        for (direction, column) in columns.iter().enumerate() {
                            jacobian[column * rows + at] += parts.load * by_friction * friction.partial(direction);
                        }
                        if pass > 0 {
                            continue;
                        }
                        residuals[at] = residual;
                        if by_rest == 0.0 {
                            continue;
                        }
                        for (j, shape) in (self.layout.shapes..).zip(&self.shapes) {
                            jacobian[j * rows + at] = parts.of(*shape).0;
                        }
                        if let Some(j) = self.layout.asymmetry {
                            jacobian[j * rows + at] = parts.load * friction.value().abs();
                        }
                        if let Some(j) = self.layout.load_offset {
                            jacobian[j * rows + at] = by_friction * friction.value();
                        }
                        if let Some(j) = self.layout.delay.filter(is_free) {
                            jacobian[j * rows + at] -= self.rate_beside(record, p, place.node, &parts);
                        }
                    }
                }
            }
            Ok(())
        })
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }

    fn is_cheaper_combined(&self) -> bool {
        // Most of a pass with derivatives is the passage of the motion, and nearly every step is taken.
        self.layout.shapes <= DIRECTIONS
    }
}

impl ForceProblem<'_> {
    /// How fast what stands beside friction changes (force per s) between a sample and the next.
    fn rate_beside(&self, record: usize, p: &[f64], node: usize, parts: &Parts<'_>) -> f64 {
        let data = &self.records[record];
        let duration = data.motion.times[node + 1] - data.motion.times[node];
        let rates = [&data.motion.positions, &data.motion.velocities, &data.motion.accelerations]
            .map(|series| (series[node + 1] - series[node]) / duration);
        let slope = |shape: &Shape| -> f64 { parts.of(*shape).1.iter().zip(rates).map(|(a, b)| a * b).sum() };
        self.shapes.iter().zip(&p[self.layout.shapes..]).map(|(shape, factor)| factor * slope(shape)).sum()
    }
}

#[cfg(test)]
mod tests {
    use fmm_fit::check_jacobian;

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

    /// Every parameter of a law with state and of one of the speed, with all that can stand beside it.
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
            let model = ForceModel::named(&format!("{law} + {beside}")).unwrap();
            let records = [record()];
            let problem = ForceProblem::new(&model, &records).unwrap();
            let mut p = values;
            p.extend([0.3, 0.2, 0.05, 0.4, 2.0, 0.1, -0.2, 0.15, 0.7, 2.3e-3]);
            p.resize(problem.parameters().len(), 0.4);
            let doubt = check_jacobian(&problem, &p).unwrap();
            assert!(doubt.is_empty(), "{law}: {doubt:?}");
        }
    }
}
