//! Refusals of responses that cannot be fitted, each with a reason and without a panic.

use fmm_frf::{Complex64, FrequencyResponse, FrfError, MeasuredResponse, ModalFit, ModalOptions, ResponseForm};

use crate::chain::{Chain, lines};

fn flat(lines: &[f64], value: f64) -> MeasuredResponse {
    let values = vec![Complex64::new(value, 0.0); lines.len()];
    MeasuredResponse::new(FrequencyResponse::new(ResponseForm::Mobility, lines.to_vec(), values).unwrap())
}

fn fit(responses: &[MeasuredResponse], options: &ModalOptions) -> FrfError {
    ModalFit::of(responses, options).expect_err("there is no mode")
}

#[test]
fn what_has_no_modes() {
    let (all, automatic) = (lines(1.0, 50.0, 100), ModalOptions::default());
    assert!(matches!(fit(&[], &automatic), FrfError::TooFew { .. }));
    assert!(matches!(fit(&[flat(&all, 0.0)], &automatic), FrfError::Values { .. }));
    assert!(matches!(fit(&[flat(&all, 1.0)], &automatic), FrfError::NoFit { .. }));
    assert!(matches!(fit(&[flat(&all, 1e-310)], &automatic), FrfError::Values { .. }));
    for count in 1..4 {
        assert!(matches!(fit(&[flat(&all[..count], 1.0)], &automatic), FrfError::TooFew { .. }), "{count} lines");
    }
    let beyond = fit(&[flat(&all, 1.0)], &automatic.clone().within(60.0, 70.0));
    assert!(matches!(beyond, FrfError::Outside { .. }), "{beyond}");
}

#[test]
fn what_does_not_go_together() {
    let (one, other) = (lines(1.0, 50.0, 100), lines(1.0, 51.0, 100));
    let automatic = ModalOptions::default();
    assert!(matches!(fit(&[flat(&one, 1.0), flat(&other, 1.0)], &automatic), FrfError::Mismatch { .. }));
    assert!(flat(&one, 1.0).with_uncertainty(vec![1.0; 99], 3.0).is_err());
    assert!(flat(&one, 1.0).with_uncertainty(vec![-1.0; 100], 3.0).is_err());
    assert!(flat(&one, 1.0).with_uncertainty(vec![1.0; 100], 1.0).is_err());
    assert!(flat(&one, 1.0).with_coherence_values(&[0.0; 100], 3.0).is_err());
    assert!(flat(&one, 1.0).with_coherence_values(&[f64::NAN; 100], 3.0).is_err());
}

#[test]
fn orders_that_the_lines_do_not_allow() {
    let responses = Chain::read("two").responses(ResponseForm::Mobility, &lines(5.0, 80.0, 60), 0);
    let message = fit(&responses, &ModalOptions::default().up_to_order(30)).to_string();
    assert!(message.contains("at least 62 lines") && message.contains("there are 60"), "{message}");
    assert!(matches!(fit(&responses, &ModalOptions::default().up_to_order(0)), FrfError::TooFew { .. }));
    assert!(ModalFit::of(&responses, &ModalOptions::default().up_to_order(29)).is_ok());
}

#[test]
fn modes_that_are_not_there() {
    let responses = Chain::read("two").responses(ResponseForm::Mobility, &lines(5.0, 80.0, 200), 0);
    let missing = fit(&responses, &ModalOptions::default().nearest_to([23.0, 37.0])).to_string();
    assert!(missing.contains("37 Hz"), "{missing}");
    let one = ModalFit::of(&responses, &ModalOptions::default().nearest_to([48.0])).unwrap();
    assert!((one.modes()[0].natural_frequency.value - 48.703).abs() < 0.1, "{}", one.modes()[0]);
}

/// Whatever numbers a file has, there is an answer or a reason.
#[test]
fn any_numbers() {
    let all = lines(0.5, 80.0, 64);
    for seed in 0..60_u32 {
        let mut state = f64::from(seed) / 61.0 + 1e-3;
        let mut next = || {
            state = 3.99 * state * (1.0 - state);
            let size = [1.0, 1e-150, 1e150, 0.0][(seed % 4) as usize];
            // Some are all alike but for one line.
            if seed % 5 == 4 && state < 0.9 { size } else { (state - 0.5) * size }
        };
        let values = all.iter().map(|_| Complex64::new(next(), next())).collect();
        let response = FrequencyResponse::new(ResponseForm::Accelerance, all.clone(), values).unwrap();
        if let Ok(fit) = ModalFit::of(&[MeasuredResponse::new(response)], &ModalOptions::default()) {
            for mode in fit.modes() {
                assert!(mode.natural_frequency.value.is_finite() && mode.damping_ratio.uncertainty.is_finite());
            }
        }
    }
}
