//! Covariance of the estimates when the residuals are not independent of each other.

use std::ops::Range;

use crate::algebra::definite::{self, add_square, factor, inverse};
use crate::problem::block::Structure;
use crate::problem::residuals::{Derivatives, EvaluationError, Residuals};
use crate::result::fit::Fit;

/// Covariance of the estimates of a fit whose residuals are correlated with their neighbours.
///
/// ```text
/// V = n/(b W) Σ_w m_w m_wᵀ,     m_w = (JᵀJ − Σ_{i ∈ w} Jᵢ Jᵢᵀ)⁻¹ Σ_{i ∈ w} Jᵢ rᵢ     for W windows w of b of the n residuals
/// ```
///
/// m_w is how far the estimates move when the window is left out: the jackknife of overlapping windows. With the
/// inverse of the whole JᵀJ it would be the long-run covariance of the scores Jᵢ rᵢ with the triangular weights of
/// Newey and West, which is too small, as the parameters have followed the noise where it is slowest. It needs no model
/// of the correlation and holds where the law misses something, as it takes the residuals as they are. It is too small
/// if correlations last longer than a window, and uncertain by about √(b/n), so windows should be a few correlation
/// times long and many.
///
/// # References
/// H. R. Künsch, Ann. Stat. 17 (1989) 1217, <https://doi.org/10.1214/aos/1176347265>;
/// W. K. Newey, K. D. West, Econometrica 55 (1987) 703, <https://doi.org/10.2307/1913610>;
/// M. S. Meketon, B. Schmeiser, "Overlapping batch means", Proc. Winter Simulation Conf. 1984, 226.
#[derive(Debug, Clone, PartialEq)]
pub struct CorrelatedCovariance {
    count: usize,
    degrees_of_freedom: f64,
    elements: Vec<Option<f64>>,
}

/// Number of windows that begin within the length of one, which is nearly as good as all.
const OVERLAPPING: usize = 8;

/// The sums over one window.
struct Window {
    /// Σ Jᵢ rᵢ.
    score: Vec<f64>,
    /// Σ Jᵢ Jᵢᵀ.
    information: Vec<f64>,
}

impl Window {
    fn new(order: usize) -> Self {
        Self { score: vec![0.0; order], information: vec![0.0; order * order] }
    }

    fn clear(&mut self) {
        self.score.fill(0.0);
        self.information.fill(0.0);
    }

    /// Adds a residual with its `row` of derivatives, or takes it out.
    fn add(&mut self, row: &[f64], residual: f64, sign: f64) {
        self.score.iter_mut().zip(row).for_each(|(score, a)| *score += sign * a * residual);
        add_square(&mut self.information, row, sign);
    }
}

/// Least share of what determines a direction that must be left without a window.
const LEAST_LEFT: f64 = 1e-3;

/// A fit, as far as it takes to leave windows out of it.
struct Whole {
    /// A = (JᵀJ)⁺ over the parameters that are determined.
    unit: Vec<f64>,
    /// Its inverse, with the squares of the diagonal of the factor of that; `None` if A is singular but for rounding.
    information: Option<(Vec<f64>, Vec<f64>)>,
    factored: Vec<f64>,
    moved: Vec<f64>,
}

impl Whole {
    fn new(unit: Vec<f64>, order: usize) -> Self {
        let information = inverse(&unit, order).and_then(|information| {
            let mut factored = information.clone();
            let squares = |factored: &[f64]| (0..order).map(|j| factored[j * order + j].powi(2)).collect();
            factor(&mut factored, order, |_| 0.0).then(|| (information, squares(&factored)))
        });
        Self { unit, information, factored: Vec::new(), moved: Vec::new() }
    }

    /// (A⁻¹ − M)⁻¹ Σ Jᵢ rᵢ, by which the estimates move if the window is left out; A Σ Jᵢ rᵢ for one without which not
    /// all of them were determined.
    fn moved_without(&mut self, window: &Window) -> &[f64] {
        let order = window.score.len();
        self.moved.clone_from(&window.score);
        if let Some((information, squares)) = &self.information {
            self.factored.clear();
            self.factored.extend(information.iter().zip(&window.information).map(|(all, part)| all - part));
            if factor(&mut self.factored, order, |j| LEAST_LEFT * squares[j]) {
                definite::solve(&self.factored, &mut self.moved);
                return &self.moved;
            }
        }
        for (moved, row) in self.moved.iter_mut().zip(self.unit.chunks_exact(order)) {
            *moved = row.iter().zip(&window.score).map(|(a, score)| a * score).sum();
        }
        &self.moved
    }
}

