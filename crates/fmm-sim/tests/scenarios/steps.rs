//! A motion in steps is the motion of the engines, whatever happens within a step.

use fmm_friction::{
    AccelerationCoulomb, Berger, Coulomb, CoulombStatic, CoulombViscous, Dahl, FamilyMember, LawFamily, Stribeck,
    Viscous,
};
use fmm_model::{Damping, Dual, Oscillator, Restoring, Scalar};
use fmm_sim::{
    Direction, Engine, Exact, Excitation, Force, Mode, RungeKutta, Sampling, Scenario, SimulationError, State, Stepped,
    Stepper,
};

/// 10.391 kg and 0.275 N s/m on a spring of this `stiffness` (N/m).
fn machine(stiffness: f64) -> Oscillator {
    Oscillator::new(10.391, stiffness).unwrap().with_damping(Damping::linear(0.275).unwrap())
}

/// Forces (N) of a controller that does not know what it wants: between −20 and 20.
fn forces(count: usize) -> Vec<f64> {
    (0..count).map(|i| 20.0 * (1.7 * i as f64).sin() * (0.31 * i as f64 + 0.4).cos()).collect()
}

const STEP: f64 = 0.02;

/// The end of each step from (2 mm, 0.03 m/s) on.
fn walk<L: FamilyMember<Number = f64>>(stepper: &mut Stepper<L>, forces: &[Force]) -> Vec<Stepped> {
    let mut state = State { position: 0.002, velocity: 0.03 };
    forces
        .iter()
        .map(|force| {
            let stepped = stepper.step(state, *force, STEP).unwrap();
            state = stepped.state;
            stepped
        })
        .collect()
}

/// Greatest distance of a walk from the motion of an engine, as a share of the greatest position and velocity.
fn distance<L: Clone>(engine: &impl Engine<f64, L>, scenario: &Scenario<f64, L>, walk: &[Stepped]) -> f64 {
    let scenario = scenario.clone().starting_at(0.002, 0.03).unwrap();
    let motion = engine.run(&scenario, &Sampling::uniform(STEP, walk.len() + 1).unwrap()).unwrap();
    let of = |values: &[f64], component: fn(&Stepped) -> f64| {
        let most = values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let off = values[1..].iter().zip(walk).map(|(value, step)| (value - component(step)).abs());
        off.fold(0.0, f64::max) / most
    };
    let events: usize = walk.iter().map(|step| step.events).sum();
    assert!(events > 10, "only {events} events");
    of(motion.position().values(), |step| step.state.position)
        .max(of(motion.velocity().values(), |step| step.state.velocity))
}

/// `scenario` under forces that are held, each from its step on.
fn held<L: Clone>(scenario: &Scenario<f64, L>, forces: &[f64]) -> Scenario<f64, L> {
    let mut before = 0.0;
    forces.iter().enumerate().fold(scenario.clone(), |scenario, (index, force)| {
        let change = Excitation::constant(force - before).unwrap().delayed(index as f64 * STEP).unwrap();
        before = *force;
        scenario.driven_by(change)
    })
}

fn follows<L>(law: &L, stiffness: f64, engine: &impl Engine<f64, L>, tolerance: f64)
where
    L: FamilyMember<Number = f64> + Clone + std::fmt::Debug,
{
    let scenario = Scenario::new(machine(stiffness), law.clone(), 20.0).unwrap();
    let mut stepper = Stepper::new(machine(stiffness), law.clone(), 20.0).unwrap();
    let forces = forces(120);
    let steps: Vec<_> = forces.iter().map(|force| Force::held(*force)).collect();
    let off = distance(engine, &held(&scenario, &forces), &walk(&mut stepper, &steps));
    assert!(off < tolerance, "{law:?} on {stiffness} N/m, held: {off} of the motion");
    let lines: Vec<_> = forces.windows(2).map(|pair| Force::line(pair[0], pair[1])).collect();
    let sampled = Excitation::sampled_force(STEP, forces).unwrap();
    let off = distance(engine, &scenario.driven_by(sampled), &walk(&mut stepper, &lines));
    assert!(off < tolerance, "{law:?} on {stiffness} N/m, lines: {off} of the motion");
}

