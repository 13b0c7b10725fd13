//! Friction at one speed or over a path, with its uncertainty.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt;

use fmm_fit::FTest;
use fmm_model::Rounded;

use crate::finding::Source;
use crate::friction_curve::mixture::moments;

/// Friction at one speed, or in the mean over a path: a number of a [`FrictionCurve`](crate::FrictionCurve).
///
/// Its distribution is a mixture of Student's t, cut off at zero: friction takes energy. `Display` gives value,
/// standard uncertainty, unit and 95 % interval.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionLevel {
    /// Weight, mean and variance of each part.
    parts: Vec<(f64, f64, f64)>,
    /// ν of each part (1).
    freedom: f64,
    unit: String,
    value: f64,
    uncertainty: f64,
    /// Standard uncertainty by each source.
    contributions: Vec<(Source, f64)>,
}

/// Deviations of a part beyond which it is left out of a search for a quantile (1).
const FAR: f64 = 40.0;

impl FrictionLevel {
    /// Level as a mixture of these `parts` in `unit`, each of Student's t with `freedom`.
    pub(super) fn new(parts: &[(f64, f64, f64)], freedom: f64, unit: String) -> Self {
        let parts = gathered(parts);
        let mut level = Self { value: 0.0, uncertainty: 0.0, contributions: Vec::new(), parts, freedom, unit };
        (level.value, level.uncertainty) = level.moments_above_zero();
        level
    }

    /// The same with these standard uncertainties by source.
    pub(super) fn with_sources(mut self, contributions: impl Iterator<Item = (Source, f64)>) -> Self {
        self.contributions = contributions.filter(|(_, uncertainty)| *uncertainty > 0.0).collect();
        self
    }

    /// Mean of the distribution, in the [unit](Self::unit).
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Standard deviation of the distribution, in the [unit](Self::unit).
    pub fn uncertainty(&self) -> f64 {
        self.uncertainty
    }

    /// Standard uncertainty by each source that has a part in it, in the [unit](Self::unit); the squares sum to that of
    /// the [uncertainty](Self::uncertainty), or to more where the distribution is cut off at zero.
    ///
    /// [`Source::Residuals`] differs from record to record, [`Source::Smoothness`] is alike in all records of one
    /// curve.
    pub fn contributions(&self) -> &[(Source, f64)] {
        &self.contributions
    }

    /// Unit of the value, `"1"` for a coefficient.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// The interval that covers the friction with probability `level`, as much being below it as above it; `None`
    /// for a level outside (0, 1).
    pub fn interval(&self, level: f64) -> Option<(f64, f64)> {
        let tail = 0.5 * (1.0 - level);
        (level > 0.0 && level < 1.0).then(|| (self.quantile(tail), self.quantile(1.0 - tail)))
    }

    /// Mean and standard deviation of what lies above zero.
    fn moments_above_zero(&self) -> (f64, f64) {
        let plain = moments(&self.parts);
        if self.parts.iter().all(|(_, mean, variance)| *mean > 6.0 * variance.sqrt()) {
            return plain;
        }
        let mut above = Vec::with_capacity(self.parts.len());
        for &(weight, mean, variance) in &self.parts {
            let deviation = variance.sqrt();
            let a = -mean / deviation;
            let share = upper_tail(a, f64::INFINITY);
            if share > 0.0 && deviation > 0.0 {
                let ratio = (-0.5 * a * a).exp() / (2.0 * PI).sqrt() / share;
                let own = (mean + deviation * ratio, variance * (1.0 + a * ratio - ratio * ratio).max(0.0));
                above.push((weight * share, own.0, own.1));
            }
        }
        let sum: f64 = above.iter().map(|(weight, ..)| weight).sum();
        if !(sum > 0.0) {
            return (0.0, plain.1);
        }
        for (weight, ..) in &mut above {
            *weight /= sum;
        }
        moments(&above)
    }

    /// Probability of a value above `x`, those below zero not left out.
    fn beyond(&self, x: f64) -> f64 {
        let parts = self.parts.iter();
        parts.map(|(weight, mean, variance)| weight * upper_tail((x - mean) / variance.sqrt(), self.freedom)).sum()
    }

