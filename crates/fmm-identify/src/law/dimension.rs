//! Scales of the parameters of a law, by their units.

use fmm_friction::{LawParameter, Role};
use fmm_model::Unit;

use crate::error::IdentifyError;
use crate::law::Law;

/// Factors that part two parameters of equal meaning at the start of a fit (1).
const APART: [f64; 5] = [3.0, 1.5, 1.0, 1.0 / 1.5, 1.0 / 3.0];

/// The scales of the motion in a record, in its units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    /// Largest displacement.
    pub(crate) length: f64,
    /// Largest velocity.
    pub(crate) speed: f64,
    /// F/m of Coulomb friction with the same losses.
    pub(crate) friction: f64,
    /// c/m of the viscous part (1/s).
    pub(crate) damping: f64,
    /// Divisor of the speeds and lengths at which laws bend, for a start in another place (1).
    pub(crate) sharpness: f64,
}

/// Scaling of a parameter of a law beside a force, as powers of position and time. Angles are
/// positions, and a power that is itself a parameter of the law has its typical value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Powers {
    position: f64,
    time: f64,
    /// Unit of the parameter over the SI unit (1).
    factor: f64,
}

impl Powers {
    /// Powers in the unit in which `law` states `parameter`; `None` if it is not known how that unit scales.
    fn of(law: &Law, parameter: &LawParameter) -> Option<Self> {
        let exponent = |symbol: &str| {
            let named = |parameter: &&LawParameter| parameter.parameter().symbol() == symbol;
            law.parameters.iter().find(named).map(LawParameter::typical)
        };
        let unit = Unit::of(parameter.parameter().unit()).dimension(exponent).filter(|unit| unit.mass() == 0.0)?;
        Some(Self { position: unit.length() + unit.angle(), time: unit.time(), factor: unit.factor() })
    }

    /// The power of a speed that it is; `None` if it is none.
    pub(crate) fn of_speed(&self) -> Option<f64> {
        (self.position != 0.0 && self.time == -self.position).then_some(self.position)
    }

    /// The value that stands for a `stiffness` of a parameter that is a force over a length beside it; `None` for
    /// others.
    pub(crate) fn at_stiffness(&self, stiffness: f64) -> Option<f64> {
        (self.position == -1.0 && self.time == 0.0).then(|| stiffness / self.factor)
    }

    /// The value of the parameter that stands for a `speed`.
    pub(crate) fn at_speed(&self, speed: f64) -> f64 {
        speed.powf(self.position) / self.factor
    }
}

impl Law {
    /// Scaling of a parameter of this law; a law with a unit that is not known is refused before.
    pub(crate) fn powers(&self, parameter: &LawParameter) -> Powers {
        Powers::of(self, parameter).unwrap_or(Powers { position: 0.0, time: 0.0, factor: 1.0 })
    }

    /// Refuses a law with a parameter in a unit of which it is not known what it scales with.
    pub(crate) fn require_units(&self) -> Result<(), IdentifyError> {
        let unknown = self.parameters.iter().find(|parameter| Powers::of(self, parameter).is_none());
        unknown.map_or(Ok(()), |parameter| {
            let (law, parameter) = (self.name, parameter.parameter());
            Err(IdentifyError::UnknownName {
                what: format!(
                    "{law} states {} in {}, and a fit does not know where to begin: a unit is made of m, s, rad and \
                     deg, with prefixes and powers",
                    parameter.name(),
                    parameter.unit()
                ),
            })
        })
    }

    /// True if `parameter` says where the law bends, which a fit may have to look for.
    pub(crate) fn bends(&self, parameter: &LawParameter) -> bool {
        let Powers { position, time, .. } = self.powers(parameter);
        parameter.role() != Role::Slope && (position, time) != (0.0, 0.0)
    }

    /// Start values of its [fitted](Self::fitted) parameters: `start`, and others in which two that stand for the same
    /// lie apart. Where these are equal, the law bends once instead of twice, no derivative tells the two, and a fit
    /// that comes near creeps.
    pub(crate) fn apart(&self, start: &[f64]) -> Vec<Vec<f64>> {
        let is_alike = |one: &LawParameter, other: &LawParameter| {
            (one.typical(), one.parameter().unit()) == (other.typical(), other.parameter().unit())
        };
        let bends = |(_, parameter): &(usize, &LawParameter)| parameter.role() == Role::Shape && self.bends(parameter);
        let shapes: Vec<_> = self.fitted().enumerate().filter(bends).collect();
        let pairs = shapes
            .iter()
            .enumerate()
            .flat_map(|(place, one)| shapes[place + 1..].iter().map(move |other| (one, other)));
        let twins: Vec<_> =
            pairs.filter(|(one, other)| is_alike(one.1, other.1)).map(|(one, other)| (one.0, other.0)).collect();
        if twins.is_empty() {
            return vec![start.to_vec()];
        }
        let moved = |factor: f64| {
            let mut start = start.to_vec();
            for (one, other) in &twins {
                start[*one] *= factor;
                start[*other] /= factor;
            }
            start
        };
        APART.map(moved).to_vec()
    }

