//! Events that a method could step over: peaks a billionth of a newton high or a microsecond long, waves on waves.

use fmm_friction::CoulombStatic;
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Engine, EventKind, Exact, Excitation, RungeKutta, Sampling, Scenario, SimulationError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::agreement::{AGREEMENT, difference, is_ambiguous};
use super::contact::Family;
use super::setup::{Cause, Solver, setups};
use crate::case::log_uniform;

/// Distance of a peak from the static level (N), of levels of 1 N or so.
const HAIR: f64 = 1e-9;

/// Causes whose load, with one another and on a machine at rest at zero, peaks at `peak` (N) and `time` (s); no other
/// peak is within 10 ppm of it. `frequency` (Hz) is about that of the slowest.
fn causes(random: &mut ChaCha8Rng, peak: f64, time: f64, frequency: f64) -> Vec<Excitation> {
    let angular = std::f64::consts::TAU * frequency;
    match random.random_range(0..4) {
        0 => vec![Excitation::harmonic(peak, angular, -angular * time).unwrap()],
        1 => {
            let duration = log_uniform(random, -6.0, -1.0) / frequency;
            let pulse = Excitation::half_sine(peak, duration).unwrap();
            vec![pulse.delayed((time - 0.5 * duration).max(0.0)).unwrap()]
        }
        2 => {
            let rise = log_uniform(random, -6.0, -1.0) / frequency;
            let pulse = Excitation::sampled_force(rise, vec![0.0, peak, 0.0]).unwrap();
            vec![pulse.delayed((time - rise).max(0.0)).unwrap()]
        }
        _ => {
            // A small fast wave on a large slow one; they are in phase once.
            let (small, fast) = (peak * random.random_range(0.01..0.3), angular * random.random_range(30.3..300.3));
            let slow = Excitation::harmonic(peak - small, angular, -angular * time).unwrap();
            vec![slow, Excitation::harmonic(small, fast, -fast * time).unwrap()]
        }
    }
}

/// True if the contact breaks away on either engine before `end`, seen by no sample in between; none where an engine
/// says that the spring is too weak for it.
fn breaks_away(level: f64, causes: &[Excitation], machine: Oscillator, end: f64) -> [Option<bool>; 2] {
    let law = CoulombStatic::new(0.5 * level, level).unwrap();
    let start = Scenario::new(machine, law, 1.0).unwrap();
    let scenario = causes.iter().cloned().fold(start, Scenario::driven_by);
    let sampling = Sampling::at(vec![end]).unwrap();
    let motions = [Exact.run(&scenario, &sampling), RungeKutta::default().run(&scenario, &sampling)];
    motions.map(|motion| match motion {
        Ok(motion) => Some(motion.events().iter().any(|event| event.kind == EventKind::Breakaway)),
        Err(SimulationError::NoClosedForm { .. }) => None,
        Err(error) => panic!("{error}"),
    })
}

#[test]
fn a_hair_decides_whether_a_contact_breaks_away() {
    let mut random = ChaCha8Rng::seed_from_u64(101);
    let mut refused = 0;
    for _ in 0..4000 {
        let (level, frequency) = (log_uniform(&mut random, -1.0, 1.0), log_uniform(&mut random, -1.0, 3.0));
        let (mass, natural) = (log_uniform(&mut random, -3.0, 3.0), 6.3 * log_uniform(&mut random, -1.0, 3.0));
        let damping = Damping::linear(mass * natural * random.random_range(0.1..2.0)).unwrap();
        let machine = Oscillator::new(mass, mass * natural * natural).unwrap().with_damping(damping);
        // The first peak of a wave comes in its first period.
        let (time, end) = (random.random_range(0.3..0.8) / frequency, 0.9 / frequency);
        let seed = random.random::<u64>();
        for (peak, breaks) in [(level + HAIR, true), (level - HAIR, false)] {
            let causes = causes(&mut ChaCha8Rng::seed_from_u64(seed), peak, time, frequency);
            let [exact, stepped] = breaks_away(level, &causes, machine, end);
            refused += usize::from(exact.is_none());
            assert_eq!(
                [exact.unwrap_or(breaks), stepped.expect("steps need no spring")],
                [breaks; 2],
                "exact and stepped: a peak of {peak} N at {time} s under {causes:?} on a level of {level} N, {machine:?}"
            );
        }
    }
    assert!(refused < 80, "{refused} of 8000 refused");
}

/// A small fast wave shakes a slow one: reversals, stops and breakaways by the dozen.
#[test]
fn fast_waves_on_slow_ones_cost_no_event() {
    let mut random = ChaCha8Rng::seed_from_u64(102);
    let (mut events, mut checked) = (0, 0);
    for mut setup in setups(7, Family::CoulombStatic, true, 400) {
        let (force, angular) = (setup.stiffness * setup.length, setup.angular());
        setup.causes.truncate(1);
        setup.causes.push(Cause::Harmonic {
            amplitude: force * log_uniform(&mut random, -1.0, 0.5),
            angular: angular * random.random_range(10.0..100.0),
            phase: random.random_range(-3.0..3.0),
        });
        let sampling = setup.sampling(7);
        let exact = setup.gradient(Solver::Exact, &sampling);
        if is_ambiguous(&setup, &exact) {
            continue;
        }
        let stepped = setup.motion(Solver::RungeKutta(RungeKutta::default()), &sampling);
        let error = difference(&setup, &exact, &stepped);
        assert!(error < AGREEMENT, "{error:e} of what an error of each number would do: {setup}");
        (events, checked) = (events + exact.events().len(), checked + 1);
    }
    println!("{events} {checked}");
    assert!(checked >= 380 && events >= 10 * checked, "{events} events in {checked} setups");
}
