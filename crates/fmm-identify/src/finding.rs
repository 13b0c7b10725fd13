//! One number of a report: a quantity with its uncertainty and where it comes from.

use std::fmt;

use fmm_fit::EstimateStatus;
use fmm_model::{Parameter, Rounded, coverage_factor};
use fmm_uq::{Budget, Input, Inputs};

/// Source of a part of an uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Source {
    /// Residuals of the fit: noise, and misfits of the law.
    Residuals,
    /// The mass that was given.
    Mass,
    /// The stiffness that was given.
    Stiffness,
    /// The machine's own damping that was given.
    Damping,
    /// The normal load that was given.
    NormalLoad,
    /// The gain of the instrument that recorded the motion.
    Gain,
    /// The gain of the instrument that measured the force.
    ForceGain,
    /// The clock of the record.
    Clock,
    /// The time at which a pulse acts.
    Timing,
    /// The steadiness of the friction that was declared.
    Steadiness,
    /// The smoothness that a friction curve is given beforehand.
    Smoothness,
    /// Noise of a motion that was measured beside a force, and its averaging.
    Motion,
    /// Laws that the records do not exclude, and that would give another value.
    OtherLaws,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Residuals => "residuals of the fit",
            Self::Mass => "mass",
            Self::Stiffness => "stiffness",
            Self::Damping => "damping of the machine",
            Self::NormalLoad => "normal load",
            Self::Gain => "gain of the record",
            Self::ForceGain => "gain of the force",
            Self::Clock => "clock of the record",
            Self::Timing => "time of the pulse",
            Self::Steadiness => "steadiness of the friction",
            Self::Smoothness => "smoothness of the curve",
            Self::Motion => "noise of the motion",
            Self::OtherLaws => "laws that are not excluded",
        })
    }
}

/// Origin of the value of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Origin {
    /// Found by the fit.
    Fitted(EstimateStatus),
    /// Follows from fitted values and what is known of the machine.
    Derived,
}

/// A quantity that the identification found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    pub(crate) parameter: Parameter,
    pub(crate) value: f64,
    /// Variances by their sources, in the unit of the parameter squared; `None` if the record does not determine the
    /// value.
    parts: Option<Vec<(Source, f64)>>,
    /// ν of the part of the residuals.
    of_residuals: f64,
    pub(crate) origin: Origin,
    is_of_record: bool,
    /// u as if a value on its bound were not there, where there are no parts for the bound.
    at_bound: Option<f64>,
}

impl Finding {
    /// A finding with variances, if it has any, of which that of the residuals is known with `degrees_of_freedom`.
    pub(crate) fn new(
        parameter: Parameter,
        value: f64,
        parts: Option<Vec<(Source, f64)>>,
        degrees_of_freedom: f64,
        origin: Origin,
        is_of_record: bool,
    ) -> Self {
        let of_residuals = if parts.is_some() { degrees_of_freedom } else { f64::INFINITY };
        Self { parameter, value, parts, of_residuals, origin, is_of_record, at_bound: None }
    }

    /// The same for a value that lies on a bound, or follows from one: the standard uncertainty that it had without the
    /// bound.
    pub(crate) fn at_bound(mut self, uncertainty: Option<f64>, degrees_of_freedom: f64) -> Self {
        if self.parts.is_none() && uncertainty.is_some() {
            self.at_bound = uncertainty;
            self.of_residuals = degrees_of_freedom;
        }
        self
    }

    /// Adds a contribution of `source` to the uncertainty, if there is one.
    pub(crate) fn add(&mut self, source: Source, uncertainty: f64) {
        if let Some(parts) = &mut self.parts {
            parts.push((source, uncertainty * uncertainty));
        }
    }

    /// Variance by `source`, in the unit of the parameter squared.
    pub(crate) fn part(&self, source: Source) -> f64 {
        let parts = self.parts.iter().flatten().filter(|(own, _)| *own == source);
        parts.map(|(_, variance)| variance).sum()
    }

    /// True if what follows from the machine has a square, as its variance needs one.
    pub(crate) fn is_representable(&self) -> bool {
        self.origin != Origin::Derived || self.value == 0.0 || (self.value * self.value).is_normal()
    }

    /// Name, symbol and unit.
    pub fn parameter(&self) -> &Parameter {
        &self.parameter
    }

    /// The estimate, in the unit of the parameter.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// u, its standard uncertainty, in the unit of the parameter; `None` if the record does not determine it.
    pub fn uncertainty(&self) -> Option<f64> {
        self.variance().map(f64::sqrt)
    }

    /// u, or of a value on its bound the one that it would have without the bound, in the unit of the parameter.
    pub(crate) fn unbounded_uncertainty(&self) -> Option<f64> {
        self.uncertainty().or(self.at_bound)
    }

    fn variance(&self) -> Option<f64> {
        self.parts.as_ref().map(|parts| parts.iter().map(|(_, variance)| variance).sum())
    }

