//! The solver against the evaluations that it asks for, and a fit of the exact motion against one of the thesis' Euler
//! motion, in one run.
//!
//! `cargo bench --bench least_squares` prints criterion's estimates and then the ratios of their medians. The package
//! `peers` beside this file compares the factorisation with nalgebra and faer.

#[path = "common/ratio.rs"]
mod ratio;

use std::cell::RefCell;
use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, criterion_group};
use fmm_fit::{Derivatives, EvaluationError, Minimizer, Options, Outcome, Refit, Residuals, solve};
use fmm_friction::{Berger, Coulomb, LawFamily};
use fmm_identify::Problem;
use fmm_model::{Bounds, Damping, Dual, Oscillator, Parameter, Scalar};
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Engine, Exact, RungeKutta, Sampling, Scenario, Thesis, Trajectory};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use ratio::{median, print_ratio, print_row};

/// Friction coefficient, position and velocity of a ring-down of 1501 velocities at 1 kHz, the workload of the thesis.
struct Experiment {
    parameters: [Parameter; 3],
    sampling: Sampling,
    data: Vec<f64>,
    plain: RefCell<Trajectory>,
    carrying: RefCell<Trajectory<Dual<3>>>,
}

fn scenario<D: Scalar>(p: &[D; 3]) -> Result<Scenario<D, Coulomb<D>>, EvaluationError> {
    let number = |value: f64| D::from(value);
    let damping = Damping::linear(number(0.275))?;
    let machine = Oscillator::new(number(10.391), number(1982.0))?.with_damping(damping);
    Ok(Scenario::new(machine, Coulomb::at(&[p[0]])?, number(7.2))?.starting_at(p[1], p[2])?)
}

impl Experiment {
    fn new() -> Self {
        let sampling = Sampling::uniform(1e-3, 1501).expect("valid").keeping(Channels::Velocity);
        let motion = Exact.run(&scenario(&[0.15, 0.0, 0.101]).expect("valid"), &sampling).expect("valid");
        // Noise of 0.3 mm/s rms, deterministic.
        let noise = |i: usize| 1e-3 * (((i * 7919) % 1009) as f64 / 1009.0 - 0.5);
        let data = motion.velocity().values().iter().enumerate().map(|(i, v)| v + noise(i)).collect();
        let friction = Parameter::new("friction_coefficient", "μ", "1").bounded(Bounds::NOT_NEGATIVE);
        let parameters = [friction, Parameter::new("position", "x₀", "m"), Parameter::new("velocity", "v₀", "m/s")];
        Self { parameters, sampling, data, plain: RefCell::default(), carrying: RefCell::default() }
    }
}

/// Model less data.
fn write_differences(model: &[f64], data: &[f64], residuals: &mut [f64]) {
    for ((r, model), data) in residuals.iter_mut().zip(model).zip(data) {
        *r = model - data;
    }
}

impl Residuals for Experiment {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.data.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let data = &self.data;
        let Some(jacobian) = jacobian else {
            let mut trajectory = self.plain.borrow_mut();
            Exact.run_into(&scenario(&[p[0], p[1], p[2]])?, &self.sampling, &mut trajectory)?;
            write_differences(trajectory.velocity().values(), data, residuals);
            return Ok(());
        };
        let mut trajectory = self.carrying.borrow_mut();
        let variables = [0, 1, 2].map(|j| Dual::variable(p[j], j));
        Exact.run_into(&scenario(&variables)?, &self.sampling, &mut trajectory)?;
        write_differences(trajectory.velocity().values(), data, residuals);
        for (j, column) in jacobian.chunks_exact_mut(data.len()).enumerate() {
            column.copy_from_slice(trajectory.velocity().partial(j).expect("three directions are carried"));
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

/// Record of what a fit asked of its problem: the values, and whether for derivatives.
struct Recorded<'a> {
    problem: &'a Experiment,
    calls: RefCell<Vec<(Vec<f64>, bool)>>,
}

impl Residuals for Recorded<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }
    fn len(&self) -> usize {
        self.problem.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        self.calls.borrow_mut().push((p.to_vec(), jacobian.is_some()));
        self.problem.evaluate(p, residuals, jacobian)
    }
    fn derivatives(&self) -> Derivatives {
        self.problem.derivatives()
    }
}

