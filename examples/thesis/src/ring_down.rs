//! Simulated ring-downs of the thesis' machine, as no measured ones are published.

use fmm_friction::LawFamily;
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, Trajectory, simulate_into};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

use crate::{Found, printed};

/// Sampling interval of the thesis (s).
pub(crate) const INTERVAL: f64 = 1e-3;

/// Assumption about the viscous damping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Viscous {
    /// The mean of Table 2.
    Mean,
    /// The line of Eq. 5.5, whose instantaneous law is c₁ + (3π/8) slope |v|.
    Line,
}

impl Viscous {
    /// Linear (N s/m) and quadratic (N s²/m²) coefficient.
    pub(crate) fn coefficients(self) -> [f64; 2] {
        match self {
            Self::Mean => [printed::MACHINE[2], 0.0],
            Self::Line => [printed::EQUATION_5_5[1], printed::INSTANTANEOUS_SLOPE],
        }
    }
}

/// Mass and stiffness of Table 2 with this damping.
pub(crate) fn machine(viscous: Viscous) -> Found<Oscillator> {
    let [mass, stiffness, _] = printed::MACHINE;
    let [linear, quadratic] = viscous.coefficients();
    Ok(Oscillator::new(mass, stiffness)?.with_damping(Damping::new(linear, quadratic)?))
}

/// A machine with a contact whose law has these `values`, let go at a position (m) and velocity (m/s).
pub(crate) fn scenario<F: LawFamily>(
    machine: Oscillator,
    values: &[f64],
    load: f64,
    (position, velocity): (f64, f64),
) -> Found<Scenario<f64, F::At<f64>>> {
    Ok(Scenario::new(machine, F::at(values)?, load)?.starting_at(position, velocity)?)
}

/// The motion by the engine that suits the law.
pub(crate) fn motion<F: LawFamily>(scenario: &Scenario<f64, F::At<f64>>, sampling: &Sampling) -> Found<Trajectory> {
    let mut trajectory = Trajectory::new();
    simulate_into::<F, _>(scenario, sampling, None, &mut trajectory)?;
    Ok(trajectory)
}

/// `values` with white noise of this standard `deviation` (their unit); the same for the same `seed`.
pub(crate) fn with_noise(values: &[f64], deviation: f64, seed: u64) -> Found<Vec<f64>> {
    if deviation == 0.0 {
        return Ok(values.to_vec());
    }
    let noise = Normal::new(0.0, deviation)?.sample_iter(ChaCha8Rng::seed_from_u64(seed));
    Ok(values.iter().zip(noise).map(|(value, noise)| value + noise).collect())
}

/// A velocity record that begins at time 0.
pub(crate) fn velocity_record(values: Vec<f64>) -> Found<Record> {
    Ok(Record::new(0.0, INTERVAL, values, Quantity::Velocity, "m/s")?)
}

/// Times (s) with `values` times `factor`, as the points of a curve.
pub(crate) fn over_time(values: &[f64], factor: f64) -> Vec<(f64, f64)> {
    values.iter().enumerate().map(|(i, value)| (i as f64 * INTERVAL, factor * value)).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use fmm_friction::Coulomb;

    /// Free vibration without friction, with linear and quadratic damping (N s²/m²).
    pub(crate) fn free(quadratic: f64, start: (f64, f64), seconds: f64) -> Trajectory {
        let [mass, stiffness, _] = printed::MACHINE;
        let damping = Damping::new(printed::EQUATION_5_5[1], quadratic).unwrap();
        let machine = Oscillator::new(mass, stiffness).unwrap().with_damping(damping);
        let scenario = scenario::<Coulomb>(machine, &[0.0], 1.0, start).unwrap();
        motion::<Coulomb>(&scenario, &Sampling::uniform(INTERVAL, (seconds / INTERVAL) as usize).unwrap()).unwrap()
    }

    /// Mean and standard deviation.
    pub(crate) fn statistics(values: &[f64]) -> (f64, f64) {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (mean, (squares / (values.len() as f64 - 1.0)).sqrt())
    }

    pub(crate) fn close(found: f64, expected: f64, relative: f64, what: &str) {
        let error = found / expected - 1.0;
        assert!(
            error.abs() <= relative,
            "{what}: {found} against {expected}, off by {error:.2e}, allowed {relative:.0e}"
        );
    }
}
