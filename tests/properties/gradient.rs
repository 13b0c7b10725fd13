//! Exact derivatives: against differences of the exact engine, and against themselves where differences fail.

use std::f64::consts::PI;

use fmm_friction::Coulomb;
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Event, Sampling, Scenario, Trajectory};

use crate::case::{Case, cases, exactly};

/// Derivatives in every input.
type Gradient = Dual<7>;

const INPUTS: [&str; 7] = ["m", "k", "c", "μ", "N", "x₀", "v₀"];
const VELOCITY: usize = 6;

fn inputs(case: &Case) -> [f64; 7] {
    [case.mass, case.stiffness, case.damping, case.sliding, case.normal_load, case.position, case.velocity]
}

/// The motion at the given inputs, each being the variable of one direction.
fn run<D: Scalar>(case: &Case, inputs: [f64; 7], sampling: &Sampling) -> Trajectory<D> {
    let input = |direction: usize| D::variable(inputs[direction], direction);
    let damping = Damping::linear(input(2)).unwrap();
    let machine = Oscillator::new(input(0), input(1)).unwrap().with_damping(damping);
    let scenario = Scenario::new(machine, Coulomb::new(input(3)).unwrap(), input(4))
        .and_then(|scenario| scenario.starting_at(input(5), input(6)))
        .unwrap();
    exactly(case, &scenario, sampling)
}

/// A change of each input that matters as much as a change of the amplitude by itself.
fn scales(case: &Case) -> [f64; 7] {
    let (force, critical) = (case.stiffness * case.amplitude(), 2.0 * (case.stiffness * case.mass).sqrt());
    let positive = |factor: f64| if factor > 0.0 { factor } else { 1.0 };
    [
        case.mass,
        case.stiffness,
        critical,
        force / positive(case.normal_load),
        force / positive(case.sliding),
        case.amplitude(),
        case.amplitude() * case.angular(),
    ]
}

/// Multiples of the step and weights of a first derivative of fourth order: central, or forwards from a bound.
const CENTRAL: [(f64, f64); 5] =
    [(-2.0, 1.0 / 12.0), (-1.0, -2.0 / 3.0), (0.0, 0.0), (1.0, 2.0 / 3.0), (2.0, -1.0 / 12.0)];
const FORWARDS: [(f64, f64); 5] = [(0.0, -25.0 / 12.0), (1.0, 4.0), (2.0, -3.0), (3.0, 4.0 / 3.0), (4.0, -1.0 / 4.0)];

/// How many times its own size a quantity changes when an input changes by its scale: the phase ω₀ t, more where the
/// first swing is small beside the shift of its centre (damping shortens it up to 1 + 2ζ times), and 1/(1 − ζ²) for
/// what goes with ω_d.
fn liveliness(case: &Case) -> f64 {
    let phase = 1.0 + case.angular() * case.sampling().end();
    let shift = case.friction() / case.stiffness;
    let sense = if case.velocity == 0.0 { -case.position.signum() } else { case.velocity.signum() };
    let first =
        (case.position + sense * shift).hypot(case.velocity / case.angular()) / (1.0 + 2.0 * case.damping_ratio());
    let critical = (1.0 - case.damping_ratio().powi(2)).abs().recip().min(phase * phase);
    phase * (case.size() / first.min(case.size())) + critical
}

/// Differences take steps of 1/50 of the scale over the liveliness Q. With derivatives of the fifth order of size Q⁵
/// the stencils are then (1/50)⁴/5 Q off at worst.
const STEP: f64 = 0.02;

