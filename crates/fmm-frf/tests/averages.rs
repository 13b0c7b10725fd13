//! How trials are added, weighed and refused.

use fmm_frf::{
    AverageOptions, Baseline, Complex64, Estimator, ExponentialWindow, ForceWindow, FrfError, ResponseForm,
    TrialAverage,
};
use fmm_record::{Quantity, Record};

const LENGTH: usize = 64;
const RATE: f64 = 32.0;

/// Repeatable numbers between −1/2 and 1/2, by the mixing function of splitmix64.
fn noise(seed: usize) -> impl Fn(usize) -> f64 {
    move |i| {
        let mut z = (((seed << 20) + i) as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}

fn trial(seed: usize) -> (Vec<f64>, Vec<f64>) {
    let (force, response) = (noise(seed), noise(seed + 50));
    ((0..LENGTH).map(&force).collect(), (0..LENGTH).map(|i| 3.0 * force(i) + 0.1 * response(i)).collect())
}

fn average(options: &AverageOptions) -> TrialAverage {
    TrialAverage::new(ResponseForm::Mobility, RATE, LENGTH, options).unwrap()
}

fn of(options: &AverageOptions, seeds: impl IntoIterator<Item = usize>) -> TrialAverage {
    let mut average = average(options);
    for seed in seeds {
        let (force, response) = trial(seed);
        average.add(&force, &response).unwrap();
    }
    average
}

/// Plain sums over k of x e^{−2πi jk/N}.
fn transform(samples: &[f64], line: usize) -> Complex64 {
    let angle = |i: usize| -std::f64::consts::TAU * (line * i % samples.len()) as f64 / samples.len() as f64;
    samples.iter().enumerate().map(|(i, x)| Complex64::from_polar(*x, angle(i))).sum()
}

#[test]
fn estimates_are_their_definitions() {
    let average = of(&AverageOptions::default().keeping_ratios(), 0..3);
    let estimates = [Estimator::H1, Estimator::H2, Estimator::Hv, Estimator::MeanOfRatios]
        .map(|estimator| average.estimate(estimator).unwrap());
    let uncertainties = [Estimator::H1, Estimator::MeanOfRatios].map(|e| average.uncertainty(e).unwrap());
    for (line, (u_h1, u_ratio)) in uncertainties[0].iter().zip(&uncertainties[1]).enumerate() {
        let pairs: Vec<_> = (0..3).map(trial).map(|(f, v)| (transform(&f, line), transform(&v, line))).collect();
        let ff: f64 = pairs.iter().map(|(f, _)| f.norm_sqr()).sum();
        let vv: f64 = pairs.iter().map(|(_, v)| v.norm_sqr()).sum();
        let fv: Complex64 = pairs.iter().map(|(f, v)| f.conj() * v).sum();
        let ratio: Complex64 = pairs.iter().map(|(f, v)| v / f).sum::<Complex64>() / 3.0;
        let expected = [fv / ff, vv / fv.conj(), fv / fv.norm() * (vv / ff).sqrt(), ratio];
        for (estimate, expected) in estimates.iter().zip(expected) {
            // 64 terms per transform.
            let error = (estimate.values()[line] - expected).norm() / expected.norm();
            assert!(error < 1e-12, "line {line}: {error:.1e}");
        }
        // Residual scatter of the regression of V on F, and the scatter of the ratios.
        let residual: f64 = pairs.iter().map(|(f, v)| (v - f * (fv / ff)).norm_sqr()).sum();
        let scatter: f64 = pairs.iter().map(|(f, v)| (v / f - ratio).norm_sqr()).sum();
        for (found, expected) in [(u_h1, (residual / ff / 4.0).sqrt()), (u_ratio, (scatter / 12.0).sqrt())] {
            // Both come out as small differences: γ² is 0.999.
            assert!((found / expected - 1.0).abs() < 1e-9, "line {line}: u = {found}, not {expected}");
        }
    }
}

#[test]
fn trials_can_be_added_later_and_forgotten() {
    let mut early = of(&AverageOptions::default(), 0..2);
    let before = early.estimate(Estimator::H1).unwrap();
    let (force, response) = trial(2);
    early.add(&force, &response).unwrap();
    let all = of(&AverageOptions::default(), 0..3);
    assert_eq!(early.estimate(Estimator::H1), all.estimate(Estimator::H1));
    assert_ne!(early.estimate(Estimator::H1).unwrap(), before);
    early.clear();
    assert_eq!(early.trials(), 0);
    assert!(matches!(early.estimate(Estimator::H1), Err(FrfError::TooFew { what }) if what.contains("no trial")));
    assert!(matches!(early.coherence(), Err(FrfError::TooFew { .. })));
    for seed in 0..2 {
        let (force, response) = trial(seed);
        early.add(&force, &response).unwrap();
    }
    assert_eq!(early.estimate(Estimator::H1).unwrap(), before);
}

#[test]
fn a_refused_trial_changes_nothing() {
    let mut average = of(&AverageOptions::default().keeping_ratios(), 0..2);
    let before = (average.estimate(Estimator::H1).unwrap(), average.estimate(Estimator::MeanOfRatios).unwrap());
    let (force, response) = trial(7);
    let with = |samples: &[f64], at: usize, value: f64| {
        let mut samples = samples.to_vec();
        samples[at] = value;
        samples
    };
    let trials = [
        (with(&force, 3, f64::NAN), response.clone(), "sample 3 of the force must be finite, but is NaN"),
        (force.clone(), with(&response, 63, f64::INFINITY), "sample 63 of the response must be finite, but is inf"),
        (
            force.clone(),
            with(&response, 0, 1e200),
            "the samples of the response are so large that their squares overflow",
        ),
        (
            vec![0.0; LENGTH],
            response.clone(),
            "the force of the trial is zero from start to end, or so small that its square is; there is no impact",
        ),
        (vec![1.0; LENGTH], response.clone(), "no trial has force at 0.5 Hz; average over a band without this line"),
        (force[1..].to_vec(), response.clone(), "the force needs 64 samples, but has 63"),
        (force.clone(), Vec::new(), "the response needs 64 samples, but has 0"),
    ];
    for (force, response, expected) in trials {
        assert_eq!(average.add(&force, &response).unwrap_err().to_string(), expected);
    }
    let after = (average.estimate(Estimator::H1).unwrap(), average.estimate(Estimator::MeanOfRatios).unwrap());
    assert_eq!((before, 2), (after, average.trials()));
}

#[test]
fn records_must_fit() {
    let mut average = average(&AverageOptions::default());
    let (force, response) = trial(0);
    let record = |rate: f64, values: &[f64], quantity| Record::sampled(rate, values.to_vec(), quantity, "").unwrap();
    let (f, v) = (record(RATE, &force, Quantity::Force), record(RATE, &response, Quantity::Velocity));
    average.add_records(&f, &v).unwrap();
    let slower = record(RATE / 2.0, &response, Quantity::Velocity);
    let error = average.add_records(&f, &slower).unwrap_err();
    assert!(error.to_string().starts_with(&format!("the response was sampled at {} Hz", RATE / 2.0)), "{error}");
    assert!(
        matches!(average.add_records(&v, &v), Err(FrfError::Mismatch { what }) if what.contains("the force must be"))
    );
    let acceleration = record(RATE, &response, Quantity::Acceleration);
    assert!(
        matches!(average.add_records(&f, &acceleration), Err(FrfError::Mismatch { what }) if what.contains("the response must be"))
    );
    let late = v.clone().starting_at(0.5).unwrap();
    assert!(
        matches!(average.add_records(&f, &late), Err(FrfError::Mismatch { what }) if what.contains("begin at 0 s and 0.5 s"))
    );
    assert_eq!(average.trials(), 1);
}

#[test]
fn lines_without_force_or_response_have_no_estimate() {
    // A constant force is at zero frequency only.
    let mut constant = average(&AverageOptions::default());
    constant.add(&[1.0; LENGTH], &trial(0).1).unwrap();
    assert!(matches!(constant.estimate(Estimator::H1), Err(FrfError::NotDefined { frequency: 0.5, .. })));
    let mut narrow = average(&AverageOptions::default().within(0.0, 0.4).unwrap());
    narrow.add(&[1.0; LENGTH], &[2.0; LENGTH]).unwrap();
    assert_eq!(narrow.estimate(Estimator::H1).unwrap().values(), [Complex64::new(2.0, 0.0)]);

    let mut silent = average(&AverageOptions::default());
    silent.add(&trial(0).0, &[0.0; LENGTH]).unwrap();
    assert!(silent.estimate(Estimator::H1).unwrap().values().iter().all(|value| value.norm() == 0.0));
    assert!(matches!(silent.estimate(Estimator::H2), Err(FrfError::NotDefined { frequency: 0.0, .. })));
    assert!(silent.estimate(Estimator::Hv).is_err() && silent.coherence().is_err());
    assert!(matches!(silent.estimate(Estimator::MeanOfRatios), Err(FrfError::Outside { .. })));
    assert!(
        matches!(silent.uncertainty(Estimator::H1), Err(FrfError::TooFew { what }) if what.ends_with("there is 1"))
    );
    silent.add(&trial(1).0, &[0.0; LENGTH]).unwrap();
    assert!(silent.uncertainty(Estimator::H1).unwrap().iter().all(|u| *u == 0.0));
}

#[test]
fn one_trial_has_a_coherence_that_says_nothing() {
    let one = of(&AverageOptions::default(), 0..1);
    let coherence = one.coherence().unwrap();
    assert!(!coherence.is_meaningful() && coherence.values().iter().all(|value| (value - 1.0).abs() < 1e-14));
    // Of two channels without connection, n averages show 1/n.
    let mut apart = average(&AverageOptions::default());
    for seed in 0..20 {
        apart.add(&trial(seed).0, &trial(seed + 300).0).unwrap();
    }
    let coherence = apart.coherence().unwrap();
    let mean = coherence.values().iter().sum::<f64>() / coherence.values().len() as f64;
    assert!((0.02..0.1).contains(&mean), "mean coherence of nothing {mean}");
}

#[test]
fn bands_and_lengths() {
    for length in [2, 3, 63, 64] {
        let mut any = TrialAverage::new(ResponseForm::Mobility, 1.0, length, &AverageOptions::default()).unwrap();
        let (force, response) = trial(3);
        any.add(&force[..length], &response[..length]).unwrap();
        assert_eq!(any.frequencies().len(), length / 2 + 1);
        let density = any.force_density().unwrap();
        // Parseval: lines of 1/N Hz hold the mean square.
        let mean_square = force[..length].iter().map(|f| f * f).sum::<f64>() / length as f64;
        let sum = density.iter().sum::<f64>() / length as f64;
        assert!((sum / mean_square - 1.0).abs() < 1e-13, "{length} samples: {sum} N², not {mean_square} N²");
    }
    let whole = of(&AverageOptions::default(), 0..2);
    let options = AverageOptions::default().within(1.5, 4.0).unwrap();
    let band = of(&options, 0..2);
    assert_eq!(band.frequencies(), [1.5, 2.0, 2.5, 3.0, 3.5, 4.0]);
    let (whole, band) = (whole.estimate(Estimator::H1).unwrap(), band.estimate(Estimator::H1).unwrap());
    assert_eq!(whole.within(1.5, 4.0).unwrap(), band);
    let new = |rate, length, options: &AverageOptions| TrialAverage::new(ResponseForm::Mobility, rate, length, options);
    for (low, high) in [(20.0, 30.0), (1.1, 1.2)] {
        let options = AverageOptions::default().within(low, high).unwrap();
        let error = new(RATE, LENGTH, &options).unwrap_err().to_string();
        assert_eq!(error, format!("no line lies between {low} Hz and {high} Hz"));
    }
    for (low, high) in [(2.0, 1.0), (f64::NAN, 1.0), (-2.0, -1.0)] {
        assert!(AverageOptions::default().within(low, high).is_err(), "{low} Hz to {high} Hz");
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
        assert!(new(rate, LENGTH, &AverageOptions::default()).is_err(), "{rate} Hz");
    }
    for length in [0, 1] {
        assert!(new(RATE, length, &AverageOptions::default()).is_err(), "{length} samples");
    }
    let window = AverageOptions::default().force_window(ForceWindow::new(10.0, 11.0).unwrap());
    assert!(matches!(new(RATE, LENGTH, &window), Err(FrfError::Outside { .. })));
}

#[test]
fn segments() {
    let (mut force, mut response) = trial(1);
    let (more_force, more_response) = trial(2);
    force.extend(more_force);
    response.extend(more_response);
    let mut average = average(&AverageOptions::default());
    assert_eq!(average.add_segments(&force, &response, 0).unwrap(), 2);
    assert_eq!(average.estimate(Estimator::H1), of(&AverageOptions::default(), 1..3).estimate(Estimator::H1));
    assert_eq!(average.add_segments(&force[..100], &response[..100], 32).unwrap(), 2);
    assert!(matches!(average.add_segments(&force, &response, LENGTH), Err(FrfError::Outside { .. })));
    assert!(average.add_segments(&force[..9], &response[..9], 0).is_err());
    assert!(average.add_segments(&force, &response[1..], 0).is_err());
    assert_eq!(average.trials(), 4);
}

/// Offsets go before windows: a windowed offset would be a pulse.
#[test]
fn offsets_and_windows() {
    let (force, response) = trial(4);
    let shifted: Vec<f64> = force.iter().map(|f| f + 8.0).collect();
    let window = ForceWindow::new(0.25, 0.75).unwrap();
    let plain = AverageOptions::default().force_window(window);
    let corrected = plain.clone().force_baseline(Baseline::Offset(8.0));
    let estimate = |options: &AverageOptions, force: &[f64]| {
        let mut average = average(options);
        average.add(force, &response).unwrap();
        average.estimate(Estimator::H1).unwrap()
    };
    for (found, expected) in estimate(&corrected, &shifted).values().iter().zip(estimate(&plain, &force).values()) {
        // Adding and taking away 8 N rounds by 1e-15 N, and the least line of the force has 1e-2 of the largest.
        assert!((found - expected).norm() < 1e-11 * expected.norm(), "{found}, not {expected}");
    }
    let exponential = AverageOptions::default().exponential_window(ExponentialWindow::new(0.7).unwrap());
    assert_eq!(estimate(&exponential, &force).decay_rate(), 0.7);
    let wrong = AverageOptions::default().force_baseline(Baseline::MeanOf(60..70));
    let error = average(&wrong).add(&force, &response).unwrap_err();
    assert!(
        error.to_string().contains(&format!("samples 60 to 70 (excluded), but the record has {LENGTH}")),
        "{error}"
    );
}
