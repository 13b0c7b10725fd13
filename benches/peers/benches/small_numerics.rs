//! Small pieces of general numerics against the crates that offer the same, in one run.
//!
//! `cargo bench --manifest-path benches/peers/Cargo.toml --bench small_numerics` prints criterion's estimates and then
//! the ratios of their medians: variates of rand_distr, decompositions of nalgebra.

#[path = "../../common/ratio.rs"]
mod ratio;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group};
use nalgebra::{Complex, DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};
use ratio::print_ratio;

// What is measured is no public item; these files need nothing else of their crates.
#[path = "../../../crates/fmm-fit/src/algebra"]
#[allow(dead_code, unused_imports, reason = "only parts are measured, and their tests do not run here")]
mod algebra {
    pub(crate) mod definite;
    pub(crate) mod spectrum;
    pub(crate) mod sums;
    pub(crate) mod triangle;
}
#[path = "../../../crates/fmm-sim/src/bristle/lu.rs"]
#[allow(dead_code, unused_imports, reason = "only parts are measured, and their tests do not run here")]
mod lu;
#[path = "../../../crates/fmm-uq/src/distributions"]
#[allow(dead_code, unused_imports, reason = "only parts are measured, and their tests do not run here")]
mod distributions {
    pub(crate) mod ziggurat;
}
#[path = "../../../crates/fmm-uq/src/stream.rs"]
#[allow(dead_code, unused_imports, reason = "only parts are measured, and their tests do not run here")]
mod stream;

use algebra::definite;
use algebra::spectrum::Spectrum;
use algebra::triangle::Triangle;
use distributions::ziggurat::Ziggurat;

const VALUES: usize = 10_000;

fn variates(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("variates");
    let mut values = vec![0.0; VALUES];
    for (label, nu) in [("normal", f64::INFINITY), ("t5", 5.0)] {
        let own = if nu.is_finite() { Ziggurat::student_t(nu).expect("few degrees") } else { Ziggurat::normal() };
        group.bench_function(BenchmarkId::new("own", label), |bencher| {
            let mut rng = ChaCha8Rng::seed_from_u64(0);
            bencher.iter(|| own.fill(&mut rng, (0.0, 1.0), black_box(&mut values), 1));
        });
        group.bench_function(BenchmarkId::new("rand_distr", label), |bencher| {
            let mut rng = ChaCha8Rng::seed_from_u64(0);
            let student = StudentT::new(nu.min(1e6)).expect("positive");
            bencher.iter(|| {
                for value in black_box(&mut values) {
                    *value = if nu.is_finite() { student.sample(&mut rng) } else { StandardNormal.sample(&mut rng) };
                }
            });
        });
    }
    group.finish();
}

/// An element of a well-conditioned matrix.
fn element(i: usize, j: usize) -> f64 {
    let plain = ((7 * i + 13 * j) % 11) as f64 / 11.0 - 0.5;
    if i == j { 3.0 + plain } else { plain }
}

const ORDERS: [usize; 3] = [3, 6, 12];

fn singular_values(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("singular_values");
    for order in ORDERS {
        let mut triangle = Triangle::default();
        triangle.reset(order);
        let mut block: Vec<f64> = (0..=order).flat_map(|j| (0..order).map(move |i| element(i, j))).collect();
        triangle.fold(&mut block);
        group.bench_function(BenchmarkId::new("own", order), |bencher| {
            bencher.iter(|| Spectrum::of(black_box(&triangle)));
        });
        let matrix = DMatrix::from_fn(order, order, |i, j| if i > j { 0.0 } else { triangle.r(i, j) });
        group.bench_function(BenchmarkId::new("nalgebra", order), |bencher| {
            bencher.iter(|| black_box(&matrix).clone().svd(true, true));
        });
    }
    group.finish();
}

fn systems(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("cholesky");
    for order in ORDERS {
        let square = |i: usize, j: usize| (0..order).map(|k| element(i, k) * element(j, k)).sum::<f64>();
        let matrix = DMatrix::from_fn(order, order, square);
        let right = DVector::from_fn(order, |i, _| element(i, 1));
        group.bench_function(BenchmarkId::new("own", order), |bencher| {
            let mut factored = vec![0.0; order * order];
            let mut solution = vec![0.0; order];
            bencher.iter(|| {
                factored.copy_from_slice(black_box(matrix.as_slice()));
                solution.copy_from_slice(right.as_slice());
                assert!(definite::factor(&mut factored, order, |_| 0.0));
                definite::solve(&factored, &mut solution);
            });
        });
        group.bench_function(BenchmarkId::new("nalgebra", order), |bencher| {
            bencher.iter(|| black_box(&matrix).clone().cholesky().expect("definite").solve(&right));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("lu");
    for order in ORDERS {
        // Complex systems that differ on their diagonals.
        let entry = |system: usize, i: usize, j: usize| {
            let diagonal = if i == j { system as f64 } else { 0.0 };
            Complex::new(element(i, j) + diagonal, diagonal)
        };
        let matrices: [DMatrix<Complex<f64>>; lu::SYSTEMS] =
            std::array::from_fn(|system| DMatrix::from_fn(order, order, |i, j| entry(system, i, j)));
        let right = DVector::from_fn(order, |i, _| Complex::new(element(i, 1), 0.0));
        let part = |values: [Complex<f64>; lu::SYSTEMS]| {
            std::array::from_fn(|i| if i < lu::SYSTEMS { values[i].re } else { values[i - lu::SYSTEMS].im })
        };
        group.bench_function(BenchmarkId::new("own", order), |bencher| {
            let mut factors = lu::Factors::default();
            let entries: Vec<lu::Complex<f64>> = (0..order * order)
                .map(|index| part(std::array::from_fn(|system| matrices[system][(index / order, index % order)])))
                .collect();
            let rights: Vec<lu::Complex<f64>> = right.iter().map(|right| part([*right; lu::SYSTEMS])).collect();
            let mut solution = rights.clone();
            bencher.iter(|| {
                factors.matrix(order).copy_from_slice(black_box(&entries));
                solution.copy_from_slice(&rights);
                assert!(factors.factor());
                factors.solve(&mut solution);
            });
        });
        group.bench_function(BenchmarkId::new("nalgebra", order), |bencher| {
            bencher.iter(|| black_box(&matrices).each_ref().map(|matrix| matrix.clone().lu().solve(&right)));
        });
    }
    group.finish();
}

fn print_ratios() {
    for label in ["normal", "t5"] {
        print_ratio(&format!("variates/rand_distr/{label}"), &format!("variates/own/{label}"), 1.0..);
    }
    for group in ["singular_values", "cholesky", "lu"] {
        for order in ORDERS {
            print_ratio(&format!("{group}/nalgebra/{order}"), &format!("{group}/own/{order}"), ..);
        }
    }
}

criterion_group!(benches, variates, singular_values, systems);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    print_ratios();
}
