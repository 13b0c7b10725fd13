//! Prior knowledge of the pulses, as residuals of the fit.

use crate::impact::parameters::{PER_TRIAL, Parameters};

/// The errors of the impulses and the times of the pulses as what they are before the motion is looked at: about zero,
/// within their uncertainties.
///
/// ```text
/// r = σ L⁻¹ x,   V = L Lᵀ,   V = diag(u²) + u_c² 1 1ᵀ                                                     (1)
/// rᵢ = σ (xᵢ − κᵢ Σ_{j<i} xⱼ/uⱼ²) / √(uᵢ² + κᵢ),   1/κᵢ = 1/u_c² + Σ_{j<i} 1/uⱼ²                          (2)
/// ```
///
/// (1) is generalised least squares: the residuals that a set of errors x of covariance V adds to those of a velocity
/// with noise σ. The calibration of the hammer, u_c, is common to all impulses; (2) is L⁻¹ for that, each error by what
/// those before it say of the calibration. Times have nothing in common.
#[derive(Debug, Clone, Default)]
pub(crate) struct PulsePrior {
    /// Indices of the parameters, one for each residual.
    parameters: Vec<usize>,
    /// κᵢ, and the root in the denominator.
    common: Vec<f64>,
    deviations: Vec<f64>,
    /// 1/uⱼ².
    weights: Vec<f64>,
}

impl PulsePrior {
    /// Of the parameters that have one, for a `calibration` of this relative standard uncertainty (1).
    pub(crate) fn of(layout: &Parameters, calibration: f64) -> Self {
        let known = |first: usize| {
            let indices = (first..layout.all.len()).step_by(PER_TRIAL).filter(|index| layout.has_prior[*index]);
            indices.map(|index| (index, layout.uncertainties[index]))
        };
        let mut prior = Self::default();
        prior.add(known(layout.impulse_error(0)), calibration * calibration);
        prior.add(known(layout.pulse_delay(0)), 0.0);
        prior
    }

    /// Adds parameters by index and standard uncertainty, with what they have in common, of variance `shared`.
    fn add(&mut self, known: impl Iterator<Item = (usize, f64)>, shared: f64) {
        let (mut kappa, mut sum) = (shared, 0.0);
        for (index, u) in known {
            self.parameters.push(index);
            self.common.push(kappa);
            self.deviations.push(u.hypot(kappa.sqrt()));
            self.weights.push((u * u).recip());
            sum += (u * u).recip();
            kappa = if shared > 0.0 { (shared.recip() + sum).recip() } else { 0.0 };
        }
    }

    /// Indices of the parameters on which the residuals depend, as many as there are residuals.
    pub(crate) fn parameters(&self) -> &[usize] {
        &self.parameters
    }

    /// κᵢ/uⱼ² (1), by which residual `i` depends on error `j` before it.
    fn share(&self, i: usize, j: usize) -> f64 {
        // Impulses come first; a time has κ = 0.
        self.common[i] * self.weights[j]
    }

    /// The residuals at parameters `p`, in units of `scale` (m/s).
    pub(crate) fn write_residuals(&self, p: &[f64], scale: f64, residuals: &mut [f64]) {
        for (i, out) in residuals.iter_mut().enumerate() {
            let earlier: f64 = (0..i).map(|j| self.share(i, j) * p[self.parameters[j]]).sum();
            *out = scale * (p[self.parameters[i]] - earlier) / self.deviations[i];
        }
    }

    /// Their derivatives, one column for each of the parameters.
    pub(crate) fn write_jacobian(&self, scale: f64, columns: &mut [f64]) {
        let count = self.parameters.len();
        for (j, column) in columns.chunks_exact_mut(count.max(1)).enumerate() {
            for (i, out) in column.iter_mut().enumerate() {
                let derivative = match i.cmp(&j) {
                    std::cmp::Ordering::Less => 0.0,
                    std::cmp::Ordering::Equal => 1.0,
                    std::cmp::Ordering::Greater => -self.share(i, j),
                };
                *out = scale * derivative / self.deviations[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The residuals of errors of covariance V have the covariance of independent numbers.
    #[test]
    fn residuals_are_independent() {
        let (u, calibration): ([f64; 3], f64) = ([0.01, 0.002, 0.03], 0.02);
        let mut prior = PulsePrior::default();
        prior.add(u.into_iter().enumerate(), calibration * calibration);
        let mut columns = [0.0; 9];
        prior.write_jacobian(1.0, &mut columns);
        let whitening = |i: usize, k: usize| columns[3 * k + i];
        let covariance = |k: usize, l: usize| calibration.powi(2) + if k == l { u[k] * u[k] } else { 0.0 };
        for i in 0..3 {
            for j in 0..3 {
                let found: f64 =
                    (0..9).map(|n| whitening(i, n / 3) * covariance(n / 3, n % 3) * whitening(j, n % 3)).sum();
                assert!((found - f64::from(u8::from(i == j))).abs() < 1e-12, "({i}, {j}): {found}");
            }
            let p = [0.3, -0.2, 0.1];
            let mut residuals = [0.0; 3];
            prior.write_residuals(&p, 2.0, &mut residuals);
            let expected: f64 = (0..3).map(|k| 2.0 * whitening(i, k) * p[k]).sum();
            assert!((residuals[i] - expected).abs() < 1e-12);
        }
    }
}
