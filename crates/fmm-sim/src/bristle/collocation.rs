//! One step of the collocation method: Newton's method for all stages at once, and what the solution says of its error.

use fmm_friction::BristleLaw;
use fmm_model::Scalar;

use super::field::{Branch, Field};
use super::lu::Factors;
use super::radau::{BERNSTEIN, COMPLEX, FROM_MODES, INVERSE, LEGENDRE, NODES, PAIRS, REAL, STAGES, TO_MODES, basis};
use crate::SimulationError;
use crate::drive::Piece;

/// Iterations for the values; one that needs more is better off with a shorter step.
const MOST_ITERATIONS: usize = 15;

/// Iterations for the derivatives, which converge as the values do, but from wherever these have left them.
const MOST_DERIVATIVE_ITERATIONS: usize = 60;

/// What is left over by Newton's method, in units of the tolerance; and rounding, below which it cannot get.
const LEFT_OVER: f64 = 0.01;
const ROUNDING: f64 = 1e-15;

/// The interval of a step and what its errors are compared with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) begin: f64,
    pub(super) length: f64,
    /// Time (s) over which a velocity changes the position at most: since the last event, or the inverse of the natural
    /// frequency ω, if that is shorter.
    pub(super) memory: f64,
    /// ω, natural angular frequency (rad/s).
    pub(super) angular: f64,
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
    pub(super) iterations: usize,
    pub(super) failed: usize,
    /// The state at its beginning.
    pub(super) begin: Vec<D>,
    /// Yᵢ − y₀, stage by stage.
    increments: Vec<D>,
    /// f(Yᵢ), stage by stage.
    rates: Vec<D>,
    residual: Vec<D>,
    modes: Vec<D>,
    right: Vec<D>,
    state: Vec<D>,
    /// Increments and length of a step from which this one is predicted, and where in units of that step this one begins:
    /// at 1, or at 0 if it is a first attempt at the same step.
    guess: Vec<D>,
    guess_length: f64,
    guess_begin: f64,
    /// f(y₀), if there is no step before.
    slope: Vec<D>,
    forces: [D; STAGES],
    jacobian: Vec<f64>,
    real: Factors,
    pairs: [Factors; PAIRS],
    scale: Vec<f64>,
}

impl<D: Scalar> Collocation<D> {
    pub(super) fn new(begin: Vec<D>) -> Self {
        let size = begin.len();
        let zero = D::from(0.0);
        let stages = || vec![zero; size * STAGES];
        Self {
            size,
            iterations: 0,
            failed: 0,
            begin,
            increments: stages(),
            rates: stages(),
            residual: stages(),
            modes: stages(),
            right: vec![zero; 2 * size],
            state: vec![zero; size],
            guess: stages(),
            guess_length: 0.0,
            guess_begin: 1.0,
            slope: vec![zero; size],
            forces: [zero; STAGES],
            jacobian: vec![0.0; size * size],
            real: Factors::default(),
            pairs: std::array::from_fn(|_| Factors::default()),
            scale: vec![1.0; size],
        }
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
        for (y, increment) in self.begin.iter_mut().zip(&self.increments[(STAGES - 1) * self.size..]) {
            *y = *y + *increment;
        }
        std::mem::swap(&mut self.increments, &mut self.guess);
        (self.guess_length, self.guess_begin) = (length, 1.0);
    }

    /// Goes on by `time` (s) along the tangent, which must be short.
    pub(super) fn nudge(&mut self, time: f64) {
        let end = (STAGES - 1) * self.size;
        for (y, rate) in self.begin.iter_mut().zip(&self.rates[end..]) {
            *y = *y + *rate * time;
        }
    }

    /// The state at `tau` in units of the step.
    pub(super) fn at(&self, tau: f64, state: &mut [D]) {
        let basis = basis(tau);
        state.copy_from_slice(&self.begin);
        for (weight, stage) in basis.iter().zip(self.increments.chunks_exact(self.size)) {
            for (y, increment) in state.iter_mut().zip(stage) {
                *y = *y + *increment * *weight;
            }
        }
    }

    /// One component of the state at `tau` in units of the step.
    pub(super) fn component(&self, index: usize, basis: &[f64; STAGES]) -> D {
        let stages = self.increments.iter().skip(index).step_by(self.size);
        self.begin[index] + basis.iter().zip(stages).fold(D::from(0.0), |sum, (weight, w)| sum + *w * *weight)
    }

