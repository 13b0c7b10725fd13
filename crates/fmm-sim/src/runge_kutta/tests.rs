//! Derivatives under steep laws and laws that jump: identities that hold whatever the motion is, and a motion that
//! creeps.

use fmm_friction::{Coulomb, Karnopp, LawFamily, MakkarDixon, PowerLaw, SlidingLaw, Stribeck};
use fmm_model::{Damping, Dual, Oscillator, Scalar};

use super::*;
use crate::scenario::{EventKind, Excitation};

/// Directions: mass, damping coefficient, angular frequency and belt velocity, then the parameters of a law.
type Numbers = Dual<9>;

const MASS: (f64, f64) = (1.0, 2.0);
const DAMPING: (f64, f64) = (0.3, 1.0);

/// A motion through some stops and reversals, with a wave and a belt if it is `driven`, and the numbers in it that have
/// a power of time in their units, with that power.
fn motion<F: LawFamily>(law: &[(f64, f64)], driven: bool, tolerance: f64) -> (Trajectory<Numbers>, Vec<(f64, f64)>)
where
    F::At<Numbers>: SlidingLaw<Numbers>,
{
    let (frequency, belt) = ((7.0, -1.0), (0.05, -1.0));
    let numbers: Vec<_> = [MASS, DAMPING, frequency, belt].into_iter().chain(law.iter().copied()).collect();
    let number = |index: usize| Numbers::variable(numbers[index].0, index);
    let values: Vec<_> = (4..numbers.len()).map(number).collect();
    let machine = Oscillator::new(number(0), Numbers::from(100.0)).unwrap();
    let machine = machine.with_damping(Damping::linear(number(1)).unwrap());
    let mut scenario = Scenario::new(machine, F::at(&values).unwrap(), Numbers::from(10.0))
        .and_then(|scenario| scenario.starting_at(Numbers::from(0.1), Numbers::from(0.0)))
        .unwrap();
    if driven {
        let wave = Excitation::harmonic(Numbers::from(1.5), number(2), Numbers::from(0.4)).unwrap();
        scenario = scenario.driven_by(wave).driven_by(Excitation::belt(number(3)).unwrap());
    }
    let sampling = Sampling::uniform(0.01, 201).unwrap();
    (RungeKutta::new(tolerance).unwrap().run(&scenario, &sampling).unwrap(), numbers)
}

/// Nothing depends on the unit of time: a number q of a unit with the power e of it has Σ e q ∂T/∂q = T for every time
/// T of an event, and Σ e q ∂x/∂q = −t v for the position at a given time t. The greatest miss, relative to the terms.
fn miss(motion: &Trajectory<Numbers>, numbers: &[(f64, f64)]) -> f64 {
    let mut worst = 0.0f64;
    let mut compare = |partial: &dyn Fn(usize) -> f64, expected: f64| {
        let terms = || numbers.iter().enumerate().map(|(direction, (q, power))| power * q * partial(direction));
        let size = terms().map(f64::abs).sum::<f64>() + expected.abs();
        if size > 0.0 {
            worst = worst.max((terms().sum::<f64>() - expected).abs() / size.max(1e-3));
        }
    };
    for event in motion.events().iter().filter(|event| !event.grazing) {
        compare(&|direction| event.time.partial(direction), event.time.value());
    }
    for (index, velocity) in motion.velocity().values().iter().enumerate() {
        let time = index as f64 * 0.01;
        compare(&|direction| motion.position().partial(direction).unwrap()[index], -time * velocity);
    }
    worst
}

/// Allowed errors of the derivatives of a run, for each of two tolerances.
const GOOD: [f64; 2] = [1e-7, 1e-5];

fn check<F: LawFamily>(law: &[(f64, f64)], driven: bool, allowed: [f64; 2])
where
    F::At<Numbers>: SlidingLaw<Numbers>,
{
    for (tolerance, allowed) in [3e-14, 1e-10].into_iter().zip(allowed) {
        let (motion, numbers) = motion::<F>(law, driven, tolerance);
        let turns = motion.events().iter().filter(|event| event.kind != EventKind::Start).count();
        assert!(turns >= 3, "{} {law:?}: {turns} events", F::NAME);
        let miss = miss(&motion, &numbers);
        assert!(miss < allowed, "{} {law:?}, driven: {driven}, to {tolerance:e}: {miss:e} off", F::NAME);
    }
}

/// The smaller the exponent, the less of the slope does a step see.
#[test]
fn derivatives_know_an_infinite_slope_at_rest() {
    for exponent in [0.95, 0.7, 0.5, 0.3, 0.2116] {
        check::<PowerLaw>(&[(0.1, exponent), (exponent, 0.0), (0.05, 0.0)], false, GOOD);
    }
    for exponent in [0.95, 0.7, 0.5] {
        check::<PowerLaw>(&[(0.1, exponent), (exponent, 0.0), (0.05, 0.0)], true, GOOD);
        let law = [(0.05, 0.0), (0.1, 0.0), (0.05, -1.0), (exponent, 0.0), (0.01, 1.0)];
        check::<Stribeck>(&law, false, GOOD);
        // A contact that breaks away where friction falls with the root of the speed begins without an acceleration, so
        // that its speed is no measure of time.
        check::<Stribeck>(&law, true, if exponent > 0.5 { GOOD } else { [1e-5, 1e-3] });
    }
}

