//! Springs that hardly pull, and none at all.

use fmm_friction::{Coulomb, CoulombStatic, Dahl, MaxwellSlip, Stribeck};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{
    Bristle, Engine, Exact, Excitation, Moreau, RungeKutta, Sampling, Scenario, SimulationError, Thesis, Trajectory,
    simulate_into,
};

/// 1 kg pushed at 1 m/s against 0.5 N: x = t − t²/4 until 2 s, then 1 m.
fn block(stiffness: f64) -> Scenario<f64, Coulomb> {
    let machine = Oscillator::new(1.0, stiffness).unwrap();
    Scenario::new(machine, Coulomb::new(0.5).unwrap(), 1.0).unwrap().starting_at(0.0, 1.0).unwrap()
}

fn off(motion: &Trajectory, sampling: &Sampling) -> f64 {
    let position = |time: f64| if time < 2.0 { time - 0.25 * time * time } else { 1.0 };
    let off = |(index, x): (usize, &f64)| (x - position(sampling.time(index))).abs();
    motion.position().values().iter().enumerate().map(off).fold(0.0, f64::max)
}

/// The closed form is right to nine digits, or says that it is not.
#[test]
fn the_closed_form_is_right_or_refused() {
    let sampling = Sampling::uniform(1e-2, 301).unwrap();
    let mut refused = 0;
    for stiffness in [0.0, 1e-100, 1e-20, 1e-15, 1e-12] {
        match Exact.run(&block(stiffness), &sampling) {
            Ok(motion) => assert!(off(&motion, &sampling) < 1e-9, "{stiffness} N/m: {} m off", off(&motion, &sampling)),
            Err(error) => {
                assert!(error.to_string().contains("is too weak"), "{stiffness} N/m: {error}");
                refused += 1;
            }
        }
    }
    assert!(refused >= 3, "{refused} refused");
    // A spring that matters is not weak.
    assert!(Exact.run(&block(1e-3), &sampling).is_ok());
}

/// A hammer of 1 kN and 1 ms sampled at 1 MHz, its impulse 0.637 N s, on 1 kg with next to no spring: 0.637 m after a
/// second.
#[test]
fn a_hammer_on_a_weak_spring_is_right_or_refused() {
    let force: Vec<f64> = (0..=1000).map(|i| 1e3 * (f64::from(i) * 1e-3 * std::f64::consts::PI).sin()).collect();
    for (stiffness, exact) in [(1e-6, false), (2000.0, true)] {
        let machine = Oscillator::new(1.0, stiffness).unwrap();
        let scenario = Scenario::new(machine, Coulomb::new(1e-6).unwrap(), 1.0).unwrap();
        let scenario = scenario.driven_by(Excitation::sampled_force(1e-6, force.clone()).unwrap());
        let sampling = Sampling::uniform(1e-2, 101).unwrap();
        let reference = RungeKutta::default().run(&scenario, &sampling).unwrap();
        let closed = Exact.run(&scenario, &sampling);
        assert_eq!(closed.is_ok(), exact, "{stiffness} N/m: {:?}", closed.err());
        let mut chosen = Trajectory::new();
        simulate_into::<Coulomb, _>(&scenario, &sampling, None, &mut chosen).unwrap();
        assert_eq!(chosen.engine(), if exact { "exact" } else { "runge_kutta" });
        for (got, expected) in chosen.position().values().iter().zip(reference.position().values()) {
            assert!((got - expected).abs() < 1e-8, "{stiffness} N/m: {got} instead of {expected} m");
        }
    }
}

/// Without any spring every engine but the closed form goes on.
#[test]
fn no_spring_is_a_machine() {
    let sampling = Sampling::uniform(1e-3, 3001).unwrap();
    let mut chosen = Trajectory::new();
    simulate_into::<Coulomb, _>(&block(0.0), &sampling, None, &mut chosen).unwrap();
    assert!(off(&chosen, &sampling) < 1e-13, "chosen: {} m", off(&chosen, &sampling));
    for (motion, most) in [
        (RungeKutta::default().run(&block(0.0), &sampling).unwrap(), 1e-13),
        (Moreau::default().run(&block(0.0), &sampling).unwrap(), 1e-3),
        (Thesis::A3.run(&block(0.0), &sampling).unwrap(), 1e-2),
    ] {
        let (off, rest) = (off(&motion, &sampling), motion.rest().expect("friction stops it").time);
        // Methods of fixed step stop up to two steps late.
        assert!(off < most && (rest - 2.0).abs() < 2.5e-3, "{}: {off} m, rest at {rest} s", motion.engine());
    }
    // One sample needs no time scale.
    assert!(RungeKutta::default().run(&block(0.0), &Sampling::uniform(1.0, 1).unwrap()).is_ok());
}

/// A block without a spring on bristles that are hardly bent before they slide.
#[test]
fn bristles_need_no_spring() {
    let machine = Oscillator::new(1.0, 0.0).unwrap();
    let sampling = Sampling::uniform(1e-2, 150).unwrap();
    let law = Dahl::new(0.5, 1e6, 1.0).unwrap();
    let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(0.0, 1.0).unwrap();
    let motion = Bristle::default().run(&scenario, &sampling).unwrap();
    assert!(off(&motion, &sampling) < 2e-6, "{} m", off(&motion, &sampling));
    let elements = MaxwellSlip::new(&[(1e6, 0.5)]).unwrap();
    let scenario = Scenario::new(machine, elements, 1.0).unwrap().starting_at(0.0, 1.0).unwrap();
    assert!(matches!(Exact.run(&scenario, &sampling), Err(SimulationError::NoClosedForm { .. })));
    let motion = Bristle::default().run(&scenario, &sampling).unwrap();
    assert!(off(&motion, &sampling) < 2e-6, "{} m", off(&motion, &sampling));
}

/// Under a constant force above the static level a block without a spring gains speed for ever; below it, it stays.
#[test]
fn a_constant_force_on_a_free_block() {
    let machine = Oscillator::new(2.0, 0.0).unwrap().with_damping(Damping::none());
    for (force, acceleration) in [(1.4, 0.45), (0.9, 0.0), (-1.4, -0.45)] {
        let scenario = Scenario::new(machine, CoulombStatic::new(0.5, 1.0).unwrap(), 1.0).unwrap();
        let scenario = scenario.driven_by(Excitation::harmonic(force, 0.0, 0.0).unwrap());
        let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(1.0, 11).unwrap()).unwrap();
        let x = motion.position().values()[10];
        assert!((x - 50.0 * acceleration).abs() < 1e-12, "{force} N: {x} m");
        assert_eq!(motion.rest().is_some(), acceleration == 0.0);
    }
    let law = Stribeck::new(0.3, 0.5, 0.1, 1.0, 0.0).unwrap();
    let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(0.0, 1.0).unwrap();
    assert!(RungeKutta::default().run(&scenario, &Sampling::uniform(0.1, 101).unwrap()).unwrap().rest().is_some());
}
