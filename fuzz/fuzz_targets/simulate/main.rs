//! Any finite scenario, under any law, force and engine, ends in a finite motion or in a typed error: no panic, no NaN,
//! no hang, events in order and within the sampled time.

#![no_main]

mod case;
mod contact;
mod motion;
mod number;

use libfuzzer_sys::{Corpus, fuzz_target};

use case::Case;

fuzz_target!(|case: Case| -> Corpus {
    match contact::run(&case) {
        Some(()) => Corpus::Keep,
        None => Corpus::Reject,
    }
});
