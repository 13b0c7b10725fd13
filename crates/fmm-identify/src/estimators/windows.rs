//! Viscous fits over a few cycles at a time: damping against velocity.

use std::ops::Range;

use fmm_fit::{Derivatives, EvaluationError, Fit, Options, Residuals, autocorrelation_time, solve};
use fmm_model::{Bounds, Dual, Parameter, Scalar};
use fmm_record::Quantity;

use crate::error::IdentifyError;
use crate::estimators::free_vibration::FreeVibration;
use crate::experiment::Experiment;
use crate::law::naming::Units;
use crate::residuals::correlation::{are_correlated, correlated_covariance};
use fmm_model::Estimated;

/// The viscous fit over one window.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct WindowFit {
    /// First and last time of the window (s), on the time axis of the record.
    pub span: (f64, f64),
    /// c/m (1/s).
    pub damping: Estimated,
    /// f₀, natural frequency (Hz).
    pub natural_frequency: Estimated,
    /// V, the amplitude of the fitted velocity in the middle of the window (unit of the record, or that per second for
    /// a displacement).
    pub peak_velocity: f64,
    /// Measured velocity amplitude at the peak with which the window begins, in the same unit.
    pub first_peak_velocity: f64,
    /// Mean over the peaks with which its cycles begin, in the same unit.
    pub mean_peak_velocity: f64,
    /// The fit: covariance, rank, residuals.
    pub fit: Fit,
}

/// Fits of a free damped vibration over windows of a few cycles, as the thesis makes them for its Table 1 and Fig. 12.
///
/// ```text
/// x″ + (c/m) x′ + ω₀² x = 0                                          f₀, c/m, x₀, v₀ and offset free in each window
/// ```
///
/// Each window begins at a peak. A machine whose damping is c₁ + c₂|v| gives a line with the slope 8/(3π) c₂ in V.
/// Which V makes a difference of some percent: the amplitude in the middle of the window leaves 0.1 %, the mean over
/// the peaks that begin its five cycles 0.5 %, the first peak alone 2 %.
///
/// c/m may come out negative; where noise makes it so, that is what the window says. Standard uncertainties are
/// those of independent residuals, or of correlated ones where that is more.
///
/// ```
/// use std::f64::consts::PI;
///
/// use fmm_fit::{StraightLine, Weighting};
/// use fmm_identify::{Preparation, Experiment, Windows};
/// use fmm_model::{Damping, Oscillator};
/// # use fmm_friction::Coulomb;
/// # use fmm_record::{Quantity, Record};
/// # use fmm_sim::{Engine, RungeKutta, Sampling, Scenario};
///
/// // A velocity record of a machine with c = 0.2005 + 0.5148 |v|.
/// let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::new(0.2005, 0.5148)?);
/// # let scenario = Scenario::new(machine, Coulomb::new(0.0)?, 0.0)?.starting_at(0.0, 0.25)?;
/// # let motion = RungeKutta::new(1e-11)?.run(&scenario, &Sampling::uniform(1e-3, 6000)?)?;
/// # let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s")?;
/// let decay = Experiment::ring_down(&record, &Preparation::default())?;
/// let windows = Windows::default().fit(&decay)?;
/// assert_eq!(windows.len(), 2);
/// for window in &windows {
///     let expected = machine.damping().cycle_equivalent(window.peak_velocity);
///     assert!((10.391 * window.damping.value / expected - 1.0).abs() < 2e-3);
/// }
///
/// // The line through them; with sliding windows it has more points.
/// let windows = Windows::default().sliding_by(1).fit(&decay)?;
/// let velocity: Vec<f64> = windows.iter().map(|window| window.peak_velocity).collect();
/// let damping: Vec<f64> = windows.iter().map(|window| 10.391 * window.damping.value).collect();
/// let line = StraightLine::fit(&velocity, &damping, Weighting::Equal)?;
/// assert!((line.intercept() / 0.2005 - 1.0).abs() < 0.01);
/// assert!((line.slope() / (8.0 / (3.0 * PI) * 0.5148) - 1.0).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Windows {
    cycles: usize,
    step: Option<usize>,
    holds_first_sample: bool,
}

impl Default for Windows {
    /// Five cycles each, one after the other.
    fn default() -> Self {
        Self { cycles: 5, step: None, holds_first_sample: false }
    }
}

impl Windows {
    /// Cycles in each window (5); 0 counts as 1.
    #[must_use]
    pub fn with_cycles(mut self, cycles: usize) -> Self {
        self.cycles = cycles.max(1);
        self
    }

    /// Each window begins `cycles` after the one before, so that they overlap if that is fewer than they have; 0
    /// counts as 1. By default the next begins where the last one ends.
    #[must_use]
    pub fn sliding_by(mut self, cycles: usize) -> Self {
        self.step = Some(cycles.max(1));
        self
    }

