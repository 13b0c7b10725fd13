//! The laws by their names: how each moves a machine, and its friction over the speed.

use fmm_friction::{
    AccelerationCoulomb, Berger, BoucWen, Coulomb, CoulombStatic, CoulombViscous, Dahl, ExponentialPair, Hyperbolic,
    Karnopp, LawFamily, LawParameter, LuGre, MakkarDixon, PowerLaw, RegularisedStribeck, Role, ShiftedMakkarDixon,
    SlidingLaw, Stribeck, StribeckLorentzian, Viscous,
};
use fmm_model::Oscillator;
use fmm_sim::{Sampling, Scenario, Trajectory, simulate_into};

use super::Found;

/// The levels by which a law is judged, without its viscous part (1).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Levels {
    /// At rest: the static level, or the highest level near rest of a law that creeps.
    pub(crate) rest: f64,
    /// At the peak speed, while the speed falls.
    pub(crate) peak: f64,
    /// Far beyond it: the level that a falling law tends to.
    pub(crate) beyond: f64,
}

impl Levels {
    /// The same `level` at all speeds.
    pub(crate) fn constant(level: f64) -> Self {
        Self { rest: level, peak: level, beyond: level }
    }

    /// All levels times `factor`.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { rest: self.rest * factor, peak: self.peak * factor, beyond: self.beyond * factor }
    }

    /// True if the friction is the same at all speeds.
    pub(crate) fn is_constant(self) -> bool {
        self.rest == self.peak
    }
}

/// A speed beyond all others, in peak speeds.
const BEYOND: f64 = 1e6;

/// A law family by its name.
#[derive(Debug)]
pub(crate) struct Law {
    pub(crate) name: &'static str,
    pub(crate) parameters: &'static [LawParameter],
    simulate: fn(Oscillator, &[f64], f64, f64, &Sampling) -> Found<Trajectory>,
    levels: fn(&[f64], f64) -> Option<Levels>,
}

/// The motion of an oscillator under the law of these `values` and a `load` (N), let go at `release` (m).
fn simulate<F: LawFamily>(
    oscillator: Oscillator,
    values: &[f64],
    load: f64,
    release: f64,
    sampling: &Sampling,
) -> Found<Trajectory> {
    let scenario = Scenario::new(oscillator, F::at::<f64>(values)?, load)?.starting_at(release, 0.0)?;
    let mut trajectory = Trajectory::new();
    simulate_into::<F, _>(&scenario, sampling, None, &mut trajectory)?;
    Ok(trajectory)
}

/// Levels of a law of the sliding speed.
fn sliding<F: LawFamily>(values: &[f64], peak_speed: f64) -> Option<Levels>
where
    F::At<f64>: SlidingLaw<f64>,
{
    let law = F::at::<f64>(values).ok()?;
    let at = |speed| law.coefficient_losing_speed(speed);
    Some(Levels { rest: law.coefficient(0.0), peak: at(peak_speed), beyond: at(BEYOND * peak_speed) })
}

/// Levels of a law of the sliding speed that begins at zero.
fn creeping<F: LawFamily>(values: &[f64], peak_speed: f64) -> Option<Levels>
where
    F::At<f64>: SlidingLaw<f64>,
{
    const STEPS: u32 = 1000;
    let law = F::at::<f64>(values).ok()?;
    let speeds = (1..=STEPS).map(|step| peak_speed * (f64::from(step) / f64::from(STEPS)).powi(2));
    let rest = speeds.map(|speed| law.coefficient(speed)).fold(0.0, f64::max);
    let at = |speed| law.coefficient_losing_speed(speed);
    Some(Levels { rest, peak: at(peak_speed), beyond: at(BEYOND * peak_speed) })
}

/// Levels of steady sliding of a law with internal state.
fn with_state<F: LawFamily>(values: &[f64], peak_speed: f64) -> Option<Levels> {
    let law = F::at::<f64>(values).ok()?;
    let at = |speed| F::steady_coefficient(&law, speed, true);
    Some(Levels { rest: at(0.0)?, peak: at(peak_speed)?, beyond: at(BEYOND * peak_speed)? })
}

