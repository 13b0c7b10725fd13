//! The factorisation of the solver against those of nalgebra and faer, the solver against the evaluations that it asks
//! for, and a fit of the exact motion against one of the thesis' Euler motion, in one run.
//!
//! `cargo bench --bench least_squares` prints criterion's estimates and then the ratios of their medians.

use std::cell::RefCell;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, criterion_group};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor::{qr_in_place, qr_in_place_scratch, recommended_block_size};
use faer::{Mat, Par};
use fmm_fit::{EvaluationError, Minimizer, MultiStart, Options, Outcome, Residuals};
use fmm_friction::{Coulomb, LawFamily};
use fmm_model::{Bounds, Damping, Dual, Oscillator, Parameter, Scalar};
use fmm_sim::{Channels, Engine, Exact, Sampling, Scenario, Thesis, Trajectory};

// The factorisation is no public item; the file needs nothing else of its crate.
#[path = "../crates/fmm-fit/src/solver/triangle.rs"]
#[allow(dead_code, unused_imports, reason = "only the factorisation is measured, and its tests do not run here")]
mod triangle;

use triangle::Triangle;

/// Columns of derivatives and one of residuals, as a decaying oscillation has them.
fn columns(rows: usize, parameters: usize) -> Vec<f64> {
    let element = |j: usize, i: usize| {
        let t = i as f64 / rows as f64;
        (-t).exp() * (40.0 * t * (1.0 + 0.1 * j as f64) + j as f64).sin() + 0.1 * t.powf(j as f64)
    };
    (0..=parameters).flat_map(|j| (0..rows).map(move |i| element(j, i))).collect()
}

/// faer's factorisation, in a thread of its own: its wide registers are left in a state that slows down all plain code
/// which a thread runs after it.
fn faer_qr(columns: &[f64], rows: usize, repetitions: u64) -> Duration {
    let width = columns.len() / rows;
    let run = || {
        let mut matrix = Mat::<f64>::zeros(rows, width);
        let size = recommended_block_size::<f64>(rows, width);
        let mut coefficients = Mat::<f64>::zeros(size, width);
        let scratch = qr_in_place_scratch::<f64>(rows, width, size, Par::Seq, faer::prelude::default());
        let mut memory = MemBuffer::new(scratch);
        let began = Instant::now();
        for _ in 0..repetitions {
            for (j, column) in black_box(columns).chunks_exact(rows).enumerate() {
                matrix.col_as_slice_mut(j).copy_from_slice(column);
            }
            let stack = MemStack::new(&mut memory);
            qr_in_place(matrix.as_mut(), coefficients.as_mut(), Par::Seq, stack, faer::prelude::default());
            black_box(&matrix);
        }
        began.elapsed()
    };
    std::thread::scope(|scope| scope.spawn(run).join()).expect("nothing in it panics")
}

const SHAPES: [(usize, usize); 4] = [(1500, 3), (1500, 6), (45_000, 3), (45_000, 6)];

fn factorisation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("factor");
    group.sample_size(20);
    for (rows, parameters) in SHAPES {
        let label = format!("{rows}x{parameters}");
        let columns = columns(rows, parameters);
        let (jacobian, residuals) = columns.split_at(rows * parameters);
        let all: Vec<usize> = (0..parameters).collect();
        let (mut triangle, mut block) = (Triangle::default(), Vec::new());
        group.bench_function(BenchmarkId::new("own", &label), |bencher| {
            bencher.iter(|| triangle.factor(black_box(jacobian), &all, residuals, &mut block));
        });
        group.bench_function(BenchmarkId::new("nalgebra", &label), |bencher| {
            bencher.iter(|| nalgebra::DMatrix::from_column_slice(rows, parameters + 1, black_box(&columns)).qr());
        });
        group.bench_function(BenchmarkId::new("faer", &label), |bencher| {
            bencher.iter_custom(|repetitions| faer_qr(&columns, rows, repetitions));
        });
    }
    group.finish();
}

