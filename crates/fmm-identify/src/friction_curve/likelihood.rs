//! Likelihood of the levels: a record seen from near one curve.

use fmm_fit::{EvaluationError, Residuals};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::finding::Source;
use crate::friction_curve::levels::LEVELS;
use crate::linear_algebra::{inverse, products};
use crate::problem::Problem;
use crate::residuals::noise::{ResidualNoise, Series};

/// Residuals of a problem and their derivatives near some values.
pub(super) struct Linearised {
    /// Places of the parameters behind the columns, the levels last.
    places: Vec<usize>,
    /// Residuals of the records, and their derivatives.
    residuals: Vec<f64>,
    columns: Vec<Vec<f64>>,
    of_records: Squares,
    /// Those of prior knowledge.
    of_knowledge: Squares,
    /// (JᵀJ)⁻ of the records, row by row.
    inverse: Vec<f64>,
    /// Residuals of the records at the best curve of all, without any knowledge of curves.
    left: Vec<f64>,
}

/// JᵀJ, Jᵀr and rᵀr of residuals r and their derivatives J.
struct Squares {
    products: DMatrix<f64>,
    slopes: DVector<f64>,
    sum: f64,
}

/// Gaussian likelihood of the levels b and of all else that is fitted, n.
///
/// ```text
/// ln L(b) = ηᵀ b − ½ bᵀ Λ b
/// ```
///
/// For white residuals with variance s², Λ is JᵀJ/s²; for others JᵀJ (JᵀΣJ)⁻¹ JᵀJ, which belongs to the sandwich
/// (JᵀJ)⁻¹JᵀΣJ(JᵀJ)⁻¹. The rest n is integrated out: Λ = Λ_bb − Λ_bn Λ_nn⁻¹ Λ_nb.
pub(super) struct Likelihood {
    pub(super) precision: DMatrix<f64>,
    pub(super) information: DVector<f64>,
    /// Degrees of freedom of the noise (1).
    pub(super) freedom: f64,
    /// Variance of the residuals at the best curve.
    pub(super) variance: f64,
    /// Change of η with each declared value, for one standard uncertainty of it.
    pub(super) by_declared: Vec<(Source, DVector<f64>)>,
    rest: Cholesky<f64, Dyn>,
    mixed: DMatrix<f64>,
    slope: DVector<f64>,
}

impl Linearised {
    /// The `problem` near the values `p`, of which those from `first` on are the levels.
    pub(super) fn of(problem: &Problem<'_>, p: &[f64], first: usize) -> Result<Self, EvaluationError> {
        let levels = first..first + LEVELS;
        let is_free = |i: &usize| !levels.contains(i) && !problem.parameters()[*i].bounds().is_fixed();
        let mut places: Vec<usize> = (0..p.len()).filter(is_free).chain(levels.clone()).collect();
        let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
        let (mut residuals, mut jacobian) = (vec![0.0; problem.len()], vec![0.0; elements]);
        problem.evaluate(p, &mut residuals, Some(&mut jacobian))?;
        let measured = problem.measured();
        let mut columns = vec![vec![0.0; measured]; places.len()];
        let mut known = vec![vec![0.0; residuals.len() - measured]; places.len()];
        let (mut row, mut rest) = (0, jacobian.as_slice());
        for block in problem.blocks() {
            // Blocks of prior knowledge follow those of the records.
            let (all, start) = if row < measured { (&mut columns, row) } else { (&mut known, row - measured) };
            for parameter in block.parameters() {
                let (column, others) = rest.split_at(block.rows());
                rest = others;
                if let Some(place) = places.iter().position(|place| place == parameter) {
                    all[place][start..start + block.rows()].copy_from_slice(column);
                }
            }
            row += block.rows();
        }
        // A contact that never sticks does not show its static level.
        for place in (0..places.len() - LEVELS).rev() {
            if columns[place].iter().chain(&known[place]).all(|derivative| *derivative == 0.0) {
                places.remove(place);
                columns.remove(place);
                known.remove(place);
            }
        }
        let of_knowledge = Squares::of(&known, &residuals.split_off(measured));
        let of_records = Squares::of(&columns, &residuals);
        let inverse = inverse(&of_records.products);
        let mut left = residuals.clone();
        for (row, column) in inverse.chunks(places.len()).zip(&columns) {
            let step = dot(row, of_records.slopes.as_slice());
            left.iter_mut().zip(column).for_each(|(left, derivative)| *left -= step * derivative);
        }
        Ok(Self { places, residuals, columns, of_records, of_knowledge, inverse, left })
    }

