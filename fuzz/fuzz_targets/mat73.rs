//! Any file of MATLAB version 7.3, or noise in its place, ends in arrays or in a typed error.

#![no_main]

use fmm_record::{Array, Reader};
use libfuzzer_sys::{Corpus, fuzz_target};

/// Bytes with which HDF5 begins, here or behind the header of MATLAB.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let is_hdf5 = bytes.starts_with(HDF5) || bytes.get(512..).is_some_and(|rest| rest.starts_with(HDF5));
    if !is_hdf5 {
        return Corpus::Reject;
    }
    let Ok(file) = Reader::default().parse(bytes) else { return Corpus::Keep };
    for array in file.arrays() {
        let count: usize = array.shape().iter().product();
        assert_eq!(count, array.values().len());
    }
    let _ = file.channels();
    let names: Vec<&str> = file.arrays().iter().map(Array::name).collect();
    for name in names.into_iter().take(4) {
        if let Ok(reading) = file.channel(name) {
            assert!(reading.record.values().iter().all(|value| value.is_finite()));
        }
    }
    let _ = Reader::default().rate(100.0).read_from(bytes);
    Corpus::Keep
});