/// Five records of 45 000 samples, two shared parameters and two of each record.
fn joint(criterion: &mut Criterion) {
    const RECORDS: usize = 5;
    const ROWS: usize = 45_000;
    let mut group = criterion.benchmark_group("joint");
    group.sample_size(10);
    let record = columns(ROWS, 4);
    let (jacobian, residuals) = record.split_at(4 * ROWS);
    // Shared parameters first, then those of each record.
    let total = RECORDS * ROWS;
    let mut dense = vec![0.0; 13 * total];
    for number in 0..RECORDS {
        for (column, place) in [0, 1, 2 + 2 * number, 3 + 2 * number, 12].into_iter().enumerate() {
            dense[place * total + number * ROWS..][..ROWS].copy_from_slice(&record[column * ROWS..][..ROWS]);
        }
    }
    let (whole, right) = dense.split_at(12 * total);
    let all: Vec<usize> = (0..12).collect();
    let (mut triangle, mut small, mut block) = (Triangle::default(), Triangle::default(), Vec::new());
    group.bench_function("blocks", |bencher| {
        bencher.iter(|| {
            triangle.reset(12);
            for number in 0..RECORDS {
                small.factor(black_box(jacobian), &all[..4], residuals, &mut block);
                triangle.merge(&small, &[0, 1, 2 + 2 * number, 3 + 2 * number], &mut block);
            }
        });
    });
    group.bench_function("own", |bencher| {
        bencher.iter(|| triangle.factor(black_box(whole), &all, right, &mut block));
    });
    group.bench_function("nalgebra", |bencher| {
        bencher.iter(|| nalgebra::DMatrix::from_column_slice(total, 13, black_box(&dense)).qr());
    });
    group.bench_function("faer", |bencher| {
        bencher.iter_custom(|repetitions| faer_qr(&dense, total, repetitions));
    });
    group.finish();
}

/// Friction coefficient, position and velocity of a ring-down of 1501 velocities at 1 kHz, the workload of the thesis.
struct RingDown {
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

impl RingDown {
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

impl Residuals for RingDown {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.data.len()
    }
    fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        let mut trajectory = self.plain.borrow_mut();
        Exact.run_into(&scenario(&[p[0], p[1], p[2]])?, &self.sampling, &mut trajectory)?;
        for ((r, model), data) in residuals.iter_mut().zip(trajectory.velocity().values()).zip(&self.data) {
            *r = model - data;
        }
        Ok(())
    }
    fn jacobian(&self, p: &[f64], jacobian: &mut [f64]) -> Result<bool, EvaluationError> {
        let mut trajectory = self.carrying.borrow_mut();
        let variables = [0, 1, 2].map(|j| Dual::variable(p[j], j));
        Exact.run_into(&scenario(&variables)?, &self.sampling, &mut trajectory)?;
        for (j, column) in jacobian.chunks_exact_mut(self.data.len()).enumerate() {
            column.copy_from_slice(trajectory.velocity().partial(j).expect("three directions are carried"));
        }
        Ok(true)
    }
}

/// What a fit asked of its problem: the values, and whether for derivatives.
struct Recorded<'a> {
    problem: &'a RingDown,
    calls: RefCell<Vec<(Vec<f64>, bool)>>,
}

impl Residuals for Recorded<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }
    fn len(&self) -> usize {
        self.problem.len()
    }
    fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        self.calls.borrow_mut().push((p.to_vec(), false));
        self.problem.residuals(p, residuals)
    }
    fn jacobian(&self, p: &[f64], jacobian: &mut [f64]) -> Result<bool, EvaluationError> {
        self.calls.borrow_mut().push((p.to_vec(), true));
        self.problem.jacobian(p, jacobian)
    }
}

fn solver(criterion: &mut Criterion) {
    let problem = RingDown::new();
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
                if *is_jacobian {
                    problem.jacobian(p, &mut jacobian).expect("valid before");
                } else {
                    problem.residuals(p, &mut residuals).expect("valid before");
                }
            }
        });
    });
    group.finish();
}

