//! After the construction, steps allocate nothing.

use allocation_counter::measure;
use fmm_friction::{Berger, CoulombStatic, FamilyMember, Stribeck};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Force, Mode, State, Stepper};

type Gradient = Dual<3>;

/// A machine that begins to slide, stops, holds and breaks away in steps of 5 ms.
fn takes_no_memory<D: Scalar, L: FamilyMember<Number = D>>(law: L, stiffness: f64) {
    let machine = Oscillator::new(D::from(10.0), D::variable(stiffness, 2)).unwrap();
    let machine = machine.with_damping(Damping::linear(D::from(0.3)).unwrap());
    let mut stepper = Stepper::new(machine, law, D::from(20.0)).unwrap();
    let mut state = State { position: D::from(0.002), velocity: D::from(0.02) };
    let (mut holds, mut events) = (0, 0);
    let counted = measure(|| {
        for index in 0..400 {
            let force = |index: i32| D::variable((8.0 + 0.005 * stiffness) * (0.05 * f64::from(index)).sin(), 0);
            let stepped = stepper.step(state, Force::line(force(index), force(index + 1)), 5e-3).unwrap();
            state = State { velocity: D::variable(stepped.state.velocity.value(), 1), ..stepped.state };
            holds += usize::from(stepped.mode == Mode::Stick);
            events += stepped.events;
        }
    });
    assert!(holds > 0 && events > 3, "{holds} steps that hold, {events} events");
    assert_eq!(counted.count_total, 0, "{counted:?} on {stiffness} N/m");
}

#[test]
fn steps_allocate_nothing() {
    for stiffness in [0.0, 100.0, 1982.0] {
        takes_no_memory::<f64, _>(CoulombStatic::new(0.2, 0.3).unwrap(), stiffness);
        takes_no_memory::<f64, _>(Stribeck::new(0.15, 0.3, 0.02, 2.0, 0.1).unwrap(), stiffness);
        takes_no_memory::<f64, _>(Berger::new(0.15, 0.2, 20.0).unwrap(), stiffness);
        let [low, high, slow, one] = [0.2, 0.3, 0.02, 1.0].map(Gradient::from);
        takes_no_memory(CoulombStatic::new(low, high).unwrap(), stiffness);
        takes_no_memory(Stribeck::new(low, high, slow, one, Gradient::from(0.1)).unwrap(), stiffness);
        // As steep as the derivatives of a step by the speed are for.
        takes_no_memory(Stribeck::new(low, high, Gradient::from(2e-4), one, Gradient::from(0.1)).unwrap(), stiffness);
    }
    // The counter counts.
    assert!(measure(|| drop(std::hint::black_box(vec![1.0]))).count_total > 0);
}
