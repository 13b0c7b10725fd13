//! Model of a force along a motion.

use fmm_model::{Bounds, Parameter, Unit};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::force::ForceRecord;
use crate::law::naming::{Level, Units};
use crate::machine::terms::Term;

/// What a force along a motion is made of: a law, damping beside it, and what else acts or is measured along.
///
/// ```text
/// F(t + τ) = (N + N₀) (µ + a |µ|) + c v + c₂ |v| v + c₃ v³ + m v' + k x + A sin x + B cos x + F₀ + Σ κᵢ yᵢ(t + τ)
/// ```
///
/// µ is the law, with the sign of the velocity; N is 1 without a measured load, so that levels are forces. A force
/// record tells the levels of the two directions apart, a = (F₊ − F₋)/(F₊ + F₋), which a ring-down does not: there they
/// are a level and a force that moves the rest position. yᵢ are what was measured beside the force,
/// [`ForceRecord::with_channel`].
///
/// ```
/// use fmm_identify::ForceModel;
///
/// let model = ForceModel::named("dahl + linear + zero + gravity")?;
/// assert_eq!(model.name(), "dahl + linear + zero + gravity");
/// assert_eq!(ForceModel::named("coulomb")?.with_zero().with_inertia().name(), "coulomb + zero + inertia");
/// assert!(ForceModel::named("coulomb + cubic spring").is_err());
/// # Ok::<(), fmm_identify::IdentifyError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ForceModel {
    pub(crate) law: Candidate,
    has: [bool; Part::ALL.len()],
    /// The longest delay to be looked for (s); `None` for twenty samples.
    longest: Option<f64>,
}

/// What acts or is measured beside friction and damping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Zero,
    Inertia,
    Stiffness,
    Gravity,
    Asymmetry,
    LoadOffset,
    Channels,
    Delay,
}

impl Part {
    const ALL: [Self; 8] = [
        Self::Zero,
        Self::Inertia,
        Self::Stiffness,
        Self::Gravity,
        Self::Asymmetry,
        Self::LoadOffset,
        Self::Channels,
        Self::Delay,
    ];

    /// The word by which a model has it, after a plus sign.
    const fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Inertia => "inertia",
            Self::Stiffness => "stiffness",
            Self::Gravity => "gravity",
            Self::Asymmetry => "asymmetry",
            Self::LoadOffset => "load offset",
            Self::Channels => "channels",
            Self::Delay => "delay",
        }
    }
}

/// Samples of delay that are looked for unless it is said otherwise.
const SAMPLES_OF_DELAY: f64 = 20.0;

impl ForceModel {
    /// Friction by `law`, with the damping that stands beside it.
    ///
    /// # Errors
    /// [`IdentifyError::Contradiction`] for a term of a spring, as the part `stiffness` is the spring of a force
    /// record, and for damping with a free power, as that is a law.
    pub fn of(law: Candidate) -> Result<Self, IdentifyError> {
        if law.terms().has_spring() {
            return Err(IdentifyError::contradiction(
                "a spring that is not linear is a term of free vibrations; a force along a motion takes the part stiffness",
            ));
        }
        if law.terms().has(Term::PowerDamping) {
            return Err(IdentifyError::contradiction(
                "damping with a free power is a term of free vibrations; a force along a motion takes the law power_law",
            ));
        }
        if law.terms().has_linear_damping() && law.law().has_slope() {
            return Err(IdentifyError::two_dampings(law.law_name()));
        }
        Ok(Self { law, has: [false; Part::ALL.len()], longest: None })
    }

