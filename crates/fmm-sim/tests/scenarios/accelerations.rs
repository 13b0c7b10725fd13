//! Accelerations are those of the equation of motion, the derivatives of the velocities, and have derivatives
//! themselves.

use fmm_friction::{
    AccelerationCoulomb, Berger, BristleLaw, Coulomb, CoulombStatic, CoulombViscous, Dahl, LawFamily, LuGre,
    MaxwellSlip, PowerLaw, Regime, SlidingLaw, Stribeck,
};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{
    Bristle, Channels, Engine, Exact, Excitation, Mode, Moreau, RungeKutta, Samples, Sampling, Scenario,
    SimulationError, Thesis, Trajectory,
};

const MASS: f64 = 2.0;
const STIFFNESS: f64 = 300.0;
const DAMPING: f64 = 0.4;
const LOAD: f64 = 10.0;
const BELT: f64 = 0.15;
/// Amplitude (N), angular frequency (rad/s) and phase (rad).
const WAVE: [f64; 3] = [6.0, 9.0, 0.4];
/// Samples (N) and their interval (s).
const PULSE: [f64; 5] = [0.0, 9.0, -4.0, 5.0, 0.0];
const PULSE_INTERVAL: f64 = 0.17;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Cause {
    Free,
    Harmonic,
    Sampled,
    Belt,
}

const CAUSES: [Cause; 4] = [Cause::Free, Cause::Harmonic, Cause::Sampled, Cause::Belt];

impl Cause {
    fn belt(self) -> f64 {
        if self == Self::Belt { BELT } else { 0.0 }
    }

    fn force(self, time: f64) -> f64 {
        match self {
            Self::Harmonic => WAVE[0] * (WAVE[1] * time + WAVE[2]).cos(),
            Self::Sampled => {
                let left = (time / PULSE_INTERVAL) as usize;
                let part = time / PULSE_INTERVAL - left as f64;
                PULSE.get(left + 1).map_or(0.0, |next| PULSE[left] + (next - PULSE[left]) * part)
            }
            Self::Free | Self::Belt => 0.0,
        }
    }
}

/// Factors of mass, stiffness, damping, load, start, speed at the start, and what acts.
const FACTORS: [f64; 7] = [1.0; 7];

fn scenario<D: Scalar, L>(law: L, cause: Cause, factors: [D; 7]) -> Scenario<D, L> {
    let machine = Oscillator::new(factors[0] * MASS, factors[1] * STIFFNESS).unwrap();
    let machine = machine.with_damping(Damping::linear(factors[2] * DAMPING).unwrap());
    let scenario = Scenario::new(machine, law, factors[3] * LOAD).unwrap();
    let scenario = scenario.starting_at(factors[4] * 0.05, factors[5] * 0.3).unwrap();
    let scale = factors[6];
    let number = |value: f64| D::from(value);
    match cause {
        Cause::Free => scenario,
        Cause::Harmonic => {
            scenario.driven_by(Excitation::harmonic(scale * WAVE[0], number(WAVE[1]), number(WAVE[2])).unwrap())
        }
        Cause::Sampled => {
            let values: Vec<D> = PULSE.iter().map(|value| scale * *value).collect();
            scenario.driven_by(Excitation::sampled_force(PULSE_INTERVAL, values).unwrap())
        }
        Cause::Belt => scenario.driven_by(Excitation::belt(scale * BELT).unwrap()),
    }
}

fn law<F: LawFamily, D: Scalar, const N: usize>(values: [f64; N]) -> F::At<D> {
    F::at(&values.map(D::from)).unwrap()
}

fn elements<D: Scalar>() -> MaxwellSlip<D> {
    MaxwellSlip::new(&[(500.0, 0.06), (200.0, 0.04)].map(|(stiffness, level)| (D::from(stiffness), D::from(level))))
        .unwrap()
}

const INTERVAL: f64 = 5e-4;

