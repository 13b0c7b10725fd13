//! Eigenvalues of the companion matrices behind a stabilisation diagram, and the Cholesky factor of its normal
//! equations, by faer beside nalgebra in one run. `fmm-frf` takes nalgebra, which is in a build anyway.

#[path = "../../common/ratio.rs"]
mod ratio;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group};
use faer::{Mat, Side, c64};
use ratio::print_ratio;

/// Orders of a diagram: one reference, two, and four.
const ORDERS: [usize; 3] = [40, 80, 160];

/// The companion of a polynomial whose zeros lie about the unit circle.
fn companion(order: usize) -> Mat<c64> {
    let coefficient = |j: usize| c64::new((1.0 + j as f64).sin(), (2.0 + 3.0 * j as f64).cos()) * 0.3;
    Mat::from_fn(order, order, |row, column| match row {
        0 => coefficient(column),
        row if row == column + 1 => c64::new(1.0, 0.0),
        _ => c64::new(0.0, 0.0),
    })
}

/// A Hermitian matrix that is definite.
fn definite(order: usize) -> Mat<c64> {
    let factor = companion(order);
    &factor * factor.adjoint() + Mat::<c64>::identity(order, order)
}

fn of(matrix: &Mat<c64>) -> nalgebra::DMatrix<c64> {
    nalgebra::DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |row, column| matrix[(row, column)])
}

fn eigenvalues(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("eigenvalues");
    group.sample_size(10);
    for order in ORDERS {
        let faer = companion(order);
        let nalgebra = of(&faer);
        group.bench_function(BenchmarkId::new("faer", order), |bencher| {
            bencher.iter(|| black_box(&faer).eigenvalues().expect("it converges"));
        });
        group.bench_function(BenchmarkId::new("nalgebra", order), |bencher| {
            bencher.iter(|| black_box(&nalgebra).clone().schur().eigenvalues());
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("cholesky");
    group.sample_size(10);
    for order in ORDERS {
        let faer = definite(order);
        let nalgebra = of(&faer);
        group.bench_function(BenchmarkId::new("faer", order), |bencher| {
            bencher.iter(|| black_box(&faer).llt(Side::Lower).expect("it is definite"));
        });
        group.bench_function(BenchmarkId::new("nalgebra", order), |bencher| {
            bencher.iter(|| black_box(&nalgebra).clone().cholesky().expect("it is definite"));
        });
    }
    group.finish();
}

criterion_group!(benches, eigenvalues);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    for order in ORDERS {
        print_ratio(&format!("eigenvalues/nalgebra/{order}"), &format!("eigenvalues/faer/{order}"), 1.0..);
        print_ratio(&format!("cholesky/nalgebra/{order}"), &format!("cholesky/faer/{order}"), ..);
    }
}
