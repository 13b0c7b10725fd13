//! A budget for other programs.

use serde::{Serialize, Serializer};

use crate::gum::budget::{Budget, Contribution};
use crate::inputs::Input;

/// Document of a budget; infinite and unknown numbers are none.
#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct Document<'a> {
    name: &'a str,
    unit: &'a str,
    estimate: f64,
    standard_uncertainty: f64,
    effective_degrees_of_freedom: Option<f64>,
    contributions: Vec<Row<'a>>,
    correlations: Vec<Correlation<'a>>,
    suspect: bool,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct Row<'a> {
    quantity: &'a str,
    estimate: f64,
    unit: &'a str,
    distribution: String,
    #[serde(rename = "type")]
    evaluation: String,
    divisor: f64,
    standard_uncertainty: f64,
    degrees_of_freedom: Option<f64>,
    sensitivity: f64,
    sensitivity_unit: String,
    contribution: f64,
    /// Share of the variance (1); none for a correlated input, whose share may be negative.
    share: Option<f64>,
    share_with_correlations: f64,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
struct Correlation<'a> {
    first: &'a str,
    second: &'a str,
    coefficient: f64,
}

impl<'a> Row<'a> {
    fn new(budget: &Budget, row: Contribution<'a>, is_correlated: bool) -> Self {
        let input = row.input;
        Self {
            quantity: input.name(),
            estimate: input.value(),
            unit: input.unit(),
            distribution: input.distribution().to_string(),
            evaluation: input.evaluation().to_string(),
            divisor: input.distribution().divisor(),
            standard_uncertainty: input.standard_uncertainty(),
            degrees_of_freedom: Some(input.degrees_of_freedom()).filter(|nu| nu.is_finite()),
            sensitivity: row.sensitivity,
            sensitivity_unit: budget.unit_of_sensitivity(input.unit()),
            contribution: row.uncertainty,
            share: (!is_correlated).then_some(row.share.clamp(0.0, 1.0)),
            share_with_correlations: row.share,
        }
    }
}

#[cfg(feature = "schemars")]
impl schemars::JsonSchema for Budget {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Budget".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        Document::json_schema(generator)
    }
}

impl Serialize for Budget {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let names: Vec<&str> = self.inputs().as_slice().iter().map(Input::name).collect();
        let correlation = |(i, j): (usize, usize)| {
            let coefficient = self.inputs().correlation_at(i, j);
            Correlation { first: names[i], second: names[j], coefficient }
        };
        let is_correlated = |i: usize| self.inputs().correlated_pairs().any(|(j, k)| i == j || i == k);
        let document = Document {
            name: self.name(),
            unit: self.unit(),
            estimate: self.estimate(),
            standard_uncertainty: self.standard_uncertainty(),
            effective_degrees_of_freedom: self.effective_degrees_of_freedom().filter(|nu| nu.is_finite()),
            contributions: self
                .contributions()
                .enumerate()
                .map(|(i, row)| Row::new(self, row, is_correlated(i)))
                .collect(),
            correlations: self.inputs().correlated_pairs().map(correlation).collect(),
            suspect: self.linearisation().is_suspect(),
        };
        document.serialize(serializer)
    }
}
