//! Normal loads that vary in time, against closed forms, the balance of energy and differences.

use fmm_friction::{AccelerationCoulomb, Coulomb, CoulombStatic, Dahl, LawFamily, Stribeck};
use fmm_model::{Dual, Oscillator, Scalar};
use fmm_sim::{
    Bristle, Engine, EventKind, Exact, Excitation, Moreau, RungeKutta, Sampling, Scenario, SimulationError, simulate,
};

fn machine<D: Scalar>() -> Oscillator<D> {
    Oscillator::new(D::from(2.0), D::from(50.0)).unwrap()
}

/// In one direction of sliding a load that grows is a force that grows against the motion.
#[test]
fn a_load_that_grows_is_a_ramp_against_the_motion() {
    let (coefficient, first, rate) = (0.1, 6.0, 9.0);
    let sampling = Sampling::uniform(1e-3, 700).unwrap();
    let loaded = Scenario::new(machine(), Coulomb::new(coefficient).unwrap(), 1.0).unwrap();
    let loaded = loaded.under_sampled_load(2.0, [first, first + 2.0 * rate]).unwrap().starting_at(0.5, 0.0).unwrap();
    let ramp = Excitation::ramp(coefficient * rate).unwrap();
    let driven = Scenario::new(machine(), Coulomb::new(coefficient).unwrap(), first).unwrap();
    let driven = driven.driven_by(ramp).starting_at(0.5, 0.0).unwrap();
    let (found, expected) = (simulate(&loaded, &sampling).unwrap(), Exact.run(&driven, &sampling).unwrap());
    assert_eq!(found.engine(), "runge_kutta");
    let turn = found.events()[1].time;
    assert!((turn - expected.events()[1].time).abs() < 1e-12 && turn > 0.6 && turn < 0.69, "{turn} s");
    for (index, (one, other)) in found.position().values().iter().zip(expected.position().values()).enumerate() {
        assert!(sampling.time(index) > turn || (one - other).abs() < 1e-12, "{one}, {other} m at {index}");
    }
}

/// μ_s N(t) = k x decides when a spring begins to pull the mass, and ∂t/∂μ_s = −N/(μ_s N′).
#[test]
fn a_load_that_falls_lets_go_at_its_time() {
    for later in [12.0, 30.0] {
        let law = CoulombStatic::new(Dual::from(0.1), Dual::<2>::variable(0.4, 0)).unwrap();
        let scenario = Scenario::new(machine(), law, Dual::from(0.0)).unwrap();
        let load = [40.0, 38.0, later].map(Dual::from);
        let load = [load[0], load[1], Dual::variable(later, 1)];
        let scenario = scenario.under_sampled_load(0.5, load).unwrap();
        let scenario = scenario.starting_at(Dual::from(0.2), Dual::from(0.0)).unwrap();
        let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(0.01, 150).unwrap()).unwrap();
        if later == 30.0 {
            // 10 N of the spring against 12 N.
            assert_eq!(motion.rest().map(|rest| rest.time.value()), Some(0.0));
            continue;
        }
        let event = &motion.events()[1];
        let (rate, load) = ((later - 38.0) / 0.5, 10.0 / 0.4);
        let time = 0.5 + (load - 38.0) / rate;
        assert_eq!(event.kind, EventKind::Breakaway);
        assert!((event.time.value() - time).abs() < 1e-13 && (event.static_level - 10.0).abs() < 1e-12);
        assert!((event.time.partial(0) + load / (0.4 * rate)).abs() < 1e-10, "{:?}", event.time);
        // N = 38 + (L − 38) (t − ½)/½ = 25 tells t; of a greater L it is later.
        assert!((event.time.partial(1) - 0.5 * (38.0 - load) / (later - 38.0).powi(2)).abs() < 1e-10);
        assert!(motion.rest().is_none_or(|rest| rest.time.value() > time));
    }
}

/// On its static level a contact goes where the load is going.
#[test]
fn a_level_that_is_reached_is_left_by_a_load_that_falls() {
    for (later, slips) in [(10.0, true), (30.0, false)] {
        let scenario = Scenario::new(machine(), CoulombStatic::new(0.25, 0.5).unwrap(), 0.0).unwrap();
        // 10 N of the spring, and of friction at the start.
        let scenario = scenario.under_sampled_load(1.0, [20.0, later]).unwrap().starting_at(0.2, 0.0).unwrap();
        let motion = simulate(&scenario, &Sampling::uniform(0.01, 50).unwrap()).unwrap();
        assert_eq!(motion.events()[0].next.direction().is_some(), slips, "{:?}", motion.events()[0]);
        assert_eq!(motion.rest().is_some(), !slips);
    }
}

