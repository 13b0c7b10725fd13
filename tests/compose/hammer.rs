//! Hammer blows that others recorded, against values that other programs found.

use std::path::PathBuf;

use fmm_frf::{
    AverageOptions, Background, Baseline, Estimator, Pulse, RationalFit, ResponseForm, TrialAverage, impulse,
};
use fmm_record::Reader;
use fmm_record::{Quantity, Record};

use crate::real_records::data;

/// Force (N) and acceleration (m/s²) of three blows, at 25.6 kHz for 1 s.
fn blows() -> [(Record, Record); 3] {
    [1, 2, 3].map(|hit| {
        let path: PathBuf = data(&format!("hammer_{hit}.mat"));
        let read = |channel: &str, quantity, unit: &str| {
            Reader::default().channel(channel).quantity(quantity).unit(unit).read(&path).unwrap().record
        };
        (read("force", Quantity::Force, "N"), read("acceleration", Quantity::Acceleration, "m/s²"))
    })
}

fn average(blows: &[(Record, Record)], options: &AverageOptions) -> TrialAverage {
    let mut average = TrialAverage::new(ResponseForm::Accelerance, 25_600.0, 25_600, options).unwrap();
    for (force, acceleration) in blows {
        average.add_records(force, acceleration).unwrap();
    }
    average
}

/// Over the samples from 40 before the highest to 60 after it, less the mean of the last fifth.
#[test]
fn impulses() {
    for ((force, _), expected) in blows().iter().zip([0.012_196, 0.014_632, 0.014_924]) {
        let quiet = Baseline::MeanOf(20_480..25_600);
        let pulse = Pulse::of(force.values(), force.interval(), quiet.clone()).unwrap();
        assert!(pulse.further_hits.is_empty() && pulse.overload.is_none(), "{pulse:?}");
        assert!((1.5e-4..2e-4).contains(&pulse.width), "{} s", pulse.width);
        let peak = (pulse.time / force.interval()).round() as usize;
        let mean = force.values()[20_480..].iter().sum::<f64>() / 5120.0;
        let around = &force.values()[peak.saturating_sub(40)..peak + 60];
        let found = impulse(around, force.interval(), Baseline::Offset(mean)).unwrap();
        assert!((found - expected).abs() < 1e-6, "{found} N s, not {expected} N s");
        // The pulse alone misses only what the sensor rings after it.
        assert!((pulse.impulse / expected - 1.0).abs() < 0.02, "{} N s, not {expected} N s", pulse.impulse);
    }
}

#[test]
fn resonances_and_coherence() {
    let average = average(&blows(), &AverageOptions::default());
    let (h1, coherence) = (average.estimate(Estimator::H1).unwrap(), average.coherence().unwrap());
    let found = h1.within(100.0, 5000.0).unwrap().resonances(25.0);
    for (frequency, magnitude) in [(810.0, 134.0), (900.0, 459.0), (2640.0, 321.0), (3669.0, 3004.0), (4128.0, 2616.0)]
    {
        let peak = found.iter().find(|peak| (peak.frequency - frequency).abs() < 0.5);
        let peak = peak.unwrap_or_else(|| panic!("no resonance at {frequency} Hz in {found:?}"));
        assert!((peak.magnitude - magnitude).abs() < 0.5, "{frequency} Hz: {} 1/kg", peak.magnitude);
        let there = coherence.values()[frequency as usize];
        assert!((0.998..=1.0).contains(&there), "coherence {there} at {frequency} Hz");
        // Between the lines, by a fit to the ten nearest.
        let fit = RationalFit::of(&h1, frequency - 5.0, frequency + 5.0, Background::OtherModes).unwrap();
        let mode = fit;
        assert!((mode.natural_frequency.value - frequency).abs() < 1.0, "{mode}");
        assert!((1e-4..2e-3).contains(&mode.damping_ratio.value), "{mode}");
    }
    let median = coherence.median(100.0, 3000.0).unwrap();
    assert!((median - 0.9994).abs() < 5e-5, "median coherence {median}");
    // H1 = γ² H2, line by line.
    let h2 = average.estimate(Estimator::H2).unwrap();
    for ((h1, h2), coherence) in h1.values().iter().zip(h2.values()).zip(coherence.values()) {
        assert!((h1 - h2 * coherence).norm() < 1e-12 * h2.norm(), "{h1} and {h2} with γ² = {coherence}");
    }
}

/// The uncertainty of two blows covers the third where it should: in about half of the lines within the median of F(2,
/// 2).
#[test]
fn uncertainty_of_the_response() {
    let blows = blows();
    let band = AverageOptions::default().within(200.0, 3000.0).unwrap();
    let (all, one) = (average(&blows, &band), average(&blows[2..], &band));
    let (h1, third) = (all.estimate(Estimator::H1).unwrap(), one.estimate(Estimator::H1).unwrap());
    let u = all.uncertainty(Estimator::H1).unwrap();
    let lines = h1.values().iter().zip(third.values()).zip(&u);
    // A blow of three differs from their mean by √2 standard uncertainties of the mean, in each of two components.
    let mut squares: Vec<f64> = lines.map(|((mean, third), u)| (mean - third).norm_sqr() / (4.0 * u * u)).collect();
    squares.sort_by(f64::total_cmp);
    let median = squares[squares.len() / 2];
    assert!((0.2..2.0).contains(&median), "median of squared deviations {median}");
}
