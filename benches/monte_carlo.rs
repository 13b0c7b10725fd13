//! A million trials of a Monte Carlo against a bare loop with the same generator, in one run.
//!
//! `cargo bench --bench monte_carlo` prints criterion's estimates and then the ratios of their medians. Estimate,
//! standard uncertainty and the symmetric interval of 95 % are part of every figure but those of the bare loops, which
//! only draw and keep their values.

#[path = "common/ratio.rs"]
mod ratio;

use std::hint::black_box;

use criterion::{Criterion, criterion_group};
use fmm_model::Interval;
use fmm_uq::{Distribution, Input, Inputs, MonteCarlo};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal, StudentT};
use ratio::{median, print_ratio, print_row};

const TRIALS: u64 = 1_000_000;

/// JCGM 101:2008, 9.2.2: four standard normal quantities.
fn additive() -> Inputs {
    let names = ["X1", "X2", "X3", "X4"];
    Inputs::new(names.map(|name| Input::new(name, 0.0, 1.0, "1").expect("valid"))).expect("valid")
}

/// JCGM 101:2008, 9.5: a gauge block, in nm.
fn gauge_block() -> Inputs {
    let of = |name: &str, distribution: Result<Distribution, _>, unit: &str| {
        Input::of(name, distribution.expect("valid"), unit).expect("valid")
    };
    Inputs::new([
        of("length of the standard", Distribution::student_t(50_000_623.0, 25.0, 18.0), "nm"),
        of("difference", Distribution::student_t(215.0, 6.0, 24.0), "nm"),
        of("random effects", Distribution::student_t(0.0, 4.0, 5.0), "nm"),
        of("systematic effects", Distribution::student_t(0.0, 7.0, 8.0), "nm"),
        of("expansion", Distribution::rectangular(9.5e-6, 13.5e-6), "1/K"),
        of("mean temperature", Distribution::normal(-0.1, 0.2), "K"),
        of("cyclic temperature", Distribution::arc_sine(-0.5, 0.5), "K"),
        of("difference of expansions", Distribution::curvilinear_trapezoid(-1e-6, 1e-6, 1e-7), "1/K"),
        of("difference of temperatures", Distribution::curvilinear_trapezoid(-0.05, 0.05, 0.025), "K"),
    ])
    .expect("valid")
}

fn length(x: &[f64]) -> f64 {
    x[0] + x[1] + x[2] + x[3] - x[0] * (x[7] * (x[5] + x[6]) + x[4] * x[8])
}

/// Everything that is asked of a run.
fn evaluate(inputs: &Inputs, model: impl Fn(&[f64]) -> f64 + Sync) -> (f64, f64, Interval) {
    let run = MonteCarlo::new(inputs, TRIALS).expect("valid");
    let sample = run.run(model).expect("no trial fails");
    let interval = sample.symmetric_interval(0, 0.95).expect("enough trials");
    (sample.estimate(0).expect("one output"), sample.standard_uncertainty(0).expect("one output"), interval)
}

fn additive_model(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("additive");
    group.sample_size(20);
    group.bench_function("bare_loop", |bencher| {
        bencher.iter(|| {
            let mut rng = ChaCha8Rng::seed_from_u64(0);
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let values = (0..TRIALS).map(|_| normal() + normal() + normal() + normal());
            black_box(values.collect::<Vec<f64>>())
        });
    });
    let inputs = additive();
    group.bench_function("monte_carlo", |bencher| {
        bencher.iter(|| evaluate(black_box(&inputs), |x| x[0] + x[1] + x[2] + x[3]));
    });
    let sample = MonteCarlo::new(&inputs, TRIALS).and_then(|run| run.run(|x| x[0] + x[1] + x[2] + x[3]));
    let sample = sample.expect("no trial fails");
    group.bench_function("symmetric_interval", |bencher| bencher.iter(|| sample.symmetric_interval(0, 0.95)));
    group.bench_function("shortest_interval", |bencher| bencher.iter(|| sample.shortest_interval(0, 0.95)));
    group.finish();
}

fn gauge_block_model(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gauge_block");
    group.sample_size(20);
    group.bench_function("bare_loop", |bencher| {
        let student = |nu: f64| StudentT::new(nu).expect("valid");
        let [s, d, r, e] = [18.0, 24.0, 5.0, 8.0].map(student);
        bencher.iter(|| {
            let mut rng = ChaCha8Rng::seed_from_u64(0);
            let mut x = [0.0; 9];
            let values = (0..TRIALS).map(|_| {
                let limits = |rng: &mut ChaCha8Rng, half: f64, inexactness: f64| {
                    let half = half + inexactness * (2.0 * rng.random::<f64>() - 1.0);
                    half * (2.0 * rng.random::<f64>() - 1.0)
                };
                x[0] = 50_000_623.0 + 25.0 * s.sample(&mut rng);
                x[1] = 215.0 + 6.0 * d.sample(&mut rng);
                x[2] = 4.0 * r.sample(&mut rng);
                x[3] = 7.0 * e.sample(&mut rng);
                x[4] = 9.5e-6 + 4e-6 * rng.random::<f64>();
                let z: f64 = StandardNormal.sample(&mut rng);
                x[5] = -0.1 + 0.2 * z;
                x[6] = 0.5 * (std::f64::consts::TAU * rng.random::<f64>()).sin();
                x[7] = limits(&mut rng, 1e-6, 1e-7);
                x[8] = limits(&mut rng, 0.05, 0.025);
                length(&x)
            });
            black_box(values.collect::<Vec<f64>>())
        });
    });
    let inputs = gauge_block();
    group.bench_function("monte_carlo", |bencher| bencher.iter(|| evaluate(black_box(&inputs), length)));
    group.finish();
}

fn print_ratios() {
    if let (Some(bare), Some(whole)) = (median("additive/bare_loop"), median("additive/monte_carlo")) {
        // 4 ms for what the loop does not do: moments, and an interval from pooled values.
        let allowed = 1.2 * bare + 4e6;
        print_row("`additive/monte_carlo` / (1.2 `additive/bare_loop` + 4 ms)", whole / allowed, ..=1.0);
    }
    print_ratio("additive/monte_carlo", "additive/bare_loop", ..);
    print_ratio("gauge_block/monte_carlo", "gauge_block/bare_loop", ..=1.0);
}

criterion_group!(benches, additive_model, gauge_block_model);

fn main() {
    benches();
    Criterion::default().configure_from_args().final_summary();
    print_ratios();
}
