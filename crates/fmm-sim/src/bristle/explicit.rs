//! One explicit step of order 8, for a law that is not stiff.

use fmm_friction::BristleLaw;
use fmm_model::Scalar;

use crate::bristle::field::{Branch, Field};
use crate::bristle::pace::STABLE;
use crate::bristle::polynomial::{ROUNDING, Solved, Span, StepPolynomial};
use crate::bristle::radau::{Columns, NODES, STAGES, product};
use crate::dormand_prince::{END, Rates, dense_stages, error, errors, mean_rate, nested, step};
use crate::mechanics::Piece;

/// Order of the method.
const ORDER: i32 = 8;

/// Error allowed in a step, in units of the tolerance; the errors of many steps add up.
const SAFETY: f64 = 0.1;

/// The Dormand-Prince method, as the [`RungeKutta`](crate::RungeKutta) engine uses it.
///
/// Its interpolant has the degree of the polynomial of the collocation method and is passed on as values at the stages
/// of that method.
pub(super) struct Explicit<D> {
    rates: Vec<Rates<D>>,
    state: Vec<D>,
    end: Vec<D>,
    rate: Vec<D>,
    /// Rates (1/s) at which the states return, for each state.
    relaxations: Vec<f64>,
}

impl<D: Scalar> Explicit<D> {
    pub(super) fn new(size: usize) -> Self {
        let zeros = vec![D::from(0.0); size];
        Self {
            rates: vec![[D::from(0.0); 16]; size],
            state: zeros.clone(),
            end: zeros.clone(),
            rate: zeros,
            relaxations: vec![0.0; size - 2],
        }
    }

