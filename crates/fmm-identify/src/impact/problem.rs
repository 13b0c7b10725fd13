//! The least-squares problem of blows: these trials by that law.

use std::collections::BTreeMap;
use std::sync::Arc;

use fmm_fit::{Block, EvaluationError, Residuals};
use fmm_frf::RealTransform;
use fmm_model::{Damping, Dual, Oscillator, Parameter, Scalar};
use fmm_sim::{Channels, Excitation, Sampling, Simulated, Trajectory};

use crate::impact::lines::{Lines, Scratch};
use crate::impact::parameters::{LAW, Parameters, RESPONSE_GAIN};
use crate::impact::{ImpactDomain, ImpactMachine, ImpactOptions, ImpactTrial};
use crate::law::{DIRECTIONS as MANY, Law, Motion, Simulate};
use crate::pool::Pool;
use crate::{IdentifyError, Known};

/// The residuals "model less measurement" of one or several blows by a law, with exact derivatives.
///
/// The machine rests in the force-free position, held by friction, until the measured force, joined by straight lines between its
/// samples, breaks it loose; the motion is followed through every reversal to where it stops. What is compared is said by
/// [`ImpactDomain`], what can be found or held by [`ImpactOptions`]. The law's parameters and the machine are shared by
/// all trials. Everything that is not found is an input with an uncertainty, of which
/// [`Sensitivity`](fmm_fit::Sensitivity) can be asked.
///
/// A gain g of the force channel, reading by force, multiplies mass, stiffness, damping and load in the equation of motion,
/// which is how it enters here.
///
/// [`identify_impact`](crate::identify_impact) is what most want.
#[derive(Debug)]
pub struct ImpactProblem<'a> {
    law: ImpactLaw,
    machine: ImpactMachine,
    trials: &'a [ImpactTrial],
    parameters: Parameters,
    domain: ImpactDomain,
    lines: Arc<[Lines]>,
    /// For each trial, the spectrum of its velocity at its lines.
    spectra: Arc<[Vec<f64>]>,
    blocks: Vec<Block>,
    is_complete: bool,
    idle: Pool<Memory>,
}

/// Directions of derivative that one simulation carries if no more are wanted; [`MANY`] if so.
const FEW: usize = 2;

/// A law with its simulation in few directions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImpactLaw {
    law: Law,
    with_few: Simulate<Dual<FEW>>,
}

impl ImpactLaw {
    /// Family `F`.
    pub(crate) const fn of<F: Simulated>() -> Self {
        Self { law: Law::of::<F>(), with_few: Motion::simulate::<F> }
    }

    /// Name of the law.
    pub(crate) fn name(&self) -> &'static str {
        self.law.name
    }
}

/// The numbers of a simulation before those of the law: mass, stiffness, damping, load.
const MACHINE: usize = 4;

#[derive(Debug, Default)]
struct Memory {
    plain: Trajectory,
    few: Trajectory<Dual<FEW>>,
    many: Trajectory<Dual<MANY>>,
    scratch: Scratch,
    rows: Vec<f64>,
}

/// Band unless one is given, in natural frequencies.
const BAND: (f64, f64) = (0.5, 2.0);

impl<'a> ImpactProblem<'a> {
    /// The problem of `trials` on `machine` by a law of family `F`.
    ///
    /// # Errors
    /// [`IdentifyError::NoRecord`], [`IdentifyError::NoLine`], [`IdentifyError::UnknownParameter`],
    /// [`IdentifyError::HeldOutOfBounds`], and [`IdentifyError::TwoDampings`] if the damping is to be found beside a law that has
    /// a viscous part.
    pub fn new<F: Simulated>(
        machine: &ImpactMachine,
        trials: &'a [ImpactTrial],
        options: &ImpactOptions,
    ) -> Result<Self, IdentifyError> {
        Self::of(ImpactLaw::of::<F>(), machine, trials, options)
    }

