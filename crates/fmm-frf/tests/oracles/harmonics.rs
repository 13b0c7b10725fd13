//! Mobilities of simulated impacts with dry friction, at lines around nine multiples of the natural frequency.

use std::f64::consts::TAU;

use fmm_frf::{FrequencyResponse, FrfError, FrictionSpectrum, ResponseForm, SingleDegreeOfFreedom};

use crate::table::{complex, rows};

fn machine() -> SingleDegreeOfFreedom {
    SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0).unwrap()
}

/// Mobility of the impacts of 0.98, 1.42 and 1.64 N s.
fn mobilities() -> [FrequencyResponse; 3] {
    let rows = rows(include_str!("../data/coulomb_impact_mobility.csv"), 0);
    [1, 3, 5].map(|column| {
        let frequencies = rows.iter().map(|row| row[0]).collect();
        let values = rows.iter().map(|row| complex(row, column)).collect();
        FrequencyResponse::new(ResponseForm::Mobility, frequencies, values).unwrap()
    })
}

#[test]
fn friction_has_odd_harmonics_only() {
    let fundamental = machine().natural_angular_frequency() / TAU;
    for (mobility, impulse) in mobilities().iter().zip([0.98, 1.42, 1.64]) {
        let linear = machine().frequency_response(ResponseForm::Mobility, mobility.frequencies()).unwrap();
        let spectrum = FrictionSpectrum::of(mobility, &linear).unwrap();
        let harmonics = spectrum.harmonics(fundamental, 9).unwrap();
        // A square wave has 1/n: 20 log10 n dB below the fundamental.
        for (order, level) in [(3, -9.5), (5, -14.0), (7, -16.9), (9, -19.0)] {
            let found = harmonics[order - 1];
            assert_eq!(found.order as usize, order);
            assert!((found.level - level).abs() < 0.2, "{impulse} N s, order {order}: {} dB", found.level);
            assert!((found.level + 20.0 * (order as f64).log10()).abs() < 0.2, "order {order}: {} dB", found.level);
        }
        for order in [2, 4, 6, 8] {
            let found = harmonics[order - 1];
            assert!(found.level < -22.0, "{impulse} N s, order {order}: {} dB", found.level);
            assert!(found.deviation.abs() < 0.065, "{impulse} N s, order {order}: {} dB", found.deviation);
        }
        // As deviations from the linear mobility the odd ones alternate.
        for (order, deviation) in [(3, 2.4), (5, -1.8), (7, 1.1), (9, -0.9)] {
            let found = harmonics[order - 1].deviation;
            assert!((found - deviation).abs() < 0.1, "{impulse} N s, order {order}: {found} dB");
        }
        let ratio = spectrum.odd_by_even(fundamental, 9).unwrap();
        assert!(ratio > 4.0, "{impulse} N s: odd by even {ratio}");
    }
}

#[test]
fn a_linear_machine_has_no_harmonics() {
    let fundamental = machine().natural_angular_frequency() / TAU;
    let lines = mobilities()[0].frequencies().to_vec();
    let linear = machine().frequency_response(ResponseForm::Mobility, &lines).unwrap();
    // The model of the machine is off by 1 % in mass, which is the same error at odd and even multiples.
    let model = SingleDegreeOfFreedom::new(10.495, 0.275, 1982.0).unwrap();
    let model = model.frequency_response(ResponseForm::Mobility, &lines).unwrap();
    let ratio = FrictionSpectrum::of(&linear, &model).unwrap().odd_by_even(fundamental, 9).unwrap();
    assert!((0.4..2.4).contains(&ratio), "odd by even {ratio}");
    // And nothing at all is left of the right model.
    let same = FrictionSpectrum::of(&linear, &linear).unwrap();
    assert!(matches!(same.harmonics(fundamental, 9), Err(FrfError::Outside { .. })));
}

/// The highest line of the receptance, as the summary of the simulation has it.
#[test]
fn receptance_peaks() {
    let expected =
        [(2.151_515, 3.511_459_465_303e-3), (2.181_818, 5.037_386_071_112e-3), (2.181_818, 5.793_328_079_192e-3)];
    for (mobility, (frequency, magnitude)) in mobilities().iter().zip(expected) {
        let (at, found) = mobility.converted(ResponseForm::Receptance).unwrap().peak().unwrap();
        assert!((at - frequency).abs() < 1e-6, "{at} Hz, not {frequency} Hz");
        // The mobility has 15 digits.
        assert!((found / magnitude - 1.0).abs() < 1e-12, "{found} m/N, not {magnitude} m/N");
    }
}

#[test]
fn impossible_spectra_are_refused() {
    let [low, ..] = mobilities();
    let fundamental = machine().natural_angular_frequency() / TAU;
    let linear = |lines: &[f64]| machine().frequency_response(ResponseForm::Mobility, lines).unwrap();
    let shorter = linear(&low.frequencies()[1..]);
    assert!(
        matches!(FrictionSpectrum::of(&low, &shorter), Err(FrfError::Mismatch { what }) if what.ends_with("line 0 on"))
    );
    let receptance = linear(low.frequencies()).converted(ResponseForm::Receptance).unwrap();
    assert!(matches!(FrictionSpectrum::of(&low, &receptance), Err(FrfError::Mismatch { .. })));
    let zero = linear(&[0.0, 1.0]);
    assert!(matches!(FrictionSpectrum::of(&zero, &zero), Err(FrfError::NotDefined { frequency: 0.0, .. })));
    let spectrum = FrictionSpectrum::of(&low, &linear(low.frequencies())).unwrap();
    for (frequency, order) in [(0.0, 3), (f64::NAN, 3), (1.0, 3), (fundamental, 10)] {
        assert!(spectrum.harmonics(frequency, order).is_err(), "{frequency} Hz, order {order}");
    }
}
