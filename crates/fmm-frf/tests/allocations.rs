//! After the construction, adding a trial allocates nothing.

use allocation_counter::measure;
use fmm_frf::{AverageOptions, Baseline, ExponentialWindow, ForceWindow, ResponseForm, Taper, TrialAverage};

/// A blow, and a response that is not the same twice.
fn trial(length: usize, k: usize) -> (Vec<f64>, Vec<f64>) {
    let force = (0..length).map(|i| if (10..14).contains(&i) { (k + 1) as f64 } else { 1e-3 * (i % 7) as f64 });
    (force.collect(), (0..length).map(|i| (0.1 * i as f64 + k as f64).sin()).collect())
}

#[test]
fn adding_a_trial_allocates_nothing() {
    let everything = AverageOptions::default()
        .taper(Taper::Hann)
        .force_window(ForceWindow::new(0.005, 0.02).unwrap())
        .exponential_window(ExponentialWindow::new(3.0).unwrap())
        .force_baseline(Baseline::MeanOf(0..8))
        .response_baseline(Baseline::Mean)
        .keeping_ratios();
    for (what, options) in [("no options", AverageOptions::default()), ("all options", everything)] {
        // One even length of small factors, one odd, one prime.
        for length in [1000, 1125, 1009] {
            let mut average = TrialAverage::new(ResponseForm::Mobility, 1000.0, length, &options).unwrap();
            let trials: Vec<_> = (0..3).map(|k| trial(length, k)).collect();
            for (k, (force, response)) in trials.iter().enumerate() {
                let counted = measure(|| average.add(force, response).unwrap());
                assert_eq!(counted.count_total, 0, "{what}, {length} samples, trial {k}: {counted:?}");
            }
            // A refused trial nothing but what it says, and a new test with the same plan nothing.
            let damaged = vec![f64::NAN; length];
            let counted = measure(|| assert!(average.add(&trials[0].0, &damaged).is_err()));
            assert_eq!(counted.count_total, 1, "only the message: {counted:?}");
            let counted = measure(|| average.clear());
            assert_eq!(counted.count_total, 0, "{counted:?}");
        }
    }
    // The counter counts.
    let average = TrialAverage::new(ResponseForm::Mobility, 1000.0, 1000, &AverageOptions::default()).unwrap();
    assert!(measure(|| assert!(average.trials() == 0)).count_total == 0);
    assert!(measure(|| drop(average.frequencies().to_vec())).count_total > 0);
}
