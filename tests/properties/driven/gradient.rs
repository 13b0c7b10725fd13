//! Derivatives through all kinds of events, in every number of a law, a machine and a force, against differences.

use fmm_model::Scalar;
use fmm_sim::{EventKind, RungeKutta, Samples, Sampling, Trajectory};

use super::agreement::{Reach, is_ambiguous};
use super::contact::Family;
use super::setup::{Gradient, Setup, Solver, setups};

/// Part of a number by which it is changed for a difference.
const STEP: f64 = 1e-3;

/// Rounding of a run, and for a stepped one what its steps change, in units of how far an error reaches.
const NOISE: f64 = 2e-11;

/// The motion with the number of `direction` changed by `change`.
fn changed(setup: &Setup, solver: Solver, sampling: &Sampling, direction: usize, change: f64) -> Option<Trajectory> {
    let mut index = 0;
    let number = |_, value| {
        index += 1;
        if index == direction + 1 { value + change } else { value }
    };
    setup.run(solver, sampling, number).ok()
}

/// Central differences over two widths, at −2, −1, 1 and 2 steps: of fourth order, and how much the widths differ.
fn difference(values: [f64; 4], step: f64) -> (f64, f64) {
    let (wide, narrow) = ((values[3] - values[0]) / (4.0 * step), (values[2] - values[1]) / (2.0 * step));
    ((4.0 * narrow - wide) / 3.0, (narrow - wide).abs())
}

/// Compares the derivatives in one number with differences; false if events come, go or change on the way.
fn column_agrees(setup: &Setup, solver: Solver, sampling: &Sampling, exact: &Trajectory<Gradient>, direction: usize) -> bool {
    let reach = Reach::of(setup);
    let (name, value) = setup.numbers()[direction];
    let (size, step) = (reach.size(direction), reach.size(direction) * STEP);
    // The numbers of a machine, a law and a load have zero as their bound, and a law of two branches its kink at a speed of zero.
    let bounded = !matches!(name, "x₀" | "v₀" | "φ" | "peak" | "rate" | "amplitude" | "base amplitude" | "v_b");
    if bounded && value < 3.0 * step || name == "v₀" && value.abs() < 3.0 * step || size == 0.0 {
        return false;
    }
    // Equal levels are the bound of a static level.
    if name == "law" && setup.law.iter().filter(|other| (*other - value).abs() < 3.0 * step).count() > 1 {
        return false;
    }
    let runs = [-2.0, -1.0, 1.0, 2.0].map(|multiple| changed(setup, solver, sampling, direction, multiple * step));
    let [Some(a), Some(b), Some(c), Some(d)] = runs else { return false };
    let runs = [a, b, c, d];
    let kinds = |run: &Trajectory| run.events().iter().map(|event| (event.kind, event.next)).collect::<Vec<_>>();
    let expected: Vec<_> = exact.events().iter().map(|event| (event.kind, event.next)).collect();
    if runs.iter().any(|run| kinds(run) != expected) {
        return false;
    }
    let agree = |what: &str, time: f64, derivative: f64, values: [f64; 4], noise: f64| {
        let (expected, spread) = difference(values, step);
        // The widths differ by three times the error of second order; that of fourth order is smaller still.
        let allowed = 0.1 * spread + NOISE / STEP * noise / size;
        let error = derivative - expected;
        assert!(
            error.abs() <= allowed,
            "∂{what}/∂{name} at {time} s is {derivative:e}, not {expected:e}: {error:e} off, {allowed:e} allowed: {setup}"
        );
    };

    let length = exact.position().values().iter().fold(setup.length, |size, x| size.max(x.abs()));
    for (index, event) in exact.events().iter().enumerate() {
        let time = event.time.value();
        let values = |part: &dyn Fn(&Trajectory) -> f64| [0, 1, 2, 3].map(|run| part(&runs[run]));
        let noise = reach.number(event.time) + time;
        agree("t of an event", time, event.time.partial(direction), values(&|run| run.events()[index].time), noise);
        let noise = reach.number(event.position) + length;
        agree("x of an event", time, event.position.partial(direction), values(&|run| run.events()[index].position), noise);
    }
    // Between the earliest and the latest of an event the runs are in different modes; a kink of the force is fixed in time.
    let jumps: Vec<_> = (1..expected.len())
        .map(|index| {
            let times = runs.iter().map(|run| run.events()[index].time).chain([exact.events()[index].time.value()]);
            times.fold((f64::INFINITY, 0.0f64), |(first, last), time| (first.min(time), last.max(time)))
        })
        .collect();
    for index in 0..sampling.count() {
        let time = sampling.time(index);
        if jumps.iter().any(|(first, last)| (*first..=*last).contains(&time)) || setup.changes_between(name, time, step) {
            continue;
        }
        let column = |what: &str, samples: &Samples<Gradient>, of: fn(&Trajectory) -> &Samples<f64>, length: f64| {
            let values = [0, 1, 2, 3].map(|run| of(&runs[run]).values()[index]);
            let noise = reach.sample(samples, index) + length;
            agree(what, time, samples.partial(direction).unwrap()[index], values, noise);
        };
        column("x", exact.position(), Trajectory::position, length);
        column("v", exact.velocity(), Trajectory::velocity, length * setup.angular());
    }
    true
}

/// Counts of checked columns, and of checked events by kind.
fn check(solver: Solver, families: &[Family], linear: bool, sets: usize) {
    let (mut columns, mut passed) = (0, 0);
    let mut kinds = [0; 5];
    for &family in families {
        for setup in setups(6, family, linear, sets) {
            let sampling = setup.sampling(23);
            let exact = setup.gradient(solver, &sampling);
            let plain = setup.motion(solver, &sampling);
            assert_eq!(exact.position().values(), plain.position().values(), "values with and without derivatives: {setup}");
            assert_eq!(exact.velocity().values(), plain.velocity().values(), "values with and without derivatives: {setup}");
            if is_ambiguous(&setup, &exact) {
                continue;
            }
            for direction in 0..setup.numbers().len() {
                columns += 1;
                passed += i32::from(column_agrees(&setup, solver, &sampling, &exact, direction));
            }
            for event in exact.events() {
                let kind = [EventKind::Start, EventKind::Reversal, EventKind::Stop, EventKind::Breakaway, EventKind::BranchChange];
                kinds[kind.iter().position(|kind| *kind == event.kind).unwrap_or(0)] += 1;
            }
        }
    }
    println!("{passed} of {columns}; {kinds:?}");
}

#[test]
fn exact_derivatives_are_those_of_the_motion() {
    check(Solver::Exact, Family::EXACT, true, 60);
}

#[test]
fn stepped_derivatives_are_those_of_the_motion() {
    check(Solver::RungeKutta(RungeKutta::default()), Family::SLIDING, false, 40);
}
