//! The fields of a scenario file. All numbers are in SI units.

use std::error::Error;

use fmm_model::{Damping, Oscillator, Restoring};
use fmm_sim::{Excitation, SimulationError};
use serde::Deserialize;

use super::EngineName;
use super::entries::Entries;

/// A scenario as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a scenario, which is an object")]
pub(crate) struct File {
    #[serde(default)]
    pub(crate) title: String,
    #[serde(default)]
    pub(crate) description: String,
    pub(crate) oscillator: Machine,
    /// Law; none for a machine without friction.
    pub(crate) law: Option<Entries>,
    /// N; with 1 a coefficient is a force.
    #[serde(default = "one")]
    pub(crate) normal_load: f64,
    #[serde(default)]
    pub(crate) excitation: Vec<Drive>,
    #[serde(default)]
    pub(crate) initial: Initial,
    /// Simulated time (s).
    pub(crate) duration: Option<f64>,
    pub(crate) output: Option<Output>,
    #[serde(default)]
    pub(crate) engine: EngineName,
    pub(crate) tolerance: Option<f64>,
}

/// The machine.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Machine {
    /// kg.
    mass: f64,
    /// N/m.
    stiffness: f64,
    #[serde(default)]
    damping: Drag,
    #[serde(default)]
    restoring: Spring,
}

/// The damping of the machine: parts that add up.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Drag {
    /// N s/m.
    linear: Option<f64>,
    /// N s²/m².
    quadratic: Option<f64>,
    /// N s³/m³.
    #[serde(default)]
    cubic: f64,
    power: Option<Power>,
    peak_velocity_line: Option<Line>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Power {
    /// N (s/m)^p.
    coefficient: f64,
    exponent: f64,
}

/// Equivalent damping against the peak velocity of a swing.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    /// N s/m.
    intercept: f64,
    /// N s²/m².
    slope: f64,
}

/// Restoring force over the position.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum Spring {
    #[default]
    Linear,
    Sine {
        /// m, or 1 for an angle.
        #[serde(default = "one")]
        length: f64,
    },
    Polynomial {
        /// k₃ (1/m²).
        cubic: f64,
        /// k₅ (1/m⁴).
        #[serde(default)]
        quintic: f64,
    },
    Stop {
        /// m.
        distance: f64,
        /// Stiffness beyond the stop as a multiple of that before it.
        ratio: f64,
    },
    Gap {
        /// m, on either side.
        gap: f64,
    },
}

impl Machine {
    /// The oscillator of these numbers.
    ///
    /// # Errors
    /// Text on two descriptions of one damping, or on a number that cannot be.
    pub(crate) fn oscillator(&self) -> Result<Oscillator, Box<dyn Error>> {
        let drag = &self.damping;
        let damping = match &drag.peak_velocity_line {
            Some(_) if drag.linear.is_some() || drag.quadratic.is_some() => {
                return Err(
                    "damping is given by linear and quadratic, or by peak_velocity_line, which stands for both; not by \
                     both ways"
                        .into(),
                );
            }
            Some(line) => Damping::from_peak_velocity_line(line.intercept, line.slope)?,
            None => Damping::new(drag.linear.unwrap_or(0.0), drag.quadratic.unwrap_or(0.0))?,
        };
        let damping = damping.with_cubic(drag.cubic)?;
        let damping = match &drag.power {
            Some(power) => damping.with_power(power.coefficient, power.exponent)?,
            None => damping,
        };
        let restoring = match self.restoring {
            Spring::Linear => Restoring::Linear,
            Spring::Sine { length } => Restoring::sine(length)?,
            Spring::Polynomial { cubic, quintic } => Restoring::polynomial(cubic, quintic)?,
            Spring::Stop { distance, ratio } => Restoring::stop(distance, ratio)?,
            Spring::Gap { gap } => Restoring::gap(gap)?,
        };
        Ok(Oscillator::new(self.mass, self.stiffness)?.with_damping(damping).with_restoring(restoring))
    }
}

/// Action from outside.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub(crate) enum Drive {
    /// Measured values (N), one every `interval` (s), straight lines between them.
    SampledForce {
        interval: f64,
        values: Vec<f64>,
        #[serde(default)]
        delay: f64,
    },
    /// A blow of `peak` (N) and `duration` (s).
    HalfSine {
        peak: f64,
        duration: f64,
        #[serde(default)]
        delay: f64,
    },
    /// A constant `force` (N).
    Constant {
        force: f64,
        #[serde(default)]
        delay: f64,
    },
    /// A force that grows by `rate` (N/s).
    Ramp {
        rate: f64,
        #[serde(default)]
        delay: f64,
    },
    /// `amplitude` cos(`angular_frequency` t + `phase`) (N, rad/s, rad).
    Harmonic {
        amplitude: f64,
        angular_frequency: f64,
        #[serde(default)]
        phase: f64,
    },
    /// A base displaced by `amplitude` cos(`angular_frequency` t + `phase`) (m, rad/s, rad).
    Base {
        amplitude: f64,
        angular_frequency: f64,
        #[serde(default)]
        phase: f64,
    },
    /// A counterface that moves with `velocity` (m/s).
    Belt { velocity: f64 },
}

impl Drive {
    /// The excitation of these numbers.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] for a number that cannot be, [`SimulationError::OutOfRange`] for a list without
    /// one.
    pub(crate) fn excitation(self) -> Result<Excitation, SimulationError> {
        match self {
            Self::SampledForce { values, .. } if values.is_empty() => Err(SimulationError::OutOfRange {
                what: "a sampled force needs one value or more, but has none".to_owned(),
                value: 0.0,
            }),
            Self::SampledForce { interval, values, delay } => {
                Excitation::sampled_force(interval, values)?.delayed(delay)
            }
            Self::HalfSine { peak, duration, delay } => Excitation::half_sine(peak, duration)?.delayed(delay),
            Self::Constant { force, delay } => Excitation::constant(force)?.delayed(delay),
            Self::Ramp { rate, delay } => Excitation::ramp(rate)?.delayed(delay),
            Self::Harmonic { amplitude, angular_frequency, phase } => {
                Excitation::harmonic(amplitude, angular_frequency, phase)
            }
            Self::Base { amplitude, angular_frequency, phase } => Excitation::base(amplitude, angular_frequency, phase),
            Self::Belt { velocity } => Excitation::belt(velocity),
        }
    }

    /// The velocity (m/s) that it gives to the counterface.
    pub(crate) const fn belt(&self) -> f64 {
        match self {
            Self::Belt { velocity } => *velocity,
            _ => 0.0,
        }
    }
}

/// The state at t = 0.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Initial {
    /// m.
    #[serde(default)]
    pub(crate) position: f64,
    /// m/s.
    #[serde(default)]
    pub(crate) velocity: f64,
}

/// Times at which the motion is sampled.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub(crate) enum Output {
    /// Samples at these times (s).
    Times(Vec<f64>),
    /// Samples at this rate (1/s), from 0 to the duration.
    Rate(f64),
}

fn one() -> f64 {
    1.0
}
