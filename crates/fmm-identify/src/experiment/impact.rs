//! Impact: the free motion after a measured impact of a hammer.

use std::ops::Range;
use std::sync::Arc;

use fmm_record::{Quantity, Record};

use super::{Experiment, FEWEST_SAMPLES};
use crate::error::IdentifyError;
use crate::experiment::lines::Lines;
use crate::experiment::ring_down;
use crate::experiment::{Drive, ImpactTrial, Offset, Preparation};

/// Band of a mobility unless one is given, in natural frequencies.
const BAND: (f64, f64) = (0.5, 2.0);

impl Experiment {
    /// The impact of a hammer: the velocity from the beginning of the impact until a while after rest, driven by the
    /// measured force. The machine is at rest before; samples during contact are left out, as the force between its
    /// samples is not known. What the samples of the force leave
    /// open of the impulse and of its time is fitted with that knowledge.
    ///
    /// [`mobility`](Self::mobility) compares the lines of a spectrum instead.
    ///
    /// ```
    /// use fmm_friction::Coulomb;
    /// use fmm_identify::{Experiment, ImpactTrial, Machine, Preparation, identify};
    /// use fmm_record::{Quantity, Record};
    /// # use fmm_model::{Damping, Oscillator};
    /// # use fmm_sim::{Engine, Exact, Excitation, Sampling, Scenario};
    ///
    /// // An impact on the machine of the thesis, F = 0.75 N, and a ring-down of it; here both are simulated.
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
    /// let impact = Experiment::impact(&ImpactTrial::prepare(&force, &velocity)?)?;
    /// let ring_down = Experiment::ring_down(&free, &Preparation::default())?;
    /// // The force tells the mass, both tell friction.
    /// let found = identify::<Coulomb>(&Machine::unknown().with_damping(fmm_identify::Known::exact(0.275)?)?, &[ring_down, impact])?;
    /// assert!((found.finding("mass").unwrap().value() / 10.391 - 1.0).abs() < 1e-3);
    /// assert!((found.finding("friction_force").unwrap().value() / 0.75 - 1.0).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::TooFew`] if contact leaves too little of the motion.
    pub fn impact(trial: &ImpactTrial) -> Result<Self, IdentifyError> {
        let hits = trial.hits.iter().map(|hit| hit.start..hit.end + 1);
        Self::of_trial(trial, Offset::Fitted)?.using(ring_down::without(trial.motion().len(), hits))
    }

    /// The impact of a hammer by its mobility: the lines of the velocity's spectrum within `band` (Hz), or from half to
    /// twice the frequency of the motion. Samples during contact are part of a spectrum; the pulse that they make is
    /// fitted with what is known of it, as by [`impact`](Self::impact).
    ///
    /// # Errors
    /// [`IdentifyError::NotSeen`] for a band without a line, and as for [`impact`](Self::impact).
    pub fn mobility(trial: &ImpactTrial, band: Option<(f64, f64)>) -> Result<Self, IdentifyError> {
        // An offset has no part in lines above zero frequency.
        let experiment = Self::of_trial(trial, Offset::Fixed(0.0))?;
        let frequency = experiment.guess.frequency();
        // Of the motion alone, so that the noise of one line tells nothing of the next.
        let band = band.unwrap_or((BAND.0 * frequency, BAND.1 * frequency));
        let lines = Lines::new(trial.motion().len(), trial.summary().rate, band)?;
        Ok(Self { lines: Some(Arc::new(lines)), ..experiment })
    }

    /// The whole motion of `trial` with this `offset`, driven by its force.
    fn of_trial(trial: &ImpactTrial, offset: Offset) -> Result<Self, IdentifyError> {
        let (motion, interval) = (trial.motion(), trial.interval());
        let start = trial.summary().begin;
        let velocity = trial.velocity()[motion.clone()].to_vec();
        let force = trial.force().to_vec();
        let velocity = Record::new(start, interval, velocity, Quantity::Velocity, "m/s")?;
        let force = Record::new(start, interval, force, Quantity::Force, "N")?;
        let summary = trial.summary();
        let drive = Drive::force(&force)?
            .with_gain_uncertainty((summary.impulse.uncertainty / summary.impulse.value).abs())?
            .with_calibration_uncertainty(trial.calibration_uncertainty())?
            .with_free_delay(interval)?
            .with_delay_uncertainty(summary.time_uncertainty);
        let preparation = Preparation { offset, ..Preparation::default() };
        let mut experiment =
            Self::driven(&velocity, drive, &preparation)?.using(std::iter::once(0..motion.len()).collect())?;
        if let Some(driven) = &mut experiment.driven {
            driven.is_at_rest = true;
        }
        experiment.impact = Some(summary.clone());
        Ok(experiment)
    }

    /// The same of which these ranges of samples are used.
    fn using(mut self, used: Vec<Range<usize>>) -> Result<Self, IdentifyError> {
        self.summary.samples = used.iter().map(Range::len).sum();
        self.kept = used;
        if self.summary.samples < FEWEST_SAMPLES {
            return Err(IdentifyError::too_short(self.summary.samples, FEWEST_SAMPLES));
        }
        Ok(self)
    }
}
