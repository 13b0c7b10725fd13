//! The linear systems of Newton's method, taken apart into the modes of the method's matrix.

use fmm_model::Scalar;

use super::lu::Factors;
use super::radau::{COMPLEX, PAIRS, REAL, STAGES, Stages};

/// The systems (λ − J) q = r for all eigenvalues λ of A⁻¹/h, with J the Jacobian of the equations of motion.
///
/// The position follows the velocity, λ q_x − q_v = r_x, and is eliminated:
///
/// ```text
/// (λ − J_vv − J_vx/λ) q_v − J_vz q_z = r_v + J_vx r_x/λ
/// ```
pub(super) struct Modes<D> {
    /// Right-hand sides, then solutions: for each component those of the real eigenvalue, and in pairs q₁ and q₂ of q₁ − iq₂.
    pub(super) values: Vec<Stages<D>>,
    jacobian: Vec<f64>,
    length: f64,
    real: Factors,
    pairs: [Factors; PAIRS],
    right: Vec<D>,
}

impl<D: Scalar> Modes<D> {
    pub(super) fn new(size: usize) -> Self {
        let zero = D::from(0.0);
        Self {
            values: vec![[zero; STAGES]; size],
            jacobian: vec![0.0; size * size],
            length: 0.0,
            real: Factors::default(),
            pairs: std::array::from_fn(|_| Factors::default()),
            right: vec![zero; 2 * (size - 1)],
        }
    }

    /// The Jacobian, row by row, to be filled before [`factor`](Self::factor).
    pub(super) fn jacobian_mut(&mut self) -> &mut [f64] {
        &mut self.jacobian
    }

    /// The greatest rate (1/s) at which the velocity or a state follows itself.
    pub(super) fn stiffness(&self) -> f64 {
        let size = self.values.len();
        (1..size).fold(0.0, |most: f64, i| most.max(self.jacobian[i * size + i].abs()))
    }

    /// J_vx (1/s²).
    fn spring(&self) -> f64 {
        self.jacobian[self.values.len()]
    }

    /// Factors the systems for a step of `length` h (s). False if one is singular.
    pub(super) fn factor(&mut self, length: f64) -> bool {
        self.length = length;
        let spring = self.spring();
        let Self { values, jacobian, real, pairs, .. } = self;
        let (size, rest) = (values.len(), values.len() - 1);
        let fill = |matrix: &mut [f64], width: usize, offset: usize, alpha: f64, spring: f64| {
            for (row, slopes) in jacobian.chunks_exact(size).skip(1).enumerate() {
                let start = (row + offset) * width + offset;
                for (entry, slope) in matrix[start..start + rest].iter_mut().zip(&slopes[1..]) {
                    *entry = -slope;
                }
                matrix[start + row] += alpha;
            }
            matrix[offset * width + offset] -= spring;
        };
        let gamma = REAL / length;
        fill(real.matrix(rest), rest, 0, gamma, spring / gamma);
        let mut regular = real.factor();
        for (factors, (alpha, beta)) in pairs.iter_mut().zip(COMPLEX) {
            // Real and imaginary parts one below the other.
            let (alpha, beta) = (alpha / length, beta / length);
            let square = alpha * alpha + beta * beta;
            let matrix = factors.matrix(2 * rest);
            matrix.fill(0.0);
            fill(matrix, 2 * rest, 0, alpha, spring * alpha / square);
            fill(matrix, 2 * rest, rest, alpha, spring * alpha / square);
            for row in 0..rest {
                matrix[row * 2 * rest + rest + row] = beta;
                matrix[(rest + row) * 2 * rest + row] = -beta;
            }
            matrix[rest] += spring * beta / square;
            matrix[rest * 2 * rest] -= spring * beta / square;
            regular &= factors.factor();
        }
        regular
    }

    /// Replaces the right-hand sides in `values` by the solutions.
    pub(super) fn solve(&mut self) {
        let spring = self.spring();
        let Self { values, length, real, pairs, right, .. } = self;
        let Some((positions, others)) = values.split_first_mut() else { return };
        let rest = others.len();
        let inverse = *length / REAL;
        for (right, modes) in right.iter_mut().zip(&*others) {
            *right = modes[0];
        }
        right[0] += positions[0] * (spring * inverse);
        real.solve(&mut right[..rest]);
        positions[0] = (positions[0] + right[0]) * inverse;
        for (modes, right) in others.iter_mut().zip(&*right) {
            modes[0] = *right;
        }
        for (pair, (factors, (alpha, beta))) in pairs.iter().zip(COMPLEX).enumerate() {
            let (one, two) = (1 + 2 * pair, 2 + 2 * pair);
            // 1/λ = (α − iβ) h/(α² + β²), applied to q₁ − iq₂.
            let square = alpha * alpha + beta * beta;
            let (alpha, beta) = (alpha * *length / square, beta * *length / square);
            let divide = |first: D, second: D| (first * alpha - second * beta, first * beta + second * alpha);
            for (index, modes) in others.iter().enumerate() {
                right[index] = modes[one];
                right[rest + index] = modes[two];
            }
            let (first, second) = divide(positions[one], positions[two]);
            right[0] += first * spring;
            right[rest] += second * spring;
            factors.solve(right);
            (positions[one], positions[two]) = divide(positions[one] + right[0], positions[two] + right[rest]);
            for (index, modes) in others.iter_mut().enumerate() {
                modes[one] = right[index];
                modes[two] = right[rest + index];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::radau::{FROM_MODES_COLUMNS, INVERSE_COLUMNS, TO_MODES_COLUMNS, product};
    use super::*;

    /// The whole system, (A⁻¹/h ⊗ I − I ⊗ J) W = R, is put together again from a known W.
    #[test]
    fn modes_solve_the_whole_system() {
        let jacobian = [[0.0, 1.0, 0.0, 0.0], [-7.0, -0.3, -50.0, 2.0], [0.0, 0.9, -30.0, 0.1], [0.0, 0.4, 1.5, -8.0]];
        let length = 0.07;
        let known: Vec<Stages<f64>> =
            (0..4).map(|c| std::array::from_fn(|i| f64::from(c + 1) / (i as f64 + 1.5) - 0.3)).collect();
        let mut modes = Modes::<f64>::new(4);
        modes.jacobian_mut().copy_from_slice(&jacobian.concat());
        assert!(modes.factor(length));
        for (component, row) in jacobian.iter().enumerate() {
            let slopes = product(&INVERSE_COLUMNS, &known[component]);
            let right = std::array::from_fn(|stage| {
                let coupled: f64 = row.iter().zip(&known).map(|(entry, known)| entry * known[stage]).sum();
                slopes[stage] / length - coupled
            });
            modes.values[component] = product(&TO_MODES_COLUMNS, &right);
        }
        modes.solve();
        for (values, known) in modes.values.iter().zip(&known) {
            for (got, expected) in product(&FROM_MODES_COLUMNS, values).iter().zip(known) {
                // T has a condition of about 1e4.
                assert!((got - expected).abs() < 1e-11, "{got} instead of {expected}");
            }
        }
    }
}
