//! Tools of the tests.

pub(crate) mod synthetic;
