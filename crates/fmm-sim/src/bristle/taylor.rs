//! Taylor series of a motion about the beginning of a step, for laws that expand themselves.

use fmm_friction::{BristleLaw, Expansion};
use fmm_model::{Restoring, Scalar};

use crate::bristle::field::{Branch, Field};
use crate::bristle::first_root::first_root;
use crate::bristle::guards::Guard;
use crate::bristle::polynomial::{ROUNDING, Series, Span, StepPolynomial, value};
use crate::bristle::run::Run;
use crate::dormand_prince::bernstein;
use crate::error::SimulationError;
use crate::mechanics::Piece;

/// Highest order of the series.
pub(super) const ORDER: usize = Expansion::<f64>::TERMS - 1;

/// Error allowed in a step, in units of the tolerance; the errors of many steps add up.
const SAFETY: f64 = 0.1;

/// Greatest ratio of the last terms of a component to its first ones, above rounding (1). A greater ratio shows a
/// singularity within the step, as of a state that reaches its bound in finite time.
const FALL: f64 = 1e-3;

/// Step times stiffness up to which a step damps a deviation (1): |1 − x + x²/2! − … + x²⁴/24!| < 0.05.
const STABLE: f64 = 9.0;

/// Greatest angle of a step (rad): the next term is below 1e-10.
const ANGLE: f64 = 4.0;

/// Greatest ratio of the frequency of a wave that exists in derivatives only, unseen by step lengths, to that of the
/// machine (1).
const CALM: f64 = 4.0;

/// Defect of a step, in units of the tolerance, above which its series misses a part of the law. The defect of a
/// complete series is 24 times the error allowed.
const MOST_DEFECT: f64 = 100.0;

/// Number of parts of a step among which the slowest place is sought.
const PARTS: usize = 16;

/// Greatest number of corrections of a zero by Newton's method.
const MOST_CORRECTIONS: usize = 8;

/// The method and its working memory.
pub(super) struct Taylor<D> {
    law: Expansion<D>,
    force: Series<D>,
}

impl<D: Scalar> Taylor<D> {
    pub(super) fn new() -> Self {
        Self { law: Expansion::new(), force: [D::from(0.0); ORDER + 1] }
    }

    /// Writes the series of all components into those of `motion`, in time since `time` (s) in units of `unit` (s).
    /// False if machine or law have none here.
    pub(super) fn expand<L: BristleLaw<D> + ?Sized>(
        &mut self,
        motion: &mut StepPolynomial<D>,
        field: &Field<D, L>,
        branch: Branch,
        piece: &Piece<D>,
        (time, unit): (f64, f64),
    ) -> bool {
        let Some(damping) = field.linear_damping else { return false };
        if motion.size != 3 || !matches!(field.oscillator.restoring(), Restoring::Linear) {
            return false;
        }
        piece.series(time, unit, &mut self.force);
        let Self { law, force } = self;
        let [position, velocity, state] = &mut motion.series[..] else { return false };
        for (series, begin) in [&mut *position, velocity, state].into_iter().zip(&motion.begin) {
            series[0] = *begin;
        }
        let (sign, stiffness) = (branch.direction.sign(), field.oscillator.stiffness());
        law.held = field.saturated[0];
        for order in 0..ORDER {
            let per_order = unit / (order + 1) as f64;
            let relative = if order == 0 { velocity[0] - field.belt } else { velocity[order] };
            law.velocity[order] = relative * sign;
            law.state[order] = state[order] * sign;
            if !field.law.expand(order, law) {
                return false;
            }
            let friction = field.normal_load * law.coefficient[order] * sign;
            let machine = velocity[order] * damping + stiffness * position[order];
            let acceleration =
                if field.guided { force[order] } else { (force[order] - machine - friction) * field.per_mass };
            position[order + 1] = velocity[order] * per_order;
            velocity[order + 1] = acceleration * per_order;
            state[order + 1] = if law.held { D::from(0.0) } else { law.rate[order] * (per_order * sign) };
        }
        true
    }
}

