//! A campaign: which records, how each is read, and what describes it.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{CommandFactory, Parser};
use fmm_identify::Experiment;
use serde::{Deserialize, Serialize};

use super::manifest::{EXCLUDE, FILE, Manifest, exclusion, listed};
use super::sheet::Sheet;
use crate::files::{self, create_folder, named};
use crate::host::Host;
use crate::input::{DRIVES, Given, Input, Question};
use crate::refusal::Kind;

/// The records of a campaign, in their order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Campaign {
    /// Options of `fmm identify` for all of them.
    pub(crate) options: Vec<String>,
    /// The column that says which belong together.
    pub(crate) group: Option<String>,
    /// Entries of the manifest for the record sheet.
    pub(crate) sheet: Option<Sheet>,
    /// True if no friction curves are fitted.
    #[serde(default)]
    pub(crate) without_curves: bool,
    pub(crate) entries: Vec<Entry>,
}

/// One record of a campaign.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Entry {
    #[serde(with = "files::exact")]
    pub(crate) file: PathBuf,
    /// Options of `fmm identify` for it alone.
    pub(crate) options: Vec<String>,
    /// Description by column.
    pub(crate) description: BTreeMap<String, String>,
    /// Why the manifest leaves it out, empty where it gives no reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) excluded: Option<String>,
}

/// Name of the list in the folder of a campaign.
const LIST: &str = "list.json";

impl Campaign {
    /// Campaign of files, and of the files in folders, by name.
    pub(crate) fn of_files(records: &[PathBuf], options: Vec<String>) -> Result<Self, Box<dyn Error>> {
        let mut files = Vec::new();
        for path in records {
            if !path.is_dir() {
                files.push(path.clone());
                continue;
            }
            let unreadable = |error| format!("cannot read {}: {error}", path.display());
            let mut inside = Vec::new();
            for entry in std::fs::read_dir(path).map_err(unreadable)? {
                let file = entry.map_err(unreadable)?.path();
                let is_hidden = file.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
                if file.is_file() && !is_hidden {
                    inside.push(file);
                }
            }
            inside.sort();
            files.extend(inside);
        }
        if files.is_empty() {
            return Err("there is no record in these folders".into());
        }
        let entry = |file| Entry { file, ..Entry::default() };
        let entries = files.into_iter().map(entry).collect();
        Ok(Self { options, group: None, sheet: None, without_curves: false, entries })
    }

    /// Campaign of a manifest; a `group` goes before the one that it names.
    pub(crate) fn of_manifest(
        path: &Path,
        options: Vec<String>,
        group: Option<String>,
        host: &Host<'_>,
    ) -> Result<Self, Box<dyn Error>> {
        let manifest = Manifest::read(path, host)?;
        let wrong = |what: String| Kind::Document.refusal(named(path)(what));
        let command = RecordOptions::command();
        let is_option =
            |column: &str| command.get_arguments().any(|option| option.get_long() == Some(&column.replace('_', "-")));
        for column in
            manifest.columns.iter().filter(|column| ![FILE, EXCLUDE].contains(&column.as_str()) && !is_option(column))
        {
            refuse_drive(column).and_then(|()| refuse_misspelt(column, &command)).map_err(wrong)?;
        }
        let folder = path.parent().unwrap_or_else(|| Path::new(""));
        let entry = |cells: &Vec<String>| {
            let mut entry = Entry::default();
            for (column, cell) in manifest.columns.iter().zip(cells) {
                if column == FILE {
                    entry.file = folder.join(cell);
                    continue;
                }
                if column == EXCLUDE {
                    entry.excluded = exclusion(cell);
                }
                if is_option(column) && !cell.is_empty() {
                    entry.options.push(format!("--{}={cell}", column.replace('_', "-")));
                }
                entry.description.insert(column.clone(), cell.clone());
            }
            entry
        };
        let entries = manifest.records.iter().map(entry).collect();
        let (group, sheet) = (group.or(manifest.group), manifest.sheet);
        let campaign = Self { options, group, sheet, without_curves: false, entries };
        if let Some(column) = &campaign.group {
            campaign.require_column(column).map_err(wrong)?;
        }
        Ok(campaign)
    }

