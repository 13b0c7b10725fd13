//! Guess of the findings of the tests: values, their uncertainty, and earlier measurements.

use fmm_fit::design::Information;
use fmm_friction::Role;
use fmm_model::{ModelError, Parameter, Rounded, Unit};
use fmm_record::{Quantity, Record};

use crate::candidate::Candidate;
use crate::design::local;
use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::identification::Identification;
use crate::law::dimension::is_force;
use crate::law::naming::{Form, Units};
use crate::machine::Machine;
use crate::machine::Scale;

/// Knowledge before the tests: the machine, the law with guessed values, and earlier measurements.
///
/// ```
/// use fmm_identify::design::Guess;
/// use fmm_identify::{Candidate, Known, Machine};
///
/// let machine = Machine::of_mass(Known::new(10.391, 0.005)?)?.with_normal_load(Known::exact(14.0)?)?;
/// // 2.198 Hz; μ₀, μ₁ and α of Berger's law, and the damping of the machine (N s/m).
/// let guess = Guess::new(machine, &Candidate::named("berger + linear")?, 2.198, &[0.228, 0.261, 2.852], &[("damping", 0.275)])?;
/// assert!((guess.value("friction_per_mass").unwrap() - 0.228 * 14.0 / 10.391).abs() < 1e-12);
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Guess {
    pub(crate) machine: Machine,
    /// The law with its static levels fitted, and its terms.
    pub(crate) model: Candidate,
    /// Unit of positions.
    pub(crate) position: Unit,
    /// The parameters that all tests share, in the order of a fit, static levels among them, and their values.
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) values: Vec<f64>,
    /// Information of earlier measurements about the shared parameters.
    pub(crate) measured: Information,
    /// Spread of the values of the shared parameters.
    spread: Information,
}

impl Guess {
    /// A `candidate` law on `machine`, which vibrates at `frequency` (Hz) without friction, with `law` values in the
    /// order and the units of the [family](fmm_friction::LawFamily): coefficients under the normal load of the machine,
    /// or forces if none is known, or forces per mass if no mass is known either. The `terms` beside the law are given
    /// by name, as a fit has it (`quadratic_damping_per_mass`) or without the last two words for what belongs to the
    /// mass (`damping`, in N s/m).
    ///
    /// # Errors
    /// [`IdentifyError::Missing`] and [`IdentifyError::UnknownName`] for values that are missing or belong to nothing,
    /// [`IdentifyError::OutOfRange`] for those outside their bounds.
    pub fn new(
        machine: Machine,
        candidate: &Candidate,
        frequency: f64,
        law: &[f64],
        terms: &[(&str, f64)],
    ) -> Result<Self, IdentifyError> {
        ModelError::require_positive("natural frequency", frequency, "Hz")?;
        let model = candidate.with_breakaway();
        let family = model.law;
        if law.len() != family.parameters.len() {
            let names: Vec<&str> = family.parameters.iter().map(|one| one.parameter().name()).collect();
            return Err(IdentifyError::missing(format!(
                "{} values of {} are given, but it has {}: {}",
                law.len(),
                family.name,
                names.len(),
                names.join(", ")
            )));
        }
        let per_mass_of_unit = local::mass_of(&machine, frequency).unwrap_or(1.0);
        let load = machine.normal_load().map_or(1.0, |load| load.value());
        let (mut values, to_fitted) = match machine.scale() {
            Scale::Unknown => {
                return Err(IdentifyError::contradiction(
                    "a guess cannot begin with a machine of unknown mass and stiffness: give one of them, or describe \
                     the machine per unit mass",
                ));
            }
            _ => (vec![frequency], load / per_mass_of_unit),
        };
        candidate.terms.require_vibration()?;
        let known: Vec<Parameter> = candidate.terms.parameters(&Unit::of("m")).collect();
        let named = known.iter().map(|parameter| {
            let name = parameter.name();
            let plain = name.strip_suffix("_per_mass");
            let exactly = terms.iter().find(|(given, _)| *given == name).map(|(_, value)| *value);
            let by_mass = terms.iter().find(|(given, _)| Some(*given) == plain);
            if let (Some(plain), Some(_), Some(_)) = (plain, exactly, by_mass) {
                return Err(IdentifyError::contradiction(format!("{name} is given twice, once as {plain}")));
            }
            let held = || candidate.terms.held().find(|(held, _)| *held == name).map(|(_, value)| value);
            exactly.or_else(|| by_mass.map(|(_, value)| value / per_mass_of_unit)).or_else(held).ok_or_else(|| {
                IdentifyError::missing(format!("{} has no value for {name}: give one", candidate.name()))
            })
        });
        values.extend(named.collect::<Result<Vec<f64>, _>>()?);
        let is_known = |given: &str| {
            known.iter().any(|one| one.name() == given || one.name().strip_suffix("_per_mass") == Some(given))
        };
        if let Some((given, _)) = terms.iter().find(|(given, _)| !is_known(given)) {
            let names: Vec<&str> = known.iter().map(Parameter::name).collect();
            let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            return Err(IdentifyError::UnknownName {
                what: format!(
                    "{} has no term with a value called {given:?}; its values are: {names}",
                    candidate.name()
                ),
            });
        }
        let level = family.level().map_or(0.0, |level| law[level]);
        for (parameter, value) in family.parameters.iter().zip(law) {
            // A refusal of a derived value would have a name and a number that nobody gave.
            let (name, bounds) = (parameter.parameter().name(), parameter.parameter().bounds());
            let subject = format!("the guess of {name}");
            if !(value.is_finite() && bounds.contains(*value)) {
                return Err(IdentifyError::not_allowed(&subject, *value, &bounds.to_string()));
            }
            if matches!(parameter.role(), Role::LevelAbove | Role::Breakaway) && *value < level {
                let allowed = format!("at least {}, the level of sliding", Rounded::every_digit(level));
                return Err(IdentifyError::not_allowed(&subject, *value, &allowed));
            }
        }
        values.extend(family.parameters.iter().zip(law).map(|(parameter, value)| match parameter.role() {
            Role::LevelAbove | Role::Breakaway => (value - level) * to_fitted,
            Role::Slope => value * to_fitted,
            role if is_force(role) => value * to_fitted,
            _ => *value,
        }));
        Self::of(machine, model, Unit::of("m"), values)
    }

