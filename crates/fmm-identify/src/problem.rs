//! The least-squares problem of an identification: these records by that law.

use std::marker::PhantomData;
use std::ops::Range;

use fmm_fit::{EvaluationError, Residuals};
use fmm_friction::Role;
use fmm_model::{Dual, Parameter, Scalar};
use fmm_record::Quantity;
use fmm_sim::{Channels, Samples, Sampling, Simulated, Trajectory};

use crate::first_guess::Dissipation;
use crate::layout::{Layout, fitted, mass_of_stiffness};
use crate::{IdentifyError, Machine, RingDown};

/// The residuals "model less record" of one or several ring-downs by a law of family `F`, with exact derivatives.
///
/// Oscillator and law are shared by all records; initial position, initial velocity and offset are each
/// record's own. The initial velocity is never taken from the data: fixing it at a noisy maximum biases the
/// friction by up to 0.8 %.
///
/// Anything that takes [`Residuals`] can be applied to it; [`identify`](crate::identify) is what most want.
#[derive(Debug, Clone)]
pub struct RingDownProblem<'a, F> {
    machine: Machine,
    decays: &'a [RingDown],
    parameters: Vec<Parameter>,
    layout: Layout,
    family: PhantomData<F>,
}

/// Directions of derivative that one simulation carries; a law with more parameters takes several.
const DIRECTIONS: usize = 6;

/// Samples simulated at a time: memory beyond the solver's own stays below 2 MB however long the record.
const WINDOW: usize = 1 << 15;

impl<'a, F: Simulated> RingDownProblem<'a, F> {
    /// The problem of `decays` on `machine`.
    ///
    /// # Errors
    /// [`IdentifyError::NoRecord`] and [`IdentifyError::MixedRecords`].
    pub fn new(machine: Machine, decays: &'a [RingDown]) -> Result<Self, IdentifyError> {
        let describe = |decay: &RingDown| format!("{} in {}", decay.record().quantity(), decay.record().unit());
        let first = decays.first().ok_or(IdentifyError::NoRecord)?;
        if let Some(other) = decays.iter().find(|decay| describe(decay) != describe(first)) {
            return Err(IdentifyError::MixedRecords { first: describe(first), other: describe(other) });
        }
        let (layout, parameters) = Layout::of::<F>(&machine, decays);
        Ok(Self { machine, decays, parameters, layout, family: PhantomData })
    }

    /// The ring-downs up to their last peaks, if they are displacements and that leaves something out.
    pub(crate) fn up_to_last_peaks(&self) -> Option<Vec<RingDown>> {
        if self.decays[0].record().quantity() != Quantity::Displacement {
            return None;
        }
        let shortened = self.decays.iter().map(RingDown::up_to_last_peak).collect::<Vec<_>>();
        let any = shortened.iter().any(Option::is_some);
        let complete =
            shortened.into_iter().zip(self.decays).map(|(short, whole)| short.unwrap_or_else(|| whole.clone()));
        any.then(|| complete.collect())
    }

