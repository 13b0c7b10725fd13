//! The command line that all chapters share.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::{Chapter, Found, Settings, Target};

/// Numbers of the thesis beside ours.
#[derive(Debug, Parser)]
struct Arguments {
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
    /// Write the figures as SVG files into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Fewer repetitions
    #[arg(long)]
    quick: bool,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs `chapter` as the command line asks, prints it, and fails if a target is missed.
pub fn program(chapter: impl Fn(&Settings<'_>) -> Found<Chapter>) -> ExitCode {
    match run(&Arguments::parse(), chapter) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => {
            eprintln!("a target is missed");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments, chapter: impl Fn(&Settings<'_>) -> Found<Chapter>) -> Found<bool> {
    let bar = ProgressBar::new(1000);
    bar.set_style(ProgressStyle::with_template("{wide_bar} {percent} %, {eta} left")?);
    let watch = |share: f64| bar.set_position((1000.0 * share) as u64);
    let settings = Settings::new().quick(arguments.quick).with_seed(arguments.seed).with_progress(&watch);
    let chapter = chapter(&settings)?;
    bar.finish_and_clear();

    let mut out = std::io::stdout().lock();
    if arguments.json {
        let targets: Vec<_> = chapter.targets.iter().map(Target::document).collect();
        let findings: Vec<_> = chapter
            .findings
            .iter()
            .map(|finding| {
                json!({ "statement": finding.statement, "evidence": finding.evidence, "errata": finding.errata })
            })
            .collect();
        let document = json!({ "chapter": chapter.title, "targets": targets, "findings": findings });
        writeln!(out, "{}", serde_json::to_string_pretty(&document)?)?;
    } else {
        write!(out, "{chapter}")?;
    }
    if let Some(folder) = &arguments.figures {
        std::fs::create_dir_all(folder)?;
        for drawing in &chapter.drawings {
            std::fs::write(folder.join(drawing.name).with_extension("svg"), &drawing.svg)?;
        }
    }
    Ok(chapter.passes())
}
