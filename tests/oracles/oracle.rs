//! Reading the reference files.

use std::path::Path;

use fmm_friction::Coulomb;
use fmm_model::{Damping, Dual, Oscillator, Scalar};
use fmm_sim::Scenario;
use serde_json::Value;

/// One reference file of `tests/data/friction`.
pub(crate) fn read(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/friction").join(name).with_extension("json");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A number of a reference file; a missing one is 0, as the files leave out what does not apply.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(0.0)
}

/// A list of numbers of a reference file.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

/// The six inputs of an oscillator with Coulomb friction, in the order of the directions of [`scenario`].
pub(crate) const INPUTS: [&str; 6] = ["m", "k", "c1", "F", "x0", "v0"];

/// The scenario of a file's `params`, each input being the variable of one direction.
pub(crate) fn scenario<D: Scalar>(params: &Value) -> Scenario<D, Coulomb<D>> {
    let input = |index: usize| D::variable(number(&params[INPUTS[index]]), index);
    let machine = Oscillator::new(input(0), input(1)).unwrap().with_damping(Damping::linear(input(2)).unwrap());
    let law = Coulomb::new(input(3)).unwrap();
    Scenario::new(machine, law, D::from(1.0)).unwrap().starting_at(input(4), input(5)).unwrap()
}

/// A number with derivatives in all inputs.
pub(crate) type Gradient = Dual<6>;
