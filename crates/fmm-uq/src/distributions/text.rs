//! Text of distributions.

use std::fmt;

use super::{Distribution, Shape};
use crate::report::rounding::significant;

impl Distribution {
    /// Name of the family, as a budget shows it: "normal", "rectangular", "t" …
    pub const fn name(&self) -> &'static str {
        match &self.shape {
            Shape::Constant(_) => "constant",
            Shape::Rectangular { .. } => "rectangular",
            Shape::CurvilinearTrapezoid(_) => "curvilinear trapezoid",
            Shape::Trapezoid(shape) if shape.is_triangle() => "triangular",
            Shape::Trapezoid(_) => "trapezoid",
            Shape::ArcSine(_) => "arc sine",
            Shape::Normal { .. } => "normal",
            Shape::StudentT { .. } => "t",
            Shape::Exponential { .. } => "exponential",
            Shape::Gamma { .. } => "gamma",
            Shape::Triangle(_) => "triangular",
            Shape::Beta(_) => "beta",
            Shape::TruncatedNormal(_) => "truncated normal",
            Shape::LogNormal { .. } => "log-normal",
            Shape::Poisson { .. } => "Poisson",
            Shape::Empirical(_) => "empirical",
        }
    }

    /// Divisor of the half width between the limits that gives the standard uncertainty (1), such as √3 of a
    /// rectangular quantity; 1 for a distribution without limits on both sides, of which u itself is known, and for a
    /// constant.
    pub fn divisor(&self) -> f64 {
        let (low, high) = self.limits();
        let half = 0.5 * (high - low);
        let limited = !matches!(self.shape, Shape::Constant(_) | Shape::Empirical(_)) && half.is_finite();
        if limited { half / self.standard_uncertainty() } else { 1.0 }
    }
}

impl fmt::Display for Distribution {
    /// The symbols of JCGM 101:2008, Table 1, with six digits: `R(7000, 9000)`, `N(0, 0.05²)`, `t_18(0, 25²)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = |value: f64| significant(value, 6);
        let (low, high) = self.limits();
        let (low, high) = (short(low), short(high));
        match &self.shape {
            Shape::Constant(value) => f.write_str(&short(*value)),
            Shape::Rectangular { .. } => write!(f, "R({low}, {high})"),
            Shape::CurvilinearTrapezoid(shape) => {
                let d = shape.inexactness();
                let (outer_low, outer_high) = self.limits();
                write!(f, "CTrap({}, {}, {})", short(outer_low + d), short(outer_high - d), short(d))
            }
            Shape::Trapezoid(shape) if shape.is_triangle() => write!(f, "T({low}, {high})"),
            Shape::Trapezoid(shape) => write!(f, "Trap({low}, {high}, {})", short(shape.ratio())),
            Shape::ArcSine(_) => write!(f, "U({low}, {high})"),
            Shape::Normal { mean, standard_deviation } => {
                write!(f, "N({}, {}²)", short(*mean), short(*standard_deviation))
            }
            Shape::StudentT { mean, scale, degrees_of_freedom, .. } => {
                write!(f, "t_{}({}, {}²)", short(*degrees_of_freedom), short(*mean), short(*scale))
            }
            Shape::Exponential { mean } => write!(f, "Ex(1/{})", short(*mean)),
            Shape::Gamma { shape, scale, .. } => write!(f, "G({}, {})", short(*shape), short(*scale)),
            Shape::Triangle(shape) => write!(f, "T({low}, {}, {high})", short(shape.parameters().1)),
            Shape::Beta(shape) => {
                write!(f, "Beta({}, {}) on [{low}, {high}]", short(shape.shapes().0), short(shape.shapes().1))
            }
            Shape::TruncatedNormal(shape) => {
                let (mean, u) = shape.parameters();
                write!(f, "N({}, {}²) on [{low}, {high}]", short(mean), short(u))
            }
            Shape::LogNormal { median, deviation } => {
                write!(f, "LN({}, {}²)", short(*median), short(*deviation))
            }
            Shape::Poisson { mean, .. } => write!(f, "Poisson({})", short(*mean)),
            Shape::Empirical(shape) => write!(f, "empirical of {} values", shape.count()),
        }
    }
}