    /// Residuals of the records.
    pub(super) fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// Sum of squares of all residuals.
    pub(super) fn sum_of_squares(&self) -> f64 {
        self.of_records.sum + self.of_knowledge.sum
    }

    /// Sum of squares of the records at the best curve of all, if residuals were linear.
    pub(super) fn least_squares(&self) -> f64 {
        dot(&self.left, &self.left)
    }

    /// Sum of squares after `step`, if residuals were linear.
    pub(super) fn predicted(&self, step: &[f64]) -> f64 {
        let step = DVector::from_column_slice(step);
        self.of_records.after(&step) + self.of_knowledge.after(&step)
    }

    /// The values `p` after `share` of `step`.
    pub(super) fn moved(&self, p: &[f64], step: &[f64], share: f64) -> Vec<f64> {
        let mut moved = p.to_vec();
        self.places.iter().zip(step).for_each(|(place, by)| moved[*place] += share * by);
        moved
    }

    /// Noise of the records as the residuals at the best curve show it; `None` if it is white.
    pub(super) fn noise(&self, problem: &Problem<'_>, p: &[f64]) -> Option<ResidualNoise> {
        let signals: Vec<Vec<f64>> =
            (0..problem.experiments().len()).map(|record| problem.signal_by(record, p, &self.residuals)).collect();
        let series: Vec<Series<'_>> = problem
            .row_ranges()
            .zip(problem.experiments())
            .zip(&signals)
            .map(|((rows, experiment), signal)| Series {
                rows,
                signal: Some(signal),
                period: experiment.record().rate() / experiment.guess.frequency(),
                columns: &self.columns,
                weights: &self.inverse,
                plateaus: experiment.stays(),
            })
            .collect();
        let noise = ResidualNoise::of(&self.left, &series);
        (!noise.is_white()).then_some(noise)
    }

