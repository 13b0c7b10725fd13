//! Two masses between three springs: the modes of their responses to a force on the first.

use fmm_frf::{
    Complex64, FrequencyResponse, FrfError, MeasuredResponse, ModalFit, ModalOptions, Mode, Pole, Residue, ResponseForm,
};

/// Masses of 1 kg, springs of 40 kN/m to the walls and 10 kN/m between, dampers in proportion.
const WALL: f64 = 40e3;
const BETWEEN: f64 = 10e3;
const DAMPING: f64 = 2e-5;

/// Receptances of both masses at a frequency (Hz).
fn receptances(frequency: f64) -> [Complex64; 2] {
    let omega = std::f64::consts::TAU * frequency;
    let lossy = |stiffness: f64| Complex64::new(stiffness, omega * DAMPING * stiffness);
    let (own, other) = (lossy(WALL + BETWEEN) - omega * omega, -lossy(BETWEEN));
    let determinant = own * own - other * other;
    [own / determinant, -other / determinant]
}

/// Damped frequency (Hz) of a pole.
fn damped(pole: Pole) -> f64 {
    pole.value().im / std::f64::consts::TAU
}

fn main() -> Result<(), FrfError> {
    let lines: Vec<f64> = (40..400).map(|i| 0.125 * f64::from(i)).collect();
    let measured = |mass: usize| {
        let values = lines.iter().map(|frequency| receptances(*frequency)[mass]).collect();
        FrequencyResponse::new(ResponseForm::Receptance, lines.clone(), values).map(MeasuredResponse::new)
    };
    let fit = ModalFit::of(&[measured(0)?, measured(1)?], &ModalOptions::default())?;
    let modes: &[Mode] = fit.modes();
    for (mode, stiffness) in modes.iter().zip([WALL, WALL + 2.0 * BETWEEN]) {
        println!("{mode}, damped {:.4} Hz", damped(mode.pole));
        let expected = stiffness.sqrt() / std::f64::consts::TAU;
        assert!((mode.natural_frequency.value / expected - 1.0).abs() < 1e-9, "{mode}: not {expected} Hz");
        assert!((mode.damping_ratio.value / (0.5 * DAMPING * stiffness.sqrt()) - 1.0).abs() < 1e-7, "{mode}");
    }
    // The masses move together in the first mode and against each other in the second.
    let sign = |mode: &Mode| {
        let [one, other]: [Residue; 2] = [mode.residues[0], mode.residues[1]];
        (one.value.im * other.value.im).signum()
    };
    assert_eq!((modes.len(), sign(&modes[0]), sign(&modes[1])), (2, 1.0, -1.0));
    Ok(())
}
