//! Models of forces along motions beside each other, and records and models that are refused.

use std::f64::consts::PI;

use fmm_friction::{Coulomb, Dahl};
use fmm_identify::{Candidate, ForceRecord, Identification, IdentifyError, Known, Machine, Warning, compare, identify};
use fmm_sim::{FrictionPoint, PrescribedMotion, State, friction_along};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::force::{identified, motion};

/// The model that has made the forces wins, whether the others are cases of it or not; two words for one model are
/// refused.
#[test]
fn the_model_behind_the_forces_wins() {
    let times: Vec<f64> = (0..1500).map(|i| 2e-3 * f64::from(i)).collect();
    let states: Vec<State> = times.iter().map(|t| motion(*t)).collect();
    let path = PrescribedMotion::through(&times, &states).unwrap();
    let law = Dahl::new(4.0, 3e3, 1.0).unwrap();
    let friction = friction_along(&law, 1.0, &path).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut force = |(state, point): (&State, &FrictionPoint)| {
        let draw: f64 = StandardNormal.sample(&mut random);
        point.force + 20.0 * state.velocity + 0.05 * draw
    };
    let forces: Vec<f64> = states.iter().zip(&friction).map(&mut force).collect();
    let (positions, velocities): (Vec<f64>, Vec<f64>) =
        states.iter().map(|state| (state.position, state.velocity)).unzip();
    let record = ForceRecord::of_positions(&times, &positions, &forces).unwrap().with_velocities(&velocities).unwrap();
    let models = |names: &[&str]| names.iter().map(|name| Candidate::named(name).unwrap()).collect::<Vec<_>>();
    let compare = |records: &[ForceRecord], names: &[&str]| compare(&Machine::per_unit_mass(), records, &models(names));
    let names = ["coulomb + linear", "dahl", "dahl + linear", "dahl + linear + zero", "viscous"];
    let compared = compare(std::slice::from_ref(&record), &names).unwrap();
    assert!(compared.is_decided(), "{compared}");
    assert_eq!(compared.preferred().law(), "dahl + linear", "{compared}");
    let twice = compare(std::slice::from_ref(&record), &["dahl", "dahl"]);
    assert!(matches!(twice, Err(IdentifyError::Contradiction { .. })), "{twice:?}");
    assert!(matches!(compare(&[record], &[]), Err(IdentifyError::Missing { .. })));
}

#[test]
fn what_is_no_record_is_refused() {
    let (times, values) = ([0.0, 0.1, 0.2, 0.3], [0.0, 1.0, 0.5, 0.2]);
    let record = |times: &[f64], positions: &[f64], forces: &[f64]| ForceRecord::of_positions(times, positions, forces);
    assert!(matches!(record(&times[..2], &values[..2], &values[..2]), Err(IdentifyError::TooFew { .. })));
    assert!(matches!(record(&times, &values[..3], &values), Err(IdentifyError::Contradiction { .. })));
    assert!(matches!(record(&[0.0, 0.2, 0.2, 0.3], &values, &values), Err(IdentifyError::OutOfRange { .. })));
    assert!(matches!(record(&times, &[f64::NAN; 4], &values), Err(IdentifyError::InvalidInput(_))));
    assert!(matches!(record(&times, &[1.0; 4], &values), Err(IdentifyError::NotSeen { .. })));
    let record = record(&times, &values, &values).unwrap();
    assert!(record.clone().under_loads(&[-1.0; 4]).is_err() && record.clone().under_loads(&[0.0; 4]).is_err());
    assert!(record.clone().under_loads(&[0.0, 1.0, 0.0, 2.0]).is_ok() && record.clone().resting_up_to(-1.0).is_err());
    assert!(matches!(identified("coulomb", &[]), Err(IdentifyError::Missing { .. })));
    assert!(matches!(
        identified("coulomb + load offset", std::slice::from_ref(&record)),
        Err(IdentifyError::Missing { .. })
    ));
    let angles = record.clone().in_units("rad", "N m");
    let found = identified("coulomb", std::slice::from_ref(&record)).unwrap();
    assert!(
        matches!(found.validate(&angles), Err(IdentifyError::WrongRecord { .. })) && found.predict(&record).is_ok()
    );
    assert!(matches!(identified("coulomb", &[record.clone(), angles]), Err(IdentifyError::WrongRecord { .. })));
    assert!(matches!(identified("lugre + zero", std::slice::from_ref(&record)), Err(IdentifyError::TooFew { .. })));
    assert!(matches!(Candidate::named("coulomb + wind"), Err(IdentifyError::UnknownName { .. })));
    for name in ["viscous + linear", "coulomb + cubic spring", "coulomb + power"] {
        let refused = identified(name, std::slice::from_ref(&record));
        assert!(matches!(refused, Err(IdentifyError::Contradiction { .. })), "{name}: {refused:?}");
    }
    let machine = Machine::of_mass(Known::exact(1.0).unwrap()).unwrap();
    assert!(matches!(identify::<Coulomb>(&machine, &[record]), Err(IdentifyError::Contradiction { .. })));
}

