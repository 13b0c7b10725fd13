//! One step of the collocation method: Newton's method for all stages at once, and what the solution says of its error.

use fmm_friction::BristleLaw;
use fmm_model::Scalar;

use super::field::{Branch, Field};
use super::modes::Modes;
use super::motion::{Motion, ROUNDING, Solved, Span};
use super::radau::{FROM_MODES_COLUMNS, INVERSE_COLUMNS, NODES, STAGES, Stages, TO_MODES_COLUMNS, basis, dot, product};
use crate::SimulationError;
use crate::drive::Piece;

/// Iterations for the values; one that needs more is better off with a shorter step.
const MOST_ITERATIONS: i32 = 15;

/// Iterations for the derivatives, which converge as the values do, but from wherever these have left them.
const MOST_DERIVATIVE_ITERATIONS: usize = 60;

/// What is left over by Newton's method, in units of the tolerance.
const LEFT_OVER: f64 = 0.01;

/// The method: what it needs beside the motion.
pub(super) struct Collocation<D> {
    /// f(Yᵢ) at all stages, for each component.
    rates: Vec<Stages<D>>,
    residual: Vec<Stages<D>>,
    /// The last change that Newton's method has proposed, and what the increments have changed by then.
    proposed: Vec<Stages<f64>>,
    changed: Vec<Stages<f64>>,
    modes: Modes<D>,
    state: Vec<D>,
    rate: Vec<D>,
    /// Increments and length of a step from which this one is predicted, and where in units of that step this one begins:
    /// at 1, or at 0 if it is a first attempt at the same step.
    guess: Vec<Stages<D>>,
    guess_length: f64,
    guess_begin: f64,
    forces: [D; STAGES],
}

impl<D: Scalar> Collocation<D> {
    pub(super) fn new(size: usize) -> Self {
        let zero = D::from(0.0);
        let stages = || vec![[zero; STAGES]; size];
        Self {
            rates: stages(),
            residual: stages(),
            proposed: vec![[0.0; STAGES]; size],
            changed: vec![[0.0; STAGES]; size],
            modes: Modes::new(size),
            state: vec![zero; size],
            rate: vec![zero; size],
            guess: stages(),
            guess_length: 0.0,
            guess_begin: 1.0,
            forces: [zero; STAGES],
        }
    }

    /// The next step has nothing to do with the one before.
    pub(super) fn forget(&mut self) {
        self.guess_length = 0.0;
    }

    /// The next step begins where `motion`, a step of this `length`, did, at 0, or where it has ended, at 1.
    pub(super) fn predict_from(&mut self, motion: &Motion<D>, length: f64, begin: f64) {
        self.guess.copy_from_slice(&motion.increments);
        (self.guess_length, self.guess_begin) = (length, begin);
    }

