//! Residuals of a problem and their derivatives, record by record and window by window.

use std::ops::Range;

use fmm_fit::{Block, Derivatives, EvaluationError, Residuals};
use fmm_model::{Dual, Parameter, widest};

use super::Problem;
use crate::law::{DIRECTIONS, FEW, Simulate};
use crate::problem::idle::Simulated;
use crate::quantities::rows::Place;
use crate::threads::on_all_threads;

/// Columns that one simulation with derivatives fills: those of a few parameters of one record, and with the first of
/// them its residuals and the column of its sensor's corner.
struct Part<'o> {
    record: usize,
    directions: Vec<usize>,
    columns: Vec<&'o mut [f64]>,
    residuals: Option<&'o mut [f64]>,
    by_corner: Option<&'o mut [f64]>,
}

impl Problem<'_> {
    /// Largest derivative of the motion of `record` by a parameter of this `value`; steeper ones can't be fitted.
    fn steepest(&self, record: usize, value: f64) -> f64 {
        /// Largest change of the motion, in amplitudes, for a parameter that is doubled (1). Origin: that of the phase
        /// after ten million periods.
        const STEEP: f64 = 1e8;
        (STEEP * self.experiments[record].summary().amplitudes.0 / value.abs()).min(f64::MAX)
    }

    /// True if derivatives by the parameter at `index` are asked for.
    fn is_wanted(&self, index: usize) -> bool {
        !self.parameters[index].bounds().is_fixed()
    }

    /// Writes what the rows of `record` see of `samples`, one for each sample that is used.
    fn map(&self, record: usize, samples: &[f64], rows: &mut [f64]) -> Result<(), EvaluationError> {
        if let Some(lines) = self.experiments[record].lines() {
            return lines.transform(samples, rows);
        }
        rows.copy_from_slice(samples);
        Ok(())
    }

    /// Fills the `columns` of `record` that need no simulation, those of the offset and of the disturbances, and gives the
    /// others to `parts`, so many to each; derivatives by what is held are not written.
    fn divide<'o>(
        &self,
        record: usize,
        columns: &'o mut [f64],
        residuals: &'o mut [f64],
        parts: &mut Vec<Part<'o>>,
    ) -> Result<(), EvaluationError> {
        let experiment = &self.experiments[record];
        let weight = self.weights[record];
        let (mut residuals, mut by_corner) = (Some(residuals), None);
        let (mut directions, mut wanted) = (Vec::new(), Vec::new());
        let columns = columns.chunks_exact_mut(experiment.rows().max(1));
        for (column, &index) in columns.zip(self.blocks[record].parameters()) {
            match self.table.rows[index].place {
                _ if !self.is_wanted(index) => {}
                Place::Offset if experiment.lines().is_none() => column.fill(weight),
                Place::Offset => self.map(record, &vec![weight; experiment.summary().samples], column)?,
                Place::Disturbance(at) => {
                    let shape = &experiment.shapes[at];
                    let kept = experiment.kept().iter().flat_map(|range| &shape[range.clone()]);
                    self.map(record, &kept.map(|shape| weight * shape).collect::<Vec<_>>(), column)?;
                }
                Place::Corner => {
                    column.fill(0.0);
                    by_corner = Some(column);
                }
                _ => {
                    directions.push(index);
                    wanted.push(column);
                }
            }
        }
        let most = if directions.len() <= FEW { FEW } else { DIRECTIONS };
        let mut wanted = wanted.into_iter();
        // A record of which no parameter is free has residuals all the same.
        let groups = if directions.is_empty() { vec![&[][..]] } else { directions.chunks(most).collect() };
        for directions in groups {
            let (residuals, by_corner) = (residuals.take(), by_corner.take());
            let columns = wanted.by_ref().take(directions.len()).collect();
            parts.push(Part { record, directions: directions.to_vec(), columns, residuals, by_corner });
        }
        Ok(())
    }

    /// Fills all `parts`. What has no closed form takes long enough to be spread over threads; the result is the same.
    fn differentiate(&self, p: &[f64], parts: Vec<Part<'_>>) -> Result<(), EvaluationError> {
        if parts.len() > 1 && !self.law().is_piecewise_linear() {
            return on_all_threads(parts, |part| self.fill(p, part)).into_iter().collect();
        }
        parts.into_iter().try_for_each(|part| self.fill(p, part))
    }

    /// Fills one part by a simulation.
    fn fill(&self, p: &[f64], part: Part<'_>) -> Result<(), EvaluationError> {
        let experiment = &self.experiments[part.record];
        if experiment.lines().is_none() {
            return self.fill_samples(p, part);
        }
        let samples = experiment.summary().samples;
        let mut values = vec![vec![0.0; samples]; part.columns.len() + 1];
        let (residuals, columns) = values.split_at_mut(1);
        let of_samples = Part {
            record: part.record,
            directions: part.directions,
            columns: columns.iter_mut().map(Vec::as_mut_slice).collect(),
            residuals: Some(&mut residuals[0]),
            by_corner: None,
        };
        self.fill_samples(p, of_samples)?;
        if let Some(rows) = part.residuals {
            self.map(part.record, &values[0], rows)?;
        }
        part.columns.into_iter().zip(&values[1..]).try_for_each(|(rows, column)| self.map(part.record, column, rows))
    }

    /// Fills one part with what each used sample shows.
    fn fill_samples(&self, p: &[f64], part: Part<'_>) -> Result<(), EvaluationError> {
        let members = self.law().members;
        let few: Simulate<'_, Dual<FEW>> = &|motion, sampling, out| members.simulate(motion, sampling, out);
        let more: Simulate<'_, Dual<DIRECTIONS>> = &|motion, sampling, out| members.simulate(motion, sampling, out);
        if part.directions.len() <= FEW { self.fill_by(few, p, part) } else { self.fill_by(more, p, part) }
    }

    fn fill_by<const N: usize>(
        &self,
        simulate: Simulate<'_, Dual<N>>,
        p: &[f64],
        part: Part<'_>,
    ) -> Result<(), EvaluationError>
    where
        Dual<N>: Simulated,
    {
        let Part { record, directions, mut columns, mut residuals, mut by_corner } = part;
        let (kept, weight) = (self.experiments[record].kept(), self.weights[record]);
        let mut steep = None;
        self.simulate(simulate, record, p, &directions, kept, |before, samples, inside, seen| {
            let rows = before..before + inside.len();
            if let Some(residuals) = &mut residuals {
                self.write_residuals(record, p, samples, &seen.values()[inside.clone()], &mut residuals[rows.clone()]);
            }
            if let (Some(out), Some(by_corner)) = (&mut by_corner, seen.by_corner()) {
                write_weighted(&by_corner[inside.clone()], weight, f64::INFINITY, &mut out[rows.clone()]);
            }
            for ((index, column), direction) in directions.iter().zip(&mut columns).zip(0..) {
                let Some(partial) = seen.partial(direction) else { continue };
                let steepest = self.steepest(record, p[*index]);
                if !write_weighted(&partial[inside.clone()], weight, steepest, &mut column[rows.clone()]) {
                    steep = Some(*index);
                }
            }
        })?;
        let Some(index) = steep else { return Ok(()) };
        let (name, value) = (self.parameters[index].name(), p[index]);
        Err(EvaluationError::message(format!("the motion changes with {name} by leaps near {value:e}")))
    }

    /// Writes the residuals of `samples` of `record`.
    fn write_residuals(
        &self,
        record: usize,
        p: &[f64],
        samples: Range<usize>,
        simulated: &[f64],
        residuals: &mut [f64],
    ) {
        let offset = self.offset(record, p);
        let measured = &self.experiments[record].record().values()[samples.clone()];
        widest(
            #[inline(always)]
            || {
                // A copy is what vectors take.
                let zero = offset;
                for ((out, model), measured) in residuals.iter_mut().zip(simulated).zip(measured) {
                    *out = model + zero - measured;
                }
            },
        );
        for (size, shape) in self.disturbances(record, p) {
            let shape = &shape[samples.clone()];
            residuals.iter_mut().zip(shape).for_each(|(out, shape)| *out += size * shape);
        }
        let weight = self.weights[record];
        if weight != 1.0 {
            for out in residuals {
                *out *= weight;
            }
        }
    }

    /// Fills the residuals of `record` by a simulation without derivatives.
    fn simulate_residuals(&self, record: usize, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        let experiment = &self.experiments[record];
        let mut samples = vec![0.0; if experiment.lines().is_some() { experiment.summary().samples } else { 0 }];
        let out = if samples.is_empty() { &mut *residuals } else { &mut samples };
        let simulate: Simulate<'_, f64> = &|motion, sampling, trajectory| match self.euler {
            Some(euler) => euler(motion, sampling, trajectory),
            None => self.plain(motion, sampling, trajectory),
        };
        self.simulate(simulate, record, p, &[], experiment.kept(), |before, samples, inside, seen| {
            let out = &mut out[before..before + inside.len()];
            self.write_residuals(record, p, samples, &seen.values()[inside], out);
        })?;
        if samples.is_empty() { Ok(()) } else { self.map(record, &samples, residuals) }
    }
}

