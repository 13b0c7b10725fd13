//! Sampling: neither the sample times nor further knots on a straight piece of a force change a motion.

use fmm_sim::{RungeKutta, Sampling, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::agreement::{AGREEMENT, difference, is_ambiguous};
use super::contact::Family;
use super::setup::{Cause, Setup, Solver, setups};

const STEPPED: fn() -> Solver = || Solver::RungeKutta(RungeKutta::default());

/// Every family with each engine that takes it.
fn all(seed: u64, count: usize) -> impl Iterator<Item = (Setup, Solver)> {
    let exact =
        Family::EXACT.iter().flat_map(move |family| setups(seed, *family, true, count)).map(|s| (s, Solver::Exact));
    let stepped = Family::SLIDING.iter().flat_map(move |family| setups(seed, *family, false, count));
    exact.chain(stepped.map(|setup| (setup, STEPPED())))
}

fn state(motion: &Trajectory, index: usize) -> [f64; 2] {
    [motion.position().values()[index], motion.velocity().values()[index]]
}

/// Given times take the closed form or the polynomial at each of them: the others do not matter to a bit.
#[test]
fn more_times_change_nothing() {
    let mut random = ChaCha8Rng::seed_from_u64(111);
    for (setup, solver) in all(10, 100) {
        let mut few: Vec<f64> = (0..12).map(|_| random.random_range(0.0..setup.duration)).collect();
        few.push(setup.duration);
        let mut many = few.clone();
        many.extend((0..40).map(|_| random.random_range(0.0..setup.duration)));
        few.sort_by(f64::total_cmp);
        many.sort_by(f64::total_cmp);
        let motions = [&few, &many].map(|times| setup.motion(solver, &Sampling::at(times.clone()).unwrap()));
        assert_eq!(motions[0].events(), motions[1].events(), "{setup}");
        for (index, time) in few.iter().enumerate() {
            let other = many.iter().position(|other| other == time).unwrap();
            assert_eq!(state(&motions[0], index), state(&motions[1], other), "at {time} s: {setup}");
        }
    }
}

/// Uniform samples of the exact engine come from a table of powers, others from the closed form.
#[test]
fn equal_intervals_are_times_like_others() {
    for (setup, solver) in all(11, 100) {
        let uniform = setup.sampling(100);
        let times: Vec<f64> = (0..uniform.count()).map(|index| uniform.time(index)).collect();
        let (one, other) = (setup.motion(solver, &uniform), setup.motion(solver, &Sampling::at(times).unwrap()));
        assert_eq!(one.events(), other.events(), "{setup}");
        let size = one.position().values().iter().fold(setup.length, |size, x| size.max(x.abs()));
        for index in 0..uniform.count() {
            let ([x, v], [other_x, other_v]) = (state(&one, index), state(&other, index));
            let error = (x - other_x).abs().max((v - other_v).abs() / setup.angular());
            assert!(error <= 1e-13 * size, "sample {index} is {error:e} of {size:e} m off: {setup}");
        }
    }
}

/// The force of `setup` with `parts` samples in the place of one, on the same lines; values on a grid of 2⁻²⁰ of their
/// size.
fn resampled(setup: &Setup, parts: usize) -> Setup {
    let mut setup = setup.clone();
    for cause in &mut setup.causes {
        if let Cause::Sampled { interval, values } = cause {
            let last = values[values.len() - 1];
            let between = |pair: &[f64], part: usize| pair[0] + (pair[1] - pair[0]) * (part as f64 / parts as f64);
            let finer = values.windows(2).flat_map(|pair| (0..parts).map(move |part| between(pair, part)));
            *values = finer.chain([last]).collect();
            *interval /= parts as f64;
        }
    }
    setup
}

#[test]
fn more_knots_on_the_same_lines_change_nothing() {
    let mut checked = 0;
    for (mut setup, solver) in all(12, 300) {
        for cause in &mut setup.causes {
            if let Cause::Sampled { values, .. } = cause {
                let unit = 2f64.powi((setup.stiffness * setup.length).log2() as i32 - 20);
                for value in values.iter_mut() {
                    *value = (*value / unit).round() * unit;
                }
            }
        }
        if !setup.causes.iter().any(|cause| matches!(cause, Cause::Sampled { .. })) {
            continue;
        }
        let sampling = setup.sampling(24);
        let motion = setup.motion(solver, &sampling);
        // Halves of these numbers are exact, and a knot on a line is none; others may cut the line elsewhere.
        if setup.causes.len() == 1 {
            assert_eq!(resampled(&setup, 2).motion(solver, &sampling), motion, "{setup}");
        }
        if solver == Solver::Exact {
            // Thirds are rounded, and each knot is one more step of the closed form.
            let exact = setup.gradient(solver, &sampling);
            if !is_ambiguous(&setup, &exact) {
                let error = difference(&setup, &exact, &resampled(&setup, 3).motion(solver, &sampling));
                assert!(error < 1e-13, "{error:e} of what an error of each number would do: {setup}");
            }
        } else if Family::AFFINE.contains(&setup.family) && setup.pendulum.is_none() && setup.damping[1] == 0.0 {
            let exact = setup.gradient(Solver::Exact, &sampling);
            if !is_ambiguous(&setup, &exact) {
                let error = difference(&setup, &exact, &resampled(&setup, 3).motion(solver, &sampling));
                assert!(error < AGREEMENT, "{error:e} of what an error of each number would do: {setup}");
            }
        }
        checked += 1;
    }
    assert!(checked > 500, "{checked} setups");
}
