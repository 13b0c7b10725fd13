//! Engines: samples, half swings, derivatives, tolerance, stiffness and states.

use std::fmt::{self, Display};

use fmm_friction::{Berger, BoucWen, Coulomb, Dahl, Gms, LawFamily, LuGre, MaxwellSlip, Stribeck};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{
    Bristle, Channels, Engine, Exact, Excitation, Moreau, RungeKutta, Sampling, Scenario, Thesis, Trajectory,
};

use crate::least::Unit::Microsecond;
use crate::least::{least, print_row};

/// The normal load (N).
const LOAD: f64 = 7.2;
/// Duration (s) of the thesis' ring-down of seven half swings at μ = 0.15.
const DURATION: f64 = 1.5;

/// Levels of friction over that of the shortest motion.
const LEVELS: [f64; 4] = [1.0, 0.3, 0.1, 0.03];

/// A number that carries no derivative.
fn plain(_: usize, value: f64) -> f64 {
    value
}

/// Number `index` among the variables, if so many are carried.
fn carried<const N: usize>(index: usize, value: f64) -> Dual<N> {
    if index < N { Dual::variable(value, index) } else { Dual::from(value) }
}

/// The thesis' machine with a contact that begins at `position` (m) and `velocity` (m/s).
fn starting<D: Scalar, L>(law: L, number: impl Fn(usize, f64) -> D, position: f64, velocity: f64) -> Scenario<D, L> {
    let damping = Damping::linear(number(2, 0.275)).expect("valid");
    let machine = Oscillator::new(number(3, 10.391), number(4, 1982.0)).expect("valid").with_damping(damping);
    let scenario = Scenario::new(machine, law, number(5, LOAD)).expect("valid");
    scenario.starting_at(number(6, position), number(7, velocity)).expect("valid")
}

fn velocities(duration: f64, samples: usize) -> Sampling {
    Sampling::uniform(duration / (samples - 1) as f64, samples).expect("valid").keeping(Channels::Velocity)
}

fn run<D: Scalar, L, E: Engine<D, L>>(engine: &E, scenario: &Scenario<D, L>, sampling: &Sampling) -> f64 {
    let mut trajectory = Trajectory::new();
    engine.run_into(scenario, sampling, &mut trajectory).expect("valid");
    least(|| engine.run_into(scenario, sampling, &mut trajectory).is_ok())
}

/// The thesis' ring-down.
fn coulomb<D: Scalar>(number: impl Fn(usize, f64) -> D) -> Scenario<D, Coulomb<D>> {
    starting(Coulomb::at(&[number(0, 0.15)]).expect("valid"), number, 0.0, 0.101)
}

/// A ring-down under about `count` half swings' worth of friction, and its length (s).
fn long(count: usize) -> (Scenario<f64, Coulomb>, f64) {
    let machine = Oscillator::new(10.391, 1982.0).expect("valid");
    let level = 0.02 * 1982.0 / (2.0 * count as f64 * LOAD);
    let scenario = Scenario::new(machine, Coulomb::new(level).expect("valid"), LOAD).expect("valid");
    let half_swing = std::f64::consts::PI * (10.391_f64 / 1982.0).sqrt();
    (scenario.starting_at(0.02, 0.0).expect("valid"), 1.1 * half_swing * count as f64)
}

/// A motion that weaker friction makes last longer, called by its number of half swings.
#[derive(Clone, Copy)]
struct Lasting {
    /// The level over that of the shortest (1).
    level: f64,
    half_swings: usize,
}

impl Display for Lasting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.half_swings)
    }
}

/// The motions that `scenario` has at these levels, over times in inverse proportion to them.
fn lasting<L, E: Engine<f64, L>>(
    engine: &E,
    shortest: f64,
    levels: [f64; 4],
    scenario: impl Fn(f64) -> Scenario<f64, L>,
) -> [Lasting; 4] {
    levels.map(|level| {
        let motion = engine.run(&scenario(level), &velocities(shortest / level, 16)).expect("valid");
        Lasting { level, half_swings: motion.half_cycles() }
    })
}

