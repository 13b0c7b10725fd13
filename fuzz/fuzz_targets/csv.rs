//! Any text or noise ends in a record or in a typed error.

#![no_main]

use fmm_record::Reader;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for reader in [Reader::default(), Reader::default().rate(100.0), Reader::default().channel(1)] {
        if let Ok(reading) = reader.read_from(bytes) {
            assert!(reading.record.values().iter().all(|value| value.is_finite()));
        }
    }
});
