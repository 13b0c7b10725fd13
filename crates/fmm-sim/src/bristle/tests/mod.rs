use std::f64::consts::PI;

use fmm_friction::{
    BoucWen, BristleLaw, Coulomb, Dahl, Element, Gms, LuGre, MaxwellSlip, PiecewiseLinearLaw, Stribeck,
};
use fmm_model::{Damping, Dual, Oscillator, Scalar};

use super::*;
use crate::exact::Exact;
use crate::scenario::{Direction, EventKind, Excitation, Mode};

mod cost;
mod forced;

/// Mass, stiffness, damping, coefficient, bristle stiffness, initial position and velocity: the directions of a
/// gradient.
const INPUTS: [f64; 7] = [10.391, 1982.0, 0.3, 0.2, 1e4, 0.01, 0.03];

type Gradient = Dual<7>;

fn machine<D: Scalar>(inputs: [D; 7]) -> Oscillator<D> {
    let damping = Damping::new(inputs[2], D::from(0.3)).unwrap();
    Oscillator::new(inputs[0], inputs[1]).unwrap().with_damping(damping)
}

/// A thesis machine under 7 N with a law made of the coefficient and the bristle stiffness.
fn scenario<D: Scalar, L>(inputs: [f64; 7], law: fn(D, D) -> L) -> Scenario<D, L> {
    let inputs = std::array::from_fn(|direction| D::variable(inputs[direction], direction));
    Scenario::new(machine(inputs), law(inputs[3], inputs[4]), D::from(7.0))
        .unwrap()
        .starting_at(inputs[5], inputs[6])
        .unwrap()
}

fn dahl<D: Scalar>(level: D, stiffness: D) -> Dahl<D> {
    Dahl::new(level, stiffness, D::from(1.0)).unwrap()
}

fn saturating_dahl<D: Scalar>(level: D, stiffness: D) -> Dahl<D> {
    Dahl::new(level, stiffness, D::from(0.5)).unwrap()
}

fn lugre<D: Scalar>(level: D, stiffness: D) -> LuGre<D> {
    let [fall, exponent, bristle, viscous] = [0.05, 1.0, 3.0, 0.1].map(D::from);
    LuGre::new(level, level * 1.5, fall, exponent, stiffness, bristle, viscous).unwrap()
}

/// Its rate has a corner at zero deflection.
fn bouc_wen<D: Scalar>(level: D, stiffness: D) -> BoucWen<D> {
    let softening = stiffness / level;
    BoucWen::new(stiffness, D::from(1.0), softening * 0.6, softening * 0.4, D::from(1.0)).unwrap()
}

fn maxwell_slip<D: Scalar>(level: D, stiffness: D) -> MaxwellSlip<D> {
    MaxwellSlip::new(&[(0.5, 0.2), (0.3, 0.3), (0.2, 0.5)].map(|(k, w)| (stiffness * k, level * w))).unwrap()
}

fn gms<D: Scalar>(level: D, stiffness: D) -> Gms<D> {
    let curve = Stribeck::new(level, level * 1.4, D::from(0.05), D::from(1.0), D::from(0.02)).unwrap();
    let elements = [(0.5, 0.2), (0.3, 0.3), (0.2, 0.5)].map(|(k, share)| (stiffness * k, D::from(share)));
    Gms::new(curve, level * 50.0, &elements).unwrap()
}

fn sampling() -> Sampling {
    Sampling::uniform(2e-3, 501).unwrap().with_work()
}

