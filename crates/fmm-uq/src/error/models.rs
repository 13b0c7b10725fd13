//! Errors of models and of formulas.

use std::error::Error;

use crate::UncertaintyError;

/// Models.
impl UncertaintyError {
    /// The model itself reported an error.
    pub(crate) fn model_failed(at: &str, source: Box<dyn Error + Send + Sync>) -> Self {
        Self::Model { what: format!("the model failed at {at}"), source: Some(source) }
    }

    /// The model gave an infinite result or no number.
    pub(crate) fn result_not_finite(result: f64, at: &str) -> Self {
        Self::Model { what: format!("the model gives {result} at {at}"), source: None }
    }

    /// A sensitivity is infinite or not a number, or its product with the uncertainty overflows.
    pub(crate) fn sensitivity_not_finite(input: &str, sensitivity: f64, at: &str) -> Self {
        Self::Model {
            what: format!("the sensitivity to {input} is {sensitivity}, which cannot be propagated, at {at}"),
            source: None,
        }
    }

    /// The model gave different results for the same values.
    pub(crate) fn model_not_repeatable(first: f64, again: f64, at: &str) -> Self {
        Self::Model {
            what: format!("the model gives {first}, then {again}, for the same values {at}; it must be deterministic"),
            source: None,
        }
    }

    /// The model has another number of outputs than it should have.
    pub(crate) fn output_count(expected: usize, found: usize) -> Self {
        Self::Model { what: format!("the model must give {expected} outputs, but gives {found}"), source: None }
    }

    /// A model whose number of outputs is not always the same.
    pub(crate) fn output_count_changed(first: usize, again: usize) -> Self {
        Self::Model {
            what: format!("the model gives {first} outputs, then {again}; their number must not change"),
            source: None,
        }
    }

    /// No trial succeeded at all.
    pub(crate) fn no_success() -> Self {
        Self::Model { what: "none of the trials succeeded".to_owned(), source: None }
    }

    /// Too many rows of a variance analysis in which the model failed.
    pub(crate) fn rows_failed(failed: u64, rows: u64, allowed: f64) -> Self {
        Self::Model {
            what: format!("the model failed in {failed} of {rows} rows, more than the allowed share of {allowed}"),
            source: None,
        }
    }
}

/// Formulas.
#[cfg(feature = "formula")]
impl UncertaintyError {
    fn formula(what: String) -> Self {
        Self::Model { what, source: None }
    }

    /// Text that is no formula from `rest` on.
    pub(crate) fn not_a_formula(text: &str, rest: &str) -> Self {
        let place = if rest.is_empty() { "at its end".to_owned() } else { format!("from {rest:?} on") };
        Self::formula(format!("{text:?} cannot be read as a formula {place}; write products with *, powers with ^"))
    }

    /// More levels than a parser should go down.
    pub(crate) fn formula_too_deep(most: usize) -> Self {
        Self::formula(format!("a formula may have at most {most} parentheses, powers and signs"))
    }

    /// A function that does not exist.
    pub(crate) fn unknown_function(name: &str, known: &[&str]) -> Self {
        Self::formula(format!("there is no function {name}; there are {} and atan2", known.join(", ")))
    }

    /// A quantity in a formula that is no input.
    pub(crate) fn unknown_in_formula(name: &str, known: &[&str]) -> Self {
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        Self::formula(format!("there is no quantity {name}; there is {known}"))
    }

    /// Values for another number of quantities.
    pub(crate) fn wrong_number_of_values(needed: usize, found: usize) -> Self {
        Self::formula(format!("the formula has {needed} quantities, but {found} values were given"))
    }

    /// Error of a word that cannot be the name of a quantity of a formula.
    pub(crate) fn not_a_name(name: &str) -> Self {
        let what = format!(
            "a formula cannot contain a quantity `{name}`; a name is made of letters, digits and underscores, begins with no digit, and is \
             no constant or function"
        );
        Self::Inputs { what }
    }
}
