//! Prior knowledge of quantities, as further residuals of a fit.

use crate::finding::Source;
use crate::quantities::rows::{Knowledge, Row};

/// Quantities that are known before the records are looked at, with their covariance V.
///
/// ```text
/// r = σ L⁻¹ (x − x₀),   V = L Lᵀ
/// ```
///
/// These are the residuals that the knowledge adds to those of records with noise σ: generalised least squares.
#[derive(Debug, Clone, Default)]
pub(crate) struct Prior {
    /// Rows of the table, in their order.
    pub(crate) indices: Vec<usize>,
    /// x₀.
    means: Vec<f64>,
    pub(crate) sources: Vec<Source>,
    /// V, row by row.
    pub(crate) covariance: Vec<f64>,
    /// L⁻¹, row by row.
    whitening: Vec<f64>,
}

impl Prior {
    /// Knowledge in a table's `rows`, of which two have the covariance `shared`.
    pub(crate) fn of(rows: &[Row], shared: impl Fn(usize, usize) -> f64) -> Self {
        let mut prior = Self::default();
        let mut deviations = Vec::new();
        for (index, row) in rows.iter().enumerate() {
            let Knowledge::Prior { value, uncertainty, source } = row.knowledge else { continue };
            prior.indices.push(index);
            prior.means.push(value);
            prior.sources.push(source);
            deviations.push(uncertainty);
        }
        let count = prior.indices.len();
        let element = |i: usize, j: usize| {
            if i == j { deviations[i] * deviations[i] } else { shared(prior.indices[i], prior.indices[j]) }
        };
        prior.covariance = (0..count * count).map(|at| element(at / count, at % count)).collect();
        prior.whitening = whitening(&prior.covariance, count);
        prior
    }

    /// Number of residuals, one a quantity.
    pub(crate) fn len(&self) -> usize {
        self.indices.len()
    }

    /// Index, source and standard uncertainty of each quantity.
    pub(crate) fn declared(&self) -> impl Iterator<Item = (usize, Source, f64)> {
        let count = self.len();
        (0..count).map(move |at| (self.indices[at], self.sources[at], self.covariance[at * (count + 1)].sqrt()))
    }

    /// V⁻¹, row by row.
    pub(crate) fn precision(&self) -> Vec<f64> {
        let count = self.len();
        let element = |i: usize, j: usize| -> f64 {
            (0..count).map(|k| self.whitening[k * count + i] * self.whitening[k * count + j]).sum()
        };
        (0..count * count).map(|at| element(at / count, at % count)).collect()
    }

    /// Distance of each of `values` from what is known, in standard uncertainties.
    pub(crate) fn tensions<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + 'a {
        let count = self.len();
        self.indices.iter().enumerate().map(move |(at, index)| {
            (*index, (values[*index] - self.means[at]) / self.covariance[at * (count + 1)].sqrt())
        })
    }

    /// Writes the residuals at `values`, for records with noise of standard deviation `noise`.
    pub(crate) fn write_residuals(&self, values: &[f64], noise: f64, residuals: &mut [f64]) {
        let rows = self.whitening.chunks(self.len().max(1));
        for (residual, row) in residuals.iter_mut().zip(rows) {
            let known = self.indices.iter().zip(&self.means);
            *residual =
                noise * row.iter().zip(known).map(|(w, (index, mean))| w * (values[*index] - mean)).sum::<f64>();
        }
    }

    /// Writes their derivatives, column by column.
    pub(crate) fn write_jacobian(&self, noise: f64, jacobian: &mut [f64]) {
        let count = self.len();
        for (at, element) in jacobian.iter_mut().enumerate() {
            *element = noise * self.whitening[at % count * count + at / count];
        }
    }
}

/// L⁻¹ of V = L Lᵀ, row by row, by elimination of each row from those below it; rows of a singular V are left out as
/// zeros.
fn whitening(covariance: &[f64], count: usize) -> Vec<f64> {
    let mut inverse = vec![0.0; count * count];
    for i in 0..count {
        // The part of quantity i that those before it do not explain, and its variance.
        let mut row = vec![0.0; count];
        row[i] = 1.0;
        for j in 0..i {
            let of_j = &inverse[j * count..(j + 1) * count];
            let shared: f64 = (0..=j).map(|k| of_j[k] * covariance[i * count + k]).sum();
            (0..=j).for_each(|k| row[k] -= shared * of_j[k]);
        }
        let explained = |k: usize| (0..=i).map(|l| row[l] * covariance[k * count + l]).sum::<f64>();
        let variance: f64 = (0..=i).map(|k| row[k] * explained(k)).sum();
        let scale = if variance > 0.0 { variance.sqrt().recip() } else { 0.0 };
        (0..=i).for_each(|k| inverse[i * count + k] = scale * row[k]);
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantities::rows::Place;

    fn known(value: f64, uncertainty: f64) -> Row {
        let knowledge = Knowledge::Prior { value, uncertainty, source: Source::Mass };
        Row { place: Place::DriveGain, record: None, knowledge }
    }

    /// rᵀr = (x − x₀)ᵀ V⁻¹ (x − x₀), here of two gains with a calibration in common.
    #[test]
    fn residuals_are_those_of_generalised_least_squares() {
        let free = Row { place: Place::Offset, record: None, knowledge: Knowledge::Free };
        let rows = [known(1.0, 0.05), free, known(1.0, 0.04)];
        let shared = 0.03 * 0.03;
        let prior = Prior::of(&rows, |_, _| shared);
        assert_eq!(prior.indices, [0, 2]);
        let mut residuals = [0.0; 2];
        prior.write_residuals(&[1.02, 7.0, 0.95], 3.0, &mut residuals);
        let (a, b, c) = (0.05f64.powi(2), 0.04f64.powi(2), shared);
        let (x, y) = (0.02f64, -0.05f64);
        let expected = 9.0 * (b * x * x - 2.0 * c * x * y + a * y * y) / (a * b - c * c);
        let square = residuals[0].powi(2) + residuals[1].powi(2);
        assert!((square / expected - 1.0).abs() < 1e-12, "{square} in place of {expected}");
        let mut jacobian = [0.0; 4];
        prior.write_jacobian(3.0, &mut jacobian);
        let by_columns = [jacobian[0] * x + jacobian[2] * y, jacobian[1] * x + jacobian[3] * y];
        assert!((by_columns[0] - residuals[0]).abs() < 1e-12 && (by_columns[1] - residuals[1]).abs() < 1e-12);
        let tensions: Vec<(usize, f64)> = prior.tensions(&[1.02, 7.0, 0.95]).collect();
        assert!((tensions[0].1 - 0.4).abs() < 1e-12 && (tensions[1].1 + 1.25).abs() < 1e-12);
    }
}
