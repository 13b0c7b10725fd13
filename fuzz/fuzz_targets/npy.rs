//! Any file of NumPy, or noise in its place, ends in arrays or in a typed error.

#![no_main]

use fmm_record::{Array, Reader};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = Reader::default().parse(bytes) else { return };
    for array in file.arrays() {
        let count: usize = array.shape().iter().product();
        assert_eq!(count, array.values().len());
    }
    let _ = file.channels();
    let names: Vec<&str> = file.arrays().iter().map(Array::name).collect();
    for name in names.into_iter().take(4) {
        for series in ["", "[1]", "[:,1]"] {
            let _ = file.channel(&format!("{name}{series}")[..]);
        }
    }
    if let Ok(reading) = Reader::default().rate(100.0).read_from(bytes) {
        assert!(reading.record.values().iter().all(|value| value.is_finite()));
    }
});
