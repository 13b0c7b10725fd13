//! The same laws on records that others measured.

use std::path::{Path, PathBuf};

use fmm_identify::{Comparison, Experiment, Identification, Machine, Preparation, Terms, compare};
use fmm_record::{Quantity, Reader, Record};

use super::{candidates, side_by_side};
use crate::{Chapter, Found, Settings};

/// A record and what it is of.
struct Measured {
    name: &'static str,
    record: Record,
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data").join(name)
}

fn wheel() -> Found<Measured> {
    let reader = Reader::default().quantity(Quantity::Velocity).unit("rad/s");
    let record = reader.read(path("bicycle_wheel_radial_gyro.csv"))?.record;
    Ok(Measured { name: "bicycle wheel on a torsion bar", record })
}

fn fork() -> Found<Measured> {
    let reader = Reader::default().channel("data").quantity(Quantity::Velocity).unit("V");
    let record = reader.read(path("BrowserForkCompoundFirst1.mat"))?.record;
    Ok(Measured { name: "bicycle fork as a pendulum", record })
}

pub(super) fn add(chapter: &mut Chapter, settings: &Settings<'_>) -> Found<()> {
    let candidates = candidates(&Terms::default().with_linear_damping())?;
    // The fork swings for 30 s, in which two laws are enough to see what a state adds.
    let mut measured = vec![(wheel()?, &candidates[..])];
    if !settings.is_quick() {
        measured.push((fork()?, &candidates[..2]));
    }
    let (mut rows, mut verdicts) = (Vec::new(), Vec::new());
    let compared = |index: usize| -> Found<Comparison> {
        let (one, candidates) = &measured[index];
        let decay = Experiment::ring_down(&one.record, &Preparation::default())?;
        Ok(compare(&Machine::per_unit_mass(), &[decay], candidates)?)
    };
    for ((one, _), comparison) in measured.iter().zip(side_by_side(measured.len(), &compared)) {
        let comparison = comparison?;
        rows.extend(rows_of(one, &comparison));
        verdicts.push(verdict(one, &comparison)?);
    }
    chapter.table("Measured records, fitted by dry friction and by laws with a state", &HEADINGS, rows);
    chapter.finding(
        "A law with a state that fits a measured record better is not yet presliding.",
        format!(
            "Measured by others: {}. Nor would more help: a contact softer than the machine bends with all of the motion, as a softening \
             spring does, or the sine of a pendulum, whose frequency rises as well when the swings get smaller. Laws with a state are told \
             from those by what happens at the turns, and by loads of different size.",
            verdicts.join("; ")
        ),
        &[],
    );
    Ok(())
}

/// Which law the record prefers by how much, and what it tells of the contact's stiffness by Dahl's law.
fn verdict(one: &Measured, comparison: &Comparison) -> Found<String> {
    let [_, dahl, ..] = comparison.identifications() else { return Err("Dahl's law was not fitted".into()) };
    let preferred = comparison.preferred();
    let others = comparison.identifications().iter().zip(comparison.scores());
    let (own, others): (Vec<_>, Vec<_>) = others.partition(|(found, _)| found.law() == preferred.law());
    let least =
        |scores: &[(&Identification, &f64)]| scores.iter().map(|(_, score)| **score).fold(f64::INFINITY, f64::min);
    let residuals = dahl.rms_residual() / comparison.identifications()[0].rms_residual();
    let stiffness = dahl.finding("contact_stiffness_per_mass").ok_or("Dahl's law has a stiffness")?;
    let frequency = dahl.finding("natural_frequency_hz").ok_or("a ring-down has a frequency")?.value();
    Ok(format!(
        "{}: {} is preferred, by {:.0} in Akaike's criterion; Dahl's law leaves {:.1} % less than dry friction, and its stiffness \
         {stiffness} is {:.1} times that of the machine",
        one.name,
        preferred.law(),
        least(&others) - least(&own),
        100.0 * (1.0 - residuals),
        stiffness.value() / (std::f64::consts::TAU * frequency).powi(2)
    ))
}

const HEADINGS: [&str; 6] =
    ["record", "law", "rms residual", "Akaike less best", "friction per mass", "contact stiffness per mass / (1/s²)"];

fn rows_of(one: &Measured, comparison: &Comparison) -> Vec<Vec<String>> {
    let least = comparison.scores().iter().copied().fold(f64::INFINITY, f64::min);
    let row = |(found, score): (&Identification, &f64)| {
        let text = |name: &str| found.finding(name).map_or_else(|| "–".to_owned(), ToString::to_string);
        vec![
            one.name.to_owned(),
            found.law().to_owned(),
            format!("{:.3e} {}", found.rms_residual(), one.record.unit()),
            format!("{:.1}", score - least),
            text("friction_per_mass"),
            text("contact_stiffness_per_mass"),
        ]
    };
    comparison.identifications().iter().zip(comparison.scores()).map(row).collect()
}
