//! A trajectory that is used again holds the new run alone.

use fmm_friction::{AccelerationCoulomb, Berger, Coulomb, Dahl, LuGre, MaxwellSlip};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Bristle, Channels, Engine, Exact, Excitation, Moreau, RungeKutta, Sampling, Scenario, Trajectory};

type D1 = Dual<1>;

/// A motion that slides and stops, one that rests all the time, and one on a belt, on a machine of 2.2 Hz.
fn scenarios<D: Scalar, L: Clone>(law: &L) -> [Scenario<D, L>; 3] {
    let number = D::from;
    let machine = Oscillator::new(number(10.391), D::variable(1982.0, 0)).unwrap();
    let machine = machine.with_damping(Damping::linear(number(0.3)).unwrap());
    let scenario = Scenario::new(machine, law.clone(), number(7.2)).unwrap();
    let belt = Excitation::belt(number(0.02)).unwrap();
    [scenario.clone().starting_at(number(0.015), number(0.0)).unwrap(), scenario.clone(), scenario.driven_by(belt)]
}

/// Runs each of the scenarios after each other one, and into new memory; nothing may differ.
fn check<D: Scalar, L: Clone>(engine: &impl Engine<D, L>, law: &L) {
    let sampling = Sampling::uniform(4e-3, 500).unwrap().keeping(Channels::All);
    let scenarios = scenarios::<D, L>(law);
    let mut used = Trajectory::new();
    for first in &scenarios {
        for second in &scenarios {
            if engine.run_into(first, &sampling, &mut used).is_err() {
                continue;
            }
            let Ok(new) = engine.run(second, &sampling) else { continue };
            engine.run_into(second, &sampling, &mut used).unwrap();
            assert!(used == new, "{} left something of an earlier run", new.engine());
            let finite = |samples: &fmm_sim::Samples<D>| {
                let partials = samples.partial(0).unwrap_or_default();
                samples.values().len() == 500 && samples.values().iter().chain(partials).all(|value| value.is_finite())
            };
            assert!([new.position(), new.velocity(), new.acceleration()].into_iter().all(finite), "{}", new.engine());
        }
    }
}

#[test]
fn every_sample_is_written() {
    check::<f64, _>(&Moreau::default(), &Coulomb::new(0.15).unwrap());
    check::<f64, _>(&Exact, &AccelerationCoulomb::new(0.15, 0.1).unwrap());
    check::<D1, _>(&Exact, &Coulomb::new(D1::from(0.15)).unwrap());
    check::<D1, _>(&Exact, &MaxwellSlip::new(&[(D1::from(6e3), D1::from(0.05))]).unwrap());
    check::<D1, _>(&RungeKutta::default(), &Berger::new(D1::from(0.2), D1::from(0.3), D1::from(3.0)).unwrap());
    let dahl = Dahl::new(D1::from(0.15), D1::from(1e4), D1::from(1.0)).unwrap();
    check::<D1, _>(&Bristle::default(), &dahl);
    check::<f64, _>(&Bristle::default(), &LuGre::new(0.1, 0.15, 0.1, 2.0, 2e3, 3.0, 0.05).unwrap());
}