/// Writes `derivatives` times `weight`; false if one of them is larger than `most` or no number.
fn write_weighted(derivatives: &[f64], weight: f64, most: f64, out: &mut [f64]) -> bool {
    let smooth = widest(
        #[inline(always)]
        || {
            // Copies and a count are what vectors take.
            let (weight, most, mut smooth) = (weight, most, 0_u64);
            for (out, derivative) in out.iter_mut().zip(derivatives) {
                *out = derivative * weight;
                smooth += u64::from(derivative.abs() <= most);
            }
            smooth
        },
    );
    smooth == derivatives.len() as u64
}

impl Residuals for Problem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.blocks.iter().map(Block::rows).sum()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        if let Some(forces) = self.forces() {
            return forces.evaluate(p, residuals, jacobian);
        }
        let (measured, known) = residuals.split_at_mut(self.measured());
        self.prior.write_residuals(p, self.noise, known);
        let mut rest = measured;
        let Some(jacobian) = jacobian else {
            for (record, block) in (0..self.experiments.len()).zip(&self.blocks) {
                let (own, others) = rest.split_at_mut(block.rows());
                self.simulate_residuals(record, p, own)?;
                rest = others;
            }
            return Ok(());
        };
        let mut elements = jacobian;
        let mut parts = Vec::new();
        for (record, block) in (0..self.experiments.len()).zip(&self.blocks) {
            let (own, others) = rest.split_at_mut(block.rows());
            let (columns, further) = elements.split_at_mut(block.rows() * block.parameters().len());
            self.divide(record, columns, own, &mut parts)?;
            (rest, elements) = (others, further);
        }
        self.prior.write_jacobian(self.noise, elements);
        self.differentiate(p, parts)
    }

    fn derivatives(&self) -> Derivatives {
        if self.euler.is_some() { Derivatives::None } else { Derivatives::Free }
    }

    fn is_cheaper_combined(&self) -> bool {
        if let Some(forces) = self.forces() {
            return forces.is_cheaper_combined();
        }
        // Two directions cost about as much as none, more of them several times as much.
        self.euler.is_none() && (0..self.parameters.len()).filter(|index| self.is_wanted(*index)).count() <= FEW
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }
}