    pub(crate) fn of(
        law: ImpactLaw,
        machine: &ImpactMachine,
        trials: &'a [ImpactTrial],
        options: &ImpactOptions,
    ) -> Result<Self, IdentifyError> {
        if trials.is_empty() {
            return Err(IdentifyError::NoRecord);
        }
        let mut parameters = Parameters::of(&law.law, machine, trials.len(), options)?;
        for (trial, of_trial) in trials.iter().enumerate() {
            let (index, summary) = (parameters.gain(trial), of_trial.summary());
            parameters.uncertainties[index] = (summary.impulse.uncertainty / summary.impulse.value).abs();
            parameters.uncertainties[index + 1] = summary.velocity_offset.uncertainty;
        }
        let natural = machine.natural_frequency_hz();
        let band = options.band.unwrap_or((BAND.0 * natural, BAND.1 * natural));
        // Trials are often of one length.
        let mut plans = BTreeMap::new();
        let of_trial = |trial: &ImpactTrial| {
            let length = trial.velocity().len();
            let plan = plans.entry(length).or_insert_with(|| RealTransform::new(length));
            Lines::new(plan.clone(), trial.summary().rate, band)
        };
        let lines = trials.iter().map(of_trial).collect::<Result<Vec<Lines>, _>>()?;
        let mut scratch = Scratch::default();
        let spectrum = |(lines, trial): (&Lines, &ImpactTrial)| {
            let mut rows = vec![0.0; lines.rows()];
            let done = lines.transform(0, trial.velocity(), &mut scratch, &mut rows);
            done.map(|()| rows)
                .map_err(|error| IdentifyError::Simulation { law: law.law.name, message: error.to_string() })
        };
        let spectra = lines.iter().zip(trials).map(spectrum).collect::<Result<Vec<_>, _>>()?;
        let mut problem = Self {
            law,
            machine: *machine,
            trials,
            parameters,
            domain: options.domain,
            lines: lines.into(),
            spectra: spectra.into(),
            blocks: Vec::new(),
            is_complete: false,
            idle: Pool::default(),
        };
        problem.blocks = problem.blocks_of_trials();
        Ok(problem)
    }

    /// The same problem in another domain.
    pub(crate) fn fitting(&self, domain: ImpactDomain) -> Self {
        let mut other = Self {
            law: self.law,
            machine: self.machine,
            trials: self.trials,
            parameters: self.parameters.clone(),
            domain,
            lines: Arc::clone(&self.lines),
            spectra: Arc::clone(&self.spectra),
            blocks: Vec::new(),
            is_complete: self.is_complete,
            idle: Pool::default(),
        };
        other.blocks = other.blocks_of_trials();
        other
    }

    /// The same problem with derivatives by the held parameters as well, for [`Sensitivity`](fmm_fit::Sensitivity). A fit of it
    /// would take longer.
    #[must_use]
    pub fn with_derivatives_by_inputs(mut self) -> Self {
        self.is_complete = true;
        self
    }

