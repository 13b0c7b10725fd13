//! The first zero of a curve, found without ever stepping over one.

use crate::SimulationError;
use crate::curve::{Curve, Jet};

/// Steps of a search, over all events of a run, before it is given up: a contact that holds under a wave for a million
/// periods is no record.
pub(crate) const SEARCH_BUDGET: usize = 5_000_000;

/// Rounding of a value, in units of the sum of the magnitudes of its terms.
pub(crate) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Largest distance below zero, in the same units, at which a curve may begin that is known to begin at zero and rises:
/// its terms are rounded sums.
const AT_ZERO: f64 = 1e-12;

/// The first time in (0, `limit`] at which `curve`, positive until then, reaches zero.
///
/// From each point the curve lies above its tangent less the parabola of its greatest curvature ahead. The search goes
/// to where that lower bound reaches zero, which the curve cannot do before, so that no zero is missed however close
/// two of them are. Near a simple zero this is Newton's method from the near side, and converges as fast.
///
/// A zero at the start is left behind if the curve rises from it. Where it neither rises nor is positive, the start
/// itself is the zero.
///
/// # Errors
/// [`SimulationError::Exhausted`] if `budget` steps are not enough.
pub(crate) fn first_zero(curve: &Curve<f64>, limit: f64, budget: &mut usize) -> Result<Option<f64>, SimulationError> {
    let mut elapsed = 0.0;
    loop {
        let Jet { value, slope, curvature, most_curvature, most_jerk, size } = curve.jet(elapsed);
        if !(value.is_finite() && slope.is_finite() && most_curvature.is_finite()) {
            return Err(SimulationError::NotFinite { time: elapsed });
        }
        let level = 1e-13 * (most_curvature * size).sqrt();
        let (rises, falls) = (slope > level, slope < -level);
        let bends = !falls && curvature > 1e-13 * most_curvature;
        if elapsed == 0.0 && value < -(if rises || bends { AT_ZERO } else { ROUNDING }) * size {
            return Ok(Some(0.0));
        }
        let low = value <= ROUNDING * size;
        if low && slope < 0.0 && elapsed > 0.0 {
            return Ok(Some(elapsed));
        }
        let value = value.max(0.0);
        // The positive root of value + slope h − most_curvature h²/2, without cancellation.
        let root = (slope * slope + 2.0 * most_curvature * value).sqrt();
        let mut step = if slope > 0.0 { (slope + root) / most_curvature } else { 2.0 * value / (root - slope) };
        if most_curvature == 0.0 {
            // A straight line.
            step = if slope < 0.0 { value / -slope } else { f64::INFINITY };
        } else if low && !rises {
            // It starts from zero with no slope to speak of: the curvature decides.
            if !bends {
                return Ok((elapsed == 0.0 || slope < 0.0).then_some(elapsed));
            }
            step = step.max(curvature / most_jerk.max(f64::MIN_POSITIVE));
        }
        let next = elapsed + step;
        if !(next < limit) {
            return Ok(at_limit(curve, elapsed, limit));
        }
        if next <= elapsed {
            return Ok(Some(elapsed));
        }
        elapsed = next;
        *budget = budget.checked_sub(1).ok_or_else(|| SimulationError::event_budget(SEARCH_BUDGET, limit))?;
    }
}

/// The bound reaches zero at or after `limit`: the limit is a zero only if the curve has come down to it there.
fn at_limit(curve: &Curve<f64>, elapsed: f64, limit: f64) -> Option<f64> {
    if !limit.is_finite() || elapsed >= limit {
        return None;
    }
    let Jet { value, slope, size, .. } = curve.jet(limit);
    (value <= ROUNDING * size && slope < 0.0).then_some(limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Wave;

    fn wave(constant: f64, angular: f64, cosine: f64, sine: f64) -> Curve<'static, f64> {
        let mut curve = Curve::line(constant, 0.0);
        curve.waves.push(Wave { angular, cosine, sine });
        curve
    }

    fn zero(curve: &Curve<f64>, limit: f64) -> Option<f64> {
        first_zero(curve, limit, &mut 10_000).unwrap()
    }

    #[test]
    fn finds_the_first_of_two_close_zeros_and_none_that_is_not_there() {
        // 1 + δ + cos τ touches −δ or misses zero by δ at π.
        for gap in [1e-3, 1e-6, 1e-9, 1e-12] {
            let first = zero(&wave(1.0 - gap, 1.0, 1.0, 0.0), 10.0).expect("two zeros around π");
            let expected = (gap - 1.0f64).acos();
            // cos is flat there: an error of 1e-15 in the value moves the zero by 1e-15/√(2 δ).
            assert!((first - expected).abs() < 2e-15 / (2.0 * gap).sqrt() + 1e-15, "δ = {gap}: {first}");
            assert_eq!(zero(&wave(1.0 + gap, 1.0, 1.0, 0.0), 1000.0), None, "δ = {gap}");
        }
    }

    #[test]
    fn leaves_a_zero_at_the_start_behind() {
        // sin τ rises from zero; 1 − cos τ has no slope there.
        let sine = zero(&wave(0.0, 2.0, 0.0, 1.0), 10.0).unwrap();
        assert!((sine - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let mut cosine = wave(1.0, 1.0, -1.0, 0.0);
        cosine.slope = -0.01;
        let mut lifted = cosine.clone();
        lifted.slope = 0.0;
        assert_eq!(zero(&lifted, 6.0), None);
        assert_eq!(zero(&wave(0.0, 1.0, 0.0, -1.0), 10.0), Some(0.0), "it falls from zero");
        // 1 − cos τ − τ/2 falls from zero although it bends upwards.
        let mut bent = wave(1.0, 1.0, -1.0, 0.0);
        bent.slope = -0.5;
        assert_eq!(zero(&bent, 10.0), Some(0.0));
    }

    #[test]
    fn lines_need_one_division() {
        assert_eq!(zero(&Curve::line(3.0, -2.0), 10.0), Some(1.5));
        assert_eq!(zero(&Curve::line(3.0, -2.0), 1.5), Some(1.5));
        assert_eq!(zero(&Curve::line(3.0, -2.0), 1.4), None);
        assert_eq!(zero(&Curve::line(3.0, 0.0), f64::INFINITY), None);
        assert_eq!(zero(&Curve::line(0.0, 1.0), f64::INFINITY), None);
    }

    #[test]
    fn an_endless_search_ends_with_an_error() {
        let error = first_zero(&wave(1.5, 1e9, 1.0, 0.0), 1e9, &mut 1000).unwrap_err();
        assert!(matches!(error, SimulationError::Exhausted { .. }), "{error}");
    }
}