/// A force that grows with the level never exceeds it, and the load stays what its last sample says.
#[test]
fn a_load_that_has_grown_holds_for_good() {
    let scenario = Scenario::new(machine(), CoulombStatic::new(0.25, 0.5).unwrap(), 0.0).unwrap();
    let scenario = scenario.under_sampled_load(1.0, [20.0, 40.0]).unwrap().starting_at(0.1, 0.0).unwrap();
    // 5 N of the spring, and with the force 13 N of 20 N at last, where the first level was 10 N.
    let pulled = scenario.clone().driven_by(Excitation::sampled_force(1.0, [0.0, -8.0]).unwrap());
    let motion = simulate(&pulled, &Sampling::uniform(0.01, 20).unwrap()).unwrap();
    assert_eq!((motion.events().len(), motion.rest().is_some()), (1, true));
    let moving = scenario.starting_at(0.1, 9.0).unwrap();
    let later = moving.clone().driven_by(Excitation::constant(0.0).unwrap().delayed(2.0).unwrap());
    let sampling = Sampling::uniform(0.01, 400).unwrap();
    let [one, other] = [moving, later].map(|scenario| simulate(&scenario, &sampling).unwrap());
    for (one, other) in one.velocity().values().iter().zip(other.velocity().values()) {
        assert!((one - other).abs() < 1e-11, "{one}, {other} m/s");
    }
}

/// Times of changes of branch know by how much the friction of the moment grows.
#[test]
fn changes_of_branch_have_their_derivatives() {
    let run = |scale: Dual<1>| {
        let load: Vec<Dual<1>> = pulsing().into_iter().map(|load| scale * (load + 20.0)).collect();
        let law = AccelerationCoulomb::new(Dual::from(0.25), Dual::from(0.2)).unwrap();
        let scenario = Scenario::new(machine(), law, Dual::from(1.0)).unwrap().under_sampled_load(0.05, load).unwrap();
        let push = Excitation::harmonic(Dual::from(9.0), Dual::from(4.1), Dual::from(0.3)).unwrap();
        let scenario = scenario.driven_by(push).starting_at(Dual::from(0.5), Dual::from(0.0)).unwrap();
        RungeKutta::default().run(&scenario, &Sampling::uniform(2e-2, 150).unwrap()).unwrap()
    };
    let (step, exact) = (1e-4, run(Dual::variable(1.0, 0)));
    let runs = [-2.0, -1.0, 1.0, 2.0].map(|steps| run(Dual::from(1.0 + steps * step)));
    let mut compared = 0;
    for (index, event) in exact.events().iter().enumerate().filter(|(_, event)| event.kind == EventKind::BranchChange) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|at: usize| &runs[at].events()[index]);
        assert!([a, b, c, d].iter().all(|other| other.kind == event.kind), "{event:?}");
        let [a, b, c, d] = [a, b, c, d].map(|event| event.time.value());
        let difference = (8.0 * (c - b) - (d - a)) / (12.0 * step);
        let partial = event.time.partial(0);
        assert!((difference - partial).abs() < 1e-5 * partial.abs().max(1e-3), "{difference}, {partial} at {event:?}");
        compared += 1;
    }
    assert!(compared > 5, "{compared} changes of branch in {} events", exact.events().len());
}

/// Loads that change sign of their slope often, from nothing to twice the mean.
fn pulsing() -> Vec<f64> {
    (0..200).map(|i| 5.0 * (1.0 + (0.9 * f64::from(i)).sin())).collect()
}

fn balances<L>(law: L)
where
    L: fmm_friction::FamilyMember<Number = f64, Family: LawFamily>,
{
    let drive = Excitation::harmonic(2.0, 4.1, 0.3).unwrap();
    let scenario = Scenario::new(machine(), law, 1.0).unwrap().under_sampled_load(0.05, pulsing()).unwrap();
    let scenario = scenario.driven_by(drive).starting_at(0.3, 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(1e-2, 1000).unwrap().with_work()).unwrap();
    let imbalance = motion.energy_imbalance(&scenario).unwrap();
    assert!(imbalance < 1e-10, "{imbalance}");
    assert!(motion.events().len() > 10, "{} events", motion.events().len());
    for event in motion.events() {
        match event.next.direction() {
            None => assert!(event.load <= event.static_level * (1.0 + 1e-9) + 1e-9, "{event:?}"),
            Some(direction) => assert!(event.velocity * direction.sign() >= -1e-12, "{event:?}"),
        }
    }
}