/// Compares one input's column with differences; false if a difference would reach over a change of the number of
/// events, which no derivative sees.
fn column_agrees(case: &Case, motion: &Trajectory<Gradient>, direction: usize) -> bool {
    let (sampling, inputs, q) = (case.sampling(), inputs(case), liveliness(case));
    let scale = scales(case)[direction];
    let step = STEP / q * scale;
    let stencil = if direction < 5 && inputs[direction] < 2.5 * step { FORWARDS } else { CENTRAL };
    let runs = stencil.map(|(multiple, _)| {
        let mut inputs = inputs;
        inputs[direction] += multiple * step;
        run::<f64>(case, inputs, &sampling)
    });
    let same = |other: &Trajectory| {
        let kinds = other.events().iter().map(|event| (event.kind, event.next));
        kinds.eq(motion.events().iter().map(|event| (event.kind, event.next)))
    };
    if !runs.iter().all(same) {
        return false;
    }
    let difference = |value: &dyn Fn(&Trajectory) -> f64| {
        stencil.iter().zip(&runs).map(|((_, weight), run)| weight * value(run)).sum::<f64>() / step
    };
    // All in metres per scale: truncation as above, and rounding of five runs over the step.
    let tolerance = |time: f64| (STEP.powi(4) * q * case.size() + 8.0 * case.rounding(time) * q / STEP) / scale;
    let agree = |what: &str, time: f64, exact: f64, difference: f64, tolerance: f64| {
        let (error, name) = (exact - difference, INPUTS[direction]);
        assert!(
            error.abs() <= tolerance,
            "∂{what}/∂{name} at {time} s: {exact:e} against {difference:e}, {error:e} off, {tolerance:e} allowed: {case}"
        );
    };

    for (index, event) in motion.events().iter().enumerate() {
        let (time, position) = (event.time.value(), event.position.partial(direction));
        let of = |part: &dyn Fn(&Event) -> f64| difference(&|run: &Trajectory| part(&run.events()[index]));
        agree("x of an event", time, position, of(&|event| event.position), tolerance(time));
        // A time is a velocity over the acceleration ω₀² × distance from the centre of the swing that ends there.
        let reach = if index == 0 { case.size() } else { turning_distance(case, &motion.events()[index - 1], event) };
        let slack = tolerance(time) / (case.angular() * reach);
        agree("t of an event", time, event.time.partial(direction), of(&|event| event.time), slack);
    }

    // Between the earliest and the latest of an event the runs are in different swings: the second derivative jumps.
    let jumps: Vec<_> = (1..motion.events().len())
        .map(|index| {
            let times = runs.iter().map(|run| run.events()[index].time);
            times.fold((f64::INFINITY, 0.0f64), |(first, last), time| (first.min(time), last.max(time)))
        })
        .collect();
    for index in (0..case.count).step_by(case.count / 60 + 1) {
        let time = sampling.time(index);
        if jumps.iter().any(|(first, last)| (*first..=*last).contains(&time)) {
            continue;
        }
        let partial = |samples: &fmm_sim::Samples<Gradient>| samples.partial(direction).unwrap()[index];
        let position = difference(&|run: &Trajectory| run.position().values()[index]);
        let velocity = difference(&|run: &Trajectory| run.velocity().values()[index]);
        agree("x", time, partial(motion.position()), position, tolerance(time));
        agree("v", time, partial(motion.velocity()), velocity, tolerance(time) * case.angular());
    }
    true
}

/// Distance of a turning point from the centre of the swing that ends there (m).
fn turning_distance(case: &Case, before: &Event<Gradient>, event: &Event<Gradient>) -> f64 {
    let centre = -crate::case::sense(before.next) * case.friction() / case.stiffness;
    (event.position.value() - centre).abs()
}

#[test]
fn derivatives_are_those_of_the_motion() {
    let mut checked = [0; 7];
    for case in cases(61, 1500) {
        let motion = run::<Gradient>(&case, inputs(&case), &case.sampling());
        let narrow = motion.events().iter().any(|event| event.velocity.value() == 0.0 && event.margin().abs() < 1e-3);
        if narrow || case.amplitude() == 0.0 || liveliness(&case) > 1e4 {
            continue;
        }
        for (direction, checked) in checked.iter_mut().enumerate() {
            // Where the initial velocity may change its sign the motion has a kink; see the next test.
            let slow = case.velocity.abs() < 2.5 * STEP / liveliness(&case) * scales(&case)[VELOCITY];
            if (direction != VELOCITY || !slow) && column_agrees(&case, &motion, direction) {
                *checked += 1;
            }
        }
    }
    assert!(checked.iter().all(|checked| *checked >= 900), "{checked:?} of 1500 cases checked in each input");
    assert!(checked.iter().sum::<usize>() >= 7 * 1000, "{checked:?}");
}

/// At rest outside the stick zone the derivative in the initial velocity is that of a push towards the centre: the
/// limit from the side on which no reversal is added.
#[test]
fn a_release_from_rest_has_the_derivative_of_a_slow_start() {
    let mut checked = 0;
    for case in cases(62, 3000) {
        let released = Case { velocity: 0.0, ..case };
        let motion = run::<Gradient>(&released, inputs(&released), &released.sampling());
        if released.position == 0.0 || motion.rest().is_some_and(|rest| rest.time.value() == 0.0) {
            continue;
        }
        // A push of 1e-8 changes derivatives by about 1e-8 of themselves; the phase they grow with is allowed for.
        let push = -1e-8 * released.angular() * released.position;
        let pushed = Case { velocity: push, ..released };
        let other = run::<Gradient>(&pushed, inputs(&pushed), &pushed.sampling());
        let narrow = motion.events().iter().chain(other.events()).any(|event| event.margin().abs() < 1e-3);
        if narrow || other.events().len() != motion.events().len() || liveliness(&released) > 1e4 {
            continue;
        }
        let slack = 1e-6 * liveliness(&released);
        for (before, (event, expected)) in
            motion.events().iter().zip(motion.events().iter().zip(other.events()).skip(1))
        {
            let (got, expected) = (event.time.partial(VELOCITY), expected.time.partial(VELOCITY));
            // (m/s)⁻¹ s = s²/m: one over an acceleration.
            let reach = turning_distance(&released, before, event);
            let tolerance = slack * released.size() / (released.angular().powi(2) * reach * released.size());
            assert!(
                (got - expected).abs() <= tolerance,
                "∂t/∂v₀ of an event: {got} against {expected} s²/m: {released}"
            );
        }
        let jumps: Vec<_> =
            motion.events().iter().zip(other.events()).skip(1).map(|(a, b)| (a.time.value(), b.time.value())).collect();
        for index in (0..released.count).step_by(released.count / 60 + 1) {
            let time = released.sampling().time(index);
            if jumps.iter().any(|(a, b)| (time - a) * (time - b) <= 0.0) {
                continue;
            }
            let partial = |motion: &Trajectory<Gradient>| motion.velocity().partial(VELOCITY).unwrap()[index];
            let (got, expected) = (partial(&motion), partial(&other));
            assert!((got - expected).abs() <= slack, "∂v/∂v₀ at {time} s: {got} against {expected}: {released}");
        }
        checked += 1;
    }
    assert!(checked >= 1000, "{checked} cases");
}