/// Workload W3: friction coefficient and position of a noise-free ring-down of 1501 velocities. The exact engine gives its
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

/// What the data of workload W3 were made with: μ (1), x₀ (m).
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
    fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        let mut trajectory = self.plain.borrow_mut();
        self.engine.run_into(&scenario(&[p[0], p[1], VELOCITY])?, &self.sampling, &mut trajectory)?;
        for ((r, model), data) in residuals.iter_mut().zip(trajectory.velocity().values()).zip(&self.data) {
            *r = model - data;
        }
        Ok(())
    }
    fn residuals_and_jacobian(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<bool, EvaluationError> {
        if !self.is_exact {
            self.residuals(p, residuals)?;
            return Ok(false);
        }
        let mut trajectory = self.carrying.borrow_mut();
        let variables = [Dual::variable(p[0], 0), Dual::variable(p[1], 1), Dual::from(VELOCITY)];
        Exact.run_into(&scenario(&variables)?, &self.sampling, &mut trajectory)?;
        let velocity = trajectory.velocity();
        for ((r, model), data) in residuals.iter_mut().zip(velocity.values()).zip(&self.data) {
            *r = model - data;
        }
        for (j, column) in jacobian.chunks_exact_mut(self.data.len()).enumerate() {
            column.copy_from_slice(velocity.partial(j).expect("two directions are carried"));
        }
        Ok(true)
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
    let search = MultiStart::default().with_starts(1).with_kicks(2, 16).with_reach(vec![1e-3, 1e-3]);
    let minima = search.solve(&euler, &START).expect("valid");
    if let Some(best) = minima.best() {
        print_error(&format!("  the best of {} Euler fits", minima.starts()), best.values(), best.outcome());
    }

    let own = Repeated::new(Thesis::A3, false, &Thesis::A3);
    let outcome = minimizer.minimize(&own, &START).expect("valid");
    print_error("Euler fit of an Euler motion", minimizer.values(), outcome);
    group.bench_function("euler_of_euler", |bencher| bencher.iter(|| minimizer.minimize(&own, black_box(&START))));
    group.finish();
}

/// Criterion's median of a benchmark of this run (ns), if it was measured.
fn median(benchmark: &str) -> Option<f64> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| Path::new("target").to_owned(), Into::into);
    let path = target.join("criterion").join(benchmark).join("new").join("estimates.json");
    let estimates: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
    estimates["median"]["point_estimate"].as_f64()
}

/// Prints how many times as long one benchmark takes as another, beside what is wanted.
fn print_ratio(slow: &str, fast: &str, wanted: &str) {
    if let (Some(slow_time), Some(fast_time)) = (median(slow), median(fast)) {
        let wanted = if wanted.is_empty() { String::new() } else { format!(" (wanted: {wanted})") };
        println!("{slow} / {fast} = {:.2}{wanted}", slow_time / fast_time);
    }
}

fn print_ratios() {
    for (rows, parameters) in SHAPES {
        let of = |method: &str| format!("factor/{method}/{rows}x{parameters}");
        print_ratio(&of("nalgebra"), &of("own"), "at least 1");
        print_ratio(&of("faer"), &of("own"), "at least 1");
    }
    print_ratio("joint/own", "joint/blocks", "at least 3, the ratio of stored elements");
    print_ratio("joint/nalgebra", "joint/own", "");
    print_ratio("joint/faer", "joint/own", "");
    print_ratio("joint/faer", "joint/blocks", "");
    print_ratio("solver/fit", "solver/evaluations", "at most 1.2");
    print_ratio("thesis_fit/euler", "thesis_fit/exact", "at least 50");
    print_ratio("thesis_fit/euler_of_euler", "thesis_fit/exact", "");
}

criterion_group!(benches, factorisation, joint, solver, thesis_fit);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    print_ratios();
}
