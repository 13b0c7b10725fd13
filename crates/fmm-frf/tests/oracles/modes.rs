//! Modal estimates of the four impacts (m = 10.391 kg, c = 8 N s/m, k = 1982 N/m, noise on both channels), against
//! independent fits of the same lines.

use fmm_frf::{AverageOptions, Background, Estimated, Estimator, FrequencyResponse, RationalFit};

use crate::estimates::truncated;
use crate::table::impacts;

const FREQUENCY: f64 = 2.198_078_935_155_759_3;
const RATIO: f64 = 0.027_872_729_100_689_435;

fn mobility() -> FrequencyResponse {
    impacts(&AverageOptions::default()).estimate(Estimator::H1).unwrap()
}

/// Of the amplitude, e^{−cT/2m} is left when the records end after T = 16 s. All lines lack it alike, so that it is in
/// no uncertainty.
const LEAKAGE: f64 = 2.1e-3;

/// Within `tolerance` of the truth, and but for the leakage within four of its own standard uncertainties.
fn near(found: Estimated, truth: f64, tolerance: f64, what: &str) {
    let error = (found.value - truth).abs();
    assert!(error < tolerance * truth, "{what}: {found}, not {truth}");
    assert!(error < 4.0 * found.uncertainty + LEAKAGE * truth, "{what}: {found}, not {truth}");
    assert!(found.uncertainty < tolerance * truth, "{what}: {found} is hardly known");
}

#[test]
fn rational_fraction() {
    let fit = RationalFit::of(&mobility(), 1.0, 4.0, Background::None).unwrap();
    let [mass, damping, stiffness] = fit.machine.unwrap();
    // The same least squares, solved by scipy to its tolerances of 1e-8.
    for (found, expected) in [
        (mass.value, 10.400_494_249_180_197),
        (damping.value, 8.033_710_883_339_944),
        (stiffness.value, 1_983.612_273_804_027_8),
        (fit.natural_frequency.value, 2.197_968_863_876_998),
        (fit.damping_ratio.value, 0.027_966_030_059_178_42),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found}, not {expected}");
    }
    near(fit.natural_frequency, FREQUENCY, 2e-4, "natural frequency (Hz)");
    near(fit.damping_ratio, RATIO, 0.02, "damping ratio");
    near(damping, 8.0, 0.02, "damping (N s/m)");
    assert!(fit.residual < 1e-2 * 0.125, "{} m/(N s) are left over", fit.residual);
    let with_background = RationalFit::of(&mobility(), 1.0, 4.0, Background::OtherModes).unwrap();
    near(with_background.damping_ratio, RATIO, 0.02, "damping ratio beside a background");
    assert!(with_background.machine.is_none() && with_background.residual <= fit.residual);
}

/// Of a response whose window has added three times its own damping, the fit returns the machine's.
#[test]
fn damping_behind_an_exponential_window() {
    let windowed = truncated();
    let rational = RationalFit::of(&windowed, 1.0, 4.0, Background::None).unwrap();
    let [_, damping, _] = rational.machine.unwrap();
    assert!((damping.value / 8.0 - 1.0).abs() < 0.05, "rational fit: {damping} N s/m");
    let mode = rational;
    assert!((mode.damping_ratio.value / RATIO - 1.0).abs() < 0.05, "{mode}");
    assert!((mode.natural_frequency.value / FREQUENCY - 1.0).abs() < 2e-3, "{mode}");
}
