//! Least squares frequency domain method: residues of known poles, and what other modes leave in the band.

use fmm_record::Complex64;
use nalgebra::DMatrix;

use super::band::{Band, Channel};

/// Unknowns of each response besides the residues: real and imaginary part of the upper and of the lower term.
const REST: usize = 4;

/// Columns of all unknowns at the lines of a response, real parts above imaginary ones, and their factorisation.
///
/// ```text
/// H(s) = sᵖ (Σ A/(s − λ) + A*/(s − λ*) + U + L/s²)                                                      (1)
/// ```
///
/// All of it is linear but for λ: for the poles given, the least squares for real and imaginary parts of A, U and L
/// are one factorisation.
pub(super) struct Basis {
    /// Q, orthonormal columns.
    orthonormal: DMatrix<f64>,
    /// R, upper triangle.
    triangle: DMatrix<f64>,
}

/// s of each line, and what depends on it alone.
pub(super) struct Lines {
    pub(super) arguments: Vec<Complex64>,
    /// sᵖ
    forms: Vec<Complex64>,
}

impl Lines {
    pub(super) fn of(band: &Band) -> Self {
        let form = i32::from(band.form.derivatives());
        let arguments: Vec<Complex64> = band.arguments().collect();
        let forms = arguments.iter().map(|s| s.powi(form)).collect();
        Self { arguments, forms }
    }

    pub(super) fn len(&self) -> usize {
        self.arguments.len()
    }

    /// Number of real unknowns of a response with so many `modes`.
    pub(super) fn unknowns(modes: usize) -> usize {
        2 * modes + REST
    }

    /// Values of the columns of all unknowns at a line, in their order: the parts of each residue, of the upper term
    /// and of the lower one.
    fn row(&self, line: usize, poles: &[Complex64]) -> impl Iterator<Item = Complex64> {
        let (s, form) = (self.arguments[line], self.forms[line]);
        let fraction = move |pole: &Complex64| {
            let (one, other) = ((s - pole).inv(), (s - pole.conj()).inv());
            [one + other, Complex64::I * (one - other)]
        };
        let lower = (s * s).inv();
        let rest = [Complex64::ONE, Complex64::I, lower, Complex64::I * lower];
        poles.iter().flat_map(fraction).chain(rest).map(move |value| form * value)
    }

    /// The value at a line that the `unknowns` give.
    pub(super) fn value(&self, line: usize, poles: &[Complex64], unknowns: &[f64]) -> Complex64 {
        self.row(line, poles).zip(unknowns).map(|(column, unknown)| column * unknown).sum()
    }

    /// The slopes of that value by −Re λ and Im λ of the mode with this pole and this residue.
    pub(super) fn slopes(&self, line: usize, pole: Complex64, residue: Complex64) -> [Complex64; 2] {
        let (s, form) = (self.arguments[line], self.forms[line]);
        let (one, other) = ((s - pole).inv(), (s - pole.conj()).inv());
        let (one, other) = (residue * one * one, residue.conj() * other * other);
        [-form * (one + other), form * Complex64::I * (one - other)]
    }
}

impl Basis {
    /// With the `weights` of the lines, 1 without any.
    pub(super) fn of(lines: &Lines, poles: &[Complex64], weights: Option<&[f64]>) -> Self {
        let count = lines.len();
        let mut columns = DMatrix::zeros(2 * count, Lines::unknowns(poles.len()));
        for line in 0..count {
            let weight = weights.map_or(1.0, |weights| weights[line]);
            for (column, value) in lines.row(line, poles).enumerate() {
                columns[(line, column)] = weight * value.re;
                columns[(count + line, column)] = weight * value.im;
            }
        }
        let (orthonormal, triangle) = columns.qr().unpack();
        Self { orthonormal, triangle }
    }

    /// True unless two columns are the same but for rounding, as they are for two equal poles.
    pub(super) fn is_determined(&self) -> bool {
        (0..self.triangle.ncols()).all(|j| {
            let length = (0..=j).map(|i| self.triangle[(i, j)].powi(2)).sum::<f64>().sqrt();
            self.triangle[(j, j)].abs() > 1e-13 * length
        })
    }

    /// Qᵀ times the columns of `right`.
    pub(super) fn project(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        // Not `tr_mul`, which goes column by column without the kernel of this product.
        self.orthonormal.transpose() * right
    }

    /// Takes out of `right` what the columns can be made of, of which `projection` is [`Basis::project`].
    pub(super) fn take_out(&self, right: &mut DMatrix<f64>, projection: &DMatrix<f64>) {
        right.gemm(-1.0, &self.orthonormal, projection, 1.0);
    }

    /// R⁻¹ times the columns of a projection: the unknowns.
    pub(super) fn solve(&self, projection: &DMatrix<f64>) -> DMatrix<f64> {
        let mut unknowns = projection.clone();
        self.triangle.solve_upper_triangular_mut(&mut unknowns);
        unknowns
    }

    /// (RᵀR)⁻¹, covariance of the unknowns for known poles and residuals of unit variance.
    pub(super) fn covariance(&self) -> DMatrix<f64> {
        let size = self.triangle.ncols();
        let inverse = self.solve(&DMatrix::identity(size, size));
        &inverse * inverse.transpose()
    }
}

/// Real parts above imaginary parts of the values of a channel, times the weights of its lines.
pub(super) fn right_side(channel: &Channel, weights: Option<&[f64]>) -> DMatrix<f64> {
    let count = channel.values.len();
    DMatrix::from_fn(2 * count, 1, |row, _| {
        let line = row % count;
        let value = channel.values[line];
        weights.map_or(1.0, |weights| weights[line]) * if row < count { value.re } else { value.im }
    })
}
