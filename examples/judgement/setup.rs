//! A machine with a contact of a law, let go.

use fmm_identify::{Known, Machine};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Sampling, Trajectory};

use super::law::Law;
use super::{Found, Truth};

/// Machine that moves, and what is true of it.
#[derive(Debug, Clone)]
pub(crate) struct Setup {
    /// m (kg).
    pub(crate) mass: f64,
    /// k (N/m).
    pub(crate) stiffness: f64,
    /// c, of the machine (N s/m).
    pub(crate) damping: f64,
    /// c₂, of the machine (N s²/m²).
    pub(crate) quadratic: f64,
    /// N (N).
    pub(crate) load: f64,
    /// x₀ (m).
    pub(crate) release: f64,
    /// Name of the law.
    pub(crate) law: &'static str,
    /// One value per parameter of the law.
    pub(crate) values: Vec<f64>,
    /// Names by which the law may be called; the first is its own.
    pub(crate) right: Vec<&'static str>,
}

impl Setup {
    fn family(&self) -> Found<&'static Law> {
        Law::named(self.law).ok_or_else(|| format!("there is no law {}", self.law).into())
    }

    pub(crate) fn oscillator(&self) -> Found<Oscillator> {
        let damping = Damping::new(self.damping, self.quadratic)?;
        Ok(Oscillator::new(self.mass, self.stiffness)?.with_damping(damping))
    }

    /// ω₀ (rad/s).
    pub(crate) fn angular_frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// The exact motion, `count` samples every `interval` (s).
    pub(crate) fn motion(&self, interval: f64, count: usize) -> Found<Trajectory> {
        let sampling = Sampling::uniform(interval, count)?;
        self.family()?.simulate(self.oscillator()?, &self.values, self.load, self.release, &sampling)
    }

    /// Quantities that are known beforehand: mass and normal load.
    pub(crate) fn known(&self) -> Found<Machine> {
        Ok(Machine::of_mass(Known::exact(self.mass)?)?.with_normal_load(Known::exact(self.load)?)?)
    }

    /// Truth that should be found, if the largest speed is `peak_speed` (m/s).
    pub(crate) fn truth(&self, peak_speed: f64) -> Found<Truth> {
        let law = self.family()?;
        Ok(Truth {
            right: self.right.clone(),
            levels: law.levels(&self.values, peak_speed).ok_or("the law has no level")?,
            change: 0.0,
            rise: 0.0,
            damping_per_mass: (self.damping + self.load * law.slope(&self.values)) / self.mass,
            frequency: self.oscillator()?.natural_frequency(),
            peak_speed,
            mass_by_load: self.mass / self.load,
        })
    }
}
