//! Sameness of what is said of a record: as it is, in thousandths of its unit, and with changes far below its noise.

use std::fmt::Write as _;
use std::ops::Range;

use fmm_identify::{Comparison, Experiment, FrictionCurve, FrictionLevel, Inquiry, Machine, Preparation};
use fmm_record::{Quantity, Record};

use super::judge::{kind, named, plain};
use super::study::on_each_record;
use super::{Cell, Found};

/// A change of a value or of its standard uncertainty, over that, which is none (1).
const NONE: f64 = 0.01;
/// Largest change of a sample over itself (1).
const ROUNDING: f64 = 1e-9;

/// Statement about one record.
struct Statement {
    law: String,
    is_decided: bool,
    named: Vec<String>,
    warnings: Vec<String>,
    /// Frequency and damping by the law, with their standard uncertainties.
    by_law: Vec<(f64, f64)>,
    /// Friction by the curve, at rest, over the path and at the top speed, with its standard uncertainties.
    curve: Vec<(f64, f64)>,
}

impl Statement {
    /// The default judgement of `record`, with lengths times `scale`.
    fn of(record: &Record, scale: f64) -> Found<Self> {
        let experiments = [Experiment::ring_down(record, &Preparation::default())?];
        let found: Comparison = Inquiry::of(&Machine::per_unit_mass(), &experiments).on_threads(1).search()?;
        let preferred = found.preferred();
        // A remark on units is no statement on the record.
        let mut warnings: Vec<String> = found.warnings().iter().map(kind).filter(|kind| kind != "NotSi").collect();
        warnings.sort();
        warnings.dedup();
        let number = |name| preferred.finding(name).and_then(|found| Some((found.value(), found.uncertainty()?)));
        let level = |level: FrictionLevel| (scale * level.value(), scale * level.uncertainty());
        let levels = |curve: FrictionCurve| [curve.at_rest(), curve.mean_over_path(), curve.at_top_speed()].map(level);
        let curve = FrictionCurve::beside(preferred, &experiments).map(levels);
        Ok(Self {
            law: plain(preferred.law()),
            is_decided: found.is_decided(),
            named: named(&found),
            warnings,
            by_law: ["natural_frequency_hz", "damping_per_mass"].into_iter().filter_map(number).collect(),
            curve: curve.map_or_else(|_| Vec::new(), |levels| levels.to_vec()),
        })
    }

    /// Differences in `other`: the law and whether it is decided, the laws that are left, the warnings, the numbers by
    /// the same law, and those of the curve.
    fn differs_from(&self, other: &Self) -> [bool; 5] {
        let law = (&self.law, self.is_decided) != (&other.law, other.is_decided);
        let by_law = !law && largest_change(&self.by_law, &other.by_law) > NONE;
        let curve = largest_change(&self.curve, &other.curve) > NONE;
        [law, self.named != other.named, self.warnings != other.warnings, by_law, curve]
    }
}

/// The largest change of numbers and of their uncertainties, over these (1); endless if others are stated.
fn largest_change(some: &[(f64, f64)], others: &[(f64, f64)]) -> f64 {
    if some.len() != others.len() {
        return f64::INFINITY;
    }
    let change = |((x, u), (y, v)): (&(f64, f64), &(f64, f64))| ((x - y).abs() / u).max((v / u - 1.0).abs());
    some.iter().zip(others).map(change).fold(0.0, f64::max)
}

/// Differences for record number `record` of `cell` in thousandths of its unit, and where it is rounded.
fn differences(cell: &Cell, record: u64) -> Found<[[bool; 5]; 2]> {
    let record = cell.case(record)?.record;
    let thousandths = if record.quantity() == Quantity::Displacement { "mm" } else { "mm/s" };
    let written =
        |values: Vec<f64>, unit: &str| Record::new(record.start(), record.interval(), values, record.quantity(), unit);
    // Multiples of the golden ratio are spread evenly and lie on no lattice.
    let rounded = |(i, x): (usize, &f64)| x * (1.0 + ROUNDING * (0.618_033_988_75 * i as f64).fract());
    let in_thousandths = written(record.values().iter().map(|x| 1e3 * x).collect(), thousandths)?;
    let rounded = written(record.values().iter().enumerate().map(rounded).collect(), record.unit())?;
    let said = Statement::of(&record, 1.0)?;
    Ok([said.differs_from(&Statement::of(&in_thousandths, 1e-3)?), said.differs_from(&Statement::of(&rounded, 1.0)?)])
}

/// A line for each cell and way of writing: how many records there are, and of how many what differs.
pub(crate) fn sameness(cells: &[Cell], numbers: &[Range<u64>], threads: usize, done: &(dyn Fn() + Sync)) -> String {
    let results = on_each_record(cells, numbers, threads, done, differences);
    let mut text = format!(
        "{:<44} {:<12} {:>4} {:>5} {:>5} {:>5} {:>8} {:>7} {:>5}\n",
        "cell", "written", "n", "fail", "law", "left", "warnings", "numbers", "curve"
    );
    for (cell, results) in cells.iter().zip(&results) {
        for (place, written) in ["thousandths", "rounded"].into_iter().enumerate() {
            let said: Vec<[bool; 5]> = results.iter().flatten().map(|differences| differences[place]).collect();
            let [law, left, warnings, numbers, curve] =
                std::array::from_fn(|what| said.iter().filter(|differs| differs[what]).count());
            let failed = results.len() - said.len();
            let _ = writeln!(
                text,
                "{:<44} {written:<12} {:>4} {failed:>5} {law:>5} {left:>5} {warnings:>8} {numbers:>7} {curve:>5}",
                cell.name,
                results.len(),
            );
        }
    }
    text
}