    /// ν, the effective degrees of freedom of the uncertainty (1) by Welch and Satterthwaite (JCGM 100:2008, G.4.1),
    /// infinite if nothing of it was estimated from residuals.
    pub fn degrees_of_freedom(&self) -> f64 {
        let Some(parts) = &self.parts else { return self.of_residuals };
        let random = parts.iter().find(|(source, variance)| *source == Source::Residuals && *variance > 0.0);
        let all = self.variance().unwrap_or(0.0);
        random.map_or(f64::INFINITY, |(_, random)| self.of_residuals * (all / random).powi(2))
    }

    /// The budget of the uncertainty, with the sources that contribute something as its inputs; `None` if there is no
    /// uncertainty. The sources are independent of each other: first order for what was given, JCGM 100:2008, 5.1.2.
    ///
    /// ```
    /// use fmm_friction::Coulomb;
    /// use fmm_identify::{Experiment, Known, Machine, Preparation, identify};
    /// # use fmm_model::Oscillator;
    /// # use fmm_record::{Quantity, Record};
    /// # use fmm_sim::{Engine, Exact, Sampling, Scenario};
    ///
    /// # let machine = Oscillator::new(10.391, 1982.0)?;
    /// # let scenario = Scenario::new(machine, Coulomb::new(0.25)?, 14.0)?.starting_at(0.015, 0.0)?;
    /// # let velocity = Exact.run(&scenario, &Sampling::uniform(1e-3, 1500)?)?.velocity().values().to_vec();
    /// # let record = Record::new(0.0, 1e-3, velocity, Quantity::Velocity, "m/s")?;
    /// // A record without noise: μ = F/N is as uncertain as mass (0.05 %) and load (0.1 %) are.
    /// let machine = Machine::of_mass(Known::new(10.391, 0.0052)?)?.with_normal_load(Known::new(14.0, 0.014)?)?;
    /// let found = identify::<Coulomb>(&machine, &[Experiment::ring_down(&record, &Preparation::default())?])?;
    /// let budget = found.finding("mu").unwrap().budget().unwrap();
    /// let load = budget.contributions().find(|part| part.input.name() == "normal load").unwrap();
    /// assert!((load.uncertainty - 0.25 * 0.014 / 14.0).abs() < 1e-9);
    /// // (0.1 %)²/((0.1 %)² + (0.05 %)²)
    /// assert!((load.share - 0.8).abs() < 1e-3);
    /// println!("{budget}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn budget(&self) -> Option<Budget> {
        let (name, unit) = (self.parameter.name(), self.parameter.unit());
        let input = |&(source, variance): &(Source, f64)| {
            let input = Input::new(source.to_string(), 0.0, variance.sqrt(), unit)?;
            if source == Source::Residuals { input.with_degrees_of_freedom(self.of_residuals) } else { Ok(input) }
        };
        let parts = self.parts.iter().flatten().filter(|(_, variance)| *variance > 0.0);
        let inputs = Inputs::new(parts.map(input).collect::<Result<Vec<_>, _>>().ok()?).ok()?;
        let sensitivities = vec![1.0; inputs.as_slice().len()];
        Some(Budget::new(inputs, self.value, sensitivities).ok()?.named(name, unit))
    }

    /// The interval that covers the quantity with probability `level`, in the unit of the parameter: value ± k u by
    /// Student's t with the [degrees of freedom](Self::degrees_of_freedom) (JCGM 100:2008, G.4), as far as the bounds
    /// of the parameter allow; of a value on its bound what lies within the bounds. `None` without an uncertainty, for
    /// what was held, where no width is left beside the digits of the value, or for a level outside (0, 1).
    pub fn interval(&self, level: f64) -> Option<(f64, f64)> {
        if self.origin == Origin::Fitted(EstimateStatus::Fixed) {
            return None;
        }
        let reach = self.uncertainty().or(self.at_bound)? * coverage_factor(level, self.degrees_of_freedom())?;
        let bounds = self.parameter.bounds();
        let (low, high) = (bounds.clamp(self.value - reach), bounds.clamp(self.value + reach));
        let has_width = low < high && (low..=high).contains(&self.value);
        // What is only known to be positive reaches down to zero.
        let low = if low == f64::MIN_POSITIVE { 0.0 } else { low };
        has_width.then_some((low, high))
    }

    /// Reason why it has no 95 % [interval](Self::interval); `None` if it has one.
    pub fn without_interval(&self) -> Option<&'static str> {
        if self.interval(0.95).is_some() {
            return None;
        }
        Some(match (self.origin, self.unbounded_uncertainty()) {
            (Origin::Fitted(EstimateStatus::Fixed), _) => "it was held, not found",
            (Origin::Fitted(status), None) if status.is_at_bound() => {
                "it lies on its bound, and the record does not tell how far from it it may be"
            }
            (Origin::Fitted(_), None) => "the record does not determine it",
            (Origin::Derived, None) => "it follows from values that the record does not determine",
            (_, Some(_)) if !self.parameter.bounds().contains(self.value) => "its value lies outside of its bounds",
            (_, Some(_)) => "its uncertainty is zero, or lost in the digits of its value",
        })
    }

    /// True for a quantity that cannot be negative, of which not even the order of magnitude is known.
    fn is_lost(&self) -> bool {
        /// Uncertainties of more than so many values leave nothing of them (1). Origin: chosen; the digits of a value
        /// that small are those of its noise.
        const MOST: f64 = 10.0;
        let is_positive = self.parameter.bounds().lower() >= 0.0;
        is_positive && self.uncertainty().is_some_and(|uncertainty| uncertainty > MOST * self.value)
    }

    /// Value, uncertainty and unit as text; of a value that is lost below its uncertainty, that it is not determined.
    pub(crate) fn quantity(&self) -> String {
        if self.is_lost() || self.origin == Origin::Fitted(EstimateStatus::Undetermined) {
            return "not determined".to_owned();
        }
        let value = Rounded::new(self.value, self.uncertainty());
        match self.parameter.unit() {
            "1" => value.to_string(),
            unit => format!("{value} {unit}"),
        }
    }

    /// Its 95 % interval as text, to the place to which the uncertainty is rounded.
    pub(crate) fn interval_text(&self) -> Option<String> {
        let (low, high) = self.interval(0.95)?;
        Some(Rounded::new(self.value, self.uncertainty().or(self.at_bound)).interval(low, high))
    }

    /// True if it belongs to one record alone: its initial state or its offset.
    pub fn is_of_record(&self) -> bool {
        self.is_of_record
    }

    /// Its origin.
    pub fn origin(&self) -> Origin {
        self.origin
    }
}

