//! The least-squares problem of blows: these trials by that law.

use std::collections::BTreeMap;
use std::sync::Arc;

use fmm_fit::{Block, Derivatives, EvaluationError, Residuals};
use fmm_frf::RealTransform;
use fmm_friction::LawFamily;
use fmm_model::Parameter;

use crate::error::IdentifyError;
use crate::experiment::ImpactTrial;
use crate::impact::lines::{Lines, Scratch};
use crate::impact::parameters::Parameters;
use crate::impact::pulse_prior::PulsePrior;
use crate::impact::simulation::{FEW, ImpactLaw, Memory};
use crate::impact::{ImpactDomain, ImpactMachine, ImpactOptions};
use crate::law::Law;
use crate::machine::Known;
use crate::threads::Pool;

/// The residuals "model less measurement" of one or several blows by a law, with exact derivatives.
///
/// The machine rests in the force-free position, held by friction, until the measured force, joined by straight lines
/// between its samples, breaks it loose; the motion is followed through every reversal to where it stops. What is
/// compared is said by [`ImpactDomain`], what can be found or held by [`ImpactOptions`]. The law's parameters and the
/// machine are shared by all trials. Everything that is not found is an input with an uncertainty, of which
/// [`Sensitivity`](fmm_fit::Sensitivity) can be asked.
///
/// A gain g of the force channel, reading by force, multiplies mass, stiffness, damping and load in the equation of
/// motion, which is how it enters here.
///
/// Between its samples a force is not known. Straight lines have its impulse and its centre on average over where the
/// samples lie, but of one blow both are a little off: by a relative error ε of the impulse, which acts as a gain 1 +
/// ε, and a delay δ. They are found with everything else, and what is known of them beforehand,
/// [`ImpactSummary::impulse`](crate::ImpactSummary) with its uncertainty, are residuals after those of the trials: σ
/// ε/u(ε) and σ δ/u(δ), with the noise σ of the velocity.
///
/// [`identify_impact`](crate::identify_impact) is what most want.
#[derive(Debug)]
pub struct ImpactProblem<'a> {
    law: ImpactLaw,
    machine: ImpactMachine,
    trials: &'a [ImpactTrial],
    parameters: Parameters,
    prior: PulsePrior,
    /// Standard deviation of the noise of the velocities (m/s), all trials together.
    noise: f64,
    domain: ImpactDomain,
    lines: Arc<[Lines]>,
    /// For each trial, the spectrum of its velocity at its lines.
    spectra: Arc<[Vec<f64>]>,
    blocks: Vec<Block>,
    is_complete: bool,
    idle: Pool<Memory>,
}

/// What rounding makes of a noise-free velocity, relative to the largest.
const ROUNDING: f64 = 1e-9;

/// Band unless one is given, in natural frequencies.
const BAND: (f64, f64) = (0.5, 2.0);

