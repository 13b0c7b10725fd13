//! The tables as one JSON document.

use serde_json::{Value, json};

use super::Summary;
use super::summary::Share;

/// All `summaries`.
pub(crate) fn document(summaries: &[Summary]) -> Value {
    let cells: Vec<Value> = summaries.iter().map(cell).collect();
    json!({ "cells": cells })
}

fn cell(summary: &Summary) -> Value {
    let share = |share: Share| json!({ "count": share.count, "of": share.of, "percent": share.percent() });
    json!({
        "name": summary.name,
        "records": summary.records,
        "failures": summary.failures,
        "first_failure": summary.failure,
        "without_mu": summary.without_mu,
        "bias_of_mu": summary.bias,
        "median_error_of_mu": summary.median_error,
        "scatter_over_u_of_mu": summary.scatter,
        "coverage_of_mu": share(summary.mu),
        "coverage_of_damping": share(summary.damping),
        "coverage_of_frequency": share(summary.frequency),
        "loud_misses": summary.loud_misses,
        "silent_misses": summary.silent_misses,
        "decided": summary.decided,
        "decided_right": summary.right,
        "decided_wrong_loud": summary.wrong_loud,
        "decided_wrong_silent": summary.wrong_silent,
        "undecided_with_truth": summary.among,
        "undecided_without_truth": summary.not_among,
        "silently_wrong": summary.silently_wrong,
        "preferred": summary.preferred,
        "named": summary.named,
        "warnings": summary.warnings,
        "median_seconds": summary.median_seconds(),
    })
}