/// Without friction nothing is kinked and ∂v/∂v₀ is cos ω₀t for any start, from rest as well.
#[test]
fn a_pendulum_swings_on_after_a_push() {
    let case = Case {
        mass: 1.0,
        stiffness: 4.0 * PI * PI,
        damping: 0.0,
        sliding: 0.0,
        breakaway: 0.0,
        normal_load: 0.0,
        position: 0.01,
        velocity: 0.0,
        interval: 0.01,
        count: 301,
    };
    let motion = run::<Gradient>(&case, inputs(&case), &case.sampling());
    for (index, got) in motion.velocity().partial(VELOCITY).unwrap().iter().enumerate() {
        let expected = (2.0 * PI * case.sampling().time(index)).cos();
        assert!((got - expected).abs() < 1e-13, "sample {index}: ∂v/∂v₀ = {got}, not {expected}: {case}");
    }
}

/// Numbers with derivatives take the branches of plain numbers and have their values, up to the rounding of quotients.
#[test]
fn values_do_not_depend_on_the_number_type() {
    let mut checked = 0;
    for case in cases(63, 1100) {
        let sampling = case.sampling();
        let plain = run::<f64>(&case, inputs(&case), &sampling);
        let dual = run::<Gradient>(&case, inputs(&case), &sampling);
        let tolerance = 2.0 * case.rounding(sampling.end());
        let narrow = |event: &Event| (event.load - event.static_level).abs() <= case.stiffness * tolerance;
        if plain.events().iter().any(narrow) {
            continue;
        }
        assert_eq!(dual.events().len(), plain.events().len(), "number of events: {case}");
        for (dual, plain) in dual.events().iter().zip(plain.events()) {
            let error = dual.position.value() - plain.position;
            assert!(error.abs() <= tolerance, "event at {} s: {error:e} m off: {case}", plain.time);
            assert_eq!((dual.kind, dual.next), (plain.kind, plain.next), "event at {} s: {case}", plain.time);
        }
        for index in 0..case.count {
            let position = dual.position().values()[index] - plain.position().values()[index];
            let velocity = (dual.velocity().values()[index] - plain.velocity().values()[index]) / case.angular();
            let error = position.abs().max(velocity.abs());
            assert!(error <= tolerance, "sample {index}: {error:e} m off, {tolerance:e} m allowed: {case}");
        }
        checked += 1;
    }
    assert!(checked >= 1000, "{checked} cases");
}

/// A sample at the very time of an event holds the state after it, derivatives included:
///
/// ```text
/// v = 0,   ∂v/∂θ = −a₊ ∂t/∂θ,   ∂x/∂θ = ∂x_event/∂θ,   a₊ = −(k x + s N μ)/m, or 0 in stick
/// ```
#[test]
fn a_sample_at_an_event_is_the_state_after_it() {
    let mut checked = 0;
    for case in cases(64, 1500) {
        let motion = run::<Gradient>(&case, inputs(&case), &case.sampling());
        for event in motion.events().iter().skip(1).step_by(5) {
            // Powers of two times an interval are exact, so that sample 16 is at the event to the last bit.
            let sampling = Sampling::uniform(event.time.value() / 16.0, 20).unwrap();
            let sampled = run::<Gradient>(&case, inputs(&case), &sampling);
            assert_eq!(sampled.velocity().values()[16], 0.0, "at {} s: {case}", event.time.value());
            let sense = crate::case::sense(event.next);
            let force = case.stiffness * event.position.value() + sense * case.friction();
            let acceleration = if sense == 0.0 { 0.0 } else { -force / case.mass };
            for (direction, name) in INPUTS.iter().enumerate() {
                let partial = |samples: &fmm_sim::Samples<Gradient>| samples.partial(direction).unwrap()[16];
                let late = event.time.partial(direction);
                let (got, expected) = (partial(sampled.velocity()), -acceleration * late);
                // A few ulp of the larger terms of the force, from which the acceleration is left.
                let slack = 1e-14 * case.angular().powi(2) * case.size() * late.abs();
                assert!((got - expected).abs() <= slack, "∂v/∂{name}: {got:e}, not {expected:e}: {case}");
                let (got, expected) = (partial(sampled.position()), event.position.partial(direction));
                let slack = 1e-13 * case.conditioning() * case.size() * liveliness(&case) / scales(&case)[direction];
                assert!((got - expected).abs() <= slack, "∂x/∂{name}: {got:e}, not {expected:e}: {case}");
            }
            checked += 1;
        }
    }
    assert!(checked >= 1000, "{checked} events");
}
