//! The transform against the sum that it is.

use std::f64::consts::TAU;

use fmm_record::{Complex64, RealTransform, RecordError};

/// The sum as it is written, for lengths with all kinds of factors.
#[test]
fn lines_are_those_of_the_definition() {
    let (mut spectrum, mut scratch) = (Vec::new(), Vec::new());
    for length in [1_usize, 2, 3, 16, 30, 49, 97] {
        let samples: Vec<f64> = (0..length).map(|i| ((i * 7919) % 101) as f64 / 101.0 - 0.5).collect();
        let transform = RealTransform::new(length);
        transform.run(&mut samples.clone(), &mut spectrum, &mut scratch).unwrap();
        assert_eq!(spectrum.len(), length / 2 + 1);
        for (k, line) in spectrum.iter().enumerate() {
            let angle = |j: usize| -TAU * ((j * k) % length) as f64 / length as f64;
            let terms = samples.iter().enumerate().map(|(j, x)| Complex64::from_polar(*x, angle(j)));
            let expected: Complex64 = terms.sum();
            assert!((line - expected).norm() < 1e-14 * length as f64, "line {k} of {length}: {line}, not {expected}");
        }
    }
}

#[test]
fn another_number_of_samples_is_refused() {
    let (mut spectrum, mut scratch) = (Vec::new(), Vec::new());
    for (length, given) in [(4, 3), (4, 5), (4, 0), (0, 1)] {
        let error = RealTransform::new(length).run(&mut vec![1.0; given], &mut spectrum, &mut scratch);
        let expected = format!("a transform of {length} samples was given {given}");
        assert!(matches!(error, Err(RecordError::Options { what }) if what == expected));
    }
    RealTransform::new(0).run(&mut [], &mut spectrum, &mut scratch).unwrap();
    assert_eq!(spectrum, [Complex64::default()]);
}