    /// The trials.
    pub fn trials(&self) -> &'a [ImpactTrial] {
        self.trials
    }

    /// Frequencies (Hz) of the lines of `trial` that lie in the band; none for a trial that is not there.
    pub fn frequencies(&self, trial: usize) -> impl Iterator<Item = f64> + '_ {
        self.lines.get(trial).into_iter().flat_map(Lines::frequencies)
    }

    pub(crate) fn law(&self) -> &Law {
        &self.law.law
    }

    pub(crate) fn machine(&self) -> &ImpactMachine {
        &self.machine
    }

    pub(crate) fn layout(&self) -> &Parameters {
        &self.parameters
    }

    pub(crate) fn domain(&self) -> ImpactDomain {
        self.domain
    }

    pub(crate) fn lines(&self, trial: usize) -> &Lines {
        &self.lines[trial]
    }

    /// Real and imaginary part of the velocity of `trial` at its lines.
    pub(crate) fn spectrum(&self, trial: usize) -> &[f64] {
        &self.spectra[trial]
    }

    fn blocks_of_trials(&self) -> Vec<Block> {
        let block = |trial| {
            let (samples, lines) = self.rows(trial);
            Block::new(samples + lines, self.parameters.of_trial(trial))
        };
        (0..self.trials.len()).map(block).collect()
    }

    /// How many residuals of `trial` are samples, and how many are parts of lines, which follow.
    pub(crate) fn rows(&self, trial: usize) -> (usize, usize) {
        let samples = if self.domain == ImpactDomain::Mobility { 0 } else { self.trials[trial].motion().len() };
        let lines = if self.domain == ImpactDomain::Time { 0 } else { self.lines[trial].rows() };
        (samples, lines)
    }

    /// Index among the parameters of number `number` of a simulation.
    fn index(number: usize) -> usize {
        if number < MACHINE { number } else { LAW + number - MACHINE }
    }

    /// Simulates `trial` by `simulate` from the begin of its blow on, with derivatives by the numbers of a simulation in `directions`, as far as
    /// its residuals need it.
    fn simulate<D: Scalar>(
        &self,
        simulate: Simulate<D>,
        trial: usize,
        p: &[f64],
        directions: &[usize],
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), EvaluationError> {
        let gain = p[self.parameters.gain(trial)];
        let number = |number: usize| {
            let value = p[Self::index(number)] * if number < MACHINE { gain } else { 1.0 };
            // What has no direction gets one that no number carries, which makes it a constant.
            D::variable(value, directions.iter().position(|d| *d == number).unwrap_or(usize::MAX))
        };
        let oscillator = Oscillator::new(number(0), number(1))?.with_damping(Damping::linear(number(2))?);
        let law: Vec<D> = (LAW..self.parameters.shared).map(|index| number(index - LAW + MACHINE)).collect();
        let trial = &self.trials[trial];
        let scenario = Motion {
            oscillator,
            law: self.law().values(&law),
            normal_load: number(3),
            initial: [D::from(0.0); 2],
            force: Some(Excitation::sampled_force(trial.interval(), trial.shared_force())?),
        };
        let (motion, all) = (trial.motion().len(), trial.velocity().len() - trial.begin());
        let sampling = Sampling::uniform(trial.interval(), all)?.keeping(Channels::Velocity);
        simulate(&scenario, &sampling.window(0..motion).unwrap_or_else(|| sampling.clone()), trajectory)?;
        if self.domain != ImpactDomain::Time && motion < all && trajectory.rest().is_none() {
            simulate(&scenario, &sampling, trajectory)?;
        }
        Ok(())
    }

    /// Samples and lines of a `series` that begins with the blow of `trial`.
    fn observe(
        &self,
        trial: usize,
        series: &[f64],
        scratch: &mut Scratch,
        rows: &mut Vec<f64>,
    ) -> Result<(), EvaluationError> {
        let (samples, lines) = self.rows(trial);
        rows.clear();
        rows.extend_from_slice(&series[..samples]);
        rows.resize(samples + lines, 0.0);
        if lines > 0 {
            self.lines[trial].transform(self.trials[trial].begin(), series, scratch, &mut rows[samples..])?;
        }
        Ok(())
    }

    /// Residuals of `trial` from what its model shows.
    fn write_residuals(&self, trial: usize, p: &[f64], model: &[f64], residuals: &mut [f64]) {
        let (gain, offset) = (p[RESPONSE_GAIN], p[self.parameters.gain(trial) + 1]);
        let (samples, _) = self.rows(trial);
        let of_trial = &self.trials[trial];
        let measured = of_trial.velocity()[of_trial.motion()].iter().take(samples);
        for ((out, model), measured) in residuals.iter_mut().zip(model).zip(measured) {
            *out = gain * model + offset - measured;
        }
        // A constant has no part in any line but that of zero frequency.
        for ((out, model), measured) in residuals.iter_mut().zip(model).skip(samples).zip(&self.spectra[trial]) {
            *out = gain * model - measured;
        }
    }

    fn is_wanted(&self, index: usize) -> bool {
        self.is_complete || !self.parameters.is_held(index)
    }

    /// The numbers of a simulation of `trial` by which derivatives are needed.
    fn directions(&self, trial: usize) -> Vec<usize> {
        let gain = self.is_wanted(self.parameters.gain(trial));
        let count = MACHINE + self.parameters.shared - LAW;
        (0..count).filter(|number| self.is_wanted(Self::index(*number)) || (gain && *number < MACHINE)).collect()
    }

    /// Residuals and columns of `trial` from a simulation with derivatives in `directions`.
    fn differentiate<const N: usize>(
        &self,
        (simulate, trajectory): (Simulate<Dual<N>>, &mut Trajectory<Dual<N>>),
        trial: usize,
        p: &[f64],
        directions: &[usize],
        (scratch, rows): (&mut Scratch, &mut Vec<f64>),
        (residuals, columns): (&mut [f64], &mut [f64]),
    ) -> Result<(), EvaluationError> {
        self.simulate(simulate, trial, p, directions, trajectory)?;
        let simulated = trajectory.velocity();
        let count = self.blocks[trial].rows();
        let (gain, response_gain) = (p[self.parameters.gain(trial)], p[RESPONSE_GAIN]);
        self.observe(trial, simulated.values(), scratch, rows)?;
        self.write_residuals(trial, p, rows, residuals);
        columns[RESPONSE_GAIN * count..][..count].copy_from_slice(rows);
        for (direction, &number) in directions.iter().enumerate() {
            let Some(partial) = simulated.partial(direction) else { continue };
            self.observe(trial, partial, scratch, rows)?;
            // Mass, stiffness, damping and load are simulated times the gain of the force.
            let (by_number, by_gain) = if number < MACHINE { (gain, p[number]) } else { (1.0, 0.0) };
            let column = &mut columns[Self::index(number) * count..][..count];
            column.iter_mut().zip(&*rows).for_each(|(out, row)| *out = response_gain * by_number * row);
            let column = &mut columns[self.parameters.shared * count..][..count];
            column.iter_mut().zip(&*rows).for_each(|(out, row)| *out += response_gain * by_gain * row);
        }
        Ok(())
    }

    /// What the model says for every sample of the record of `trial`, its offset left out.
    ///
    /// # Errors
    /// [`EvaluationError`] if the motion cannot be simulated with values `p`.
    pub(crate) fn model(&self, trial: usize, p: &[f64]) -> Result<Vec<f64>, EvaluationError> {
        let mut trajectory = Trajectory::<f64>::new();
        self.simulate(self.law().plain, trial, p, &[], &mut trajectory)?;
        let mut model = vec![0.0; self.trials[trial].velocity().len()];
        let simulated = trajectory.velocity().values().iter();
        for (out, value) in model[self.trials[trial].begin()..].iter_mut().zip(simulated) {
            *out = p[RESPONSE_GAIN] * value;
        }
        Ok(model)
    }

    /// The motion of `trial`, with its events counted from the begin of the blow.
    pub(crate) fn motion(&self, trial: usize, p: &[f64]) -> Result<Trajectory, EvaluationError> {
        let mut trajectory = Trajectory::new();
        self.simulate(self.law().plain, trial, p, &[], &mut trajectory)?;
        Ok(trajectory)
    }

    /// Standard uncertainty of what is known of the parameter at `index`.
    pub(crate) fn known(&self, index: usize) -> Option<Known> {
        Known::new(self.parameters.values[index], self.parameters.uncertainties[index]).ok()
    }
}