fn solver(criterion: &mut Criterion) {
    let problem = Experiment::new();
    let start = [0.3, 1e-3, 0.09];
    let mut minimizer = Minimizer::new(Options::default());
    let recorded = Recorded { problem: &problem, calls: RefCell::default() };
    assert!(minimizer.minimize(&recorded, &start).expect("valid").is_success());
    let error = (minimizer.values()[0] - 0.15).abs();
    assert!(error < 1e-3, "the fit is {error} off");
    let calls = recorded.calls.into_inner();

    let mut group = criterion.benchmark_group("solver");
    group.bench_function("fit", |bencher| bencher.iter(|| minimizer.minimize(&problem, black_box(&start))));
    let (mut residuals, mut jacobian) = (vec![0.0; problem.len()], vec![0.0; 3 * problem.len()]);
    group.bench_function("evaluations", |bencher| {
        bencher.iter(|| {
            for (p, is_jacobian) in black_box(&calls) {
                let jacobian = is_jacobian.then_some(jacobian.as_mut_slice());
                problem.evaluate(p, &mut residuals, jacobian).expect("valid before");
            }
        });
    });
    group.finish();
}

/// Friction coefficient and position of a noise-free ring-down of 1501 velocities. The exact engine gives its
/// gradient, the thesis' Euler engine leaves it to differences.
struct Repeated<E> {
    engine: E,
    is_exact: bool,
    parameters: [Parameter; 2],
    sampling: Sampling,
    data: Vec<f64>,
    plain: RefCell<Trajectory>,
    carrying: RefCell<Trajectory<Dual<2>>>,
}

/// Values with which the data of that fit were made: μ (1), x₀ (m).
const TRUTH: [f64; 2] = [0.15, 0.0];
/// Where the thesis begins: μ (1), x₀ (m).
const START: [f64; 2] = [0.15, 1e-4];
/// The initial velocity (m/s).
const VELOCITY: f64 = 0.101;

impl<E: Engine<f64, Coulomb>> Repeated<E> {
    /// The motion that `truth` makes, to be fitted by `engine`.
    fn new(engine: E, is_exact: bool, truth: &impl Engine<f64, Coulomb>) -> Self {
        let sampling = Sampling::uniform(1e-3, 1501).expect("valid").keeping(Channels::Velocity);
        let motion = truth.run(&scenario(&[TRUTH[0], TRUTH[1], VELOCITY]).expect("valid"), &sampling).expect("valid");
        let data = motion.velocity().values().to_vec();
        let within = |lower, upper| Bounds::new(lower, upper).expect("valid");
        let parameters = [
            Parameter::new("friction_coefficient", "μ", "1").bounded(within(0.1, 1.0)),
            Parameter::new("position", "x₀", "m").bounded(within(-3e-3, 3e-3)),
        ];
        let (plain, carrying) = (RefCell::default(), RefCell::default());
        Self { engine, is_exact, parameters, sampling, data, plain, carrying }
    }
}

impl<E: Engine<f64, Coulomb>> Residuals for Repeated<E> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.data.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let Some(jacobian) = jacobian else {
            let mut trajectory = self.plain.borrow_mut();
            self.engine.run_into(&scenario(&[p[0], p[1], VELOCITY])?, &self.sampling, &mut trajectory)?;
            write_differences(trajectory.velocity().values(), &self.data, residuals);
            return Ok(());
        };
        let mut trajectory = self.carrying.borrow_mut();
        let variables = [Dual::variable(p[0], 0), Dual::variable(p[1], 1), Dual::from(VELOCITY)];
        Exact.run_into(&scenario(&variables)?, &self.sampling, &mut trajectory)?;
        let velocity = trajectory.velocity();
        write_differences(velocity.values(), &self.data, residuals);
        for (j, column) in jacobian.chunks_exact_mut(self.data.len()).enumerate() {
            column.copy_from_slice(velocity.partial(j).expect("two directions are carried"));
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        if self.is_exact { Derivatives::Free } else { Derivatives::None }
    }
    fn is_cheaper_combined(&self) -> bool {
        self.is_exact
    }
}

/// Prints how far from the truth a fit is.
fn print_error(name: &str, values: &[f64], outcome: Outcome) {
    let errors = [values[0] - TRUTH[0], values[1] - TRUTH[1]];
    println!("{name}: off by {:.1e} in μ and {:.1e} m in x₀; {outcome}", errors[0], errors[1]);
}

fn thesis_fit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("thesis_fit");
    let exact = Repeated::new(Exact, true, &Exact);
    let mut minimizer = Minimizer::new(Options::default());
    let outcome = minimizer.minimize(&exact, &START).expect("valid");
    print_error("exact fit", minimizer.values(), outcome);
    assert!((minimizer.values()[0] - TRUTH[0]).abs() < 1e-12, "the exact fit misses the minimum");
    group.bench_function("exact", |bencher| bencher.iter(|| minimizer.minimize(&exact, black_box(&START))));

    group.sample_size(20);
    let euler = Repeated::new(Thesis::A3, false, &Exact);
    let outcome = minimizer.minimize(&euler, &START).expect("valid");
    print_error("Euler fit of the same motion", minimizer.values(), outcome);
    group.bench_function("euler", |bencher| bencher.iter(|| minimizer.minimize(&euler, black_box(&START))));

    let own = Repeated::new(Thesis::A3, false, &Thesis::A3);
    let outcome = minimizer.minimize(&own, &START).expect("valid");
    print_error("Euler fit of an Euler motion", minimizer.values(), outcome);
    group.bench_function("euler_of_euler", |bencher| bencher.iter(|| minimizer.minimize(&own, black_box(&START))));
    group.finish();
}

