//! Any Universal File, or noise in its place, ends in data sets or in a typed error; what was read can be written and
//! read again, with as many points.

#![no_main]

use fmm_record::uff::{ByteOrder, Form, UffFile, write_to};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = UffFile::parse(bytes) else { return };
    for set in file.sets().iter().take(4) {
        if let Ok(record) = set.record() {
            assert!(record.values().iter().all(|value| value.is_finite()));
        }
    }
    for set in file.sets() {
        assert_eq!(set.abscissae().len(), set.ordinate().len());
    }
    for form in [Form::Ascii, Form::Binary(ByteOrder::Little), Form::Binary(ByteOrder::Big)] {
        let mut written = Vec::new();
        if write_to(&mut written, file.sets(), form).is_ok() {
            let again = UffFile::parse(&written).expect("a file written here is read");
            let lengths = |file: &UffFile| file.sets().iter().map(|set| set.ordinate().len()).collect::<Vec<_>>();
            assert_eq!(lengths(&again), lengths(&file));
        }
    }
});
