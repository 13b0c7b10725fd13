//! Run of a scenario: from its text to its motion.

use fmm_model::Restoring;
use fmm_sim::State;

use super::catalogue::contact;
use super::contact::{Contact, Setting};
use super::engine::Choice;
use super::entries::{Entries, Field};
use super::file::{Drive, File};
use super::{EngineName, Motion, Plan, ScenarioError};

/// A scenario, checked and ready to run.
pub(crate) struct Simulation {
    title: String,
    description: String,
    law: &'static str,
    contact: Box<dyn Contact>,
    setting: Setting,
    belt: f64,
    choice: Choice,
    plan: Plan,
}

impl Simulation {
    /// Reads the text of a scenario file.
    ///
    /// # Errors
    /// [`ScenarioError`], which says what is wrong and what would be right.
    pub(crate) fn read(text: &str) -> Result<Self, ScenarioError> {
        let file: File = serde_json::from_str(text)?;
        let has_law = file.law.is_some();
        let (law, contact) = contact(file.law.unwrap_or_else(frictionless))?;
        let choice = Choice { engine: file.engine, tolerance: file.tolerance };
        if !contact.engines().contains(&choice.engine) {
            return Err(match wrong_engine(law, contact.as_ref(), choice.engine) {
                ScenarioError::Engine { engine, possible, .. } if !has_law => {
                    ScenarioError::EngineWithoutLaw { engine, possible }
                }
                error => error,
            });
        }
        let integrates = matches!(choice.engine, EngineName::RungeKutta | EngineName::Bristle);
        if choice.tolerance.is_some() && !integrates {
            return Err(ScenarioError::NoTolerance { engine: choice.engine });
        }
        let belt = file.excitation.iter().map(Drive::belt).sum();
        let mut excitations = Vec::with_capacity(file.excitation.len());
        for drive in file.excitation {
            excitations.push(drive.excitation()?);
        }
        let setting = Setting {
            oscillator: file.oscillator.oscillator()?,
            normal_load: file.normal_load,
            initial: State { position: file.initial.position, velocity: file.initial.velocity },
            excitations,
        };
        let plan = Plan::new(file.duration, file.output)?;
        Ok(Self { title: file.title, description: file.description, law, contact, setting, belt, choice, plan })
    }

    /// The motion at the times that the scenario asks for.
    ///
    /// # Errors
    /// [`ScenarioError::Simulation`] if the engine has no answer.
    pub(crate) fn run(&self) -> Result<Motion, ScenarioError> {
        self.run_at(&self.plan)
    }

    /// The motion at the times of another `plan`.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub(crate) fn run_at(&self, plan: &Plan) -> Result<Motion, ScenarioError> {
        let sampling = plan.sampling.clone().with_work();
        match self.contact.simulate(&self.setting, self.choice, &sampling)? {
            Some(trajectory) => Ok(Motion::new(&trajectory, plan, &self.setting)),
            None => Err(wrong_engine(self.law, self.contact.as_ref(), self.choice.engine)),
        }
    }

    /// What the scenario calls itself.
    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    /// What the scenario says of itself.
    pub(crate) fn description(&self) -> &str {
        &self.description
    }

    /// Name of the law.
    pub(crate) const fn law(&self) -> &'static str {
        self.law
    }

    /// Friction force (N) at a `velocity` (m/s) relative to the counterface and internal `states`; `losing` tells that
    /// the speed falls.
    pub(crate) fn friction(&self, velocity: f64, states: &[f64], losing: bool) -> f64 {
        self.contact.coefficient(velocity, states, losing) * self.setting.normal_load
    }

    /// The units of position, velocity and force: those of an angle for a pendulum of length 1.
    pub(crate) fn units(&self) -> [&'static str; 3] {
        match self.setting.oscillator.restoring() {
            Restoring::Sine { length: 1.0 } => ["rad", "rad/s", "N m"],
            _ => ["m", "m/s", "N"],
        }
    }

    /// Velocity of the counterface (m/s).
    pub(crate) const fn belt(&self) -> f64 {
        self.belt
    }
}

/// The law of a scenario that names none.
fn frictionless() -> Entries {
    let nothing = Entries(vec![("viscous".to_owned(), Field::Number(0.0))]);
    Entries(vec![("viscous".to_owned(), Field::Object(nothing))])
}

fn wrong_engine(law: &'static str, contact: &dyn Contact, engine: EngineName) -> ScenarioError {
    let possible: Vec<String> = contact.engines().iter().map(EngineName::to_string).collect();
    ScenarioError::Engine { engine, law, possible: possible.join(", ") }
}
