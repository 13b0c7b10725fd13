//! Friction against load: proportional, with an offset, or independent.

use std::fmt;

use fmm_fit::{RandomEffectsLine, UncertainPoint};
use fmm_model::{Estimated, Rounded};

use crate::error::IdentifyError;
use crate::judgement::rules::LEVEL;

/// Dependence of friction on the load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LoadVerdict {
    /// Friction in proportion to the load, within the uncertainty of the runs: F = μ N (Amontons).
    Proportional,
    /// Growing with the load from a level other than zero: F/N depends on the load, and one coefficient does not
    /// describe it.
    Offset,
    /// Friction that is not seen to grow with the load.
    Independent,
}

/// Friction of several runs against their loads, by a straight line whose coefficient differs from run to run.
///
/// ```text
/// F_i = F₀ + (μ + b_i) N_i + e_i,     var b_i = τ²
/// F_i/N_i = μ + F₀ (1/N_i) + b_i + e_i/N_i                   the line that is fitted, RandomEffectsLine
/// ```
///
/// A coefficient that differs by as much at each load makes forces that differ in proportion to it, which a line
/// through forces with one spread does not know. Uncertainties of load and force enter both sides of the fitted line,
/// with their correlation; they are taken to be independent from run to run. A scale that is wrong by one factor in all
/// loads or all forces changes μ by that factor, and not whether F₀ is zero.
///
/// `Display` gives the judgement in a sentence.
///
/// ```
/// use fmm_identify::FrictionOverLoad;
/// use fmm_model::Estimated;
///
/// // Three loads (N), two runs each, with the friction force (N).
/// let runs = [(3.5, 0.352), (3.5, 0.349), (7.0, 0.703), (7.0, 0.698), (14.0, 1.404), (14.0, 1.395)];
/// let of = |offset: f64| {
///     let run = |(load, force): (f64, f64)| (Estimated::new(load, 0.0), Estimated::new(force + offset, 0.002));
///     FrictionOverLoad::of(&runs.map(run))
/// };
/// let found = of(0.0)?;
/// assert!(found.to_string().starts_with("friction is in proportion to the load between 3.5 N and 14 N"));
/// assert!((found.coefficient().value - 0.1).abs() < 2.0 * found.coefficient().uncertainty);
/// // An adhesion of 0.05 N shows.
/// assert!(of(0.05)?.to_string().starts_with("friction is not in proportion to the load"));
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionOverLoad {
    line: RandomEffectsLine,
    runs: usize,
    loads: (f64, f64),
}

impl FrictionOverLoad {
    /// Friction over the load by at least three runs, each with its normal load and its friction force (N), at two
    /// different loads or more.
    ///
    /// # Errors
    /// [`IdentifyError::TooFew`]; [`IdentifyError::OutOfRange`] for a load that is not positive or a number that is not
    /// finite; [`IdentifyError::NotSeen`] if no line describes the runs, as where neither force nor load of a run has
    /// an uncertainty.
    pub fn of(runs: &[(Estimated, Estimated)]) -> Result<Self, IdentifyError> {
        if runs.len() < 3 {
            return Err(IdentifyError::too_few_runs("runs", runs.len(), 3));
        }
        for (load, force) in runs {
            if !(load.value > 0.0 && load.value.is_finite()) {
                return Err(IdentifyError::not_allowed("the normal load of a run", load.value, "positive, in N"));
            }
            if !force.value.is_finite() {
                return Err(IdentifyError::not_allowed("the friction force of a run", force.value, "finite, in N"));
            }
        }
        let loads = || runs.iter().map(|(load, _)| load.value);
        let (smallest, largest) = (loads().fold(f64::INFINITY, f64::min), loads().fold(0.0, f64::max));
        if smallest == largest {
            return Err(IdentifyError::too_few_runs("different loads", 1, 2));
        }
        let point = |(load, force): &(Estimated, Estimated)| {
            // dx = −dN/N², dy = dF/N − F dN/N².
            let (n, f, u) = (load.value, force.value, load.uncertainty / load.value);
            let (u_x, by_load, by_force) = (u / n, f / n * u, force.uncertainty / n);
            let u_y = by_load.hypot(by_force);
            let correlation = if u_x > 0.0 && u_y > 0.0 { by_load / u_y } else { 0.0 };
            UncertainPoint::new(1.0 / n, f / n, u_x, u_y).with_correlation(correlation)
        };
        let points: Vec<UncertainPoint> = runs.iter().map(point).collect();
        let line = RandomEffectsLine::fit(&points).map_err(|error| IdentifyError::not_seen(error.to_string()))?;
        Ok(Self { line, runs: runs.len(), loads: (smallest, largest) })
    }

    /// μ, slope of the friction over the load (1).
    pub fn coefficient(&self) -> Estimated {
        Estimated::new(self.line.intercept(), self.line.intercept_uncertainty())
    }