/// Every law that a record can be made with.
const LAWS: &[Law] = &[
    Law::of::<Viscous>(sliding::<Viscous>),
    Law::of::<Coulomb>(sliding::<Coulomb>),
    Law::of::<CoulombStatic>(sliding::<CoulombStatic>),
    Law::of::<CoulombViscous>(sliding::<CoulombViscous>),
    Law::of::<AccelerationCoulomb>(sliding::<AccelerationCoulomb>),
    Law::of::<Stribeck>(sliding::<Stribeck>),
    Law::of::<StribeckLorentzian>(sliding::<StribeckLorentzian>),
    Law::of::<Hyperbolic>(sliding::<Hyperbolic>),
    Law::of::<Berger>(sliding::<Berger>),
    Law::of::<PowerLaw>(sliding::<PowerLaw>),
    Law::of::<ExponentialPair>(sliding::<ExponentialPair>),
    Law::of::<Karnopp>(sliding::<Karnopp>),
    Law::of::<ShiftedMakkarDixon>(sliding::<ShiftedMakkarDixon>),
    Law::of::<MakkarDixon>(creeping::<MakkarDixon>),
    Law::of::<RegularisedStribeck>(creeping::<RegularisedStribeck>),
    Law::of::<Dahl>(with_state::<Dahl>),
    Law::of::<BoucWen>(with_state::<BoucWen>),
    Law::of::<LuGre>(with_state::<LuGre>),
];

impl Law {
    const fn of<F: LawFamily>(levels: fn(&[f64], f64) -> Option<Levels>) -> Self {
        Self { name: F::NAME, parameters: F::PARAMETERS, simulate: simulate::<F>, levels }
    }

    /// The law called `name`, of which terms and what is held are no part; none if there is no such law.
    pub(crate) fn named(name: &str) -> Option<&'static Self> {
        let name = name.split(['+', ',']).next()?.trim();
        LAWS.iter().find(|law| law.name == name)
    }

    /// The motion of `oscillator` under the law of these `values` and a `load` (N), let go at `release` (m).
    pub(crate) fn simulate(
        &self,
        oscillator: Oscillator,
        values: &[f64],
        load: f64,
        release: f64,
        sampling: &Sampling,
    ) -> Found<Trajectory> {
        (self.simulate)(oscillator, values, load, release, sampling)
    }

    /// Levels of the law of these `values` at rest and at `peak_speed` (m/s).
    pub(crate) fn levels(&self, values: &[f64], peak_speed: f64) -> Option<Levels> {
        let dry =
            |(parameter, value): (&LawParameter, &f64)| if parameter.role() == Role::Slope { 0.0 } else { *value };
        let values: Vec<f64> = self.parameters.iter().zip(values).map(dry).collect();
        (self.levels)(&values, peak_speed)
    }

    /// The viscous part of the law of these `values` (s/m).
    pub(crate) fn slope(&self, values: &[f64]) -> f64 {
        let slopes = self.parameters.iter().zip(values).filter(|(parameter, _)| parameter.role() == Role::Slope);
        slopes.map(|(_, value)| value).sum()
    }

    /// Values for all parameters from those that a record is fitted by: static levels are the sliding level, and a
    /// level that may not lie below another is that with what it is above it.
    pub(crate) fn of_fitted(&self, fitted: &[f64]) -> Option<Vec<f64>> {
        let level = self.fitted().position(|parameter| parameter.role() == Role::Level);
        let level = level.and_then(|level| fitted.get(level)).copied().unwrap_or(0.0);
        let mut fitted = fitted.iter().copied();
        let value = |parameter: &LawParameter| match parameter.role() {
            Role::Breakaway => Some(level),
            Role::LevelAbove => fitted.next().map(|excess| level + excess),
            _ => fitted.next(),
        };
        self.parameters.iter().map(value).collect()
    }

    /// The parameters that a record is fitted by.
    pub(crate) fn fitted(&self) -> impl Iterator<Item = &'static LawParameter> + use<> {
        self.parameters.iter().filter(|parameter| parameter.role() != Role::Breakaway)
    }
}
