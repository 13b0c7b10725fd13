//! Home of the examples, tests and benches; the library code lives in `crates/`.

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