    /// F₀, friction without a load, extrapolated (N).
    pub fn intercept(&self) -> Estimated {
        Estimated::new(self.line.slope(), self.line.slope_uncertainty())
    }

    /// τ, standard deviation of μ between runs beyond their uncertainties (1).
    pub fn between(&self) -> f64 {
        self.line.between()
    }

    /// The interval that covers μ with probability `level` (1); `None` unless 0 < level < 1.
    pub fn coefficient_interval(&self, level: f64) -> Option<(f64, f64)> {
        self.line.intercept_interval(level)
    }

    /// The interval that covers F₀ with probability `level` (N); `None` unless 0 < level < 1.
    pub fn intercept_interval(&self, level: f64) -> Option<(f64, f64)> {
        self.line.slope_interval(level)
    }

    /// Probability of an F₀ as far from zero if friction were in proportion to the load (1).
    pub fn intercept_p_value(&self) -> f64 {
        self.line.slope_p_value()
    }

    /// The interval that covers the friction force at a `load` (N) of a mean run with probability `level` (N); `None`
    /// unless 0 < level < 1 and the load is positive.
    pub fn force_interval(&self, load: f64, level: f64) -> Option<(f64, f64)> {
        let (low, high) = self.line.value_interval(load.recip(), level).filter(|_| load > 0.0)?;
        Some((load * low, load * high))
    }

    /// The friction force at a `load` (N), F₀ + μ N (N).
    pub fn force(&self, load: f64) -> f64 {
        self.line.slope() + self.line.intercept() * load
    }

    /// Smallest and largest load (N).
    pub fn loads(&self) -> (f64, f64) {
        self.loads
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.runs
    }

    /// The judgement, by intervals of 95 %.
    fn verdict(&self) -> LoadVerdict {
        let includes_zero = |interval: Option<(f64, f64)>| interval.is_none_or(|(low, high)| low <= 0.0 && 0.0 <= high);
        if includes_zero(self.coefficient_interval(LEVEL)) {
            LoadVerdict::Independent
        } else if includes_zero(self.intercept_interval(LEVEL)) {
            LoadVerdict::Proportional
        } else {
            LoadVerdict::Offset
        }
    }

    /// Largest |F₀| that the 95 % interval includes, as a share of the friction at the smallest load (1).
    fn largest_share(&self) -> f64 {
        let (low, high) = self.intercept_interval(LEVEL).unwrap_or_default();
        low.abs().max(high.abs()) / self.force(self.loads.0).abs()
    }
}

