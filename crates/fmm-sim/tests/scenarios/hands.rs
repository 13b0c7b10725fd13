//! Short ways to write a scenario.

use fmm_friction::{Coulomb, Dahl, LawError, Stribeck};
use fmm_model::{Dual, Oscillator, Scalar};
use fmm_sim::{Engine, Exact, Excitation, RungeKutta, Sampling, Scenario, Trajectory, simulate};

fn machine() -> Oscillator {
    Oscillator::new(1.0, 100.0).unwrap()
}

/// The engine follows from the law, and no number but the first needs a type.
#[test]
fn the_law_chooses_the_engine_and_the_scenario_the_numbers() {
    let sampling = Sampling::uniform(1e-2, 50).unwrap();
    let coulomb = Scenario::new(machine(), Coulomb::new(0.2).unwrap(), 10.0).unwrap().starting_at(0.1, 0.0).unwrap();
    assert_eq!(simulate(&coulomb, &sampling), Exact.run(&coulomb, &sampling));
    let law = Stribeck::new(0.2, 0.3, 0.1, 1.0, 0.0).unwrap();
    let stribeck = Scenario::new(machine(), law, 10.0).unwrap().starting_at(0.1, 0.0).unwrap();
    assert_eq!(simulate(&stribeck, &sampling), RungeKutta::default().run(&stribeck, &sampling));
    let dahl = Scenario::new(machine(), Dahl::new(0.2, 1e3, 1.0).unwrap(), 10.0).unwrap();
    assert_eq!(simulate(&dahl, &sampling).unwrap().engine(), "bristle");

    let oscillator = Oscillator::new(Dual::<1>::from(1.0), Dual::from(100.0)).unwrap();
    let law = Coulomb::new(Dual::variable(0.2, 0)).unwrap();
    let scenario = Scenario::new(oscillator, law, Dual::from(10.0)).unwrap();
    let scenario = scenario.starting_at(Dual::from(0.1), Dual::from(0.0)).unwrap();
    // The first turning point is at −(x₀ − 2 μ N/k).
    let motion = simulate(&scenario, &sampling).unwrap();
    assert!((motion.events()[1].position.partial(0) - 0.2).abs() < 1e-14);
}

#[test]
fn a_trajectory_knows_its_times() {
    let scenario = Scenario::new(machine(), Coulomb::new(0.2).unwrap(), 10.0).unwrap();
    let times = |sampling: &Sampling| simulate(&scenario, sampling).unwrap().times().collect::<Vec<_>>();
    let uniform = Sampling::uniform(0.25, 6).unwrap();
    assert_eq!(times(&uniform), [0.0, 0.25, 0.5, 0.75, 1.0, 1.25]);
    assert_eq!(times(&uniform.window(2..4).unwrap()), [0.5, 0.75]);
    assert_eq!(times(&Sampling::at([0.1, 0.7]).unwrap()), [0.1, 0.7]);
    assert_eq!(Trajectory::<f64>::new().times().len(), 0);
}

/// A constant force shifts the centre and nothing else.
#[test]
fn constant_forces_shift_the_centre() {
    let still = Scenario::new(machine(), Coulomb::new(0.2).unwrap(), 10.0).unwrap();
    let biased = still.clone().driven_by(Excitation::constant(5.0).unwrap()).starting_at(0.15, 0.0).unwrap();
    let still = still.starting_at(0.1, 0.0).unwrap();
    let sampling = Sampling::uniform(1e-2, 100).unwrap();
    let (still, biased) = (simulate(&still, &sampling).unwrap(), simulate(&biased, &sampling).unwrap());
    assert_eq!(biased.engine(), "exact");
    for (x, shifted) in still.position().values().iter().zip(biased.position().values()) {
        assert!((shifted - x - 0.05).abs() < 1e-15, "{shifted} against {x} m");
    }
    assert!(biased.rest().is_some());
    assert!(Excitation::constant(f64::NAN).is_err());
}

/// Straight lines through a wave come near the wave with the square of the interval.
#[test]
fn functions_of_time_are_lines() {
    let scenario = Scenario::new(machine(), Coulomb::new(0.2).unwrap(), 10.0).unwrap();
    let sampling = Sampling::uniform(1e-2, 200).unwrap();
    let wave = scenario.clone().driven_by(Excitation::harmonic(8.0, 6.0, 0.0).unwrap());
    let wave = simulate(&wave, &sampling).unwrap();
    let off = |interval: f64| {
        let lines = Excitation::function(interval, 2.0, |t| 8.0 * (6.0 * t).cos()).unwrap();
        let lines = simulate(&scenario.clone().driven_by(lines), &sampling).unwrap();
        let pairs = lines.position().values().iter().zip(wave.position().values());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let offs = [1e-2, 1e-3].map(off);
    assert!(offs[0] < 1e-3 && offs[1] < 0.02 * offs[0], "{offs:?} m");
    for (interval, duration) in [(0.0, 1.0), (1.0, f64::NAN), (1e-300, 1e300)] {
        assert!(Excitation::function(interval, duration, |t| t).is_err());
    }
}

#[test]
fn laws_of_ones_own_can_say_what_is_wrong() {
    let error = LawError::Contradiction { what: "sticky needs a < b, but a = 2 and b = 1".to_owned() };
    assert_eq!(error.to_string(), "sticky needs a < b, but a = 2 and b = 1");
}
