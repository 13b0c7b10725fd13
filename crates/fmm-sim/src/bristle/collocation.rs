//! One step of the collocation method: Newton's method for all stages at once, and what the solution says of its error.

use fmm_friction::BristleLaw;
use fmm_model::Scalar;

use super::field::{Branch, Field};
use super::modes::Modes;
use super::radau::{BERNSTEIN, FROM_MODES, INVERSE, LEGENDRE, NODES, STAGES, Stages, TO_MODES, basis, dot, product};
use crate::SimulationError;
use crate::drive::Piece;

/// Iterations for the values; one that needs more is better off with a shorter step.
const MOST_ITERATIONS: usize = 15;

/// Iterations for the derivatives, which converge as the values do, but from wherever these have left them.
const MOST_DERIVATIVE_ITERATIONS: usize = 60;

/// What is left over by Newton's method, in units of the tolerance; and rounding, below which it cannot get.
const LEFT_OVER: f64 = 0.01;
const ROUNDING: f64 = 2e-15;

/// The interval of a step (s), and the error allowed in it (1).
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) begin: f64,
    pub(super) length: f64,
    pub(super) tolerance: f64,
}

/// The outcome of a step that could be solved.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solved {
    /// Estimated error of the polynomial anywhere in the step, in units of the tolerance.
    pub(super) error: f64,
    /// Whether Newton's method was quick, so that a longer step is worth trying.
    pub(super) quick: bool,
}

/// A step: the polynomial of degree s that meets the equations of motion at the s stages.
pub(super) struct Collocation<D> {
    size: usize,
    /// The state at its beginning.
    pub(super) begin: Vec<D>,
    /// Yᵢ − y₀ at all stages, for each component.
    increments: Vec<Stages<D>>,
    /// f(Yᵢ) at all stages, for each component.
    rates: Vec<Stages<D>>,
    residual: Vec<Stages<D>>,
    modes: Modes<D>,
    state: Vec<D>,
    rate: Vec<D>,
    /// Increments and length of a step from which this one is predicted, and where in units of that step this one begins:
    /// at 1, or at 0 if it is a first attempt at the same step.
    guess: Vec<Stages<D>>,
    guess_length: f64,
    guess_begin: f64,
    forces: [D; STAGES],
    scale: Vec<f64>,
    /// The state at the beginning of the swing, the velocity being that of the counterface, and how far each component has
    /// moved from there.
    origin: Vec<f64>,
    moved: Vec<f64>,
}

impl<D: Scalar> Collocation<D> {
    pub(super) fn new(begin: Vec<D>) -> Self {
        let size = begin.len();
        let zero = D::from(0.0);
        let stages = || vec![[zero; STAGES]; size];
        Self {
            size,
            begin,
            increments: stages(),
            rates: stages(),
            residual: stages(),
            modes: Modes::new(size),
            state: vec![zero; size],
            rate: vec![zero; size],
            guess: stages(),
            guess_length: 0.0,
            guess_begin: 1.0,
            forces: [zero; STAGES],
            scale: vec![1.0; size],
            origin: vec![0.0; size],
            moved: vec![0.0; size],
        }
    }

    /// A swing begins; errors are relative to its motion. `belt` is the velocity of the counterface.
    pub(super) fn turn(&mut self, belt: f64) {
        for (origin, y) in self.origin.iter_mut().zip(&self.begin) {
            *origin = y.value();
        }
        self.origin[1] = belt;
        self.moved.fill(0.0);
        self.guess_length = 0.0;
    }

    /// The next step has nothing to do with the one before.
    pub(super) fn forget(&mut self) {
        self.guess_length = 0.0;
    }

    /// The next step begins where this one of `length` did.
    pub(super) fn retry(&mut self, length: f64) {
        std::mem::swap(&mut self.increments, &mut self.guess);
        (self.guess_length, self.guess_begin) = (length, 0.0);
    }

    /// Goes to the end of a step of `length`, from which the next one begins.
    pub(super) fn advance(&mut self, length: f64) {
        for component in 0..self.size {
            self.moved[component] = self.moved(component);
        }
        for (y, increments) in self.begin.iter_mut().zip(&self.increments) {
            *y = *y + increments[STAGES - 1];
        }
        std::mem::swap(&mut self.increments, &mut self.guess);
        (self.guess_length, self.guess_begin) = (length, 1.0);
    }

    /// Goes on from the end of the last step by a short `part` of it along the tangent of its polynomial.
    pub(super) fn nudge(&mut self, part: f64) {
        for (y, increments) in self.begin.iter_mut().zip(&self.guess) {
            *y = *y + dot(&INVERSE[STAGES - 1], increments) * part;
        }
    }