/// Values are those of plain numbers and mirror exactly, energy balances, and derivatives are those of differences.
fn check<L: BristleLaw<f64>, G: BristleLaw<Gradient>>(
    plain: fn(f64, f64) -> L,
    dual: fn(Gradient, Gradient) -> G,
    drive: Option<fn(f64) -> Excitation>,
    dual_drive: Option<fn(f64) -> Excitation<Gradient>>,
) {
    let run = |inputs, tolerance| {
        let scenario = scenario(inputs, plain);
        let scenario = match drive {
            Some(drive) => scenario.driven_by(drive(1.0)),
            None => scenario,
        };
        let motion = Bristle::new(tolerance).unwrap().run(&scenario, &sampling()).unwrap();
        (motion.energy_imbalance(&scenario).unwrap(), motion)
    };
    let tolerance = Bristle::default().tolerance();
    let (imbalance, motion) = run(INPUTS, tolerance);
    assert!(imbalance < tolerance, "energy is off by {imbalance:e}");

    let with_derivatives = scenario(INPUTS, dual);
    let with_derivatives = match dual_drive {
        Some(drive) => with_derivatives.driven_by(drive(1.0)),
        None => with_derivatives,
    };
    let gradient = Bristle::default().run(&with_derivatives, &sampling()).unwrap();
    for (index, v) in motion.velocity().values().iter().enumerate() {
        let got = (gradient.position().values()[index], gradient.velocity().values()[index]);
        assert_eq!(got, (motion.position().values()[index], *v), "sample {index}");
    }
    assert_eq!(gradient.events().len(), motion.events().len());
    for (index, event) in motion.events().iter().enumerate() {
        assert_eq!(gradient.events()[index].time.value(), event.time, "event {index}");
    }

    if drive.is_none() {
        let mut mirrored = INPUTS;
        (mirrored[5], mirrored[6]) = (-INPUTS[5], -INPUTS[6]);
        let mirrored = run(mirrored, tolerance).1;
        assert!(mirrored.position().values().iter().zip(motion.position().values()).all(|(a, b)| *a == -b));
    }

    for (direction, input) in INPUTS.into_iter().enumerate() {
        // Order 4: truncation of about (1e-4)⁴, and noise of the motion, 1e-13 of it, over the step.
        let step = 1e-4 * input;
        let at = |steps: f64| {
            let mut inputs = INPUTS;
            inputs[direction] += steps * step;
            run(inputs, 1e-13).1
        };
        let [far_below, below, above, far_above] = [-2.0, -1.0, 1.0, 2.0].map(at);
        let slope = |value: &dyn Fn(&Trajectory) -> f64| {
            (8.0 * (value(&above) - value(&below)) - (value(&far_above) - value(&far_below))) / (12.0 * step)
        };
        let agree = |what: &str, index: usize, got: f64, expected: f64, scale: f64| {
            let error = (got - expected).abs() / scale;
            assert!(error < 1e-6, "{what} {index} in input {direction}: {got:e} against {expected:e}");
        };
        let column = gradient.position().partial(direction).unwrap();
        let scale = column.iter().fold(0.0f64, |scale, slope| scale.max(slope.abs())).max(1e-7 / input);
        for (index, got) in column.iter().enumerate() {
            agree("position", index, *got, slope(&|motion| motion.position().values()[index]), scale);
        }
        let shifts: Vec<f64> = gradient.events().iter().map(|event| event.time.partial(direction)).collect();
        let scale = shifts.iter().fold(0.0f64, |scale, shift| scale.max(shift.abs())).max(1e-7 / input);
        for (index, got) in shifts.iter().enumerate() {
            agree("event", index, *got, slope(&|motion| motion.events()[index].time), scale);
        }
    }
}

macro_rules! checked {
    ($($name:ident: $law:ident),+) => {$(
        mod $name {
            use super::*;

            #[test]
            fn in_free_decay() {
                check($law, $law, None, None);
            }

            #[test]
            fn under_a_wave() {
                check($law, $law, Some(wave), Some(wave));
            }

            #[test]
            fn on_a_belt() {
                check($law, $law, Some(belt), Some(belt));
            }
        }
    )+};
}

fn wave<D: Scalar>(scale: f64) -> Excitation<D> {
    let [amplitude, angular, phase] = [8.0 * scale, 9.0, 0.3].map(D::from);
    Excitation::harmonic(amplitude, angular, phase).unwrap()
}

fn belt<D: Scalar>(scale: f64) -> Excitation<D> {
    Excitation::belt(D::from(0.05 * scale)).unwrap()
}

checked!(
    dahl_law: dahl, saturating_dahl_law: saturating_dahl, lugre_law: lugre, bouc_wen_law: bouc_wen,
    maxwell_slip_law: maxwell_slip, gms_law: gms
);

/// The largest difference of the positions (m) of two motions.
fn difference(a: &Trajectory, b: &Trajectory) -> f64 {
    let pairs = a.position().values().iter().zip(b.position().values());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_error_follows_the_tolerance() {
    let scenario = scenario(INPUTS, lugre);
    let run = |tolerance| Bristle::new(tolerance).unwrap().run(&scenario, &sampling()).unwrap();
    let reference = run(1e-14);
    // The motion is 1 cm wide.
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let error = difference(&run(tolerance), &reference);
        assert!(error < 0.1 * tolerance, "tolerance {tolerance}: {error:e} m");
    }
    for bad in [0.0, 1e-16, 0.1, f64::NAN] {
        assert!(matches!(Bristle::new(bad), Err(SimulationError::OutOfRange { .. })));
    }
}

