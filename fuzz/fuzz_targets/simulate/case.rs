//! A scenario out of bytes: machine, contact, causes of motion, samples and engine.

use arbitrary::Arbitrary;
use fmm_model::{Damping, Oscillator, Restoring, Scalar};
use fmm_sim::{Channels, Excitation, Sampling, Scenario, SimulationError};

use crate::number::{Number, Signed};

/// All that a simulation needs but the law.
#[derive(Debug, Clone, Arbitrary)]
pub(crate) struct Case {
    mass: Number,
    stiffness: Number,
    linear: Number,
    rest_of_damping: Option<[Number; 4]>,
    pendulum: Option<Number>,
    normal_load: Number,
    position: Signed,
    velocity: Signed,
    causes: [Option<Cause>; 3],
    times: Times,
    channels: u8,
    pub(crate) engine: Choice,
    pub(crate) law: Contact,
}

/// Which engine runs a law that several take.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub(crate) enum Choice {
    /// The one that suits the law.
    Natural,
    /// Runge-Kutta with a tolerance between 1e-15 and 1e-2.
    RungeKutta(u8),
    Moreau(u8),
    Thesis(u8),
    /// The one that suits the law, with derivatives.
    Gradient,
}

/// A law and its numbers, more than any law has.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub(crate) struct Contact {
    pub(crate) law: Law,
    pub(crate) numbers: [Number; 8],
}

#[derive(Debug, Clone, Copy, Arbitrary)]
pub(crate) enum Law {
    Viscous,
    Coulomb,
    CoulombStatic,
    CoulombViscous,
    AccelerationCoulomb,
    MaxwellSlip,
    Stribeck,
    StribeckLorentzian,
    Hyperbolic,
    Berger,
    PowerLaw,
    ExponentialPair,
    Karnopp,
    MakkarDixon,
    ShiftedMakkarDixon,
    RegularisedStribeck,
    Smoothed,
    Dahl,
    LuGre,
    BoucWen,
    Gms,
}

#[derive(Debug, Clone, Copy, Arbitrary)]
enum Cause {
    Sampled { interval: Number, values: [Signed; 5], count: u8, delay: Option<Number> },
    HalfSine { peak: Signed, duration: Number, delay: Option<Number> },
    Ramp { rate: Signed, delay: Option<Number> },
    Harmonic { amplitude: Signed, angular: Number, phase: Signed },
    Base { amplitude: Signed, angular: Number, phase: Signed },
    Belt { velocity: Signed },
}

#[derive(Debug, Clone, Copy, Arbitrary)]
enum Times {
    /// So many samples, that many to a period of the machine.
    Periods {
        count: u16,
        per_period: u8,
    },
    Uniform {
        count: u16,
        interval: Number,
    },
    At([Number; 4]),
}

/// Most samples of a run.
const SAMPLES: usize = 2000;

impl Case {
    fn numbers(&self) -> Vec<Number> {
        let mut numbers = vec![self.mass, self.stiffness, self.linear, self.normal_load];
        numbers.extend([self.position.magnitude, self.velocity.magnitude]);
        numbers.extend(self.rest_of_damping.iter().flatten());
        numbers.extend(self.pendulum);
        numbers.extend(self.law.numbers);
        for cause in self.causes.iter().flatten() {
            match *cause {
                Cause::Sampled { interval, values, .. } => {
                    numbers.push(interval);
                    numbers.extend(values.map(|value| value.magnitude));
                }
                Cause::HalfSine { peak, duration, .. } => numbers.extend([peak.magnitude, duration]),
                Cause::Ramp { rate, .. } => numbers.push(rate.magnitude),
                Cause::Harmonic { amplitude, angular, phase } | Cause::Base { amplitude, angular, phase } => {
                    numbers.extend([amplitude.magnitude, angular, phase.magnitude]);
                }
                Cause::Belt { velocity } => numbers.push(velocity.magnitude),
            }
        }
        numbers
    }

