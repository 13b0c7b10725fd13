//! One step of a motion: the polynomial that a method has found for it.

use fmm_model::Scalar;

use crate::bristle::radau::{
    BERNSTEIN_COLUMNS, CENTRED_COLUMNS, INVERSE, LEGENDRE_COLUMNS, NODES, STAGES, Stages, basis, dot, product,
};
use crate::bristle::taylor::ORDER;

/// Rounding of the state, relative to it.
pub(super) const ROUNDING: f64 = 2e-15;

/// Share of the scale of one half cycle that counts in the next (1): the state contains the errors of the former.
const CARRIED: f64 = 0.3;

/// The interval of a step (s), and the error allowed in it (1).
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) begin: f64,
    pub(super) length: f64,
    pub(super) tolerance: f64,
}

/// The outcome of a step that could be taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solved {
    /// Estimated error anywhere in the step, in units of the tolerance.
    pub(super) error: f64,
    /// True if the method suggests a longer step.
    pub(super) quick: bool,
    /// True if the polynomial describes the step; if not, the step has to be shorter.
    pub(super) followed: bool,
    /// Length of the step times the greatest rate (1/s) at which neighbouring motions approach each other or part.
    pub(super) stiffness: f64,
    /// Relative change of the rates of the states over the step (1).
    pub(super) variation: f64,
}

/// The state at the beginning of a step and the polynomial from there.
pub(super) struct StepPolynomial<D> {
    pub(super) size: usize,
    /// The state at its beginning.
    pub(super) begin: Vec<D>,
    /// Yᵢ − y₀ at all stages of the collocation method, for each component.
    pub(super) increments: Vec<Stages<D>>,
    /// Scale of the errors of each component.
    scale: Vec<f64>,
    /// State at the beginning of the half cycle, with the velocity of the counterface, and distance that each component
    /// has moved from there.
    origin: Vec<f64>,
    moved: Vec<f64>,
    /// Rest of the scale of the half cycle before.
    carried: Vec<f64>,
    state: Vec<D>,
    /// Angular frequency (rad/s) of small vibrations on a spring that is not linear where the step begins, else 0.
    pub(super) local: f64,
    /// Taylor coefficients of each component in powers of τ, for a step of the series.
    pub(super) series: Vec<Series<D>>,
    /// True if the polynomial is that of the series.
    is_series: bool,
}

impl<D: Scalar> StepPolynomial<D> {
    pub(super) fn new(begin: Vec<D>) -> Self {
        let size = begin.len();
        let zero = D::from(0.0);
        Self {
            size,
            increments: vec![[zero; STAGES]; size],
            scale: vec![1.0; size],
            origin: vec![0.0; size],
            moved: vec![0.0; size],
            carried: vec![0.0; size],
            state: begin.clone(),
            local: 0.0,
            series: vec![[zero; ORDER + 1]; size],
            is_series: false,
            begin,
        }
    }

    /// A half cycle begins; errors are relative to its motion. `belt` is the velocity of the counterface.
    pub(super) fn turn(&mut self, belt: f64) {
        for (origin, y) in self.origin.iter_mut().zip(&self.begin) {
            *origin = y.value();
        }
        self.origin[1] = belt;
        for ((carried, scale), moved) in self.carried.iter_mut().zip(&self.scale).zip(&mut self.moved) {
            (*carried, *moved) = (if *moved > 0.0 { CARRIED * scale } else { 0.0 }, 0.0);
        }
    }

    /// Goes to the end of the step, from which the next one begins, and a short `part` of it further along the tangent.
    pub(super) fn advance(&mut self, part: f64) {
        for component in 0..self.size {
            self.moved[component] = self.moved(component);
        }
        if self.is_series {
            for (y, series) in self.begin.iter_mut().zip(&self.series) {
                *y = sum(series, 1.0);
            }
            return;
        }
        for (y, increments) in self.begin.iter_mut().zip(&self.increments) {
            *y += increments[STAGES - 1];
            if part != 0.0 {
                *y += dot(&INVERSE[STAGES - 1], increments) * part;
            }
        }
    }

