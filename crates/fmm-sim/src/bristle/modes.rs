//! The linear systems of Newton's method, taken apart into the modes of the method's matrix.

use fmm_model::Scalar;

use crate::bristle::lu::{Factors, SYSTEMS};
use crate::bristle::radau::{EIGENVALUES, STAGES, Stages};

/// The systems (λ − J) q = r for the eigenvalues λ of A⁻¹/h, one of each conjugate pair, with J the Jacobian of the
/// equations of motion.
///
/// The position follows the velocity, q_x = q_v/λ, and is eliminated:
///
/// ```text
/// (λ − J_vv − J_vx/λ) q_v − J_vz q_z = r_v,     (λ − J_zz) q_z − J_zv q_v = r_z
/// ```
pub(super) struct Modes<D> {
    /// Right-hand sides, then solutions, of each component but the position.
    pub(super) values: Vec<Stages<D>>,
    /// The Jacobian, row by row, to be filled before [`factor`](Self::factor).
    pub(super) jacobian: Vec<f64>,
    factors: Factors,
}

impl<D: Scalar> Modes<D> {
    pub(super) fn new(size: usize) -> Self {
        Self {
            values: vec![[D::from(0.0); STAGES]; size - 1],
            jacobian: vec![0.0; size * size],
            factors: Factors::default(),
        }
    }

    /// The rate (1/s) at which neighbouring motions approach each other in a component.
    pub(super) fn relaxation(&self, component: usize) -> f64 {
        -self.jacobian[component * (self.values.len() + 2)]
    }

    /// The greatest rate (1/s) at which the velocity or a state follows itself.
    pub(super) fn stiffness(&self) -> f64 {
        (1..=self.values.len()).fold(0.0, |most: f64, component| most.max(self.relaxation(component).abs()))
    }

    /// Factors the systems for a step of `length` h (s). False if one is singular.
    pub(super) fn factor(&mut self, length: f64) -> bool {
        let Self { values, jacobian, factors } = self;
        let (size, rest) = (values.len() + 1, values.len());
        let matrix = factors.matrix(rest);
        for (row, slopes) in jacobian.chunks_exact(size).skip(1).enumerate() {
            for (column, slope) in slopes[1..].iter().enumerate() {
                let (re, im) = matrix[row * rest + column].split_at_mut(SYSTEMS);
                re.fill(-slope);
                im.fill(0.0);
                if row == column {
                    for (system, (alpha, beta)) in EIGENVALUES.into_iter().enumerate() {
                        re[system] += alpha / length;
                        im[system] -= beta / length;
                    }
                }
            }
        }
        // J_vx (1/s²).
        let spring = jacobian[size];
        for (system, (alpha, beta)) in EIGENVALUES.into_iter().enumerate() {
            let by_square = spring * length / (alpha * alpha + beta * beta);
            matrix[0][system] -= alpha * by_square;
            matrix[0][SYSTEMS + system] -= beta * by_square;
        }
        factors.factor()
    }

    /// Replaces the right-hand sides in `values` by the solutions.
    pub(super) fn solve(&mut self) {
        self.factors.solve(&mut self.values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bristle::radau::{COEFFICIENTS_COLUMNS, FROM_MODES_COLUMNS, INVERSE_COLUMNS, TO_MODES_COLUMNS, product};

    /// The whole system, (A⁻¹/h ⊗ I − I ⊗ J) W = R, is put together again from a known W of which the positions follow
    /// the velocities.
    #[test]
    fn modes_solve_the_whole_system() {
        let jacobian = [[0.0, 1.0, 0.0, 0.0], [-7.0, -0.3, -50.0, 2.0], [0.0, 0.9, -30.0, 0.1], [0.0, 0.4, 1.5, -8.0]];
        let length = 0.07;
        let mut known: [Stages<f64>; 4] =
            std::array::from_fn(|c| std::array::from_fn(|i| (c + 1) as f64 / (i as f64 + 1.5) - 0.3));
        known[0] = product(&COEFFICIENTS_COLUMNS, &known[1]).map(|x| x * length);
        let mut modes = Modes::<f64>::new(4);
        modes.jacobian.copy_from_slice(&jacobian.concat());
        assert!(modes.factor(length));
        assert_eq!([1, 2, 3].map(|component| modes.relaxation(component)), [0.3, 30.0, 8.0]);
        assert_eq!(modes.stiffness(), 30.0);
        for (component, row) in jacobian.iter().enumerate() {
            let slopes = product(&INVERSE_COLUMNS, &known[component]);
            let right: Stages<f64> = std::array::from_fn(|stage| {
                let coupled: f64 = row.iter().zip(&known).map(|(entry, known)| entry * known[stage]).sum();
                slopes[stage] / length - coupled
            });
            if component == 0 {
                assert!(right.iter().all(|right| right.abs() < 1e-12), "{right:?}");
            } else {
                modes.values[component - 1] = product(&TO_MODES_COLUMNS, &right);
            }
        }
        modes.solve();
        for (values, known) in modes.values.iter().zip(&known[1..]) {
            for (got, expected) in product(&FROM_MODES_COLUMNS, values).iter().zip(known) {
                // T has a condition of about 1e4.
                assert!((got - expected).abs() < 1e-11, "{got} instead of {expected}");
            }
        }
    }
}
