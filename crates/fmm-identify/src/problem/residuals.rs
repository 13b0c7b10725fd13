//! Residuals of a problem and their derivatives, record by record and window by window.

use std::ops::Range;

use fmm_fit::{Block, Derivatives, EvaluationError, Residuals};
use fmm_model::Parameter;

use super::Problem;
use crate::law::DIRECTIONS;
use crate::threads::on_all_threads;

/// What one simulation with derivatives fills: the columns of a few directions of one record, and with the first of
/// them its residuals and the column of its sensor's corner.
struct Part<'o> {
    record: usize,
    first: usize,
    columns: &'o mut [f64],
    residuals: Option<&'o mut [f64]>,
    by_corner: Option<&'o mut [f64]>,
}

impl Problem<'_> {
    /// That the motion follows the parameter at `index`, of this `value`, less steeply than any that can be fitted.
    fn require_smooth(
        &self,
        record: usize,
        index: usize,
        value: f64,
        derivatives: &[f64],
    ) -> Result<(), EvaluationError> {
        /// Amplitudes by which a relative change of one would move the motion. The phase of ten million periods moves
        /// by as much.
        const STEEP: f64 = 1e8;
        let most = STEEP * self.decays[record].summary().amplitudes.0;
        if derivatives.iter().all(|derivative| (derivative * value).abs() <= most) {
            return Ok(());
        }
        let name = self.parameters[index].name();
        Err(EvaluationError::message(format!("the motion changes with {name} by leaps near {value:e}")))
    }

    /// Fills the columns of `record` that no simulation is needed for: those of the offset and of the disturbances. The
    /// one of the sensor's corner, which is the last, is returned.
    fn fill_beside<'o>(&self, record: usize, mut columns: &'o mut [f64]) -> Option<&'o mut [f64]> {
        let decay = &self.decays[record];
        let (rows, weight) = (decay.summary().samples, self.weights[record]);
        if decay.fixed_offset().is_none() {
            let column;
            (column, columns) = columns.split_at_mut(rows);
            column.fill(weight);
        }
        for shape in decay.shapes() {
            let column;
            (column, columns) = columns.split_at_mut(rows);
            let kept = decay.kept().iter().flat_map(|range| &shape[range.clone()]);
            column.iter_mut().zip(kept).for_each(|(out, shape)| *out = weight * shape);
        }
        Some(columns).filter(|columns| !columns.is_empty())
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
        let Part { record, first, columns, mut residuals, mut by_corner } = part;
        let rows = self.decays[record].summary().samples;
        let simulate = self.law().with_derivatives;
        self.simulate(simulate, record, p, first, self.decays[record].kept(), |before, samples, inside, simulated| {
            if let Some(residuals) = &mut residuals {
                self.write_residuals(record, before, p, samples, &simulated.values()[inside.clone()], residuals);
            }
            if let (Some(out), Some(by_corner)) = (&mut by_corner, simulated.by_corner()) {
                out[before..before + inside.len()].copy_from_slice(&by_corner[inside.clone()]);
            }
            for (direction, column) in columns.chunks_exact_mut(rows).enumerate() {
                let Some(partial) = simulated.partial(direction) else { continue };
                column[before..before + inside.len()].copy_from_slice(&partial[inside.clone()]);
            }
        })?;
        for (direction, column) in (first..).zip(columns.chunks_exact(rows)) {
            let index = self.layout.index(record, direction);
            self.require_smooth(record, index, p[index], column)?;
        }
        let weight = self.weights[record];
        if weight != 1.0 {
            for element in columns.iter_mut().chain(by_corner.into_iter().flatten()) {
                *element *= weight;
            }
        }
        Ok(())
    }

    /// Fills all residuals by simulations without derivatives.
    fn simulate_residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        for (record, base) in self.bases() {
            self.simulate(
                self.law().plain,
                record,
                p,
                0,
                self.decays[record].kept(),
                |before, samples, inside, simulated| {
                    self.write_residuals(record, base + before, p, samples, &simulated.values()[inside], residuals);
                },
            )?;
        }
        Ok(())
    }

    /// Writes the residuals of `record`, which begin at `base`.
    fn write_residuals(
        &self,
        record: usize,
        base: usize,
        p: &[f64],
        samples: Range<usize>,
        simulated: &[f64],
        residuals: &mut [f64],
    ) {
        let offset = self.offset(record, p);
        let measured = &self.decays[record].record().values()[samples.clone()];
        for ((out, model), measured) in residuals[base..].iter_mut().zip(simulated).zip(measured) {
            *out = model + offset - measured;
        }
        for (size, shape) in self.disturbances(record, p) {
            let shape = &shape[samples.clone()];
            residuals[base..].iter_mut().zip(shape).for_each(|(out, shape)| *out += size * shape);
        }
        let weight = self.weights[record];
        if weight != 1.0 {
            residuals[base..base + simulated.len()].iter_mut().for_each(|out| *out *= weight);
        }
    }
}

impl Residuals for Problem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.decays.iter().map(|decay| decay.summary().samples).sum()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let Some(jacobian) = jacobian else { return self.simulate_residuals(p, residuals) };
        jacobian.fill(0.0);
        let (mut columns, mut values) = (jacobian, residuals);
        let mut parts = Vec::new();
        for (record, decay) in self.decays.iter().enumerate() {
            let rows = decay.summary().samples;
            let (own, others) = columns.split_at_mut(rows * self.blocks[record].parameters().len());
            let (of_record, of_others) = values.split_at_mut(rows);
            (columns, values) = (others, of_others);
            let (of_motion, beside) = own.split_at_mut(rows * self.layout.directions(record));
            let (mut of_record, mut by_corner) = (Some(of_record), self.fill_beside(record, beside));
            for (number, columns) in of_motion.chunks_mut(DIRECTIONS * rows).enumerate() {
                let (residuals, by_corner) = (of_record.take(), by_corner.take());
                parts.push(Part { record, first: number * DIRECTIONS, columns, residuals, by_corner });
            }
        }
        self.differentiate(p, parts)
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }
}

#[cfg(test)]
mod tests {
    use fmm_friction::{CoulombViscous, Stribeck};
    use fmm_model::Oscillator;
    use fmm_record::{Quantity, Record};
    use fmm_sim::{Engine, Exact, Sampling, Scenario};

    use super::super::WINDOW;
    use super::super::tests::require_derivatives;
    use super::*;
    use crate::experiment::nuisance::DRIFT;
    use crate::experiment::{Experiment, Preparation, Sensor};
    use crate::machine::Machine;

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
        let problem = Problem::new::<Stribeck>(Machine::per_unit_mass(), &decays).unwrap();
        assert!(problem.weights[1] != 1.0 && problem.layout().directions(0) > DIRECTIONS);
        require_derivatives(&problem, &values(&problem));
    }

    #[test]
    fn residuals_are_the_model_less_the_record_by_weight() {
        let decays = decays();
        let problem = Problem::new::<Stribeck>(Machine::per_unit_mass(), &decays).unwrap();
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

    #[test]
    fn a_motion_that_leaps_is_refused() {
        let decays = decays();
        let problem = Problem::new::<Stribeck>(Machine::per_unit_mass(), &decays).unwrap();
        let steepest = 1e8 * decays[0].summary().amplitudes.0 / 4.0;
        assert!(problem.require_smooth(0, 0, 4.0, &[0.0, -0.99 * steepest]).is_ok());
        for derivative in [1.01 * steepest, -1.01 * steepest, f64::NAN] {
            assert!(problem.require_smooth(0, 0, 4.0, &[0.0, derivative]).is_err(), "{derivative:e}");
        }
    }
}
