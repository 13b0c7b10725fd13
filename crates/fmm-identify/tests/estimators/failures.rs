//! What the estimators cannot take is refused with an error that says why.

use fmm_identify::{
    EnergyMethod, Experiment, IdentifyError, Preparation, WeakForm, Windows, decrements, half_swing_losses,
    half_swing_losses_of,
};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record, Smoothing};

use crate::measurement::{free, velocity};

fn prepared(values: Vec<f64>, quantity: Quantity) -> Experiment {
    let record = Record::new(0.0, 1e-3, values, quantity, "m/s").unwrap();
    Experiment::ring_down(&record, &Preparation::default()).unwrap()
}

/// A few half swings of a sine, without any damping or noise.
fn sine(half_swings: f64) -> Vec<f64> {
    let count = (250.0 * half_swings) as u32;
    (0..count).map(|i| (std::f64::consts::PI * f64::from(i) / 250.0).sin()).collect()
}

#[test]
fn too_few_cycles() {
    let short = prepared(sine(3.0), Quantity::Velocity);
    assert!(matches!(decrements(&short), Err(IdentifyError::TooFew { found: 3, needed: 4, .. })));
    let windows = Windows::default().fit(&short);
    assert!(matches!(windows, Err(IdentifyError::TooFew { found: 3, needed: 11, .. })));
    assert!(Windows::default().with_cycles(usize::MAX).fit(&short).is_err());
    let two = prepared(sine(2.0), Quantity::Displacement);
    // As many equations as unknowns: an estimate, and nothing that could test it.
    assert_eq!(WeakForm::default().estimate(&two).unwrap().explained_noise, None);
    assert!(matches!(
        half_swing_losses_of(&two, &Oscillator::per_unit_mass(2.0).unwrap()),
        Err(IdentifyError::TooFew { .. })
    ));
    let record = velocity(sine(3.0));
    let once = WeakForm::default().estimate_between(&record, &[0.25, 0.5], None);
    assert!(matches!(once, Err(IdentifyError::TooFew { found: 1, needed: 2, .. })));
}

/// A motion without loss and without noise has neither damping nor uncertainty, and nothing that is not a number.
#[test]
fn no_noise_and_no_loss() {
    let endless = prepared(sine(24.0), Quantity::Velocity);
    for cycle in decrements(&endless).unwrap() {
        assert!(cycle.damping.value.abs() < 1e-6 && cycle.damping.uncertainty.is_finite(), "{cycle:?}");
        assert!(cycle.friction.value.abs() < 1e-6 && cycle.friction.uncertainty.is_finite(), "{cycle:?}");
    }
    for window in Windows::default().fit(&endless).unwrap() {
        assert!(window.damping.value.abs() < 1e-9 && window.damping.uncertainty < 1e-9, "{:?}", window.damping);
    }
    let weak = WeakForm::default().estimate(&endless).unwrap();
    assert!(weak.friction.value.abs() < 1e-3 && weak.friction.uncertainty.is_finite(), "{:?}", weak.friction);
    assert!(weak.damping.value.abs() < 1e-3 && weak.damping.uncertainty.is_finite(), "{:?}", weak.damping);
    for half_swing in half_swing_losses_of(&endless, &Oscillator::per_unit_mass(2.0).unwrap()).unwrap() {
        assert!(half_swing.friction.value.abs() < 1e-3 && half_swing.friction.uncertainty.is_finite());
    }
}

#[test]
fn wrong_quantities() {
    let force = velocity(sine(8.0)).with_quantity(Quantity::Force);
    let weak = WeakForm::default().estimate_between(&force, &[0.25, 0.5, 0.75], None);
    assert!(matches!(weak, Err(IdentifyError::WrongRecord { ref what }) if what.contains("force")));
    let displacement = prepared(sine(8.0), Quantity::Displacement);
    let quadratic = WeakForm::default().with_quadratic_damping().estimate(&displacement);
    assert!(matches!(quadratic, Err(IdentifyError::WrongRecord { ref what }) if what.contains("is: displacement")));
    let machine = Oscillator::per_unit_mass(2.0).unwrap();
    let method = EnergyMethod::new(machine, 0.0).unwrap();
    assert!(
        matches!(method.rates(displacement.record()), Err(IdentifyError::WrongRecord { ref what }) if what.contains("needs a velocity"))
    );
    assert!(matches!(
        half_swing_losses(displacement.record(), &machine, 0.0, &[0.0, 0.25]),
        Err(IdentifyError::WrongRecord { ref what }) if what.contains("needs a velocity")
    ));
    let error = quadratic.unwrap_err().to_string();
    assert_eq!(error, "quadratic damping by the weak form needs a velocity, but the record is: displacement");
}

#[test]
fn impossible_times_and_numbers() {
    let record = velocity(sine(8.0));
    for times in
        [&[0.25, 0.25, 0.5][..], &[0.5, 0.25, 0.75], &[-1.0, 0.5, 1.0], &[0.5, f64::NAN, 1.0], &[0.5, 1.0, 9.0]]
    {
        let weak = WeakForm::default().estimate_between(&record, times, None);
        assert!(matches!(weak, Err(IdentifyError::OutOfRange { .. })), "{times:?}: {weak:?}");
        let machine = Oscillator::per_unit_mass(2.0).unwrap();
        let energies = half_swing_losses(&record, &machine, 0.0, times);
        assert!(matches!(energies, Err(IdentifyError::OutOfRange { .. })), "{times:?}");
    }
    assert!(WeakForm::default().estimate_between(&record, &[0.25, 0.5, 0.75], Some(f64::NAN)).is_err());
    assert!(WeakForm::default().holding_damping(f64::NAN).is_err());
    assert!(WeakForm::default().holding_natural_frequency(0.0).is_err());
    let machine = Oscillator::per_unit_mass(2.0).unwrap();
    assert!(EnergyMethod::new(machine, f64::INFINITY).is_err());
    let method = EnergyMethod::new(machine, 0.0).unwrap();
    assert!(method.above(-1.0).is_err() && method.with_margin(f64::NAN).is_err());
    let wide = method.smoothed_by(Smoothing::SavitzkyGolay { span: usize::MAX, degree: 3 });
    assert!(matches!(wide.rates(&record), Err(IdentifyError::Record(_))));
    assert!(matches!(method.above(10.0).unwrap().rates(&record), Err(IdentifyError::TooFew { found: 0, .. })));
}

/// Two half swings hold five unknowns badly, and one equation too few is an error and no guess.
#[test]
fn too_few_equations() {
    let record = velocity(free(0.0, (0.02, 0.0), 3.0).velocity().values().to_vec());
    let half = 0.5 / 2.198_08;
    let times = [0.0, half, 2.0 * half];
    let found = WeakForm::default().estimate_between(&record, &times, None);
    assert!(matches!(found, Err(IdentifyError::TooFew { found: 2, needed: 3, .. })), "{found:?}");
}