impl Residuals for ImpactProblem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters.all
    }

    fn len(&self) -> usize {
        self.blocks.iter().map(Block::rows).sum()
    }

    fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        self.idle.lend(|Memory { plain, scratch, rows, .. }| {
            let mut rest = residuals;
            for (trial, block) in self.blocks.iter().enumerate() {
                let (own, others) = rest.split_at_mut(block.rows());
                self.simulate(self.law().plain, trial, p, &[], plain)?;
                self.observe(trial, plain.velocity().values(), scratch, rows)?;
                self.write_residuals(trial, p, rows, own);
                rest = others;
            }
            Ok(())
        })
    }

    fn jacobian(&self, p: &[f64], jacobian: &mut [f64]) -> Result<bool, EvaluationError> {
        self.residuals_and_jacobian(p, &mut vec![0.0; self.len()], jacobian)
    }

    fn residuals_and_jacobian(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<bool, EvaluationError> {
        jacobian.fill(0.0);
        self.idle.lend(|Memory { few, many, scratch, rows, .. }| {
            let (mut rest, mut elements) = (residuals, jacobian);
            for (trial, block) in self.blocks.iter().enumerate() {
                let (own, others) = rest.split_at_mut(block.rows());
                let (columns, further) = elements.split_at_mut(block.rows() * block.parameters().len());
                let directions = self.directions(trial);
                if directions.len() <= FEW {
                    let run = (self.law.with_few, &mut *few);
                    self.differentiate(run, trial, p, &directions, (scratch, rows), (own, columns))?;
                } else {
                    for directions in directions.chunks(MANY) {
                        let run = (self.law().with_derivatives, &mut *many);
                        self.differentiate(run, trial, p, directions, (scratch, rows), (own, columns))?;
                    }
                }
                let (samples, _) = self.rows(trial);
                let offset = (block.parameters().len() - 1) * block.rows();
                columns[offset..offset + samples].fill(1.0);
                (rest, elements) = (others, further);
            }
            Ok(true)
        })
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn is_cheaper_combined(&self) -> bool {
        // Two directions cost about as much as none, more of them several times as much.
        self.directions(0).len() <= FEW
    }

    fn fills_fixed_columns(&self) -> bool {
        self.is_complete
    }
}
