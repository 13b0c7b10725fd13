//! Springs that harden or soften, and cubic damping, fitted beside the law.

use std::time::Duration;

use fmm_friction::{Coulomb, CoulombViscous, Stribeck};
use fmm_identify::{
    Candidate, Experiment, FrictionCurve, IdentifyError, Inquiry, Machine, Preparation, Terms, Warning, compare, search,
};
use fmm_model::{Damping, Oscillator, Restoring};
use fmm_record::Quantity;
use fmm_sim::{Sampling, Scenario, simulate};

use crate::acceleration::{self, DELAY, FINER, filtered};
use crate::simulated::{INTERVAL, machine, record};

/// 2 Hz at small amplitude, released at 0.3 rad.
fn motion(cubic: f64, quintic: f64, damping: Damping) -> Vec<f64> {
    swing(Restoring::polynomial(cubic, quintic).unwrap(), damping)
}

fn swing(spring: Restoring, damping: Damping) -> Vec<f64> {
    let machine = Oscillator::per_unit_mass(2.0).unwrap().with_damping(damping).with_restoring(spring);
    let scenario = Scenario::new(machine, CoulombViscous::new(0.2, 0.1).unwrap(), 1.0).unwrap();
    let motion = simulate(&scenario.starting_at(0.3, 0.0).unwrap(), &Sampling::uniform(INTERVAL, 6000).unwrap());
    motion.unwrap().position().values().to_vec()
}

#[test]
fn springs_come_back() {
    let terms = Terms::default().with_cubic_spring().with_quintic_spring();
    for (cubic, quintic) in [(-3.0, 12.0), (4.0, 0.0), (-1.0, -2.0)] {
        let motion = motion(cubic, quintic, Damping::none());
        let record = record(&motion, 1e-4, 5, Quantity::Displacement, "rad");
        let experiment = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let found = Inquiry::of(&Machine::per_unit_mass(), &[experiment])
            .candidate(&Candidate::of::<CoulombViscous>().with(terms.clone()))
            .unwrap();
        for (name, truth) in [("cubic_spring", cubic), ("quintic_spring", quintic), ("friction_per_mass", 0.2)] {
            let finding = found.finding(name).unwrap();
            let (error, u) = ((finding.value() - truth).abs(), finding.uncertainty().unwrap());
            assert!(error < 4.0 * u && u < 0.2, "{name} for {truth}:\n{found}");
        }
        let ratio = found.finding("cubic_stiffness_per_mass").unwrap().value();
        let angular = std::f64::consts::TAU * found.finding("natural_frequency_hz").unwrap().value();
        assert!((ratio / (angular * angular * found.finding("cubic_spring").unwrap().value()) - 1.0).abs() < 1e-12);
    }
}

/// The findings of these names lie within four of their uncertainties of the truth, which are less than the last
/// number.
fn come_back(motion: &[f64], seed: u64, terms: &Terms, truths: &[(&str, f64, f64)]) {
    let record = record(motion, 1e-4, seed, Quantity::Displacement, "rad");
    let experiment = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let found = Inquiry::of(&Machine::per_unit_mass(), &[experiment])
        .candidate(&Candidate::of::<CoulombViscous>().with(terms.clone()))
        .unwrap();
    for (name, truth, most) in truths {
        let finding = found.finding(name).unwrap();
        let (error, u) = ((finding.value() - truth).abs(), finding.uncertainty().unwrap());
        assert!(error < 4.0 * u && u < *most, "{name} for {truth}:\n{found}");
    }
}

#[test]
fn damping_terms_come_back() {
    let cubic = motion(0.0, 0.0, Damping::none().with_cubic(0.05).unwrap());
    come_back(&cubic, 6, &Terms::default().with_cubic_damping(), &[("cubic_damping_per_mass", 0.05, 0.01)]);
    let power = motion(0.0, 0.0, Damping::none().with_power(0.1, 2.4).unwrap());
    let truths = [("power_damping_per_mass", 0.1, 0.02), ("power_damping_exponent", 2.4, 0.3)];
    come_back(&power, 8, &Terms::default().with_power_damping(), &truths);
}