    /// True if derivatives stay within the range of the number type.
    pub(crate) fn is_everyday(&self) -> bool {
        self.numbers().into_iter().all(Number::is_everyday) && !matches!(self.times, Times::Uniform { .. })
    }

    /// The scenario with `law` in the contact; stiffness and normal load are the variables of a gradient.
    pub(crate) fn scenario<D: Scalar, L>(&self, law: L) -> Result<Scenario<D, L>, SimulationError> {
        let number = |number: Number| D::from(number.value());
        let mut damping = Damping::linear(number(self.linear))?;
        if let Some([quadratic, cubic, power, exponent]) = self.rest_of_damping {
            damping = Damping::new(number(self.linear), number(quadratic))?
                .with_cubic(number(cubic))?
                .with_power(number(power), D::from(exponent.positive()))?;
        }
        let mut machine = Oscillator::new(D::from(self.mass.positive()), D::variable(self.stiffness.positive(), 0))?
            .with_damping(damping);
        if let Some(length) = self.pendulum {
            machine = machine.with_restoring(Restoring::sine(D::from(length.positive()))?);
        }
        let mut scenario = Scenario::new(machine, law, D::variable(self.normal_load.value(), 1))?
            .starting_at(D::from(self.position.value()), D::from(self.velocity.value()))?;
        for cause in self.causes.iter().flatten() {
            scenario = scenario.driven_by(cause.excitation()?);
        }
        Ok(scenario)
    }

    pub(crate) fn sampling(&self, needs_uniform: bool) -> Result<Sampling, SimulationError> {
        let count = |count: u16| 1 + usize::from(count) % SAMPLES;
        let uniform = |samples: u16, per_period: u8| {
            let period = 6.3 * (self.mass.positive() / self.stiffness.positive()).sqrt();
            Sampling::uniform(period / f64::from(per_period.max(4)), count(samples))
        };
        let sampling = match self.times {
            Times::Periods { count, per_period } => uniform(count, per_period)?,
            Times::Uniform { count: samples, interval } => Sampling::uniform(interval.positive(), count(samples))?,
            Times::At(_) if needs_uniform => uniform(20, 20)?,
            Times::At(times) => {
                let mut times = times.map(Number::value);
                times.sort_by(f64::total_cmp);
                Sampling::at(times.to_vec())?
            }
        };
        let channels =
            [Channels::Both, Channels::Position, Channels::Velocity, Channels::All][usize::from(self.channels % 4)];
        let sampling = sampling.keeping(channels);
        Ok(if self.channels & 64 == 0 { sampling } else { sampling.with_work() })
    }
}

impl Cause {
    fn excitation<D: Scalar>(&self) -> Result<Excitation<D>, SimulationError> {
        let number = |signed: Signed| D::from(signed.value());
        let later = |excitation: Excitation<D>, delay: Option<Number>| match delay {
            Some(delay) => excitation.delayed(D::from(delay.value())),
            None => Ok(excitation),
        };
        match *self {
            Self::Sampled { interval, values, count, delay } => {
                let values = &values[..usize::from(count) % 6];
                let values: Vec<D> = values.iter().map(|value| D::from(value.value())).collect();
                later(Excitation::sampled_force(interval.positive(), values)?, delay)
            }
            Self::HalfSine { peak, duration, delay } => {
                later(Excitation::half_sine(number(peak), D::from(duration.positive()))?, delay)
            }
            Self::Ramp { rate, delay } => later(Excitation::ramp(number(rate))?, delay),
            Self::Harmonic { amplitude, angular, phase } => {
                Excitation::harmonic(number(amplitude), D::from(angular.value()), number(phase))
            }
            Self::Base { amplitude, angular, phase } => {
                Excitation::base(number(amplitude), D::from(angular.value()), number(phase))
            }
            Self::Belt { velocity } => Excitation::belt(number(velocity)),
        }
    }
}