fn exact_rows() {
    print_row("`Exact`, samples of 7 half swings", Microsecond, &[16, 151, 1501, 15_001, 150_001], |samples| {
        run(&Exact, &coulomb(plain), &velocities(DURATION, samples))
    });
    print_row("`Exact`, half swings in 16 samples", Microsecond, &[5, 10, 50, 100, 1000], |count| {
        let (scenario, duration) = long(count);
        run(&Exact, &scenario, &velocities(duration, 16))
    });
    let sampling = velocities(DURATION, 1501);
    print_row("`Exact`, derivatives of 1501 samples", Microsecond, &[0, 1, 2, 4, 8], |count| match count {
        0 => run(&Exact, &coulomb(plain), &sampling),
        1 => run(&Exact, &coulomb(carried::<1>), &sampling),
        2 => run(&Exact, &coulomb(carried::<2>), &sampling),
        4 => run(&Exact, &coulomb(carried::<4>), &sampling),
        _ => run(&Exact, &coulomb(carried::<8>), &sampling),
    });
    print_row("`Exact`, elements of `MaxwellSlip`, 1501 samples", Microsecond, &[1, 2, 4, 8], |count| {
        let elements = (1..=count).map(|i| (4e3 * f64::from(i), 0.15 / f64::from(count)));
        let law = MaxwellSlip::new(&elements.collect::<Vec<_>>()).expect("valid");
        run(&Exact, &starting(law, plain, 0.0, 0.101), &sampling)
    });
    print_row("`Exact`, samples of a measured force that acts throughout", Microsecond, &[1501, 15_001], |samples| {
        let force: Vec<f64> = (0..samples).map(|i| 3.0 * (0.01 * f64::from(i)).sin()).collect();
        let interval = DURATION / f64::from(samples - 1);
        let pushed = coulomb(plain).driven_by(Excitation::sampled_force(interval, force).expect("valid"));
        run(&Exact, &pushed, &velocities(DURATION, samples as usize))
    });
    print_row("`Thesis`, samples", Microsecond, &[1501, 15_001], |samples| {
        run(&Thesis::A3, &coulomb(plain), &velocities(DURATION, samples))
    });
    print_row("`Moreau`, samples", Microsecond, &[1501, 15_001], |samples| {
        run(&Moreau::default(), &coulomb(plain), &velocities(DURATION, samples))
    });
}

/// Berger's law of the thesis' Table 5.
fn berger<D: Scalar>(number: impl Fn(usize, f64) -> D, level: f64, position: f64) -> Scenario<D, Berger<D>> {
    let law = [number(0, 0.228 * level), number(1, 0.261 * level), D::from(2.852)];
    starting(Berger::at(&law).expect("valid"), number, position, 0.0)
}

fn runge_kutta_rows() {
    let engine = RungeKutta::default();
    let ring_down = velocities(1.75, 1751);
    print_row(
        "`RungeKutta`, Berger's law, tolerance",
        Microsecond,
        &["1e-6", "1e-8", "1e-10", "1e-12", "3e-14"],
        |tolerance| {
            let engine = RungeKutta::new(tolerance.parse().expect("a number")).expect("valid");
            run(&engine, &berger(plain, 1.0, 0.016), &ring_down)
        },
    );
    print_row("`RungeKutta`, samples", Microsecond, &[16, 1751, 17_501], |samples| {
        run(&engine, &berger(plain, 1.0, 0.016), &velocities(1.75, samples))
    });
    let lasting_longer = lasting(&engine, 1.75, LEVELS, |level| berger(plain, level, 0.016));
    print_row("`RungeKutta`, half swings", Microsecond, &lasting_longer, |motion| {
        run(&engine, &berger(plain, motion.level, 0.016), &velocities(1.75 / motion.level, 1751))
    });
    print_row("`RungeKutta`, derivatives of 1751 samples", Microsecond, &[0, 1, 2, 4, 8], |count| match count {
        0 => run(&engine, &berger(plain, 1.0, 0.016), &ring_down),
        1 => run(&engine, &berger(carried::<1>, 1.0, 0.016), &ring_down),
        2 => run(&engine, &berger(carried::<2>, 1.0, 0.016), &ring_down),
        4 => run(&engine, &berger(carried::<4>, 1.0, 0.016), &ring_down),
        _ => run(&engine, &berger(carried::<8>, 1.0, 0.016), &ring_down),
    });
}