impl fmt::Display for FrictionOverLoad {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = |value: Estimated| Rounded::new(value.value, Some(value.uncertainty)).to_string();
        let (coefficient, intercept) = (text(self.coefficient()), text(self.intercept()));
        let (smallest, largest) = self.loads;
        match self.verdict() {
            LoadVerdict::Proportional => write!(
                f,
                "friction is in proportion to the load between {smallest} N and {largest} N, F = μ N, as far as {} \
                 runs tell: F₀ + μ N has μ = {coefficient} and F₀ = {intercept} N, zero within its 95 % interval; an \
                 F₀ of up to {:.1} % of the friction at {smallest} N would not show",
                self.runs,
                100.0 * self.largest_share()
            ),
            LoadVerdict::Offset => write!(
                f,
                "friction is not in proportion to the load: F₀ + μ N has μ = {coefficient} and F₀ = {intercept} N, \
                 which is not zero (p = {:.1e}) and makes {:.1} % of the friction at {smallest} N; F/N {} with the \
                 load, so that no one coefficient holds between {smallest} N and {largest} N",
                self.intercept_p_value(),
                100.0 * self.intercept().value / self.force(smallest),
                if self.intercept().value > 0.0 { "falls" } else { "rises" }
            ),
            LoadVerdict::Independent => write!(
                f,
                "friction is not seen to grow with the load between {smallest} N and {largest} N: F₀ + μ N has μ = \
                 {coefficient}, zero within its 95 % interval, and F₀ = {intercept} N"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_fit::{StraightLine, Weighting};

    fn runs(loads: &[f64], force: impl Fn(usize, f64) -> f64, u: f64) -> Vec<(Estimated, Estimated)> {
        let run = |(i, load): (usize, &f64)| (Estimated::new(*load, 0.0), Estimated::new(force(i, *load), u));
        loads.iter().enumerate().map(run).collect()
    }

    /// Runs with two coefficients in turn: the line of forces over loads with weights 1/N², closed form of
    /// `StraightLine`.
    #[test]
    fn it_is_the_line_weighted_by_the_load() {
        let loads = [2.0, 2.0, 4.0, 4.0, 8.0, 8.0, 16.0];
        let force = |i: usize, load: f64| 0.3 + load * (0.1 + 0.01 * [1.0, -1.0, 0.4, -0.7, 0.2, 0.9, -0.8][i]);
        // Uncertainties in proportion to the load, so that all F/N are known as well.
        let run = |(i, load): (usize, &f64)| (Estimated::new(*load, 0.0), Estimated::new(force(i, *load), 1e-4 * load));
        let found = FrictionOverLoad::of(&loads.iter().enumerate().map(run).collect::<Vec<_>>()).unwrap();
        let forces: Vec<f64> = loads.iter().enumerate().map(|(i, load)| force(i, *load)).collect();
        let line = StraightLine::fit(&loads, &forces, Weighting::Relative(&loads)).unwrap();
        for (found, value, u) in [
            (found.intercept(), line.intercept(), line.intercept_uncertainty()),
            (found.coefficient(), line.slope(), line.slope_uncertainty()),
        ] {
            assert!((found.value / value - 1.0).abs() < 1e-10, "{found:?} instead of {value}");
            assert!((found.uncertainty / u.unwrap() - 1.0).abs() < 1e-9, "{found:?} instead of {u:?}");
        }
        assert!((found.force(5.0) - line.value(5.0)).abs() < 1e-10);
        let (low, high) = found.force_interval(5.0, 0.95).unwrap();
        let expected = line.predict(5.0).unwrap().confidence(0.95).unwrap();
        assert!((low / expected.0 - 1.0).abs() < 1e-9 && (high / expected.1 - 1.0).abs() < 1e-9);
        assert_eq!(found.force_interval(-1.0, 0.95), None);
    }

    #[test]
    fn each_verdict_has_its_sentence() {
        let loads = [2.0, 2.0, 4.0, 4.0, 8.0, 8.0];
        let noise = |i: usize| 0.001 * [1.0, -1.0, 0.5, -0.5, 0.8, -0.8][i];
        let of = |force: &dyn Fn(usize, f64) -> f64| {
            let found = FrictionOverLoad::of(&runs(&loads, force, 0.001)).unwrap();
            (found.verdict(), found.to_string())
        };
        let (verdict, text) = of(&|i, load| 0.1 * load + noise(i));
        assert!(
            verdict == LoadVerdict::Proportional && text.contains("in proportion to the load between 2 N"),
            "{text}"
        );
        let (verdict, text) = of(&|i, load| 0.1 * load + 0.05 + noise(i));
        assert!(verdict == LoadVerdict::Offset && text.contains("F/N falls"), "{text}");
        let (verdict, text) = of(&|i, load| 0.1 * load - 0.05 + noise(i));
        assert!(verdict == LoadVerdict::Offset && text.contains("F/N rises"), "{text}");
        let (verdict, text) = of(&|i, _| 0.5 + noise(i));
        assert!(verdict == LoadVerdict::Independent && text.contains("is not seen to grow"), "{text}");
    }

    /// The uncertainty of a load makes that of F/N and of 1/N: what the line says of μ is that of one run, u(N)/N.
    #[test]
    fn uncertain_loads_count_on_both_sides() {
        let loads = [2.0, 2.0, 4.0, 4.0];
        let of = |u: f64| {
            let run = |load: f64| (Estimated::new(load, u * load), Estimated::new(0.1 * load, 1e-6));
            FrictionOverLoad::of(&loads.map(run)).unwrap()
        };
        // About F = μ N, the error of a load moves a run along the line of F/N against 1/N only by what F₀ is, and off
        // it by μ u(N)/N: u(μ)² = (u μ)² (Σ x²)/(n Σ (x − x̄)²) with x = 1/N.
        let (sum, square, count) = (1.5_f64, 0.625_f64, 4.0);
        let expected = 0.01 * 0.1 * (square / (count * square - sum * sum)).sqrt();
        let found = of(0.01).coefficient();
        assert!(
            (found.value - 0.1).abs() < 1e-9 && (found.uncertainty / expected - 1.0).abs() < 1e-3,
            "{found:?} {expected}"
        );
    }

    #[test]
    fn bad_input_is_named() {
        let of = |loads: &[f64], u: f64| {
            FrictionOverLoad::of(&runs(loads, |_, load| 0.1 * load, u)).unwrap_err().to_string()
        };
        assert!(of(&[1.0, 2.0], 0.1).contains("2 runs"), "{}", of(&[1.0, 2.0], 0.1));
        assert!(of(&[2.0; 4], 0.1).contains("1 different load"), "{}", of(&[2.0; 4], 0.1));
        assert!(of(&[1.0, 2.0, -3.0], 0.1).contains("must be positive, in N, not -3"));
        assert!(of(&[1.0, 2.0, 3.0], 0.0).contains("no uncertainty"));
        let lost = runs(&[1.0, 2.0, 3.0], |_, _| f64::NAN, 0.1);
        assert!(FrictionOverLoad::of(&lost).unwrap_err().to_string().contains("friction force of a run"));
    }
}
