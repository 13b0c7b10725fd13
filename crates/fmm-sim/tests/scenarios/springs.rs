//! Springs that harden or soften, against elliptic integrals and the balance of energy.

use std::f64::consts::FRAC_PI_2;

use fmm_friction::{AccelerationCoulomb, Berger, Coulomb, Dahl, SlidingLaw};
use fmm_model::{Dual, Oscillator, Restoring, Scalar};
use fmm_sim::{
    Bristle, Engine, EventKind, Excitation, Mode, RungeKutta, Sampling, Scenario, SimulationError, simulate,
};

const STIFFNESS: f64 = 50.0;
const MASS: f64 = 2.0;

fn sprung<D: Scalar>(restoring: Restoring<D>) -> Oscillator<D> {
    Oscillator::new(D::from(MASS), D::from(STIFFNESS)).unwrap().with_restoring(restoring)
}

fn machine<D: Scalar>(cubic: D, quintic: D) -> Oscillator<D> {
    sprung(Restoring::polynomial(cubic, quintic).unwrap())
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
fn reversals(machine: Oscillator, amplitude: f64, end: f64) -> Vec<f64> {
    let scenario = Scenario::new(machine, Coulomb::new(0.0).unwrap(), 1.0).unwrap();
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
        let times = reversals(machine(cubic, 0.0), amplitude, 10.0 * period);
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
    for (event, time) in swings.zip(reversals(machine(-1.0 / 6.0, 1.0 / 120.0), 0.1, 10.0)) {
        assert!((event.time / time - 1.0).abs() < 0.1f64.powi(6) / 5040.0, "{} {time}", event.time);
    }
}

/// A release from A beyond a corner at g: a sine of the outer stiffness about the point where that force would vanish,
/// then one of the inner stiffness, or a straight line across a gap.
#[test]
fn periods_with_corners_are_sums_of_arcs() {
    let angular = (STIFFNESS / MASS).sqrt();
    for (corner, inner, outer, amplitude) in
        [(0.3, 1.0, 6.0, 0.8), (0.3, 1.0, 0.25, 0.9), (0.1, 0.0, 1.0, 0.5), (0.2, 1.0, 40.0, 0.21)]
    {
        let restoring =
            if inner == 0.0 { Restoring::gap(corner).unwrap() } else { Restoring::stop(corner, outer).unwrap() };
        let (slow, fast) = (angular * f64::sqrt(inner), angular * f64::sqrt(outer));
        // F = k b (x − c) outside.
        let centre = corner * (1.0 - inner / outer);
        let reach = amplitude - centre;
        let arc = ((corner - centre) / reach).acos() / fast;
        let speed: f64 = fast * (reach * reach - (corner - centre).powi(2)).sqrt();
        let inside = if inner == 0.0 { corner / speed } else { (slow * corner / speed).atan() / slow };
        let period = 4.0 * (arc + inside);
        let times = reversals(sprung(restoring), amplitude, 10.0 * period);
        for (index, time) in times.iter().enumerate() {
            let expected = 0.5 * period * (index + 1) as f64;
            assert!((time / expected - 1.0).abs() < 1e-11, "{restoring:?}: {time} s for {expected} s");
        }
        assert!(times.len() >= 19, "{} reversals", times.len());
    }
}

/// Dahl's bristles on a spring with a corner: they come near Coulomb's friction, which another engine passes, as the
/// root of their compliance, as on a spring without, and the engine's own tolerance does not matter.
#[test]
fn bristles_pass_corners() {
    let sampling = Sampling::uniform(0.02, 101).unwrap();
    let run = |stiffness: f64, tolerance: f64| {
        let machine = sprung(Restoring::stop(0.3, 6.0).unwrap());
        let scenario = Scenario::new(machine, Dahl::new(1.3, stiffness, 1.0).unwrap(), 1.0).unwrap();
        let scenario = scenario.starting_at(0.7, 0.0).unwrap();
        Bristle::new(tolerance).unwrap().run(&scenario, &sampling).unwrap().position().values().to_vec()
    };
    let largest = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let fine = run(130.0, 1e-13);
    let coarse = largest(&run(130.0, 1e-9), &fine);
    assert!(coarse < 1e-7, "{coarse} m between tolerances");
    let coulomb = Scenario::new(sprung(Restoring::stop(0.3, 6.0).unwrap()), Coulomb::new(1.3).unwrap(), 1.0).unwrap();
    let coulomb = simulate(&coulomb.starting_at(0.7, 0.0).unwrap(), &sampling).unwrap();
    let off = [1e4, 1e6].map(|stiffness| largest(&run(stiffness, 1e-10), coulomb.position().values()));
    assert!(off[0] < 2e-3 && off[1] < 0.11 * off[0], "{off:?} m from Coulomb's law");
}

/// The turning points under friction F follow from the energy of the spring, k (x²/2 + k₃ x⁴/4 + k₅ x⁶/6) or two
/// parabolas, and the work F |Δx|.
#[test]
fn turning_points_follow_from_energy() {
    let friction = 1.3;
    let corners = [Restoring::stop(0.3, 6.0), Restoring::stop(0.3, 0.2), Restoring::gap(0.1)];
    let springs = [(3.0, 0.0), (-0.8, 0.0), (-2.0, 4.0), (10.0, 5.0)].map(|(cubic, quintic)| machine(cubic, quintic));
    for machine in springs.into_iter().chain(corners.map(|restoring| sprung(restoring.unwrap()))) {
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
            assert!((event.position - inside).abs() < 1e-12, "{machine:?}: {} for {inside}", event.position);
            (from, turns) = (event.position, turns + 1);
            // The next one would lie on this side of the middle.
            if machine.potential_energy(from) < friction * from.abs() {
                break;
            }
        }
        assert!(turns > 3, "{turns} turning points");
    }
}