    /// The state at `tau` in units of the step.
    pub(super) fn at(&self, tau: f64, state: &mut [D]) {
        let basis = basis(tau);
        for ((state, y), increments) in state.iter_mut().zip(&self.begin).zip(&self.increments) {
            *state = *y + dot(&basis, increments);
        }
    }

    /// The slope of a component at the end of the step, per unit of the step.
    pub(super) fn end_slope(&self, component: usize) -> f64 {
        dot(&INVERSE[STAGES - 1], &self.increments[component]).value()
    }

    /// The Bernstein coefficients of the polynomial through what `value` gives at the states at the beginning and at all
    /// stages.
    pub(super) fn bernstein(&mut self, mut value: impl FnMut(&[D]) -> f64) -> [f64; STAGES + 1] {
        let mut nodal = [0.0; STAGES + 1];
        nodal[0] = value(&self.begin);
        for (index, nodal) in nodal[1..].iter_mut().enumerate() {
            load(&mut self.state, &self.begin, &self.increments, index);
            *nodal = value(&self.state);
        }
        BERNSTEIN.map(|row| row.iter().zip(nodal).map(|(factor, value)| factor * value).sum())
    }

    /// Solves the step over `span`. None if Newton's method does not converge.
    ///
    /// The values are iterated first, by rules that look at nothing but values, and then left alone while the derivatives
    /// are iterated: the values are those of plain numbers to the last bit.
    pub(super) fn solve<L: BristleLaw<D>>(
        &mut self,
        field: &mut Field<D, L>,
        branch: Branch,
        piece: &Piece<D>,
        span: Span,
    ) -> Result<Option<Solved>, SimulationError> {
        for (force, node) in self.forces.iter_mut().zip(NODES) {
            *force = piece.force(span.begin + node * span.length);
        }
        self.predict(field, branch, span);
        let forces = field.force_size(self.forces[0], branch, &self.begin);
        let rounding = ROUNDING / span.tolerance * forces / field.oscillator.mass().value() * span.length;
        self.rescale(span, rounding);
        if !self.prepare(field, branch, span) {
            return Ok(None);
        }
        let goal = (LEFT_OVER * span.tolerance).max(ROUNDING);
        let (mut before, mut iterations) = (f64::INFINITY, 0);
        loop {
            self.iterate(field, branch, span, true);
            self.rescale(span, rounding);
            let correction = self.correction(D::value);
            iterations += 1;
            let ratio = correction / before;
            let left = if ratio < 1.0 { ratio / (1.0 - ratio) * correction } else { correction };
            if (iterations > 1 && left <= goal) || correction <= goal * 1e-2 {
                break;
            }
            let stagnates = ratio > 0.5 && correction <= 10.0 * goal;
            if stagnates {
                break;
            }
            if !(correction.is_finite() && iterations < MOST_ITERATIONS && (ratio < 0.9 || iterations < 3)) {
                return Ok(None);
            }
            before = correction;
        }
        if D::DIRECTIONS > 0 {
            self.solve_derivatives(field, branch, span, goal)?;
        }
        let error = self.error() / span.tolerance;
        Ok(error.is_finite().then_some(Solved { error, quick: iterations <= 9 }))
    }

    /// Guesses the increments: the polynomial of another step, or straight lines.
    fn predict<L: BristleLaw<D>>(&mut self, field: &mut Field<D, L>, branch: Branch, span: Span) {
        if self.guess_length > 0.0 {
            let ratio = span.length / self.guess_length;
            let origin = basis(self.guess_begin);
            for (index, node) in NODES.iter().enumerate() {
                let mut ahead = basis(self.guess_begin + node * ratio);
                for (ahead, origin) in ahead.iter_mut().zip(origin) {
                    *ahead -= origin;
                }
                for (increments, known) in self.increments.iter_mut().zip(&self.guess) {
                    increments[index] = dot(&ahead, known);
                }
            }
        } else {
            field.rates(self.forces[0], branch, &self.begin, &mut self.rate);
            for (component, (increments, rate)) in self.increments.iter_mut().zip(&self.rate).enumerate() {
                let rate = if component < 2 { *rate } else { D::from(0.0) };
                *increments = NODES.map(|node| rate * (node * span.length));
            }
        }
    }

    /// What errors of each component are compared with: how far it has moved in this swing, this step included, or what
    /// rounding makes of it.
    fn rescale(&mut self, span: Span, rounding: f64) {
        for component in 0..self.size {
            let floor = ROUNDING / span.tolerance * self.begin[component].value().abs();
            let floor = if component == 1 { floor.max(rounding) } else { floor };
            self.scale[component] = self.moved(component).max(floor).max(f64::MIN_POSITIVE);
        }
    }

