//! Numbers of samples that no memory holds are errors, not panics.

use fmm_friction::{Coulomb, Dahl};
use fmm_model::{Dual, Oscillator};
use fmm_sim::{Bristle, Engine, Exact, Moreau, RungeKutta, Sampling, Scenario, SimulationError, Thesis};

#[test]
fn counts_beyond_exact_times_are_refused() {
    for count in [usize::MAX, usize::MAX / 2, (1 << 53) + 1] {
        let refused = Sampling::uniform(1e-3, count);
        assert!(matches!(refused, Err(SimulationError::OutOfRange { .. })), "{count}: {refused:?}");
    }
}

#[test]
fn a_run_ends_after_the_steps_that_it_may_take() {
    let machine = Oscillator::new(1.0, 100.0).unwrap();
    let scenario = Scenario::new(machine, Coulomb::new(0.1).unwrap(), 1.0).unwrap().starting_at(0.1, 0.0).unwrap();
    let dahl = Dahl::new(0.1, 1e4, 1.0).unwrap();
    let bristles = Scenario::new(machine, dahl, 1.0).unwrap().starting_at(0.1, 0.0).unwrap();
    let sampling = Sampling::uniform(1e-2, 500).unwrap();
    let runs = |sampling: &Sampling| {
        [RungeKutta::default().run(&scenario, sampling), Bristle::default().run(&bristles, sampling)]
    };
    for (whole, few) in runs(&sampling).into_iter().zip(runs(&sampling.clone().in_steps(100_000))) {
        assert_eq!(whole.unwrap().position().values(), few.unwrap().position().values());
    }
    for refused in runs(&sampling.in_steps(10)) {
        let refused = refused.unwrap_err();
        let says = refused.to_string().starts_with("the motion takes more than 10 steps before 4.99 s");
        assert!(says && matches!(refused, SimulationError::Exhausted { .. }), "{refused}");
    }
}

#[test]
fn samples_beyond_memory_are_an_error() {
    let scenario = Scenario::new(Oscillator::new(1.0, 100.0).unwrap(), Coulomb::new(0.1).unwrap(), 1.0).unwrap();
    let bristles = Scenario::new(Oscillator::new(1.0, 100.0).unwrap(), Dahl::new(0.1, 1e4, 1.0).unwrap(), 1.0).unwrap();
    let sampling = Sampling::uniform(1e-3, 1_000_000_000_000_000).unwrap();
    let outcomes = [
        Exact.run(&scenario, &sampling),
        RungeKutta::default().run(&scenario, &sampling),
        Thesis::A3.run(&scenario, &sampling),
        Moreau::default().run(&scenario, &sampling),
        Bristle::default().run(&bristles, &sampling),
    ];
    for outcome in outcomes {
        let refused = outcome.unwrap_err();
        let is_memory = refused.to_string().starts_with("there is no memory for 1000000000000000 samples");
        assert!(is_memory && matches!(refused, SimulationError::Exhausted { .. }), "{refused:?}");
    }
    // A short part of a long grid is what it was.
    let window = sampling.window(1000..1003).unwrap();
    assert_eq!(Exact.run(&scenario, &window).unwrap().position().values().len(), 3);
    // Columns of derivatives count.
    let number = |value: f64| Dual::<64>::from(value);
    let machine = Oscillator::new(number(1.0), number(100.0)).unwrap();
    let scenario = Scenario::new(machine, Coulomb::new(number(0.1)).unwrap(), number(1.0)).unwrap();
    let outcome = Exact.run(&scenario, &Sampling::uniform(1e-3, 1 << 53).unwrap());
    assert!(matches!(outcome, Err(SimulationError::Exhausted { .. })));
}