impl<'a> ImpactProblem<'a> {
    /// The problem of `trials` on `machine` by a law of family `F`.
    ///
    /// # Errors
    /// [`IdentifyError::Missing`], [`IdentifyError::NotSeen`], [`IdentifyError::UnknownName`],
    /// [`IdentifyError::OutOfRange`], and [`IdentifyError::Contradiction`] if the damping is to be found beside a law
    /// that has a viscous part.
    pub fn new<F: LawFamily>(
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
            return Err(IdentifyError::no_record());
        }
        let parameters = Parameters::of(&law.law, machine, trials, options)?;
        let prior = PulsePrior::of(&parameters, options.force_gain_uncertainty);
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
            done.map(|()| rows).map_err(|error| IdentifyError::simulation(law.law.name, error))
        };
        let spectra = lines.iter().zip(trials).map(spectrum).collect::<Result<Vec<_>, _>>()?;
        let mut problem = Self {
            law,
            machine: *machine,
            trials,
            parameters,
            prior,
            noise: noise(trials),
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
            prior: self.prior.clone(),
            noise: self.noise,
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

    /// The same problem with derivatives by the held parameters as well, for [`Sensitivity`](fmm_fit::Sensitivity). A
    /// fit of it would take longer.
    #[must_use]
    pub fn with_derivatives_by_inputs(mut self) -> Self {
        self.is_complete = true;
        self
    }

    /// The trials.
    pub fn trials(&self) -> &'a [ImpactTrial] {
        self.trials
    }

    /// Frequencies (Hz) of the lines of `trial` that lie in the band; `None` for a trial that is not there.
    pub fn frequencies(&self, trial: usize) -> impl Iterator<Item = f64> + '_ {
        self.lines.get(trial).into_iter().flat_map(Lines::frequencies)
    }

    pub(crate) fn law(&self) -> &Law {
        &self.law.law
    }

    pub(crate) fn family(&self) -> &ImpactLaw {
        &self.law
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
        let prior = self.prior.parameters();
        let last = (!prior.is_empty()).then(|| Block::new(prior.len(), prior));
        (0..self.trials.len()).map(block).chain(last).collect()
    }

    /// Standard deviation of the noise of the velocities (m/s), all trials together.
    pub(crate) fn noise(&self) -> f64 {
        self.noise
    }

    /// How many times what a record says is counted.
    pub(crate) fn repeats(&self) -> f64 {
        if self.domain == ImpactDomain::Both { 2.0 } else { 1.0 }
    }

    /// How many residuals are of trials; those of what is known of the pulses follow.
    pub(crate) fn measured(&self) -> usize {
        self.len() - self.prior.parameters().len()
    }

    /// What residuals of what is known of the pulses are in units of (m/s): they count as often as the record does.
    fn scale_of_prior(&self) -> f64 {
        self.noise * self.repeats().sqrt()
    }

    /// Whether the residuals depend on the parameter at `index`, or their derivatives by it are asked for all the same.
    pub(crate) fn is_wanted(&self, index: usize) -> bool {
        self.is_complete || !self.parameters.is_held(index)
    }

    /// How many residuals of `trial` are samples, and how many are parts of lines, which follow.
    pub(crate) fn rows(&self, trial: usize) -> (usize, usize) {
        let samples = if self.domain == ImpactDomain::Mobility { 0 } else { self.trials[trial].motion().len() };
        let lines = if self.domain == ImpactDomain::Time { 0 } else { self.lines[trial].rows() };
        (samples, lines)
    }

    /// Standard uncertainty of what is known of the parameter at `index`.
    pub(crate) fn known(&self, index: usize) -> Option<Known> {
        Known::new(self.parameters.values[index], self.parameters.uncertainties[index]).ok()
    }
}

/// Standard deviation of the noise of the velocities of all `trials` (m/s), at least that of rounding.
fn noise(trials: &[ImpactTrial]) -> f64 {
    let (mut sum, mut samples, mut speed) = (0.0, 0.0, 0.0f64);
    for trial in trials {
        let count = trial.motion().len() as f64;
        sum += count * trial.summary().velocity_noise.powi(2);
        samples += count;
        speed = speed.max(trial.summary().speed);
    }
    (sum / samples).sqrt().max(ROUNDING * speed)
}

impl Residuals for ImpactProblem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters.all
    }

    fn len(&self) -> usize {
        self.blocks.iter().map(Block::rows).sum()
    }

    fn evaluate(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> Result<(), EvaluationError> {
        if let Some(jacobian) = &mut jacobian {
            jacobian.fill(0.0);
        }
        self.idle.lend(|memory| {
            let (mut rest, mut elements) = (residuals, jacobian);
            for (trial, block) in (0..self.trials.len()).zip(&self.blocks) {
                let (own, others) = rest.split_at_mut(block.rows());
                rest = others;
                elements = match elements {
                    Some(elements) => {
                        let (columns, further) = elements.split_at_mut(block.rows() * block.parameters().len());
                        self.differentiate(trial, p, memory, own, columns)?;
                        Some(further)
                    }
                    None => {
                        self.simulate_residuals(trial, p, memory, own)?;
                        None
                    }
                };
            }
            self.prior.write_residuals(p, self.scale_of_prior(), rest);
            if let Some(elements) = elements {
                self.prior.write_jacobian(self.scale_of_prior(), elements);
            }
            Ok(())
        })
    }

    fn derivatives(&self) -> Derivatives {
        if self.is_complete { Derivatives::All } else { Derivatives::Free }
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn is_cheaper_combined(&self) -> bool {
        // Two directions cost about as much as none, more of them several times as much.
        self.directions(0).len() <= FEW
    }
}
