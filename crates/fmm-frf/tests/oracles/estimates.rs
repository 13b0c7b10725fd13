//! Responses, coherence and densities against numpy, scipy and pyFRF.

use fmm_frf::{
    AverageOptions, Baseline, Complex64, Estimator, ExponentialWindow, ForceWindow, FrequencyResponse, ResponseForm,
    Taper, TrialAverage,
};

use crate::table::{Recording, complex, impact, impacts, rows};

/// The value of `response` at `frequency` (Hz), one of its lines.
fn at(response: &FrequencyResponse, frequency: f64) -> Complex64 {
    let line = response.frequencies().iter().position(|line| (line - frequency).abs() < 1e-9);
    response.values()[line.unwrap_or_else(|| panic!("no line at {frequency} Hz"))]
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{what}: {found}, not {expected}");
}

#[test]
fn four_impacts() {
    let average = impacts(&AverageOptions::default().keeping_ratios());
    let estimators = [(1, Estimator::MeanOfRatios), (3, Estimator::H1), (5, Estimator::H2), (7, Estimator::Hv)];
    let found = estimators.map(|(column, estimator)| (column, estimator, average.estimate(estimator).unwrap()));
    let coherence = average.coherence().unwrap();
    let (force, velocity) = (average.force_density().unwrap(), average.response_density().unwrap());
    let rows = rows(include_str!("../data/impact4_frf.csv"), 0);
    assert_eq!(rows.len(), 92);
    // All values are relative to the largest, as the two transforms round to that.
    let largest = |column: usize| rows.iter().map(|row| complex(row, column).norm()).fold(0.0, f64::max);
    for (column, estimator, response) in &found {
        let scale = largest(*column);
        for row in &rows {
            let (found, expected) = (at(response, row[0]), complex(row, *column));
            let error = (found - expected).norm() / scale;
            assert!(error < 1e-12, "{estimator:?} at {} Hz: {found}, not {expected}: {error:.1e}", row[0]);
        }
    }
    for row in &rows {
        let line = (row[0] * 16.0).round() as usize;
        assert!((coherence.values()[line] - row[9]).abs() < 1e-12, "coherence at {} Hz", row[0]);
        close(force[line], row[12], 1e-12, "N²/Hz of the force");
        // Lines of little response are rounded by those of much.
        assert!((velocity[line] - row[13]).abs() < 1e-12 * row[13] + 1e-18, "{} at {} Hz", velocity[line], row[0]);
    }
    assert_eq!(coherence.averages(), 4.0);
    // What the stored solution of the machine says: 0.5 N of noise on blows of 1 N s.
    for row in rows.iter().filter(|row| (0.5..10.0).contains(&row[0])) {
        let (found, truth) = (at(&found[1].2, row[0]), complex(row, 10));
        assert!((found - truth).norm() < 0.011 * truth.norm(), "H1 at {} Hz: {found}, not {truth}", row[0]);
    }
}

/// Im H < 0 and Re(iω H) > 0 for a passive machine.
#[test]
fn the_sign_is_that_of_a_passive_machine() {
    let mobility = impacts(&AverageOptions::default()).estimate(Estimator::H1).unwrap().within(1.0, 4.0).unwrap();
    assert!(mobility.values().iter().all(|value| value.re > 0.0));
    let receptance = mobility.converted(ResponseForm::Receptance).unwrap();
    assert!(receptance.values().iter().all(|value| value.im < 0.0));
}

/// The scatter over trials tells how far H1 is from the truth; four trials tell it to a factor.
#[test]
fn uncertainties_cover_the_truth() {
    let average = impacts(&AverageOptions::default().keeping_ratios().within(0.5, 10.0).unwrap());
    for estimator in [Estimator::H1, Estimator::H2, Estimator::Hv, Estimator::MeanOfRatios] {
        let response = average.estimate(estimator).unwrap();
        let uncertainty = average.uncertainty(estimator).unwrap();
        let truth = fmm_frf::SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0).unwrap();
        let truth = truth.frequency_response(ResponseForm::Mobility, response.frequencies()).unwrap();
        let lines = response.values().iter().zip(truth.values()).zip(&uncertainty);
        let squares = lines.map(|((found, truth), u)| (found - truth).norm_sqr() / (2.0 * u * u));
        let mut squares: Vec<f64> = squares.collect();
        squares.sort_by(f64::total_cmp);
        // |error|²/2u² is F distributed with 2 and 2(n − 1) = 6 degrees of freedom: the median is 0.78.
        let median = squares[squares.len() / 2];
        assert!((0.4..1.5).contains(&median), "{estimator:?}: median of squared errors {median}");
    }
}

