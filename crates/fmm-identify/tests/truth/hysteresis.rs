//! Two levels fitted to friction that has no hysteresis: by exact simulation they agree, by the thesis' Euler they do
//! not.

use fmm_friction::{AccelerationCoulomb, Berger, Coulomb, LawFamily};
use fmm_identify::{Candidate, Experiment, Identification, Machine, compare};
use fmm_sim::{Engine, Sampling, Scenario, Thesis};

use crate::records::{LOAD, RELEASES, machine, noisy, prepared, velocity};

const SAMPLES: usize = 1500;

fn identified(decay: Experiment) -> Identification {
    let candidates = [Candidate::of::<AccelerationCoulomb>()];
    compare(&Machine::per_unit_mass(), &[decay], &candidates).unwrap().identifications()[0].clone()
}

/// μ₁ − μ₂ and its standard uncertainty.
fn difference(found: &Identification) -> (f64, f64) {
    let of = |name: &str| found.finding(name).unwrap();
    let (gaining, losing) = (of("gaining_friction_per_mass"), of("losing_friction_per_mass"));
    let (u1, u2) = (gaining.uncertainty().unwrap(), losing.uncertainty().unwrap());
    let correlation = found.fit().correlation(1, 2).unwrap();
    let u = (u1 * u1 + u2 * u2 - 2.0 * correlation * u1 * u2).sqrt();
    let per_load = machine().mass() / LOAD;
    (per_load * (gaining.value() - losing.value()), per_load * u)
}

/// Sum of squares of what the thesis' Euler leaves of a record of velocity (m²/s²).
fn misfit(levels: [f64; 2], release: f64, measured: &[f64]) -> f64 {
    let Ok(law) = AccelerationCoulomb::new(levels[0], levels[1]) else { return f64::INFINITY };
    let scenario = Scenario::new(machine(), law, LOAD).unwrap().starting_at(release, 0.0).unwrap();
    let motion = Thesis::A3.run(&scenario, &Sampling::uniform(1e-3, measured.len()).unwrap()).unwrap();
    motion.velocity().values().iter().zip(measured).map(|(v, measured)| (v - measured).powi(2)).sum()
}

/// μ₁ and μ₂ of the lowest misfit: a search by steps along each level and along both, which halve when none of them
/// helps. The misfit jumps, so no gradient leads there.
fn thesis_levels(start: f64, release: f64, measured: &[f64]) -> [f64; 2] {
    const DIRECTIONS: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    let mut best = ([start; 2], misfit([start; 2], release, measured));
    let mut step = 0.02;
    while step > 1e-6 {
        let tried = DIRECTIONS.iter().flat_map(|[a, b]| {
            [step, -step].map(|by| {
                let levels = [best.0[0] + by * a, best.0[1] + by * b];
                (levels, misfit(levels, release, measured))
            })
        });
        match tried.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some(lower) if lower.1 < best.1 => best = lower,
            _ => step *= 0.5,
        }
    }
    best.0
}

/// Exact and thesis' differences of the levels for a record without noise.
fn differences<F: LawFamily>(values: &[f64], start: f64, release: f64) -> ((f64, f64), f64) {
    let measured = velocity::<F>(machine(), values, release, SAMPLES);
    let thesis = thesis_levels(start, release, &measured);
    let found = identified(prepared(measured));
    let exact = difference(&found);
    println!(
        "released at {release} m: {:.6} ± {:.6}, thesis {:.5} ({thesis:?})",
        exact.0,
        exact.1,
        thesis[0] - thesis[1]
    );
    (exact, thesis[0] - thesis[1])
}

#[test]
fn coulomb_friction_has_none() {
    for release in RELEASES {
        let ((exact, _), thesis) = differences::<Coulomb>(&[0.25], 0.25, release);
        // Both levels to 1e-6 of themselves.
        assert!(exact.abs() < 1e-6 * 0.25, "released at {release} m: {exact}");
        assert!(thesis > 0.002, "released at {release} m: the thesis' Euler finds {thesis}");
    }
}

/// The two levels miss the fall with speed, and their uncertainties are widened for that.
#[test]
fn falling_friction_has_none() {
    for release in RELEASES {
        let ((exact, u), _) = differences::<Berger>(&[0.228, 0.261, 2.852], 0.4, release);
        assert!(exact.abs() < 2.0 * u, "released at {release} m: {exact} ± {u}");
    }
}

/// Nineteen of twenty intervals of 95 % contain zero: 95 ± 2.2 % of a hundred, and three standard deviations are
/// allowed.
#[test]
fn noise_makes_none() {
    const SEEDS: u64 = 100;
    let motion = velocity::<Coulomb>(machine(), &[0.25], RELEASES[2], SAMPLES);
    let consistent = (0..SEEDS).filter(|seed| {
        let (difference, u) = difference(&identified(noisy(&motion, 500 + seed)));
        difference.abs() < 1.96 * u
    });
    let count = consistent.count();
    println!("{count} of {SEEDS} are consistent with zero");
    assert!(count >= 89, "{count} of {SEEDS} are consistent with zero");
}
