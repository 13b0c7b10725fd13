//! One step of the collocation method: Newton's method for all stages at once, and the estimate of its error.

use fmm_friction::BristleLaw;
use fmm_model::Scalar;

use crate::bristle::field::{Branch, Field};
use crate::bristle::modes::Modes;
use crate::bristle::polynomial::{ROUNDING, Solved, Span, StepPolynomial};
use crate::bristle::radau::{
    CENTRED_COLUMNS, COEFFICIENTS_COLUMNS, FROM_MODES_COLUMNS, INVERSE_COLUMNS, NODES, STAGES, Stages,
    TO_MODES_COLUMNS, product,
};
use crate::error::SimulationError;
use crate::mechanics::Piece;

/// Greatest number of iterations for the values; if more are needed, a shorter step is better.
const MOST_ITERATIONS: i32 = 15;

/// Greatest number of iterations for the derivatives, which begin at the result of the step before.
const MOST_DERIVATIVE_ITERATIONS: usize = 60;

/// Remaining error of Newton's method, in units of the tolerance.
const LEFT_OVER: f64 = 0.01;

/// Correction above which the increments are not yet a measure of the motion (1): a prediction may be off by any
/// factor.
const FAR: f64 = 1e-2;

/// Step times stiffness below which the stiffness of a state does not count beside the eigenvalues of the method, 10 to
/// 13 (1). Measured: the number of iterations is least for 5 to 6.
const LEAST_STIFF: f64 = 6.0;

/// The method and its working memory.
pub(super) struct Collocation<D> {
    /// f(Yᵢ) at all stages, for each component.
    rates: Vec<Stages<D>>,
    residual: Vec<Stages<D>>,
    modes: Modes<D>,
    state: Vec<D>,
    rate: Vec<D>,
    /// Increments and length of a step from which this one is predicted, and the beginning of this one in units of that
    /// step: 1, or 0 for another attempt at that step.
    guess: Vec<Stages<D>>,
    guess_length: f64,
    guess_begin: f64,
    forces: [D; STAGES],
    /// Factors of the residuals of the states, for each state.
    weights: Vec<Stages<f64>>,
    relaxations: Vec<f64>,
}

impl<D: Scalar> Collocation<D> {
    pub(super) fn new(size: usize) -> Self {
        let zero = D::from(0.0);
        let stages = || vec![[zero; STAGES]; size];
        Self {
            rates: stages(),
            residual: stages(),
            modes: Modes::new(size),
            state: vec![zero; size],
            rate: vec![zero; size],
            guess: stages(),
            guess_length: 0.0,
            guess_begin: 1.0,
            forces: [zero; STAGES],
            weights: vec![[1.0; STAGES]; size - 2],
            relaxations: vec![0.0; size - 2],
        }
    }

    /// Forgets the step before, which does not predict the next one.
    pub(super) fn forget(&mut self) {
        self.guess_length = 0.0;
    }

    /// The next step begins where `motion`, a step of this `length`, did, at 0, or where it has ended, at 1.
    pub(super) fn predict_from(&mut self, motion: &StepPolynomial<D>, length: f64, begin: f64) {
        self.guess.copy_from_slice(&motion.increments);
        (self.guess_length, self.guess_begin) = (length, begin);
    }

