//! The same motion by FMM and by diffsol, whose root function finds the stops and whose reset decides what follows.

use diffsol::{DenseMatrix, MatrixCommon, NalgebraMat, OdeBuilder, OdeSolverMethod};
use fmm_friction::{Berger, Coulomb};
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Channels, Sampling, Scenario};

/// Mass (kg), stiffness (N/m), linear (N s/m) and quadratic damping (N s²/m²), normal load (N) and the three parameters
/// of the Berger law of the thesis' Table 5, released from 16 mm.
pub const BERGER: [f64; 8] = [10.391, 1982.0, 0.2005, 0.437, 14.0, 0.228, 0.261, 2.852];

/// The same machine with Coulomb friction and linear damping alone.
pub const COULOMB: [f64; 8] = [10.391, 1982.0, 0.2005, 0.0, 14.0, 0.228, 0.0, 0.0];

/// Where it is released (m).
pub const RELEASE: f64 = 0.016;

/// Interval (s) and number of the samples.
pub const SAMPLES: (f64, usize) = (1e-3, 1751);

/// The motion of [`BERGER`] for an engine of FMM.
pub fn berger() -> Scenario<f64, Berger> {
    let [.., mu0, mu1, alpha] = BERGER;
    scenario(BERGER, Berger::new(mu0, mu1, alpha).expect("valid"))
}

/// The motion of [`COULOMB`] for an engine of FMM.
pub fn coulomb() -> Scenario<f64, Coulomb> {
    let [.., mu, _, _] = COULOMB;
    scenario(COULOMB, Coulomb::new(mu).expect("valid"))
}

/// The times of the samples, and what of them.
pub fn sampling() -> Sampling {
    Sampling::uniform(SAMPLES.0, SAMPLES.1).expect("valid").keeping(Channels::Velocity)
}

fn scenario<L>([mass, stiffness, linear, quadratic, load, ..]: [f64; 8], law: L) -> Scenario<f64, L> {
    let damping = Damping::new(linear, quadratic).expect("valid");
    let machine = Oscillator::new(mass, stiffness).expect("valid").with_damping(damping);
    Scenario::new(machine, law, load).and_then(|case| case.starting_at(RELEASE, 0.0)).expect("valid")
}

/// The sampled velocity (m/s) of a `case` by diffsol's explicit method of order 5 at a relative `tolerance`.
///
/// The third state is the direction of sliding, 0 at rest: the friction force is smooth from root to root.
pub fn by_diffsol(case: [f64; 8], tolerance: f64, velocity: &mut Vec<f64>) {
    let [mass, stiffness, linear, quadratic, load, mu0, mu1, alpha] = case;
    let held = load * (mu0 + mu1);
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(tolerance)
        .atol([tolerance * 1e-2, tolerance * 1e-1, 1.0])
        .rhs(move |y, _, _, rate| {
            let (x, v, s) = (y[0], y[1], y[2]);
            let speed = v * s;
            let friction = s * load * (mu0 + mu1 * (-alpha * speed).exp());
            let force = -friction - (linear + quadratic * speed) * v - stiffness * x;
            rate[0] = v * s.abs();
            rate[1] = force / mass * s.abs();
            rate[2] = 0.0;
        })
        .init(|_, _, y| y.copy_from_slice(&[RELEASE, 0.0, -1.0]), 3)
        .root(|y, _, _, root| root[0] = if y[2] == 0.0 { 1.0 } else { y[1] }, 1)
        .reset(move |y, _, _, after| {
            let spring = -stiffness * y[0];
            after.copy_from_slice(&[y[0], 0.0, if spring.abs() > held { spring.signum() } else { 0.0 }]);
        })
        .build()
        .expect("a valid problem");
    let times: Vec<f64> = (0..SAMPLES.1).map(|i| i as f64 * SAMPLES.0).collect();
    let mut solver = problem.tsit45().expect("a solver");
    let (states, _) = solver.solve_dense(&times).expect("a solution");
    velocity.clear();
    velocity.extend((0..states.ncols()).map(|i| states.get_index(1, i)));
}
