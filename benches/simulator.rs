//! The exact engine against the thesis' Euler loop, and its gradient against a plain run, in one run.
//!
//! `cargo bench --bench simulator` prints criterion's estimates and then the ratios of their medians.

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, criterion_group};
use fmm_friction::{Coulomb, LawFamily};
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::{Channels, Engine, Exact, Sampling, Scenario, Thesis, Trajectory};

/// Workload W1: the Monte Carlo case of the thesis, 1501 velocity samples at 1 kHz.
fn thesis_case<D: Scalar>(coefficient: D, position: D) -> (Scenario<D, Coulomb<D>>, Sampling) {
    let number = |value: f64| D::from(value);
    let damping = Damping::linear(number(0.275)).expect("valid");
    let machine = Oscillator::new(number(10.391), number(1982.0)).expect("valid").with_damping(damping);
    let law = Coulomb::at(&[coefficient]).expect("valid");
    let scenario = Scenario::new(machine, law, number(7.2)).expect("valid");
    let sampling = Sampling::uniform(1e-3, 1501).expect("valid").keeping(Channels::Velocity);
    (scenario.starting_at(position, number(0.101)).expect("valid"), sampling)
}

fn ring_down(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ring_down");
    let (scenario, sampling) = thesis_case(0.15, 0.0);
    let mut trajectory = Trajectory::new();
    group.bench_function("thesis", |bencher| {
        bencher.iter(|| Thesis.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.bench_function("exact", |bencher| {
        bencher.iter(|| Exact.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    let (scenario, sampling) = thesis_case(Dual::<2>::variable(0.15, 0), Dual::variable(0.0, 1));
    let mut trajectory = Trajectory::new();
    group.bench_function("exact_gradient", |bencher| {
        bencher.iter(|| Exact.run_into(black_box(&scenario), &sampling, &mut trajectory));
    });
    group.finish();
}

/// Criterion's median of a benchmark of this run (ns), if it was measured.
fn median(benchmark: &str) -> Option<f64> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| Path::new("target").to_owned(), Into::into);
    let path = target.join("criterion").join("ring_down").join(benchmark).join("new").join("estimates.json");
    let estimates: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
    estimates["median"]["point_estimate"].as_f64()
}

fn print_ratios() {
    if let (Some(thesis), Some(exact), Some(gradient)) = (median("thesis"), median("exact"), median("exact_gradient")) {
        println!("thesis / exact: {:.1} (target at least 10)", thesis / exact);
        println!("exact with two gradient columns / exact: {:.2} (target at most 3)", gradient / exact);
    }
}

criterion_group!(benches, ring_down);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    print_ratios();
}
