//! Home of the examples, tests and benches; the library code lives in `crates/`.