    /// y′ at the end of the step.
    pub(super) fn end_rates(&self) -> &[D] {
        &self.rates[(STAGES - 1) * self.size..]
    }

    /// The Bernstein coefficients of the polynomial through what `value` gives at the states at the beginning and at all
    /// stages.
    pub(super) fn bernstein(&mut self, mut value: impl FnMut(&[D]) -> f64) -> [f64; STAGES + 1] {
        let mut nodal = [0.0; STAGES + 1];
        nodal[0] = value(&self.begin);
        for (nodal, stage) in nodal[1..].iter_mut().zip(self.increments.chunks_exact(self.size)) {
            for ((y, y0), increment) in self.state.iter_mut().zip(&self.begin).zip(stage) {
                *y = *y0 + *increment;
            }
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
        let rounding = 16.0 * f64::EPSILON / span.tolerance * forces / field.oscillator.mass().value() * span.length;
        self.rescale(field, span, rounding);
        if !self.prepare(field, branch, span) {
            return Ok(None);
        }
        let goal = (LEFT_OVER * span.tolerance).max(ROUNDING);
        let (mut before, mut iterations) = (f64::INFINITY, 0);
        loop {
            self.iterate(field, branch, span, true);
            self.rescale(field, span, rounding);
            let correction = self.correction(D::value);
            iterations += 1;
            self.iterations += 1;
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
                self.failed += 1;
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

    /// Guesses the increments: the polynomial of the step before, or straight lines.
    fn predict<L: BristleLaw<D>>(&mut self, field: &mut Field<D, L>, branch: Branch, span: Span) {
        if self.guess_length > 0.0 {
            let ratio = span.length / self.guess_length;
            let origin = basis(self.guess_begin);
            for (node, stage) in NODES.iter().zip(self.increments.chunks_exact_mut(self.size)) {
                stage.fill(D::from(0.0));
                let ahead = basis(self.guess_begin + node * ratio);
                for ((ahead, origin), known) in ahead.iter().zip(origin).zip(self.guess.chunks_exact(self.size)) {
                    for (increment, w) in stage.iter_mut().zip(known) {
                        *increment = *increment + *w * (ahead - origin);
                    }
                }
            }
        } else {
            field.rates(self.forces[0], branch, &self.begin, &mut self.slope);
            for (stage, node) in self.increments.chunks_exact_mut(self.size).zip(NODES) {
                stage.fill(D::from(0.0));
                for (increment, slope) in stage.iter_mut().zip(&self.slope).take(2) {
                    *increment = *slope * (node * span.length);
                }
            }
        }
    }

    /// What errors of each component are compared with: the motion as it is in this step.
    fn rescale<L: BristleLaw<D>>(&mut self, field: &Field<D, L>, span: Span, rounding: f64) {
        let mut most = [0, 1].map(|component| self.begin[component].value().abs());
        for stage in self.increments.chunks_exact(self.size) {
            for (component, most) in most.iter_mut().enumerate() {
                *most = most.max((self.begin[component].value() + stage[component].value()).abs());
            }
        }
        let [x, v] = most;
        self.scale[0] = x.max(v * span.memory).max(f64::MIN_POSITIVE);
        self.scale[1] = v.max(span.angular * x).max(rounding).max(f64::MIN_POSITIVE);
        for (index, scale) in self.scale[2..].iter_mut().enumerate() {
            *scale = field.law.bound(index).value().abs().clamp(f64::MIN_POSITIVE, f64::MAX);
        }
    }

    /// The Jacobian in the middle of the step, and the factors of the systems of all modes.
    fn prepare<L: BristleLaw<D>>(&mut self, field: &mut Field<D, L>, branch: Branch, span: Span) -> bool {
        let middle = &self.increments[STAGES / 2 * self.size..];
        for ((y, y0), increment) in self.state.iter_mut().zip(&self.begin).zip(middle) {
            *y = *y0 + *increment;
        }
        field.jacobian(branch, &self.state, self.scale[1], &mut self.jacobian);
        let size = self.size;
        let fill = |matrix: &mut [f64], width: usize, offset: usize, diagonal: f64, jacobian: &[f64]| {
            for (row, slopes) in jacobian.chunks_exact(size).enumerate() {
                let start = (row + offset) * width + offset;
                for (entry, slope) in matrix[start..start + size].iter_mut().zip(slopes) {
                    *entry = -slope;
                }
                matrix[start + row] += diagonal;
            }
        };
        fill(self.real.matrix(size), size, 0, REAL / span.length, &self.jacobian);
        let mut regular = self.real.factor();
        for (factors, (alpha, beta)) in self.pairs.iter_mut().zip(COMPLEX) {
            let matrix = factors.matrix(2 * size);
            matrix.fill(0.0);
            fill(matrix, 2 * size, 0, alpha / span.length, &self.jacobian);
            fill(matrix, 2 * size, size, alpha / span.length, &self.jacobian);
            for row in 0..size {
                matrix[row * 2 * size + size + row] = beta / span.length;
                matrix[(size + row) * 2 * size + row] = -beta / span.length;
            }
            regular &= factors.factor();
        }
        regular
    }

    /// One iteration of Newton's method; afterwards `residual` holds the change of the increments. Without `values` these
    /// stay what they are.
    fn iterate<L: BristleLaw<D>>(&mut self, field: &mut Field<D, L>, branch: Branch, span: Span, values: bool) {
        let size = self.size;
        for (index, rates) in self.rates.chunks_exact_mut(size).enumerate() {
            let stage = &self.increments[index * size..(index + 1) * size];
            for ((y, y0), increment) in self.state.iter_mut().zip(&self.begin).zip(stage) {
                *y = *y0 + *increment;
            }
            field.rates(self.forces[index], branch, &self.state, rates);
        }
        // f(Y) − (1/h) A⁻¹ W
        combine(&INVERSE, size, &self.increments, &mut self.residual);
        for (residual, rate) in self.residual.iter_mut().zip(&self.rates) {
            *residual = *rate - *residual / span.length;
            if !values {
                *residual = *residual - residual.value();
            }
        }
        combine(&TO_MODES, size, &self.residual, &mut self.modes);
        self.real.solve(&mut self.modes[..size]);
        for (factors, pair) in self.pairs.iter().zip(self.modes[size..].chunks_exact_mut(2 * size)) {
            self.right.copy_from_slice(pair);
            factors.solve(&mut self.right);
            pair.copy_from_slice(&self.right);
        }
        combine(&FROM_MODES, size, &self.modes, &mut self.residual);
        for (increment, change) in self.increments.iter_mut().zip(&self.residual) {
            *increment = *increment + *change;
        }
    }

    /// The greatest `part` of the last change of an increment, relative to its scale.
    fn correction(&self, part: impl Fn(D) -> f64) -> f64 {
        let mut most = 0.0f64;
        for stage in self.residual.chunks_exact(self.size) {
            for (change, scale) in stage.iter().zip(&self.scale) {
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
                for stage in self.increments.chunks_exact(self.size) {
                    for ((w, y0), scale) in stage.iter().zip(&self.begin).zip(&self.scale) {
                        let most = w.partial(direction).abs().max(y0.partial(direction).abs());
                        size = size.max(most / scale);
                    }
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
        for (component, scale) in self.scale.iter().enumerate() {
            let mut coefficients = [0.0; 4];
            for (row, legendre) in INVERSE.iter().zip(0..) {
                let stages = self.increments.iter().skip(component).step_by(self.size);
                let slope: f64 = row.iter().zip(stages).map(|(factor, w)| factor * w.value()).sum();
                for (coefficient, row) in coefficients.iter_mut().zip(&LEGENDRE) {
                    *coefficient += row[legendre] * slope;
                }
            }
            let [first, second, third, last] = coefficients.map(f64::abs);
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

/// `out` = `matrix` ⊗ I · `stages`.
fn combine<D: Scalar>(matrix: &[[f64; STAGES]; STAGES], size: usize, stages: &[D], out: &mut [D]) {
    for (row, out) in matrix.iter().zip(out.chunks_exact_mut(size)) {
        out.fill(D::from(0.0));
        for (factor, stage) in row.iter().zip(stages.chunks_exact(size)) {
            for (out, value) in out.iter_mut().zip(stage) {
                *out = *out + *value * *factor;
            }
        }
    }
}
