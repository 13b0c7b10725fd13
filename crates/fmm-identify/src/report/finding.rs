//! One number of a report: a quantity with its uncertainty and where it comes from.

use fmm_fit::{EstimateStatus, Fit, coverage_factor};
use fmm_friction::Role;
use fmm_model::{Bounds, Dual, Parameter, Rounded, Scalar};

use crate::fit::layout::{Layout, mass_of_stiffness};
use crate::law::DIRECTIONS;
use crate::law::dimension::{is_coefficient, is_force};
use crate::law::naming::{Level, Units};
use crate::machine::Machine;
use crate::machine::Scale;
use crate::report::{Contribution, Source};
use crate::residuals::structure::Covariance;

/// Where the value of a finding comes from.
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

    /// Whether what follows from the machine has a square, as its variance needs one.
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

    /// The budget of the uncertainty: what each source contributes to it, without those that contribute nothing. Empty
    /// if there is no uncertainty.
    ///
    /// ```
    /// use fmm_friction::Coulomb;
    /// use fmm_identify::{Experiment, Known, Machine, Preparation, Source, identify};
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
    /// let load = found.finding("mu").unwrap().contributions().find(|part| part.source == Source::NormalLoad).unwrap();
    /// assert!((load.uncertainty - 0.25 * 0.014 / 14.0).abs() < 1e-9);
    /// // (0.1 %)²/((0.1 %)² + (0.05 %)²)
    /// assert!((load.share - 0.8).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contributions(&self) -> impl Iterator<Item = Contribution> + '_ {
        let all = self.variance().unwrap_or(0.0);
        self.parts.iter().flatten().filter(|(_, variance)| *variance > 0.0).map(move |&(source, variance)| {
            let is_estimated = source == Source::Residuals;
            Contribution {
                source,
                uncertainty: variance.sqrt(),
                share: variance / all,
                degrees_of_freedom: if is_estimated { self.of_residuals } else { f64::INFINITY },
            }
        })
    }

    /// The interval that covers the quantity with probability `level`, in the unit of the parameter: value ± k u by
    /// Student's t with the [degrees of freedom](Self::degrees_of_freedom) (JCGM 100:2008, G.4), as far as the bounds
    /// of the parameter allow; of a value on its bound what lies within the bounds. `None` without an uncertainty, for
    /// what was held, or for a level outside (0, 1).
    pub fn interval(&self, level: f64) -> Option<(f64, f64)> {
        if self.origin == Origin::Fitted(EstimateStatus::Fixed) {
            return None;
        }
        let reach = self.uncertainty().or(self.at_bound)? * coverage_factor(level, self.degrees_of_freedom())?;
        let bounds = self.parameter.bounds();
        Some((bounds.clamp(self.value - reach), bounds.clamp(self.value + reach)))
    }

    /// Value, uncertainty and unit as text.
    pub(crate) fn quantity(&self) -> String {
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

    /// Whether it belongs to one record alone: its initial state or its offset.
    pub fn is_of_record(&self) -> bool {
        self.is_of_record
    }

    /// Where it comes from.
    pub fn origin(&self) -> Origin {
        self.origin
    }
}

/// Shared values of one fit and what is known from elsewhere, from which the derived quantities follow.
struct Inputs<'a> {
    machine: &'a Machine,
    shared: &'a [f64],
    layout: &'a Layout,
    /// Relative errors of the gains of the instrument and of a measured force, as factors (1).
    gains: [f64; 2],
    gain_uncertainty: f64,
}

/// Inputs that were not fitted: scale of the machine, normal load, gain of the instrument, gain of a measured force.
const KNOWN: usize = 4;

