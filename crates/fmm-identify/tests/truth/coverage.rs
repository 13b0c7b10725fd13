//! Coverage: 95 % intervals contain the truth as often as they say.

use fmm_fit::{Fit, Options, Residuals, solve};
use fmm_friction::{AccelerationCoulomb, Berger, Coulomb, LawFamily, Stribeck};
use fmm_identify::{Candidate, Experiment, Identification, Known, Machine, Problem, Terms, compare, identify};
use fmm_model::{Damping, Oscillator, Parameter, coverage_factor};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::records::{LOAD, NOISE, RELEASES, expected, machine, noisy, prepared, velocity};

/// Of 300 intervals 95 ± 1.3 % contain the truth by chance alone.
const SEEDS: u64 = 300;
const SAMPLES: usize = 1500;
const LEVEL: f64 = 0.95;

/// The share of seeds whose interval contains the truth lies within 92 and 98 %, for each of the `names`.
fn covers(names: &[&str], truth: &[f64], mut fit: impl FnMut(u64) -> Fit) {
    let mut inside = vec![0_u32; names.len()];
    for seed in 0..SEEDS {
        let fit = fit(seed);
        assert!(fit.outcome().is_success(), "seed {seed}: {}", fit.outcome());
        for ((count, name), truth) in inside.iter_mut().zip(names).zip(truth) {
            let (lower, upper) = fit.interval(name, LEVEL).unwrap();
            *count += u32::from((lower..=upper).contains(truth));
        }
    }
    let shares: Vec<f64> = inside.iter().map(|count| f64::from(*count) / SEEDS as f64).collect();
    println!("{names:?}: {shares:?}");
    for (share, name) in shares.iter().zip(names) {
        assert!((0.92..=0.98).contains(share), "{share} of the intervals of {name} contain the truth");
    }
}

/// Motions without noise, one for each release.
fn motions<F: LawFamily>(machine: Oscillator, values: &[f64], releases: &[f64]) -> Vec<Vec<f64>> {
    releases.iter().map(|release| velocity::<F>(machine, values, *release, SAMPLES)).collect()
}

fn decays(motions: &[Vec<f64>], seed: u64) -> Vec<Experiment> {
    motions.iter().enumerate().map(|(i, motion)| noisy(motion, 10_000 * i as u64 + seed)).collect()
}

/// The fit of law `F` from the true `start`: that it is found from elsewhere is not the question here.
fn fitted<F: LawFamily>(decays: &[Experiment], terms: &Terms, shared: &[f64], releases: &[f64]) -> Fit {
    let problem = Problem::of(&Candidate::of::<F>().with(terms.clone()), Machine::per_unit_mass(), decays).unwrap();
    let own = releases.iter().flat_map(|release| [*release, 0.0, 0.0]);
    let mut known = shared.iter().copied().chain(own);
    // In a few records noise looks like hum, which has parameters of its own.
    let is_hum = |parameter: &Parameter| parameter.name().starts_with("hum");
    let value = |parameter: &Parameter| if is_hum(parameter) { Some(0.0) } else { known.next() };
    let start: Vec<f64> = problem.parameters().iter().filter_map(value).collect();
    solve(&problem, &start, &Options::default()).unwrap()
}

fn with_frequency(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    std::iter::once(machine().natural_frequency()).chain(values).collect()
}

/// Both levels, by a search from automatic start values.
#[test]
fn acceleration_coulomb() {
    let values = [0.25, 0.24];
    let motions = motions::<AccelerationCoulomb>(machine(), &values, &RELEASES[2..]);
    let names = ["gaining_friction_per_mass", "losing_friction_per_mass"];
    covers(&names, &expected::<AccelerationCoulomb>(&values), |seed| {
        let candidates = [Candidate::of::<AccelerationCoulomb>()];
        let comparison = compare(&Machine::per_unit_mass(), &decays(&motions, seed), &candidates).unwrap();
        comparison.identifications()[0].fit().clone()
    });
}

/// Three releases with one law; one alone hardly tells floor and excess apart.
#[test]
fn berger_of_three_releases() {
    let values = [0.15, 0.2, 10.0];
    let motions = motions::<Berger>(machine(), &values, &RELEASES);
    let names = ["friction_per_mass", "excess_friction_per_mass", "decay"];
    let truth = expected::<Berger>(&values);
    covers(&names, &truth, |seed| {
        fitted::<Berger>(&decays(&motions, seed), &Terms::default(), &with_frequency(truth.clone()), &RELEASES)
    });
}

/// The exponent held, as few records tell it.
#[test]
fn stribeck_of_known_exponent() {
    let values = [0.15, 0.3, 0.05, 2.0, 0.3];
    let motions = motions::<Stribeck>(machine(), &values, &RELEASES[2..]);
    let terms = Terms::default().holding("exponent", 2.0).unwrap();
    let truth = expected::<Stribeck>(&values);
    let names = ["sliding_friction_per_mass", "static_excess_friction_per_mass", "stribeck_speed", "damping_per_mass"];
    let of_names = [truth[0], truth[1], truth[2], truth[4]];
    covers(&names, &of_names, |seed| {
        fitted::<Stribeck>(&decays(&motions, seed), &terms, &with_frequency(truth.clone()), &RELEASES[2..])
    });
}

