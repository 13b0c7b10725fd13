//! A fit repeated many times, each time with other fixed values.

use std::sync::{Mutex, PoisonError};

use fmm_model::Parameter;

use crate::algebra::spectrum::is_surely_of_full_rank;
use crate::algebra::triangle::Triangle;
use crate::error::FitError;
use crate::problem::block::{Scratch, Structure};
use crate::problem::knowledge::WithFixed;
use crate::problem::residuals::{Derivatives, Residuals};
use crate::result::estimate::EstimateStatus;
use crate::result::fit::Fit;
use crate::solver::minimizer::Minimizer;
use crate::solver::options::Options;
use crate::uncertainty::forecast::Forecast;
use crate::uncertainty::sensitivity::Sensitivity;

/// A step that moves the residuals by less than this share of what the parameters themselves make of them is no step.
const NEGLIGIBLE: f64 = 1e-10;

/// Gauss–Newton steps that have to get there; they do in two if the sensitivities foresee the new minimum.
const STEPS: usize = 8;

/// Share of the standard deviation of an estimate over the expected inputs that is nothing beside it.
const NOTHING: f64 = 1e-6;

/// Factor by which steps may fall more slowly at other inputs than at the expected ones (1).
const SLOWER: f64 = 2.0;

/// Residuals with kinks, as those of a motion whose stop passes a sample, may let steps go to and fro;
/// from within this share of the parameters' reach a search has the shorter way than from the forecast.
const NEAR: f64 = 1e-3;

/// End of Gauss–Newton steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Arrival {
    AtMinimum,
    Near,
    Lost,
}

/// A fit prepared to be repeated with other values of its fixed parameters, the inputs: the model of a
/// Monte Carlo calculation.
///
/// The [`Sensitivity`] of the fit foresees the minimum; Gauss–Newton steps take it there, until the
/// next one, by their rate of convergence, would change nothing. Two evaluations are enough as a rule. A problem
/// without derivatives, or a minimum that this does not reach within a few steps and the bounds, is handed to the
/// [`Minimizer`]. With the changes to expect given, one evaluation is often enough:
/// [`expecting`](Self::expecting).
///
/// The estimates depend on the inputs alone: not on the order of the calls, nor on the thread.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Automatic, Model, Options, Refit, solve};
/// use fmm_model::{Bounds, Parameter, Scalar};
///
/// /// A cooling cup, T = T₀ + a exp(−b t), in a room whose temperature T₀ was measured.
/// struct Cooling {
///     parameters: [Parameter; 3],
/// }
/// # impl Model for Cooling {
/// #     fn parameters(&self) -> &[Parameter] { &self.parameters }
/// #     fn len(&self) -> usize { 4 }
/// #     fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
/// #         for (r, (t, data)) in residuals.iter_mut().zip([(0.0, 80.1), (10.0, 55.9), (20.0, 41.3), (30.0, 32.8)]) {
/// #             *r = p[0] + p[1] * (-p[2] * t).exp() - data;
/// #         }
/// #         Ok(())
/// #     }
/// # }
/// let room = Parameter::new("room", "T₀", "°C").bounded(Bounds::new(20.0, 20.0)?);
/// let parameters = [room, Parameter::new("amplitude", "a", "K"), Parameter::new("rate", "b", "1/s")];
/// let problem = Automatic::<_, 3>::new(Cooling { parameters });
/// let fit = solve(&problem, &[20.0, 50.0, 0.01], &Options::default())?;
///
/// let refit = Refit::prepare(&problem, &fit)?;
/// let rate = |room: f64| refit.estimates(&[room]).map(|estimates| estimates[1]);
/// assert!((rate(20.0)? - fit.values()[2]).abs() < 1e-10);
/// // A warmer room: what is left cools away faster.
/// assert!(rate(21.0)? > rate(20.0)?);
///
/// // For many repetitions, with a temperature known to 0.5 °C: the same estimates, with less work each.
/// let foreseeing = Refit::prepare(&problem, &fit)?.expecting(&[0.5])?;
/// assert!((foreseeing.estimates(&[21.0])?[1] / rate(21.0)? - 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Refit<'a, P: ?Sized> {
    problem: &'a P,
    values: Vec<f64>,
    inputs: Vec<usize>,
    free: Vec<usize>,
    forecast: Forecast,
    convergence: Option<Convergence>,
    structure: Structure,
    is_direct: bool,
    options: Options,
    idle: Mutex<Vec<Workspace>>,
}