    /// Takes the step over `span`. `None` if it leaves the range of numbers.
    pub(super) fn take<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut StepPolynomial<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        piece: &Piece<D>,
        span: Span,
    ) -> Option<Solved> {
        let Span { begin: time, length, tolerance } = span;
        let Self { rates, state, end, rate, .. } = self;
        let mut rate_at = |elapsed: f64, state: &[D], stage: usize, rates: &mut [Rates<D>]| {
            field.rates(piece.force(time + elapsed), branch, state, rate);
            for (rates, rate) in rates.iter_mut().zip(&*rate) {
                rates[stage] = *rate;
            }
        };
        rate_at(0.0, &motion.begin, 0, rates);
        step(&motion.begin, length, rates, state, end, &mut rate_at);
        for (increments, rates) in motion.increments.iter_mut().zip(&*rates) {
            // The end alone gives the extent of the step, the scale of its errors.
            *increments = [mean_rate(rates) * length; NODES.len()];
        }
        let forces = field.force_size(piece, time, branch, &motion.begin);
        let rounding = ROUNDING / tolerance * forces / field.oscillator.mass().value() * length;
        motion.rescale(span, rounding);
        let error = self.error(motion, length) / (SAFETY * tolerance);
        if !error.is_finite() {
            return None;
        }
        let (mut error, mut stiffness) = (error, self.stiffness(motion, length));
        if self.is_settled(motion) {
            field.relaxations(branch, &self.end, &mut self.relaxations);
            stiffness = self.relaxations.iter().fold(stiffness, |most, relaxation| most.max(length * relaxation));
            // The values stay constant in a step of any length, but derivatives and rounding grow
            // in one that is not stable.
            error = error.max((stiffness / STABLE).powi(ORDER));
        }
        let variation = self.variation(motion);
        // A step too long for the method only shows an event within.
        let followed = error <= 1.0 || self.passes(motion, field.belt.value());
        if followed {
            self.follow(motion, field, branch, piece, span);
        }
        Some(Solved { error, quick: true, followed, stiffness, variation })
    }

    /// The greatest local error of a component.
    fn error(&self, motion: &StepPolynomial<D>, length: f64) -> f64 {
        let mut worst = 0.0f64;
        for (component, rates) in self.rates.iter().enumerate() {
            let (fifth, third) = errors(rates);
            let scale = motion.scale(component);
            let (fifth, third) = (fifth.value() / scale, third.value() / scale);
            let error = error(length, fifth * fifth, third * third);
            worst = if error > worst || error.is_nan() { error } else { worst };
        }
        worst
    }

    /// Length of the step times the stiffest rate, estimated from the two stages at its end.
    ///
    /// # References
    /// E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, Springer 1996, section IV.2, eq. (2.25).
    fn stiffness(&self, motion: &StepPolynomial<D>, length: f64) -> f64 {
        let (mut rates, mut states) = (0.0, 0.0);
        for (component, of) in self.rates.iter().enumerate() {
            let scale = motion.scale(component);
            let rate = (of[END] - of[END - 1]).value() / scale;
            let state = (self.end[component] - self.state[component]).value() / scale;
            rates += rate * rate;
            states += state * state;
        }
        if states > 0.0 { length * (rates / states).sqrt() } else { 0.0 }
    }

    /// True if the states rest at their equilibrium. Their values then do not show how fast they would return, but
    /// their derivatives do return.
    fn is_settled(&self, motion: &StepPolynomial<D>) -> bool {
        /// Greatest change of a state that does not count, in units of its scale (1).
        const UNSEEN: f64 = 1e-9;
        let states = self.end.iter().zip(&self.state).enumerate().skip(2);
        let mut states =
            states.map(|(component, (end, state))| ((*end - *state).value() / motion.scale(component)).abs());
        states.all(|change| change <= UNSEEN)
    }

    /// Relative change of the rates of the states over the step (1).
    fn variation(&self, motion: &StepPolynomial<D>) -> f64 {
        let (mut change, mut size) = (0.0, 0.0);
        for (component, of) in self.rates.iter().enumerate().skip(2) {
            let scale = motion.scale(component);
            let [first, last] = [of[0], of[END]].map(|rate| rate.value() / scale);
            change += (last - first) * (last - first);
            size += first * first;
        }
        if change == 0.0 { 0.0 } else { (change / size).sqrt() }
    }

    /// True if the relative velocity or a state has changed its sign.
    fn passes(&self, motion: &StepPolynomial<D>, belt: f64) -> bool {
        let changes = |begin: f64, end: f64| begin * end <= 0.0 && begin != end;
        let [begin, end] = [&motion.begin, &self.end].map(|state| state[1].value());
        changes(begin - belt, end - belt)
            || motion.begin[2..].iter().zip(&self.end[2..]).any(|(begin, end)| changes(begin.value(), end.value()))
    }

    /// The polynomial within the step.
    fn follow<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut StepPolynomial<D>,
        field: &mut Field<D, L>,
        branch: Branch,
        piece: &Piece<D>,
        span: Span,
    ) {
        let Self { rates, state, rate, .. } = self;
        dense_stages(&motion.begin, span.length, rates, state, |elapsed, state, stage, rates| {
            field.rates(piece.force(span.begin + elapsed), branch, state, rate);
            for (rates, rate) in rates.iter_mut().zip(&*rate) {
                rates[stage] = *rate;
            }
        });
        for (increments, rates) in motion.increments.iter_mut().zip(&*rates) {
            *increments = product(&TERMS, &nested(rates, mean_rate(rates) * span.length, span.length));
        }
    }
}

/// The factors of the terms of the interpolant at the stages of the collocation method, term by term: θ, θ(1 − θ),
/// θ²(1 − θ), …
static TERMS: Columns<STAGES, 7> = {
    let mut terms = [NODES; 7];
    let mut term = 1;
    while term < terms.len() {
        let mut stage = 0;
        while stage < STAGES {
            let factor = if term % 2 == 0 { NODES[stage] } else { 1.0 - NODES[stage] };
            terms[term][stage] = terms[term - 1][stage] * factor;
            stage += 1;
        }
        term += 1;
    }
    terms
};
