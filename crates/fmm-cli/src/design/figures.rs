//! Pictures of a plan: the uncertainty against each number that the tests vary.

use super::Choice;
use super::candidates::unit;
use crate::figure::{Panel, Role, drawn, label};

/// Uncertainties above this multiple of the smallest are left out of a picture (1).
const IN_SIGHT: f64 = 20.0;

/// One panel for each number of which the tests have several: every test, the best at each value, and those chosen.
pub(super) fn picture(answer: &Choice) -> Option<(String, String)> {
    let least = answer.tests.iter().filter_map(|test| test.u).fold(f64::INFINITY, f64::min);
    let mut names: Vec<&'static str> = answer.tests.iter().flat_map(|test| test.settings.keys().copied()).collect();
    names.sort_unstable();
    names.dedup();
    let panel = |name: &'static str| {
        let at =
            |test: &super::Row| Some((*test.settings.get(name)?, 100.0 * test.u.filter(|u| *u < IN_SIGHT * least)?));
        let mut values: Vec<f64> = answer.tests.iter().filter_map(|test| test.settings.get(name).copied()).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        if values.len() < 2 {
            return None;
        }
        let all: Vec<(f64, f64)> = answer.tests.iter().filter_map(at).collect();
        let best = values.iter().filter_map(|value| {
            let u = all.iter().filter(|point| point.0 == *value).map(|point| point.1).fold(f64::INFINITY, f64::min);
            u.is_finite().then_some((*value, u))
        });
        let chosen = answer.best.chosen.iter().filter_map(|(place, _)| at(&answer.tests[*place]));
        let axis = match unit(name).trim() {
            "" => name.replace('_', " "),
            unit => label(name.replace('_', " "), unit),
        };
        let panel = Panel::new(axis, label(format!("u of {}", answer.aim), "%"), 320.0)
            .with(Role::Points, "each test by itself", all.iter().copied())
            .with(Role::Fitted, "the best at each value", best)
            .with(Role::ResidualPoints, "in the best set", chosen);
        Some(panel)
    };
    let panels: Vec<Panel> = names.into_iter().filter_map(panel).collect();
    (!panels.is_empty()).then(|| ("design.svg".to_owned(), drawn(&panels)))
}
