//! Least-squares complex frequency method: from responses to the denominators of all orders.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use fmm_record::Complex64;
use nalgebra::{Cholesky, DMatrix, Schur};

use super::band::Band;
use super::table::Table;
use crate::error::FrfError;

/// Share of the unit circle that the lines cover. Origin: chosen; the gap lets a polynomial join the two ends of the
/// band, and as it is small, powers of z remain far from dependent.
const COVERED: f64 = 0.75;
/// Shares of the mean diagonal added to it, one after the other, until the matrix is definite: without noise an order
/// above that of the structure makes it singular.
const RIDGES: [f64; 4] = [1e-14, 1e-12, 1e-10, 1e-8];
/// Steps of the iteration for eigenvalues at most, for each of them. Origin: that of LAPACK (dlahqr).
const STEPS: usize = 30;

/// Denominators of the orders 1 to N of a right matrix fraction, from one factorisation.
///
/// ```text
/// H(s) = B(z) A(z)⁻¹,   A = Σ A_k zᵏ,   z = exp(−(s − s_c) T),   A_n = 1                              (1)
/// ```
///
/// s_c is the middle of the band and T makes it cover three quarters of the unit circle, so that coefficients are
/// complex, any band is as good as one from zero on, and each pole of the band is one zero of A. The sum of
/// |B − H A|² over lines and responses is least; B, of order N, is eliminated response by response. What is left is a
/// Hermitian matrix of the coefficients of A alone, and the leading part of its Cholesky factor belongs to each
/// lower order, so that an order costs one triangular solution.
///
/// With the highest coefficient held at 1 and z falling with s, poles that only fit noise come to lie inside the unit
/// circle, where a structure would gain energy, and those of a structure outside.
///
/// # References
/// P. Guillaume et al., "A poly-reference implementation of the least-squares complex frequency-domain estimator",
/// Proc. IMAC 21 (2003); B. Cauberghe et al., "The influence of the parameter constraint on the stability of the poles
/// and the discrimination capability of the stabilisation diagrams", Mechanical Systems and Signal Processing 19 (2005)
/// 989.
pub(super) struct Denominators {
    /// L of the Cholesky factorisation.
    factor: DMatrix<Complex64>,
    references: usize,
    order: usize,
    centre: Complex64,
    period: f64,
}

impl Denominators {
    /// Of the `lines` of the responses in `table`, up to `order`.
    pub(super) fn of(band: &Band, lines: Range<usize>, table: &Table, order: usize) -> Result<Self, FrfError> {
        let references = table[0].len();
        let size = order + 1;
        let frequencies = &band.frequencies[lines.clone()];
        let (low, high) = (frequencies[0], frequencies[frequencies.len() - 1]);
        let period = TAU * COVERED / (TAU * (high - low));
        let middle = 0.5 * (low + high);
        let powers = Powers::new(frequencies.iter().map(|frequency| -TAU * (frequency - middle) * period));
        // R, of the numerator alone; it is that of all responses.
        let lags = powers.sums(order, |_| Complex64::ONE);
        let numerator = DMatrix::<Complex64>::from_fn(size, size, |j, k| lags[order + k - j]);
        let numerator = definite(numerator)?;
        let mut normal = DMatrix::<Complex64>::zeros(size * references, size * references);
        for row in table {
            let values = |reference: usize| &band.channels[row[reference]].values[lines.clone()];
            let mut mixed = DMatrix::<Complex64>::zeros(size, size * references);
            for one in 0..references {
                let lags = powers.sums(order, |line| -values(one)[line]);
                for k in 0..size {
                    for j in 0..size {
                        mixed[(j, k * references + one)] = lags[order + k - j];
                    }
                }
                for other in 0..references {
                    let lags = powers.sums(order, |line| values(one)[line].conj() * values(other)[line]);
                    for k in 0..size {
                        for j in 0..size {
                            normal[(j * references + one, k * references + other)] += lags[order + k - j];
                        }
                    }
                }
            }
            numerator.solve_lower_triangular_mut(&mut mixed);
            normal -= mixed.ad_mul(&mixed);
        }
        let centre = Complex64::new(band.decay_rate, TAU * middle);
        Ok(Self { factor: definite(normal)?, references, order, centre, period })
    }

