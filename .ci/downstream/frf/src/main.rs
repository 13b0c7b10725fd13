//! Two hammer blows give the response of a machine without friction, the peaks of three more the friction it has since.

use std::cmp::Ordering;

use fmm_frf::{
    AverageOptions, Background, CoulombLine, Estimator, FrfError, RationalFit, ResponseForm, SingleDegreeOfFreedom,
    TrialAverage,
};

/// Sampling rate (Hz), samples of a record, and the sample of the blow.
const RATE: f64 = 256.0;
const LENGTH: u32 = 2048;
const BLOW: u32 = 8;

/// Velocity (m/s) of 2 kg that ring at 31.4 rad/s and decay by 1 1/s, after `impulse` (N s).
fn velocity(impulse: f64) -> Vec<f64> {
    let (omega, decay) = (31.4, 1.0);
    let swing = |t: f64| impulse / 2.0 * (-decay * t).exp() * ((omega * t).cos() - decay / omega * (omega * t).sin());
    // Nothing before the blow, and the mean of before and after at it.
    let share = |i: u32| match i.cmp(&BLOW) {
        Ordering::Less => 0.0,
        Ordering::Equal => 0.5,
        Ordering::Greater => 1.0,
    };
    (0..LENGTH).map(|i| share(i) * swing((f64::from(i) - f64::from(BLOW)) / RATE)).collect()
}

fn main() -> Result<(), FrfError> {
    let mut average = TrialAverage::new(ResponseForm::Mobility, RATE, LENGTH as usize, &AverageOptions::default())?;
    for impulse in [1.0, 2.0] {
        let force: Vec<f64> = (0..LENGTH).map(|i| if i == BLOW { impulse * RATE } else { 0.0 }).collect();
        average.add(&force, &velocity(impulse))?;
    }
    let mobility = average.estimate(Estimator::H1)?;
    let mode = RationalFit::of(&mobility, 3.0, 7.0, Background::OtherModes)?;
    let omega = std::f64::consts::TAU * mode.natural_frequency.value;
    println!("natural frequency {:.4} Hz, damping ratio {:.4}", mode.natural_frequency.value, mode.damping_ratio.value);
    // ω₀² = ω_d² + δ²; the sampling of the sharp blow leaves a few parts in 10⁴.
    assert!((omega / f64::hypot(31.4, 1.0) - 1.0).abs() < 1e-3, "{omega} rad/s");

    // A contact with 0.75 N of friction is put on, and the peaks of the receptance grow with the impulse.
    let impulses = [0.98, 1.42, 1.64];
    let machine = SingleDegreeOfFreedom::new(2.0, 0.0, 2.0 * omega * omega)?;
    let peaks = impulses.map(|impulse| machine.peak_after_impact(impulse, 0.75));
    let peaks = peaks.into_iter().collect::<Result<Vec<f64>, FrfError>>()?;
    let friction = CoulombLine::fit(&impulses, &peaks, 2.0, omega)?.friction_force;
    println!("friction force {:.4} N from peaks of {peaks:.4?} m/N", friction.value);
    assert!((friction.value - 0.75).abs() < 1e-12, "{} N", friction.value);
    Ok(())
}
