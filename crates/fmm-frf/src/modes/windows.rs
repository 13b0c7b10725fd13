//! Windows of lines in which poles are looked for.

use std::ops::Range;

use super::band::Band;
use super::diagram::{StabilisationDiagram, by_frequency};
use super::normal_equations::Denominators;
use super::pole::Pole;
use super::table::Table;
use super::tracks::stable_poles;
use crate::error::FrfError;

/// Number of lines above which a band is divided. Origin: measured hammer blows, whose modes are one to two lines wide:
/// a window of 400 lines shows them, one of 1700 some, one of 7000 only the strongest.
const UNDIVIDED: usize = 600;
/// Parts of a window that overlap by half, of a size of a quarter each.
const PARTS: usize = 7;

/// The diagram of a band and its stable poles.
pub(super) struct Search {
    pub(super) diagram: StabilisationDiagram,
    /// In the order of their frequencies.
    pub(super) stable: Vec<Pole>,
}

impl Search {
    /// Up to `order` in each window that has lines enough for it.
    pub(super) fn of(band: &Band, table: &Table, order: usize) -> Result<Self, FrfError> {
        let mut diagrams = Vec::new();
        let mut stable: Vec<Pole> = Vec::new();
        // The smallest windows first: what larger ones show besides is wider.
        for Window { lines, counting } in windows(band.len()).iter().rev() {
            let order = order.min((lines.len() / 2).saturating_sub(1));
            let ends = (band.frequencies[counting.start], band.frequencies[counting.end - 1]);
            let denominators = match Denominators::of(band, lines.clone(), table, order) {
                Ok(denominators) => denominators,
                // Of a part without a signal nothing follows; all lines together have one.
                Err(_) if lines.len() < band.len() => continue,
                Err(error) => return Err(error),
            };
            let diagram = StabilisationDiagram::of(&denominators, ends);
            let is_new = |pole: &Pole, known: &[Pole]| {
                let is_it = |other: &Pole| (pole.0 - other.0).norm() < pole.0.re.abs().max(other.0.re.abs());
                !known.iter().any(is_it)
            };
            let found: Vec<Pole> = stable_poles(&diagram).into_iter().filter(|pole| is_new(pole, &stable)).collect();
            stable.extend(found);
            diagrams.push(diagram);
        }
        let diagram = StabilisationDiagram::joined(diagrams);
        if diagram.poles().is_empty() {
            let (low, high) = band.ends();
            return Err(FrfError::no_mode("modal fit", low, high));
        }
        stable.sort_by(by_frequency);
        Ok(Self { diagram, stable })
    }
}

/// Lines of a window, and those of them whose poles count: all but a quarter on either side that has neighbours.
struct Window {
    lines: Range<usize>,
    counting: Range<usize>,
}

/// All lines, and where these are many, windows of a quarter of them, and so on.
fn windows(count: usize) -> Vec<Window> {
    let mut windows = vec![Window { lines: 0..count, counting: 0..count }];
    let (mut parts, mut size) = (1, count);
    while size > UNDIVIDED {
        (parts, size) = (parts * PARTS.div_ceil(2), size / 4);
        let number = 2 * parts - 1;
        windows.extend((0..number).map(|part| {
            let start = (count - size) * part / (number - 1);
            let begin = if part == 0 { 0 } else { start + size / 4 };
            // One line more, so that no pole between two windows is lost.
            let end = if part == number - 1 { count } else { start + size - size / 4 + 1 };
            Window { lines: start..start + size, counting: begin..end }
        }));
    }
    windows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_of_each_size_cover_all_lines() {
        assert_eq!(windows(600).len(), 1);
        for count in [601, 2400, 6979, 50_001] {
            let windows = windows(count);
            let sizes: std::collections::BTreeSet<usize> = windows.iter().map(|window| window.lines.len()).collect();
            for size in sizes {
                let of_size: Vec<_> = windows.iter().filter(|window| window.lines.len() == size).collect();
                let mut end = 0;
                for Window { lines, counting } in of_size {
                    assert!(counting.start <= end, "{count} lines, {size} each: a gap at {end}");
                    assert!(lines.start <= counting.start && counting.end <= lines.end);
                    end = counting.end;
                }
                assert_eq!(end, count, "{size} each");
            }
        }
    }
}