/// Buffers of one refit at a time.
#[derive(Debug, Default)]
struct Workspace {
    values: Vec<f64>,
    residuals: Vec<f64>,
    jacobian: Vec<f64>,
    triangle: Triangle,
    scratch: Scratch,
    step: Vec<f64>,
    /// The first two steps, and how many have led to the minimum: none if it was not reached so.
    first: [Vec<f64>; 2],
    taken: usize,
}

/// Rate at which Gauss–Newton steps fall at the expected inputs.
#[derive(Debug)]
struct Convergence {
    /// Standard deviations of the estimates over the inputs, in which a step is measured: by the largest of its parts.
    deviations: Vec<f64>,
    /// Longest first step (1) of which the second is known.
    longest: f64,
    /// Largest ratio (1) of a second step to the first.
    rate: f64,
}

impl Convergence {
    /// Taken from the first two `steps`; `None` if there are fewer, if they fall slowly, or if they move an estimate
    /// that the inputs do not.
    fn seen(deviations: Vec<f64>, steps: &[[Vec<f64>; 2]]) -> Option<Self> {
        let mut convergence = Self { deviations, longest: 0.0, rate: 0.0 };
        for [first, second] in steps {
            let length = convergence.length(first);
            convergence.longest = convergence.longest.max(length);
            convergence.rate = convergence.rate.max(convergence.length(second) / length);
        }
        let is_known = 0.0 < convergence.longest && convergence.longest.is_finite();
        (is_known && convergence.rate < 0.5 / SLOWER).then_some(convergence)
    }

    fn length(&self, step: &[f64]) -> f64 {
        let parts = step.iter().zip(&self.deviations).filter(|(part, _)| **part != 0.0);
        parts.map(|(part, deviation)| part.abs() / deviation).fold(0.0, f64::max)
    }

    /// True if all steps after this first one are nothing beside the changes of the estimates by the inputs.
    fn ends_with(&self, first: &[f64]) -> bool {
        let (length, rate) = (self.length(first), SLOWER * self.rate);
        length <= self.longest && length * rate / (1.0 - rate) <= NOTHING
    }
}

impl<'a, P: Residuals + ?Sized> Refit<'a, P> {
    /// Prepares to repeat `fit`, which must be a converged one of `problem`.
    ///
    /// # Errors
    /// [`FitError`] if it is not.
    pub fn prepare(problem: &'a P, fit: &Fit) -> Result<Self, FitError> {
        // Without derivatives of its own, differences of differences cost more than they foresee.
        let sensitivity = if fit.has_exact_jacobian() {
            Sensitivity::of(problem, fit)
        } else {
            Sensitivity::first_order(problem, fit)
        }?;
        let inputs = sensitivity.inputs().to_vec();
        let free: Vec<usize> = (0..problem.parameters().len()).filter(|j| !inputs.contains(j)).collect();
        let coefficient = |&j: &usize, &input: &usize| sensitivity.coefficient(j, input).unwrap_or(0.0);
        let slopes: Vec<f64> =
            free.iter().flat_map(|j| inputs.iter().map(move |input| coefficient(j, input))).collect();
        let at = |places: &[usize]| places.iter().map(|&j| fit.values()[j]).collect();
        let forecast = Forecast::straight(at(&free), at(&inputs), &slopes);
        let is_determined = |&j: &usize| fit.estimates()[j].status() == EstimateStatus::Determined;
        let is_direct = problem.derivatives() != Derivatives::None && free.iter().all(is_determined);
        Ok(Self {
            problem,
            values: fit.values().to_vec(),
            inputs,
            free,
            forecast,
            convergence: None,
            structure: Structure::of(problem)?,
            is_direct,
            options: Options::default(),
            idle: Mutex::default(),
        })
    }

    /// The same with these inputs only, in this order and each once; the others keep the values that they had in the
    /// fit.
    ///
    /// # Errors
    /// [`FitError::UnknownName`] for a name that was not fixed in the fit.
    pub fn varying(mut self, names: &[&str]) -> Result<Self, FitError> {
        let mut places = Vec::with_capacity(names.len());
        for name in names {
            let place = self.inputs().position(|input| input.name() == *name);
            places.push(place.ok_or_else(|| {
                let inputs = self.inputs().map(Parameter::name).collect::<Vec<_>>().join(", ");
                FitError::unknown_name(format!("{name:?} was not fixed in the fit; the fixed parameters are: {inputs}"))
            })?);
        }
        self.forecast = self.forecast.of_inputs(&places);
        self.convergence = None;
        self.inputs = places.iter().map(|&place| self.inputs[place]).collect();
        Ok(self)
    }