#[cfg(test)]
mod tests {
    use fmm_friction::{Coulomb, CoulombViscous, RegularisedStribeck, Stribeck};
    use fmm_model::Oscillator;
    use fmm_record::{Quantity, Record};
    use fmm_sim::{Engine, Exact, Sampling, Scenario};

    use super::super::WINDOW;
    use super::super::tests::require_derivatives;
    use super::*;
    use crate::candidate::Candidate;
    use crate::experiment::nuisance::DRIFT;
    use crate::experiment::{Experiment, Preparation, Sensor};
    use crate::machine::{Machine, Terms};

    /// A velocity behind a filter whose corner is fitted, and a displacement that drifts, in more samples than are
    /// simulated at a time.
    fn decays() -> Vec<Experiment> {
        let record = |quantity: Quantity, unit: &'static str, interval: f64, count: usize| {
            let law = CoulombViscous::new(0.3, 0.05).unwrap();
            let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
            let sampling = Sampling::uniform(interval, count).unwrap();
            let motion = Exact.run(&scenario.starting_at(0.02, 0.0).unwrap(), &sampling).unwrap();
            let samples = if quantity == Quantity::Velocity { motion.velocity() } else { motion.position() };
            // Without lines that a hum would have.
            let noise = |i: usize| 1e-4 * (((i * i * 7919) % 10_007) as f64 / 10_007.0 - 0.5);
            let values = samples.values().iter().enumerate().map(|(i, value)| value + noise(i)).collect();
            let record = Record::new(0.0, interval, values, quantity, unit).unwrap();
            Experiment::ring_down(&record, &Preparation::default()).unwrap()
        };
        let sensor = Sensor::default().with_free_low_pass(2).unwrap();
        vec![
            record(Quantity::Velocity, "m/s", 1e-3, 2000).seen_by(sensor).unwrap(),
            record(Quantity::Displacement, "m", 3e-5, WINDOW + 1000).beside(DRIFT.to_vec()),
        ]
    }

    /// Values of a curve that falls, offset and disturbances among them.
    fn values(problem: &Problem<'_>) -> Vec<f64> {
        let named = |parameter: &Parameter| match parameter.name() {
            "natural_frequency_hz" => 2.01,
            name if name.starts_with("offset") => 1e-3,
            name if name.starts_with("drift") => 2e-3,
            name if name.starts_with("initial_position") => 0.021,
            name if name.starts_with("initial_velocity") => 1e-3,
            name if name.contains("corner") => 40.0,
            "exponent" => 1.5,
            _ => 0.25,
        };
        problem.parameters().iter().map(named).collect()
    }

    #[test]
    fn derivatives_behind_sensors_and_beside_drift_are_those_of_differences() {
        let decays = decays();
        let problem = Problem::of(&Candidate::of::<Stribeck>(), Machine::per_unit_mass(), &decays).unwrap();
        assert!(problem.weights[1] != 1.0 && problem.table.directions(0) > DIRECTIONS);
        require_derivatives(&problem, &values(&problem));
    }

    #[test]
    fn derivatives_of_friction_that_changes_are_those_of_differences() {
        let decays = decays();
        let terms = Terms::default().with_curved_change().with_linear_damping();
        let decays = &decays[..1];
        let problem = Problem::of(&Candidate::of::<Coulomb>().with(terms), Machine::per_unit_mass(), decays).unwrap();
        let mut p = values(&problem);
        let place = |name: &str| problem.parameters().iter().position(|parameter| parameter.name() == name).unwrap();
        // Friction that grows ever faster: the motion has fewer reversals than differences may spoil.
        p[place("friction_change")] = 0.4;
        p[place("friction_change_slowing")] = -0.3;
        require_derivatives(&problem, &p);
    }

    #[test]
    fn residuals_are_the_model_less_the_record_by_weight() {
        let decays = decays();
        let problem = Problem::of(&Candidate::of::<Stribeck>(), Machine::per_unit_mass(), &decays).unwrap();
        let p = values(&problem);
        let mut residuals = vec![f64::NAN; problem.len()];
        problem.evaluate(&p, &mut residuals, None).unwrap();
        let mut left = residuals.as_slice();
        for (record, decay) in decays.iter().enumerate() {
            let model = problem.model(record, &p).unwrap();
            for i in decay.kept().iter().cloned().flatten() {
                let expected = (model[i] - decay.record().values()[i]) * problem.weights[record];
                assert!((left[0] - expected).abs() < 1e-12, "{} in place of {expected}, record {record}, {i}", left[0]);
                left = &left[1..];
            }
        }
        assert!(left.is_empty());
        let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
        let mut beside = vec![f64::NAN; problem.len()];
        problem.evaluate(&p, &mut beside, Some(&mut vec![f64::NAN; elements])).unwrap();
        assert_eq!(beside, residuals);
    }

    /// A contact that creeps at speeds that no record shows would take a million steps.
    #[test]
    fn a_motion_that_creeps_for_too_long_is_refused() {
        let decays = decays();
        let candidate = Candidate::of::<RegularisedStribeck>();
        let problem = Problem::of(&candidate, Machine::per_unit_mass(), &decays[..1]).unwrap();
        let mut p = values(&problem);
        let mut residuals = vec![0.0; problem.len()];
        let place = problem.parameters().iter().position(|parameter| parameter.name() == "peak_speed").unwrap();
        p[place] = 1e-2;
        problem.evaluate(&p, &mut residuals, None).unwrap();
        p[place] = 1e-7;
        let refused = problem.evaluate(&p, &mut residuals, None).unwrap_err().to_string();
        // Four periods in 2 s, and twenty more.
        let steps: f64 = refused.split("more than ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((steps - 300.0 * 24.0).abs() < 30.0, "{refused}");
    }

    #[test]
    fn a_motion_that_leaps_is_refused() {
        let decays = decays();
        let problem = Problem::of(&Candidate::of::<Stribeck>(), Machine::per_unit_mass(), &decays).unwrap();
        let steepest = problem.steepest(0, -4.0);
        assert_eq!(steepest, 1e8 * decays[0].summary().amplitudes.0 / 4.0);
        let mut out = [f64::NAN; 2];
        assert!(write_weighted(&[0.0, -0.99 * steepest], 0.5, steepest, &mut out));
        assert_eq!(out, [0.0, -0.495 * steepest]);
        for derivative in [1.01 * steepest, -1.01 * steepest, f64::NAN] {
            assert!(!write_weighted(&[derivative, 0.0], 1.0, steepest, &mut out), "{derivative:e}");
        }
    }
}
