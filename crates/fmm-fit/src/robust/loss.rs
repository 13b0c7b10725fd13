//! Loss functions: the weight of a residual as a function of its size.

/// Cost of a residual r of scale s: `s² ρ(z)` with `z = (r/s)²` instead of r².
///
/// | loss | ρ(z) | weight ρ′(z) | at large r |
/// |---|---|---|---|
/// | `Squares` | z | 1 | grows as r² |
/// | `SoftL1` | 2 (√(1 + z) − 1) | 1/√(1 + z) | grows as \|r\| |
/// | `Huber` | z up to z = 1, 2 √z − 1 beyond | 1, 1/√z | grows as \|r\| |
/// | `Cauchy` | ln(1 + z) | 1/(1 + z) | grows as ln \|r\| |
/// | `Arctan` | arctan z | 1/(1 + z²) | at most π/2 |
/// | `Tukey` | (1 − (1 − z)³)/3 up to z = 1, 1/3 beyond | (1 − z)², 0 | at most 1/3 |
///
/// All begin as z, so that small residuals count as in least squares. `SoftL1` and `Huber` keep problems with one
/// minimum as they are; the others forget large residuals and thereby make further minima, which want a good start.
/// The first five are those of `scipy.optimize.least_squares`; `Tukey` is the biweight.
///
/// # References
/// P. J. Huber, E. M. Ronchetti, "Robust Statistics", 2nd ed., Wiley (2009), ch. 4 and 7; A. E. Beaton, J. W. Tukey,
/// Technometrics 16 (1974) 147 (biweight).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Loss {
    /// The square: least squares.
    Squares,
    /// A smooth passage from the square to the absolute value.
    SoftL1,
    /// The square up to the scale, the absolute value beyond.
    Huber,
    /// The logarithm of a Cauchy (Lorentz) distribution.
    Cauchy,
    /// The arc tangent of the square.
    Arctan,
    /// Tukey's biweight, for which residuals beyond the scale do not count at all.
    Tukey,
}

impl Loss {
    /// The scale, in standard deviations of normal residuals without outliers, at which the estimates are 95 % as
    /// efficient as those of least squares.
    ///
    /// ```text
    /// (E ψ′)²/E ψ² = 0.95,     ψ(r) = r ρ′(r²/s²)
    /// ```
    pub const fn efficient_scale(self) -> f64 {
        match self {
            Self::Squares => 1.0,
            Self::SoftL1 => 1.287_099_224,
            Self::Huber => 1.344_997_509,
            Self::Cauchy => 2.384_947_119,
            Self::Arctan => 2.571_400_569,
            Self::Tukey => 4.685_064_949,
        }
    }

    /// ρ(z)/z for `z ≥ 0`, between 0 and 1.
    pub(crate) fn share(self, z: f64) -> f64 {
        match self {
            Self::Squares => 1.0,
            Self::SoftL1 => 2.0 / (1.0 + (1.0 + z).sqrt()),
            Self::Huber if z > 1.0 => (2.0 - z.sqrt().recip()) / z.sqrt(),
            Self::Tukey if z > 1.0 => (3.0 * z).recip(),
            Self::Tukey => 1.0 - z * (1.0 - z / 3.0),
            Self::Cauchy if z > 0.0 => z.ln_1p() / z,
            Self::Arctan if z > 0.0 => z.atan() / z,
            // NaN passes through.
            Self::Huber | Self::Cauchy | Self::Arctan => 1.0 + z * 0.0,
        }
    }

    /// ρ′(z) for `z ≥ 0`, the weight of a residual, between 0 and 1.
    pub(crate) fn weight(self, z: f64) -> f64 {
        match self {
            Self::Squares => 1.0,
            Self::SoftL1 => (1.0 + z).sqrt().recip(),
            Self::Huber => z.max(1.0).sqrt().recip(),
            Self::Cauchy => (1.0 + z).recip(),
            Self::Arctan => (1.0 + z * z).recip(),
            Self::Tukey => (1.0 - z).max(0.0).powi(2),
        }
    }

