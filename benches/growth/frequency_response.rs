//! Frequency responses: samples of a trial, and the primes in their number.

use fmm_frf::{AverageOptions, Estimator, ResponseForm, TrialAverage};

use crate::least::Unit::Microsecond;
use crate::least::{least, print_row};

/// A blow and the decay that follows it.
fn trial(samples: usize) -> (Vec<f64>, Vec<f64>) {
    let noise = |i: usize| (i * 7919 % 1009) as f64 / 1009.0 - 0.5;
    let force = (0..samples).map(|i| if i < 20 { 1000.0 } else { 0.0 } + noise(i)).collect();
    let velocity = (0..samples).map(|i| (-1e-3 * i as f64).exp() * (0.05 * i as f64).cos() + 1e-3 * noise(i + 7));
    (force, velocity.collect())
}

fn average(samples: usize) -> TrialAverage {
    TrialAverage::new(ResponseForm::Mobility, 1e4, samples, &AverageOptions::default()).expect("valid")
}

pub(crate) fn print_rows() {
    let added = |samples| {
        let ((force, velocity), mut average) = (trial(samples), average(samples));
        least(|| average.add(&force, &velocity).is_ok())
    };
    print_row(
        "a trial of two channels, samples",
        Microsecond,
        &[1024, 4096, 16_384, 65_536, 262_144, 1_048_576],
        added,
    );
    print_row("330 000 = 2⁴ · 3 · 5⁴ · 11, and a prime", Microsecond, &[330_000, 330_017], added);
    print_row("a power of two, and a prime", Microsecond, &[32_768, 32_771], added);
    print_row("`H1` of such trials, samples", Microsecond, &[330_000], |samples| {
        let ((force, velocity), mut average) = (trial(samples), average(samples));
        for _ in 0..3 {
            average.add(&force, &velocity).expect("valid");
        }
        least(|| average.estimate(Estimator::H1).is_ok())
    });
}