    /// The state at `tau` in units of the step.
    pub(super) fn at(&self, tau: f64, state: &mut [D]) {
        if self.is_series {
            for (state, series) in state.iter_mut().zip(&self.series) {
                *state = sum(series, tau);
            }
            return;
        }
        let basis = basis(tau);
        for ((state, y), increments) in state.iter_mut().zip(&self.begin).zip(&self.increments) {
            *state = *y + dot(&basis, increments);
        }
    }

    /// The coefficients of a component in powers of 2τ − 1.
    pub(super) fn centred(&self, component: usize) -> [D; STAGES + 1] {
        let mut coefficients = product(&CENTRED_COLUMNS, &self.increments[component]);
        coefficients[0] += self.begin[component];
        coefficients
    }

    /// Writes the state at stage `index` of the collocation method into `state`.
    pub(super) fn load(&self, index: usize, state: &mut [D]) {
        for ((state, y), increments) in state.iter_mut().zip(&self.begin).zip(&self.increments) {
            *state = *y + increments[index];
        }
    }

    /// The slope of a component at the end of the step, per unit of the step.
    pub(super) fn end_slope(&self, component: usize) -> f64 {
        dot(&INVERSE[STAGES - 1], &self.increments[component]).value()
    }

    /// Distance from the end of the step to the time at which the velocity reaches that of the counterface, `belt`,
    /// along the tangent, in units of the step. Infinite if the relative velocity does not fall, or has fallen to a
    /// small part of its greatest value in this half cycle.
    pub(super) fn to_turn(&self, belt: f64) -> f64 {
        const SMALL: f64 = 0.1;
        let relative = self.begin[1].value() + self.increments[1][STAGES - 1].value() - belt;
        let ahead = -relative / self.end_slope(1);
        if ahead > 0.0 && relative.abs() > SMALL * self.scale[1] { ahead } else { f64::INFINITY }
    }

    /// Bernstein coefficients of the polynomial through the `value` of the states at the beginning and at all stages.
    pub(super) fn bernstein(&mut self, mut value: impl FnMut(&[D]) -> f64) -> [f64; STAGES + 1] {
        let mut nodal = [0.0; STAGES + 1];
        nodal[0] = value(&self.begin);
        let mut state = std::mem::take(&mut self.state);
        for (index, nodal) in nodal[1..].iter_mut().enumerate() {
            self.load(index, &mut state);
            *nodal = value(&state);
        }
        self.state = state;
        coefficients(&nodal)
    }

    /// Bernstein coefficients of `sign` times the excess of a component over `level`.
    pub(super) fn bernstein_of(&self, component: usize, level: f64, sign: f64) -> [f64; STAGES + 1] {
        // Next to the level the increments have digits that the sum with the beginning would lose.
        let excess = self.begin[component].value() - level;
        let mut nodal = [excess * sign; STAGES + 1];
        for (nodal, increment) in nodal[1..].iter_mut().zip(&self.increments[component]) {
            *nodal = (excess + increment.value()) * sign;
        }
        coefficients(&nodal)
    }

    /// Scale of the errors of a component.
    pub(super) fn scale(&self, component: usize) -> f64 {
        self.scale[component]
    }

    /// Compares errors with how far each component has moved in this swing, this step included, or with what rounding
    /// makes of it; `rounding` is that of the velocity (m/s) in units of the tolerance.
    pub(super) fn rescale(&mut self, span: Span, rounding: f64) {
        // The rounding of the velocity is that of all that follows it.
        let velocity = self.moved(1);
        let noise = if velocity > 0.0 { (rounding / velocity).max(1.0) } else { 1.0 };
        for component in 0..self.size {
            let moved = if component == 1 { velocity } else { noise * self.moved(component) };
            self.scale[component] = moved.max(self.least_scale(component, span.tolerance, rounding));
        }
        if self.local > 0.0 {
            // On a stop the way since the last reversal is no measure of what an error of the position does.
            let floor = ROUNDING / span.tolerance * self.begin[0].value().abs();
            self.scale[0] = self.scale[0].min(self.scale[1] / self.local).max(floor);
        }
    }

