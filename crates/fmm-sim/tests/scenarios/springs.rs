//! Springs that harden or soften, against elliptic integrals and the balance of energy.

use std::f64::consts::FRAC_PI_2;

use fmm_friction::{Coulomb, Dahl};
use fmm_model::{Dual, Oscillator, Restoring, Scalar};
use fmm_sim::{Bristle, Engine, EventKind, Excitation, RungeKutta, Sampling, Scenario, SimulationError, simulate};

const STIFFNESS: f64 = 50.0;
const MASS: f64 = 2.0;

fn machine<D: Scalar>(cubic: D, quintic: D) -> Oscillator<D> {
    let restoring = Restoring::polynomial(cubic, quintic).unwrap();
    Oscillator::new(D::from(MASS), D::from(STIFFNESS)).unwrap().with_restoring(restoring)
}

/// K(m), by the arithmetic-geometric mean.
fn complete_elliptic(m: f64) -> f64 {
    let (mut a, mut g) = (1.0, (1.0 - m).sqrt());
    for _ in 0..40 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    FRAC_PI_2 / a
}

/// Times of the reversals of a release from `amplitude` without friction.
fn reversals(cubic: f64, quintic: f64, amplitude: f64, end: f64) -> Vec<f64> {
    let scenario = Scenario::new(machine(cubic, quintic), Coulomb::new(0.0).unwrap(), 1.0).unwrap();
    let scenario = scenario.starting_at(amplitude, 0.0).unwrap();
    let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(end / 100.0, 101).unwrap()).unwrap();
    let reversals = motion.events().iter().filter(|event| event.kind == EventKind::Reversal);
    reversals.map(|event| event.time).collect()
}

/// x = A cn(Ω t), Ω² = ω² (1 + k₃ A²), m = k₃ A² ω²/2Ω².
#[test]
fn periods_are_elliptic_integrals() {
    let angular = (STIFFNESS / MASS).sqrt();
    for (cubic, amplitude) in [(3.0, 0.8), (40.0, 1.0), (-0.5, 0.9), (-2.0, 0.6)] {
        let shape: f64 = cubic * amplitude * amplitude;
        let stiffened = angular * (1.0 + shape).sqrt();
        let period = 4.0 * complete_elliptic(0.5 * shape / (1.0 + shape)) / stiffened;
        let times = reversals(cubic, 0.0, amplitude, 10.0 * period);
        for (index, time) in times.iter().enumerate() {
            let expected = 0.5 * period * (index + 1) as f64;
            assert!((time / expected - 1.0).abs() < 1e-10, "k₃ = {cubic}: {time} s for {expected} s");
        }
        assert!(times.len() >= 19, "{} reversals", times.len());
    }
    // The sine to fifth order: its period differs by the next term, A⁶/5040 at most.
    let sine = Scenario::new(
        Oscillator::new(MASS, STIFFNESS).unwrap().with_restoring(Restoring::sine(1.0).unwrap()),
        Coulomb::new(0.0).unwrap(),
        1.0,
    );
    let sine = sine.unwrap().starting_at(0.1, 0.0).unwrap();
    let motion = simulate(&sine, &Sampling::uniform(0.1, 101).unwrap()).unwrap();
    let swings = motion.events().iter().filter(|event| event.kind == EventKind::Reversal);
    for (event, time) in swings.zip(reversals(-1.0 / 6.0, 1.0 / 120.0, 0.1, 10.0)) {
        assert!((event.time / time - 1.0).abs() < 0.1f64.powi(6) / 5040.0, "{} {time}", event.time);
    }
}

