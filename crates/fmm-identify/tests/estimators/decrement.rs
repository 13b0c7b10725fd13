//! The logarithmic decrement: the line of the thesis, and uncertainties that are true.

use std::f64::consts::TAU;

use fmm_friction::Coulomb;
use fmm_identify::{Experiment, Preparation, decrements};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};

use crate::measurement::{MASS, close, free, line, noisy, statistics, velocity};

/// Peaks fitted through all samples about them: 8/(3π) 0.5148 = 0.43699.
#[test]
fn fitted_peaks_give_the_line_of_the_thesis() {
    let motion = free(0.5148, (0.01, 0.0), 80.0);
    for (noise, tolerance, scatter) in [(0.0, 1e-3, 2e-4), (1e-5, 3e-3, 1e-3), (1e-4, 0.02, 1e-2)] {
        let record = velocity(noisy(motion.velocity().values(), noise, 1));
        let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let cycles = decrements(&decay).unwrap();
        let points: Vec<_> = cycles.iter().map(|cycle| (cycle.peak_velocity, MASS * cycle.damping.value)).collect();
        let (intercept, slope, found) = line(&points);
        assert!((173..=176).contains(&cycles.len()), "{} cycles", cycles.len());
        close(slope, 0.436_99, tolerance, "slope (N s²/m²)");
        close(intercept, 0.2005, tolerance, "intercept (N s/m)");
        assert!(found < scatter, "scatter {found} N s/m at {noise} m/s");
    }
}

/// The stated uncertainties are those that happen: 170 cycles tell a standard deviation to about 6 %, and a little more
/// as neighbours are correlated.
#[test]
fn uncertainties_are_those_that_happen() {
    let motion = free(0.0, (0.01, 0.0), 80.0);
    for (values, quantity, noise) in [
        (motion.velocity().values(), Quantity::Velocity, 1e-4),
        (motion.position().values(), Quantity::Displacement, 1e-5),
    ] {
        let record = velocity(noisy(values, noise, 5)).with_quantity(quantity).with_unit("m");
        let cycles = decrements(&Experiment::ring_down(&record, &Preparation::default()).unwrap()).unwrap();
        let pulls: Vec<f64> =
            cycles.iter().map(|cycle| (cycle.damping.value - 0.2005 / MASS) / cycle.damping.uncertainty).collect();
        let (mean, deviation) = statistics(&pulls);
        assert!((0.8..1.2).contains(&deviation), "{quantity}: pulls scatter by {deviation} about {mean}");
        let peak = cycles[0].peak_velocity;
        close(peak, 0.01 * (1982.0f64 / MASS).sqrt(), 0.02, "first peak velocity (m/s)");
    }
}

/// Dry friction: the linear form gives F/m at every amplitude, for both quantities.
#[test]
fn differences_give_dry_friction() {
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), Coulomb::new(0.05).unwrap(), 1.0).unwrap();
    let scenario = scenario.starting_at(0.02, 0.0).unwrap();
    let motion = Exact.run(&scenario, &Sampling::uniform(1e-3, 8000).unwrap()).unwrap();
    for (values, quantity, unit) in [
        (motion.velocity().values(), Quantity::Velocity, "m/s"),
        (motion.position().values(), Quantity::Displacement, "m"),
    ] {
        let record = Record::new(0.0, 1e-3, noisy(values, 1e-6, 2), quantity, unit).unwrap();
        let cycles = decrements(&Experiment::ring_down(&record, &Preparation::default()).unwrap()).unwrap();
        let moving: Vec<_> = cycles.iter().filter(|cycle| cycle.peak_velocity > 0.03).collect();
        assert!(moving.len() > 8, "{} cycles", moving.len());
        for cycle in moving {
            close(cycle.friction.value, 0.05, 0.02, &format!("{quantity}: F/m (m/s²) at {} m/s", cycle.peak_velocity));
        }
        // The viscous reading of the same loss grows without end: c/m = 4F/(π m V).
        let last = cycles.iter().rfind(|cycle| cycle.peak_velocity > 0.05).unwrap();
        close(last.damping.value, 8.0 * 0.05 / (TAU * last.peak_velocity), 0.05, "c/m (1/s)");
    }
}