    /// Least scale of the errors of a component before a step; arguments are those of [`rescale`](Self::rescale).
    pub(super) fn least_scale(&self, component: usize, tolerance: f64, rounding: f64) -> f64 {
        let floor = ROUNDING / tolerance * self.begin[component].value().abs();
        let floor = if component == 1 { floor.max(rounding) } else { floor };
        self.moved[component].max(self.carried[component]).max(floor).max(f64::MIN_POSITIVE)
    }

    /// True if the polynomial is that of the series.
    pub(super) const fn is_series(&self) -> bool {
        self.is_series
    }

    /// Takes the polynomial of the stages.
    pub(super) const fn take_stages(&mut self) {
        self.is_series = false;
    }

    /// Takes the polynomial of the series, with a new unit of time, `ratio` times that which it has.
    pub(super) fn take_series(&mut self, ratio: f64) {
        self.is_series = true;
        for series in &mut self.series {
            let mut factor = 1.0;
            for term in series {
                *term *= factor;
                factor *= ratio;
            }
        }
    }

    /// Writes the values of the series at the stages, as a prediction of the next step.
    pub(super) fn fill_stages(&mut self) {
        for ((increments, series), y) in self.increments.iter_mut().zip(&self.series).zip(&self.begin) {
            *increments = NODES.map(|node| sum(series, node) - *y);
        }
    }

    /// Values of the series of a component above `level`, times `sign`.
    pub(super) fn plain_series(&self, component: usize, level: f64, sign: f64) -> Series<f64> {
        let mut series = self.series[component].map(|term| term.value() * sign);
        series[0] = (self.begin[component].value() - level) * sign;
        series
    }

    /// Approximate ratio of the longest step of the collocation method to the step of the series. The first missing
    /// term of the former, of degree s + 1, is smaller by 2^(2s + 1), as its stages spread over the step.
    pub(super) fn reach_of_stages(&self, tolerance: f64) -> f64 {
        let missing = self.series.iter().zip(&self.scale);
        let missing = missing.fold(0.0f64, |most, (series, scale)| most.max(series[STAGES + 1].value().abs() / scale));
        let spread = f64::from(1u32 << (2 * STAGES + 1));
        (tolerance * spread / missing).powf(1.0 / (STAGES + 1) as f64)
    }

    /// Distance that a component has moved in this half cycle, this step included.
    fn moved(&self, component: usize) -> f64 {
        let distance = self.begin[component].value() - self.origin[component];
        if self.is_series {
            let end = value(&self.series[component], 1.0) - self.origin[component];
            return self.moved[component].max(distance.abs()).max(end.abs());
        }
        let increments = &self.increments[component];
        increments.iter().fold(self.moved[component], |most, w| {
            let moved = (distance + w.value()).abs();
            // Nothing but a comparison, as NaN is seen elsewhere.
            if moved > most { moved } else { most }
        })
    }

    /// The first coefficient that the polynomial of y′ lacks, extrapolated from the decay of its last four, as an error
    /// of y relative to its scale.
    pub(super) fn error(&self) -> f64 {
        let mut worst = 0.0f64;
        for (increments, scale) in self.increments.iter().zip(&self.scale) {
            let [first, second, third, last] = product(&LEGENDRE_COLUMNS, &increments.map(D::value)).map(f64::abs);
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

/// One Taylor coefficient an order.
pub(super) type Series<D> = [D; ORDER + 1];

/// The series at `tau` in its unit.
fn sum<D: Scalar>(series: &Series<D>, tau: f64) -> D {
    series.iter().rev().fold(D::from(0.0), |sum, term| sum * tau + *term)
}

/// The value of the series at `tau` in its unit.
pub(super) fn value<D: Scalar>(series: &Series<D>, tau: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, term| sum * tau + term.value())
}

/// Bernstein coefficients from values at the beginning and at all stages.
fn coefficients(nodal: &[f64; STAGES + 1]) -> [f64; STAGES + 1] {
    product(&BERNSTEIN_COLUMNS, nodal)
}