    /// The same for inputs that change by about these amounts, such as their standard uncertainties: the estimates are
    /// foreseen by a polynomial through refits at one and two of them either way instead of by a straight line. Its
    /// dozen fits for two inputs, two dozen for three, save an evaluation or more in every refit to come. They also
    /// show how fast steps fall, so that a refit ends where the next step would move no estimate by more than a
    /// millionth of its standard deviation over the inputs.
    ///
    /// An amount of zero is an input that does not change.
    ///
    /// # Errors
    /// [`FitError::Count`], [`FitError::OutOfRange`] for an amount that is not a finite number of at least zero,
    /// and as for [`estimates`](Self::estimates).
    pub fn expecting(mut self, spread: &[f64]) -> Result<Self, FitError> {
        self.require_count(spread.len())?;
        if let Some((input, spread)) =
            self.inputs().zip(spread).find(|(_, spread)| !(**spread >= 0.0 && spread.is_finite()))
        {
            let input = input.name();
            return Err(FitError::out_of_range(
                format!("{input} is expected to change by {spread}; a finite number of at least zero is needed"),
                *spread,
            ));
        }
        self.convergence = None;
        let (mut workspace, mut steps, mut is_followed) = (Workspace::default(), Vec::new(), true);
        self.forecast = self.forecast.through(spread, |inputs| {
            let estimates = self.estimates_in(&mut workspace, inputs)?;
            is_followed &= workspace.taken > 0;
            if workspace.taken > 1 {
                steps.push(workspace.first.clone());
            }
            Ok::<_, FitError>(estimates)
        })?;
        if is_followed {
            self.convergence = Convergence::seen(self.forecast.deviations(spread), &steps);
        }
        Ok(self)
    }

    /// The same with other options for the fits that the short way does not reach.
    #[must_use]
    pub fn with_options(mut self, options: Options) -> Self {
        self.options = options;
        self
    }

    /// The fixed parameters, in the order in which values are given.
    pub fn inputs(&self) -> impl ExactSizeIterator<Item = &Parameter> {
        self.inputs.iter().map(|&j| &self.problem.parameters()[j])
    }

    /// The estimated parameters, in the order of the estimates.
    pub fn estimated(&self) -> impl ExactSizeIterator<Item = &Parameter> {
        self.free.iter().map(|&j| &self.problem.parameters()[j])
    }

    /// The estimates with these values of the inputs.
    ///
    /// # Errors
    /// [`FitError`] if the inputs are not one finite number each, or if the fit fails.
    pub fn estimates(&self, inputs: &[f64]) -> Result<Vec<f64>, FitError> {
        self.require_count(inputs.len())?;
        let taken = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut workspace = taken.unwrap_or_default();
        let estimates = self.estimates_in(&mut workspace, inputs);
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(workspace);
        estimates
    }

    fn require_count(&self, given: usize) -> Result<(), FitError> {
        let inputs = self.inputs.len();
        if given == inputs {
            Ok(())
        } else {
            Err(FitError::count(format!("{given} values were given for {inputs} inputs")))
        }
    }

    fn estimates_in(&self, workspace: &mut Workspace, inputs: &[f64]) -> Result<Vec<f64>, FitError> {
        self.foresee(&mut workspace.values, inputs);
        match if self.is_direct { self.follow(workspace) } else { Arrival::Lost } {
            Arrival::AtMinimum => {}
            Arrival::Near => self.search(&mut workspace.values)?,
            Arrival::Lost => {
                self.foresee(&mut workspace.values, inputs);
                self.search(&mut workspace.values)?;
            }
        }
        Ok(self.free.iter().map(|&j| workspace.values[j]).collect())
    }

    /// Writes the inputs and where the minimum is expected.
    fn foresee(&self, values: &mut Vec<f64>, inputs: &[f64]) {
        values.clone_from(&self.values);
        for (&j, input) in self.inputs.iter().zip(inputs) {
            values[j] = *input;
        }
        for (&j, foreseen) in self.free.iter().zip(self.forecast.at(inputs)) {
            values[j] = self.problem.parameters()[j].bounds().clamp(foreseen);
        }
    }