    /// The highest order.
    pub(super) fn order(&self) -> usize {
        self.order
    }

    /// Poles (rad/s) of the denominator of `order`, of those that are finite.
    pub(super) fn poles(&self, order: usize) -> Vec<Complex64> {
        let (size, references) = (order * self.references, self.references);
        // M₁₁ X = −M₁₂ with M₁₁ = L₁₁L₁₁ᴴ and M₁₂ = L₁₁L₂₁ᴴ.
        let mut coefficients = self.factor.view((size, 0), (references, size)).adjoint();
        self.factor.view((0, 0), (size, size)).ad_solve_lower_triangular_mut(&mut coefficients);
        // The companion of zⁿ + A_{n−1} zⁿ⁻¹ + … + A₀; the signs of X and of the companion cancel.
        let companion = DMatrix::<Complex64>::from_fn(size, size, |row, column| {
            if row < references {
                let block = order - 1 - column / references;
                coefficients[(block * references + row, column % references)]
            } else if row == column + references {
                Complex64::ONE
            } else {
                Complex64::ZERO
            }
        });
        let zeros = eigenvalues(companion);
        let pole = |z: &Complex64| {
            let angle = z.arg();
            // The gap between the ends of the band is no place for a pole.
            (z.is_finite() && angle.abs() <= PI * COVERED).then(|| self.centre - z.ln() / self.period)
        };
        zeros.iter().filter_map(pole).filter(|pole| pole.is_finite()).collect()
    }
}

fn eigenvalues(matrix: DMatrix<Complex64>) -> Vec<Complex64> {
    // An iteration that does not end leaves the order without poles.
    let most = STEPS * matrix.nrows();
    let schur = Schur::try_new(matrix, f64::EPSILON, most);
    schur.and_then(|schur| schur.eigenvalues()).map_or_else(Vec::new, |zeros| zeros.iter().copied().collect())
}

/// The Cholesky factor of a matrix that is definite but for rounding.
fn definite(matrix: DMatrix<Complex64>) -> Result<DMatrix<Complex64>, FrfError> {
    let size = matrix.nrows();
    let mean = (0..size).map(|i| matrix[(i, i)].re).sum::<f64>() / size as f64;
    let mut matrix = matrix;
    for ridge in RIDGES {
        for i in 0..size {
            matrix[(i, i)] += ridge * mean;
        }
        // nalgebra takes the complex root of a pivot that is negative.
        let factor = matrix.clone().cholesky().map(Cholesky::unpack);
        if let Some(factor) = factor.filter(|lower| lower.diagonal().iter().all(|pivot| pivot.re > pivot.im.abs())) {
            return Ok(factor);
        }
    }
    let what = "the lines do not determine polynomials of this order; take a lower order or a wider band";
    Err(FrfError::NoFit { what: what.into() })
}

/// z of each line.
struct Powers(Vec<Complex64>);

impl Powers {
    fn new(angles: impl Iterator<Item = f64>) -> Self {
        Self(angles.map(|angle| Complex64::from_polar(1.0, angle)).collect())
    }

    /// Σ v zᵈ over the lines with the values `v`, for d from −`order` to `order`.
    fn sums(&self, order: usize, v: impl Fn(usize) -> Complex64) -> Vec<Complex64> {
        let mut sums = vec![Complex64::ZERO; 2 * order + 1];
        for (line, z) in self.0.iter().enumerate() {
            let v = v(line);
            sums[order] += v;
            let (mut forth, mut back) = (v, v);
            for d in 1..=order {
                forth *= z;
                back *= z.conj();
                sums[order + d] += forth;
                sums[order - d] += back;
            }
        }
        sums
    }
}
