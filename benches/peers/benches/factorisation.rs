//! The factorisation of the least-squares solver against those of nalgebra and faer, in one run.
//!
//! `cargo bench --manifest-path benches/peers/Cargo.toml --bench factorisation` prints criterion's estimates and then
//! the ratios of their medians.

#[path = "../../common/ratio.rs"]
mod ratio;

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, criterion_group};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor::{qr_in_place, qr_in_place_scratch, recommended_block_size};
use faer::{Mat, Par};
use ratio::print_ratio;

// The factorisation is no public item; its files need nothing else of their crate.
#[path = "../../../crates/fmm-fit/src/algebra"]
#[allow(dead_code, unused_imports, reason = "only the factorisation is measured, and its tests do not run here")]
mod algebra {
    pub(crate) mod sums;
    pub(crate) mod triangle;
}

use algebra::triangle::Triangle;

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

fn print_ratios() {
    for (rows, parameters) in SHAPES {
        let of = |method: &str| format!("factor/{method}/{rows}x{parameters}");
        print_ratio(&of("nalgebra"), &of("own"), 1.0..);
        print_ratio(&of("faer"), &of("own"), 1.0..);
    }
    // Three is the ratio of stored elements.
    print_ratio("joint/own", "joint/blocks", 3.0..);
    print_ratio("joint/nalgebra", "joint/own", ..);
    print_ratio("joint/faer", "joint/own", ..);
    print_ratio("joint/faer", "joint/blocks", ..);
}

criterion_group!(benches, factorisation, joint);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    print_ratios();
}
