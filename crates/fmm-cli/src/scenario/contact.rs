//! A law whose type is known only at run time, with the engines that take it.

use std::fmt;
use std::rc::Rc;

use fmm_friction::{BristleLaw, LawVisitor, PiecewiseLinearLaw, Regime, SlidingLaw};
use fmm_model::Oscillator;
use fmm_sim::{
    Bristle, Engine, Exact, Excitation, Moreau, RungeKutta, Sampling, Scenario, SimulationError, State, Thesis,
    Trajectory,
};
use serde::{Deserialize, Serialize};

/// The engines that a scenario can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum EngineName {
    /// The one that suits law and machine.
    #[default]
    Auto,
    /// Closed form between events.
    Exact,
    /// Any law of the sliding speed, to a tolerance.
    RungeKutta,
    /// Any law with an internal state, to a tolerance.
    Bristle,
    /// The thesis' semi-implicit Euler, one step a sample.
    Thesis,
    /// Time stepping of the set-valued law, one step a sample.
    Moreau,
}

/// The name in a file.
impl fmt::Display for EngineName {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.serialize(f)
    }
}

/// An engine and how accurate it shall be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Choice {
    pub(crate) engine: EngineName,
    /// Relative tolerance (1); none for the engine's own.
    pub(crate) tolerance: Option<f64>,
}

/// Everything about a scenario but the law.
#[derive(Debug, Clone)]
pub(crate) struct Setting {
    pub(crate) oscillator: Oscillator,
    /// N.
    pub(crate) normal_load: f64,
    pub(crate) initial: State,
    pub(crate) excitations: Vec<Excitation>,
}

impl Setting {
    fn with<L>(&self, law: L) -> Result<Scenario<f64, L>, SimulationError> {
        let State { position, velocity } = self.initial;
        let scenario = Scenario::new(self.oscillator, law, self.normal_load)?.starting_at(position, velocity)?;
        Ok(self.excitations.iter().cloned().fold(scenario, Scenario::driven_by))
    }
}

/// The motion by the chosen engine, which must be one that takes the law.
type Simulate = dyn Fn(&Setting, Choice, &Sampling) -> Result<Trajectory, SimulationError>;

/// Friction coefficient (1) with its sign by velocity (m/s) relative to the counterface, internal states, and whether
/// the speed falls.
type Coefficient = dyn Fn(f64, &[f64], bool) -> f64;

/// A law of any type.
pub(crate) struct Contact {
    /// The engines that take the law.
    pub(crate) engines: &'static [EngineName],
    pub(crate) simulate: Box<Simulate>,
    pub(crate) coefficient: Box<Coefficient>,
    /// The law as one of the sliding speed alone, if it is one.
    pub(crate) sliding: Option<AnySliding>,
}

/// Makes a contact of a law, with the motion by the engine that suits it best.
pub(crate) struct Make<L> {
    pub(crate) law: L,
    pub(crate) automatic: fn(&Scenario<f64, L>, &Sampling) -> Result<Trajectory, SimulationError>,
}

impl<L: Clone + 'static> LawVisitor<f64, L> for Make<L> {
    type Output = Contact;

    fn sliding(self) -> Contact
    where
        L: SlidingLaw<f64>,
    {
        // Time stepping has one level only.
        let engines = &[EngineName::Auto, EngineName::RungeKutta, EngineName::Thesis, EngineName::Moreau];
        let law = AnySliding(Rc::new(self.law));
        let (simulated, asked) = (law.clone(), law.clone());
        Contact {
            engines: if law.depends_on_acceleration() { &engines[..3] } else { engines },
            simulate: Box::new(move |setting, Choice { engine, tolerance }, sampling| {
                let scenario: &Scenario<f64, dyn SlidingLaw<f64>> = &setting.with(simulated.clone())?;
                match engine {
                    EngineName::Thesis => Thesis::default().run(scenario, sampling),
                    EngineName::Moreau => Moreau::default().run(scenario, sampling),
                    _ => tolerance.map_or_else(|| Ok(RungeKutta::default()), RungeKutta::new)?.run(scenario, sampling),
                }
            }),
            coefficient: Box::new(move |velocity, _, losing| {
                let speed = velocity.abs();
                let level = if losing { asked.coefficient_losing_speed(speed) } else { asked.coefficient(speed) };
                if velocity == 0.0 { 0.0 } else { level * velocity.signum() }
            }),
            sliding: Some(law),
        }
    }

    fn piecewise_linear(self) -> Contact
    where
        L: PiecewiseLinearLaw<f64> + SlidingLaw<f64>,
    {
        let engines =
            &[EngineName::Auto, EngineName::Exact, EngineName::RungeKutta, EngineName::Thesis, EngineName::Moreau];
        let (law, automatic) = (self.law.clone(), self.automatic);
        let Contact { engines: of_speed, simulate, coefficient, sliding } = self.sliding();
        Contact {
            engines: &engines[..=of_speed.len()],
            simulate: Box::new(move |setting, choice, sampling| match choice.engine {
                EngineName::Auto => automatic(&setting.with(law.clone())?, sampling),
                EngineName::Exact => Exact.run(&setting.with(law.clone())?, sampling),
                _ => simulate(setting, choice, sampling),
            }),
            coefficient,
            sliding,
        }
    }

    fn bristle(self) -> Contact
    where
        L: BristleLaw<f64>,
    {
        let Self { law, automatic } = self;
        let asked = law.clone();
        Contact {
            engines: &[EngineName::Auto, EngineName::Bristle],
            simulate: Box::new(move |setting, Choice { engine, tolerance }, sampling| {
                let scenario = setting.with(law.clone())?;
                match engine {
                    EngineName::Auto => automatic(&scenario, sampling),
                    _ => tolerance.map_or_else(|| Ok(Bristle::default()), Bristle::new)?.run(&scenario, sampling),
                }
            }),
            coefficient: Box::new(move |velocity, states, _| {
                // Which elements slide does not matter to the coefficient.
                let mut rate = vec![0.0; asked.states()];
                asked.rate(velocity, states, Regime::ALL_HOLD, &mut rate);
                asked.coefficient(velocity, states, &rate)
            }),
            sliding: None,
        }
    }

    fn elements(self) -> Contact
    where
        L: PiecewiseLinearLaw<f64> + BristleLaw<f64>,
    {
        let law = self.law.clone();
        let Contact { simulate, coefficient, sliding, .. } = self.bristle();
        Contact {
            engines: &[EngineName::Auto, EngineName::Exact, EngineName::Bristle],
            simulate: Box::new(move |setting, choice, sampling| match choice.engine {
                EngineName::Exact => Exact.run(&setting.with(law.clone())?, sampling),
                _ => simulate(setting, choice, sampling),
            }),
            coefficient,
            sliding,
        }
    }
}

/// A law of the sliding speed of any type.
#[derive(Clone)]
pub(crate) struct AnySliding(Rc<dyn SlidingLaw<f64>>);

impl SlidingLaw<f64> for AnySliding {
    fn coefficient(&self, speed: f64) -> f64 {
        self.0.coefficient(speed)
    }

    fn breakaway(&self) -> f64 {
        self.0.breakaway()
    }

    fn depends_on_acceleration(&self) -> bool {
        self.0.depends_on_acceleration()
    }

    fn coefficient_losing_speed(&self, speed: f64) -> f64 {
        self.0.coefficient_losing_speed(speed)
    }

    fn capture_speed(&self) -> f64 {
        self.0.capture_speed()
    }
}