    /// A `candidate` law on `machine`, which vibrates at `frequency` (Hz) without friction, with values by the names that
    /// a fit gives them, per mass: `friction_per_mass`, `damping_per_mass`. A static level of its own that is not among
    /// them is the sliding one.
    ///
    /// ```
    /// use fmm_identify::design::Guess;
    /// use fmm_identify::{Candidate, Machine};
    ///
    /// let found = [("friction_per_mass", 0.34), ("damping_per_mass", 0.03)];
    /// let guess = Guess::of_findings(Machine::per_unit_mass(), &Candidate::named("coulomb + linear")?, 2.2, &found)?;
    /// assert_eq!(guess.value("damping_per_mass"), Some(0.03));
    /// # Ok::<(), fmm_identify::IdentifyError>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::Missing`] and [`IdentifyError::UnknownName`] for values that are missing or belong to nothing,
    /// [`IdentifyError::OutOfRange`] for those outside their bounds.
    pub fn of_findings(
        machine: Machine,
        candidate: &Candidate,
        frequency: f64,
        found: &[(&str, f64)],
    ) -> Result<Self, IdentifyError> {
        ModelError::require_positive("natural frequency", frequency, "Hz")?;
        let (model, position) = (candidate.with_breakaway(), Unit::of("m"));
        let (_, parameters) = local::layout(&model, &machine, &position, frequency)?;
        let names = || parameters.iter().map(Parameter::name).collect::<Vec<_>>().join(", ");
        if let Some((name, _)) = found.iter().find(|(name, _)| parameters.iter().all(|one| one.name() != *name)) {
            let what =
                format!("{} has no parameter called {name:?}; its parameters are: {}", candidate.name(), names());
            return Err(IdentifyError::UnknownName { what });
        }
        let units = Units::new("m", "N");
        let is_breakaway = |name: &str| {
            let mut own = model.law.parameters.iter().filter(|parameter| parameter.role() == Role::Breakaway);
            own.any(|parameter| units.fitted(parameter, Form::PerMass).name() == name)
        };
        let value = |parameter: &Parameter| match found.iter().find(|(name, _)| *name == parameter.name()) {
            Some((_, value)) => Ok(*value),
            None if parameter.name() == "natural_frequency_hz" => Ok(frequency),
            None if parameter.bounds().is_fixed() => Ok(parameter.bounds().lower()),
            None if is_breakaway(parameter.name()) => Ok(0.0),
            None => Err(IdentifyError::missing(format!(
                "{} has no value for {}: give one",
                candidate.name(),
                parameter.name()
            ))),
        };
        let values = parameters.iter().map(value).collect::<Result<Vec<f64>, _>>()?;
        Self::of(machine, model, position, values)
    }