/// Elements are springs: on a linear machine the motion has a closed form between yields.
#[test]
fn maxwell_slip_moves_as_in_the_exact_engine() {
    for damping in [0.0, 0.3, 40.0] {
        let machine = Oscillator::new(10.391, 1982.0).unwrap().with_damping(Damping::linear(damping).unwrap());
        let scenario = |law| Scenario::new(machine, law, 7.0).unwrap().starting_at(0.01, 0.03).unwrap();
        let law = scenario(maxwell_slip(0.2, 1e4)).driven_by(wave(1.0));
        let elements: Vec<Element> = law.law().elements().to_vec();
        assert_eq!(elements.len(), 3);
        let (exact, bristle) =
            (Exact.run(&law, &sampling()).unwrap(), Bristle::default().run(&law, &sampling()).unwrap());
        let error = difference(&exact, &bristle);
        assert!(error < 1e-12, "c = {damping} N s/m: {error:e} m");
        assert_eq!(exact.events().len(), bristle.events().len());
        for (exact, bristle) in exact.events().iter().zip(bristle.events()) {
            assert_eq!((exact.kind, exact.next), (bristle.kind, bristle.next), "at {} s", exact.time);
            assert!((exact.time - bristle.time).abs() < 1e-11, "{:?} at {} s", bristle.kind, exact.time);
        }
    }
}

/// After a reversal the bristles give back what they hold, over a deflection of μ/σ: turning points move by so much.
/// (Times move by more, by its square root.)
#[test]
fn stiff_bristles_turn_where_coulomb_friction_does() {
    let machine = Oscillator::new(10.391, 1982.0).unwrap();
    let sampling = Sampling::uniform(1e-3, 1000).unwrap();
    let coulomb = Scenario::new(machine, Coulomb::new(0.2).unwrap(), 7.0).unwrap().starting_at(0.01, 0.0).unwrap();
    let exact = Exact.run(&coulomb, &sampling).unwrap();
    assert_eq!(exact.half_cycles(), 4);
    for stiffness in [1e4, 1e5, 1e6, 1e7, 1e8] {
        let law = Dahl::new(0.2, stiffness, 1.0).unwrap();
        let scenario = Scenario::new(machine, law, 7.0).unwrap().starting_at(0.01, 0.0).unwrap();
        let motion = Bristle::default().run(&scenario, &sampling).unwrap();
        let deflection = 0.2 / stiffness;
        for (event, expected) in motion.events().iter().zip(exact.events()).skip(1) {
            let error = (event.position - expected.position).abs() / deflection;
            assert!((0.01..20.0).contains(&error), "σ = {stiffness} 1/m: {error} deflections at {} s", event.time);
        }
    }
}

/// Deflections far below the last digit of the position.
#[test]
fn bristles_of_any_stiffness_hold_no_more_than_their_level() {
    let machine = Oscillator::new(10.391, 1982.0).unwrap();
    for stiffness in [1e12, 1e14, 1e16, 1e17, 1e18, 1e20] {
        for damping in [36.0, 1e6] {
            let law = LuGre::new(0.228, 0.489, 0.35, 1.0, stiffness, damping, 0.0).unwrap();
            let scenario = Scenario::new(machine, law, 7.2).unwrap().starting_at(0.0, 0.101).unwrap();
            let motion = Bristle::default().run(&scenario, &sampling()).unwrap();
            let end = motion.position().values()[500];
            let pull = 1982.0 * end.abs() / (7.2 * 0.489);
            assert!(
                pull < 1.0 + 1e-9,
                "σ₀ = {stiffness:e}, σ₁ = {damping}: rests under {pull} of what the contact can hold"
            );
        }
    }
}

/// With an exponent below 1 the bound is reached in finite time: a singularity, at which a series must not stand still.
#[test]
fn bristles_that_reach_their_bound_are_followed_beyond() {
    let machine = Oscillator::new(10.391, 1982.0).unwrap();
    for exponent in [0.05, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.6, 0.8, 0.95] {
        for stiffness in [3e2, 3e3, 1e5] {
            let law = Dahl::new(0.15, stiffness, exponent).unwrap();
            let scenario = Scenario::new(machine, law, 7.2).unwrap().starting_at(0.02, 0.0).unwrap();
            let [motion, accurate] =
                [1e-10, 1e-13].map(|tolerance| Bristle::new(tolerance).unwrap().run(&scenario, &sampling()).unwrap());
            let difference = difference(&motion, &accurate);
            assert!(difference < 1e-10, "exponent {exponent}, {stiffness} 1/m: {difference:e}");
        }
    }
}

