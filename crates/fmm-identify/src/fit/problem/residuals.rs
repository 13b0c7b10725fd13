//! Residuals of a problem and their derivatives, record by record and window by window.

use std::ops::Range;

use fmm_fit::{Block, EvaluationError, Residuals};
use fmm_model::Parameter;

use super::Problem;
use crate::law::DIRECTIONS;

impl Problem<'_> {
    /// That the motion follows the parameter at `index`, of this `value`, less steeply than any that can be fitted.
    fn require_smooth(
        &self,
        record: usize,
        index: usize,
        value: f64,
        derivatives: &[f64],
    ) -> Result<(), EvaluationError> {
        /// Amplitudes by which a relative change of one would move the motion. The phase of ten million periods moves by as much.
        const STEEP: f64 = 1e8;
        let most = STEEP * self.decays[record].summary().amplitudes.0;
        if derivatives.iter().all(|derivative| (derivative * value).abs() <= most) {
            return Ok(());
        }
        let name = self.parameters[index].name();
        Err(EvaluationError::message(format!("the motion changes with {name} by leaps near {value:e}")))
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

    fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
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

    fn jacobian(&self, p: &[f64], jacobian: &mut [f64]) -> Result<bool, EvaluationError> {
        self.residuals_and_jacobian(p, &mut [], jacobian)
    }

    fn residuals_and_jacobian(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<bool, EvaluationError> {
        jacobian.fill(0.0);
        let mut elements = 0;
        for (record, base) in self.bases() {
            let rows = self.decays[record].summary().samples;
            for first in (0..self.layout.directions(record)).step_by(DIRECTIONS) {
                let carried = (self.layout.directions(record) - first).min(DIRECTIONS);
                let kept = self.decays[record].kept();
                self.simulate(
                    self.law().with_derivatives,
                    record,
                    p,
                    first,
                    kept,
                    |before, samples, inside, simulated| {
                        if first == 0 && !residuals.is_empty() {
                            let values = &simulated.values()[inside.clone()];
                            self.write_residuals(record, base + before, p, samples, values, residuals);
                        }
                        if let (0, Some(by_corner)) = (first, simulated.by_corner()) {
                            let start = elements + (self.blocks[record].parameters().len() - 1) * rows + before;
                            jacobian[start..start + inside.len()].copy_from_slice(&by_corner[inside.clone()]);
                        }
                        for direction in 0..carried {
                            let Some(partial) = simulated.partial(direction) else { continue };
                            let start = elements + (first + direction) * rows + before;
                            jacobian[start..start + inside.len()].copy_from_slice(&partial[inside.clone()]);
                        }
                    },
                )?;
                for direction in first..first + carried {
                    let index = self.layout.index(record, direction);
                    let column = &jacobian[elements + direction * rows..][..rows];
                    self.require_smooth(record, index, p[index], column)?;
                }
            }
            if self.decays[record].fixed_offset().is_none() {
                let start = elements + self.layout.directions(record) * rows;
                jacobian[start..start + rows].fill(1.0);
            }
            let decay = &self.decays[record];
            let beside = self.layout.directions(record) + usize::from(decay.fixed_offset().is_none());
            for (column, shape) in decay.shapes().iter().enumerate() {
                let start = elements + (beside + column) * rows;
                let kept = decay.kept().iter().flat_map(|range| &shape[range.clone()]);
                jacobian[start..start + rows].iter_mut().zip(kept).for_each(|(out, shape)| *out = *shape);
            }
            let end = elements + rows * self.blocks[record].parameters().len();
            let weight = self.weights[record];
            if weight != 1.0 {
                jacobian[elements..end].iter_mut().for_each(|element| *element *= weight);
            }
            elements = end;
        }
        Ok(true)
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }
}
