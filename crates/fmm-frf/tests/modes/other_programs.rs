//! A measured file, and the poles that another program finds in it.

use std::path::Path;

use fmm_frf::{MeasuredResponse, ModalFit, ModalOptions};
use fmm_record::uff::{Form, UffFile, write_to};

use crate::chain::Chain;

/// Natural frequencies (Hz) and damping ratios by pyEMA 0.31.0, its poles of order 60 from 1 Hz to 256 Hz.
const PYEMA: [(f64, f64); 6] = [
    (24.266_061_417_789_945, 0.007_317_748_807_998_884),
    (71.388_117_232_908_75, 0.004_469_592_995_623_87),
    (114.361_140_415_724_85, 0.004_982_607_536_981_597),
    (150.687_102_646_536_63, 0.005_782_531_706_529_482),
    (178.254_258_677_758_97, 0.006_473_296_628_010_606),
    (195.457_400_319_420_17, 0.006_919_645_353_869_693),
];

fn file() -> UffFile {
    UffFile::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/chain_of_six.uff")).unwrap()
}

/// The truth is within three u of the fit; the other program, which stops at the linear fit, is within 0.6 % of the
/// truth in damping, and up to fifteen times as far from it.
#[test]
fn poles_of_a_binary_universal_file() {
    let responses = MeasuredResponse::of_universal(&file(), None, None).unwrap();
    let found = ModalFit::of(&responses, &ModalOptions::default()).unwrap();
    let truth = Chain::read("six").modes;
    assert_eq!(found.modes().len(), truth.len());
    let (mut own, mut theirs) = (0.0_f64, 0.0_f64);
    for ((mode, truth), (frequency, ratio)) in found.modes().iter().zip(&truth).zip(PYEMA) {
        for (found, truth, other, within) in
            [(mode.natural_frequency, truth.frequency, frequency, 1e-4), (mode.damping_ratio, truth.ratio, ratio, 1e-2)]
        {
            assert!((found.value - truth).abs() < 3.0 * found.uncertainty, "{mode}: not {truth}");
            assert!((found.value / other - 1.0).abs() < within, "{mode}: the other program has {other}");
        }
        own = own.max((mode.damping_ratio.value / truth.ratio - 1.0).abs());
        theirs = theirs.max((ratio / truth.ratio - 1.0).abs());
    }
    println!("damping ratios within {own:.2e} of the truth, those of pyEMA within {theirs:.2e}");
    assert!(own < theirs, "the damping ratios are off by {own}, those of the other program by {theirs}");
}

#[test]
fn a_response_comes_back_out_of_a_file() {
    let responses = MeasuredResponse::of_universal(&file(), None, None).unwrap();
    let places: Vec<String> = responses.iter().map(|measured| measured.response().to_string()).collect();
    assert_eq!(places, ["1+X", "2+X", "3+X", "4+X", "5+X", "6+X"]);
    for form in [Form::Ascii, Form::Binary(fmm_record::uff::ByteOrder::Little)] {
        let sets: Vec<_> = responses.iter().map(|measured| measured.data_set().unwrap()).collect();
        let mut bytes = Vec::new();
        write_to(&mut bytes, &sets, form).unwrap();
        let again = MeasuredResponse::of_universal(&UffFile::parse(&bytes).unwrap(), None, None).unwrap();
        for (one, other) in responses.iter().zip(&again) {
            assert_eq!(one.values().frequencies(), other.values().frequencies());
            assert_eq!((one.values().form(), one.response()), (other.values().form(), other.response()));
            for (a, b) in one.values().values().iter().zip(other.values().values()) {
                // Text has 13 digits.
                assert!((a - b).norm() <= 1e-12 * a.norm(), "{a} became {b}");
            }
        }
    }
}
