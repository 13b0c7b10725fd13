//! Posteriors of identifications: findings, the three intervals, predictive checks.

use fmm_friction::{Coulomb, CoulombViscous};
use fmm_identify::posterior::PredictiveCheck;
use fmm_identify::{Experiment, Identification, Known, Machine, Preparation, identify};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

/// A ring-down of the thesis' machine with 0.25 · 14 N of friction from 22 mm, and white noise of 1 mm/s.
fn decays() -> Vec<Experiment> {
    let law = CoulombViscous::new(0.25, 0.05).unwrap();
    let scenario = Scenario::new(Oscillator::new(10.391, 1982.0).unwrap(), law, 14.0).unwrap();
    let motion =
        Exact.run(&scenario.starting_at(0.022, 0.0).unwrap(), &Sampling::uniform(1e-3, 2001).unwrap()).unwrap();
    let noise = Normal::new(0.0, 1e-3).unwrap().sample_iter(ChaCha8Rng::seed_from_u64(5));
    let values = motion.velocity().values().iter().zip(noise).map(|(v, noise)| v + noise).collect();
    let record = Record::new(0.0, 1e-3, values, Quantity::Velocity, "m/s").unwrap();
    vec![Experiment::ring_down(&record, &Preparation::default()).unwrap()]
}

fn machine() -> Machine {
    let mass = Machine::of_mass(Known::new(10.391, 0.005).unwrap()).unwrap();
    mass.with_normal_load(Known::new(14.0, 0.1).unwrap()).unwrap()
}

/// Far from its bounds a ring-down is nearly linear: the posterior has the deviation of the standard uncertainty, that
/// of the load included, and the report says that it was not needed.
#[test]
fn the_posterior_of_a_plain_ring_down_is_value_and_uncertainty() {
    let decays = decays();
    let found: Identification = identify::<CoulombViscous>(&machine(), &decays).unwrap();
    let posterior = found.posterior(&decays, &found.sampler()).unwrap();
    println!("{posterior}");
    // Of twelve such records two or three have 5 to 9 trajectories of 4000 that diverge; which ones, the last digits of
    // the motion decide.
    let sampled = posterior.posterior();
    assert!(200 * sampled.divergences() <= sampled.len(), "{posterior}");
    assert_eq!(posterior.warnings().len(), usize::from(sampled.divergences() > 0), "{posterior}");
    assert!(posterior.agrees() && posterior.verdict().ends_with("value ± u is enough"), "{posterior}");
    for name in ["mu", "friction_force", "stiffness", "friction_per_mass"] {
        let (finding, marginal) = (found.finding(name).unwrap(), posterior.finding(name).unwrap());
        let u = finding.uncertainty().unwrap();
        // Four Monte Carlo errors, and 3 % for what is not linear: the bend of the motion, and u(N)²/N².
        let reach = 4.0 * marginal.error_of_deviation() + 0.03 * u;
        assert!((marginal.standard_deviation() - u).abs() < reach, "{name}: {} for {u}", marginal.standard_deviation());
        assert!((marginal.mean() - finding.value()).abs() < 4.0 * marginal.error_of_mean() + 0.05 * u, "{name}");
    }
    for check in posterior.checks() {
        assert!((0.01..=0.99).contains(&check.p_value()), "{}: {}", check.feature(), check.p_value());
    }
    assert_eq!(
        posterior.checks().iter().map(PredictiveCheck::feature).collect::<Vec<_>>(),
        ["stop time", "half swings", "decrement"]
    );
}

#[test]
fn records_that_were_not_identified_are_refused() {
    let decays = decays();
    let dry = identify::<Coulomb>(&Machine::per_unit_mass(), &decays).unwrap();
    let refused = dry.posterior(&decays[..0], &dry.sampler()).unwrap_err().to_string();
    assert!(refused.starts_with("the identification is that of 1 record(s)"), "{refused}");
}