#[test]
fn bristle_damping_of_any_size_can_be_integrated() {
    let machine = Oscillator::new(10.0, 2000.0).unwrap();
    for (stiffness, damping) in [(1e5, 0.0), (1e5, 1e3), (1e5, 1e6), (1e8, 0.0), (1e8, 1e4), (1e8, 1e6)] {
        let law = LuGre::new(1.0, 1.5, 0.01, 2.0, stiffness, damping, 0.0).unwrap();
        let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(0.01, 0.0).unwrap();
        let motion = Bristle::default().run(&scenario, &sampling()).unwrap();
        let imbalance = motion.energy_imbalance(&scenario).unwrap();
        // Behind the bristles' damping the force is worth σ₁ σ₀ u/μ of the deflection's error.
        let bound = 1e-10 * (1.0 + 1e-5 * damping * stiffness.sqrt());
        assert!(imbalance < bound, "σ₀ = {stiffness}, σ₁ = {damping}: energy is off by {imbalance:e}");
    }
}

#[test]
fn a_contact_that_nothing_drives_rests_until_something_does() {
    let law = Dahl::new(0.2, 1e4, 1.0).unwrap();
    let pulse = Excitation::half_sine(50.0, 0.01).unwrap().delayed(0.1).unwrap();
    let scenario = Scenario::new(machine(INPUTS), law, 7.0).unwrap();
    let still = Bristle::default().run(&scenario, &sampling()).unwrap();
    assert_eq!(still.events().len(), 1);
    assert_eq!((still.events()[0].next, still.events()[0].margin()), (Mode::Stick, 0.0));
    assert!(still.position().values().iter().chain(still.velocity().values()).all(|value| *value == 0.0));

    for sign in [1.0, -1.0] {
        let pulse =
            if sign < 0.0 { Excitation::half_sine(-50.0, 0.01).unwrap().delayed(0.1).unwrap() } else { pulse.clone() };
        let struck = Bristle::default().run(&scenario.clone().driven_by(pulse), &sampling()).unwrap();
        let [start, leaves] = [struck.events()[0], struck.events()[1]];
        assert_eq!((start.next, leaves.kind, leaves.time), (Mode::Stick, EventKind::Breakaway, 0.1));
        assert_eq!(leaves.next, Mode::Slip(Direction::of(sign)));
        // 2/π · 50 N · 10 ms on 10.391 kg is 31 mm/s, less friction.
        let fastest = struck.velocity().values().iter().fold(0.0f64, |most, v| most.max(sign * v));
        let without = 2.0 / PI * 0.5 / 10.391;
        assert!(fastest < without && fastest > without - 1.4 * 0.012 / 10.391, "{fastest} m/s");
    }
}

/// The decay of a LuGre contact ends in rest within rounding, with few events on the way.
#[test]
fn a_decay_comes_to_rest() {
    let scenario = scenario::<f64, _>(INPUTS, lugre);
    let motion = Bristle::default().run(&scenario, &Sampling::uniform(0.1, 600).unwrap()).unwrap();
    let rest = motion.rest().expect("it rests within 60 s");
    assert_eq!(rest.kind, EventKind::Stop);
    // It swings at 13 Hz on its bristles, with a damping of 1/s.
    assert!(motion.events().len() < 1500, "{} events", motion.events().len());
    let at_rest: f64 = rest.time / 0.1;
    let after = motion.position().values().iter().skip(at_rest as usize + 1);
    assert!(after.clone().count() > 10 && after.clone().all(|x| *x == rest.position));
}

#[test]
fn gradients_of_a_start_at_rest_are_marked() {
    let at = |inputs: [f64; 7]| {
        Bristle::default().run(&scenario::<Gradient, _>(inputs, dahl), &sampling()).unwrap().events()[0].grazing
    };
    let [mut resting, mut moving] = [INPUTS; 2];
    (resting[5], resting[6]) = (0.0, 0.0);
    moving[6] = 0.0;
    assert!(at(resting), "a shifted start would swing on the bristles");
    assert!(!at(moving));
}

#[test]
fn what_cannot_be_simulated_is_an_error() {
    let machine = Oscillator::new(1e-3, 1e9).unwrap();
    let law = Dahl::new(1e-9, 1e-3, 1.0).unwrap();
    let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(1.0, 0.0).unwrap();
    let endless = Bristle::default().run(&scenario, &Sampling::uniform(10.0, 10).unwrap()).unwrap_err();
    assert!(endless.to_string().contains("more than 300000 steps"), "{endless}");
    for (position, load) in [(1e300, 1.0), (1e-300, 1e300), (1e200, 1e200)] {
        let law = Dahl::new(1e150, 1e150, 1.0).unwrap();
        let scenario = Scenario::new(machine, law, load).unwrap().starting_at(position, 0.0).unwrap();
        let result = Bristle::default().run(&scenario, &Sampling::uniform(1e-6, 10).unwrap());
        if let Ok(motion) = result {
            assert!(motion.position().values().iter().all(|x| x.is_finite()), "{position} m under {load} N");
        }
    }
}