    /// Options of the record of this index.
    pub(crate) fn record(&self, index: usize) -> Result<RecordOptions, Box<dyn Error>> {
        let entry = &self.entries[index];
        RecordOptions::of(self.options.iter().chain(&entry.options).cloned(), &entry.file)
    }

    /// Refuses a column that no record has.
    pub(crate) fn require_column(&self, column: &str) -> Result<(), String> {
        let columns = self.columns();
        if columns.contains(&column) {
            return Ok(());
        }
        let known: Vec<&str> = std::iter::once(FILE).chain(columns).collect();
        Err(format!("there is no column `{column}`; there are {}", listed(&known)))
    }

    /// Columns that describe the records.
    pub(crate) fn columns(&self) -> Vec<&str> {
        self.entries.first().map_or_else(Vec::new, |entry| entry.description.keys().map(String::as_str).collect())
    }

    /// Keeps the list in `folder`, in the place of an earlier one of the same campaign: rows of entries that changed
    /// are known by their contents, and made again.
    ///
    /// # Errors
    /// If a campaign by other options is there, or one of other records throughout.
    pub(crate) fn keep(&self, folder: &Path) -> Result<(), Box<dyn Error>> {
        create_folder(&folder.join("rows"))?;
        let path = folder.join(LIST);
        let kept = if path.exists() { Some(Self::read(folder)?) } else { None };
        if kept.as_ref() == Some(self) {
            return Ok(());
        }
        let is_same = |kept: Self| {
            let files: BTreeSet<&PathBuf> = kept.entries.iter().map(|entry| &entry.file).collect();
            (&kept.options, kept.without_curves) == (&self.options, self.without_curves)
                && self.entries.iter().any(|entry| files.contains(&entry.file))
        };
        if kept.is_none_or(is_same) {
            return Ok(files::write(&path, &serde_json::to_string_pretty(self)?)?);
        }
        Err(format!(
            "{} holds a campaign of other records or options; give another folder, or remove it",
            folder.display()
        )
        .into())
    }

    /// The campaign whose list is in `folder`.
    pub(crate) fn read(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let path = folder.join(LIST);
        let text =
            Host::default().text(&path).map_err(|error| format!("{} holds no campaign: {error}", folder.display()))?;
        Ok(serde_json::from_str(&text).map_err(named(&path))?)
    }
}

/// The options of one record.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, args_override_self = true, allow_negative_numbers = true, disable_help_flag = true)]
pub(crate) struct RecordOptions {
    #[command(flatten)]
    pub(super) given: Given,
    #[command(flatten)]
    pub(super) question: Question,
}

impl RecordOptions {
    /// Parses the `options` of the record in a `file`.
    pub(super) fn of(options: impl Iterator<Item = String>, file: &Path) -> Result<Self, Box<dyn Error>> {
        let arguments = options.map(OsString::from).chain([OsString::from("--"), file.into()]);
        Ok(Self::try_parse_from(arguments).map_err(|error| {
            // What is wrong, and what may be meant; the usage of no command would mislead.
            let text = error.to_string();
            let lines = text.lines().map(str::trim).enumerate();
            let told = lines.filter(|(number, line)| *number == 0 || line.starts_with("tip: ")).map(|(_, line)| line);
            told.collect::<Vec<_>>().join("; ").trim_start_matches("error: ").to_owned()
        })?)
    }

    /// The record as it was read, and as it is fitted.
    pub(crate) fn prepared(&self, host: &Host<'_>) -> Result<(Input, Experiment), Box<dyn Error>> {
        let input = self.given.read_mode(host)?;
        let preparation = self.given.preparation().gain_uncertainty(self.question.scale_u);
        let experiment = self.question.free(&input.record, &preparation)?;
        Ok((input, experiment))
    }
}

