//! Result of one chapter of the thesis: targets, tables, figures, findings.

use std::fmt::{self, Write as _};

use crate::Target;
use fmm_cli::figure::{self, Panel};

/// A chapter's results in the order in which they are shown.
#[derive(Debug, Clone, Default)]
pub struct Chapter {
    /// Such as "5.3 Monte Carlo".
    pub title: String,
    /// Numbers with a criterion.
    pub targets: Vec<Target>,
    /// Printed tables beside ours, row by row.
    pub tables: Vec<Table>,
    /// Findings that have to be said in words.
    pub findings: Vec<Finding>,
    /// Pictures.
    pub drawings: Vec<Drawing>,
}

/// Cells under headings.
#[derive(Debug, Clone)]
pub struct Table {
    /// Content in words, with the number of the thesis' table if it is one of those.
    pub caption: String,
    /// One per column, with units.
    pub headings: Vec<String>,
    /// Cells as they are shown.
    pub rows: Vec<Vec<String>>,
}

/// Something to know, with its evidence.
#[derive(Debug, Clone)]
pub struct Finding {
    /// The statement, short.
    pub statement: String,
    /// The numbers that show it.
    pub evidence: String,
    /// Errata of `docs/errata.md` that it concerns, such as E25.
    pub errata: Vec<&'static str>,
}

/// One figure.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// File name without extension, such as `figure_11`.
    pub name: &'static str,
    /// Content in words, and what of it was simulated.
    pub caption: String,
    /// The picture.
    pub svg: String,
}

impl Chapter {
    /// An empty chapter.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Adds a target.
    pub fn target(&mut self, target: Target) {
        self.targets.push(target);
    }

    /// Adds a table.
    pub fn table(&mut self, caption: impl Into<String>, headings: &[&str], rows: Vec<Vec<String>>) {
        let headings = headings.iter().map(|&heading| heading.to_owned()).collect();
        self.tables.push(Table { caption: caption.into(), headings, rows });
    }

    /// Adds a statement with its evidence and the errata that it concerns.
    pub fn finding(&mut self, statement: impl Into<String>, evidence: impl Into<String>, errata: &[&'static str]) {
        self.findings.push(Finding { statement: statement.into(), evidence: evidence.into(), errata: errata.to_vec() });
    }

    /// Adds a figure of panels one below the other.
    pub(crate) fn figure(&mut self, name: &'static str, caption: impl Into<String>, panels: &[Panel]) {
        self.drawings.push(Drawing { name, caption: caption.into(), svg: figure::drawn(panels) });
    }

    /// True if every target passes.
    pub fn passes(&self) -> bool {
        self.targets.iter().all(Target::passes)
    }

    /// The targets as the rows of a table.
    pub fn target_table(&self) -> Table {
        Table {
            caption: String::new(),
            headings: ["id", "quantity", "thesis", "ours", "difference", "required", "kind", "", "note"]
                .map(str::to_owned)
                .to_vec(),
            rows: self.targets.iter().map(|target| target.cells().to_vec()).collect(),
        }
    }
}

impl fmt::Display for Chapter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.title)?;
        writeln!(f, "{}", self.target_table())?;
        for table in &self.tables {
            writeln!(f, "{}\n{table}", table.caption)?;
        }
        for finding in &self.findings {
            let errata =
                if finding.errata.is_empty() { String::new() } else { format!(" [{}]", finding.errata.join(", ")) };
            writeln!(f, "* {}{errata}\n  {}", finding.statement, finding.evidence)?;
        }
        Ok(())
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column)).chain(self.headings.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.headings.len()).map(width).collect();
        for row in std::iter::once(&self.headings).chain(&self.rows) {
            let mut line = String::new();
            for (cell, width) in row.iter().zip(&widths) {
                write!(line, "{cell:<width$}  ")?;
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}
