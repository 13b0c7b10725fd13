//! Pooled friction curves as text and on the page.

use std::iter;

use fmm_model::Rounded;

use super::{Pooled, PooledCurve, PooledLevel, quantity};
use crate::batch::summary::Excluded;
use crate::batch::table::probability;
use crate::figure::{Panel, Role, drawn, label};
use crate::output::of_size;
use crate::page::{bullets, escaped, figure, row_heading, section as page_section, table, text_cell, words};

/// Curves of records that a figure has room for.
const DRAWN: usize = 100;

impl PooledCurve {
    /// Friction of which records, in a phrase.
    fn heading(&self) -> String {
        let whole = if self.whole_resistance { "" } else { ", without the declared damping" };
        let loads = match self.loads {
            None => String::new(),
            Some((low, high)) if low == high => format!(" under {low} N"),
            Some((low, high)) => format!(" under {low} N to {high} N"),
        };
        let common = if self.common_speeds.is_some() { "" } else { ", with no speed that all were sampled at" };
        format!("friction over speed, no law assumed{whole}, of {} records{loads}{common}", self.records.len())
    }

    /// Headings of the columns of a table, and its rows.
    fn cells(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let is_over_load = self.levels.iter().any(|level| level.over_load.is_some());
        let columns = ["mean ± u", "95 % interval", "shared u", "spread τ", "p"].map(str::to_owned);
        let over_load = is_over_load.then(|| "force without load / N (p)".to_owned());
        let headings = iter::once(quantity(&self.unit)).chain(columns).chain(over_load).collect();
        let row = |level: &PooledLevel| {
            let friction = &level.friction;
            let place = match level.speed {
                Some(speed) => format!("at {} {}", Rounded::significant(speed, 3), self.speed_unit),
                None => words(friction.name.trim_start_matches("friction_")),
            };
            let rounded = Rounded::new(friction.mean, Some(friction.u));
            let [low, high] = friction.interval_95;
            let over_load = level.over_load.as_ref().map(|over_load| match &over_load.line {
                Some(line) => {
                    let force = Rounded::new(line.intercept, Some(line.intercept_u));
                    format!("{force} ({})", short(line.p))
                }
                None => "–".to_owned(),
            });
            [place, rounded.to_string(), rounded.interval(low, high), of_size(friction.shared_u)]
                .into_iter()
                .chain([of_size(friction.between), short(friction.p)])
                .chain(over_load)
                .collect()
        };
        (headings, self.levels.iter().map(row).collect())
    }

    fn picture(&self, index: usize) -> String {
        let step = self.each.len().div_ceil(DRAWN);
        let panel = Panel::new(label("speed", &self.speed_unit), quantity(&self.unit), 380.0);
        let panel = self
            .each
            .iter()
            .step_by(step.max(1))
            .fold(panel, |panel, points| panel.with(Role::Each, "records", points.iter().copied()));
        let part = |value: fn(&(f64, f64, f64, f64)) -> f64| self.band.iter().map(move |at| (at.0, value(at)));
        let panel = panel
            .with(Role::Mean, "mean", part(|at| at.1))
            .with(Role::Reference, "its 95 % interval", part(|at| at.2))
            .with(Role::Reference, "", part(|at| at.3));
        let some = if step > 1 { format!(", one of {step} drawn") } else { String::new() };
        let caption =
            format!("Grey: {}{some}. Red: their mean at each speed; dark: its 95 % interval.", self.heading());
        figure(&drawn(&[panel]), &caption, &format!("friction_curve-{index}"))
    }
}

/// A probability without its letter.
fn short(p: f64) -> String {
    probability(p).trim_start_matches("= ").to_owned()
}

/// Pooled curves as tables for the eye, and what was left out.
pub(in crate::batch) fn lines(pooled: &Pooled) -> Vec<String> {
    let mut lines = left_out(pooled);
    for curve in &pooled.curves {
        lines.push(format!("{}; spread τ from record to record, p of records alike:", curve.heading()));
        let (headings, rows) = curve.cells();
        let all: Vec<&Vec<String>> = iter::once(&headings).chain(&rows).collect();
        let width = |column: usize| all.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..headings.len()).map(width).collect();
        lines.extend(all.iter().map(|row| {
            let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
            format!("  {}", cells.collect::<Vec<_>>().join("  ")).trim_end().to_owned()
        }));
    }
    lines
}

/// Records without a curve that counts, and why there is no mean.
fn left_out(pooled: &Pooled) -> Vec<String> {
    let record = |one: &Excluded| format!("no friction curve that counts: {}: {}", one.file, one.reason);
    let missing = pooled.missing.iter().map(|why| format!("friction over speed of all records: none, as {why}"));
    pooled.left_out.iter().map(record).chain(missing).collect()
}

/// The section of the page.
pub(in crate::batch) fn section(pooled: &Pooled) -> String {
    let curves = pooled.curves.iter().enumerate().map(|(index, curve)| {
        let (headings, rows) = curve.cells();
        let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
        let cells = |row: &Vec<String>| {
            let (place, values) = row.split_first().map_or(("", &[][..]), |(place, values)| (place.as_str(), values));
            iter::once(row_heading(place)).chain(values.iter().map(|value| text_cell(value))).collect()
        };
        curve.picture(index) + &table("findings", &headings, rows.iter().map(cells))
    });
    let text = format!(
        "<p>{}</p>\n",
        escaped(
            "Each record has a curve by itself; at each speed they have a consensus with random effects, between the \
             highest of the lowest speeds that they were sampled at and the lowest of their top speeds. What all curves \
             are given beforehand, their smoothness, is shared and does not average out."
        )
    );
    page_section("Friction over speed", &(text + &curves.collect::<String>() + &bullets(left_out(pooled))))
}