/// Refuses a column that is meant for an option of `fmm identify` by which the machine is driven: its record would be
/// fitted as a free vibration.
fn refuse_drive(column: &str) -> Result<(), String> {
    let Some(option) = DRIVES.into_iter().find(|option| is_meant(column, option)) else { return Ok(()) };
    Err(format!(
        "column `{column}` is meant for --{option}, but a campaign is of free vibrations; identify a driven record by \
         `fmm identify FILE --{option} NAME`, or call the column otherwise if it only describes the records"
    ))
}

/// Refuses a column that is meant for one of the options of `command`, or for the file, but not called like it.
fn refuse_misspelt(column: &str, command: &clap::Command) -> Result<(), String> {
    let options = command.get_arguments().filter_map(|option| Some(option.get_long()?.replace('-', "_")));
    let known: Vec<String> = [FILE, EXCLUDE].map(str::to_owned).into_iter().chain(options).collect();
    let Some(meant) = known.iter().find(|option| is_meant(column, option)) else { return Ok(()) };
    Err(format!(
        "column `{column}` is no option and nearly called like `{meant}`; call it so, or otherwise if it only \
         describes the records; columns that set something are {}",
        known.join(", ")
    ))
}

/// True if a column is called like an option but for case, spaces, a unit in brackets, or a slip: a letter too many,
/// too few, wrong or exchanged with the next. Of four letters or fewer only a repeated letter is a slip: a date is no
/// rate.
fn is_meant(column: &str, option: &str) -> bool {
    let bare = column.split(['[', '(']).next().unwrap_or_default();
    let written: Vec<char> = bare.trim().to_lowercase().replace(['-', ' '], "_").chars().collect();
    let option: Vec<char> = option.chars().collect();
    if option.len() > 4 {
        return is_one_slip(&written, &option);
    }
    let once = |word: &[char]| {
        let mut word = word.to_vec();
        word.dedup();
        word
    };
    once(&written) == once(&option)
}

/// True if two words are equal but for one letter, or for two that changed places.
fn is_one_slip(one: &[char], other: &[char]) -> bool {
    let begin = one.iter().zip(other).take_while(|(a, b)| a == b).count();
    let (one, other) = (&one[begin..], &other[begin..]);
    let end = one.iter().rev().zip(other.iter().rev()).take_while(|(a, b)| a == b).count();
    match (&one[..one.len() - end], &other[..other.len() - end]) {
        ([] | [_], [] | [_]) => true,
        ([a, b], [c, d]) => a == d && b == c,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_is_refused() {
        let columns = [("force", "force"), ("Force [N]", "force"), ("forces", "force"), ("base", "base")];
        for (column, option) in columns.into_iter().chain([("impact", "impact"), ("Impact (N)", "impact")]) {
            let refused = refuse_drive(column).unwrap_err();
            assert!(refused.starts_with(&format!("column `{column}` is meant for --{option}, but")), "{refused}");
        }
        for column in ["normal_load", "pressing_force", "basis", "bath"] {
            assert_eq!(refuse_drive(column), Ok(()), "{column}");
        }
    }

    #[test]
    fn a_misspelt_option_is_refused_and_a_description_is_not() {
        let command = RecordOptions::command();
        for (column, meant) in [
            ("Mass", "mass"),
            ("masss", "mass"),
            ("mass [kg]", "mass"),
            ("normal load", "normal_load"),
            ("normal_laod", "normal_load"),
            ("norml_load", "normal_load"),
            ("chanel", "channel"),
            ("chanmel", "channel"),
            ("stiffnes", "stiffness"),
            ("exlude", "exclude"),
        ] {
            let refused = refuse_misspelt(column, &command).unwrap_err();
            assert!(refused.contains(&format!("nearly called like `{meant}`")), "{column}: {refused}");
            assert!(refused.contains("columns that set something are file, exclude, channel, time, rate"), "{refused}");
        }
        for column in [
            "operator",
            "specimen",
            "date",
            "day",
            "lab",
            "model",
            "load",
            "temperature",
            "run",
            "grease",
            "note",
            "node",
        ] {
            assert_eq!(refuse_misspelt(column, &command), Ok(()), "{column}");
        }
    }
}