/// Fits of `problem` on other machines, as a Monte Carlo calculation repeats them.
fn repeat(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, problem: &Problem<'_>) {
    let fit = solve(problem, problem.values(), &Options::default()).expect("valid");
    let varying = [("mass", 10.391, 0.0049), ("stiffness", 1982.0, 1.3), ("damping", 0.275, 0.0341)];
    let refit = Refit::prepare(problem, &fit).expect("a minimum");
    let refit = refit.varying(&varying.map(|(name, ..)| name)).expect("held in the fit");
    let refit = refit.expecting(&varying.map(|(.., u)| u)).expect("near the prepared fit");
    let mut generator = ChaCha8Rng::seed_from_u64(4);
    let mut drawn = |value: f64, u: f64| value + u * Distribution::<f64>::sample(&StandardNormal, &mut generator);
    let mut machine = || varying.map(|(_, value, u)| drawn(value, u)).to_vec();
    let machines: Vec<Vec<f64>> = (0..256).map(|_| machine()).collect();
    let mut next = machines.iter().cycle();
    group.bench_function(name, |bencher| {
        bencher.iter(|| refit.estimates(black_box(next.next().expect("endless"))).expect("near the prepared fit"));
    });
}

/// The same fit on other machines; and one of the Berger law's three parameters and a
/// position, simulated to 1e-9.
fn refits(criterion: &mut Criterion) {
    let sampling = Sampling::uniform(1e-3, 1501).expect("valid").keeping(Channels::Velocity);
    let start = scenario(&[TRUTH[0], TRUTH[1], VELOCITY]).expect("valid");
    let mut trajectory = Trajectory::default();
    let mut group = criterion.benchmark_group("refit");
    group.bench_function("simulation", |bencher| {
        bencher.iter(|| Exact.run_into(black_box(&start), &sampling, &mut trajectory));
    });
    let record = |motion: &Trajectory| {
        Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s").expect("valid")
    };
    let motion = Exact.run(&start, &sampling).expect("valid");
    let machine = [("mass", 10.391), ("stiffness", 1982.0), ("damping", 0.275), ("normal_load", 7.2)];
    let unknown = [("coefficient", START[0]), ("initial_position", START[1]), ("initial_velocity", VELOCITY)];
    let problem =
        Problem::declared::<Coulomb>(&record(&motion), &[machine.as_slice(), &unknown].concat()).expect("valid");
    let problem = problem.free("coefficient").and_then(|problem| problem.free("initial_position")).expect("valid");
    repeat(&mut group, "exact", &problem);

    let law = [0.228, 0.261, 2.852];
    let oscillator = Oscillator::new(10.391, 1982.0).expect("valid");
    let oscillator = oscillator.with_damping(Damping::linear(0.275).expect("valid"));
    let released = Scenario::new(oscillator, Berger::at(&law).expect("valid"), 14.0).expect("valid");
    let released = released.starting_at(0.016, 0.0).expect("valid");
    let motion = RungeKutta::default().run(&released, &sampling).expect("valid");
    let machine = [("mass", 10.391), ("stiffness", 1982.0), ("damping", 0.275), ("normal_load", 14.0)];
    let names = Berger::<f64>::PARAMETERS.iter().map(|parameter| parameter.parameter().name());
    let mut values: Vec<(&str, f64)> = names.clone().zip(law).collect();
    values.extend(machine);
    values.push(("initial_position", 0.016));
    let mut problem = Problem::declared::<Berger>(&record(&motion), &values).expect("valid");
    for name in names.chain(["initial_position"]) {
        problem = problem.free(name).expect("a parameter");
    }
    repeat(&mut group, "berger", &problem.with_tolerance(1e-9).expect("a tolerance"));
    group.finish();
}

fn print_ratios() {
    print_ratio("solver/fit", "solver/evaluations", ..=1.2);
    print_ratio("thesis_fit/euler", "thesis_fit/exact", 50.0..);
    print_ratio("thesis_fit/euler_of_euler", "thesis_fit/exact", ..);
    print_ratio("refit/exact", "refit/simulation", ..=5.0);
    if let Some(nanoseconds) = median("refit/berger") {
        print_row("fits of the Berger law a second", 1e9 / nanoseconds, 5000.0..);
    }
}

criterion_group!(benches, solver, thesis_fit, refits);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    print_ratios();
}