    /// ψ′ = ρ′(z) + 2 z ρ″(z), the change of the weighted residual with the residual; negative where a residual is
    /// the less minded the larger it is.
    pub(crate) fn slope(self, z: f64) -> f64 {
        let weight = self.weight(z);
        match self {
            Self::Squares => 1.0,
            Self::SoftL1 => weight.powi(3),
            Self::Huber => f64::from(z <= 1.0),
            Self::Cauchy => (1.0 - z) * weight * weight,
            Self::Arctan => (1.0 - 3.0 * z * z) * weight * weight,
            Self::Tukey => (1.0 - z).max(0.0) * (1.0 - 5.0 * z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Loss; 6] = [Loss::Squares, Loss::SoftL1, Loss::Huber, Loss::Cauchy, Loss::Arctan, Loss::Tukey];

    /// ρ as the table has it.
    fn rho(loss: Loss, z: f64) -> f64 {
        match loss {
            Loss::Squares => z,
            Loss::SoftL1 => 2.0 * ((1.0 + z).sqrt() - 1.0),
            Loss::Huber if z <= 1.0 => z,
            Loss::Huber => 2.0 * z.sqrt() - 1.0,
            Loss::Cauchy => (1.0 + z).ln(),
            Loss::Arctan => z.atan(),
            Loss::Tukey if z <= 1.0 => (1.0 - (1.0 - z).powi(3)) / 3.0,
            Loss::Tukey => 1.0 / 3.0,
        }
    }

    #[test]
    fn shares_weights_and_slopes_belong_together() {
        for loss in ALL {
            for z in [1e-3, 0.1, 0.7, 0.999, 1.001, 3.0, 50.0] {
                let share = rho(loss, z) / z;
                // The table loses digits of ρ where z is small: ε/z.
                assert!((loss.share(z) - share).abs() < 1e-12, "{loss:?} at {z}: {} against {share}", loss.share(z));
                // Central differences: truncation h² times third derivatives of order one, rounding ε/h.
                let h = 1e-5 * z;
                let weight = (rho(loss, z + h) - rho(loss, z - h)) / (2.0 * h);
                assert!((loss.weight(z) - weight).abs() < 1e-6, "{loss:?} at {z}: {} against {weight}", loss.weight(z));
                let psi = |r: f64| r * loss.weight(r * r);
                let (r, h) = (z.sqrt(), 1e-6);
                let slope = (psi(r + h) - psi(r - h)) / (2.0 * h);
                assert!((loss.slope(z) - slope).abs() < 1e-6, "{loss:?} at {z}: {} against {slope}", loss.slope(z));
            }
            assert_eq!((loss.share(0.0), loss.weight(0.0), loss.slope(0.0)), (1.0, 1.0, 1.0), "{loss:?}");
        }
    }

    /// The trapezoidal rule over the normal density; it converges geometrically but for kinks, where the error is h².
    #[test]
    fn efficient_scales_are_those_of_95_percent() {
        for loss in ALL.into_iter().skip(1) {
            let scale = loss.efficient_scale();
            let step = 1e-4;
            let (mut bread, mut meat) = (0.0, 0.0);
            for i in -80_000..=80_000 {
                let r = step * f64::from(i);
                let z = (r / scale).powi(2);
                let density = step * (-0.5 * r * r).exp() / std::f64::consts::TAU.sqrt();
                bread += density * loss.slope(z);
                meat += density * (r * loss.weight(z)).powi(2);
            }
            let efficiency = bread * bread / meat;
            // A jump of the slope of Huber's loss falls between two points: half a step times the density of 0.16.
            assert!((efficiency - 0.95).abs() < 1e-4, "{loss:?}: efficiency {efficiency}");
        }
    }
}
