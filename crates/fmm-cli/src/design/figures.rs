//! Pictures of a plan: the uncertainty against each number that the tests vary.

use std::path::Path;

use super::Answer;
use super::candidates::unit;
use crate::figure::{Layer, Panel, Role, label, stacked};

/// Uncertainties above this multiple of the smallest are left out of a picture (1).
const IN_SIGHT: f64 = 20.0;

/// One panel for each number of which the tests have several: every test, the best at each value, and those chosen.
///
/// # Errors
/// If the file cannot be written.
pub(super) fn draw(folder: &Path, answer: &Answer) -> std::io::Result<()> {
    let panels = panels(answer);
    if panels.is_empty() { Ok(()) } else { stacked(&folder.join("design.svg"), &panels) }
}

fn panels(answer: &Answer) -> Vec<Panel> {
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
        let best = best.collect();
        let chosen = answer.best.chosen.iter().filter_map(|(place, _)| at(&answer.tests[*place])).collect();
        let axis = match unit(name).trim() {
            "" => name.replace('_', " "),
            unit => label(name.replace('_', " "), unit),
        };
        let panel = Panel::new(axis, label(format!("u of {}", answer.aim), "%"), 320.0)
            .with(Layer::new(Role::Points, "each test by itself", all))
            .with(Layer::new(Role::Fitted, "the best at each value", best))
            .with(Layer::new(Role::ResidualPoints, "in the best set", chosen));
        Some(panel)
    };
    names.into_iter().filter_map(panel).collect()
}
