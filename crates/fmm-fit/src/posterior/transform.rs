//! Coordinate of a bounded parameter that takes every real value.

use fmm_model::Bounds;

/// Parameter θ as a function of a coordinate ψ without bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Transform {
    /// θ = ψ.
    Identity,
    /// θ = a + exp ψ.
    Above(f64),
    /// θ = b − exp ψ.
    Below(f64),
    /// θ = a + (b − a)/(1 + exp −ψ), ψ being the logit of the share of the interval.
    Between(f64, f64),
}

/// A parameter and its derivatives by the coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Image {
    /// θ.
    pub(super) value: f64,
    /// dθ/dψ.
    pub(super) slope: f64,
    /// d²θ/dψ².
    pub(super) bend: f64,
    /// ln |dθ/dψ|, by which a density over θ becomes one over ψ.
    pub(super) log_slope: f64,
    /// Its derivative.
    pub(super) log_slope_by: f64,
    /// The derivative of that, with the sign turned; never negative.
    pub(super) log_slope_curvature: f64,
}

impl Transform {
    pub(super) fn of(bounds: Bounds) -> Self {
        match (bounds.lower().is_finite(), bounds.upper().is_finite()) {
            (false, false) => Self::Identity,
            (true, false) => Self::Above(bounds.lower()),
            (false, true) => Self::Below(bounds.upper()),
            (true, true) => Self::Between(bounds.lower(), bounds.upper()),
        }
    }

    pub(super) fn at(self, psi: f64) -> Image {
        let exponential = |origin: f64, sign: f64| {
            let distance = sign * psi.exp();
            Image {
                value: origin + distance,
                slope: distance,
                bend: distance,
                log_slope: psi,
                log_slope_by: 1.0,
                log_slope_curvature: 0.0,
            }
        };
        match self {
            Self::Identity => {
                Image { value: psi, slope: 1.0, bend: 0.0, log_slope: 0.0, log_slope_by: 0.0, log_slope_curvature: 0.0 }
            }
            Self::Above(lower) => exponential(lower, 1.0),
            Self::Below(upper) => exponential(upper, -1.0),
            Self::Between(lower, upper) => {
                let width = upper - lower;
                // The share nearer to its end, so that neither 1 − s nor ln s loses digits.
                let near = (-psi.abs()).exp();
                let (small, large) = (near / (1.0 + near), 1.0 / (1.0 + near));
                let (value, share) =
                    if psi < 0.0 { (lower + width * small, small) } else { (upper - width * small, large) };
                let slope = width * small * large;
                Image {
                    value,
                    slope,
                    bend: slope * (1.0 - 2.0 * share),
                    log_slope: width.ln() - psi.abs() - 2.0 * near.ln_1p(),
                    log_slope_by: 1.0 - 2.0 * share,
                    log_slope_curvature: 2.0 * small * large,
                }
            }
        }
    }

    /// The coordinate of a value strictly inside.
    pub(super) fn coordinate(self, value: f64) -> f64 {
        match self {
            Self::Identity => value,
            Self::Above(lower) => (value - lower).ln(),
            Self::Below(upper) => (upper - value).ln(),
            Self::Between(lower, upper) => ((value - lower) / (upper - value)).ln(),
        }
    }

    /// The value nearest to `value` that keeps at least `distance` from the ends, or a quarter of the interval if that
    /// is less.
    pub(super) fn inside(self, value: f64, distance: f64) -> f64 {
        match self {
            Self::Identity => value,
            Self::Above(lower) => value.max(lower + distance),
            Self::Below(upper) => value.min(upper - distance),
            Self::Between(lower, upper) => {
                let distance = distance.min(0.25 * (upper - lower));
                value.max(lower + distance).min(upper - distance)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_inside_and_their_derivatives_those_of_differences() {
        let all = [Transform::Identity, Transform::Above(2.0), Transform::Below(-1.0), Transform::Between(-3.0, 5.0)];
        for transform in all {
            for psi in [-3.0, -0.4, 0.0, 0.7, 2.5] {
                let [below, at, above] = [psi - 1e-5, psi, psi + 1e-5].map(|psi| transform.at(psi));
                let checks = [
                    (at.slope, above.value - below.value),
                    (at.bend, above.slope - below.slope),
                    (at.log_slope_by, above.log_slope - below.log_slope),
                    (-at.log_slope_curvature, above.log_slope_by - below.log_slope_by),
                ];
                for (derivative, difference) in checks {
                    // Truncation 1e-10 of third derivatives of up to 13, rounding 1e-15/1e-5.
                    assert!((derivative - difference / 2e-5).abs() < 3e-9, "{transform:?} at {psi}: {derivative}");
                }
                assert!((at.log_slope - at.slope.abs().ln()).abs() < 1e-14);
                // Rounding of a value of order five that a slope of at least 0.3 divides.
                assert!((transform.coordinate(at.value) - psi).abs() < 1e-14, "{transform:?} at {psi}");
            }
        }
    }

    #[test]
    fn far_coordinates_stay_within_the_ends() {
        let between = Transform::Between(1.0, 2.0);
        for psi in [-800.0, -40.0, 40.0, 800.0] {
            let image = between.at(psi);
            assert!((1.0..=2.0).contains(&image.value) && image.log_slope.is_finite(), "{image:?}");
        }
        assert_eq!(between.inside(1.0, 0.1), 1.1);
        assert_eq!(between.inside(2.0, 10.0), 1.75);
        assert_eq!(Transform::Above(0.0).inside(0.0, 0.3), 0.3);
    }
}
