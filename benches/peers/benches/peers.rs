//! Ring-downs by the thesis' Euler loop, by the engine of FMM for their law and by diffsol, in one run.
//!
//! `cargo bench --manifest-path benches/peers/Cargo.toml` prints criterion's estimates, then error and ratio of each.
//! At matched accuracy means: of the tolerances tried, the fastest whose greatest error is at most 1e-10 m/s.

#[path = "../../common/ratio.rs"]
#[expect(dead_code, reason = "other benches print plain ratios")]
mod ratio;

use std::hint::black_box;

use criterion::Criterion;
use fmm_friction::SlidingLaw;
use fmm_peers::{BERGER, COULOMB, berger, by_diffsol, coulomb, sampling};
use fmm_sim::{Engine, Exact, RungeKutta, Scenario, Thesis, Trajectory};
use ratio::{median, print_row};

/// Tolerances tried (1).
const TOLERANCES: [f64; 5] = [1e-8, 1e-9, 1e-10, 1e-11, 1e-12];

/// The accuracy asked for (m/s).
const WANTED: f64 = 1e-10;

fn greatest_error(velocity: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(velocity.len(), reference.len());
    velocity.iter().zip(reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// An engine with the name of its rows.
type Named<L> = (String, Box<dyn Engine<f64, L>>);

/// Times the `engines` and diffsol on the motion of a `case`, and adds their greatest errors (m/s).
fn measure<L: SlidingLaw<f64>>(
    criterion: &mut Criterion,
    (name, case): (&str, [f64; 8]),
    scenario: &Scenario<f64, L>,
    engines: Vec<Named<L>>,
    errors: &mut Vec<(String, f64)>,
) {
    let sampling = sampling();
    let strict = RungeKutta::new(2e-15).expect("valid").run(scenario, &sampling).expect("a motion");
    let reference = strict.velocity().values();
    let mut group = criterion.benchmark_group(name);
    let thesis: Named<L> = ("thesis".to_owned(), Box::new(Thesis::A3));
    let mut motion = Trajectory::new();
    for (engine_name, engine) in std::iter::once(thesis).chain(engines) {
        let mut run = || engine.run_into(black_box(scenario), &sampling, &mut motion).expect("a motion");
        group.bench_function(&engine_name, |bencher| bencher.iter(&mut run));
        run();
        errors.push((format!("{name}/{engine_name}"), greatest_error(motion.velocity().values(), reference)));
    }
    let mut velocity = Vec::new();
    for tolerance in TOLERANCES {
        let engine_name = format!("diffsol_{tolerance:e}");
        group.bench_function(&engine_name, |bencher| {
            bencher.iter(|| by_diffsol(case, black_box(tolerance), &mut velocity));
        });
        by_diffsol(case, tolerance, &mut velocity);
        errors.push((format!("{name}/{engine_name}"), greatest_error(&velocity, reference)));
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let mut errors = Vec::new();
    let exact: Vec<Named<_>> = vec![("fmm_exact".to_owned(), Box::new(Exact))];
    measure(&mut criterion, ("coulomb", COULOMB), &coulomb(), exact, &mut errors);
    let of_tolerance = |engine: RungeKutta| -> Named<_> { (format!("fmm_{:e}", engine.tolerance()), Box::new(engine)) };
    let tolerances = TOLERANCES.map(|tolerance| RungeKutta::new(tolerance).expect("valid"));
    let engines = tolerances.into_iter().chain([RungeKutta::default()]).map(of_tolerance).collect();
    measure(&mut criterion, ("berger", BERGER), &berger(), engines, &mut errors);
    criterion.final_summary();

    for (name, error) in &errors {
        let Some(time) = median(name) else { continue };
        println!("{name}: {:.1} µs, error {error:.1e} m/s", 1e-3 * time);
    }
    for case in ["coulomb", "berger"] {
        let best = |peer: &str| {
            let good = errors.iter().filter(|(_, error)| *error <= WANTED);
            let of_peer = good.filter(|(name, _)| name.starts_with(&format!("{case}/{peer}")));
            of_peer.filter_map(|(name, _)| median(name)).min_by(f64::total_cmp)
        };
        if let (Some(thesis), Some(ours), Some(theirs)) =
            (median(&format!("{case}/thesis")), best("fmm"), best("diffsol"))
        {
            print_row(&format!("{case}: diffsol / fmm at {WANTED:e} m/s"), theirs / ours, 5.0..);
            print_row(&format!("{case}: thesis / fmm at {WANTED:e} m/s"), thesis / ours, 1.0..);
        }
    }
}
