//! Covariance of the estimates when the residuals are not independent of each other.

use std::ops::Range;

use crate::problem::block::Structure;
use crate::{EvaluationError, Fit, Residuals};

/// Covariance of the estimates of a fit whose residuals are correlated with their neighbours.
///
/// ```text
/// V = (JᵀJ)⁺ S (JᵀJ)⁺,     S = 1/b Σ_w g_w g_wᵀ,     g_w = Σ_{i ∈ w} Jᵢ rᵢ     over all windows w of b residuals
/// ```
///
/// The sums over overlapping windows are the long-run covariance of the scores Jᵢ rᵢ, with the triangular weights
/// of Newey and West, in one pass over the residuals. It needs no model of the correlation and holds where the law
/// misses something, as it takes the residuals as they are. It is too small if correlations last longer
/// than a window, and uncertain by about √(b/n), so windows should be a few correlation times long and many.
///
/// # References
/// W. K. Newey, K. D. West, Econometrica 55 (1987) 703, <https://doi.org/10.2307/1913610>;
/// M. S. Meketon, B. Schmeiser, "Overlapping batch means", Proc. Winter Simulation Conf. 1984, 226.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrelatedCovariance {
    count: usize,
    elements: Vec<Option<f64>>,
}

impl CorrelatedCovariance {
    /// Takes the residuals of `fit` to `problem` in windows of `span`; windows never reach from one of `series`
    /// into the next. The series are ranges of residuals, such as one per record.
    ///
    /// None if the problem gives no derivatives of its own, or if no series holds a window.
    ///
    /// # Errors
    /// [`EvaluationError`] if the problem has no derivatives at the fitted values.
    pub fn of<P: Residuals + ?Sized>(
        problem: &P,
        fit: &Fit,
        span: usize,
        series: &[Range<usize>],
    ) -> Result<Option<Self>, EvaluationError> {
        let (rows, count) = (problem.len(), fit.values().len());
        let structure = Structure::of(problem)?;
        let mut jacobian = vec![0.0; structure.len()];
        if span == 0 || !problem.jacobian(fit.values(), &mut jacobian)? {
            return Ok(None);
        }
        let derivatives = structure.by_row(count);
        let score = |i: usize, j: usize| derivatives.element(&jacobian, i, j) * fit.residuals()[i];
        let mut middle = vec![0.0; count * count];
        let mut windows = 0usize;
        for range in series.iter().filter(|range| range.len() >= span && range.end <= rows) {
            let mut window: Vec<f64> =
                (0..count).map(|j| (range.start..range.start + span).map(|i| score(i, j)).sum()).collect();
            for end in range.start + span..=range.end {
                for (a, row) in middle.chunks_exact_mut(count).enumerate() {
                    for (element, other) in row.iter_mut().zip(&window) {
                        *element += window[a] * other;
                    }
                }
                windows += 1;
                if end < range.end {
                    for (j, sum) in window.iter_mut().enumerate() {
                        *sum += score(end, j) - score(end - span, j);
                    }
                }
            }
        }
        if windows == 0 {
            return Ok(None);
        }
        // Each window stands for `span` of the residuals, and the windows together for all of them.
        let weight = fit.residuals().len() as f64 / (windows as f64 * span as f64);
        let inverse = |a: usize, b: usize| fit.unit_covariance(a, b);
        let determined: Vec<usize> = (0..count).filter(|&j| inverse(j, j).is_some()).collect();
        let mut elements = vec![None; count * count];
        for &i in &determined {
            for &j in &determined {
                let mut sum = 0.0;
                for &a in &determined {
                    for &b in &determined {
                        let (left, right) = (inverse(i, a).unwrap_or(0.0), inverse(b, j).unwrap_or(0.0));
                        sum += left * middle[a * count + b] * right;
                    }
                }
                elements[i * count + j] = Some(weight * sum);
            }
        }
        Ok(Some(Self { count, elements }))
    }

    /// Covariance of the estimates of parameters `i` and `j`, in the product of their units; none where the fit has
    /// none.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        if i < self.count && j < self.count { self.elements[i * self.count + j] } else { None }
    }

    /// Standard uncertainty of the estimate of parameter `i`, in its unit.
    pub fn standard_uncertainty(&self, i: usize) -> Option<f64> {
        self.covariance(i, i).map(f64::sqrt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, solve};
    use fmm_model::Parameter;

    /// A mean and a slope through a series of noise.
    struct Line {
        data: Vec<f64>,
        parameters: [Parameter; 2],
    }

    impl Residuals for Line {
        fn parameters(&self) -> &[Parameter] {
            &self.parameters
        }
        fn len(&self) -> usize {
            self.data.len()
        }
        fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
            let scale = 1.0 / self.len() as f64;
            for (i, (r, y)) in residuals.iter_mut().zip(&self.data).enumerate() {
                *r = p[0] + p[1] * i as f64 * scale - y;
            }
            Ok(())
        }
        fn jacobian(&self, _p: &[f64], jacobian: &mut [f64]) -> Result<bool, EvaluationError> {
            let (ones, times) = jacobian.split_at_mut(self.len());
            let scale = 1.0 / ones.len() as f64;
            ones.fill(1.0);
            times.iter_mut().enumerate().for_each(|(i, t)| *t = i as f64 * scale);
            Ok(true)
        }
    }

    /// First-order autoregression xᵢ = φ xᵢ₋₁ + eᵢ of uniform noise from a linear congruential generator.
    fn line(correlation: f64) -> Line {
        let mut state = 12_345u64;
        let mut x = 0.0;
        let data = (0..40_000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                x = correlation * x + (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                x
            })
            .collect();
        Line { data, parameters: [Parameter::new("mean", "a", "1"), Parameter::new("slope", "b", "1")] }
    }

    /// The uncertainty of a mean of an autoregression is √((1 + φ)/(1 − φ)) times that of independent residuals; with
    /// 200 windows' length in the series the estimate scatters by about 7 %, and three times that is allowed.
    #[test]
    fn autocorrelation_is_seen() {
        for correlation in [0.0, 0.8] {
            let problem = line(correlation);
            let fit = solve(&problem, &[0.1, 0.1], &Options::default()).unwrap();
            let halves = [0..20_000, 20_000..40_000];
            let found = CorrelatedCovariance::of(&problem, &fit, 200, &halves).unwrap().unwrap();
            for parameter in 0..2 {
                let white = fit.estimates()[parameter].standard_uncertainty().unwrap();
                let factor = found.standard_uncertainty(parameter).unwrap() / white;
                let expected = ((1.0 + correlation) / (1.0f64 - correlation)).sqrt();
                assert!((factor / expected - 1.0).abs() < 0.2, "φ = {correlation}: {factor} against {expected}");
            }
        }
    }

    #[test]
    fn series_shorter_than_a_window_tell_nothing() {
        let problem = line(0.0);
        let fit = solve(&problem, &[0.1, 0.1], &Options::default()).unwrap();
        assert_eq!(CorrelatedCovariance::of(&problem, &fit, 50, &[0..40, 40..80]).unwrap(), None);
        assert_eq!(CorrelatedCovariance::of(&problem, &fit, 0, &[0..40, 40..80]).unwrap(), None);
    }
}