impl Inputs<'_> {
    /// Standard uncertainties of the inputs that were not fitted.
    fn uncertainties(&self) -> [(Source, f64); KNOWN] {
        let scale = match self.machine.scale() {
            Scale::Stiffness(known) => (Source::Stiffness, known.uncertainty()),
            Scale::Mass(known) => (Source::Mass, known.uncertainty()),
            Scale::PerUnitMass | Scale::Unknown => (Source::Mass, 0.0),
        };
        let load = self.machine.normal_load().map_or(0.0, |load| load.uncertainty());
        let force = self.layout.force_uncertainty;
        [scale, (Source::NormalLoad, load), (Source::Gain, self.gain_uncertainty), (Source::ForceGain, force)]
    }

    /// The derived quantities with their derivatives.
    fn with_gradients(&self) -> Vec<Derived> {
        let directions = self.shared.len() + KNOWN;
        let values = self.derived::<f64>(0);
        let mut gradients = vec![vec![0.0; directions]; values.len()];
        for first in (0..directions).step_by(DIRECTIONS) {
            for (gradient, (_, number)) in gradients.iter_mut().zip(self.derived::<Dual<DIRECTIONS>>(first)) {
                for (direction, slope) in gradient[first..].iter_mut().enumerate().take(DIRECTIONS) {
                    *slope = number.partial(direction);
                }
            }
        }
        let with_gradient = |((parameter, value), gradient)| Derived { parameter, value, gradient };
        values.into_iter().zip(gradients).map(with_gradient).collect()
    }

    /// Whether forces per mass are accelerations in SI, so that a mass makes forces of them.
    fn is_si(&self) -> bool {
        self.machine.scale() == Scale::Unknown || self.layout.units.is_metric()
    }

    /// The derived quantities, as numbers whose directions from `first` on are the shared values, then the inputs.
    fn derived<D: Scalar>(&self, first: usize) -> Vec<(Parameter, D)> {
        let variable = |value: f64, direction: usize| D::variable(value, direction.wrapping_sub(first));
        let natural_frequency = variable(self.shared[0], 0);
        let mut derived = Vec::new();
        let mass = match self.machine.scale() {
            Scale::PerUnitMass | Scale::Unknown => None,
            Scale::Mass(known) => {
                let mass = variable(known.value(), self.shared.len());
                let stiffness = mass / mass_of_stiffness(D::from(1.0), natural_frequency);
                derived.push((Parameter::new("stiffness", "k", "N/m").bounded(Bounds::POSITIVE), stiffness));
                Some(mass)
            }
            Scale::Stiffness(known) => {
                let mass = mass_of_stiffness(variable(known.value(), self.shared.len()), natural_frequency);
                derived.push((Parameter::new("mass", "m", "kg").bounded(Bounds::POSITIVE), mass));
                Some(mass)
            }
        };
        if self.machine.scale() != Scale::Unknown {
            for (place, term) in self.layout.terms.iter().enumerate() {
                let Some(parameter) = term.stiffness_per_mass(&self.layout.units.position) else { continue };
                let value = variable(self.shared[1 + place], 1 + place);
                derived.push((parameter, value / mass_of_stiffness(D::from(1.0), natural_frequency)));
            }
        }
        // With an unknown scale the fitted values are forces already, by the channel of a measured one if there is one.
        let by_force = variable(self.gains[1], self.shared.len() + 3);
        let to_force = match self.machine.scale() {
            Scale::Unknown => Some(by_force),
            _ => mass,
        };
        let load = self.machine.normal_load().map(|load| variable(load.value(), self.shared.len() + 1));
        let gain = variable(self.gains[0], self.shared.len() + 2);
        let Layout { family, units, law, .. } = self.layout;
        let law_value = |index: usize| variable(self.shared[law + index], law + index);
        let level = family.level().map(law_value);
        // Forces that a mass makes of forces per mass.
        let metric = Units::new("m", "N");
        for (i, law_parameter) in family.fitted().enumerate() {
            let role = law_parameter.role();
            let mut value = law_value(i);
            if let (Role::LevelAbove | Role::Breakaway, Some(level)) = (role, level) {
                value += level;
                derived.push(match self.machine.scale() {
                    Scale::Unknown => (units.stated(law_parameter, Level::Force), value * by_force),
                    _ => (units.stated(law_parameter, Level::PerMass), value / gain),
                });
            }
            let Some(force) = to_force.map(|to_force| value * to_force) else { continue };
            let stated = |level: Level| metric.stated(law_parameter, level);
            if is_coefficient(law_parameter) {
                if self.is_si() {
                    let force = force / gain;
                    derived.extend(mass.map(|_| (stated(Level::Force), force)));
                    derived.extend(load.map(|load| (stated(Level::Mu), force / load)));
                }
            } else if mass.is_some() && (role == Role::Slope || is_force(role) && self.is_si()) {
                derived.push((stated(Level::Force), force));
            }
        }
        derived
    }
}

/// A quantity that follows from shared values and inputs, with its derivatives by all of them.
pub(crate) struct Derived {
    pub(crate) parameter: Parameter,
    pub(crate) value: f64,
    /// By the shared values, then by scale, normal load, gain of the instrument and gain of a measured force.
    pub(crate) gradient: Vec<f64>,
}

