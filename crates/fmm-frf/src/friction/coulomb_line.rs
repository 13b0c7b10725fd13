//! Friction out of the growth of receptance peaks with the impulse.

use std::f64::consts::PI;
use std::fmt;

use fmm_fit::{LinearRegression, Weighting};
use fmm_model::{Estimated, ModelError};

use crate::error::FrfError;

/// The straight line of receptance peaks over impulses, and the friction force of its slope.
///
/// ```text
/// |H|_peak = b + s J,   F = π/(8 m ω₀ s)                                                               (1)
/// ```
///
/// By [the closed form](crate::SingleDegreeOfFreedom::peak_after_impact) dry friction alone makes b zero.
/// An intercept that is not, or points that are not on a line, tell of something else: viscous damping bends the line
/// down ([`friction_after_impact`](crate::SingleDegreeOfFreedom::friction_after_impact) takes it out
/// of each impact), friction that depends on velocity bends it either way.
///
/// The points are weighed equally and the impulses taken as exact.
///
/// ```
/// use fmm_frf::CoulombLine;
///
/// // The three levels of the thesis' chapter 8 without viscous damping, simulated with F = 0.7537 N.
/// let line = CoulombLine::fit(&[0.98, 1.42, 1.64], &[3.5695e-3, 5.1629e-3, 5.9617e-3], 10.391, 13.810_94)?;
/// assert!((line.friction_force.value / 0.7537 - 1.0).abs() < 0.003);
/// assert!(line.r_squared > 0.999_999);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CoulombLine {
    /// s, slope (m/N per N s).
    pub slope: Estimated,
    /// b, peak (m/N) at zero impulse.
    pub intercept: Estimated,
    /// F, kinetic friction force (N). Its uncertainty is that of the slope alone.
    pub friction_force: Estimated,
    /// R², share of the variance of the peaks that the line explains.
    pub r_squared: f64,
}

impl CoulombLine {
    /// The line through the `peaks` (m/N) of impacts with these `impulses` (N s); at least three, not all of one
    /// impulse.
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] for different numbers of impulses and peaks, [`FrfError::TooFew`] for fewer than three,
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any value that is not positive, and for a slope
    /// that is not: peaks of friction grow. [`FrfError::NoFit`] for impulses that are all the same.
    pub fn fit(impulses: &[f64], peaks: &[f64], mass: f64, natural_angular_frequency: f64) -> Result<Self, FrfError> {
        if impulses.len() != peaks.len() {
            let (impulses, peaks) = (impulses.len(), peaks.len());
            let what = "there must be one peak for each impulse";
            return Err(FrfError::mismatch(format!("{what}, but there are {impulses} impulses and {peaks} peaks")));
        }
        if impulses.len() < 3 {
            return Err(FrfError::too_few_points(3, impulses.len()));
        }
        let count = impulses.len() as f64;
        let mut means = [0.0; 2];
        for (&impulse, &peak) in impulses.iter().zip(peaks) {
            means[0] += ModelError::require_positive("impulse", impulse, "N s")? / count;
            means[1] += ModelError::require_positive("peak receptance", peak, "m/N")? / count;
        }
        // Both relative to their means, so that any unit will do.
        let relative = |values: &[f64], mean: f64| values.iter().map(|value| value / mean - 1.0).collect::<Vec<_>>();
        let columns: [(&str, &[f64]); 2] =
            [("level", &vec![1.0; impulses.len()]), ("steepness", &relative(impulses, means[0]))];
        let undetermined = || FrfError::undetermined("line of peaks over impulses", impulses.len());
        let line = LinearRegression::fit(&columns, &relative(peaks, means[1]), Weighting::Equal);
        let line = line.ok().filter(|line| line.null_directions().is_empty()).ok_or_else(undetermined)?;
        let steepness = line.coefficients()[1];
        let slope = steepness * means[1] / means[0];
        ModelError::require_positive("slope of the peaks over the impulses", slope, "m/(N² s)")?;
        let relative = line.standard_uncertainty(1).ok_or_else(undetermined)? / steepness;
        let intercept = line.predict(&[1.0, -1.0]).ok_or_else(undetermined)?;
        ModelError::require_positive("mass", mass, "kg")?;
        ModelError::require_positive("natural angular frequency", natural_angular_frequency, "rad/s")?;
        let friction_force = PI / (8.0 * mass * natural_angular_frequency * slope);
        ModelError::require_positive("friction force", friction_force, "N")?;
        Ok(Self {
            slope: Estimated::new(slope, slope * relative),
            intercept: Estimated::new(
                means[1] * (1.0 + intercept.value()),
                means[1] * intercept.standard_uncertainty(),
            ),
            friction_force: Estimated::new(friction_force, friction_force * relative),
            r_squared: line.r_squared().ok_or_else(undetermined)?,
        })
    }
}

impl fmt::Display for CoulombLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "|H| = {} m/N + {} m/(N² s) · J, R² = {:.6}; F = {} N",
            self.intercept, self.slope, self.r_squared, self.friction_force
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Peaks 2, 4, 5 over impulses 1, 2, 3: slope 3/2, intercept 2/3, residual sum 1/6, R² = 1 − (1/6)/(14/3) = 27/28.
    #[test]
    fn a_line_by_hand() {
        let line = CoulombLine::fit(&[1.0, 2.0, 3.0], &[2.0, 4.0, 5.0], 1.0, 1.0).unwrap();
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-14, "{found}, not {expected}");
        near(line.slope.value, 1.5);
        near(line.intercept.value, 2.0 / 3.0);
        near(line.r_squared, 27.0 / 28.0);
        // s² = 1/6 with one degree of freedom; var(slope) = s²/2, var(intercept) = s² Σx²/(n 2) = 7/18.
        near(line.slope.uncertainty, (1.0f64 / 12.0).sqrt());
        near(line.intercept.uncertainty, (7.0f64 / 18.0).sqrt());
        near(line.friction_force.value, PI / 12.0);
        near(line.friction_force.uncertainty, PI / 12.0 * (1.0f64 / 12.0).sqrt() / 1.5);
    }

    #[test]
    fn impossible_lines_are_refused() {
        assert!(matches!(CoulombLine::fit(&[1.0], &[], 1.0, 1.0), Err(FrfError::Mismatch { .. })));
        assert!(matches!(CoulombLine::fit(&[1.0; 2], &[1.0; 2], 1.0, 1.0), Err(FrfError::TooFew { .. })));
        assert!(matches!(CoulombLine::fit(&[2.0; 3], &[1.0; 3], 1.0, 1.0), Err(FrfError::NoFit { .. })));
        let falling = CoulombLine::fit(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0], 1.0, 1.0);
        assert!(matches!(falling, Err(FrfError::OutOfRange(ModelError::NotPositive { .. }))), "{falling:?}");
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(CoulombLine::fit(&[1.0, 2.0, bad], &[1.0, 2.0, 3.0], 1.0, 1.0).is_err());
            assert!(CoulombLine::fit(&[1.0, 2.0, 3.0], &[1.0, 2.0, bad], 1.0, 1.0).is_err());
            let of_machine = |mass, omega| CoulombLine::fit(&[1.0, 2.0, 3.0], &[2.0, 4.0, 5.0], mass, omega);
            assert!(of_machine(bad, 1.0).is_err() && of_machine(1.0, bad).is_err());
        }
    }
}
