//! Closed forms: impulses, linear responses, peaks and durations of impacts with friction.

use std::f64::consts::{PI, TAU};

use fmm_frf::{
    Baseline, Complex64, CoulombLine, ResponseForm, SingleDegreeOfFreedom, coulomb_impact_duration, impulse,
};

use crate::table::rows;

#[test]
fn half_sine_impulses() {
    let rows = rows(include_str!("../data/impulse_halfsine.csv"), 0);
    assert_eq!(rows.len(), 5);
    for row in rows {
        let [peak, duration, rate, n, exact, trapezoid, _] = row[..] else { panic!("{row:?}") };
        let force: Vec<f64> = (0..=n as usize).map(|i| peak * (PI * i as f64 / n).sin()).collect();
        let found = impulse(&force, 1.0 / rate, Baseline::Keep).unwrap();
        // The table asks for 1e-15: about five roundings.
        assert!((found / trapezoid - 1.0).abs() < 1e-15, "{duration} s: {found} N s, not {trapezoid} N s");
        let angle = PI / (2.0 * n);
        assert!((trapezoid / exact - angle / angle.tan()).abs() < 1e-15, "documented error, n = {n}");
    }
}

#[test]
fn oscillator_responses() {
    let rows = rows(include_str!("../data/sdof_analytic.csv"), 1);
    assert_eq!(rows.len(), 39);
    let mut well_conditioned = 0;
    for row in rows {
        let [mass, damping, stiffness, frequency] = row[..4] else { panic!("{row:?}") };
        let machine = SingleDegreeOfFreedom::new(mass, damping, stiffness).unwrap();
        let receptance = Complex64::new(row[4], row[5]).norm();
        // The frequency itself is rounded by half an ε, which shifts m ω² by one; k − m ω² rounds as often.
        let conditioning = 2.0 * f64::EPSILON * (stiffness + mass * (TAU * frequency).powi(2)) * receptance;
        well_conditioned += usize::from(conditioning < 1e-14);
        for (form, at) in
            [ResponseForm::Receptance, ResponseForm::Mobility, ResponseForm::Accelerance].iter().zip([4, 6, 8])
        {
            let expected = Complex64::new(row[at], row[at + 1]);
            let found = machine.response(*form, frequency).unwrap();
            let error = (found - expected).norm();
            assert!(
                error <= conditioning.max(1e-14) * expected.norm(),
                "{form} at {frequency} Hz: {found}, not {expected}; relative error {:.1e}",
                error / expected.norm()
            );
            assert!(*form != ResponseForm::Receptance || found.im <= 0.0, "sign at {frequency} Hz: {found}");
        }
    }
    // Close to resonance no formula can do better than its rounded frequency; everywhere else the table asks for 1e-14.
    assert!(well_conditioned >= 30, "only {well_conditioned} of 39 lines were held to 1e-14");
}

/// Impact on a machine with dry friction, simulated event by event in closed form and transformed over 33 s
/// at 10 kHz: impulse (N s), peak receptance (m/N) and time of rest (s) without viscous damping, peak with
/// c = 0.275 N s/m.
const COULOMB_IMPACTS: [(f64, f64, f64, f64); 3] = [
    (0.98, 3.569_544_372_788_652e-3, 1.941_174_234_836, 3.511_459_465_303e-3),
    (1.42, 5.162_876_591_581_655e-3, 3.079_180_615_843, 5.037_386_071_112e-3),
    (1.64, 5.961_675_581_107_64e-3, 3.534_296_661_166, 5.793_328_079_192e-3),
];
const MASS: f64 = 10.391;
const FRICTION: f64 = 0.113 * 6.67;

fn undamped() -> SingleDegreeOfFreedom {
    SingleDegreeOfFreedom::new(MASS, 0.0, 1982.0).unwrap()
}

#[test]
fn receptance_peaks_of_coulomb_impacts() {
    for (impulse, undamped_peak, _, damped) in COULOMB_IMPACTS {
        let peak = undamped().peak_after_impact(impulse, FRICTION).unwrap();
        // The amplitude falls in 9 to 16 steps instead of a ramp: of the order of 1/16² to 1/9² of the peak.
        assert!((undamped_peak / peak - 1.0).abs() < 0.005, "{impulse} N s: {peak} m/N, not {undamped_peak} m/N");
        // Viscous damping of ζ = 0.001 takes 1.6 % to 2.8 % off, the more the longer the motion lasts.
        assert!(damped < undamped_peak && damped / peak > 0.97, "{impulse} N s: {peak} m/N, not {damped} m/N");
    }
}

#[test]
fn friction_from_receptance_peaks() {
    for (impulse, undamped_peak, _, damped) in COULOMB_IMPACTS {
        let force = undamped().friction_after_impact(impulse, undamped_peak).unwrap();
        assert!((force / FRICTION - 1.0).abs() < 0.005, "{impulse} N s: {force} N, not {FRICTION} N");
        let force = undamped().friction_after_impact(impulse, damped).unwrap();
        assert!((force / FRICTION - 1.0).abs() < 0.03, "{impulse} N s: {force} N, not {FRICTION} N");
    }
}

#[test]
fn coulomb_impacts_end_when_they_should() {
    let half_period = PI / undamped().natural_angular_frequency();
    for (impulse, _, rest, _) in COULOMB_IMPACTS {
        // The blow begins 0.01 s into the record.
        let duration = coulomb_impact_duration(impulse, FRICTION).unwrap();
        assert!((rest - 0.01 - duration).abs() < half_period, "{impulse} N s: {duration} s, rest at {rest} s");
    }
}

#[test]
fn receptance_peaks_with_viscous_damping_beside_friction() {
    let machine = SingleDegreeOfFreedom::new(MASS, 0.275, 1982.0).unwrap();
    for (impulse, _, _, damped) in COULOMB_IMPACTS {
        // What is left is that the amplitude falls in 9 to 16 steps, as without viscous damping.
        let peak = machine.peak_after_impact(impulse, FRICTION).unwrap();
        assert!((damped / peak - 1.0).abs() < 0.005, "{impulse} N s: {peak} m/N, not {damped} m/N");
        let force = machine.friction_after_impact(impulse, damped).unwrap();
        assert!((force / FRICTION - 1.0).abs() < 0.005, "{impulse} N s: {force} N, not {FRICTION} N");
    }
}

/// Slopes, intercepts and R² as numpy's polyfit gives them for the same points.
#[test]
fn friction_from_the_slope() {
    let omega = undamped().natural_angular_frequency();
    let impulses = COULOMB_IMPACTS.map(|(impulse, ..)| impulse);
    let undamped = COULOMB_IMPACTS.map(|(_, peak, _, _)| peak);
    let line = CoulombLine::fit(&impulses, &undamped, MASS, omega).unwrap();
    assert!((line.slope.value / 3.623_979_562_36e-3 - 1.0).abs() < 1e-11, "{line}");
    assert!((line.intercept.value / 1.773_970_451_45e-5 - 1.0).abs() < 1e-8, "{line}");
    assert!((line.r_squared - 0.999_999_561_831_6).abs() < 1e-12, "{line}");
    assert!((line.friction_force.value / FRICTION - 1.0).abs() < 0.01, "{line}, not {FRICTION} N");
    let damped = COULOMB_IMPACTS.map(|(_, _, _, peak)| peak);
    let line = CoulombLine::fit(&impulses, &damped, MASS, omega).unwrap();
    assert!((line.slope.value / 3.458_896_448_494e-3 - 1.0).abs() < 1e-10, "{line}");
    assert!((line.r_squared - 0.999_994_787_610_7).abs() < 1e-11, "{line}");
}
