//! Every input of a force has its derivative: sampled values, delays, and amplitudes that are zero.

use fmm_friction::{CoulombStatic, Dahl, LawFamily, MaxwellSlip, Stribeck};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Bristle, Engine, Exact, Excitation, RungeKutta, Sampling, Scenario, Trajectory};

/// The forces that inputs `p` make, and the velocity with which the machine starts.
type Case<D> = (fn([D; 2]) -> Vec<Excitation<D>>, f64);

fn scenario<D: Scalar, L>(law: L, (forces, start): Case<D>, inputs: [D; 2]) -> Scenario<D, L> {
    let number = |value: f64| D::from(value);
    let machine = Oscillator::new(number(1.0), number(100.0)).unwrap();
    let machine = machine.with_damping(Damping::linear(number(0.2)).unwrap());
    let scenario = Scenario::new(machine, law, number(10.0)).unwrap().starting_at(number(0.0), number(start)).unwrap();
    forces(inputs).into_iter().fold(scenario, Scenario::driven_by)
}

fn sampled<D: Scalar>(values: &[D], delay: D) -> Excitation<D> {
    Excitation::sampled_force(0.05, values.to_vec()).unwrap().delayed(delay).unwrap()
}

/// One value of a continuous pulse, and its delay.
fn pulse<D: Scalar>([value, delay]: [D; 2]) -> Vec<Excitation<D>> {
    vec![sampled(&[D::from(0.0), D::from(9.0), value, D::from(4.0), D::from(0.0)], delay)]
}

/// A force that jumps up at its beginning and down at its end.
fn jumps<D: Scalar>([value, delay]: [D; 2]) -> Vec<Excitation<D>> {
    vec![sampled(&[value, D::from(7.0), D::from(5.0)], delay)]
}

/// Constant forces that begin at once and later.
fn steps<D: Scalar>([value, delay]: [D; 2]) -> Vec<Excitation<D>> {
    let constant = |force| Excitation::constant(force).unwrap();
    vec![constant(value), constant(D::from(-9.0)).delayed(delay).unwrap()]
}

fn shapes<D: Scalar>([first, second]: [D; 2]) -> Vec<Excitation<D>> {
    vec![
        Excitation::half_sine(D::from(20.0), D::from(0.1)).unwrap().delayed(second).unwrap(),
        Excitation::ramp(D::from(15.0)).unwrap().delayed(first * 0.01).unwrap(),
    ]
}

/// Excitations that are zero have derivatives.
fn nothing<D: Scalar>([first, second]: [D; 2]) -> Vec<Excitation<D>> {
    vec![
        Excitation::harmonic(first - 8.0, D::from(7.0), D::from(0.4)).unwrap(),
        Excitation::ramp(second - 0.07).unwrap(),
    ]
}

macro_rules! check {
    ($engine:expr, $name:expr, $law:expr, $most:expr) => {
        for (case, forces, dual_forces) in [
            ("pulse", pulse as fn([f64; 2]) -> _, pulse as fn([Dual<2>; 2]) -> _),
            ("jumps", jumps, jumps),
            ("steps", steps, steps),
            ("shapes", shapes, shapes),
            ("nothing", nothing, nothing),
        ] {
            for start in [0.0, 0.3] {
                // Bristles that nothing moves are at rest, with their derivatives, which the start says is grazing.
                if ($name, case, start) == ("dahl", "nothing", 0.0) {
                    continue;
                }
                let sampling = Sampling::uniform(0.0371, 12).unwrap();
                let at = |inputs: [f64; 2]| -> Trajectory {
                    $engine.run(&scenario($law, (forces, start), inputs), &sampling).unwrap()
                };
                let inputs = [Dual::variable(8.0, 0), Dual::variable(0.07, 1)];
                let law = $law;
                let motion = $engine.run(&scenario(law, (dual_forces, start), inputs), &sampling).unwrap();
                for (direction, step) in [(0, 1e-4), (1, 1e-6)] {
                    let moved = |sign: f64| {
                        let mut inputs = [8.0, 0.07];
                        inputs[direction] += sign * step;
                        at(inputs)
                    };
                    let (up, down) = (moved(1.0), moved(-1.0));
                    let [position, velocity] = [motion.position(), motion.velocity()];
                    for (samples, up, down) in
                        [(position, up.position(), down.position()), (velocity, up.velocity(), down.velocity())]
                    {
                        let slopes = samples.partial(direction).unwrap();
                        let quotients = up.values().iter().zip(down.values()).map(|(up, down)| (up - down) / (2.0 * step));
                        let size = slopes.iter().fold(1e-6f64, |most, slope| most.max(slope.abs()));
                        for (index, (slope, quotient)) in slopes.iter().zip(quotients).enumerate() {
                            assert!(
                                (slope - quotient).abs() < $most * size,
                                "{}, {case} from {start} m/s, direction {direction}, sample {index}: {slope} against {quotient}",
                                $name
                            );
                        }
                    }
                }
            }
        }
    };
}

fn law<F: LawFamily, D: Scalar, const N: usize>(values: [f64; N]) -> F::At<D> {
    F::at(&values.map(D::from)).unwrap()
}

fn elements<D: Scalar>() -> MaxwellSlip<D> {
    MaxwellSlip::new(&[(500.0, 0.1), (200.0, 0.1)].map(|(stiffness, level)| (D::from(stiffness), D::from(level))))
        .unwrap()
}

#[test]
fn of_the_closed_form() {
    check!(Exact, "exact", law::<CoulombStatic, _, _>([0.2, 0.3]), 1e-5);
    check!(Exact, "elements", elements(), 1e-5);
}

#[test]
fn of_the_integrators() {
    check!(RungeKutta::default(), "runge_kutta", law::<CoulombStatic, _, _>([0.2, 0.3]), 1e-5);
    check!(RungeKutta::default(), "stribeck", law::<Stribeck, _, _>([0.2, 0.3, 0.1, 1.0, 0.05]), 1e-5);
    check!(Bristle::default(), "dahl", law::<Dahl, _, _>([0.2, 500.0, 1.0]), 1e-4);
}