/// Two branches of one level are Coulomb friction on a bent spring too: no steady speed lies between them.
#[test]
fn branches_of_one_level_are_coulomb_friction() {
    let sampling = Sampling::uniform(0.05, 201).unwrap();
    for (cubic, quintic) in [(0.0, 0.0), (3.0, 0.0), (-0.8, 0.0), (-2.0, 4.0)] {
        let machine = machine(cubic, quintic);
        let one = Scenario::new(machine, Coulomb::new(1.3).unwrap(), 1.0).unwrap();
        let one = simulate(&one.starting_at(0.7, 0.0).unwrap(), &sampling).unwrap();
        let two = Scenario::new(machine, AccelerationCoulomb::new(1.3, 1.3).unwrap(), 1.0).unwrap();
        let two = simulate(&two.starting_at(0.7, 0.0).unwrap(), &sampling).unwrap();
        for (one, two) in one.position().values().iter().zip(two.position().values()) {
            assert!((one - two).abs() < 1e-9, "{cubic} {quintic}: {one} {two}");
        }
    }
}

/// Derivatives by both numbers of a spring, through the reversals, against differences: of k₃ and k₅, of where a stop
/// is and how stiff; under friction that has one level, and one that depends on whether the speed grows.
#[test]
fn derivatives_know_the_spring() {
    let polynomial = |numbers: [Dual<2>; 2]| Restoring::polynomial(numbers[0], numbers[1]).unwrap();
    let stop = |numbers: [Dual<2>; 2]| Restoring::stop(numbers[0], numbers[1]).unwrap();
    let coulomb = Coulomb::new(Dual::from(0.8)).unwrap();
    let by_acceleration = AccelerationCoulomb::new(Dual::from(0.8), Dual::from(0.5)).unwrap();
    let berger = Berger::new(Dual::from(0.8), Dual::from(0.1), Dual::from(0.05)).unwrap();
    agrees_with_differences([2.0, -1.0], polynomial, coulomb);
    agrees_with_differences([2.0, -1.0], polynomial, berger);
    agrees_with_differences([2.0, -1.0], polynomial, by_acceleration);
    agrees_with_differences([0.2, 5.0], stop, by_acceleration);
    agrees_with_differences([0.2, 5.0], stop, coulomb);
    agrees_with_differences([0.2, 0.3], stop, berger);
}