/// Stops that are harder or softer than the spring, and backlash.
#[test]
fn corners_of_a_spring_come_back() {
    for (distance, ratio) in [(0.2, 3.0), (0.12, 0.6)] {
        let motion = swing(Restoring::stop(distance, ratio).unwrap(), Damping::none());
        let truths = [
            ("stop_distance", distance, 1e-3),
            ("stop_stiffness_ratio", ratio, 0.02),
            ("friction_per_mass", 0.2, 1e-2),
        ];
        come_back(&motion, 9, &Terms::default().with_stop(), &truths);
    }
    let motion = swing(Restoring::gap(0.03).unwrap(), Damping::none());
    let truths = [("gap", 0.03, 1e-3), ("natural_frequency_hz", 2.0, 1e-2), ("friction_per_mass", 0.2, 1e-2)];
    come_back(&motion, 10, &Terms::default().with_gap(), &truths);
    for together in ["coulomb+stop+gap", "coulomb+stop+cubic spring"] {
        let record = record(&motion, 1e-4, 11, Quantity::Displacement, "rad");
        let experiment = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let candidates = [Candidate::named(together).unwrap()];
        let refused = compare(&Machine::per_unit_mass(), &[experiment], &candidates);
        assert!(matches!(refused, Err(IdentifyError::Contradiction { .. })), "{refused:?}");
    }
}

#[test]
fn a_pendulum_has_no_further_spring() {
    let motion = motion(0.0, 0.0, Damping::none());
    let record = record(&motion, 1e-4, 6, Quantity::Displacement, "rad");
    let experiment = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let machine = Machine::per_unit_mass().with_restoring(Restoring::sine(1.0).unwrap());
    let refused = Inquiry::of(&machine, &[experiment])
        .candidate(&Candidate::of::<Coulomb>().with(Terms::default().with_cubic_spring()));
    assert!(matches!(refused, Err(IdentifyError::Contradiction { .. })), "{refused:?}");
    assert_eq!(
        Candidate::named("coulomb+cubic_spring+quintic spring").unwrap().name(),
        "coulomb + cubic spring + quintic spring"
    );
}

/// The beginning of a decay behind a filter looks like a bent spring to the first residuals.
#[test]
fn a_filter_is_no_spring() {
    let motion = acceleration::motion(22e-3, FINER);
    let seen = filtered(motion.velocity().values());
    let late = (DELAY / INTERVAL) as usize;
    let values: Vec<f64> = std::iter::repeat_n(0.0, late).chain(seen).collect();
    let record = record(&values, 1e-3, 1, Quantity::Velocity, "m/s");
    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let decays = [decay];
    let searched = search(&machine(), &decays).unwrap();
    let all = searched.identifications();
    assert!(all.iter().all(|found| !found.law().contains("spring")), "{}", searched.preferred());
    let candidates = ["coulomb_viscous", "coulomb_viscous+cubic spring+quintic spring"].map(Candidate::named);
    let asked = compare(&machine(), &decays, &candidates.map(Result::unwrap)).unwrap();
    for comparison in [searched, asked] {
        let is_named = |warning: &Warning| match warning {
            Warning::FilteringSensor { law, .. } | Warning::Beginning { law, .. } => !law.contains("spring"),
            _ => false,
        };
        assert!(comparison.warnings().iter().any(is_named), "{}", comparison.preferred());
        // The filter explains the record as well, so that neither law is the answer.
        assert!(!comparison.is_decided(), "{}", comparison.preferred());
    }
}