/// Positions without a spring are sums of all velocities before.
#[test]
fn steps_follow_the_engines() {
    follows(&Coulomb::new(0.25).unwrap(), 1982.0, &Exact, 1e-12);
    follows(&CoulombStatic::new(0.2, 0.35).unwrap(), 1982.0, &Exact, 1e-12);
    follows(&CoulombViscous::new(0.2, 0.9).unwrap(), 1982.0, &Exact, 1e-12);
    let integration = RungeKutta::default();
    follows(&CoulombStatic::new(0.2, 0.35).unwrap(), 0.0, &integration, 1e-11);
    follows(&CoulombViscous::new(0.2, 0.9).unwrap(), 0.5, &integration, 1e-11);
    follows(&Berger::new(0.15, 0.2, 20.0).unwrap(), 1982.0, &integration, 1e-11);
    follows(&Stribeck::new(0.15, 0.3, 0.02, 2.0, 0.1).unwrap(), 0.0, &integration, 1e-11);
    follows(&AccelerationCoulomb::new(0.3, 0.2).unwrap(), 1982.0, &Exact, 1e-11);
}

/// One step and two that end where it ends, from many states under many forces.
fn halves<L: FamilyMember<Number = f64> + Clone + std::fmt::Debug>(law: &L, machine: Oscillator, tolerance: f64) {
    let mut stepper = Stepper::new(machine, law.clone(), 20.0).unwrap();
    let mut events = 0;
    for (i, pair) in forces(300).windows(2).enumerate() {
        let force = Force::line(2.0 * pair[0], 2.0 * pair[1]);
        let state = State { position: 0.01 * (0.7 * i as f64).sin(), velocity: 0.05 * (1.3 * i as f64).cos() };
        let state = if i % 3 == 0 { State { velocity: 0.0, ..state } } else { state };
        let duration = [1e-3, 0.02, 0.3, 1.5][i % 4];
        let whole = stepper.step(state, force, duration).unwrap();
        let middle = 0.375 * (force.end - force.begin) + force.begin;
        let first = stepper.step(state, Force::line(force.begin, middle), 0.375 * duration).unwrap();
        let second = stepper.step(first.state, Force::line(middle, force.end), 0.625 * duration).unwrap();
        let [one, two] = [whole.state, second.state];
        let (far, fast) = (0.01 + 2.0 * duration * duration, 0.05 + 2.0 * duration);
        let off = ((one.position - two.position).abs() / far).max((one.velocity - two.velocity).abs() / fast);
        assert!(off < tolerance, "{law:?}, {state:?}, {force:?}, {duration} s: {one:?} and {two:?}");
        assert_eq!(whole.mode, second.mode, "{law:?}, {state:?}, {force:?}, {duration} s");
        events += whole.events;
    }
    assert!(events > 100, "only {events} events");
}

#[test]
fn two_steps_are_one() {
    for stiffness in [0.0, 1e-6, 30.0, 2e5] {
        // A stiff machine has hundreds of half cycles in a step, each with its rounding.
        let tolerance = if stiffness > 1e3 { 1e-11 } else { 1e-14 };
        halves(&CoulombStatic::new(0.2, 0.35).unwrap(), machine(stiffness), tolerance);
    }
    // Overdamped, so that it creeps.
    let creeping = Oscillator::new(1.0, 200.0).unwrap().with_damping(Damping::linear(500.0).unwrap());
    halves(&CoulombViscous::new(0.2, 0.9).unwrap(), creeping, 1e-14);
    // Friction that falls with the speed parts neighbouring motions, and with them the errors of an integration.
    halves(&Stribeck::new(0.15, 0.3, 0.02, 2.0, 0.1).unwrap(), machine(30.0), 1e-10);
    let bent = machine(30.0).with_restoring(Restoring::polynomial(1e3, 0.0).unwrap());
    halves(&Coulomb::new(0.2).unwrap(), bent, 1e-12);
}

/// 2 kg against 3 N, 4 N from rest, on a slide without a spring.
fn slide() -> Stepper<CoulombStatic> {
    Stepper::new(Oscillator::new(2.0, 0.0).unwrap(), CoulombStatic::new(3.0, 4.0).unwrap(), 1.0).unwrap()
}

#[test]
fn a_contact_holds_as_long_as_the_force_permits() {
    let rest = State { position: 0.25, velocity: 0.0 };
    for force in [-4.0, -1.0, 0.0, 3.9, 4.0] {
        for _ in 0..3 {
            let held = slide().step(rest, Force::held(force), 0.5).unwrap();
            assert_eq!(held, Stepped { state: rest, mode: Mode::Stick, events: 0 }, "{force} N");
        }
    }
    // From 0 to 8 N in 2 s it breaks away after 1 s, and v = (t²/2 · 4 N/s + 1 N · t)/2 kg from there on.
    let moved = slide().step(rest, Force::line(0.0, 8.0), 2.0).unwrap();
    assert_eq!((moved.events, moved.mode), (1, Mode::Slip(Direction::Positive)));
    assert!((moved.state.velocity - 1.5).abs() < 1e-15, "{} m/s", moved.state.velocity);
    assert!((moved.state.position - 0.25 - 0.25 - 1.0 / 3.0).abs() < 1e-15, "{} m", moved.state.position);
}

