//! The Berger law's ring-down by the thesis' Euler loop, by the Runge-Kutta engine and by diffsol, in one run.
//!
//! `cargo bench --manifest-path benches/peers/Cargo.toml` prints criterion's estimates, then error and ratio of each.
//! At matched accuracy means: of the tolerances tried, the fastest whose greatest error is at most 1e-10 m/s.

#[path = "../../common/ratio.rs"]
#[expect(dead_code, reason = "other benches print plain ratios")]
mod ratio;

use std::hint::black_box;

use criterion::Criterion;
use fmm_peers::{berger, by_diffsol};
use fmm_sim::{Engine, RungeKutta, Thesis, Trajectory};
use ratio::{median, print_row};

/// Tolerances tried (1).
const TOLERANCES: [f64; 5] = [1e-8, 1e-9, 1e-10, 1e-11, 1e-12];

/// The accuracy asked for (m/s).
const WANTED: f64 = 1e-10;

fn greatest_error(velocity: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(velocity.len(), reference.len());
    velocity.iter().zip(reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let (scenario, sampling) = berger();
    let run = |engine: RungeKutta| engine.run(&scenario, &sampling).expect("a motion").velocity().values().to_vec();
    let reference = run(RungeKutta::new(2e-15).expect("valid"));

    let mut errors = Vec::new();
    let mut group = criterion.benchmark_group("berger");
    let mut motion = Trajectory::new();
    group.bench_function("thesis", |bencher| {
        bencher.iter(|| Thesis::A3.run_into(black_box(&scenario), &sampling, &mut motion));
    });
    errors.push(("thesis".to_owned(), greatest_error(motion.velocity().values(), &reference)));
    let engines = TOLERANCES.map(|tolerance| RungeKutta::new(tolerance).expect("valid"));
    for engine in engines.into_iter().chain([RungeKutta::default()]) {
        let name = format!("fmm_{:e}", engine.tolerance());
        group.bench_function(&name, |bencher| {
            bencher.iter(|| engine.run_into(black_box(&scenario), &sampling, &mut motion));
        });
        errors.push((name, greatest_error(&run(engine), &reference)));
    }
    let mut velocity = Vec::new();
    for tolerance in TOLERANCES {
        let name = format!("diffsol_{tolerance:e}");
        group.bench_function(&name, |bencher| bencher.iter(|| by_diffsol(black_box(tolerance), &mut velocity)));
        by_diffsol(tolerance, &mut velocity);
        errors.push((name, greatest_error(&velocity, &reference)));
    }
    group.finish();
    criterion.final_summary();

    let mut best: [Option<f64>; 2] = [None; 2];
    for (name, error) in &errors {
        let Some(time) = median(&format!("berger/{name}")) else { continue };
        println!("{name}: {:.1} µs, error {error:.1e} m/s", 1e-3 * time);
        for (best, peer) in best.iter_mut().zip(["fmm", "diffsol"]) {
            if name.starts_with(peer) && *error <= WANTED {
                *best = Some(best.map_or(time, |best| best.min(time)));
            }
        }
    }
    if let (Some(thesis), [Some(ours), Some(theirs)]) = (median("berger/thesis"), best) {
        print_row(&format!("diffsol / fmm at {WANTED:e} m/s"), theirs / ours, 5.0..);
        print_row(&format!("thesis / fmm at {WANTED:e} m/s"), thesis / ours, 1.0..);
    }
}