fn welch(taper: Taper) -> TrialAverage {
    let options =
        AverageOptions::default().taper(taper).force_baseline(Baseline::Mean).response_baseline(Baseline::Mean);
    let mut average = TrialAverage::new(ResponseForm::Mobility, 128.0, 2048, &options).unwrap();
    let recording = Recording::read("random.mat");
    let (force, velocity) = (recording.channel("force", 1e5), recording.channel("velocity", 1e8));
    assert_eq!(average.add_segments(&force, &velocity, 1024).unwrap(), 15);
    average
}

#[test]
fn random_force_with_the_periodic_window() {
    let average = welch(Taper::Hann);
    let (h1, h2) = (average.estimate(Estimator::H1).unwrap(), average.estimate(Estimator::H2).unwrap());
    let (force, velocity) = (average.force_density().unwrap(), average.response_density().unwrap());
    let coherence = average.coherence().unwrap();
    let rows = rows(include_str!("../data/random_welch_periodic.csv"), 0);
    let largest = rows.iter().map(|row| complex(row, 3).norm()).fold(0.0, f64::max);
    for row in &rows {
        let line = (row[0] * 16.0).round() as usize;
        close(force[line], row[1], 1e-11, "N²/Hz of the force");
        assert!((velocity[line] - row[2]).abs() < 1e-11 * row[2] + 1e-18, "{} at {} Hz", velocity[line], row[0]);
        assert!((at(&h1, row[0]) - complex(row, 3)).norm() < 1e-11 * largest, "H1 at {} Hz", row[0]);
        let expected = complex(row, 5);
        // H2 divides by a cross spectrum that is nearly nothing where the coherence is low.
        let error = (at(&h2, row[0]) - expected).norm() / expected.norm();
        assert!(error < 1e-11 / row[7], "H2 at {} Hz: {error:.1e}", row[0]);
        assert!((coherence.values()[line] - row[7]).abs() < 1e-11, "coherence at {} Hz", row[0]);
    }
}

#[test]
fn random_force_with_the_symmetric_window() {
    let average = welch(Taper::SymmetricHann);
    let (h1, coherence) = (average.estimate(Estimator::H1).unwrap(), average.coherence().unwrap());
    let periodic = welch(Taper::Hann).estimate(Estimator::H1).unwrap();
    let rows = rows(include_str!("../data/random_welch_symmetric.csv"), 0);
    let largest = rows.iter().map(|row| complex(row, 1).norm()).fold(0.0, f64::max);
    let mut difference = 0.0f64;
    for row in &rows {
        let expected = complex(row, 1);
        assert!((at(&h1, row[0]) - expected).norm() < 1e-11 * largest, "H1 at {} Hz", row[0]);
        assert!((coherence.values()[(row[0] * 16.0).round() as usize] - row[3]).abs() < 1e-11, "at {} Hz", row[0]);
        difference = difference.max((at(&periodic, row[0]) - expected).norm() / expected.norm());
    }
    assert!(difference > 1e-3, "the two windows must differ somewhere, but do so by {difference:.1e} at most");
}

/// The second impact cut off after 4 s: force window over 102 samples, exponential window to 1 % on both.
pub(crate) fn truncated() -> FrequencyResponse {
    let window = ExponentialWindow::reaching(0.01, 2047.0 / 512.0).unwrap();
    let options = AverageOptions::default()
        .force_window(ForceWindow::new(0.0, 102.0 / 512.0).unwrap())
        .exponential_window(window)
        .within(0.0, 8.0)
        .unwrap();
    let mut average = TrialAverage::new(ResponseForm::Mobility, 512.0, 2048, &options).unwrap();
    let (force, velocity) = impact(2);
    average.add(&force[..2048], &velocity[..2048]).unwrap();
    average.estimate(Estimator::H1).unwrap()
}

#[test]
fn exponential_window() {
    let found = truncated();
    let rows = rows(include_str!("../data/expwindow.csv"), 0);
    assert_eq!(found.frequencies().len(), rows.len());
    let largest = rows.iter().map(|row| complex(row, 1).norm()).fold(0.0, f64::max);
    for row in &rows {
        let (value, expected) = (at(&found, row[0]), complex(row, 1));
        assert!((value - expected).norm() < 1e-12 * largest, "at {} Hz: {value}, not {expected}", row[0]);
        // Against the machine at σ + iω: noise of 0.5 N and 0.2 mm/s.
        assert!((value - complex(row, 3)).norm() < 0.03 * largest, "at {} Hz", row[0]);
    }
    assert!((found.decay_rate() - 1.151_854_975_684_368_6).abs() < 1e-15);
}