/// Against 3 N and a force of 5 N the other way 2 kg at 1 m/s stop after 0.25 s, at 0.125 m, and turn, as 5 N are more
/// than 4 N.
#[test]
fn a_stop_and_a_reversal_lie_within_a_step() {
    let begin = State { position: 0.0, velocity: 1.0 };
    let turned = slide().step(begin, Force::held(-5.0), 1.0).unwrap();
    assert_eq!((turned.events, turned.mode), (1, Mode::Slip(Direction::Negative)));
    assert!((turned.state.velocity + 0.75).abs() < 1e-15, "{} m/s", turned.state.velocity);
    assert!((turned.state.position - 0.125 + 0.5 * 0.75 * 0.75).abs() < 1e-15, "{} m", turned.state.position);
    let stopped = slide().step(begin, Force::held(-3.5), 1.0).unwrap();
    assert_eq!((stopped.events, stopped.mode, stopped.state.velocity), (1, Mode::Stick, 0.0));
    assert!((stopped.state.position - 1.0 / 6.5).abs() < 1e-15, "{} m", stopped.state.position);
}

/// A force that brakes and then drives on: whether the least speed is above zero decides. The speed is
/// 1 − 4 t + 2 t² (1 + δ): its least value is 1 − 2/(1 + δ).
#[test]
fn a_velocity_that_only_dips_is_seen() {
    let step = |rise: f64| {
        let machine = Oscillator::new(1.0, 0.0).unwrap();
        let mut stepper = Stepper::new(machine, CoulombStatic::new(1.0, 10.0).unwrap(), 1.0).unwrap();
        stepper.step(State { position: 0.0, velocity: 1.0 }, Force::line(-3.0, -3.0 + 4.0 * rise), 1.0).unwrap()
    };
    for gap in [1e-3, 1e-6, 1e-9] {
        assert_eq!((step(2.0 * (1.0 + gap)).events, step(2.0 * (1.0 - gap)).events), (0, 1), "{gap}");
        assert_eq!(step(2.0 * (1.0 - gap)).mode, Mode::Stick, "{gap}");
    }
}

type Gradient = Dual<8>;

/// A step at the inputs position, velocity, both forces, mass, damping, stiffness and level.
fn step_of<F: LawFamily, D: Scalar>(inputs: [D; 8], law: &[f64], duration: f64) -> Stepped<D>
where
    F::At<D>: FamilyMember<Number = D, Family = F>,
{
    let [position, velocity, begin, end, mass, damping, stiffness, level] = inputs;
    let damping = Damping::linear(damping).unwrap();
    let machine = Oscillator::new(mass, stiffness).unwrap().with_damping(damping);
    let law: Vec<D> = [level].into_iter().chain(law.iter().map(|value| D::from(*value))).collect();
    let mut stepper = Stepper::new(machine, F::at(&law).unwrap(), D::from(20.0)).unwrap();
    stepper.step(State { position, velocity }, Force::line(begin, end), duration).unwrap()
}

/// Derivatives against central differences over the size of each input, and at the values of plain numbers.
fn has_derivatives<F: LawFamily>(inputs: [f64; 8], law: &[f64], duration: f64, events: usize, tolerance: f64)
where
    F::At<f64>: FamilyMember<Number = f64, Family = F>,
    F::At<Gradient>: FamilyMember<Number = Gradient, Family = F>,
{
    let seeded = std::array::from_fn(|index| Gradient::variable(inputs[index], index));
    let exact = step_of::<F, Gradient>(seeded, law, duration);
    let plain = step_of::<F, f64>(inputs, law, duration);
    assert_eq!((exact.events, plain.events), (events, events), "{} {inputs:?}", F::NAME);
    assert_eq!(
        (exact.state.position.value(), exact.state.velocity.value()),
        (plain.state.position, plain.state.velocity)
    );
    for index in 0..8 {
        if index == 1 && inputs[1] == 0.0 {
            // A push ends before the static level is reached.
            assert_eq!(exact.state.velocity.partial(1), 0.0);
            continue;
        }
        let size = [0.01, 0.05, 20.0, 20.0, 10.0, 1.0, 200.0, 0.3][index];
        let by = 1e-5 * size;
        let [above, below] = [by, -by].map(|by| {
            let mut moved = inputs;
            moved[index] += by;
            step_of::<F, f64>(moved, law, duration).state
        });
        let pairs = [
            (exact.state.position, above.position - below.position, 0.01),
            (exact.state.velocity, above.velocity - below.velocity, 0.05),
        ];
        for (exact, rise, scale) in pairs {
            let (exact, difference) = (exact.partial(index) * size / scale, rise / (2.0 * by) * size / scale);
            let off = (exact - difference).abs();
            assert!(off < tolerance, "{}, input {index}: {exact} for {difference}", F::NAME);
        }
    }
}

