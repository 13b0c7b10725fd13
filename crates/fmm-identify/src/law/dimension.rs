//! What the parameters of a law scale with.

use fmm_friction::{LawParameter, Role};

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
    /// What divides speeds and lengths at which laws bend, to begin a fit in another place.
    pub(crate) sharpness: f64,
}

/// The dimension of a parameter of a law beyond that of a force, as powers of length and speed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Dimension {
    length: f64,
    speed: f64,
}

impl Dimension {
    /// Of a unit as the laws write it; unknown ones are taken as numbers.
    fn of(unit: &str) -> Self {
        let (length, speed) = match unit {
            "m" => (1.0, 0.0),
            "1/m" | "1/m^n" => (-1.0, 0.0),
            "m/s" => (0.0, 1.0),
            "s/m" => (0.0, -1.0),
            // With a typical exponent of one half.
            "(s/m)^p" => (0.0, -0.5),
            _ => (0.0, 0.0),
        };
        Self { length, speed }
    }
}

impl Scales {
    /// Where a fit of `parameter` may begin.
    pub(crate) fn typical(&self, parameter: &LawParameter) -> f64 {
        if parameter.role() == Role::Slope {
            return self.damping;
        }
        let Dimension { length, speed } = Dimension::of(parameter.parameter().unit());
        let force = if is_force(parameter.role()) { self.friction } else { 1.0 };
        let scale = force * self.length.powf(length) * self.speed.powf(speed);
        parameter.typical() * scale * self.sharpness.powf(-(length + speed))
    }
}

/// Whether `role` is proportional to the friction force.
pub(crate) fn is_force(role: Role) -> bool {
    matches!(role, Role::Level | Role::Excess | Role::LevelAbove | Role::Breakaway)
}

/// Whether the law bends at a place of its own, which a fit may have to look for.
pub(crate) fn bends(parameter: &LawParameter) -> bool {
    parameter.role() != Role::Slope && Dimension::of(parameter.parameter().unit()) != Dimension::of("1")
}

/// The power of a record's gain to which `parameter` is proportional.
pub(crate) fn power_of_gain(parameter: &LawParameter) -> f64 {
    let Dimension { length, speed } = Dimension::of(parameter.parameter().unit());
    let force = if is_force(parameter.role()) || parameter.role() == Role::Slope { 1.0 } else { 0.0 };
    force + length + speed
}