    /// The model called so: a law of the [catalogue](Candidate::catalogue), then after plus signs terms of damping
    /// (`linear`, `quadratic`, `cubic`, `any sign`) and parts (`zero`, `inertia`, `stiffness`, `gravity`, `asymmetry`,
    /// `load offset`, `channels`, `delay`).
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`], with the names there are, and as for [`of`](Self::of).
    pub fn named(name: &str) -> Result<Self, IdentifyError> {
        let part = |word: &str| Part::ALL.into_iter().find(|part| part.name() == word.trim().replace('_', " "));
        let law: Vec<&str> = name.split('+').filter(|word| part(word).is_none()).collect();
        let candidate = Candidate::named(&law.join("+")).map_err(|error| match error {
            IdentifyError::UnknownName { what } => {
                let parts = Part::ALL.map(Part::name).join(", ");
                IdentifyError::UnknownName { what: format!("{what}; parts of a force are: {parts}") }
            }
            other => other,
        })?;
        let model = Self::of(candidate)?;
        Ok(name.split('+').filter_map(part).fold(model, Self::with))
    }

    fn with(mut self, part: Part) -> Self {
        self.has[part as usize] = true;
        self
    }

    /// The same with a zero of the force, F₀.
    #[must_use]
    pub fn with_zero(self) -> Self {
        self.with(Part::Zero)
    }

    /// The same with the inertia m v' of what moves between the sensor and the contact.
    #[must_use]
    pub fn with_inertia(self) -> Self {
        self.with(Part::Inertia)
    }

    /// The same with a stiffness k x.
    #[must_use]
    pub fn with_stiffness(self) -> Self {
        self.with(Part::Stiffness)
    }

    /// The same with gravity on a joint, A sin x + B cos x, for angles x in rad.
    #[must_use]
    pub fn with_gravity(self) -> Self {
        self.with(Part::Gravity)
    }

    /// The same with levels that differ by direction.
    #[must_use]
    pub fn with_asymmetry(self) -> Self {
        self.with(Part::Asymmetry)
    }

    /// The same with a load N₀ (N) beside the measured one, which is friction that does not depend on the load.
    #[must_use]
    pub fn with_load_offset(self) -> Self {
        self.with(Part::LoadOffset)
    }

    /// The same with shares κᵢ of all [channels](ForceRecord::with_channel) that were measured beside the force.
    #[must_use]
    pub fn with_channels(self) -> Self {
        self.with(Part::Channels)
    }

    /// The same with a delay τ (s) of the force behind the motion, positive or negative, of at most twenty samples.
    #[must_use]
    pub fn with_delay(self) -> Self {
        self.with(Part::Delay)
    }

    /// The same with a delay of the force of at most `longest` (s), positive or negative.
    ///
    /// # Errors
    /// [`IdentifyError::OutOfRange`] if it is not positive and finite.
    pub fn with_delay_up_to(mut self, longest: f64) -> Result<Self, IdentifyError> {
        if !(longest > 0.0 && longest.is_finite()) {
            return Err(IdentifyError::not_allowed("the longest delay of a force (s)", longest, "positive"));
        }
        self.longest = Some(longest);
        Ok(self.with(Part::Delay))
    }

    /// The same with the fitted parameter called `name` held at `value`, in the unit in which it would be fitted.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] if the value is not finite.
    pub fn holding(mut self, name: &str, value: f64) -> Result<Self, IdentifyError> {
        self.law = self.law.holding(name, value)?;
        Ok(self)
    }

    /// Name of the law with the terms and parts beside it.
    pub fn name(&self) -> String {
        let mut name = self.law.name();
        let held = name.find(',').map_or_else(String::new, |at| name.split_off(at));
        for part in self.parts() {
            name.push_str(" + ");
            name.push_str(part.name());
        }
        name + &held
    }

    /// Whether this model is a special case of `other`: some values of the parameters of `other` make it this one.
    pub(crate) fn is_nested_in(&self, other: &Self) -> bool {
        let law = self.law.is_nested_in(&other.law);
        let parts = Part::ALL.iter().filter(|part| self.has(**part) != other.has(**part));
        let mut added = parts.map(|part| other.has(*part)).peekable();
        (law || self.law.name() == other.law.name() && added.peek().is_some()) && added.all(|is_added| is_added)
    }

    fn parts(&self) -> impl Iterator<Item = Part> {
        Part::ALL.into_iter().filter(|part| self.has[*part as usize])
    }

    /// Whether `part` is fitted.
    pub(crate) fn has(&self, part: Part) -> bool {
        self.has[part as usize]
    }

    /// The longest delay (s) that is looked for in `records`.
    pub(crate) fn longest_delay(&self, records: &[ForceRecord]) -> f64 {
        if !self.has(Part::Delay) {
            return 0.0;
        }
        let shortest = records.iter().map(ForceRecord::interval).fold(f64::INFINITY, f64::min);
        self.longest.unwrap_or(SAMPLES_OF_DELAY * shortest)
    }

    /// The same with as long a delay for other records as for `records`.
    pub(crate) fn settled(&self, records: &[ForceRecord]) -> Self {
        Self { longest: Some(self.longest_delay(records)), ..self.clone() }
    }

    /// Whether the deflection of the bristles at the beginning of each record is fitted.
    pub(crate) fn fits_deflections(&self) -> bool {
        !self.law.law().is_of_speed()
    }

    /// The parameters of a fit to `records`: those of the law, then [`shapes`](Self::shapes), asymmetry, load, delay
    /// and deflections.
    pub(crate) fn parameters(&self, records: &[ForceRecord]) -> Result<Vec<Parameter>, IdentifyError> {
        let law = self.law.law();
        law.require_units()?;
        let (units, level) = naming(records);
        let mut parameters: Vec<Parameter> = law.fitted().map(|parameter| units.fitted(parameter, level)).collect();
        for shape in self.shapes(&records[0]) {
            parameters.push(shape.parameter(&units, &records[0], self.law.terms().are_of_any_sign()));
        }
        for part in self.parts() {
            match part {
                Part::Asymmetry => {
                    let bounds = Bounds::new(-1.0, 1.0)?;
                    parameters.push(Parameter::new("asymmetry", "a", "1").bounded(bounds));
                }
                Part::LoadOffset => parameters.push(Parameter::new("load_offset", "N₀", "N")),
                Part::Delay => {
                    let longest = self.longest_delay(records);
                    parameters.push(Parameter::new("delay", "τ", "s").bounded(Bounds::new(-longest, longest)?));
                }
                _ => {}
            }
        }
        if self.fits_deflections() {
            for record in 1..=records.len() {
                let number = if records.len() == 1 { String::new() } else { format!("_{record}") };
                let deflection = Parameter::named(format!("initial_deflection{number}"), "z₀/z_max", "1");
                parameters.push(deflection.bounded(Bounds::new(-1.0, 1.0)?));
            }
        }
        for (name, value) in self.law.terms().held() {
            let Some(parameter) = parameters.iter_mut().find(|parameter| parameter.name() == name) else {
                let known: Vec<&str> = parameters.iter().map(Parameter::name).collect();
                return Err(IdentifyError::unknown_parameter(name, &known.join(", ")));
            };
            if !parameter.bounds().contains(value) {
                let (lower, upper) = (parameter.bounds().lower(), parameter.bounds().upper());
                return Err(IdentifyError::held_out_of_bounds(name, value, lower, upper));
            }
            *parameter = parameter.clone().bounded(Bounds::new(value, value)?);
        }
        Ok(parameters)
    }

    /// What the force of `record` is proportional to beside the law, in the order of the parameters.
    pub(crate) fn shapes(&self, record: &ForceRecord) -> Vec<Shape> {
        let mut shapes: Vec<Shape> = self.law.terms().iter().map(Shape::Damping).collect();
        for part in self.parts() {
            match part {
                Part::Zero => shapes.push(Shape::Zero),
                Part::Inertia => shapes.push(Shape::Inertia),
                Part::Stiffness => shapes.push(Shape::Stiffness),
                Part::Gravity => shapes.extend([Shape::GravitySine, Shape::GravityCosine]),
                Part::Channels => shapes.extend((0..record.channels.len()).map(Shape::Channel)),
                Part::Asymmetry | Part::LoadOffset | Part::Delay => {}
            }
        }
        shapes
    }
}

/// Units of the motion and of the force in `records`, and what a level of a law is stated as: a force, or, with a load,
/// a coefficient.
pub(crate) fn naming(records: &[ForceRecord]) -> (Units, Level) {
    let level = if records[0].loads.is_none() { Level::Force } else { Level::Coefficient };
    (Units::new(records[0].position_unit(), records[0].force_unit()), level)
}

/// What a part of the force is proportional to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    Damping(Term),
    Zero,
    Inertia,
    Stiffness,
    GravitySine,
    GravityCosine,
    /// What was measured beside the force, by its place.
    Channel(usize),
}

impl Shape {
    /// Its factor, for positions and forces in these units and the channels of `record`.
    fn parameter(self, units: &Units, record: &ForceRecord, any_sign: bool) -> Parameter {
        let Units { position, force } = units;
        let damping = if any_sign { Bounds::UNBOUNDED } else { Bounds::NOT_NEGATIVE };
        let per_speed = |power| (force.per(&units.velocity().power(power)), damping);
        let (name, symbol, (unit, bounds)) = match self {
            Self::Damping(Term::QuadraticDamping) => ("quadratic_damping", "c₂", per_speed(2)),
            Self::Damping(Term::CubicDamping) => ("cubic_damping", "c₃", per_speed(3)),
            Self::Damping(_) => ("damping", "c", per_speed(1)),
            Self::Zero => ("zero", "F₀", (force.clone(), Bounds::UNBOUNDED)),
            Self::Inertia => {
                // An angle is a number here: a torque by an angular acceleration is kg m².
                let force = force.with("N", &Unit::of("kg m/s²"));
                let unit = force.per(&units.acceleration()).with("rad", &Unit::default());
                ("inertia", "m", (unit, Bounds::UNBOUNDED))
            }
            Self::Stiffness => ("stiffness", "k", (force.per(position), Bounds::UNBOUNDED)),
            Self::GravitySine => ("gravity_sine", "A", (force.clone(), Bounds::UNBOUNDED)),
            Self::GravityCosine => ("gravity_cosine", "B", (force.clone(), Bounds::UNBOUNDED)),
            Self::Channel(place) => {
                let name = record.channels[place].0.replace([' ', '-'], "_");
                return Parameter::named(format!("share_of_{name}"), "κ", "1");
            }
        };
        Parameter::named(name, symbol, unit.to_string()).bounded(bounds)
    }

    /// Its value at position `x`, velocity `v` and acceleration `a` with what was measured beside the force, and its
    /// slopes by these three.
    pub(crate) fn at(self, [x, v, a]: [f64; 3], channel: impl Fn(usize) -> f64) -> (f64, [f64; 3]) {
        match self {
            Self::Damping(Term::QuadraticDamping) => (v.abs() * v, [0.0, 2.0 * v.abs(), 0.0]),
            Self::Damping(Term::CubicDamping) => (v * v * v, [0.0, 3.0 * v * v, 0.0]),
            Self::Damping(_) => (v, [0.0, 1.0, 0.0]),
            Self::Zero => (1.0, [0.0; 3]),
            Self::Inertia => (a, [0.0, 0.0, 1.0]),
            Self::Stiffness => (x, [1.0, 0.0, 0.0]),
            Self::GravitySine => (x.sin(), [x.cos(), 0.0, 0.0]),
            Self::GravityCosine => (x.cos(), [-x.sin(), 0.0, 0.0]),
            Self::Channel(place) => (channel(place), [0.0; 3]),
        }
    }
}