/// Central differences over 1e-5 are good to some 1e-9 of the size, times the third derivatives.
#[test]
fn derivatives_go_through_events() {
    // On a spring: sliding on, a stop, a reversal, and a breakaway.
    let sliding = [0.002, 0.05, 3.0, 9.0, 10.0, 0.3, 200.0, 0.2];
    let stopping = [0.002, 0.01, -2.0, -3.0, 10.0, 0.3, 200.0, 0.2];
    let turning = [0.002, 0.01, -9.0, -12.0, 10.0, 0.3, 200.0, 0.2];
    let leaving = [0.002, 0.0, 0.5, 12.0, 10.0, 0.3, 200.0, 0.2];
    for stiffness in [200.0, 0.0] {
        for (inputs, events) in [(sliding, 0), (stopping, 1), (turning, 1), (leaving, 1)] {
            let mut inputs = inputs;
            if stiffness == 0.0 && inputs[1] == 0.0 {
                inputs[2] = 0.1;
            }
            inputs[6] = stiffness;
            let is_rail = stiffness == 0.0;
            // Below zero there is no stiffness to take a difference with.
            inputs[6] += if is_rail { 0.1 } else { 0.0 };
            has_derivatives::<CoulombViscous>(inputs, &[0.1], 0.05, events, 1e-7);
            has_derivatives::<Stribeck>(inputs, &[0.25, 0.02, 1.0, 0.1], 0.05, events, 1e-6);
        }
    }
}

/// A machine without any dry friction rests nowhere, and its derivatives say so.
#[test]
fn nothing_holds_a_machine_without_friction() {
    let machine = Oscillator::new(Dual::<1>::from(2.0), Dual::from(0.0)).unwrap();
    let mut stepper = Stepper::new(machine, Viscous::new(Dual::from(0.0)).unwrap(), Dual::from(1.0)).unwrap();
    let rest = State { position: Dual::from(0.0), velocity: Dual::from(0.0) };
    let end = stepper.step(rest, Force::held(Dual::variable(0.0, 0)), 0.5).unwrap();
    assert_eq!((end.state.velocity.value(), end.state.velocity.partial(0), end.events), (0.0, 0.25, 0));
    assert_eq!(end.state.position.partial(0), 0.0625);
}

#[test]
fn what_cannot_be_stepped_is_refused() {
    let rest = State { position: 0.0, velocity: 0.0 };
    let refused = |state, force, duration| slide().step(state, force, duration).unwrap_err();
    for bad in [f64::NAN, f64::INFINITY] {
        for error in [
            refused(State { position: bad, ..rest }, Force::held(0.0), 1.0),
            refused(State { velocity: bad, ..rest }, Force::held(0.0), 1.0),
            refused(rest, Force::line(bad, 0.0), 1.0),
            refused(rest, Force::line(0.0, bad), 1.0),
            refused(rest, Force::held(0.0), bad),
        ] {
            assert!(matches!(error, SimulationError::Quantity(_)), "{error}");
        }
    }
    assert!(matches!(refused(rest, Force::held(0.0), 0.0), SimulationError::Quantity(_)));
    assert!(matches!(refused(rest, Force::held(1e300), 1e300), SimulationError::NotFinite { .. }));
    let machine = machine(100.0);
    let has_past = |refused: Result<_, SimulationError>| {
        assert!(matches!(refused, Err(SimulationError::NotSupported { engine: "stepping", .. })));
    };
    has_past(Stepper::new(machine, Dahl::new(0.2, 1e4, 1.0).unwrap(), 1.0).map(|_| ()));
    has_past(Stepper::new(machine, AccelerationCoulomb::new(0.2, 0.3).unwrap(), 1.0).map(|_| ()));
    assert!(Stepper::new(machine, Coulomb::new(0.2).unwrap(), -1.0).is_err());
}
