//! Energy: what is there, was taken and was given, adds up.

use fmm_model::{Oscillator, Restoring};
use fmm_sim::RungeKutta;

use super::contact::Family;
use super::setup::{Setup, Solver, setups};

/// Random setups of each family.
const SETS: usize = 1000;

/// The greatest imbalance of a motion over its samples, relative to the energies and works in play, after how many events.
fn imbalance(setup: &Setup, solver: Solver) -> (f64, usize) {
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
    (worst / size, motion.events().len())
}

#[test]
fn energy_balances_in_closed_form() {
    for &family in Family::EXACT {
        let mut worst = (0.0, String::new());
        for setup in setups(1, family, true, SETS) {
            let (error, events) = imbalance(&setup, Solver::Exact);
            if error > worst.0 {
                worst = (error, format!("{events} events, {setup}"));
            }
        }
        println!("{family:?}: {:e}", worst.0);
        assert!(worst.0 < 1e-12, "{:e} of the energy is missing: {}", worst.0, worst.1);
    }
}

#[test]
fn energy_balances_step_by_step() {
    for tolerance in [3e-14, 1e-8] {
        for &family in Family::SLIDING {
            let solver = Solver::RungeKutta(RungeKutta::new(tolerance).unwrap());
            let mut worst = (0.0, String::new());
            for setup in setups(2, family, false, SETS) {
                let (error, events) = imbalance(&setup, solver);
                if error > worst.0 {
                    worst = (error, format!("{events} events, {setup}"));
                }
            }
            println!("{family:?} {tolerance:e}: {:e} {}", worst.0, worst.1);
        }
    }
}
