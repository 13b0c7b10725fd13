//! Linear fits of a few coefficients, whose normal equations are solved here: the solver of `fmm-fit` stands above this
//! crate, and an algebra crate would be nine more to build for so small a matrix.

/// A linear fit of weighted least squares.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LeastSquares<const P: usize> {
    pub(crate) coefficients: [f64; P],
    /// Diagonal of the inverse of the normal equations.
    pub(crate) inverse: [f64; P],
    /// Weighted sum of the squares of the residuals.
    pub(crate) residual: f64,
    /// Number of points less that of coefficients.
    pub(crate) freedom: f64,
}

impl<const P: usize> LeastSquares<P> {
    /// The fit of points, each its weight, its value and the functions there; `None` if they do not determine it.
    pub(crate) fn of(points: &[(f64, f64, [f64; P])]) -> Option<Self> {
        let freedom = points.len().checked_sub(P)? as f64;
        // The normal equations with the right hand side and a unit matrix behind, reduced by Gauss and Jordan.
        let mut left = [[0.0; P]; P];
        let mut right = [0.0; P];
        let mut inverse = [[0.0; P]; P];
        for (weight, value, functions) in points {
            for i in 0..P {
                for j in 0..P {
                    left[i][j] += weight * functions[i] * functions[j];
                }
                right[i] += weight * functions[i] * value;
            }
        }
        let largest: [f64; P] = std::array::from_fn(|i| left[i][i]);
        for (i, row) in inverse.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        for i in 0..P {
            let pivot = left[i][i];
            // Positive definite: no exchange of rows is needed, and what remains of a diagonal shows dependence.
            if !(pivot > 1e-12 * largest[i]) {
                return None;
            }
            for j in 0..P {
                left[i][j] /= pivot;
                inverse[i][j] /= pivot;
            }
            right[i] /= pivot;
            for other in (0..P).filter(|other| *other != i) {
                let factor = left[other][i];
                for j in 0..P {
                    left[other][j] -= factor * left[i][j];
                    inverse[other][j] -= factor * inverse[i][j];
                }
                right[other] -= factor * right[i];
            }
        }
        let inverse = std::array::from_fn(|i| inverse[i][i]);
        let mut fit = Self { coefficients: right, inverse, residual: 0.0, freedom };
        fit.residual = points.iter().map(|(weight, value, f)| weight * (value - fit.at(f)).powi(2)).sum();
        Some(fit)
    }

    /// The fitted value where the functions are these.
    pub(crate) fn at(&self, functions: &[f64; P]) -> f64 {
        functions.iter().zip(&self.coefficients).map(|(f, c)| f * c).sum()
    }

    /// Standard deviation of a coefficient, by the residuals.
    pub(crate) fn scatter(&self, i: usize) -> f64 {
        (self.inverse[i] * self.residual / self.freedom).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_its_coefficients_and_scatter() {
        // y = 2 + 3 t ± 0.5 at t = 0, 1, 2, 3.
        let points: Vec<_> = (0..4)
            .map(|i| (2.0, 2.0 + 3.0 * f64::from(i) + if i == 1 || i == 2 { 0.5 } else { -0.5 }, [1.0, f64::from(i)]))
            .collect();
        let fit = LeastSquares::of(&points).unwrap();
        assert!((fit.coefficients[0] - 2.0).abs() < 1e-12 && (fit.coefficients[1] - 3.0).abs() < 1e-12);
        // Σ r² = 1 with a weight of 2; s² = 1/2, Σ (t − 1.5)² = 5.
        assert!((fit.residual - 2.0).abs() < 1e-12 && (fit.scatter(1) - 0.1f64.sqrt()).abs() < 1e-12);
        // Two points determine a line, without a scatter.
        let exact = LeastSquares::of(&points[..2]).unwrap();
        assert_eq!((exact.coefficients, exact.residual, exact.freedom), ([1.5, 4.0], 0.0, 0.0));
        assert_eq!(LeastSquares::of(&points[..1]), None);
        assert_eq!(LeastSquares::of(&[(1.0, 1.0, [1.0, 1.0]); 5]), None);
    }
}