/// What follows from the `shared` values of a fit and from what is known of the `machine`.
pub(crate) fn derived(machine: &Machine, layout: &Layout, shared: &[f64]) -> Vec<Derived> {
    Inputs { machine, shared, layout, gains: [1.0; 2], gain_uncertainty: 0.0 }.with_gradients()
}

/// Everything that a fit found: its parameters, and what follows from them and the known inputs of the machine.
///
/// Uncertainties of derived quantities are first order, u² = gᵀ V g + Σ (∂y/∂xᵢ)² u²(xᵢ), with exact derivatives
/// (JCGM 100:2008, 5.1.2 and 5.2.2).
pub(crate) fn findings(
    machine: &Machine,
    layout: &Layout,
    fit: &Fit,
    covariance: &Covariance,
    gain_uncertainty: f64,
) -> Vec<Finding> {
    let estimated = fit.estimates().iter().enumerate().map(|(index, estimate)| {
        // What is proportional to a power of the record is uncertain with its gain.
        let gain = gain_uncertainty * layout.power_of_gain(index, fit.values()) * estimate.value();
        let by_force = if layout.is_scaled_by_force(index) { layout.force_uncertainty * estimate.value() } else { 0.0 };
        Finding::new(
            estimate.parameter().clone(),
            estimate.value(),
            covariance.get(index, index).map(|variance| {
                vec![
                    (Source::Residuals, variance),
                    (Source::Gain, gain * gain),
                    (Source::ForceGain, by_force * by_force),
                ]
            }),
            covariance.degrees_of_freedom(),
            Origin::Fitted(estimate.status()),
            index >= layout.shared,
        )
        .at_bound(
            Some(estimate)
                .filter(|estimate| estimate.status().is_at_bound())
                .and(covariance.relaxed(index))
                .map(f64::sqrt),
            covariance.degrees_of_freedom(),
        )
    });
    let mut findings: Vec<Finding> = estimated.collect();
    let shared = &fit.values()[..layout.shared];
    let inputs = Inputs { machine, shared, layout, gains: [1.0; 2], gain_uncertainty };
    for Derived { parameter, value, gradient } in inputs.with_gradients() {
        let known = inputs.uncertainties();
        let inside = variances(|i, j| covariance.get(i, j), &gradient, known);
        let relaxed = variances(|i, j| covariance.relaxed_pair(i, j), &gradient, known);
        let relaxed = relaxed.map(|parts| parts.iter().map(|(_, variance)| variance).sum::<f64>().sqrt());
        let freedom = covariance.degrees_of_freedom();
        let finding = Finding::new(parameter, value, inside, freedom, Origin::Derived, false);
        findings.push(finding.at_bound(relaxed, freedom));
    }
    findings
}

/// The values of all findings, in the order of [`findings`], for one draw of the fitted `values`, of what is known of
/// the machine, and of the errors of the `gains` of the instrument and of a measured force, as factors (1).
#[cfg(feature = "sampler")]
pub(crate) fn values_of_findings(machine: &Machine, layout: &Layout, values: &[f64], gains: [f64; 2]) -> Vec<f64> {
    let fitted = values.iter().enumerate().map(|(index, value)| {
        let by_force = if layout.is_scaled_by_force(index) { gains[1] } else { 1.0 };
        value * gains[0].powf(-layout.power_of_gain(index, values)) * by_force
    });
    let inputs = Inputs { machine, shared: &values[..layout.shared], layout, gains, gain_uncertainty: 0.0 };
    fitted.chain(inputs.derived::<f64>(0).into_iter().map(|(_, value)| value)).collect()
}

/// gᵀ V g over the fitted values, and the variances by the inputs; `None` if a value that matters has none.
fn variances(
    covariance: impl Fn(usize, usize) -> Option<f64>,
    gradient: &[f64],
    inputs: [(Source, f64); KNOWN],
) -> Option<Vec<(Source, f64)>> {
    let (shared, known) = gradient.split_at(gradient.len() - inputs.len());
    let mut random = 0.0;
    for (i, row) in shared.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
        for (j, column) in shared.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
            random += row * column * covariance(i, j)?;
        }
    }
    let known = known.iter().zip(inputs).map(|(slope, (source, u))| (source, (slope * u).powi(2)));
    Some(std::iter::once((Source::Residuals, random)).chain(known).collect())
}
