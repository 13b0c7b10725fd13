//! Corner plot of a posterior: each parameter by itself on the diagonal, each pair below it.

use fmm_fit::posterior::Marginal;

use crate::figure::{Cells, Panel, Role, drawn_corner, label};
use crate::page::words;

/// More panels side by side cannot be read.
const MOST: usize = 6;
/// Bins of a parameter, and of each one of a pair.
const BINS: usize = 40;
const CELLS: usize = 28;
/// Height of a panel (px).
const HEIGHT: f64 = 210.0;
/// Share of the draws left out beyond either end, so that a few far ones do not squeeze the picture.
const LEFT_OUT: f64 = 0.002;

/// The plot of the first six `marginals`, as SVG.
pub(crate) fn corner(marginals: &[&Marginal]) -> String {
    let shown = &marginals[..marginals.len().min(MOST)];
    let last = shown.len().saturating_sub(1);
    let of = |marginal: &Marginal| {
        let name = words(marginal.parameter().name());
        if marginal.parameter().unit() == "1" { name } else { label(name, marginal.parameter().unit()) }
    };
    let panel = |row: usize, column: usize| {
        let x_label = if row == last { of(shown[column]) } else { String::new() };
        if row == column {
            return Panel::new(x_label, "", HEIGHT).with(Role::Fitted, "", density(shown[row]));
        }
        let y_label = if column == 0 { of(shown[row]) } else { String::new() };
        Panel::new(x_label, y_label, HEIGHT).over(pair(shown[column], shown[row]))
    };
    let rows: Vec<Vec<Panel>> =
        (0..shown.len()).map(|row| (0..=row).map(|column| panel(row, column)).collect()).collect();
    drawn_corner(&rows)
}

fn range(marginal: &Marginal) -> (f64, f64) {
    let end = |level: f64| marginal.quantile(level).unwrap_or(marginal.mean());
    (end(LEFT_OUT), end(1.0 - LEFT_OUT))
}

/// The bin of a value, of `count` bins over the range; `None` outside of the range.
fn bin(value: f64, (low, high): (f64, f64), count: usize) -> Option<usize> {
    let share = (value - low) / (high - low);
    (0.0..1.0).contains(&share).then_some((share * count as f64) as usize)
}

/// The outline of a histogram.
fn density(marginal: &Marginal) -> Vec<(f64, f64)> {
    let range = range(marginal);
    let mut counts = [0.0; BINS];
    let bins = marginal.draws().iter().filter_map(|draw| bin(*draw, range, BINS));
    bins.for_each(|bin| counts[bin] += 1.0);
    let width = (range.1 - range.0) / BINS as f64;
    let scale = 1.0 / (marginal.draws().len() as f64 * width);
    let steps = counts.iter().enumerate().flat_map(|(i, count)| {
        let left = range.0 + i as f64 * width;
        [(left, count * scale), (left + width, count * scale)]
    });
    std::iter::once((range.0, 0.0)).chain(steps).chain([(range.1, 0.0)]).collect()
}

/// Draws in each cell, relative to the fullest cell.
fn pair(x: &Marginal, y: &Marginal) -> Cells {
    let ranges = [range(x), range(y)];
    let mut rows = vec![vec![0.0; CELLS]; CELLS];
    for (x, y) in x.draws().iter().zip(y.draws()) {
        if let (Some(column), Some(row)) = (bin(*x, ranges[0], CELLS), bin(*y, ranges[1], CELLS)) {
            rows[row][column] += 1.0;
        }
    }
    let fullest = rows.iter().flatten().fold(1.0f64, |most, count| most.max(*count));
    rows.iter_mut().flatten().for_each(|count| *count /= fullest);
    Cells { rows, x: ranges[0], y: ranges[1] }
}

#[cfg(test)]
mod tests {
    use fmm_model::Parameter;

    use super::*;

    #[test]
    fn a_density_has_the_area_of_what_is_shown() {
        let draws = (0..4000).map(|i| f64::from(i) * 1e-3).collect();
        let marginal = Marginal::new(Parameter::new("load", "N", "N"), draws, 4).unwrap();
        let outline = density(&marginal);
        let area: f64 = outline.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum();
        // All but a share of 0.002 beyond either end, and the draw at the upper end itself.
        assert!((area - 0.996).abs() < 1e-3, "{area}");
        let svg = corner(&[&marginal, &marginal]);
        assert!(svg.starts_with("<svg") && svg.contains("load / N"));
    }
}