#[test]
fn energy_is_balanced_under_a_pulsing_load() {
    balances(Coulomb::new(0.2).unwrap());
    balances(CoulombStatic::new(0.2, 0.3).unwrap());
    balances(Stribeck::new(0.15, 0.3, 0.1, 1.0, 0.02).unwrap());
    balances(AccelerationCoulomb::new(0.25, 0.2).unwrap());
}

/// With the sampled load a parameter, and with the law's own.
#[test]
fn derivatives_are_those_of_differences() {
    let run = |scale: Dual<2>, exponent: Dual<2>| {
        let law =
            Stribeck::new(Dual::from(0.05), Dual::from(0.1), Dual::from(0.3), exponent, Dual::from(0.02)).unwrap();
        let load: Vec<Dual<2>> = pulsing().into_iter().map(|load| scale * (load + 1.0)).collect();
        let scenario = Scenario::new(machine(), law, Dual::from(1.0)).unwrap();
        let scenario = scenario.under_sampled_load(0.05, load).unwrap();
        let scenario = scenario.starting_at(Dual::from(0.5), Dual::from(0.0)).unwrap();
        RungeKutta::default().run(&scenario, &Sampling::uniform(2e-2, 100).unwrap()).unwrap()
    };
    let (scale, exponent) = (1.0, 1.3);
    let exact = run(Dual::variable(scale, 0), Dual::variable(exponent, 1));
    let step = 1e-3;
    for direction in 0..2 {
        let at = |by: f64| {
            let [scale, exponent] = if direction == 0 { [scale + by, exponent] } else { [scale, exponent + by] };
            run(Dual::from(scale), Dual::from(exponent)).velocity().values().to_vec()
        };
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|steps| at(steps * step));
        let partials = exact.velocity().partial(direction).unwrap();
        let size = partials.iter().fold(0.0f64, |size, partial| size.max(partial.abs()));
        let turns: Vec<f64> = exact.events().iter().map(|event| event.time.value()).collect();
        let mut compared = 0;
        for index in 0..100 {
            // A reversal between the differences bends them.
            if turns.iter().any(|turn| (turn - 0.02 * index as f64).abs() < 0.03) {
                continue;
            }
            let difference = (8.0 * (c[index] - b[index]) - (d[index] - a[index])) / (12.0 * step);
            assert!((difference - partials[index]).abs() < 1e-7 * size, "{difference}, {} at {index}", partials[index]);
            compared += 1;
        }
        assert!(compared > 60 && size > 1e-3, "{compared} samples of {size}");
    }
}

#[test]
fn loads_that_cannot_be_are_refused() {
    let scenario = || Scenario::new(machine(), Coulomb::new(0.2).unwrap(), 1.0).unwrap();
    assert!(matches!(scenario().under_sampled_load(0.1, []), Err(SimulationError::OutOfRange { value: 0.0, .. })));
    assert!(scenario().under_sampled_load(0.1, [1.0, -1.0]).is_err());
    assert!(scenario().under_sampled_load(0.0, [1.0, 1.0]).is_err());
    assert!(scenario().under_sampled_load(0.1, [1.0, f64::NAN]).is_err());
    let sampling = Sampling::uniform(0.1, 10).unwrap();
    let varying = scenario().under_sampled_load(0.1, [1.0, 2.0]).unwrap();
    assert!(matches!(Exact.run(&varying, &sampling), Err(SimulationError::NoClosedForm { .. })));
    assert!(matches!(Moreau::default().run(&varying, &sampling), Err(SimulationError::NotSupported { .. })));
    let bristles = Scenario::new(machine(), Dahl::new(0.2, 50.0, 1.0).unwrap(), 1.0).unwrap();
    let bristles = bristles.under_sampled_load(0.1, [1.0, 2.0]).unwrap();
    assert!(matches!(Bristle::default().run(&bristles, &sampling), Err(SimulationError::NotSupported { .. })));
    // One value is a constant load.
    let constant = scenario().under_sampled_load(0.1, [3.0]).unwrap();
    assert_eq!((constant.normal_load(), Exact.run(&constant, &sampling).is_ok()), (3.0, true));
}
