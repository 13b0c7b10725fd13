//! Text of distributions.

use std::fmt;

use crate::distributions::{Distribution, Shape};
use crate::rounding::significant;

impl Distribution {
    /// Name of the family, as a budget shows it: "normal", "rectangular", "t" …
    pub const fn name(&self) -> &'static str {
        match &self.shape {
            Shape::Constant => "constant",
            Shape::Rectangular => "rectangular",
            Shape::CurvilinearTrapezoid { .. } => "curvilinear trapezoid",
            Shape::Trapezoid { top: 0.0, .. } | Shape::Triangle { .. } => "triangular",
            Shape::Trapezoid { .. } => "trapezoid",
            Shape::ArcSine { .. } => "arc sine",
            Shape::Normal => "normal",
            Shape::StudentT { .. } => "t",
            Shape::Exponential => "exponential",
            Shape::Gamma { .. } => "gamma",
            Shape::Beta { .. } => "beta",
            Shape::LogNormal { .. } => "log-normal",
            Shape::Empirical(_) => "empirical",
        }
    }

    /// Divisor of the half width between the limits that gives the standard uncertainty (1), such as √3 of a
    /// rectangular quantity; 1 for a distribution without limits on both sides, of which u itself is known, and for a
    /// constant.
    pub fn divisor(&self) -> f64 {
        let (low, high) = self.limits();
        let half = 0.5 * (high - low);
        let limited = !matches!(self.shape, Shape::Constant | Shape::Empirical(_)) && half.is_finite();
        if limited { half / self.standard_uncertainty() } else { 1.0 }
    }
}

impl fmt::Display for Distribution {
    /// The symbols of JCGM 101:2008, Table 1, with six digits: `R(7000, 9000)`, `N(0, 0.05²)`, `t_18(0, 25²)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = |value: f64| significant(value, 6);
        let (low, high) = (short(self.limits.0), short(self.limits.1));
        let (mean, u) = (short(self.mean), short(self.standard_uncertainty()));
        match &self.shape {
            Shape::Constant => f.write_str(&mean),
            Shape::Rectangular => write!(f, "R({low}, {high})"),
            Shape::CurvilinearTrapezoid { inexactness: d, .. } => {
                let (low, high) = self.limits;
                write!(f, "CTrap({}, {}, {})", short(low + d), short(high - d), short(*d))
            }
            Shape::Trapezoid { top: 0.0, .. } => write!(f, "T({low}, {high})"),
            Shape::Trapezoid { base, top } => write!(f, "Trap({low}, {high}, {})", short(top / base)),
            Shape::ArcSine { .. } => write!(f, "U({low}, {high})"),
            Shape::Normal => write!(f, "N({mean}, {u}²)"),
            Shape::StudentT { degrees_of_freedom, .. } => {
                write!(f, "t_{}({mean}, {u}²)", short(*degrees_of_freedom))
            }
            Shape::Exponential => write!(f, "Ex(1/{mean})"),
            Shape::Gamma { shape, scale, .. } => write!(f, "G({}, {})", short(*shape), short(*scale)),
            Shape::Triangle { mode } => write!(f, "T({low}, {}, {high})", short(*mode)),
            Shape::Beta { shapes: (a, b), .. } => {
                write!(f, "Beta({}, {}) on [{low}, {high}]", short(*a), short(*b))
            }
            Shape::LogNormal { median, deviation } => {
                write!(f, "LN({}, {}²)", short(*median), short(*deviation))
            }
            Shape::Empirical(sorted) => write!(f, "empirical of {} values", sorted.len()),
        }
    }
}