impl<D: Scalar, L: BristleLaw<D> + ?Sized> Run<'_, D, L> {
    /// Goes on by one step of the series, to `limit` (s) at most, or to an event before it. False if there is no series
    /// here.
    pub(super) fn expand(&mut self, piece: &Piece<D>, limit: f64) -> Result<bool, SimulationError> {
        let at_zero = self.step.begin[1].value() == self.field.belt.value();
        let unit = self.first_length().min(limit - self.time);
        let Self { step, taylor, field, branch, time, .. } = self;
        if !taylor.expand(step, field, *branch, piece, (*time, unit)) {
            return Ok(false);
        }
        self.count_step()?;
        let forces = self.field.force_size(piece, self.time, self.branch, &self.step.begin);
        let mass = self.field.oscillator.mass().value();
        let tolerance = self.tolerance;
        let rounding = |length: f64| ROUNDING / tolerance * forces / mass * length;
        let mut length = unit * ratio(&self.step, tolerance, rounding(unit));
        let room = limit - self.time;
        length = if length < room { length } else { room };
        if !(length > self.least(length)) {
            return Ok(false);
        }
        self.step.take_series(length / unit);
        let Some(rate) = self.rate_at_end() else { return Ok(false) };
        if rate * length > STABLE {
            let part = STABLE / (rate * length);
            self.step.take_series(part);
            length *= part;
        }
        let span = Span { begin: self.time, length, tolerance };
        self.step.rescale(span, rounding(length));
        let found = self.first_guard_of_series(at_zero);
        if !self.is_obeyed(piece, length, found.as_ref().map_or(1.0, |found| found.tau)) {
            return Ok(false);
        }
        if let Some(Found { tau, guard, grazing }) = found {
            if tau * length <= self.least(length) {
                if at_zero && guard == Guard::Speed {
                    return Ok(false);
                }
                return self.arrive(guard, piece, false).map(|()| true);
            }
            self.step.take_series(tau);
            length *= tau;
            let Some(part) = self.hidden(piece, length) else {
                self.finish(length, 0.0, limit, piece)?;
                return self.arrive(guard, piece, grazing).map(|()| true);
            };
            self.step.take_series(part);
            length *= part;
        } else if let Some(part) = self.hidden(piece, length) {
            self.step.take_series(part);
            length *= part;
        }
        let reach = self.step.reach_of_stages(tolerance).min((room - length) / length);
        self.pace.expand(rate * length / STABLE, reach, length);
        if self.pace.implicit {
            self.collocation.forget();
            self.step.fill_stages();
        }
        self.finish(length, 0.0, limit, piece).map(|()| true)
    }

    /// The greatest rate (1/s) at which velocity and state decay or oscillate at the end of the step, the latter in
    /// units of the greatest angle of a step. `None` if the end is not finite.
    ///
    /// Derivatives oscillate even if values stand still, and do not decide the length of a step.
    fn rate_at_end(&mut self) -> Option<f64> {
        self.step.at(1.0, &mut self.after);
        if !self.after.iter().all(|y| y.value().is_finite()) {
            return None;
        }
        let mut jacobian = [0.0; 9];
        self.field.jacobian(self.branch, &self.after, self.step.scale(1), &mut jacobian);
        let [_, _, _, spring, drag, bristle, _, bend, relax] = jacobian.map(f64::abs);
        let swing = (CALM * spring.sqrt()).max((bristle * bend).sqrt());
        Some(drag.max(relax).max(swing * (STABLE / ANGLE)))
    }

    /// True if the series obeys the equation of motion up to `end`, a part of the step of this `length`: at its
    /// quarters and at the slowest place. The last terms of the series do not show a part of the law that begins within
    /// the step, such as the rise of friction during a slow part of a fast motion. They do show if the position follows
    /// the velocity, which does not depend on the law.
    fn is_obeyed(&mut self, piece: &Piece<D>, length: f64, end: f64) -> bool {
        let [position, velocity, state] = [0, 1, 2].map(|component| self.step.plain_series(component, 0.0, 1.0));
        let belt = self.field.belt.value();
        let parts: [f64; PARTS] = std::array::from_fn(|part| end * (part + 1) as f64 / PARTS as f64);
        let speeds = values(&velocity, &parts).map(|velocity| (velocity - belt).abs());
        let slowest = (1..PARTS).min_by(|a, b| speeds[a - 1].total_cmp(&speeds[b - 1])).unwrap_or(PARTS);
        let places = [PARTS, 3 * PARTS / 4, PARTS / 2, PARTS / 4, slowest].map(|part| parts[part - 1]);
        let motion = [&position, &velocity, &state].map(|series| values(series, &places));
        let slopes = [&velocity, &state].map(|series| values(&derivative(series), &places));
        let mut rates = [D::from(0.0); 3];
        (0..places.len()).all(|place| {
            for (y, values) in self.after.iter_mut().zip(&motion) {
                *y = D::from(values[place]);
            }
            let force = piece.force(self.time + length * places[place]);
            self.field.rates(force, self.branch, &self.after, &mut rates);
            slopes.iter().enumerate().all(|(component, slopes)| {
                let defect = (slopes[place] - rates[component + 1].value() * length).abs();
                defect <= MOST_DEFECT * self.tolerance * self.step.scale(component + 1)
            })
        })
    }

    /// The first guard that is reached within the step, and its place. A step that begins `at_zero` velocity does not
    /// find that zero.
    fn first_guard_of_series(&self, at_zero: bool) -> Option<Found> {
        let (belt, sign) = (self.field.belt.value(), self.branch.direction.sign());
        let speed = zero_of(self.step.plain_series(1, belt, sign), at_zero).map(|tau| (tau, Guard::Speed));
        let state = self.step.begin[2].value();
        let is_below = self.field.below[0] && state != 0.0;
        let corner = if is_below { zero_of(self.step.plain_series(2, 0.0, state.signum()), false) } else { None };
        let corner = corner.map(|tau| (tau, Guard::Corner(2)));
        let (tau, guard) = match (speed, corner) {
            (Some(speed), Some(corner)) => {
                if corner.0 < speed.0 {
                    corner
                } else {
                    speed
                }
            }
            (found, None) | (None, found) => found?,
        };
        if guard != Guard::Speed {
            return Some(Found { tau, guard, grazing: false });
        }
        let series = self.step.plain_series(1, belt, sign);
        let [slope, curvature] = slopes(&series, tau);
        let size = series.iter().fold(0.0f64, |size, term| size.max(term.abs()));
        // Where the slope is that small, rounding moves the zero further than it is from the turning point.
        let grazing = slope >= 0.0 || slope * slope <= 4.0 * f64::EPSILON * size * curvature.abs();
        Some(Found { tau, guard, grazing })
    }
}