/// Dahl's law.
fn dahl<D: Scalar>(
    number: impl Fn(usize, f64) -> D,
    level: f64,
    stiffness: f64,
    exponent: f64,
) -> Scenario<D, Dahl<D>> {
    let law = [number(0, level), number(1, stiffness), D::from(exponent)];
    starting(Dahl::at(&law).expect("valid"), number, 0.0, 0.101)
}

fn bristle_rows() {
    let engine = Bristle::default();
    let sampling = velocities(DURATION, 1501);
    let lasting_longer = lasting(&engine, DURATION, LEVELS, |level| dahl(plain, 0.15 * level, 1e4, 1.0));
    print_row("`Bristle`, Dahl, 1e4 1/m, half swings", Microsecond, &lasting_longer, |motion| {
        run(&engine, &dahl(plain, 0.15 * motion.level, 1e4, 1.0), &velocities(DURATION / motion.level, 1501))
    });
    print_row("`Bristle`, Dahl, stiffness (1/m)", Microsecond, &[1e3, 1e4, 1e5, 1e6], |stiffness| {
        run(&engine, &dahl(plain, 0.15, stiffness, 1.0), &sampling)
    });
    print_row("`Bristle`, Dahl, exponent", Microsecond, &[1.0, 1.3, 2.0], |exponent| {
        run(&engine, &dahl(plain, 0.15, 1e4, exponent), &sampling)
    });
    print_row("`Bristle`, LuGre, stiffness (1/m)", Microsecond, &[1e4, 1e5, 1e6], |stiffness| {
        let law = LuGre::new(0.15, 0.2, 0.01, 2.0, stiffness, 1.0, 0.02).expect("valid");
        run(&engine, &starting(law, plain, 0.0, 0.101), &sampling)
    });
    print_row("`Bristle`, Bouc-Wen, exponent", Microsecond, &[1.0, 1.5, 2.0], |exponent| {
        let bends = 0.5 * (1e4_f64 / 0.15).powf(exponent);
        let law = BoucWen::new(1e4, 1.0, bends, bends, exponent).expect("valid");
        run(&engine, &starting(law, plain, 0.0, 0.101), &sampling)
    });
    print_row("`Bristle`, elements of `Gms`", Microsecond, &[1, 2, 4, 8], |count| {
        let curve = Stribeck::new(0.15, 0.2, 0.01, 2.0, 0.02).expect("valid");
        let elements = (1..=count).map(|i| (1e4 * f64::from(i), 1.0 / f64::from(count)));
        let law = Gms::new(curve, 10.0, &elements.collect::<Vec<_>>()).expect("valid");
        run(&engine, &starting(law, plain, 0.0, 0.101), &sampling)
    });
    print_row("`Bristle`, Dahl, derivatives of 1501 samples", Microsecond, &[0, 1, 2, 4, 8], |count| match count {
        0 => run(&engine, &dahl(plain, 0.15, 1e4, 1.0), &sampling),
        1 => run(&engine, &dahl(carried::<1>, 0.15, 1e4, 1.0), &sampling),
        2 => run(&engine, &dahl(carried::<2>, 0.15, 1e4, 1.0), &sampling),
        4 => run(&engine, &dahl(carried::<4>, 0.15, 1e4, 1.0), &sampling),
        _ => run(&engine, &dahl(carried::<8>, 0.15, 1e4, 1.0), &sampling),
    });
}

pub(crate) fn print_rows() {
    exact_rows();
    runge_kutta_rows();
    bristle_rows();
}