    /// The fitted motion goes through the first sample of the window, as the thesis' A1 has it.
    ///
    /// It puts weight on that sample: at a maximum of a noisy record it biases the result, and where the damping
    /// depends on the amplitude it counts the beginning of the window more. Only so do five-cycle windows
    /// reproduce the thesis' 0.437 V + 0.2005 to the last digit.
    #[must_use]
    pub fn holding_first_sample(mut self) -> Self {
        self.holds_first_sample = true;
        self
    }

    /// Fits the windows of `decay`.
    ///
    /// # Errors
    /// [`IdentifyError::TooFew`] if it does not hold one window, [`IdentifyError::Fit`] if a fit cannot begin.
    pub fn fit(&self, decay: &Experiment) -> Result<Vec<WindowFit>, IdentifyError> {
        decay.require_free("the fit of windows")?;
        let (peaks, half_swings) = (decay.peaks(), self.cycles.saturating_mul(2));
        if peaks.len() <= half_swings {
            return Err(IdentifyError::too_few_half_swings(peaks.len(), half_swings.saturating_add(1)));
        }
        let step = self.step.unwrap_or(self.cycles).saturating_mul(2);
        let starts = (0..peaks.len() - half_swings).step_by(step);
        starts.map(|start| self.fit_one(decay, start)).collect()
    }

    /// Fits the window that begins at peak `start`.
    fn fit_one(&self, decay: &Experiment, start: usize) -> Result<WindowFit, IdentifyError> {
        let record = decay.record();
        let peaks = &decay.peaks()[start..=start + 2 * self.cycles];
        let (from, to) = (peaks[0].0, peaks[2 * self.cycles].0);
        let index =
            |time: f64| (((time - record.start()) / record.interval()).round().max(0.0) as usize).min(record.len());
        let samples = index(from)..index(to);
        let centre = decay.fixed_offset().unwrap_or_else(|| centre(peaks));
        let problem = WindowProblem::new(decay, samples.clone(), self.holds_first_sample);
        let fit = solve(&problem, &problem.start(peaks, centre), &Options::default())
            .map_err(|source| IdentifyError::Fit { law: LAW, source })?;
        let uncertainty = problem.uncertainties(&fit)?;
        let estimated = |j: usize| Estimated { value: fit.values()[j], uncertainty: uncertainty[j] };

        let vibration = problem.vibration(fit.values()).map_err(failure)?;
        let displacement = record.quantity() == Quantity::Displacement;
        let to_velocity = if displacement { 2.0 * std::f64::consts::PI * fit.values()[FREQUENCY] } else { 1.0 };
        let measured = |value: f64| to_velocity * (value - fit.values()[OFFSET]).abs();
        let begins = peaks.iter().step_by(2).take(self.cycles);
        Ok(WindowFit {
            span: (record.time(samples.start), record.time(samples.end.max(samples.start + 1) - 1)),
            damping: estimated(DAMPING),
            natural_frequency: estimated(FREQUENCY),
            peak_velocity: vibration.velocity_amplitude(0.5 * samples.len() as f64 * record.interval()),
            first_peak_velocity: measured(peaks[0].1),
            mean_peak_velocity: begins.map(|(_, value)| measured(*value)).sum::<f64>() / self.cycles as f64,
            fit,
        })
    }
}

/// Centre of alternating peaks that fall evenly.
fn centre(peaks: &[(f64, f64)]) -> f64 {
    let centres = peaks.windows(3).map(|three| 0.25 * (three[0].1 + three[2].1) + 0.5 * three[1].1);
    centres.sum::<f64>() / (peaks.len() - 2) as f64
}

fn failure(error: EvaluationError) -> IdentifyError {
    IdentifyError::simulation(LAW, error)
}

/// What is fitted, in errors.
const LAW: &str = "a free damped vibration";
/// Indices of the parameters.
const FREQUENCY: usize = 0;
const DAMPING: usize = 1;
const POSITION: usize = 2;
const VELOCITY: usize = 3;
const OFFSET: usize = 4;
const COUNT: usize = 5;

/// Residuals "model less record" of one window.
struct WindowProblem<'a> {
    decay: &'a Experiment,
    samples: Range<usize>,
    kept: Vec<usize>,
    holds_first_sample: bool,
    parameters: [Parameter; COUNT],
}