fn agrees_with_differences<L: SlidingLaw<Dual<2>> + Copy>(
    numbers: [f64; 2],
    spring: impl Fn([Dual<2>; 2]) -> Restoring<Dual<2>>,
    law: L,
) {
    let run = |numbers: [Dual<2>; 2]| {
        let scenario = Scenario::new(sprung(spring(numbers)), law, Dual::from(1.0));
        let scenario = scenario.unwrap().starting_at(Dual::from(0.6), Dual::from(0.0)).unwrap();
        RungeKutta::new(1e-14).unwrap().run(&scenario, &Sampling::uniform(0.037, 60).unwrap()).unwrap()
    };
    let exact = run([0, 1].map(|direction| Dual::variable(numbers[direction], direction)));
    let step = 1e-3;
    for direction in 0..2 {
        let at = |factor: f64| {
            let mut moved = numbers;
            moved[direction] += factor * step;
            run(moved.map(Dual::from)).position().values().to_vec()
        };
        // Of fourth order, extrapolated once.
        let central = |factor: f64| {
            let [far_below, below, above, far_above] = [-2.0, -1.0, 1.0, 2.0].map(|share| at(share * factor));
            let difference =
                |i: usize| (8.0 * (above[i] - below[i]) - (far_above[i] - far_below[i])) / (12.0 * factor * step);
            (0..60).map(difference).collect::<Vec<_>>()
        };
        let (wide, narrow) = (central(1.0), central(0.5));
        let partial = exact.position().partial(direction).unwrap();
        let largest = partial.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let off = (0..60).filter(|&i| {
            let difference = narrow[i] + (narrow[i] - wide[i]) / 15.0;
            (difference - partial[i]).abs() > 1e-8 * largest
        });
        // A reversal, or the passage of a corner, may cross a sample within the step.
        let off = off.count();
        assert!(largest > 1e-3 && off <= 4, "{numbers:?}, direction {direction}: {off} samples differ");
    }
}

/// Friction that is higher while the speed grows holds a constant speed from where the spring balances the one level to
/// where it balances the other.
#[test]
fn constant_speeds_end_where_the_spring_says() {
    let (gaining, losing) = (0.8, 0.5);
    for machine in [machine(30.0, 0.0), machine(-1.0, 0.5), sprung(Restoring::stop(0.013, 3.0).unwrap())] {
        let law = AccelerationCoulomb::new(gaining, losing).unwrap();
        let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(0.6, 0.0).unwrap();
        let motion = simulate(&scenario, &Sampling::uniform(0.01, 301).unwrap().with_work()).unwrap();
        let mut phases = 0;
        for pair in motion.events().windows(2).filter(|pair| matches!(pair[0].next, Mode::Steady(_))) {
            let [from, to] = [pair[0].position, pair[1].position].map(|x| machine.restoring_force(x).abs());
            // Of the forces at the release, 20 to 400 N, the engine is good to some 1e-14.
            assert!((from - gaining).abs() < 1e-11 && (to - losing).abs() < 1e-11, "{machine:?}: {from} N to {to} N");
            let way = pair[0].velocity * (pair[1].time - pair[0].time);
            assert!((pair[1].position - pair[0].position - way).abs() < 1e-13 && pair[0].velocity == pair[1].velocity);
            phases += 1;
        }
        assert!(phases > 3, "{machine:?}: {phases} phases");
        assert!(motion.energy_imbalance(&scenario).is_some_and(|imbalance| imbalance < 1e-11), "{machine:?}");
    }
}

#[test]
fn springs_that_push_away_are_refused() {
    let scenario = Scenario::new(machine(-2.0, 0.0), Coulomb::new(0.1).unwrap(), 1.0).unwrap();
    let scenario = scenario.starting_at(0.5, 5.0).unwrap();
    let sampling = Sampling::uniform(1e-2, 300).unwrap();
    let refused = simulate(&scenario, &sampling);
    assert!(matches!(refused, Err(SimulationError::OutOfRange { .. })), "{refused:?}");
    let bristles = Scenario::new(machine(-2.0, 0.0), Dahl::new(0.1, 100.0, 1.0).unwrap(), 1.0).unwrap();
    let refused = Bristle::default().run(&bristles.starting_at(0.5, 5.0).unwrap(), &sampling);
    assert!(matches!(refused, Err(SimulationError::OutOfRange { .. })), "{refused:?}");
    for machine in [machine(2.0, 0.0), sprung(Restoring::gap(0.1).unwrap())] {
        let belt = Scenario::new(machine, Coulomb::new(0.1).unwrap(), 1.0).unwrap();
        let refused = simulate(&belt.driven_by(Excitation::belt(0.1).unwrap()), &sampling);
        assert!(matches!(refused, Err(SimulationError::NotSupported { .. })), "{refused:?}");
    }
}
