//! Impact: the free motion after a measured blow of a hammer, as one of several experiments.

use fmm_record::{Quantity, Record};

use super::{Experiment, FEWEST_SAMPLES};
use crate::error::IdentifyError;
use crate::experiment::ImpactTrial;
use crate::experiment::ring_down;
use crate::experiment::{Drive, Offset, Preparation};

impl Experiment {
    /// A hammer blow: the velocity from the beginning of the blow until a while after rest, driven by the measured
    /// force. The machine is at rest before; samples during contact are left out, as the force between its samples is
    /// not known. What these leave open of the impulse and of its time is fitted, or, on a machine of unknown mass, an
    /// uncertainty of all forces.
    ///
    /// [`identify_impact`](crate::identify_impact) fits blows alone, on a machine of which everything is known, and as
    /// mobility too.
    ///
    /// ```
    /// use fmm_friction::Coulomb;
    /// use fmm_identify::{Experiment, ImpactTrial, Machine, Preparation, identify};
    /// use fmm_record::{Quantity, Record};
    /// # use fmm_model::{Damping, Oscillator};
    /// # use fmm_sim::{Engine, Exact, Excitation, Sampling, Scenario};
    ///
    /// // A blow on the machine of the thesis, F = 0.75 N, and a ring-down of it; here both are simulated.
    /// # let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::linear(0.275)?);
    /// # let scenario = Scenario::new(machine, Coulomb::new(0.75)?, 1.0)?;
    /// # let force: Vec<f64> = (0..6000).map(|i| if (200..240).contains(&i) { 400.0 * (f64::from(i - 200) / 40.0 * std::f64::consts::PI).sin() } else { 0.0 }).collect();
    /// # let driven = scenario.clone().driven_by(Excitation::sampled_force(5e-4, force.clone())?);
    /// # let velocity = Exact.run(&driven, &Sampling::uniform(5e-4, 6000)?)?.velocity().values().to_vec();
    /// # let free = Exact.run(&scenario.starting_at(0.02, 0.0)?, &Sampling::uniform(1e-3, 4000)?)?.velocity().values().to_vec();
    /// let force = Record::new(0.0, 5e-4, force, Quantity::Force, "N")?;
    /// let velocity = Record::new(0.0, 5e-4, velocity, Quantity::Velocity, "m/s")?;
    /// let free = Record::new(0.0, 1e-3, free, Quantity::Velocity, "m/s")?;
    ///
    /// let blow = Experiment::impact(&ImpactTrial::prepare(&force, &velocity)?)?;
    /// let ring_down = Experiment::ring_down(&free, &Preparation::default())?;
    /// // The force tells the mass, both tell friction.
    /// let found = identify::<Coulomb>(&Machine::unknown().with_damping(fmm_identify::Known::exact(0.275)?)?, &[ring_down, blow])?;
    /// assert!((found.finding("mass").unwrap().value() / 10.391 - 1.0).abs() < 1e-3);
    /// assert!((found.finding("friction_force").unwrap().value() / 0.75 - 1.0).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::TooFew`] if contact leaves too little of the motion.
    pub fn impact(trial: &ImpactTrial) -> Result<Self, IdentifyError> {
        let (motion, interval) = (trial.motion(), trial.interval());
        let start = trial.summary().begin;
        let velocity = trial.velocity()[motion.clone()].to_vec();
        let mut force = trial.force().to_vec();
        force.resize(force.len().max(velocity.len()), 0.0);
        let velocity = Record::new(start, interval, velocity, Quantity::Velocity, "m/s")?;
        let force = Record::new(start, interval, force, Quantity::Force, "N")?;
        let summary = trial.summary();
        let drive = Drive::force(&force)?
            .with_gain_uncertainty((summary.impulse.uncertainty / summary.impulse.value).abs())?
            .with_free_delay(interval)?;
        let preparation = Preparation { offset: Offset::Fixed(0.0), ..Preparation::default() };
        let mut experiment = Self::driven(&velocity, drive, &preparation)?;
        let hits = trial.hits().iter().map(|hit| hit.start..hit.end + 1);
        experiment.kept = ring_down::without(motion.len(), hits);
        experiment.summary.samples = experiment.kept.iter().map(std::ops::Range::len).sum();
        if experiment.summary.samples < FEWEST_SAMPLES {
            return Err(IdentifyError::too_short(experiment.summary.samples, FEWEST_SAMPLES));
        }
        if let Some(driven) = &mut experiment.driven {
            driven.is_at_rest = true;
        }
        Ok(experiment)
    }
}
