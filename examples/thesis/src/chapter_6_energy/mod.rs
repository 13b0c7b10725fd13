//! Chapter 6: friction from the rate at which the machine loses energy.
//!
//! The thesis shows the method on a motion that it computes, and says that measured data are too noisy for it. Here
//! both are computed: the clean motion, what becomes of it when a channel is a sample late, and what noise does to it
//! under five smoothings, with two estimators beside that need no derivative.

mod clean;
mod energy_rates;
mod noisy;
mod turning_points;
mod weak_form;

use fmm_friction::Coulomb;
use fmm_sim::{Sampling, Scenario, Trajectory};

use crate::ring_down::{INTERVAL, Viscous, machine, motion, scenario};
use crate::{Chapter, Found, Settings, printed};

/// μ of the example (1).
const COEFFICIENT: f64 = 0.25;
/// Its initial displacement (m): the motion begins in the positive direction.
const RELEASE: f64 = -0.01;
/// Slower samples (m/s) are left out: the force is a power divided by the speed.
const SLOWEST: f64 = 0.02;

/// The numbers of chapter 6 beside ours.
///
/// # Errors
/// If a simulation or an estimate cannot be done.
pub fn chapter(settings: &Settings<'_>) -> Found<Chapter> {
    let mut chapter = Chapter::new("6 Energy");
    let example = Example::new()?;
    clean::add(&mut chapter, &example)?;
    settings.done(0.1);
    noisy::add(&mut chapter, &example, settings)?;
    settings.done(1.0);
    Ok(chapter)
}

/// The example of the chapter: both motions up to where the contact holds for good.
struct Example {
    scenario: Scenario<f64, Coulomb>,
    free: Scenario<f64, Coulomb>,
    sampling: Sampling,
    contact: Trajectory,
    without: Trajectory,
    /// Times of zero velocity (s): release, reversals and stop.
    reversals: Vec<f64>,
}

impl Example {
    fn new() -> Found<Self> {
        let oscillator = machine(Viscous::Mean)?;
        let of = |coefficient: f64| scenario::<Coulomb>(oscillator, &[coefficient], printed::LOADS[3], (RELEASE, 0.0));
        let (scenario, free) = (of(COEFFICIENT)?, of(0.0)?);
        let long = motion::<Coulomb>(&scenario, &Sampling::uniform(INTERVAL, 3000)?)?;
        let rest = long.rest().ok_or("the contact does not stop the motion")?.time;
        let sampling = Sampling::uniform(INTERVAL, (rest / INTERVAL).ceil() as usize + 1)?;
        Ok(Self {
            contact: motion::<Coulomb>(&scenario, &sampling)?,
            without: motion::<Coulomb>(&free, &sampling)?,
            reversals: long.events().iter().map(|event| event.time).collect(),
            scenario,
            free,
            sampling,
        })
    }

    /// When the contact holds for good (s).
    fn rest(&self) -> f64 {
        self.reversals.last().copied().unwrap_or_default()
    }
}

/// μ N of the example (N).
fn friction() -> f64 {
    COEFFICIENT * printed::LOADS[3]
}