/// The drag of air beside dry friction.
#[test]
fn quadratic_damping() {
    const QUADRATIC: f64 = 0.3;
    let machine = machine().with_damping(Damping::new(0.0, QUADRATIC * machine().mass()).unwrap());
    let motions = motions::<Coulomb>(machine, &[0.1], &RELEASES[2..]);
    let terms = Terms::default().with_quadratic_damping();
    let [friction] = expected::<Coulomb>(&[0.1])[..] else { panic!("one parameter") };
    covers(&["quadratic_damping_per_mass", "friction_per_mass"], &[QUADRATIC, friction], |seed| {
        fitted::<Coulomb>(&decays(&motions, seed), &terms, &with_frequency([QUADRATIC, friction]), &RELEASES[2..])
    });
}

/// Share of seeds whose interval of `name` contains `truth`.
fn share(name: &str, truth: f64, identify: impl Fn(u64) -> Identification) -> f64 {
    let inside = (0..SEEDS).filter(|seed| {
        let (low, high) = identify(*seed).interval(name, LEVEL).unwrap();
        (low..=high).contains(&truth)
    });
    inside.count() as f64 / SEEDS as f64
}

/// A normal load that is measured anew for every record, to as much as the noise of the record leaves.
#[test]
fn coefficient_under_an_uncertain_load() {
    const RELATIVE: f64 = 3e-4;
    let motions = motions::<Coulomb>(machine(), &[0.2], &RELEASES[1..2]);
    let identified = |seed: u64| {
        let error: f64 = StandardNormal.sample(&mut ChaCha8Rng::seed_from_u64(50_000 + seed));
        let load = Known::new(LOAD * (1.0 + RELATIVE * error), RELATIVE * LOAD).unwrap();
        let machine = Machine::of_mass(Known::exact(machine().mass()).unwrap()).unwrap();
        identify::<Coulomb>(&machine.with_normal_load(load).unwrap(), &decays(&motions, seed)).unwrap()
    };
    let share = share("mu", 0.2, identified);
    assert!((0.92..=0.98).contains(&share), "{share} of the intervals of mu contain the truth");

    // The load is known: what it adds to the variance makes the whole better known by the square of that.
    let found = identified(0);
    let (mu, force) = (found.finding("mu").unwrap(), found.finding("friction_force").unwrap());
    let relative = |finding: &fmm_identify::Finding| finding.uncertainty().unwrap() / finding.value();
    let load = found.machine().normal_load().unwrap();
    assert!((relative(mu) / relative(force).hypot(load.uncertainty() / load.value()) - 1.0).abs() < 1e-9);
    assert_eq!(force.degrees_of_freedom(), found.fit().degrees_of_freedom() as f64);
    let freedom = force.degrees_of_freedom() * (relative(mu) / relative(force)).powi(4);
    assert!((mu.degrees_of_freedom() / freedom - 1.0).abs() < 1e-9, "{}", mu.degrees_of_freedom());
    let (low, high) = mu.interval(LEVEL).unwrap();
    let reach = coverage_factor(LEVEL, freedom).unwrap() * mu.uncertainty().unwrap();
    assert!((high - mu.value() - reach).abs() < 1e-12 && (mu.value() - low - reach).abs() < 1e-12);
    assert_eq!(mu.interval(1.0), None);
    assert_eq!(found.interval("coefficient of rolling", LEVEL), None);
}

/// Noise of which each sample remembers 0.9 of the one before it, as behind a filter.
#[test]
fn friction_under_correlated_noise() {
    const MEMORY: f64 = 0.9;
    let values = [0.2];
    let clean = velocity::<Coulomb>(machine(), &values, RELEASES[1], SAMPLES);
    let identified = |seed: u64| {
        let mut noise = 0.0;
        let steps = StandardNormal.sample_iter(ChaCha8Rng::seed_from_u64(70_000 + seed));
        let record = clean.iter().zip(steps).map(|(velocity, step): (&f64, f64)| {
            noise = MEMORY * noise + (1.0 - MEMORY * MEMORY).sqrt() * NOISE * step;
            velocity + noise
        });
        identify::<Coulomb>(&Machine::per_unit_mass(), &[prepared(record.collect())]).unwrap()
    };
    let share = share("friction_per_mass", expected::<Coulomb>(&values)[0], identified);
    assert!((0.92..=0.98).contains(&share), "{share} of the intervals contain the truth");
    let found = identified(0);
    let freedom = found.finding("friction_per_mass").unwrap().degrees_of_freedom();
    assert!(freedom < 0.1 * found.fit().degrees_of_freedom() as f64, "{freedom} degrees of freedom");
}