    /// Gauss–Newton steps to the minimum.
    fn follow(&self, workspace: &mut Workspace) -> Arrival {
        let Workspace { values, residuals, jacobian, triangle, scratch, step, first, taken } = workspace;
        *taken = 0;
        residuals.resize(self.problem.len(), 0.0);
        jacobian.resize(self.structure.len(), 0.0);
        step.resize(self.free.len(), 0.0);
        let mut previous = None;
        for count in 0..STEPS {
            if self.problem.evaluate(values, residuals, Some(jacobian)).is_err() {
                return Arrival::Lost;
            }
            self.structure.factor(jacobian, &self.free, residuals, triangle, scratch);
            if !(triangle.is_finite() && is_surely_of_full_rank(triangle, residuals.len() as f64 * f64::EPSILON)) {
                return Arrival::Lost;
            }
            triangle.solve(step);
            if let Some(first) = first.get_mut(count) {
                first.clone_from(step);
            }
            for (&j, step) in self.free.iter().zip(step.iter()) {
                values[j] += step;
                if !self.problem.parameters()[j].bounds().contains(values[j]) {
                    return Arrival::Lost;
                }
            }
            // ‖R p‖ = ‖q‖: what the step does to the residuals.
            let length = (0..self.free.len()).map(|row| triangle.q(row).powi(2)).sum::<f64>().sqrt();
            let reach = |(column, &j): (usize, &usize)| values[j].abs() * triangle.column_norm(column);
            let reach = self.free.iter().enumerate().map(reach).sum::<f64>();
            // Steps fall at a constant rate at worst, so that all to come are at most this far together.
            let to_come = match previous.map(|previous: f64| length / previous) {
                None if self.convergence.as_ref().is_some_and(|convergence| convergence.ends_with(step)) => 0.0,
                None => length,
                Some(rate) if rate < 0.5 => length * rate / (1.0 - rate),
                Some(_) if length <= NEGLIGIBLE * reach => 0.0,
                Some(_) if length <= NEAR * reach => return Arrival::Near,
                Some(_) => return Arrival::Lost,
            };
            if to_come <= NEGLIGIBLE * reach {
                *taken = count + 1;
                return Arrival::AtMinimum;
            }
            previous = Some(length);
        }
        Arrival::Lost
    }

    /// A fit from these values.
    fn search(&self, values: &mut [f64]) -> Result<(), FitError> {
        let fixed = WithFixed::new(self.problem, self.inputs.iter().map(|&j| (j, values[j])))?;
        let mut minimizer = Minimizer::new(self.options.clone());
        let outcome = minimizer.minimize(&fixed, values)?;
        if !outcome.is_success() {
            return Err(FitError::no_minimum(format!("the fit ended without a minimum: {outcome}")));
        }
        values.copy_from_slice(minimizer.values());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(deviations: &[f64], steps: &[[[f64; 2]; 2]]) -> Option<Convergence> {
        let steps: Vec<_> = steps.iter().map(|pair| pair.map(|step| step.to_vec())).collect();
        Convergence::seen(deviations.to_vec(), &steps)
    }

    #[test]
    fn a_first_step_ends_where_the_rate_leaves_nothing() {
        // Lengths of 0.2 and 0.1 standard deviations, which fall to 0.0001 and 0.0002: by 0.002 at worst.
        let steps = [[[0.02, 0.4], [1e-5, 0.0]], [[0.0, -0.2], [0.0, 4e-4]]];
        let convergence = seen(&[0.1, 2.0], &steps).unwrap();
        assert!((convergence.longest - 0.2).abs() < 1e-15 && (convergence.rate - 0.002).abs() < 1e-15);
        // At twice that rate 2.4e-4 would be followed by 0.97e-6, 2.6e-4 by 1.04e-6.
        assert!(convergence.ends_with(&[2.4e-5, 0.0]) && convergence.ends_with(&[0.0, -4.8e-4]));
        assert!(!convergence.ends_with(&[2.6e-5, 0.0]));
        assert!(convergence.ends_with(&[0.0, 0.0]));
        // However fast they fell, a longer step than any is another matter.
        let fast = seen(&[1.0, 1.0], &[[[1e-3, 0.0], [0.0, 0.0]]]).unwrap();
        assert!(fast.ends_with(&[1e-3, 0.0]) && !fast.ends_with(&[1.1e-3, 0.0]));
    }

    #[test]
    fn convergence_that_shows_nothing_ends_nothing() {
        assert!(seen(&[1.0, 1.0], &[]).is_none());
        assert!(seen(&[1.0, 1.0], &[[[0.0, 0.0], [0.0, 0.0]]]).is_none());
        // Too slow to count on.
        assert!(seen(&[1.0, 1.0], &[[[1.0, 0.0], [0.3, 0.0]]]).is_none());
        // An estimate that does not depend on the inputs, but moves.
        assert!(seen(&[0.0, 1.0], &[[[1e-3, 1e-3], [0.0, 1e-6]]]).is_none());
        assert!(seen(&[0.0, 1.0], &[[[0.0, 1e-3], [0.0, 1e-6]]]).is_some());
    }
}
