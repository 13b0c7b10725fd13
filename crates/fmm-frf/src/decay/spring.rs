//! Spring of a backbone, the change of its frequency with the amplitude, and the criterion of a term.

use fmm_fit::{LinearRegression, Weighting};
use fmm_model::Estimated;

use crate::decay::backbone::BackbonePoint;

/// Relative error of the closed form for the square of the frequency (1): at best, and as a multiple of (k₃ A²)³, the
/// first power that it omits.
const ACCURACY: (f64, f64) = (2e-6, 0.02);
/// Of k₃² A⁴ in the square of the frequency: the third harmonic that a cubic spring makes.
const SECOND_ORDER: f64 = 3.0 / 128.0;
/// Fits until the term of second order is that of its own k₃.
const ROUNDS: usize = 4;

/// Least value of a coefficient, in its standard uncertainties.
pub(super) const SIGNIFICANT: f64 = 2.0;
/// Points of one window: neighbours share three quarters of their samples.
const POINTS_PER_WINDOW: f64 = 2.0;

/// Coefficients of `columns` for `values`, and the Bayesian criterion of the rest; `None` if they cannot be separated.
///
/// Values are taken to be good to a relative `accuracy` (1) at best.
pub(super) fn scored(columns: &[Vec<f64>], values: &[Estimated], accuracy: f64) -> Option<(f64, Vec<Estimated>)> {
    let count = values.len() as f64 / POINTS_PER_WINDOW;
    if count < columns.len() as f64 + 1.0 {
        return None;
    }
    let right: Vec<f64> = values.iter().map(|value| value.value).collect();
    let weights: Vec<f64> =
        values.iter().map(|value| value.uncertainty.hypot(accuracy * value.value).max(f64::MIN_POSITIVE)).collect();
    let named: Vec<(&str, &[f64])> = columns.iter().map(|column| ("term", column.as_slice())).collect();
    let regression = LinearRegression::fit(&named, &right, Weighting::Absolute(&weights)).ok()?;
    // The points share samples, and are not better than their uncertainties.
    let spread = (regression.sum_of_squares() / values.len() as f64).max(1.0);
    let inflation = (POINTS_PER_WINDOW * spread).sqrt();
    let found = (0..columns.len())
        .map(|j| Some(Estimated::new(regression.coefficients()[j], inflation * regression.standard_uncertainty(j)?)));
    let score = count * spread.ln() + columns.len() as f64 * count.ln();
    Some((score, found.collect::<Option<_>>()?))
}

/// f₀ (Hz), k₃ and k₅, as many of them as `points` show.
///
/// ```text
/// f² = f₀² (1 + ¾ k₃ A² + (⅝ k₅ + 3/128 k₃²) A⁴)
/// ```
///
/// A is the amplitude of the first harmonic. A. H. Nayfeh, D. T. Mook, *Nonlinear Oscillations*, Wiley 1979, chapter 2,
/// to second order in k₃ and first in k₅.
pub(super) fn spring_terms(points: &[BackbonePoint]) -> Vec<Estimated> {
    let column = |power: i32| points.iter().map(|point| point.amplitude.value.powi(power)).collect::<Vec<f64>>();
    let largest = points.iter().fold(0.0f64, |largest, point| largest.max(point.amplitude.value));
    let columns = [column(0), column(2), column(4)];
    let mut best: Option<(f64, Vec<Estimated>)> = None;
    for count in 1..=columns.len() {
        let (mut second, mut accuracy) = (0.0, ACCURACY.0);
        let mut fitted = None;
        for _ in 0..ROUNDS {
            let square = |point: &BackbonePoint| {
                let (f, u) = (point.frequency.value, point.frequency.uncertainty);
                Estimated::new(f * f - second * point.amplitude.value.powi(4), 2.0 * f * u)
            };
            let squares: Vec<Estimated> = points.iter().map(square).collect();
            fitted = scored(&columns[..count], &squares, accuracy);
            let of =
                |place: usize| fitted.as_ref().and_then(|(_, found)| found.get(place)).map_or(0.0, |term| term.value);
            let cubic = of(1) / (0.75 * of(0));
            if cubic.is_finite() {
                accuracy = ACCURACY.0.hypot(ACCURACY.1 * (cubic * largest * largest).powi(3));
            }
            second = if cubic.is_finite() { SECOND_ORDER * cubic * cubic * of(0) } else { 0.0 };
        }
        let Some((score, found)) = fitted else { break };
        let last = found[count - 1];
        let is_significant = last.value.abs() > SIGNIFICANT * last.uncertainty && found[0].value > 0.0;
        if is_significant && best.as_ref().is_none_or(|(least, _)| score < *least) {
            best = Some((score, found));
        }
    }
    let Some((_, found)) = best else { return Vec::new() };
    let stiffness = found[0].value;
    let mut terms = vec![Estimated::new(stiffness.sqrt(), found[0].uncertainty / (2.0 * stiffness.sqrt()))];
    terms.extend(found[1..].iter().zip([0.75, 0.625]).map(|(term, factor)| term.scaled(1.0 / (factor * stiffness))));
    terms
}

/// k₃ and k₅ of the [terms](spring_terms), and all that goes with A⁴.
fn powers(spring: &[Estimated]) -> (f64, f64) {
    let [k3, k5] = [1, 2].map(|place| spring.get(place).map_or(0.0, |term| term.value));
    (0.75 * k3, 0.625 * k5 + SECOND_ORDER * k3 * k3)
}

/// f²/f₀² at the amplitude `a` on a spring of these [terms](spring_terms).
pub(super) fn stiffening(spring: &[Estimated], a: f64) -> f64 {
    let ((second, fourth), square) = (powers(spring), a * a);
    (fourth * square + second) * square + 1.0
}

/// d ln ω/d ln A at the amplitude `a` on a spring of these [terms](spring_terms).
pub(super) fn bend(spring: &[Estimated], a: f64) -> f64 {
    let ((second, fourth), square, stiffening) = (powers(spring), a * a, stiffening(spring, a));
    if stiffening > 0.0 { (2.0 * fourth * square + second) * square / stiffening } else { 0.0 }
}
