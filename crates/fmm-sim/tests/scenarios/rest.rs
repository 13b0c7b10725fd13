//! Rest is where the motion has ended for good.

use fmm_friction::{Coulomb, CoulombStatic, Dahl, MaxwellSlip, SlidingLaw};
use fmm_model::Oscillator;
use fmm_sim::{Bristle, Engine, Exact, Excitation, Mode, Moreau, RungeKutta, Sampling, Scenario, Thesis, Trajectory};

fn machine() -> Oscillator {
    Oscillator::new(1.0, 100.0).unwrap()
}

fn motions<L: SlidingLaw<f64> + fmm_friction::PiecewiseLinearLaw<f64>>(
    scenario: &Scenario<f64, L>,
    sampling: &Sampling,
) -> Vec<Trajectory> {
    vec![
        Exact.run(scenario, sampling).unwrap(),
        RungeKutta::default().run(scenario, sampling).unwrap(),
        Moreau::default().run(scenario, sampling).unwrap(),
    ]
}

/// 100 N/m on a belt of 0.2 m/s: the contact holds from about 0.06 s until the spring carries 8 N.
#[test]
fn a_mass_that_rides_a_belt_does_not_rest() {
    let scenario = Scenario::new(machine(), CoulombStatic::new(0.4, 0.8).unwrap(), 10.0).unwrap();
    let scenario = scenario.driven_by(Excitation::belt(0.2).unwrap());
    for motion in motions(&scenario, &Sampling::uniform(1e-3, 200).unwrap()) {
        assert_eq!(motion.events().last().unwrap().next, Mode::Stick, "{}", motion.engine());
        assert_eq!(motion.rest(), None, "{}", motion.engine());
    }
}

/// A ramp of 1 N/s leaves 2 N at 2 s, whether the record goes on so far or not.
#[test]
fn a_later_breakaway_ends_no_motion() {
    let law = Coulomb::new(0.2).unwrap();
    let scenario = Scenario::new(machine(), law, 10.0).unwrap().starting_at(0.0, 0.1).unwrap();
    let ramp = || Excitation::ramp(1.0).unwrap();
    let later = Excitation::half_sine(50.0, 0.01).unwrap().delayed(1.0).unwrap();
    let wave = Excitation::harmonic(3.0, 0.5, -1.0).unwrap();
    for force in [ramp(), later, wave, ramp().delayed(1.5).unwrap()] {
        let scenario = scenario.clone().driven_by(force);
        for motion in motions(&scenario, &Sampling::uniform(1e-3, 500).unwrap()) {
            assert_eq!(motion.events().last().unwrap().next, Mode::Stick, "{}: {scenario:?}", motion.engine());
            assert_eq!(motion.rest(), None, "{}: {scenario:?}", motion.engine());
        }
    }
    let thesis = scenario.clone().driven_by(ramp());
    assert_eq!(Thesis::A3.run(&thesis, &Sampling::uniform(1e-3, 500).unwrap()).unwrap().rest(), None);
}

#[test]
fn forces_that_are_too_small_let_it_rest() {
    let scenario = Scenario::new(machine(), Coulomb::new(0.2).unwrap(), 10.0).unwrap().starting_at(0.0, 0.1).unwrap();
    let later = Excitation::half_sine(0.5, 0.01).unwrap().delayed(1.0).unwrap();
    let wave = Excitation::harmonic(0.3, 5.0, 1.0).unwrap();
    let scenario = scenario.driven_by(later).driven_by(wave);
    for motion in motions(&scenario, &Sampling::uniform(1e-3, 500).unwrap()) {
        let rest = motion.rest().unwrap_or_else(|| panic!("{} moves on", motion.engine()));
        assert!(rest.time < 0.1, "{}", motion.engine());
    }
}

/// Elements hold at 0 N; a pulse sets them in motion.
#[test]
fn bristles_at_rest_wait_for_the_force() {
    let law = Dahl::new(0.25, 100.0, 1.0).unwrap();
    let pulse = || Excitation::half_sine(50.0, 0.01).unwrap().delayed(1.0).unwrap();
    let sampling = Sampling::uniform(1e-3, 500).unwrap();
    let still = Scenario::new(machine(), law, 10.0).unwrap();
    assert!(Bristle::default().run(&still, &sampling).unwrap().rest().is_some());
    assert_eq!(Bristle::default().run(&still.driven_by(pulse()), &sampling).unwrap().rest(), None);
    let elements = Scenario::new(machine(), MaxwellSlip::new(&[(100.0, 0.1)]).unwrap(), 10.0).unwrap();
    assert!(Exact.run(&elements, &sampling).unwrap().rest().is_some());
    assert_eq!(Exact.run(&elements.driven_by(pulse()), &sampling).unwrap().rest(), None);
}
