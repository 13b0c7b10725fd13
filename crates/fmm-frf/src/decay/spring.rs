//! Spring of a backbone, the change of its frequency with the amplitude, and the criterion of a term.

use fmm_fit::{LinearRegression, Weighting};
use fmm_model::Estimated;

use crate::decay::point::BackbonePoint;

/// Relative error of the closed form for the square of the frequency (1): at best, and as a multiple of (k₃ A²)³, the
/// first power that it omits.
const ACCURACY: (f64, f64) = (2e-6, 0.02);
/// Of k₃² A⁴ in the square of the frequency: the third harmonic that a cubic spring makes.
const SECOND_ORDER: f64 = 3.0 / 128.0;
/// Fits until the term of second order is that of its own k₃.
const ROUNDS: usize = 4;

/// Least value of a term of the spring, in its standard uncertainties.
const SIGNIFICANT: f64 = 3.0;

/// Weighted fit of a few columns to the points.
pub(super) struct Fitted {
    /// Sum of the squares of the residuals over their uncertainties.
    pub(super) squares: f64,
    /// Coefficients; their uncertainties are those of the points, or those of the residuals if these are larger.
    pub(super) found: Vec<Estimated>,
    /// Mean square of the second differences of the residuals over that of noise, which a smooth misfit does not raise.
    pub(super) roughness: f64,
}

/// Mean square of the second differences of residuals of windows: neighbours do not correlate, the next but one by
/// −0.45.
const DIFFERENCES: f64 = 5.1;

impl Fitted {
    /// Fit of `columns` to `values`, which are good to a relative `accuracy` (1) at best; `None` if they cannot be
    /// separated, or leave no residual.
    pub(super) fn of(columns: &[Vec<f64>], values: &[Estimated], accuracy: f64) -> Option<Self> {
        if values.len() <= columns.len() {
            return None;
        }
        let right: Vec<f64> = values.iter().map(|value| value.value).collect();
        let weights: Vec<f64> =
            values.iter().map(|value| value.uncertainty.hypot(accuracy * value.value).max(f64::MIN_POSITIVE)).collect();
        let named: Vec<(&str, &[f64])> = columns.iter().map(|column| ("term", column.as_slice())).collect();
        let regression = LinearRegression::fit(&named, &right, Weighting::Absolute(&weights)).ok()?;
        let squares = regression.sum_of_squares();
        let inflation = (squares / (values.len() - columns.len()) as f64).max(1.0).sqrt();
        let found = (0..columns.len()).map(|j| {
            Some(Estimated::new(regression.coefficients()[j], inflation * regression.standard_uncertainty(j)?))
        });
        let differences = regression.residuals().windows(3).map(|three| (three[0] - 2.0 * three[1] + three[2]).powi(2));
        let roughness = differences.sum::<f64>() / (DIFFERENCES * (values.len() as f64 - 2.0).max(1.0));
        Some(Self { squares, found: found.collect::<Option<_>>()?, roughness })
    }

    /// Bayesian criterion for `count` points, whose uncertainties are too small by the square root of `scale`.
    pub(super) fn criterion(&self, count: usize, scale: f64) -> f64 {
        self.squares / scale + self.found.len() as f64 * (count as f64).ln()
    }
}

/// Factors by which the squares of the uncertainties of `count` points are too small for the best of some fits, and for
/// their noise: coloured noise, for example.
pub(super) fn scales(fits: &[&Fitted], count: usize) -> [f64; 2] {
    let freedom = |fit: &Fitted| count.saturating_sub(fit.found.len()).max(1) as f64;
    let least = |of: &dyn Fn(&Fitted) -> f64| fits.iter().map(|fit| of(fit)).reduce(f64::min).unwrap_or(1.0).max(1.0);
    [least(&|fit| fit.squares / freedom(fit)), least(&|fit| fit.roughness)]
}

/// f₀ (Hz), k₃ and k₅, as many of them as `points` show, and the [scale](scales) of their noise.
///
/// ```text
/// f² = f₀² (1 + ¾ k₃ A² + (⅝ k₅ + 3/128 k₃²) A⁴)
/// ```
///
/// A is the amplitude of the first harmonic. A. H. Nayfeh, D. T. Mook, *Nonlinear Oscillations*, Wiley 1979, chapter 2,
/// to second order in k₃ and first in k₅.
pub(super) fn spring_terms(points: &[BackbonePoint]) -> (Vec<Estimated>, f64) {
    let column = |power: i32| points.iter().map(|point| point.amplitude.value.powi(power)).collect::<Vec<f64>>();
    let largest = points.iter().fold(0.0f64, |largest, point| largest.max(point.amplitude.value));
    let columns = [column(0), column(2), column(4)];
    let mut fits: Vec<Fitted> = Vec::new();
    for count in 1..=columns.len() {
        let (mut second, mut accuracy) = (0.0, ACCURACY.0);
        let mut fitted = None;
        for _ in 0..ROUNDS {
            let square = |point: &BackbonePoint| {
                let (f, u) = (point.frequency.value, point.frequency.uncertainty);
                Estimated::new(f * f - second * point.amplitude.value.powi(4), 2.0 * f * u)
            };
            let squares: Vec<Estimated> = points.iter().map(square).collect();
            fitted = Fitted::of(&columns[..count], &squares, accuracy);
            let of = |place: usize| fitted.as_ref().and_then(|fit| fit.found.get(place)).map_or(0.0, |term| term.value);
            let cubic = of(1) / (0.75 * of(0).max(f64::MIN_POSITIVE));
            accuracy = ACCURACY.0.hypot(ACCURACY.1 * (cubic * largest * largest).powi(3));
            second = SECOND_ORDER * cubic * cubic * of(0);
        }
        fits.extend(fitted);
    }
    let [scale, noise] = scales(&fits.iter().collect::<Vec<_>>(), points.len());
    let is_seen = |fit: &&Fitted| {
        let last = fit.found[fit.found.len() - 1];
        last.value.abs() > SIGNIFICANT * last.uncertainty && fit.found[0].value > 0.0
    };
    let criterion = |fit: &Fitted| fit.criterion(points.len(), scale);
    let best = fits.iter().filter(is_seen).min_by(|a, b| criterion(a).total_cmp(&criterion(b)));
    let Some(Fitted { found, .. }) = best else { return (Vec::new(), noise) };
    let stiffness = found[0].value;
    let mut terms = vec![Estimated::new(stiffness.sqrt(), found[0].uncertainty / (2.0 * stiffness.sqrt()))];
    terms.extend(found[1..].iter().zip([0.75, 0.625]).map(|(term, factor)| term.scaled(1.0 / (factor * stiffness))));
    (terms, noise)
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