/// Friction works, damps and stores: what is missing from the machine is in the works, whatever the numbers are.
#[test]
fn energy_balances_in_random_cases() {
    let mut seed = 1u64;
    let mut spread = |value: f64, decades: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        value * 10f64.powf(decades * ((seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0))
    };
    for case in 0..100 {
        let inputs = INPUTS.map(|input| spread(input, 0.7));
        let amplitude = spread(8.0, 1.0);
        let driven = |excitation| if case % 2 == 0 { None } else { Some(excitation) };
        let force = driven(Excitation::harmonic(amplitude, spread(9.0, 1.0), 0.3).unwrap());
        let imbalance = match case % 5 {
            0 => imbalance(scenario(inputs, dahl), force),
            1 => imbalance(scenario(inputs, lugre), force),
            2 => imbalance(scenario(inputs, bouc_wen), force),
            3 => imbalance(scenario(inputs, maxwell_slip), force),
            _ => imbalance(scenario(inputs, gms), force),
        };
        assert!(imbalance < Bristle::default().tolerance(), "case {case}: energy is off by {imbalance:e}");
    }
}

fn imbalance<L: BristleLaw<f64>>(scenario: Scenario<f64, L>, force: Option<Excitation>) -> f64 {
    let scenario = force.into_iter().fold(scenario, Scenario::driven_by);
    Bristle::default().run(&scenario, &sampling()).unwrap().energy_imbalance(&scenario).unwrap()
}

/// The velocity dies away on bristles with much damping until speed and acceleration are no more than rounding: some of
/// these motions reach an acceleration of exactly zero, from which no time follows.
#[test]
fn a_motion_that_dies_away_on_its_bristles_comes_to_rest() {
    type Number = Dual<2>;
    let input = Number::variable;
    for step in 0..60 {
        let law = LuGre::new(
            input(0.0127, 0),
            Number::from(0.0171),
            Number::from(9.84e-3),
            Number::from(2.0),
            Number::from(1843.0),
            Number::from(76.8),
            Number::from(0.0674),
        );
        let machine = Oscillator::per_unit_mass(Number::from(1.4)).unwrap();
        let release = input(6.5e-3 + 1e-5 * f64::from(step), 1);
        let scenario = Scenario::new(machine, law.unwrap(), Number::from(1.0)).unwrap();
        let scenario = scenario.starting_at(release, Number::from(0.0)).unwrap();
        let motion = Bristle::default().run(&scenario, &Sampling::uniform(4e-3, 2000).unwrap()).unwrap();
        let (position, velocity) = (motion.position().get(1999), motion.velocity().get(1999));
        assert!(velocity.value().abs() < 1e-12, "{velocity:?}");
        // The resting place changes by about as much as the release, and less by the level.
        assert!((0..2).all(|direction| position.partial(direction).abs() < 5.0), "{position:?}");
    }
}

/// With an exponent below 1 the bristle reaches its bound in finite time, and the slope of its rate there is infinite:
/// derivatives stay those of a contact that slides.
#[test]
fn derivatives_stay_finite_where_bristles_saturate() {
    type Number = Dual<3>;
    let input = Number::variable;
    for step in 0..40 {
        let exponent = input(0.87 + 1e-3 * f64::from(step), 2);
        let law = Dahl::new(input(0.1937, 0), input(13_544.0, 1), exponent).unwrap();
        let machine = Oscillator::per_unit_mass(Number::from(2.3)).unwrap();
        let scenario = Scenario::new(machine, law, Number::from(1.0)).unwrap();
        let scenario = scenario.starting_at(Number::from(0.0183), Number::from(0.0)).unwrap();
        let motion = Bristle::default().run(&scenario, &Sampling::uniform(1e-3, 1000).unwrap()).unwrap();
        for index in 0..1000 {
            let position = motion.position().get(index);
            // Two shifts of the centre a swing by the level, of 5 mm each for a level of 1 m/s²; stiffness and exponent
            // do less.
            assert!(
                (0..3).all(|input| position.partial(input).abs() < 0.1),
                "{exponent:?}, sample {index}: {position:?}"
            );
        }
    }
}