/// Velocities in mm/s beside positions in m, or of the other sign; those of a drifting or noisy sensor are taken.
#[test]
fn velocities_that_are_not_the_slope_of_the_positions_are_refused() {
    let times: Vec<f64> = (0..2000).map(|i| 1e-3 * f64::from(i)).collect();
    let angular = 2.0 * std::f64::consts::PI;
    let positions: Vec<f64> = times.iter().map(|t| 0.01 * (angular * t).sin()).collect();
    let slope = |t: &f64| 0.01 * angular * (angular * t).cos();
    let forces: Vec<f64> = times.iter().map(|t| 3.0 * slope(t).signum()).collect();
    let with = |scale: f64, drift: f64| {
        let velocities: Vec<f64> = times.iter().map(|t| scale * slope(t) + drift * t).collect();
        ForceRecord::of_positions(&times, &positions, &forces).unwrap().with_velocities(&velocities)
    };
    for (scale, drift) in [(1.0, 0.0), (0.8, 0.01), (1.0, 0.5)] {
        assert!(with(scale, drift).is_ok(), "{scale} times, {drift} m/s²");
    }
    for scale in [1000.0, 5.0, 0.1, -1.0] {
        let refused = with(scale, 0.0).unwrap_err().to_string();
        assert!(refused.contains("times the slope of the positions"), "{refused}");
    }
}

/// Laws with a delay and without have residuals at other samples, and are compared all the same; the more general law
/// does not end above the special case.
#[test]
fn laws_with_a_delay_are_compared_with_those_without() {
    let times: Vec<f64> = (0..2000).map(|i| 2e-3 * f64::from(i)).collect();
    let forces: Vec<f64> = times
        .iter()
        .enumerate()
        .map(|(i, time)| {
            let velocity = motion(*time).velocity;
            3.0 * velocity.signum() + 10.0 * velocity + 0.05 * (1.7 * (i * i) as f64).sin()
        })
        .collect();
    let positions: Vec<f64> = times.iter().map(|time| motion(*time).position).collect();
    let record = ForceRecord::of_positions(&times, &positions, &forces).unwrap();
    let models = ["coulomb", "coulomb + linear", "coulomb + linear + delay", "dahl + linear"];
    let models = models.map(|model| Candidate::named(model).unwrap());
    let compared = compare(&Machine::per_unit_mass(), &[record], &models).unwrap();
    let rms: Vec<f64> = compared.identifications().iter().map(Identification::rms_residual).collect();
    assert!(rms[2] < 1.01 * rms[1] && rms[1] < 0.5 * rms[0], "{rms:?}");
    assert!(compared.p_values()[0] < 0.002 && compared.p_values()[1] > 0.002, "{:?}", compared.p_values());
    let unfinished =
        |warning: &Warning| matches!(warning, Warning::OtherLaw { sentence, .. } if sentence.contains("missed"));
    assert!(!compared.warnings().iter().any(unfinished), "{compared}");
}

/// A law that says a force at rest is judged by it there: it is not preferred for what it does
/// elsewhere.
#[test]
fn a_law_is_judged_at_the_samples_that_it_alone_describes() {
    let times: Vec<f64> = (0..4000).map(|i| 2e-3 * f64::from(i)).collect();
    // Half of each period it rests, and the force there wanders between the levels.
    let forces: Vec<f64> = times
        .iter()
        .enumerate()
        .map(|(i, time)| {
            let moves = time.rem_euclid(2.0) < 1.0;
            let noise = 0.05 * (1.7 * (i * i) as f64).sin();
            if moves { -3.0 + noise } else { 2.5 * (5.0 * time).sin() }
        })
        .collect();
    let velocities: Vec<f64> = times
        .iter()
        .map(|time| if time.rem_euclid(2.0) < 1.0 { -0.02 * PI * (PI * time.rem_euclid(2.0)).sin() } else { 0.0 })
        .collect();
    let record = ForceRecord::of_velocities(&times, &velocities, &forces).unwrap();
    let models = ["coulomb", "dahl"].map(|model| Candidate::named(model).unwrap());
    let compared = compare(&Machine::per_unit_mass(), &[record], &models).unwrap();
    let [coulomb, dahl] = [0, 1].map(|place| &compared.identifications()[place]);
    assert!(coulomb.samples() < dahl.samples() && coulomb.rms_residual() < dahl.rms_residual(), "{compared}");
    assert_eq!(compared.preferred().law(), "coulomb", "{compared}");
    assert!(compared.p_values()[1] < 0.002, "{:?}", compared.p_values());
}