    /// The value that is exceeded with probability 1 − `p`, by false position (Illinois).
    fn quantile(&self, p: f64) -> f64 {
        let reach = |sign: f64| self.parts.iter().map(move |(_, mean, variance)| mean + sign * FAR * variance.sqrt());
        let (mut low, mut high) = (reach(-1.0).fold(f64::INFINITY, f64::min).max(0.0), reach(1.0).fold(0.0, f64::max));
        // Near the middle first, as the ends lie far out.
        let (mean, deviation) = (self.value, self.uncertainty);
        let all = self.beyond(0.0);
        let above_of_all = |x: f64| if all > 0.0 { (self.beyond(x.max(0.0)) / all).min(1.0) } else { 0.0 };
        let excess = |x: f64| above_of_all(x) - (1.0 - p);
        let (mut below, mut above) = (excess(low), excess(high));
        for x in [mean - 4.0 * deviation, mean, mean + 4.0 * deviation] {
            if x > low && x < high {
                match excess(x) {
                    value if value > 0.0 => (low, below) = (x, value),
                    value => {
                        (high, above) = (x, value);
                        break;
                    }
                }
            }
        }
        let mut side = 0;
        for _ in 0..60 {
            if !(high - low > 1e-6 * deviation) || below == above {
                break;
            }
            let x = (low * above - high * below) / (above - below);
            let x = if x > low && x < high { x } else { 0.5 * (low + high) };
            let value = excess(x);
            if value.abs() < 1e-9 {
                return x;
            }
            if value > 0.0 {
                (low, below) = (x, value);
                above *= if side == 1 { 0.5 } else { 1.0 };
                side = 1;
            } else {
                (high, above) = (x, value);
                below *= if side == -1 { 0.5 } else { 1.0 };
                side = -1;
            }
        }
        0.5 * (low + high)
    }
}

/// Weight, mean and variance of a part.
type Part = (f64, f64, f64);

/// Parts with nearly the same mean and variance as one: a quantile takes a search over all of them.
fn gathered(parts: &[(f64, f64, f64)]) -> Vec<(f64, f64, f64)> {
    /// Width of a class of means over the deviation of all, and of deviations over themselves.
    const WIDTH: f64 = 0.1;
    let (_, deviation) = moments(parts);
    let mut classes: BTreeMap<(i64, i64), Vec<Part>> = BTreeMap::new();
    for &(weight, mean, variance) in parts {
        let class = |value: f64| (value / WIDTH).round() as i64;
        let of_deviation = class(0.5 * variance.max(f64::MIN_POSITIVE).ln());
        classes
            .entry((class(mean / deviation.max(f64::MIN_POSITIVE)), of_deviation))
            .or_default()
            .push((weight, mean, variance));
    }
    let as_one = |class: Vec<(f64, f64, f64)>| {
        let sum: f64 = class.iter().map(|(weight, ..)| weight).sum();
        let class: Vec<_> = class.into_iter().map(|(weight, mean, variance)| (weight / sum, mean, variance)).collect();
        let (mean, deviation) = moments(&class);
        (sum, mean, deviation * deviation)
    };
    classes.into_values().map(as_one).collect()
}

/// Probability that Student's t with `freedom` exceeds `t`.
fn upper_tail(t: f64, freedom: f64) -> f64 {
    let tail = 0.5 * FTest::tail(t * t, 1.0, freedom).unwrap_or(1.0);
    if t < 0.0 { 1.0 - tail } else { tail }
}

impl fmt::Display for FrictionLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = Rounded::new(self.value, Some(self.uncertainty));
        write!(f, "{rounded}")?;
        if self.unit != "1" {
            write!(f, " {}", self.unit)?;
        }
        match self.interval(0.95) {
            Some((low, high)) => write!(f, "  {}", rounded.interval(low, high)),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_part_far_above_zero_is_student_t() {
        let level = FrictionLevel::new(&[(1.0, 5.0, 0.04)], 9.0, "N".into());
        assert!((level.value() - 5.0).abs() + (level.uncertainty() - 0.2).abs() < 1e-12);
        let (low, high) = level.interval(0.95).unwrap();
        assert!((low - (5.0 - 0.2 * 2.262_157)).abs() < 1e-5 && (high - (5.0 + 0.2 * 2.262_157)).abs() < 1e-5);
        assert_eq!(level.interval(1.0), None);
    }

    /// Half of a normal distribution: mean √(2/π), 95 % quantile of |z| 1.96.
    #[test]
    fn distribution_is_cut_off_at_zero() {
        let level = FrictionLevel::new(&[(0.5, 0.0, 1.0), (0.5, 0.0, 1.0)], f64::INFINITY, "1".into());
        assert!((level.value() - (2.0 / PI).sqrt()).abs() < 1e-6, "{}", level.value());
        assert!((level.uncertainty() - (1.0 - 2.0 / PI).sqrt()).abs() < 1e-6);
        let (low, high) = level.interval(0.9).unwrap();
        assert!((low - 0.062_707).abs() < 1e-4 && (high - 1.959_964).abs() < 1e-4, "{low} {high}");
    }
}