impl<'a> WindowProblem<'a> {
    fn new(decay: &'a Experiment, samples: Range<usize>, holds_first_sample: bool) -> Self {
        let inside = |index: &usize| samples.contains(index);
        let kept = decay.kept().iter().cloned().flatten().filter(inside).collect();
        let unit = decay.record().unit();
        let displacement = decay.record().quantity() == Quantity::Displacement;
        let units = Units::of(decay.record());
        let held = |is_held: bool| {
            if is_held { Bounds::new(0.0, 0.0).unwrap_or(Bounds::UNBOUNDED) } else { Bounds::UNBOUNDED }
        };
        let offset = decay.fixed_offset().and_then(|offset| Bounds::new(offset, offset).ok());
        let parameters = [
            Parameter::new("natural_frequency_hz", "f₀", "Hz").bounded(decay.frequency_bounds()),
            Parameter::new("damping_per_mass", "c/m", "1/s"),
            Parameter::named("initial_position", "x₀", units.position.to_string())
                .bounded(held(holds_first_sample && displacement)),
            Parameter::named("initial_velocity", "v₀", units.velocity().to_string())
                .bounded(held(holds_first_sample && !displacement)),
            Parameter::named("offset", "b", unit.to_owned()).bounded(offset.unwrap_or(Bounds::UNBOUNDED)),
        ];
        Self { decay, samples, kept, holds_first_sample, parameters }
    }

    /// Start values: the frequency of the record and the decay of the peaks.
    fn start(&self, peaks: &[(f64, f64)], centre: f64) -> Vec<f64> {
        let frequency = self.parameters[FREQUENCY].bounds().clamp(self.decay.summary().frequency);
        let angular = 2.0 * std::f64::consts::PI * frequency;
        let last = peaks.len() - 1;
        let (first, end) = ((peaks[0].1 - centre).abs(), (peaks[last].1 - centre).abs());
        let rate = if end > 0.0 && first > 0.0 { 2.0 * (first / end).ln() / (peaks[last].0 - peaks[0].0) } else { 0.0 };
        let height = peaks[0].1 - centre;
        let mut start = vec![frequency, rate, 0.0, 0.0, centre];
        // A velocity at its peak passes the centre; a displacement rests there.
        if self.decay.record().quantity() == Quantity::Displacement {
            start[POSITION] = height;
        } else {
            start[VELOCITY] = height;
            start[POSITION] = -height * rate / (angular * angular);
        }
        if self.holds_first_sample {
            start[self.held()] = 0.0;
        }
        start
    }

    /// The parameter that the first sample takes the place of.
    fn held(&self) -> usize {
        if self.decay.record().quantity() == Quantity::Displacement { POSITION } else { VELOCITY }
    }

    fn vibration<D: Scalar>(&self, p: &[D]) -> Result<FreeVibration<D>, EvaluationError> {
        let mut state = [p[POSITION], p[VELOCITY]];
        if self.holds_first_sample {
            state[self.held() - POSITION] = D::from(self.decay.record().values()[self.samples.start]) - p[OFFSET];
        }
        FreeVibration::new(p[FREQUENCY], p[DAMPING], state[0], state[1])
            .ok_or_else(|| EvaluationError::message("the damping is critical: nothing vibrates"))
    }

    /// Visits the model, offset included, at every kept sample.
    fn each<D: Scalar>(&self, p: &[D], mut visit: impl FnMut(usize, D, f64)) -> Result<(), EvaluationError> {
        let vibration = self.vibration(p)?;
        let record = self.decay.record();
        let displacement = record.quantity() == Quantity::Displacement;
        for (row, index) in self.kept.iter().enumerate() {
            let (position, velocity) = vibration.state((index - self.samples.start) as f64 * record.interval());
            visit(row, if displacement { position } else { velocity } + p[OFFSET], record.values()[*index]);
        }
        Ok(())
    }

    /// Standard uncertainties, 0 for what is held.
    fn uncertainties(&self, fit: &Fit) -> Result<[f64; COUNT], IdentifyError> {
        let time = autocorrelation_time(fit.residuals()).unwrap_or(1.0);
        let series = 0..self.kept.len();
        let correlated = if are_correlated(time) {
            correlated_covariance(self, fit, time, std::slice::from_ref(&series)).map_err(failure)?
        } else {
            None
        };
        let mut uncertainties = [0.0; COUNT];
        for (j, (u, estimate)) in uncertainties.iter_mut().zip(fit.estimates()).enumerate() {
            if estimate.parameter().bounds().is_fixed() {
                continue;
            }
            let parameters = || estimate.name().to_owned();
            let white = estimate
                .standard_uncertainty()
                .ok_or_else(|| IdentifyError::undetermined("a window of this length", parameters()))?;
            *u =
                correlated.as_ref().and_then(|covariance| covariance.standard_uncertainty(j)).unwrap_or(0.0).max(white);
        }
        Ok(uncertainties)
    }
}

impl Residuals for WindowProblem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.kept.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let Some(jacobian) = jacobian else {
            return self.each(p, |row, model, measured| residuals[row] = model - measured);
        };
        let variables: Vec<Dual<COUNT>> = p.iter().enumerate().map(|(j, value)| Dual::variable(*value, j)).collect();
        let rows = self.len();
        self.each(&variables, |row, model, measured| {
            residuals[row] = model.value() - measured;
            for j in 0..COUNT {
                jacobian[j * rows + row] = model.partial(j);
            }
        })
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}