    /// The likelihood near the values `p`, for this `noise` if it is not white.
    pub(super) fn likelihood(
        &self,
        problem: &Problem<'_>,
        p: &[f64],
        noise: Option<&ResidualNoise>,
    ) -> Option<Likelihood> {
        let order = self.places.len();
        let rank = (0..order).filter(|i| self.inverse[i * (order + 1)] > 0.0).count();
        let freedom = (self.residuals.len() as f64 - rank as f64).max(1.0);
        let variance = (self.least_squares() / freedom).max(problem.noise.powi(2) * LEAST_NOISE);
        // Columns of unit length.
        let squares = self.of_records.products.diagonal() + self.of_knowledge.products.diagonal();
        let length = |square: &f64| Some(square.sqrt()).filter(|length| *length > 0.0).unwrap_or(1.0);
        let scales: Vec<f64> = squares.iter().map(length).collect();
        let scaled =
            |of: &Squares| DMatrix::from_fn(order, order, |i, j| of.products[(i, j)] / (scales[i] * scales[j]));
        let slopes = |of: &Squares| DVector::from_fn(order, |i, _| of.slopes[i] / scales[i]);
        let of_records = scaled(&self.of_records);
        let of_noise = noise.and_then(|noise| {
            let products = noise.products(&self.columns);
            let mut products = DMatrix::from_fn(order, order, |i, j| products[i * order + j] / (scales[i] * scales[j]));
            let ridge = 1e-13 * products.diagonal().max();
            (0..order).for_each(|i| products[(i, i)] += ridge);
            let inflation =
                (0..order).map(|i| products[(i, i)] / (variance * of_records[(i, i)])).sum::<f64>() / order as f64;
            Some((Cholesky::new(products)?.solve(&of_records), inflation))
        });
        let (weight, inflation) = of_noise.unwrap_or_else(|| (DMatrix::identity(order, order) / variance, 1.0));
        // Weighted from the left: JᵀJ M⁻¹ of a symmetric M, here its transpose M⁻¹ JᵀJ.
        let mut precision = weight.transpose() * &of_records;
        let mut slope = -(weight.transpose() * slopes(&self.of_records));
        let each = problem.noise.powi(-2);
        if each.is_finite() {
            precision += scaled(&self.of_knowledge) * each;
            slope -= slopes(&self.of_knowledge) * each;
        }
        let precision = DMatrix::from_fn(order, order, |i, j| {
            0.5 * (precision[(i, j)] + precision[(j, i)]) * scales[i] * scales[j]
        });
        let slope = DVector::from_fn(order, |i, _| slope[i] * scales[i]);
        let first = order - LEVELS;
        let rest = Cholesky::new(precision.view((0, 0), (first, first)).into_owned())?;
        let mixed = precision.view((0, first), (first, LEVELS)).into_owned();
        let rest_slope = slope.rows(0, first).into_owned();
        let own = precision.view((first, first), (LEVELS, LEVELS)).into_owned();
        let of_levels = &own - mixed.transpose() * rest.solve(&mixed);
        let of_levels = 0.5 * (&of_levels + of_levels.transpose());
        let levels = DVector::from_fn(LEVELS, |i, _| p[self.places[first + i]]);
        let information = slope.rows(first, LEVELS) - mixed.transpose() * rest.solve(&rest_slope) + &of_levels * levels;
        let freedom = (freedom / inflation.max(1.0)).max(1.5);
        let by_declared = self.by_declared(problem, &rest, &mixed).collect();
        let (precision, slope) = (of_levels, rest_slope);
        Some(Likelihood { precision, information, freedom, variance, by_declared, rest, mixed, slope })
    }

    /// ∂η/∂x₀ u of each value x₀ that is declared with u: −Λ_bn Λ_nn⁻¹ e/u, with e its place in n.
    fn by_declared<'a>(
        &'a self,
        problem: &'a Problem<'_>,
        rest: &'a Cholesky<f64, Dyn>,
        mixed: &'a DMatrix<f64>,
    ) -> impl Iterator<Item = (Source, DVector<f64>)> + 'a {
        problem.prior.declared().filter_map(move |(index, source, uncertainty)| {
            let place = self.places.iter().position(|place| *place == index).filter(|place| *place < mixed.nrows())?;
            let mut unit = DVector::zeros(mixed.nrows());
            unit[place] = uncertainty.recip();
            Some((source, -mixed.tr_mul(&rest.solve(&unit))))
        })
    }
}

impl Squares {
    fn of(columns: &[Vec<f64>], residuals: &[f64]) -> Self {
        let all: Vec<&[f64]> = columns.iter().map(Vec::as_slice).chain([residuals]).collect();
        let (order, all) = (columns.len(), products(&all));
        let slopes = all.column(order).rows(0, order).into_owned();
        Self { products: all.view((0, 0), (order, order)).into_owned(), slopes, sum: all[(order, order)] }
    }

    /// rᵀr after `step`.
    fn after(&self, step: &DVector<f64>) -> f64 {
        self.sum + 2.0 * step.dot(&self.slopes) + step.dot(&(&self.products * step))
    }
}

impl Likelihood {
    /// The change of all parameters in the order of the columns, for this change of the levels.
    pub(super) fn step(&self, of_levels: &DVector<f64>) -> Vec<f64> {
        let of_rest = self.rest.solve(&(&self.slope - &self.mixed * of_levels));
        of_rest.iter().chain(of_levels).copied().collect()
    }
}

/// Square of the least deviation of residuals over the noise of a record (1): a record without noise has the rounding
/// of its values.
const LEAST_NOISE: f64 = 1e-4;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