/// Width of the column that holds the names of parameters.
pub(crate) fn name_width(findings: &[Finding]) -> usize {
    findings.iter().map(|finding| finding.parameter().name().chars().count()).max().unwrap_or(0)
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.quantity())?;
        if let Some(interval) = self.interval_text() {
            write!(f, "  {interval}")?;
        }
        match self.origin() {
            Origin::Derived => write!(f, "  (with what is known of the machine)"),
            Origin::Fitted(_) => self.reservation().map_or(Ok(()), |reservation| write!(f, "  ({reservation})")),
        }
    }
}

impl Finding {
    /// Reservation against taking it for a measured value.
    pub(crate) fn reservation(&self) -> Option<&'static str> {
        match self.origin() {
            Origin::Fitted(EstimateStatus::Undetermined) => Some("the record does not tell it from others"),
            _ if self.is_lost() => Some("its uncertainty is many times its value"),
            Origin::Fitted(EstimateStatus::Fixed) => Some("held"),
            Origin::Fitted(status) if status.is_at_bound() => Some("at its bound"),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use fmm_model::Bounds;

    use super::*;

    fn finding(value: f64, u: Option<f64>, bounds: Bounds, origin: Origin) -> Finding {
        let parts = u.map(|u| vec![(Source::Residuals, u * u)]);
        Finding::new(Parameter::new("level", "F", "N").bounded(bounds), value, parts, 50.0, origin, false)
    }

    #[test]
    fn what_is_lost_below_its_uncertainty_is_not_written_as_a_number() {
        let fitted = Origin::Fitted(EstimateStatus::Determined);
        let text = |value: f64, bounds: Bounds| finding(value, Some(2900.0), bounds, fitted).to_string();
        let lost = text(12.0, Bounds::NOT_NEGATIVE);
        assert!(lost.starts_with("not determined  [0, ") && lost.contains("many times its value"), "{lost}");
        assert!(text(1200.0, Bounds::NOT_NEGATIVE).contains("1200 ± 2900"));
        // A quantity of either sign is that close to zero.
        assert!(text(12.0, Bounds::UNBOUNDED).contains(" ± 2900"));
    }

    /// An interval has a width and holds its value; without one a finding says why.
    #[test]
    fn an_interval_holds_its_value_or_is_none() {
        let derived = |value, u, bounds| finding(value, u, bounds, Origin::Derived);
        let (low, high) = derived(1.0, Some(2.0), Bounds::POSITIVE).interval(0.95).unwrap();
        assert!(low == 0.0 && (high - 5.0).abs() < 0.1, "{low} to {high}");
        let bounded = Bounds::new(0.1, 0.5628).unwrap();
        for (found, why) in [
            (derived(0.0, Some(0.0), Bounds::NOT_NEGATIVE), "its uncertainty is zero, or lost"),
            (derived(f64::MIN_POSITIVE, Some(0.0), Bounds::POSITIVE), "its uncertainty is zero, or lost"),
            (derived(1e20, Some(1.0), Bounds::UNBOUNDED), "its uncertainty is zero, or lost"),
            (derived(2.2509, Some(0.01), bounded), "its value lies outside of its bounds"),
            (derived(1.0, None, Bounds::UNBOUNDED), "it follows from values that the record does not determine"),
            (finding(1.0, None, bounded, Origin::Fitted(EstimateStatus::Fixed)), "it was held, not found"),
        ] {
            assert_eq!(found.interval(0.95), None, "{found:?}");
            assert!(
                found.without_interval().is_some_and(|said| said.starts_with(why)),
                "{:?}",
                found.without_interval()
            );
        }
        assert_eq!(derived(1.0, Some(0.1), Bounds::UNBOUNDED).without_interval(), None);
    }
}
