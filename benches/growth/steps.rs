//! Steps of a machine in a loop, by their length and by the derivatives that they carry.

use fmm_friction::{CoulombStatic, FamilyMember, LawFamily, Stribeck};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Force, State, Stepper};

use crate::least::Unit::Nanosecond;
use crate::least::{least, print_row};

/// Steps that are timed together: they slide, stop, hold and break away.
const STEPS: usize = 200;

/// Time (s) of one of many steps of `duration` (ms), under a force that holds the contact at times.
fn time<F: LawFamily, D: Scalar>(law: &[f64], stiffness: f64, duration: f64, number: impl Fn(usize, f64) -> D) -> f64
where
    F::At<D>: FamilyMember<Number = D, Family = F>,
{
    let law: Vec<D> = law.iter().enumerate().map(|(index, value)| number(4 + index, *value)).collect();
    let damping = Damping::linear(number(7, 0.275)).expect("valid");
    let machine = Oscillator::new(number(3, 10.391), D::from(stiffness)).expect("valid").with_damping(damping);
    let mut stepper = Stepper::new(machine, F::at(&law).expect("a law"), D::from(7.2)).expect("valid");
    let force = |i: usize| 4.0 * (0.02 * duration * i as f64).sin();
    let forces: Vec<_> = (0..=STEPS).map(|i| number(2, force(i))).collect();
    let begin = State { position: number(0, 0.001), velocity: number(1, 0.02) };
    let walk = || {
        forces.windows(2).fold((begin, 0), |(state, events), pair| {
            // The derivatives by the state before each step, as an observer asks for them.
            let [position, velocity] = [(0, state.position), (1, state.velocity)].map(|(i, x)| number(i, x.value()));
            let force = Force::line(pair[0], pair[1]);
            let stepped = stepper.step(State { position, velocity }, force, 1e-3 * duration).expect("finite");
            (stepped.state, events + stepped.events)
        })
    };
    least(walk) / STEPS as f64
}

fn plain(_: usize, value: f64) -> f64 {
    value
}

fn carried<const N: usize>(index: usize, value: f64) -> Dual<N> {
    if index < N { Dual::variable(value, index) } else { Dual::from(value) }
}

pub(crate) fn print_rows() {
    let (levels, stribeck) = ([0.15, 0.3], [0.15, 0.3, 0.02, 2.0, 0.1]);
    let lengths = [1.0, 5.0, 20.0, 100.0];
    print_row("`Stepper`, two levels, steps of ms", Nanosecond, &lengths, |duration| {
        time::<CoulombStatic, _>(&levels, 1982.0, duration, plain)
    });
    print_row("`Stepper`, two levels without a spring, steps of ms", Nanosecond, &lengths, |duration| {
        time::<CoulombStatic, _>(&levels, 0.0, duration, plain)
    });
    print_row("`Stepper`, `Stribeck`, steps of ms", Nanosecond, &lengths, |duration| {
        time::<Stribeck, _>(&stribeck, 1982.0, duration, plain)
    });
    print_row("`Stepper`, two levels, derivatives of steps of 1 ms", Nanosecond, &[0, 3, 6], |count| match count {
        0 => time::<CoulombStatic, _>(&levels, 1982.0, 1.0, plain),
        3 => time::<CoulombStatic, _>(&levels, 1982.0, 1.0, carried::<3>),
        _ => time::<CoulombStatic, _>(&levels, 1982.0, 1.0, carried::<6>),
    });
    print_row("`Stepper`, `Stribeck`, derivatives of steps of 1 ms", Nanosecond, &[0, 3, 6], |count| match count {
        0 => time::<Stribeck, _>(&stribeck, 1982.0, 1.0, plain),
        3 => time::<Stribeck, _>(&stribeck, 1982.0, 1.0, carried::<3>),
        _ => time::<Stribeck, _>(&stribeck, 1982.0, 1.0, carried::<6>),
    });
}
