//! Chains without noise: poles, residues and shapes are those of an independent program.

use fmm_frf::{Complex64, ModalFit, ModalOptions, ResponseForm};

use crate::chain::{Chain, lines};

/// The part of a frequency, a damping ratio or the largest residue by which a fit of exact lines may differ. Rounding of
/// the lines, 10⁻¹⁶ of the peaks, comes back through slopes of up to 10⁴ of its size.
const EXACT: f64 = 1e-9;

fn require(name: &str, form: ResponseForm, found: &ModalFit) {
    let chain = Chain::read(name);
    let list: Vec<String> = found.modes().iter().map(ToString::to_string).collect();
    assert_eq!(found.modes().len(), chain.modes.len(), "{name}, {form}: {list:?}");
    for (mode, truth) in found.modes().iter().zip(&chain.modes) {
        let (frequency, ratio) = (mode.natural_frequency.value, mode.damping_ratio.value);
        assert!((frequency / truth.frequency - 1.0).abs() < EXACT, "{name}: {frequency} Hz, not {}", truth.frequency);
        assert!((ratio / truth.ratio - 1.0).abs() < EXACT * 1e2, "{name}: a ratio of {ratio}, not {}", truth.ratio);
        let largest = truth.residues.iter().map(|residue| residue.norm()).fold(0.0, f64::max);
        for (residue, expected) in mode.residues.iter().zip(&truth.residues) {
            let error = (residue.value - expected).norm() / largest;
            assert!(error < EXACT * 1e2, "{name}, {frequency} Hz: a residue of {}, not {expected}", residue.value);
        }
    }
    for misfit in found.misfits() {
        assert!(*misfit < 1e-9, "{name}: {misfit} is left over");
    }
}

#[test]
fn chains_of_two_to_six_masses() {
    for (name, high) in
        [("two", 80.0), ("three", 250.0), ("four_not_proportional", 200.0), ("five", 250.0), ("six", 250.0)]
    {
        let chain = Chain::read(name);
        for form in [ResponseForm::Receptance, ResponseForm::Mobility, ResponseForm::Accelerance] {
            let responses = chain.responses(form, &lines(5.0, high, 400), 0);
            let found = ModalFit::of(&responses, &ModalOptions::default());
            require(name, form, &found.unwrap_or_else(|error| panic!("{name}, {form}: {error}")));
        }
    }
}

/// Bands that do not begin at zero, and lines at unequal distances.
#[test]
fn any_band_and_any_lines() {
    let chain = Chain::read("five");
    let uneven: Vec<f64> = lines(10.0, 16.0, 500).iter().map(|root| root * root).collect();
    for (grid, modes) in [(lines(100.0, 200.0, 300), 2..5), (uneven, 2..5), (lines(60.0, 130.0, 100), 1..3)] {
        let found = ModalFit::of(&chain.responses(ResponseForm::Mobility, &grid, 0), &ModalOptions::default()).unwrap();
        let list: Vec<String> = found.modes().iter().map(ToString::to_string).collect();
        assert_eq!(found.modes().len(), modes.len(), "{list:?}");
        for (mode, truth) in found.modes().iter().zip(&chain.modes[modes]) {
            // Modes outside the band are flexibility and inertia only to first order.
            let error = (mode.natural_frequency.value / truth.frequency - 1.0).abs();
            assert!(error < 1e-4, "{mode}: not {} Hz", truth.frequency);
            let error = (mode.damping_ratio.value / truth.ratio - 1.0).abs();
            assert!(error < 2e-2, "{mode}: not {}", truth.ratio);
        }
    }
}

/// Forces on two masses at once, and on all with one response: the same modes, and shapes that agree.
#[test]
fn several_references() {
    let chain = Chain::read("close");
    let grid = lines(30.0, 70.0, 300);
    let both: Vec<_> = (0..2).flat_map(|force| chain.responses(ResponseForm::Mobility, &grid, force)).collect();
    let found = ModalFit::of(&both, &ModalOptions::default()).unwrap();
    assert_eq!(found.modes().len(), 2);
    for (mode, truth) in found.modes().iter().zip(&chain.modes) {
        assert!((mode.natural_frequency.value / truth.frequency - 1.0).abs() < EXACT, "{mode}");
        assert!((mode.shape[0].deflection.value.abs() - 1.0).abs() < 1e-6, "both move alike or against each other");
        assert!(mode.phase_collinearity > 1.0 - 1e-9, "{}", mode.phase_collinearity);
    }
    // A hammer that goes about: the places of the shape are those of the force.
    let roving: Vec<_> = (0..2).map(|force| chain.responses(ResponseForm::Mobility, &grid, force).remove(0)).collect();
    let found = ModalFit::of(&roving, &ModalOptions::default()).unwrap();
    let places: Vec<String> = found.modes()[0].shape.iter().map(|point| point.place.to_string()).collect();
    assert_eq!(places, ["1+X", "2+X"]);
}

#[test]
fn the_fit_is_its_modes_and_the_rest() {
    let chain = Chain::read("three");
    let grid = lines(100.0, 200.0, 200);
    let found = ModalFit::of(&chain.responses(ResponseForm::Accelerance, &grid, 0), &ModalOptions::default()).unwrap();
    for (index, fitted) in found.fitted().iter().enumerate() {
        for (frequency, value) in fitted.frequencies().iter().zip(fitted.values()) {
            let s = Complex64::new(0.0, std::f64::consts::TAU * frequency);
            let pair = |mode: &fmm_frf::Mode| {
                let (pole, residue) = (mode.pole.value(), mode.residues[index].value);
                residue / (s - pole) + residue.conj() / (s - pole.conj())
            };
            let receptance: Complex64 = found.modes().iter().map(pair).sum::<Complex64>()
                + found.upper_residuals()[index]
                + found.lower_residuals()[index] / (s * s);
            assert!((s * s * receptance - value).norm() < 1e-9 * value.norm().max(1e-3), "{frequency} Hz");
        }
    }
}