/// Without being asked, the search finds a stop; and where a spring is fitted, that the period changes is no warning.
#[test]
fn the_search_finds_a_stop() {
    let motion = swing(Restoring::stop(0.2, 3.0).unwrap(), Damping::none());
    let record = record(&motion[..2000], 1e-4, 12, Quantity::Displacement, "rad");
    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let warns = |warnings: &[Warning]| warnings.iter().any(|w| matches!(w, Warning::PeriodDependsOnAmplitude { .. }));
    assert!(warns(&decay.warnings()));
    let found = search(&Machine::per_unit_mass(), &[decay]).unwrap();
    assert_eq!(found.preferred().law(), "coulomb_viscous + stop", "{found}");
    assert!(!warns(found.preferred().warnings()) && !warns(found.warnings()), "{found}");
}

/// A spring that bends and friction that falls with the speed are told apart at once: neither is named without the
/// other, and both come back.
#[test]
fn the_search_finds_a_bent_spring_beside_falling_friction() {
    let spring = Restoring::polynomial(-1.0, 0.0).unwrap();
    let machine = Oscillator::per_unit_mass(2.0).unwrap().with_restoring(spring);
    let law = Stribeck::new(1.5, 2.2, 0.3, 2.0, 0.05).unwrap();
    let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(0.3, 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(INTERVAL, 3000).unwrap()).unwrap();
    let record = record(motion.position().values(), 2e-4, 14, Quantity::Displacement, "rad");
    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let decays = [decay];
    let found = search(&Machine::per_unit_mass(), &decays).unwrap();
    let preferred = found.preferred();
    assert!(preferred.law().starts_with("stribeck + cubic spring"), "{found}");
    for (name, truth) in [("sliding_friction_per_mass", 1.5), ("static_friction_per_mass", 2.2), ("cubic_spring", -1.0)]
    {
        let finding = preferred.finding(name).unwrap();
        assert!((finding.value() - truth).abs() < 3.5 * finding.uncertainty().unwrap(), "{name}: {found}");
    }
    let curve = FrictionCurve::beside(preferred, &decays).unwrap();
    assert!(FrictionCurve::beside_within(preferred, &decays, Duration::ZERO).is_err());
    let within = FrictionCurve::beside_within(preferred, &decays, Duration::from_secs(3600)).unwrap();
    assert_eq!(within.at_rest().value(), curve.at_rest().value());
    assert!(curve.limits().is_empty(), "{curve}");
    let (low, high) = curve.at_rest().interval(0.95).unwrap();
    assert!(low < 2.2 && 2.2 < high, "{curve}");
}

/// Lengths of a spring are uncertain with the gain of the record, ratios are not, and a power of the velocity is by one
/// less than itself.
#[test]
fn lengths_are_uncertain_with_the_gain() {
    let uncertain = |motion: &[f64], term: &str, gain: f64| {
        let record = record(motion, 1e-5, 13, Quantity::Displacement, "rad");
        let decay = Experiment::ring_down(&record, &Preparation::default().gain_uncertainty(gain)).unwrap();
        let candidate = [Candidate::named(&format!("coulomb_viscous+{term}")).unwrap()];
        compare(&Machine::per_unit_mass(), &[decay], &candidate).unwrap()
    };
    let share = |found: &fmm_identify::Comparison, name: &str| {
        let finding = found.preferred().finding(name).unwrap();
        finding.uncertainty().unwrap() / finding.value()
    };
    let stop = swing(Restoring::stop(0.2, 3.0).unwrap(), Damping::none());
    let stop = uncertain(&stop[..2000], "stop", 0.01);
    assert!((share(&stop, "stop_distance") / 0.01 - 1.0).abs() < 0.05 && share(&stop, "stop_stiffness_ratio") < 2e-3);
    let power = motion(0.0, 0.0, Damping::none().with_power(0.4, 3.0).unwrap());
    let [sharp, blurred] =
        [0.0, 0.1].map(|gain| share(&uncertain(&power[..2000], "power", gain), "power_damping_per_mass"));
    let added = (blurred * blurred - sharp * sharp).sqrt();
    assert!((added / 0.2 - 1.0).abs() < 0.1, "{added}");
}
