//! Energy: what is there, was taken and was given, adds up.

use fmm_model::{Oscillator, Restoring};
use fmm_sim::RungeKutta;

use super::contact::Family;
use super::setup::{Setup, Solver, draws, setups};

/// The greatest imbalance of a motion over its samples, relative to the energies and works in play.
fn imbalance(setup: &Setup, solver: Solver) -> f64 {
    let sampling = setup.sampling(24).with_work();
    let motion = setup.motion(solver, &sampling);
    let mut machine = Oscillator::new(setup.mass, setup.stiffness).unwrap();
    if let Some(length) = setup.pendulum {
        machine = machine.with_restoring(Restoring::sine(length).unwrap());
    }
    let mut start = None;
    let samples = motion.position().values().iter().zip(motion.velocity().values()).enumerate();
    // What is missing, and what is in play.
    let balances: Vec<_> = samples
        .map(|(index, (&x, &v))| {
            let energy = machine.kinetic_energy(v) + machine.potential_energy(x);
            let work = motion.work(index).unwrap();
            let missing = energy + work.friction + work.viscous - work.external - *start.get_or_insert(energy);
            (missing, energy + work.friction.abs() + work.viscous.abs() + work.external.abs())
        })
        .collect();
    let size = balances.iter().fold(f64::MIN_POSITIVE, |size, balance| size.max(balance.1));
    // Elements store energy and give it back; whatever only slides does not.
    if setup.family != Family::MaxwellSlip {
        for index in 1..balances.len() {
            let gain = motion.work(index - 1).unwrap().friction - motion.work(index).unwrap().friction;
            assert!(gain <= 1e-14 * size, "friction gave {gain:e} of {size:e} J back at sample {index}: {setup}");
        }
    }
    let worst = balances.iter().fold(0.0f64, |worst, balance| worst.max(balance.0.abs()));
    worst / size
}

/// The worst imbalance of many setups of a family, and which it is.
fn worst(seed: u64, family: Family, linear: bool, solver: Solver) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for setup in setups(seed, family, linear, draws(1000)) {
        let error = imbalance(&setup, solver);
        if error > worst.0 {
            worst = (error, setup.to_string());
        }
    }
    worst
}

/// The work is integrated over the closed form to rounding.
#[test]
fn energy_balances_in_closed_form() {
    for &family in Family::EXACT {
        let (error, setup) = worst(1, family, true, Solver::Exact);
        assert!(error < 1e-12, "{error:e} of the energy is missing: {setup}");
    }
}

/// Work is integrated along the polynomial within a step, whose error is of one order less than that of the step: the
/// 8/9th power of the tolerance, and 500 for its constant and the number of steps.
#[test]
fn energy_balances_step_by_step() {
    for tolerance in [3e-14, 1e-10, 1e-6f64] {
        let solver = Solver::RungeKutta(RungeKutta::new(tolerance).unwrap());
        // A contact that is caught at the speed of its dead zone loses what it has by then: Karnopp's law does not
        // balance.
        for &family in Family::SLIDING.iter().filter(|family| **family != Family::Karnopp) {
            let (error, setup) = worst(2, family, false, solver);
            let allowed = 500.0 * tolerance.powf(8.0 / 9.0);
            assert!(error <= allowed, "{error:e} of the energy is missing, {allowed:e} allowed: {setup}");
        }
    }
}