    /// Result of a pilot experiment: values, their uncertainty, and the information of its `records`, which must be
    /// those of the identification.
    ///
    /// # Errors
    /// Those of [`Problem::of`](crate::Problem::of), and [`IdentifyError::Simulation`].
    pub fn of_pilot(found: &Identification, records: &[Experiment]) -> Result<Self, IdentifyError> {
        let problem = found.problem(records)?;
        let layout = &problem.table;
        let position = layout.units.position.clone();
        let shared = layout.shared;
        let of_fit: Vec<(&str, f64)> =
            found.fit().estimates()[..shared].iter().map(|estimate| (estimate.name(), estimate.value())).collect();
        let (machine, model) = (*found.machine(), found.fitted.model.with_breakaway());
        let (_, parameters) = local::layout(&model, &machine, &position, of_fit[0].1)?;
        // A static level that no ring-down determines begins at the sliding one.
        let value = |parameter: &Parameter| {
            of_fit.iter().find(|(name, _)| *name == parameter.name()).map_or(0.0, |(_, value)| *value)
        };
        let values = parameters.iter().map(value).collect();
        let mut guess = Self::of(machine, model, position, values)?;
        let deviation = found.fit().residual_standard_deviation().unwrap_or(0.0) * found.covariance.inflation;
        let design = |source| local::design_error(found.family().name, source);
        let information = Information::of_problem(&problem, found.fit().values(), shared).map_err(design)?;
        let information = information.scaled(deviation.powi(-2)).map_err(design)?;
        let names: Vec<&str> = of_fit.iter().map(|(name, _)| *name).collect();
        let embedded = local::by_name(&names, &guess.parameters);
        guess.measured = information.transformed(&embedded).map_err(design)?;
        guess.spread = guess.measured.clone();
        Ok(guess)
    }

    /// A law by the values that a fit has, in its order.
    pub(super) fn of(
        machine: Machine,
        model: Candidate,
        position: Unit,
        mut values: Vec<f64>,
    ) -> Result<Self, IdentifyError> {
        let (_, parameters) = local::layout(&model, &machine, &position, values[0])?;
        for (parameter, value) in parameters.iter().zip(&mut values) {
            let bounds = parameter.bounds();
            if bounds.is_fixed() {
                // A fixed value counts, not the guess.
                *value = bounds.lower();
            }
            if !bounds.contains(*value) {
                return Err(IdentifyError::not_allowed(
                    &format!("the guess of {}", parameter.name()),
                    *value,
                    &bounds.to_string(),
                ));
            }
        }
        let nothing = Information::none(parameters.len());
        Ok(Self { machine, model, position, parameters, values, measured: nothing.clone(), spread: nothing })
    }

    /// The same with values that may be off by these standard uncertainties, each by the name that a fit gives to the
    /// value and in its unit: a design may be asked to be good over all of that. Nothing is taken for measured.
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`], and [`IdentifyError::OutOfRange`] unless each is positive.
    pub fn within(mut self, uncertainties: &[(&str, f64)]) -> Result<Self, IdentifyError> {
        for (name, u) in uncertainties {
            let place = self.place(name)?;
            self.spread = self
                .spread
                .with_known(place, *u)
                .map_err(|source| local::design_error(self.model.law_name(), source))?;
        }
        Ok(self)
    }

    /// Parameters that all tests share, as a fit has them.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The values of the parameters, each in its unit.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The value of the parameter of this name, in its unit.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.place(name).ok().map(|place| self.values[place])
    }

    /// `count` draws of the values, from the covariance of the pilot or the given uncertainties; a draw outside the
    /// bounds is put on them. The same `seed` gives the same draws.
    pub fn draws(&self, count: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut draws = self.spread.draws(&self.values, count, seed).unwrap_or_default();
        for draw in &mut draws {
            for (value, parameter) in draw.iter_mut().zip(&self.parameters) {
                *value = parameter.bounds().clamp(*value);
            }
        }
        draws
    }

    fn place(&self, name: &str) -> Result<usize, IdentifyError> {
        let found = self.parameters.iter().position(|parameter| parameter.name() == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.parameters.iter().map(Parameter::name).collect();
            IdentifyError::unknown_parameter(name, &names.join(", "))
        })
    }

    /// A record that says when and in which unit a sensor of this quantity would be read, without values.
    pub(crate) fn blank(&self, quantity: Quantity, rate: f64, samples: usize) -> Result<Record, IdentifyError> {
        let units = Units::new(&self.position.to_string(), "N");
        let unit = match quantity {
            Quantity::Displacement => units.position,
            Quantity::Acceleration => units.acceleration(),
            _ => units.velocity(),
        };
        Ok(Record::sampled(rate, vec![0.0; samples], quantity, unit.to_string())?)
    }
}
