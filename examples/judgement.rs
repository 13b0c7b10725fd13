//! Trust in the default judgement, measured: `cargo run --release --example judgement`.
//!
//! Ring-downs of known truth are simulated, measured with what real measurements suffer from, and judged as the crates
//! judge them when nothing is asked for. One row a cell says how often the stated intervals hold the truth, how often a
//! miss comes without a warning, and how often a wrong law is decided for. Seeds are fixed for every cell and record:
//! the numbers are the same on any number of threads; times alone are not. `--list` lists the cells, and `--same` tells
//! whether a record in other units, or changed by 1e-9 of itself, is judged as before.

#[path = "judgement/mod.rs"]
mod judgement;

use std::io::Write as _;
use std::ops::Range;
use std::process::ExitCode;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use judgement::{Cell, Found, Summary, cells, document, sameness, speed, study, text};

/// Coverage and confusion of the default judgement.
#[derive(Debug, Parser)]
#[command(name = "judgement")]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own on the command line")]
struct Arguments {
    /// Few records: 2 a cell
    #[arg(long)]
    quick: bool,
    /// Records a cell, instead of 200 (30 for the cells of laws)
    #[arg(long)]
    seeds: Option<u64>,
    /// Number of the first record of each cell; rules were chosen by those from 0 on
    #[arg(long, default_value_t = 0, conflicts_with = "speed")]
    first: u64,
    /// Only these cells; the beginning of names, such as falling/, stands for all of them
    #[arg(long = "cell", value_name = "NAME", value_delimiter = ',')]
    names: Vec<String>,
    /// Threads
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
    /// List the cells, and stop
    #[arg(long)]
    list: bool,
    /// Judge each record twice more, in thousandths of its unit and changed by 1e-9 of itself, and count what changes
    #[arg(long, conflicts_with_all = ["json", "speed"])]
    same: bool,
    /// Time fits by the laws of many shapes instead, on all threads
    #[arg(long)]
    speed: bool,
    /// With `--speed`: only records of the law that is fitted
    #[arg(long, requires = "speed")]
    own: bool,
}

/// Records a cell with `--quick`.
const FEW: u64 = 2;

impl Arguments {
    /// The cells that are asked for: those of a name or, if there is none, those whose names begin so.
    fn chosen(&self) -> Found<Vec<Cell>> {
        let mut cells = cells();
        if self.names.is_empty() {
            return Ok(cells);
        }
        let mut chosen = vec![false; cells.len()];
        for name in &self.names {
            let is_cell = cells.iter().any(|cell| cell.name == *name);
            let mut matched = false;
            for (cell, chosen) in cells.iter().zip(&mut chosen) {
                if cell.name == *name || (!is_cell && cell.name.starts_with(name.as_str())) {
                    (*chosen, matched) = (true, true);
                }
            }
            if !matched {
                return Err(format!("there is no cell {name}; --list lists them").into());
            }
        }
        let mut chosen = chosen.into_iter();
        cells.retain(|_| chosen.next().unwrap_or(false));
        Ok(cells)
    }

    /// Numbers of the records of `cell`.
    fn records(&self, cell: &Cell) -> Range<u64> {
        let count = self.seeds.unwrap_or(if self.quick { FEW } else { cell.group.records() });
        self.first..self.first.saturating_add(count)
    }
}

/// Fits by the laws of many shapes: their time, and where they end.
fn run_speed(arguments: &Arguments) -> Found<()> {
    let is_chosen = |name: &str| arguments.names.is_empty() || arguments.names.iter().any(|chosen| chosen == name);
    let count = arguments.seeds.unwrap_or(FEW) as usize;
    let mut fits = Vec::new();
    for law in speed::FITS.iter().filter(|law| is_chosen(law.name)) {
        let records = (0..).filter(|record| !arguments.own || law.is_own(*record)).take(count);
        fits.push((law, records.map(|record| law.run(record)).collect::<Found<Vec<_>>>()?));
        if !arguments.json {
            eprint!("{}", speed::table(&fits[fits.len() - 1..]));
        }
    }
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&speed::document(&fits))?)?;
    } else {
        write!(out, "{}", speed::table(&fits))?;
    }
    Ok(())
}

fn run(arguments: &Arguments) -> Found<()> {
    if arguments.speed {
        return run_speed(arguments);
    }
    let cells = arguments.chosen()?;
    let mut out = std::io::stdout().lock();
    if arguments.list {
        for cell in &cells {
            writeln!(out, "{:<44} {}", cell.name, cell.about)?;
        }
        return Ok(());
    }
    let numbers: Vec<Range<u64>> = cells.iter().map(|cell| arguments.records(cell)).collect();
    let bar = ProgressBar::new(numbers.iter().map(|records| records.end - records.start).sum());
    bar.set_style(ProgressStyle::with_template("{wide_bar} {pos}/{len} records, {eta} left")?);
    if arguments.same {
        let told = sameness(&cells, &numbers, arguments.threads, &|| bar.inc(1));
        bar.finish_and_clear();
        write!(out, "{told}")?;
        return Ok(());
    }
    let outcomes = study(&cells, &numbers, arguments.threads, &|| bar.inc(1));
    bar.finish_and_clear();
    let summaries: Vec<Summary> =
        cells.iter().zip(&outcomes).map(|(cell, outcomes)| Summary::of(cell, outcomes)).collect();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&document(&summaries))?)?;
    } else {
        write!(out, "{}", text(&summaries))?;
    }
    Ok(())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("judgement: {error}");
            ExitCode::FAILURE
        }
    }
}