/// A guard reached within a step, at `tau` in its units.
struct Found {
    tau: f64,
    guard: Guard,
    /// True if the guard has no slope there.
    grazing: bool,
}

/// The length of a step that the last two terms allow, in the unit of the series. `rounding` is that of
/// [`rescale`](StepPolynomial::rescale).
fn ratio<D: Scalar>(motion: &StepPolynomial<D>, tolerance: f64, rounding: f64) -> f64 {
    let mut ratio: f64 = 1.0;
    for _ in 0..3 {
        let [mut last, mut before] = [0.0f64; 2];
        for (component, series) in motion.series.iter().enumerate() {
            let [begin, first, second, third, ..] = series.map(|term| term.value().abs());
            let moves = (first * ratio).max(second * ratio * ratio);
            let allowed = SAFETY * tolerance * motion.least_scale(component, tolerance, rounding).max(moves);
            let largest = FALL * moves.max(third * ratio.powi(3));
            let per_allowed = 1.0 / allowed.min(largest.max(f64::EPSILON * begin));
            last = last.max(series[ORDER].value().abs() * per_allowed);
            before = before.max(series[ORDER - 1].value().abs() * per_allowed);
        }
        let by_last = last.powf(-1.0 / ORDER as f64);
        let next = by_last.min(before.powf(-1.0 / (ORDER - 1) as f64));
        let settled = (next / ratio - 1.0).abs() < 0.05;
        ratio = next;
        if settled {
            break;
        }
    }
    ratio
}

/// The first zero in [0, 1] of a series that is positive before; of one that begins `at_zero` the first after that.
fn zero_of(mut series: Series<f64>, at_zero: bool) -> Option<f64> {
    if at_zero {
        // That zero is divided out.
        series.rotate_left(1);
        series[ORDER] = 0.0;
    }
    let lowest = series[0] + series[1..].iter().map(|term| term.min(0.0)).sum::<f64>();
    if lowest > 0.0 {
        return None;
    }
    let found = first_root(bernstein(series))?;
    let mut tau = found;
    for _ in 0..MOST_CORRECTIONS {
        let [slope, _] = slopes(&series, tau);
        let correction = value(&series, tau) / slope;
        tau -= correction;
        if !(correction.abs() > f64::EPSILON * tau) {
            break;
        }
    }
    // Next to another zero, corrections may lead anywhere.
    Some(if (tau - found).abs() < 1e-3 * found && tau <= 1.0 { tau } else { found })
}

/// The values of a series at several `places`, whose sums do not wait for each other.
fn values<const N: usize>(series: &Series<f64>, places: &[f64; N]) -> [f64; N] {
    let mut sums = [0.0; N];
    for term in series.iter().rev() {
        for (sum, place) in sums.iter_mut().zip(places) {
            *sum = *sum * place + term;
        }
    }
    sums
}

/// The series of the derivative.
fn derivative(series: &Series<f64>) -> Series<f64> {
    std::array::from_fn(|order| if order < ORDER { (order + 1) as f64 * series[order + 1] } else { 0.0 })
}

/// First and second derivatives of a series at `tau`.
fn slopes(series: &Series<f64>, tau: f64) -> [f64; 2] {
    let terms = series.iter().enumerate().rev();
    terms.fold([0.0; 2], |[slope, curvature], (order, term)| {
        let order = order as f64;
        if order < 1.0 {
            return [slope, curvature];
        }
        let curvature = if order < 2.0 { curvature } else { curvature * tau + order * (order - 1.0) * term };
        [slope * tau + order * term, curvature]
    })
}