    /// Solves the step over `span`. `None` if Newton's method does not converge.
    ///
    /// The values are iterated first, by rules that look at nothing but values, and then left alone while the derivatives
    /// are iterated: the values are those of plain numbers to the last bit.
    pub(super) fn solve<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut Motion<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        piece: &Piece<D>,
        span: Span,
    ) -> Result<Option<Solved>, SimulationError> {
        for (force, node) in self.forces.iter_mut().zip(NODES) {
            *force = piece.force(span.begin + node * span.length);
        }
        self.predict(motion, field, branch, span);
        let forces = field.force_size(self.forces[0], branch, &motion.begin);
        let rounding = ROUNDING / span.tolerance * forces / field.oscillator.mass().value() * span.length;
        motion.rescale(span, rounding);
        if !self.prepare(motion, field, branch, span) {
            return Ok(None);
        }
        let goal = (LEFT_OVER * span.tolerance).max(ROUNDING);
        let (mut before, mut contraction, mut iterations) = (f64::INFINITY, 0.0f64, 0);
        loop {
            self.iterate(motion, field, branch, span, true);
            if iterations < 2 {
                // What errors are compared with hardly changes any more.
                motion.rescale(span, rounding);
            }
            let correction = self.correction(motion, D::value);
            iterations += 1;
            let ratio = correction / before;
            // What is extrapolated shrinks faster than the change proposed last, which is not, does in one more iteration.
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
            self.extrapolate(motion, iterations > 1 && ratio < 0.9);
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
        motion: &mut Motion<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
    ) {
        if self.guess_length > 0.0 {
            let ratio = span.length / self.guess_length;
            let origin = basis(self.guess_begin);
            for (index, node) in NODES.iter().enumerate() {
                let mut ahead = basis(self.guess_begin + node * ratio);
                for (ahead, origin) in ahead.iter_mut().zip(origin) {
                    *ahead -= origin;
                }
                for (increments, known) in motion.increments.iter_mut().zip(&self.guess) {
                    increments[index] = dot(&ahead, known);
                }
            }
        } else {
            field.rates(self.forces[0], branch, &motion.begin, &mut self.rate);
            for (component, (increments, rate)) in motion.increments.iter_mut().zip(&self.rate).enumerate() {
                let rate = if component < 2 { *rate } else { D::from(0.0) };
                *increments = NODES.map(|node| rate * (node * span.length));
            }
        }
    }

    /// The Jacobian in the middle of the step, factored. False if that cannot be.
    fn prepare<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &Motion<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
    ) -> bool {
        motion.load(STAGES / 2, &mut self.state);
        field.jacobian(branch, &self.state, motion.scale(1), self.modes.jacobian_mut());
        self.modes.factor(span.length)
    }

    /// One iteration of Newton's method; afterwards `residual` holds the change of the increments. Without `values` these
    /// stay what they are.
    fn iterate<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut Motion<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
        values: bool,
    ) {
        for (index, force) in self.forces.iter().enumerate() {
            motion.load(index, &mut self.state);
            field.rates(*force, branch, &self.state, &mut self.rate);
            for (rates, rate) in self.rates.iter_mut().zip(&self.rate) {
                rates[index] = *rate;
            }
        }
        // f(Y) − (1/h) A⁻¹ W
        let per_second = 1.0 / span.length;
        for ((modes, increments), rates) in self.modes.values.iter_mut().zip(&motion.increments).zip(&self.rates) {
            let mut residual = product(&INVERSE_COLUMNS, increments);
            for (residual, rate) in residual.iter_mut().zip(rates) {
                *residual = *rate - *residual * per_second;
                if !values {
                    *residual -= residual.value();
                }
            }
            *modes = product(&TO_MODES_COLUMNS, &residual);
        }
        self.modes.solve();
        for ((residual, modes), increments) in
            self.residual.iter_mut().zip(&self.modes.values).zip(&mut motion.increments)
        {
            *residual = product(&FROM_MODES_COLUMNS, modes);
            for (increment, change) in increments.iter_mut().zip(residual) {
                *increment += *change;
            }
        }
    }

    /// Goes on, if `again`, to where the changes d that Newton's method proposes would vanish if they went on as in the last two iterations:
    /// with a Jacobian that stays what it is, they shrink by much the same factor each time.
    ///
    /// ```text
    /// Wₖ₊₁ = Gₖ − γ (Gₖ − Gₖ₋₁),     G = W + d,     γ = ⟨dₖ, dₖ − dₖ₋₁⟩/|dₖ − dₖ₋₁|²
    /// ```
    ///
    /// # References
    /// D. G. Anderson, "Iterative procedures for nonlinear integral equations", J. ACM 12 (1965) 547, doi 10.1145/321296.321305, with one
    /// iteration before the last.
    fn extrapolate(&mut self, motion: &mut Motion<D>, again: bool) {
        let Self { residual, proposed, changed, .. } = self;
        let (mut product, mut square) = (0.0, 0.0);
        for (component, (changes, before)) in residual.iter().zip(&*proposed).enumerate() {
            let per_scale = 1.0 / motion.scale(component);
            for index in 0..STAGES {
                let change = changes[index].value() * per_scale;
                let difference = change - before[index] * per_scale;
                product += change * difference;
                square += difference * difference;
            }
        }
        let part = product / square;
        let part = if again && part.is_finite() { part } else { 0.0 };
        for (component, changes) in residual.iter().enumerate() {
            let (increments, before) = (&mut motion.increments[component], &mut proposed[component]);
            let changed = &mut changed[component];
            for index in 0..STAGES {
                let change = changes[index].value();
                let further = part * (before[index] - changed[index] - change);
                increments[index] += further;
                (before[index], changed[index]) = (change, change + further);
            }
        }
    }

    /// The greatest `part` of the last change of an increment, relative to its scale.
    fn correction(&self, motion: &Motion<D>, part: impl Fn(D) -> f64) -> f64 {
        let mut most = 0.0f64;
        for (component, changes) in self.residual.iter().enumerate() {
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
        motion: &mut Motion<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
        goal: f64,
    ) -> Result<(), SimulationError> {
        let mut before = vec![f64::INFINITY; D::DIRECTIONS];
        for _ in 0..MOST_DERIVATIVE_ITERATIONS {
            self.iterate(motion, field, branch, span, false);
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
                // Where rounding keeps the corrections from shrinking, they have shrunk enough before.
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
