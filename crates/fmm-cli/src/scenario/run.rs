//! Run of a scenario: from its text to its motion.

use std::error::Error;

use fmm_friction::OwnLaw;
use fmm_model::Restoring;
use fmm_sim::State;

use super::catalogue::contact;
use super::contact::{Choice, Contact, Setting};
use super::entries::{Entries, Field};
use super::file::{Drive, File};
use super::{EngineName, Motion, Plan};

/// A scenario, checked and ready to run.
pub(crate) struct Simulation {
    pub(crate) title: String,
    pub(crate) description: String,
    /// Name of the law.
    pub(crate) law: &'static str,
    contact: Contact,
    setting: Setting,
    /// Velocity of the counterface (m/s).
    pub(crate) belt: f64,
    choice: Choice,
    plan: Plan,
}

impl Simulation {
    /// Reads the text of a scenario file, whose law may be one's `own`.
    ///
    /// # Errors
    /// Its text says what is wrong and what would be right.
    pub(crate) fn read(text: &str, own: &[&'static OwnLaw]) -> Result<Self, Box<dyn Error>> {
        let file: File = serde_json::from_str(text).map_err(|error| format!("the scenario cannot be read: {error}"))?;
        let has_law = file.law.is_some();
        let (law, contact) = contact(file.law.unwrap_or_else(frictionless), own)?;
        let choice = Choice { engine: file.engine, tolerance: file.tolerance };
        let engine = choice.engine;
        if !contact.engines.contains(&engine) {
            let possible: Vec<String> = contact.engines.iter().map(ToString::to_string).collect();
            let possible = possible.join(", ");
            return Err(if has_law {
                format!("the engine {engine} cannot take the law {law}; its engines are {possible}")
            } else {
                format!("the engine {engine} needs a law, and none was given; without one the engines are {possible}")
            }
            .into());
        }
        let integrates = matches!(engine, EngineName::RungeKutta | EngineName::Bristle);
        if choice.tolerance.is_some() && !integrates {
            return Err(format!(
                "a tolerance belongs to the engines runge_kutta and bristle, but the engine is {engine}"
            )
            .into());
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
    pub(crate) fn run(&self) -> Result<Motion, Box<dyn Error>> {
        self.run_at(&self.plan)
    }

    /// The motion at the times of another `plan`.
    ///
    /// # Errors
    /// `SimulationError` if the engine has no answer.
    pub(crate) fn run_at(&self, plan: &Plan) -> Result<Motion, Box<dyn Error>> {
        let sampling = plan.sampling.clone().with_work();
        let trajectory = (self.contact.simulate)(&self.setting, self.choice, &sampling)?;
        Ok(Motion::new(&trajectory, plan, &self.setting))
    }

    /// Friction force (N) at a `velocity` (m/s) relative to the counterface and internal `states`; `losing` tells that
    /// the speed falls.
    pub(crate) fn friction(&self, velocity: f64, states: &[f64], losing: bool) -> f64 {
        (self.contact.coefficient)(velocity, states, losing) * self.setting.normal_load
    }

    /// The units of position, velocity and force: those of an angle for a pendulum of length 1.
    pub(crate) fn units(&self) -> [&'static str; 3] {
        match self.setting.oscillator.restoring() {
            Restoring::Sine { length: 1.0 } => ["rad", "rad/s", "N m"],
            _ => ["m", "m/s", "N"],
        }
    }
}

/// The law of a scenario that names none.
fn frictionless() -> Entries {
    let nothing = Entries(vec![("viscous".to_owned(), Field::Number(0.0))]);
    Entries(vec![("viscous".to_owned(), Field::Object(nothing))])
}