impl CorrelatedCovariance {
    /// Takes the residuals of `fit` to `problem` in windows of `span`; windows never reach from one of `series`
    /// into the next. The series are ranges of residuals, such as one per record.
    ///
    /// `None` if the problem gives no derivatives of its own, if nothing is determined, or if no series holds a window.
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
        if span == 0 || problem.derivatives() == Derivatives::None {
            return Ok(None);
        }
        problem.evaluate(fit.values(), &mut vec![0.0; rows], Some(&mut jacobian))?;
        let derivatives = structure.by_row(count);
        let covariance = |a: usize, b: usize| fit.unit_covariance(a, b);
        let determined: Vec<usize> = (0..count).filter(|&j| covariance(j, j).is_some()).collect();
        let order = determined.len();
        if order == 0 {
            return Ok(None);
        }
        // In units of the uncertainties, so that a pivot is a share.
        let scales: Vec<f64> = determined.iter().map(|&j| covariance(j, j).unwrap_or(1.0).sqrt()).collect();
        let scaled = determined.iter().zip(&scales);
        let unit: Vec<f64> = scaled
            .clone()
            .flat_map(|(&a, u_a)| scaled.clone().map(move |(&b, u_b)| covariance(a, b).unwrap_or(0.0) / (u_a * u_b)))
            .collect();
        let (mut window, mut whole) = (Window::new(order), Whole::new(unit, order));
        let mut row = vec![0.0; order];
        let mut sum = vec![0.0; order * order];
        let mut windows = 0usize;
        let mut add = |window: &mut Window, i: usize, sign: f64| {
            for (element, (&j, scale)) in row.iter_mut().zip(determined.iter().zip(&scales)) {
                *element = scale * derivatives.element(&jacobian, i, j);
            }
            window.add(&row, fit.residuals()[i], sign);
        };
        for range in series.iter().filter(|range| range.len() >= span && range.end <= rows) {
            window.clear();
            (range.start..range.start + span).for_each(|i| add(&mut window, i, 1.0));
            for end in range.start + span..=range.end {
                if (end - range.start - span).is_multiple_of(span.div_ceil(OVERLAPPING)) {
                    add_square(&mut sum, whole.moved_without(&window), 1.0);
                    windows += 1;
                }
                if end < range.end {
                    add(&mut window, end, 1.0);
                    add(&mut window, end - span, -1.0);
                }
            }
        }
        if windows == 0 {
            return Ok(None);
        }
        // Each window stands for `span` of the residuals, and the windows together for all of them.
        let beside = fit.residuals().len() as f64 / span as f64;
        let weight = beside / windows as f64;
        let mut elements = vec![None; count * count];
        for ((&i, u_i), row) in scaled.clone().zip(sum.chunks_exact(order)) {
            for ((&j, u_j), element) in scaled.clone().zip(row) {
                elements[i * count + j] = Some(u_i * u_j * weight * element);
            }
        }
        let degrees_of_freedom = 1.5 * (beside - fit.rank() as f64).max(1.0);
        Ok(Some(Self { count, degrees_of_freedom, elements }))
    }

    /// Covariance of the estimates of parameters `i` and `j`, in the product of their units; `None` where the fit has
    /// none.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        if i < self.count && j < self.count { self.elements[i * self.count + j] } else { None }
    }

    /// ν, by which the covariance is known (1): that of the variance of a mean from overlapping windows of b of n
    /// residuals, about 3/2 (n/b - p) after a fit of p parameters (Meketon and Schmeiser have n/b - 1 for a mean), at
    /// least 3/2.
    pub fn degrees_of_freedom(&self) -> f64 {
        self.degrees_of_freedom
    }

    /// Standard uncertainty of the estimate of parameter `i`, in its unit.
    pub fn standard_uncertainty(&self, i: usize) -> Option<f64> {
        self.covariance(i, i).map(f64::sqrt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::solve::solve;
    use crate::solver::options::Options;
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
        fn evaluate(
            &self,
            p: &[f64],
            residuals: &mut [f64],
            jacobian: Option<&mut [f64]>,
        ) -> Result<(), EvaluationError> {
            let scale = 1.0 / self.len() as f64;
            for (i, (r, y)) in residuals.iter_mut().zip(&self.data).enumerate() {
                *r = p[0] + p[1] * i as f64 * scale - y;
            }
            if let Some(jacobian) = jacobian {
                let (ones, times) = jacobian.split_at_mut(self.len());
                let scale = 1.0 / ones.len() as f64;
                ones.fill(1.0);
                times.iter_mut().enumerate().for_each(|(i, t)| *t = i as f64 * scale);
            }
            Ok(())
        }
        fn derivatives(&self) -> Derivatives {
            Derivatives::Free
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
            // The ends of a line move against each other: −√3/2 for its value at one end and its slope, with any noise.
            let [across, back] = [(0, 1), (1, 0)].map(|(i, j)| found.covariance(i, j).unwrap());
            let deviations: f64 = (0..2).map(|i| found.standard_uncertainty(i).unwrap()).product();
            assert!((across / back - 1.0).abs() < 1e-9, "{across} and {back}");
            assert!((across / deviations + 0.75f64.sqrt()).abs() < 0.06, "correlation {}", across / deviations);
        }
    }

    /// Windows beside each other, each left out of the fit in turn: the estimates move by what the sums say.
    #[test]
    fn windows_are_left_out() {
        let problem = Line { data: line(0.5).data[..12].to_vec(), ..line(0.0) };
        let fit = solve(&problem, &[0.1, 0.1], &Options::default()).unwrap();
        let mut jacobian = vec![0.0; 24];
        problem.evaluate(fit.values(), &mut vec![0.0; problem.len()], Some(&mut jacobian)).unwrap();
        let unit = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(a, b)| fit.unit_covariance(a, b).unwrap());
        let mut whole = Whole::new(unit.to_vec(), 2);
        for start in [0, 4, 8] {
            let mut window = Window::new(2);
            (start..start + 4).for_each(|i| window.add(&[jacobian[i], jacobian[12 + i]], fit.residuals()[i], 1.0));
            let moved = whole.moved_without(&window).to_vec();
            // The line through the others, by its normal equations.
            let (mut sums, mut right) = ([0.0; 4], [0.0; 2]);
            for i in (0..12).filter(|i| !(start..start + 4).contains(i)) {
                let (t, y) = (jacobian[12 + i], problem.data[i]);
                sums.iter_mut().zip([1.0, t, t, t * t]).for_each(|(sum, term)| *sum += term);
                right.iter_mut().zip([y, t * y]).for_each(|(sum, term)| *sum += term);
            }
            assert!(factor(&mut sums, 2, |_| 0.0));
            definite::solve(&sums, &mut right);
            for ((without, with), moved) in right.iter().zip(fit.values()).zip(moved) {
                assert!((without - with - moved).abs() < 1e-12, "{without} from {with}, not by {moved}");
            }
        }
        // Without the one window that holds everything nothing is left.
        let mut all = Window::new(2);
        (0..12).for_each(|i| all.add(&[jacobian[i], jacobian[12 + i]], fit.residuals()[i] + 1.0, 1.0));
        let moved = [0, 2].map(|row| unit[row] * all.score[0] + unit[row + 1] * all.score[1]);
        assert_eq!(whole.moved_without(&all), moved);
    }

    #[test]
    fn series_shorter_than_a_window_tell_nothing() {
        let problem = line(0.0);
        let fit = solve(&problem, &[0.1, 0.1], &Options::default()).unwrap();
        assert_eq!(CorrelatedCovariance::of(&problem, &fit, 50, &[0..40, 40..80]).unwrap(), None);
        assert_eq!(CorrelatedCovariance::of(&problem, &fit, 0, &[0..40, 40..80]).unwrap(), None);
    }
}