fn sampling() -> Sampling {
    Sampling::uniform(INTERVAL, 3000).unwrap().keeping(Channels::All)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// The mode at each sample; none within `distance` (s) of an event or of a corner of the force.
fn modes<D: Scalar>(motion: &Trajectory<D>, distance: f64) -> Vec<Option<Mode>> {
    let mode = |time: f64| {
        let events = motion.events();
        let corner = time / PULSE_INTERVAL;
        let near_corner = (corner - corner.round()).abs() * PULSE_INTERVAL < distance;
        let near_event = events.iter().any(|event| (event.time.value() - time).abs() < distance);
        let last = events.iter().rfind(|event| event.time.value() <= time);
        last.map(|event| event.next).filter(|_| !near_corner && !near_event)
    };
    motion.times().map(mode).collect()
}

/// Coefficient of friction by a law of the sliding speed, with its sign; none where the contact does not slide or does
/// so steadily.
fn sliding<L: SlidingLaw<f64>>(law: &L, mode: Mode, relative: f64) -> Option<f64> {
    match mode {
        Mode::Losing(direction) => Some(direction.sign() * law.coefficient_losing_speed(relative.abs())),
        Mode::Slip(direction) | Mode::Gaining(direction) => Some(direction.sign() * law.coefficient(relative.abs())),
        _ => None,
    }
}

/// Compares with the equation of motion, and with differences of the velocity; the number of samples looked at.
fn check(
    motion: &Trajectory,
    cause: Cause,
    name: &str,
    steps: bool,
    friction: impl Fn(Mode, f64, &[f64]) -> Option<f64>,
) -> usize {
    let [x, v, a] = [motion.position(), motion.velocity(), motion.acceleration()].map(Samples::values);
    let size = largest(a);
    let modes = modes(motion, 3.0 * INTERVAL);
    let mut checked = 0;
    for (index, mode) in modes.iter().enumerate() {
        let Some(mode) = *mode else { continue };
        let time = index as f64 * INTERVAL;
        let states: Vec<f64> = motion.states().iter().map(|state| state.values()[index]).collect();
        let expected = friction(mode, v[index] - cause.belt(), &states).map_or(0.0, |friction| {
            (cause.force(time) - STIFFNESS * x[index] - DAMPING * v[index] - LOAD * friction) / MASS
        });
        let off = (a[index] - expected).abs();
        assert!(off < 1e-9 * size, "{name}, {cause:?}: {} m/s² at {time} s, not {expected}", a[index]);
        if !steps && index >= 2 && index + 2 < a.len() {
            let slope = (8.0 * (v[index + 1] - v[index - 1]) - (v[index + 2] - v[index - 2])) / (12.0 * INTERVAL);
            let off = (a[index] - slope).abs();
            assert!(off < 1e-6 * size, "{name}, {cause:?}: {} m/s² at {time} s, but x′ grows by {slope}", a[index]);
        }
        checked += 1;
    }
    checked
}

macro_rules! obeys {
    (sliding $engine:expr, $name:expr, $law:expr) => {
        for cause in CAUSES {
            let motion = $engine.run(&scenario($law, cause, FACTORS), &sampling()).unwrap();
            let law = $law;
            let checked = check(&motion, cause, $name, $name == "moreau", |mode, u, _| sliding(&law, mode, u));
            assert!(checked > 2500, "{}, {cause:?}: only {checked} samples", $name);
        }
    };
    (bristles $engine:expr, $name:expr, $law:expr) => {
        for cause in CAUSES {
            let motion = $engine.run(&scenario($law, cause, FACTORS), &sampling()).unwrap();
            let law = $law;
            let checked = check(&motion, cause, $name, true, |mode, u, states| {
                let mut rate = vec![0.0; states.len()];
                law.rate(u, states, Regime::ALL_HOLD, &mut rate);
                (mode != Mode::Stick).then(|| law.coefficient(u, states, &rate))
            });
            assert!(checked > 1500, "{}, {cause:?}: only {checked} samples", $name);
        }
    };
}

#[test]
fn obey_the_equation_of_motion_and_are_slopes() {
    obeys!(sliding Exact, "exact coulomb", law::<Coulomb, f64, _>([0.1]));
    obeys!(sliding Exact, "exact static", law::<CoulombStatic, f64, _>([0.1, 0.2]));
    obeys!(sliding Exact, "exact viscous", law::<CoulombViscous, f64, _>([0.1, 0.05]));
    obeys!(sliding Exact, "exact acceleration", law::<AccelerationCoulomb, f64, _>([0.12, 0.1]));
    let integrator = RungeKutta::default();
    obeys!(sliding integrator, "runge_kutta static", law::<CoulombStatic, f64, _>([0.1, 0.2]));
    obeys!(sliding integrator, "runge_kutta acceleration", law::<AccelerationCoulomb, f64, _>([0.12, 0.1]));
    obeys!(sliding integrator, "runge_kutta stribeck", law::<Stribeck, f64, _>([0.1, 0.15, 0.2, 1.0, 0.05]));
    obeys!(sliding integrator, "runge_kutta berger", law::<Berger, f64, _>([0.1, 0.05, 2.0]));
    obeys!(sliding Moreau::default(), "moreau", law::<CoulombStatic, f64, _>([0.1, 0.2]));
}

#[test]
fn obey_the_equation_of_motion_with_bristles() {
    obeys!(bristles Bristle::default(), "dahl", law::<Dahl, f64, _>([0.1, 500.0, 1.0]));
    obeys!(bristles Bristle::default(), "lugre", law::<LuGre, f64, _>([0.1, 0.15, 0.1, 2.0, 2e3, 3.0, 0.05]));
    obeys!(bristles Exact, "exact elements", elements::<f64>());
    obeys!(bristles Bristle::default(), "elements", elements::<f64>());
}

/// Coulomb friction without damping: a = ∓ω² (x₀ − (2n + 1) F/k) cos ω(t − nπ/ω) in half swing n.
#[test]
fn are_those_of_the_closed_form() {
    let (coefficient, start) = (0.05, 0.02);
    let (force, omega) = (coefficient * LOAD, (STIFFNESS / MASS).sqrt());
    let step = force / STIFFNESS;
    let machine = Oscillator::new(MASS, STIFFNESS).unwrap();
    let scenario = Scenario::new(machine, Coulomb::new(coefficient).unwrap(), LOAD).unwrap();
    let scenario = scenario.starting_at(start, 0.0).unwrap();
    let half = std::f64::consts::PI / omega;
    let first = Exact.run(&scenario, &Sampling::uniform(0.01, 200).unwrap()).unwrap();
    let turns: Vec<f64> = first.events()[1..].iter().map(|event| event.time).collect();
    assert_eq!(turns.len(), 6, "{turns:?}");
    assert!(first.rest().is_some());

    let mut times: Vec<f64> = (0..180).map(|index| f64::from(index) * 0.01).collect();
    times.extend(turns.iter().flat_map(|turn| [turn.next_down(), *turn]));
    times.sort_by(f64::total_cmp);
    let motion = Exact.run(&scenario, &Sampling::at(times.clone()).unwrap().keeping(Channels::All)).unwrap();
    let a = motion.acceleration().values();
    for (time, a) in times.iter().zip(a) {
        let swings = turns.iter().filter(|turn| *turn <= time).count();
        let sign = if swings % 2 == 0 { -1.0 } else { 1.0 };
        let amplitude = omega * omega * (start - (2 * swings + 1) as f64 * step);
        let moving = sign * amplitude * (omega * (time - swings as f64 * half)).cos();
        let expected = if swings == turns.len() { 0.0 } else { moving };
        assert!((a - expected).abs() < 1e-12, "{a} m/s² at {time} s, not {expected}");
    }
    for (index, turn) in turns[..5].iter().enumerate() {
        let at = times.iter().position(|time| time == turn).unwrap();
        let jump = (a[at] - a[at - 1]).abs();
        assert!((jump - 2.0 * force / MASS).abs() < 1e-12, "jump {index} of {jump} m/s²");
    }
}

macro_rules! differences {
    ($engine:expr, $name:expr, $law:expr) => {
        for cause in CAUSES {
            let sampling = Sampling::uniform(0.0071, 120).unwrap().keeping(Channels::All);
            let factors = std::array::from_fn(|direction| Dual::<7>::variable(1.0, direction));
            let motion = {
                let law = $law;
                $engine.run(&scenario(law, cause, factors), &sampling).unwrap()
            };
            let size = largest(motion.acceleration().values());
            let modes = modes(&motion, 3e-3);
            for direction in 0..7 {
                let moved = |by: f64| {
                    let mut factors = FACTORS;
                    factors[direction] += by;
                    let motion: Trajectory = $engine.run(&scenario($law, cause, factors), &sampling).unwrap();
                    motion.acceleration().values().to_vec()
                };
                // The formula is off by step⁴, which is 2e-7 at 2e-4; bristles feel a change of stiffness most.
                let step = 5e-5;
                let [up, down, far_up, far_down] = [step, -step, 2.0 * step, -2.0 * step].map(moved);
                let partial = motion.acceleration().partial(direction).unwrap();
                let scale = largest(partial).max(size);
                for (index, _) in modes.iter().enumerate().filter(|(_, mode)| mode.is_some()) {
                    let near = 8.0 * (up[index] - down[index]);
                    let slope = (near - (far_up[index] - far_down[index])) / (12.0 * step);
                    assert!(
                        (slope - partial[index]).abs() < 1e-7 * scale,
                        "{}, {cause:?}, direction {direction}, sample {index}: {} against {slope}, {scale}",
                        $name,
                        partial[index]
                    );
                }
            }
        }
    };
}

#[test]
fn have_their_derivatives_in_closed_form() {
    differences!(Exact, "static", law::<CoulombStatic, _, _>([0.1, 0.2]));
    differences!(Exact, "viscous", law::<CoulombViscous, _, _>([0.1, 0.05]));
    differences!(Exact, "elements", elements());
}

#[test]
fn have_their_derivatives_in_the_integrators() {
    differences!(RungeKutta::default(), "static", law::<CoulombStatic, _, _>([0.1, 0.2]));
    differences!(RungeKutta::default(), "stribeck", law::<Stribeck, _, _>([0.1, 0.15, 0.2, 1.0, 0.05]));
    let tight = Bristle::new(1e-13).unwrap();
    differences!(tight, "dahl", law::<Dahl, _, _>([0.1, 500.0, 1.0]));
    differences!(tight, "lugre", law::<LuGre, _, _>([0.1, 0.15, 0.1, 2.0, 2e3, 3.0, 0.05]));
}

macro_rules! windows {
    ($engine:expr, $name:expr, $law:expr, $most:expr) => {
        for cause in CAUSES {
            let scenario = scenario($law, cause, FACTORS);
            let whole = $engine.run(&scenario, &sampling()).unwrap();
            let a = whole.acceleration().values();
            for range in [0..1, 700..1900, 2990..3000] {
                let window = sampling().window(range.clone()).unwrap();
                let part = $engine.run(&scenario, &window).unwrap();
                assert_eq!(part.acceleration().values().len(), range.len());
                for (one, other) in part.acceleration().values().iter().zip(&a[range]) {
                    let off = (one - other).abs();
                    assert!(off < $most * largest(a), "{}, {cause:?}: {one} m/s², not {other}", $name);
                }
            }
            let both = $engine.run(&scenario, &sampling().keeping(Channels::Both)).unwrap();
            assert_eq!((both.position(), both.velocity()), (whole.position(), whole.velocity()), "{}", $name);
            assert!(both.acceleration().values().is_empty());
        }
    };
}

#[test]
fn are_the_same_in_any_window() {
    windows!(Exact, "exact", law::<CoulombStatic, f64, _>([0.1, 0.2]), 1e-13);
    windows!(Exact, "exact elements", elements::<f64>(), 1e-13);
    // The last step ends at the last sample, and so is another one to the tolerance.
    windows!(RungeKutta::default(), "runge_kutta", law::<CoulombStatic, f64, _>([0.1, 0.2]), 1e-12);
    windows!(Bristle::default(), "bristle", law::<Dahl, f64, _>([0.1, 500.0, 1.0]), 1e-10);
    windows!(Moreau::default(), "moreau", law::<CoulombStatic, f64, _>([0.1, 0.2]), 1e-15);
}

/// A coefficient of infinite slope at rest leaves no derivative that is no number.
#[test]
fn have_derivatives_at_rest() {
    let factors = std::array::from_fn(|direction| Dual::<7>::variable(1.0, direction));
    let root = law::<PowerLaw, Dual<7>, _>([0.1, 0.5, 0.5]);
    let motion = RungeKutta::default().run(&scenario(root, Cause::Free, factors), &sampling()).unwrap();
    for direction in 0..7 {
        let partial = motion.acceleration().partial(direction).unwrap();
        assert!(partial.iter().all(|number| number.is_finite()), "direction {direction}");
    }
}

#[test]
fn the_thesis_has_none() {
    let scenario = scenario(law::<Coulomb, f64, _>([0.1]), Cause::Free, FACTORS);
    assert!(matches!(Thesis::A3.run(&scenario, &sampling()), Err(SimulationError::NotSupported { .. })));
}