    /// The same problem with other records of the same kind and number.
    pub(crate) fn with_records<'b>(&self, decays: &'b [RingDown]) -> RingDownProblem<'b, F> {
        RingDownProblem {
            machine: self.machine,
            decays,
            parameters: self.parameters.clone(),
            layout: self.layout.clone(),
            family: PhantomData,
        }
    }

    pub(crate) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Shared values and initial state of `record` as numbers of type `D`, direction `first` being direction 0.
    fn motion<D: Scalar>(&self, record: usize, p: &[f64], first: usize) -> Vec<D> {
        (0..self.layout.directions())
            .map(|direction| {
                let value = p[self.layout.index(record, direction)];
                // A direction below `first` wraps to one that no number carries, which makes it a constant.
                D::variable(value, direction.wrapping_sub(first))
            })
            .collect()
    }

    /// Simulates `record` at the samples of `ranges`, window by window; `visit` gets the number of samples before
    /// the window, its samples' indices in the record, and the simulated samples.
    fn simulate<D: Scalar>(
        &self,
        record: usize,
        p: &[f64],
        first: usize,
        ranges: &[Range<usize>],
        mut visit: impl FnMut(usize, Range<usize>, &Samples<D>),
    ) -> Result<(), EvaluationError> {
        let decay = &self.decays[record];
        let motion = self.motion::<D>(record, p, first);
        let scenario = self.layout.scenario::<F, D>(&self.machine, &motion)?;
        let displacement = decay.record().quantity() == Quantity::Displacement;
        let channels = if displacement { Channels::Position } else { Channels::Velocity };
        let sampling = Sampling::uniform(decay.record().interval(), decay.record().len())?.keeping(channels);
        let mut trajectory = Trajectory::new();
        let mut before = 0;
        for range in ranges {
            for start in range.clone().step_by(WINDOW) {
                let samples = start..range.end.min(start + WINDOW);
                let Some(window) = sampling.window(samples.clone()) else { continue };
                F::simulate_into(&scenario, &window, &mut trajectory)?;
                let simulated = if displacement { trajectory.position() } else { trajectory.velocity() };
                let count = samples.len();
                visit(before, samples, simulated);
                before += count;
            }
        }
        Ok(())
    }

    /// The events of `record` up to its end.
    pub(crate) fn events(&self, record: usize, p: &[f64]) -> Result<Trajectory, EvaluationError> {
        let motion = self.motion::<f64>(record, p, 0);
        let scenario = self.layout.scenario::<F, f64>(&self.machine, &motion)?;
        let mut trajectory = Trajectory::new();
        let ends = Sampling::uniform(self.decays[record].record().duration(), 2)?.keeping(Channels::Position);
        F::simulate_into(&scenario, &ends, &mut trajectory)?;
        Ok(trajectory)
    }

    /// What the model says for every sample of `record`, its offset included.
    pub(crate) fn model(&self, record: usize, p: &[f64]) -> Result<Vec<f64>, EvaluationError> {
        let count = self.decays[record].record().len();
        let offset = self.offset(record, p);
        let mut model = vec![0.0; count];
        self.simulate::<f64>(record, p, 0, std::slice::from_ref(&(0..count)), |_, samples, simulated| {
            for (out, value) in model[samples].iter_mut().zip(simulated.values()) {
                *out = value + offset;
            }
        })?;
        Ok(model)
    }

    /// Start values, one set per hypothesis that the law can express, each inside the bounds.
    pub(crate) fn starts(&self) -> Vec<Vec<f64>> {
        let has = |role: Role| fitted::<F>().any(|parameter| parameter.role() == role);
        let (has_level, has_slope) = (has(Role::Level), has(Role::Slope));
        let hypotheses = self.decays[0].guess().hypotheses();
        let expressible = |dissipation: &&Dissipation| {
            (has_level || dissipation.friction == 0.0) && (has_slope || dissipation.damping == 0.0)
        };
        let mut starts: Vec<_> =
            hypotheses.iter().filter(expressible).map(|hypothesis| self.start(*hypothesis)).collect();
        if starts.is_empty() {
            starts.extend(hypotheses.first().map(|hypothesis| self.start(*hypothesis)));
        }
        starts
    }

    /// Start values under one hypothesis.
    fn start(&self, dissipation: Dissipation) -> Vec<f64> {
        let frequency = self.decays[0].guess().natural_frequency(dissipation);
        // An unknown mass starts at 1 kg; nothing in the record says better.
        let mut start = match self.layout.oscillator {
            1 => vec![frequency],
            _ => vec![1.0, 1.0 / mass_of_stiffness(1.0, frequency)],
        };
        start.extend(fitted::<F>().map(|parameter| match parameter.role() {
            Role::Level => dissipation.friction,
            Role::Slope => dissipation.damping,
            _ => 1.0,
        }));
        for decay in self.decays {
            let (position, velocity) = decay.guess().initial_state(dissipation);
            start.extend([position, velocity]);
            if decay.fixed_offset().is_none() {
                start.push(decay.guess().offset(dissipation));
            }
        }
        start.iter().zip(&self.parameters).map(|(value, parameter)| parameter.bounds().clamp(*value)).collect()
    }

    fn offset(&self, record: usize, p: &[f64]) -> f64 {
        self.decays[record].fixed_offset().unwrap_or_else(|| p[self.layout.own[record] + 2])
    }

    /// Each record with the number of residuals before its own.
    fn bases(&self) -> impl Iterator<Item = (usize, usize)> {
        let mut base = 0;
        self.decays.iter().enumerate().map(move |(record, decay)| {
            let this = base;
            base += decay.summary().samples;
            (record, this)
        })
    }

    /// Writes the residuals of `record`, which begin at `base`.
    fn write_residuals<D: Scalar>(
        &self,
        record: usize,
        base: usize,
        p: &[f64],
        samples: Range<usize>,
        simulated: &Samples<D>,
        residuals: &mut [f64],
    ) {
        let offset = self.offset(record, p);
        let measured = &self.decays[record].record().values()[samples];
        for ((out, model), measured) in residuals[base..].iter_mut().zip(simulated.values()).zip(measured) {
            *out = model + offset - measured;
        }
    }
}

impl<F: Simulated> Residuals for RingDownProblem<'_, F> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.decays.iter().map(|decay| decay.summary().samples).sum()
    }

    fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        for (record, base) in self.bases() {
            self.simulate::<f64>(record, p, 0, self.decays[record].kept(), |before, samples, simulated| {
                self.write_residuals(record, base + before, p, samples, simulated, residuals);
            })?;
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
        let rows = self.len();
        jacobian.fill(0.0);
        for (record, base) in self.bases() {
            for first in (0..self.layout.directions()).step_by(DIRECTIONS) {
                let carried = (self.layout.directions() - first).min(DIRECTIONS);
                let kept = self.decays[record].kept();
                self.simulate::<Dual<DIRECTIONS>>(record, p, first, kept, |before, samples, simulated| {
                    if first == 0 && !residuals.is_empty() {
                        self.write_residuals(record, base + before, p, samples, simulated, residuals);
                    }
                    for direction in 0..carried {
                        let Some(partial) = simulated.partial(direction) else { continue };
                        let start = self.layout.index(record, first + direction) * rows + base + before;
                        jacobian[start..start + partial.len()].copy_from_slice(partial);
                    }
                })?;
            }
            if self.decays[record].fixed_offset().is_none() {
                let start = (self.layout.own[record] + 2) * rows + base;
                jacobian[start..start + self.decays[record].summary().samples].fill(1.0);
            }
        }
        Ok(true)
    }
}
