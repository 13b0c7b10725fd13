//! Guards, the ends of a smooth branch, and their zeros within a step.

use fmm_friction::BristleLaw;
use fmm_model::Scalar;

use crate::bristle::first_root::{end_slope, first_root, last_coefficient, next_root, root_beyond};
use crate::bristle::polynomial::ROUNDING;
use crate::bristle::radau::STAGES;
use crate::bristle::run::Run;
use crate::mechanics::Range;

/// A quantity that is positive on a smooth branch and zero at its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Guard {
    /// The relative velocity reaches zero.
    Speed,
    /// An element begins to slide.
    Reserve(usize),
    /// The velocity, or a state of the law, passes zero, where damping or law may have a corner. This is no event.
    Corner(usize),
    /// The position passes the corner of the spring behind which it is in this range. This is no event.
    SpringCorner(Range),
}

/// A guard to whose zero steps are shortened or stretched.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approach {
    pub(super) guard: Guard,
    /// Least distance of their ends from the zero, in units of the step.
    pub(super) nearest: f64,
}

impl Approach {
    /// The approach to `guard`, continued if it is under way.
    pub(super) fn of(guard: Guard, under_way: Option<Self>) -> Self {
        under_way.filter(|approach| approach.guard == guard).unwrap_or(Self { guard, nearest: f64::INFINITY })
    }
}

/// Position of the end of a step relative to the zero of a guard. Corrections are in units of the step, positive if the
/// zero is ahead.
#[derive(Debug, Clone, Copy)]
pub(super) enum Landing {
    /// The tangent covers the rest.
    There {
        correction: f64,
        /// True if the guard has no slope there.
        grazing: bool,
    },
    /// A step changed by the correction ends at the zero, or nearer to it.
    Near { correction: f64 },
    /// The zero, if there is one, is elsewhere.
    Far,
}

/// Greatest last Legendre coefficient of a guard on a step, relative to the guard (1).
const SMOOTH: f64 = 1e-4;

/// Rest of a step behind a located event, up to which the state is continued along its tangent.
const TANGENT: f64 = 1e-9;

/// Greatest distance of a zero from the end of a step at which its polynomial is used, in units of the step.
const NEAR: f64 = 0.1;

/// A step has to be shorter for its guards to be seen.
pub(super) struct NotSmooth;

impl<D: Scalar, L: BristleLaw<D> + ?Sized> Run<'_, D, L> {
    /// The first guard that is reached within the step, and its place. A step that begins `at_zero` velocity does not
    /// find that zero.
    ///
    /// # Errors
    /// [`NotSmooth`] if the polynomial of an element's reserve is not as accurate as those of the motion, as the
    /// reserve may depend on the velocity in another way: its zeros cannot be sought on the polynomial.
    pub(super) fn first_guard(&mut self, at_zero: bool) -> Result<Option<(f64, Guard)>, NotSmooth> {
        let mut first: Option<(f64, Guard)> = None;
        let velocity = self.step.begin[1].value();
        let mut look = |coefficients: [f64; STAGES + 1], guard| {
            let root = match guard {
                Guard::Speed if at_zero => next_root(coefficients),
                // A motion that has just passed the corner may come back at once.
                Guard::SpringCorner(_) if coefficients[0] == 0.0 => root_beyond(coefficients, velocity),
                _ => first_root(coefficients),
            };
            if let Some(tau) = root
                && first.is_none_or(|(earliest, _)| tau < earliest)
            {
                first = Some((tau, guard));
            }
        };
        look(self.guard_polynomial(Guard::Speed), Guard::Speed);
        for index in 0..self.field.size() - 2 {
            if let Some(size) = self.field.reserve_size(index, self.branch, &self.step.begin) {
                let coefficients = self.guard_polynomial(Guard::Reserve(index));
                let most = coefficients.iter().fold(0.0f64, |most, coefficient| most.max(coefficient.abs()));
                // A small reserve consists mostly of the rounding of its terms.
                if !(last_coefficient(coefficients) * most <= SMOOTH * most + ROUNDING * size) {
                    return Err(NotSmooth);
                }
                look(coefficients, Guard::Reserve(index));
            }
        }
        let drag = !self.field.oscillator.damping().is_linear() && self.field.belt.value() != 0.0;
        for component in 1..self.field.size() {
            let may_bend = if component == 1 { drag } else { self.field.below[component - 2] };
            if may_bend && self.step.begin[component].value() != 0.0 {
                look(self.guard_polynomial(Guard::Corner(component)), Guard::Corner(component));
            }
        }
        for corner in self.field.spring.ends() {
            let guard = Guard::SpringCorner(corner.next);
            look(self.guard_polynomial(guard), guard);
        }
        Ok(first)
    }

    /// Bernstein coefficients of a guard, positive before it is reached.
    fn guard_polynomial(&mut self, guard: Guard) -> [f64; STAGES + 1] {
        let Self { step, field, branch, .. } = self;
        match guard {
            Guard::Speed => {
                let (belt, sign) = (field.belt.value(), branch.direction.sign());
                step.bernstein_of(1, belt, sign)
            }
            Guard::Reserve(index) => {
                step.bernstein(|state| field.reserve(index, *branch, state).map_or(f64::INFINITY, Scalar::value))
            }
            Guard::Corner(component) => {
                let sign = step.begin[component].value().signum();
                step.bernstein_of(component, 0.0, sign)
            }
            Guard::SpringCorner(range) => {
                let corner = field.spring.end_towards(range);
                let (position, before) =
                    corner.map_or((f64::INFINITY, -1.0), |corner| (corner.position, corner.before));
                step.bernstein_of(0, position, before)
            }
        }
    }

    /// Position of the end of the step relative to the zero of `guard`; the step before has ended `nearest` (1) to it.
    pub(super) fn landing(&mut self, guard: Guard, nearest: f64) -> Landing {
        let coefficients = self.guard_polynomial(guard);
        let slope = match guard {
            Guard::Speed => self.step.end_slope(1) * self.branch.direction.sign(),
            Guard::Reserve(_) | Guard::Corner(_) | Guard::SpringCorner(_) => end_slope(coefficients),
        };
        let [.., before, last, end] = coefficients;
        let curvature = (STAGES * (STAGES - 1)) as f64 * (end - 2.0 * last + before);
        let size = coefficients.iter().fold(0.0f64, |size, coefficient| size.max(coefficient.abs()));
        let component = match guard {
            Guard::Speed => 1,
            Guard::Reserve(index) => 2 + index,
            Guard::Corner(component) => component,
            Guard::SpringCorner(_) => 0,
        };
        // A guard counts as zero within the error of a step.
        let is_zero = end.abs() <= self.tolerance * size.max(self.step.scale(component));
        // Where the slope is that small, rounding moves the zero further than it is from the turning point.
        if slope >= 0.0 || slope * slope <= 4.0 * f64::EPSILON * size * curvature.abs() {
            return if is_zero { Landing::There { correction: 0.0, grazing: true } } else { Landing::Far };
        }
        let correction = -end / slope;
        let distance = correction.abs();
        // Corrections that no longer shrink are rounding, as long as the tangent is good enough for them.
        let stagnates = distance > 0.5 * nearest && (is_zero || distance * distance <= self.tolerance);
        if distance <= TANGENT || stagnates {
            Landing::There { correction, grazing: false }
        } else if distance < NEAR {
            Landing::Near { correction }
        } else {
            Landing::Far
        }
    }
}