    /// Solves the step over `span`. `None` if Newton's method does not converge.
    ///
    /// The values are iterated first, by rules that depend on values only, and stay fixed while the derivatives are
    /// iterated. The values are therefore those of plain numbers to the last bit.
    pub(super) fn solve<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut StepPolynomial<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        piece: &Piece<D>,
        span: Span,
    ) -> Result<Option<Solved>, SimulationError> {
        for (force, node) in self.forces.iter_mut().zip(NODES) {
            *force = piece.force(span.begin + node * span.length);
        }
        self.predict(motion, field, branch, span);
        let forces = field.force_size(piece, span.begin, branch, &motion.begin);
        let rounding = ROUNDING / span.tolerance * forces / field.oscillator.mass().value() * span.length;
        motion.rescale(span, rounding);
        if !self.prepare(motion, field, branch, span) {
            return Ok(None);
        }
        let goal = (LEFT_OVER * span.tolerance).max(ROUNDING);
        let (mut before, mut contraction, mut iterations) = (f64::INFINITY, 0.0f64, 0);
        loop {
            self.evaluate(motion, field, branch, span, iterations == 0);
            self.correct(motion, span, true);
            if before > FAR {
                // After that the scale of the errors hardly changes any more.
                motion.rescale(span, rounding);
            }
            let correction = self.correction(motion, D::value);
            iterations += 1;
            let ratio = correction / before;
            contraction = contraction.max(ratio);
            let left = if contraction < 1.0 { contraction / (1.0 - contraction) * correction } else { correction };
            if (iterations > 1 && left <= goal) || correction <= goal * 1e-2 {
                break;
            }
            let stagnates = ratio > 0.5 && correction <= 10.0 * goal;
            if stagnates {
                break;
            }
            // At this rate, the iterations left do not get there.
            let is_slow = iterations > 2 && ratio.powi(MOST_ITERATIONS - iterations) * correction > goal;
            if !(correction.is_finite() && iterations < MOST_ITERATIONS && (ratio < 0.9 || iterations < 3)) || is_slow {
                return Ok(None);
            }
            before = correction;
        }
        motion.rescale(span, rounding);
        if D::DIRECTIONS > 0 {
            self.solve_derivatives(motion, field, branch, span, goal)?;
        }
        let error = motion.error() / span.tolerance;
        Ok(error.is_finite().then_some(Solved {
            error,
            quick: iterations <= 9,
            followed: true,
            stiffness: self.modes.stiffness() * span.length,
            variation: 0.0,
        }))
    }

    /// Guesses the increments: the polynomial of another step, or straight lines.
    fn predict<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut StepPolynomial<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
    ) {
        if self.guess_length > 0.0 {
            let ratio = span.length / self.guess_length;
            let places = NODES.map(|node| 2.0 * (self.guess_begin + node * ratio) - 1.0);
            for (increments, guess) in motion.increments.iter_mut().zip(&self.guess).skip(1) {
                let polynomial = product(&CENTRED_COLUMNS, guess);
                // Of the state at its own beginning.
                let origin = if self.guess_begin > 0.0 { guess[STAGES - 1] } else { D::from(0.0) };
                *increments = [polynomial[STAGES]; STAGES];
                for term in polynomial[..STAGES].iter().rev() {
                    for (increment, place) in increments.iter_mut().zip(places) {
                        *increment = *increment * place + *term;
                    }
                }
                for increment in increments {
                    *increment -= origin;
                }
            }
        } else {
            field.rates(self.forces[0], branch, &motion.begin, &mut self.rate);
            for (component, (increments, rate)) in motion.increments.iter_mut().zip(&self.rate).enumerate() {
                let rate = if component < 2 { *rate } else { D::from(0.0) };
                *increments = NODES.map(|node| rate * (node * span.length));
            }
        }
        follow_velocity(motion, span.length);
    }

    /// The Jacobian in the middle of the step, factored. False if that cannot be.
    fn prepare<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &StepPolynomial<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
    ) -> bool {
        motion.load(STAGES / 2, &mut self.state);
        field.jacobian(branch, &self.state, motion.scale(1), &mut self.modes.jacobian);
        self.modes.factor(span.length)
    }

    /// The rates at all stages; with `weigh` also how stiff the states are at each.
    fn evaluate<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut StepPolynomial<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
        weigh: bool,
    ) {
        for (index, force) in self.forces.iter().enumerate() {
            motion.load(index, &mut self.state);
            field.rates(*force, branch, &self.state, &mut self.rate);
            for (rates, rate) in self.rates.iter_mut().zip(&self.rate) {
                rates[index] = *rate;
            }
            if weigh {
                field.relaxations(branch, &self.state, &mut self.relaxations);
                let least = LEAST_STIFF / span.length;
                for (state, (weights, relaxation)) in self.weights.iter_mut().zip(&self.relaxations).enumerate() {
                    let middle = self.modes.relaxation(2 + state);
                    // A difference across a jump does not measure stiffness, and must not hide a residual.
                    weights[index] = ((least + middle.max(0.0)) / (least + relaxation.max(0.0))).clamp(0.1, 10.0);
                }
            }
        }
    }

    /// One iteration of Newton's method; afterwards `residual` holds the change of the increments. Without `values`
    /// these stay constant.
    ///
    /// The Jacobian is that in the middle of the step. The equations of a state are multiplied by the ratio of the
    /// stiffness there to that at their stage, so that the Jacobian holds for all stages if a state follows the motion.
    fn correct(&mut self, motion: &mut StepPolynomial<D>, span: Span, values: bool) {
        // f(Y) − (1/h) A⁻¹ W
        let per_second = 1.0 / span.length;
        let unknowns = motion.increments[1..].iter().zip(&self.rates[1..]);
        for (component, (modes, (increments, rates))) in self.modes.values.iter_mut().zip(unknowns).enumerate() {
            let mut residual = product(&INVERSE_COLUMNS, increments);
            for (residual, rate) in residual.iter_mut().zip(rates) {
                *residual = *rate - *residual * per_second;
                if !values {
                    *residual -= residual.value();
                }
            }
            if component > 0 {
                for (residual, weight) in residual.iter_mut().zip(&self.weights[component - 1]) {
                    *residual *= *weight;
                }
            }
            *modes = product(&TO_MODES_COLUMNS, &residual);
        }
        self.modes.solve();
        for ((residual, modes), increments) in
            self.residual[1..].iter_mut().zip(&self.modes.values).zip(&mut motion.increments[1..])
        {
            *residual = product(&FROM_MODES_COLUMNS, modes);
            for (increment, change) in increments.iter_mut().zip(residual) {
                *increment += *change;
            }
        }
        follow_velocity(motion, span.length);
    }

    /// The greatest `part` of the last change of an increment, relative to its scale.
    fn correction(&self, motion: &StepPolynomial<D>, part: impl Fn(D) -> f64) -> f64 {
        let mut most = 0.0f64;
        for (component, changes) in self.residual.iter().enumerate().skip(1) {
            let per_scale = 1.0 / motion.scale(component);
            for change in changes {
                let relative = (part(*change) * per_scale).abs();
                // NaN must not be lost in a maximum.
                most = if relative > most || relative.is_nan() { relative } else { most };
            }
        }
        most
    }

    fn solve_derivatives<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut StepPolynomial<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
        goal: f64,
    ) -> Result<(), SimulationError> {
        let mut before = vec![f64::INFINITY; D::DIRECTIONS];
        for _ in 0..MOST_DERIVATIVE_ITERATIONS {
            self.evaluate(motion, field, branch, span, false);
            self.correct(motion, span, false);
            let mut converged = true;
            for (direction, before) in before.iter_mut().enumerate() {
                let correction = self.correction(motion, |change| change.partial(direction));
                let mut size = 0.0f64;
                for (component, (increments, y)) in motion.increments.iter().zip(&motion.begin).enumerate() {
                    let scale = motion.scale(component);
                    let most = |most: f64, w: &D| most.max(w.partial(direction).abs());
                    size = size.max(increments.iter().fold(y.partial(direction).abs(), most) / scale);
                }
                let ratio = correction / *before;
                let left = if ratio < 1.0 { ratio / (1.0 - ratio) * correction } else { correction };
                // If rounding keeps the corrections from shrinking, they are small enough.
                let stagnates = ratio > 0.5 && correction <= 1e4 * f64::EPSILON * size;
                converged &= left <= goal * size || stagnates;
                *before = correction;
            }
            if converged {
                return Ok(());
            }
        }
        Err(SimulationError::step_too_small(span.tolerance, span.begin))
    }
}

/// Makes the position follow the velocity.
fn follow_velocity<D: Scalar>(motion: &mut StepPolynomial<D>, length: f64) {
    let velocity = motion.begin[1];
    let [position, increments, ..] = &mut motion.increments[..] else { return };
    *position = product(&COEFFICIENTS_COLUMNS, increments);
    for (position, node) in position.iter_mut().zip(NODES) {
        *position = (*position + velocity * node) * length;
    }
}