    /// The power of a record's gain to which `parameter` is proportional.
    pub(crate) fn power_of_gain(&self, parameter: &LawParameter) -> f64 {
        let force = if is_force(parameter.role()) || parameter.role() == Role::Slope { 1.0 } else { 0.0 };
        force + self.powers(parameter).position
    }

    /// The power of a factor on all times to which `parameter` is proportional beside a force, if the record is the
    /// `order`th derivative of the position.
    pub(crate) fn power_of_clock(&self, parameter: &LawParameter, order: f64) -> f64 {
        let Powers { position, time, .. } = self.powers(parameter);
        order * position + time
    }
}

impl Scales {
    /// Start value of a `parameter` of `law`.
    pub(crate) fn typical(&self, law: &Law, parameter: &LawParameter) -> f64 {
        let Powers { position, time, factor } = law.powers(parameter);
        if parameter.role() == Role::Slope {
            return self.damping / factor;
        }
        let force = if is_force(parameter.role()) { self.friction } else { 1.0 };
        let scale = force * self.length.powf(position + time) * self.speed.powf(-time);
        parameter.typical() * scale * self.sharpness.powf(-position) / factor
    }
}

/// True if `role` is proportional to the friction force.
pub(crate) fn is_force(role: Role) -> bool {
    matches!(role, Role::Level | Role::Excess | Role::LevelAbove | Role::Breakaway)
}

/// True if `parameter` is a friction coefficient, a force by the normal load.
pub(crate) fn is_coefficient(parameter: &LawParameter) -> bool {
    let unit = parameter.parameter().unit();
    // Asked for each value of a law: to read a unit takes longer than most laws do.
    is_force(parameter.role()) && (unit == "1" || Unit::of(unit) == Unit::default())
}

#[cfg(test)]
mod tests {
    use fmm_friction::CoulombViscous;
    use fmm_model::{Bounds, Parameter};

    use super::*;

    /// A parameter in `unit`, of a law in which it stands alone.
    const fn alone(unit: &'static str, role: Role) -> LawParameter {
        LawParameter::new(Parameter::new("value", "x", unit).bounded(Bounds::POSITIVE), role).typically(0.5)
    }

    static ALL: [LawParameter; 6] = [
        alone("m/s", Role::Shape),
        alone("mm/s", Role::Shape),
        alone("s/m", Role::Shape),
        alone("s/mm", Role::Shape),
        alone("1/mm", Role::Level),
        alone("s/mm", Role::Slope),
    ];

    fn law() -> Law {
        Law { parameters: &ALL, ..Law::of::<CoulombViscous>() }
    }

    #[test]
    fn fits_begin_at_the_scales_of_the_motion_in_the_unit_of_the_parameter() {
        // Amplitude 0.02 m, 0.8 m/s, friction 3 m/s², viscous 0.25 1/s, bends twice as sharp.
        let scales = Scales { length: 0.02, speed: 0.8, friction: 3.0, damping: 0.25, sharpness: 2.0 };
        let wanted = [0.2, 200.0, 1.25, 1.25e-3, 0.15, 0.25e-3];
        for (parameter, wanted) in ALL.iter().zip(wanted) {
            let found = scales.typical(&law(), parameter);
            assert!((found / wanted - 1.0).abs() < 1e-12, "{}: {found}, {wanted}", parameter.parameter().unit());
        }
    }

    #[test]
    fn a_speed_is_stated_in_the_unit_of_the_parameter() {
        for (parameter, wanted) in ALL.iter().zip([0.8, 800.0, 1.25, 1.25e-3]) {
            let powers = law().powers(parameter);
            assert!(powers.of_speed().is_some());
            assert!((powers.at_speed(0.8) / wanted - 1.0).abs() < 1e-12, "{}", parameter.parameter().unit());
        }
        assert_eq!(law().powers(&ALL[4]).of_speed(), None);
    }

    #[test]
    fn parameters_that_stand_for_the_same_begin_apart() {
        let ratio = |start: Vec<f64>| start[1] / start[4];
        let makkar_dixon = Law::of::<fmm_friction::MakkarDixon>().apart(&[0.1, 50.0, 3.0, 0.2, 50.0, 0.0]);
        assert!(makkar_dixon.iter().all(|start| (start[0], start[2], start[3], start[5]) == (0.1, 3.0, 0.2, 0.0)));
        let ratios: Vec<f64> = makkar_dixon.into_iter().map(ratio).collect();
        assert!(ratios.iter().any(|ratio| *ratio > 2.0) && ratios.iter().any(|ratio| *ratio < 0.5), "{ratios:?}");
        assert_eq!(Law::of::<CoulombViscous>().apart(&[0.1, 0.2]), [[0.1, 0.2]]);
    }

    #[test]
    fn a_gain_scales_lengths_and_forces() {
        let powers = ALL.each_ref().map(|parameter| law().power_of_gain(parameter));
        // A slope is a force per speed, which a gain does not change.
        assert_eq!(powers, [1.0, 1.0, -1.0, -1.0, 0.0, 0.0]);
        // By a record of velocities, a clock leaves speeds as they are.
        let powers = ALL.each_ref().map(|parameter| law().power_of_clock(parameter, 1.0));
        assert_eq!(powers, [0.0, 0.0, 0.0, 0.0, -1.0, 0.0]);
    }
}