    /// What errors of a component are compared with.
    pub(super) fn scale(&self, component: usize) -> f64 {
        self.scale[component]
    }

    /// How far a component has moved in this swing, this step included.
    fn moved(&self, component: usize) -> f64 {
        let distance = self.begin[component].value() - self.origin[component];
        let increments = &self.increments[component];
        increments.iter().fold(self.moved[component], |most, w| most.max((distance + w.value()).abs()))
    }

    /// The Jacobian in the middle of the step, factored. False if that cannot be.
    fn prepare<L: BristleLaw<D>>(&mut self, field: &mut Field<D, L>, branch: Branch, span: Span) -> bool {
        load(&mut self.state, &self.begin, &self.increments, STAGES / 2);
        field.jacobian(branch, &self.state, self.scale[1], self.modes.jacobian_mut());
        self.modes.factor(span.length)
    }

    /// One iteration of Newton's method; afterwards `residual` holds the change of the increments. Without `values` these
    /// stay what they are.
    fn iterate<L: BristleLaw<D>>(&mut self, field: &mut Field<D, L>, branch: Branch, span: Span, values: bool) {
        for (index, force) in self.forces.iter().enumerate() {
            load(&mut self.state, &self.begin, &self.increments, index);
            field.rates(*force, branch, &self.state, &mut self.rate);
            for (rates, rate) in self.rates.iter_mut().zip(&self.rate) {
                rates[index] = *rate;
            }
        }
        // f(Y) − (1/h) A⁻¹ W
        let per_second = 1.0 / span.length;
        for ((modes, increments), rates) in self.modes.values.iter_mut().zip(&self.increments).zip(&self.rates) {
            let mut residual = product(&INVERSE, increments);
            for (residual, rate) in residual.iter_mut().zip(rates) {
                *residual = *rate - *residual * per_second;
                if !values {
                    *residual = *residual - residual.value();
                }
            }
            *modes = product(&TO_MODES, &residual);
        }
        self.modes.solve();
        for ((residual, modes), increments) in
            self.residual.iter_mut().zip(&self.modes.values).zip(&mut self.increments)
        {
            *residual = product(&FROM_MODES, modes);
            for (increment, change) in increments.iter_mut().zip(residual) {
                *increment = *increment + *change;
            }
        }
    }

    /// The greatest `part` of the last change of an increment, relative to its scale.
    fn correction(&self, part: impl Fn(D) -> f64) -> f64 {
        let mut most = 0.0f64;
        for (changes, scale) in self.residual.iter().zip(&self.scale) {
            for change in changes {
                let relative = (part(*change) / scale).abs();
                // NaN must not be lost in a maximum.
                most = if relative > most || relative.is_nan() { relative } else { most };
            }
        }
        most
    }

    fn solve_derivatives<L: BristleLaw<D>>(
        &mut self,
        field: &mut Field<D, L>,
        branch: Branch,
        span: Span,
        goal: f64,
    ) -> Result<(), SimulationError> {
        let mut before = vec![f64::INFINITY; D::DIRECTIONS];
        for _ in 0..MOST_DERIVATIVE_ITERATIONS {
            self.iterate(field, branch, span, false);
            let mut converged = true;
            for (direction, before) in before.iter_mut().enumerate() {
                let correction = self.correction(|change| change.partial(direction));
                let mut size = 0.0f64;
                for ((increments, y), scale) in self.increments.iter().zip(&self.begin).zip(&self.scale) {
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
        Err(SimulationError::StepTooSmall { tolerance: span.tolerance, time: span.begin })
    }

    /// The first coefficient that the polynomial of y′ lacks, extrapolated from the decay of its last four, as an error
    /// of y relative to its scale.
    fn error(&self) -> f64 {
        let mut worst = 0.0f64;
        for (increments, scale) in self.increments.iter().zip(&self.scale) {
            let values = increments.map(D::value);
            let [first, second, third, last] = LEGENDRE.map(|row| dot(&row, &values).abs());
            // Even and odd coefficients may differ in size, so pairs of them are compared.
            let pair = third.max(last);
            let decay = if pair < first.max(second) { (pair / first.max(second)).sqrt() } else { 1.0 };
            let missing = last.max(third * decay) * decay;
            let error = missing / (2 * STAGES + 1) as f64 / scale;
            worst = if error > worst || error.is_nan() { error } else { worst };
        }
        worst
    }
}

/// The state at stage `index`.
fn load<D: Scalar>(state: &mut [D], begin: &[D], increments: &[Stages<D>], index: usize) {
    for ((state, y), increments) in state.iter_mut().zip(begin).zip(increments) {
        *state = *y + increments[index];
    }
}