/// The turning points under friction F follow from k (x²/2 + k₃ x⁴/4 + k₅ x⁶/6) and the work F |Δx|.
#[test]
fn turning_points_follow_from_energy() {
    let friction = 1.3;
    for (cubic, quintic) in [(3.0, 0.0), (-0.8, 0.0), (-2.0, 4.0), (10.0, 5.0)] {
        let machine = machine(cubic, quintic);
        let scenario = Scenario::new(machine, Coulomb::new(friction).unwrap(), 1.0).unwrap();
        let scenario = scenario.starting_at(0.7, 0.0).unwrap();
        let motion = simulate(&scenario, &Sampling::uniform(0.05, 201).unwrap()).unwrap();
        let mut from: f64 = 0.7;
        let mut turns = 0;
        for event in motion.events().iter().filter(|event| matches!(event.kind, EventKind::Reversal | EventKind::Stop))
        {
            let excess =
                |x: f64| machine.potential_energy(x) - machine.potential_energy(from) + friction * (x - from).abs();
            // Between the middle and the point opposite there is one root.
            let (mut inside, mut outside) = (0.0, -from);
            for _ in 0..200 {
                let middle = 0.5 * (inside + outside);
                if excess(middle) < 0.0 { inside = middle } else { outside = middle }
            }
            assert!((event.position - inside).abs() < 1e-12, "{cubic}, {quintic}: {} for {inside}", event.position);
            (from, turns) = (event.position, turns + 1);
            // The next one would lie on this side of the middle.
            if machine.potential_energy(from) < friction * from.abs() {
                break;
            }
        }
        assert!(turns > 3, "{turns} turning points");
    }
}

/// Derivatives by k₃ and k₅, through the reversals, against differences.
#[test]
fn derivatives_know_the_spring() {
    let run = |cubic: Dual<2>, quintic: Dual<2>| {
        let scenario = Scenario::new(machine(cubic, quintic), Coulomb::new(Dual::from(0.8)).unwrap(), Dual::from(1.0));
        let scenario = scenario.unwrap().starting_at(Dual::from(0.6), Dual::from(0.0)).unwrap();
        RungeKutta::new(1e-14).unwrap().run(&scenario, &Sampling::uniform(0.037, 60).unwrap()).unwrap()
    };
    let (cubic, quintic) = (2.0, -1.0);
    let exact = run(Dual::variable(cubic, 0), Dual::variable(quintic, 1));
    let step = 1e-3;
    for direction in 0..2 {
        let at = |factor: f64| {
            let by = factor * step;
            let (a, b) = if direction == 0 { (cubic + by, quintic) } else { (cubic, quintic + by) };
            run(Dual::from(a), Dual::from(b)).position().values().to_vec()
        };
        // Of fourth order.
        let [far_below, below, above, far_above] = [at(-2.0), at(-1.0), at(1.0), at(2.0)];
        let partial = exact.position().partial(direction).unwrap();
        let largest = partial.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let off = (0..60).filter(|&i| {
            let difference = (8.0 * (above[i] - below[i]) - (far_above[i] - far_below[i])) / (12.0 * step);
            (difference - partial[i]).abs() > 1e-8 * largest
        });
        // A reversal may cross a sample within the step.
        let off = off.count();
        assert!(largest > 1e-3 && off <= 2, "direction {direction}: {off} samples differ");
    }
}

#[test]
fn springs_that_push_away_are_refused() {
    let scenario = Scenario::new(machine(-2.0, 0.0), Coulomb::new(0.1).unwrap(), 1.0).unwrap();
    let scenario = scenario.starting_at(0.5, 5.0).unwrap();
    let sampling = Sampling::uniform(1e-2, 300).unwrap();
    let refused = simulate(&scenario, &sampling);
    assert!(matches!(refused, Err(SimulationError::NotRestoring { .. })), "{refused:?}");
    let bristles = Scenario::new(machine(-2.0, 0.0), Dahl::new(0.1, 100.0, 1.0).unwrap(), 1.0).unwrap();
    let refused = Bristle::default().run(&bristles.starting_at(0.5, 5.0).unwrap(), &sampling);
    assert!(matches!(refused, Err(SimulationError::NotRestoring { .. })), "{refused:?}");
    let belt = Scenario::new(machine(2.0, 0.0), Coulomb::new(0.1).unwrap(), 1.0).unwrap();
    let refused = simulate(&belt.driven_by(Excitation::belt(0.1).unwrap()), &sampling);
    assert!(matches!(refused, Err(SimulationError::NotSupported { .. })), "{refused:?}");
}