#[test]
fn derivatives_know_the_jump_at_a_dead_zone() {
    for zone in [0.003, 0.01, 0.03] {
        for driven in [false, true] {
            check::<Karnopp>(&[(0.05, 0.0), (0.1, 0.0), (zone, -1.0)], driven, GOOD);
        }
    }
}

/// A motion that creeps towards rest is so near its end that steps far beyond the limit of stability keep its values
/// good.
#[test]
fn derivatives_of_a_motion_that_creeps_stay_small() {
    let law = [0.013_949, 83_740.9, 17.1668, 0.040_172_7, 348.469, 0.110_452];
    let sampling = Sampling::uniform(2e-3, 4000).unwrap();
    let of = |tolerance| {
        let values: Vec<Dual<6>> = law.iter().enumerate().map(|(index, value)| Dual::variable(*value, index)).collect();
        let machine =
            Oscillator::new(Dual::from(1.0), Dual::from((std::f64::consts::TAU * 2.335_720_18f64).powi(2))).unwrap();
        let scenario = Scenario::new(machine, MakkarDixon::at(&values).unwrap(), Dual::from(1.0))
            .and_then(|scenario| scenario.starting_at(Dual::from(0.008_379_69), Dual::from(0.0)))
            .unwrap();
        RungeKutta::new(tolerance).unwrap().run(&scenario, &sampling).unwrap()
    };
    let (fine, coarse) = (of(3e-14), of(1e-10));
    for (direction, value) in law.iter().enumerate() {
        let partials = |motion: &Trajectory<Dual<6>>| motion.velocity().partial(direction).unwrap().to_vec();
        let (fine, coarse) = (partials(&fine), partials(&coarse));
        let largest = fine.iter().fold(0.0f64, |largest, partial| largest.max(partial.abs()));
        assert!(largest * value < 1.0, "direction {direction}: {largest:e}");
        let off = fine.iter().zip(&coarse).fold(0.0f64, |off, (fine, coarse)| off.max((fine - coarse).abs()));
        assert!(off < 3e-3 * largest, "direction {direction}: {off:e} off, of {largest:e}");
    }
}

/// A run-down by dry friction and drag, v' = −a − c v²: t = atan(v₀ √(c/a))/√(a c), x = ln(1 + c v₀²/a)/(2c), however long
/// it was sampled and wherever it began.
#[test]
fn a_run_down_without_a_spring_keeps_its_digits() {
    let (dry, drag) = (2.0, 0.3);
    for (speed, end, begin) in
        [(2.0, 8.0, 0.0), (2.0, 800.0, 0.0), (50.0, 60.0, 1e3), (50.0, 6e4, 0.0), (1e-3, 1.0, 0.0)]
    {
        let machine = Oscillator::new(1.0, 0.0).unwrap().with_damping(Damping::new(0.0, drag).unwrap());
        let scenario = Scenario::new(machine, Coulomb::new(0.1 * dry).unwrap(), 10.0).unwrap();
        let scenario = scenario.starting_at(begin, speed).unwrap();
        let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(end / 8.0, 8).unwrap()).unwrap();
        let rest = motion.rest().expect("friction stops it");
        let time = (speed * (drag / dry).sqrt()).atan() / (dry * drag).sqrt();
        let path = (drag * speed * speed / dry).ln_1p() / (2.0 * drag);
        assert!((rest.time / time - 1.0).abs() < 1e-13, "{speed} m/s: {} s, {time} s", rest.time);
        let error = (rest.position - begin - path).abs();
        assert!(error < 1e-13 * path + 2.0 * f64::EPSILON * begin, "{speed} m/s, {end} s: {error} m");
    }
}

/// A block that a force moves from rest, m v' = F t − friction, is as exact as one that runs down.
#[test]
fn a_block_that_begins_from_rest_keeps_its_digits() {
    for end in [4.0, 4e3] {
        let scenario = Scenario::new(Oscillator::new(1.0, 0.0).unwrap(), Coulomb::new(0.2).unwrap(), 10.0).unwrap();
        let scenario = scenario.driven_by(Excitation::ramp(1.0).unwrap());
        let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(end / 4.0, 5).unwrap()).unwrap();
        // It breaks away at 2 s and has (t − 2 s)²/2 from there on.
        let expected = 0.5 * (end - 2.0).powi(2);
        let reached = motion.velocity().values()[4];
        assert!((reached / expected - 1.0).abs() < 1e-13, "{end} s: {reached} m/s, {expected} m/s");
    }
}
