//! Campaign of many records: `fmm batch` and `fmm merge`.
//!
//! Each record is identified by itself, in parallel; one that is refused is a row with its reason. Into a folder, each
//! row is a file of its own, written at once or not at all, so that a campaign can be cut into shards, killed and
//! resumed at any time. Copies of a record are found when all rows are there.

mod campaign;
mod curve;
mod dependence;
mod joint;
mod linked;
mod manifest;
mod page;
mod pooled;
mod row;
mod shared;
mod sheet;
mod summary;
mod table;

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Args;
use fmm_fit::Minimizer;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use serde::Serialize;

use crate::answer::{Answer, Detail, Document};
use crate::files;
use crate::host::Host;
use crate::output::Form;
use campaign::Campaign;
pub(crate) use dependence::FRICTION;
use joint::Together;
use row::{Outcome, Row};
use summary::Summary;
#[cfg(test)]
pub(crate) use table::Content;

/// Identifies many records.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The records, or folders of records
    #[arg(required_unless_present = "manifest")]
    records: Vec<PathBuf>,
    /// A table (CSV) or a list (TOML) of records, each with its `file`, relative to the manifest; columns called like
    /// an option of `fmm identify` (channel, unit, mass, normal_load, …) set it for their record, `exclude` leaves it
    /// out (true, or the reason), others (operator, specimen, …) describe it, but one that is nearly called like an
    /// option is refused, and so are `force`,
    /// `base` and `impact`, as all records are of free vibrations. In TOML, [[record]] begins a record, [common] holds
    /// what all share, `group` names a column for --group, and [sheet] holds the fields of a record sheet
    #[arg(long, value_name = "FILE", conflicts_with = "records")]
    manifest: Option<PathBuf>,
    /// Write one file for each record into this folder, and with all of them campaign.csv, campaign.json,
    /// campaign.html and campaign.jsonld (linked data); records that are there already, and whose file and entry did
    /// not change, are not done again
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Do this part of the records only, as in 2/10; `fmm merge` puts the parts together
    #[arg(long, value_name = "K/N", value_parser = shard, requires = "out")]
    shard: Option<(usize, usize)>,
    /// The column of the manifest that says which records belong together, for repeatability and reproducibility
    #[arg(long, value_name = "COLUMN")]
    group: Option<String>,
    #[command(flatten)]
    asked: Asked,
    /// Search a law for each record, as `fmm identify` does, instead of fitting coulomb_viscous to all
    #[arg(long)]
    search: bool,
    /// Leave out the friction curve of each record, friction over the speed without a law, which takes most of the time
    #[arg(long)]
    no_curves: bool,
    /// Records at a time; as many as there are processors unless given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    #[command(flatten)]
    pub(crate) form: Form,
    /// After two dashes, options of `fmm identify` for all records, as in -- --unit m/s --mass 10.391
    #[arg(last = true, value_name = "OPTION")]
    options: Vec<String>,
}

/// Puts the rows of a campaign together.
#[derive(Debug, Args)]
pub(crate) struct Merge {
    /// The folder that `fmm batch --out` wrote
    folder: PathBuf,
    #[command(flatten)]
    asked: Asked,
    #[command(flatten)]
    pub(crate) form: Form,
}

/// Requests to all records together, on which no row depends.
#[derive(Debug, Args)]
struct Asked {
    /// Fit all identified records together as one machine with one law, too; its time grows nearly as the cube of their
    /// number (thirty of 800 samples take 7 s)
    #[arg(long)]
    joint: bool,
    /// Count records whose fit is doubted by warnings; they are set apart with the reason otherwise
    #[arg(long)]
    count_doubtful: bool,
    /// A column of numbers of the manifest against which friction is set, beside load and amplitude; may be given again
    #[arg(long, value_name = "COLUMN")]
    against: Vec<String>,
}

impl Asked {
    /// Refuses columns that no record has.
    fn check(&self, campaign: &Campaign) -> Result<(), String> {
        self.against.iter().try_for_each(|column| campaign.require_column(column))
    }

    fn summary(&self, campaign: &Campaign, rows: &[Row], host: &Host<'_>) -> Result<Summary, Box<dyn Error>> {
        let alone = Summary::of(campaign, rows, self, None);
        if !self.joint {
            return Ok(alone);
        }
        let joint = match alone.against_joint() {
            Some(why) => Outcome::Refused(why),
            None => joint(campaign, rows, self, host)?,
        };
        Ok(Summary::of(campaign, rows, self, Some(joint)))
    }
}

/// Fits all records together and tells how far that is.
fn joint(
    campaign: &Campaign,
    rows: &[Row],
    asked: &Asked,
    host: &Host<'_>,
) -> Result<Outcome<Together>, Box<dyn Error>> {
    let joint = host.while_working(|tell| {
        let show =
            |law: &str, progress: &Minimizer| tell(format!("joint fit by {law}: step {}", progress.iterations()));
        Together::of(campaign, rows, asked.count_doubtful, host, show)
    })?;
    Ok(joint.into())
}

/// The law that is fitted to all records unless another one is asked for.
const LAW: &str = "coulomb_viscous";

/// The K of K/N, counted from 1, and N.
fn shard(text: &str) -> Result<(usize, usize), String> {
    let refused = || format!("{text:?} is no part; give K/N with K from 1 to N, as in 2/10");
    let (part, all) = text.split_once('/').ok_or_else(refused)?;
    let (part, all) = (part.trim().parse().map_err(|_| refused())?, all.trim().parse().map_err(|_| refused())?);
    if (1..=all).contains(&part) { Ok((part, all)) } else { Err(refused()) }
}

/// Rows of a campaign, and what they say together.
pub(crate) struct Found {
    campaign: Campaign,
    rows: Vec<Row>,
    summary: Summary,
    written: Option<String>,
}

impl Answer for Found {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        Ok(table::text(&self.rows, &self.summary))
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        table::document(&self.rows, &self.summary)
    }

    fn page(&self) -> Result<Option<String>, Box<dyn Error>> {
        Ok(Some(page::page(&self.campaign, &self.rows, &self.summary)))
    }

    fn written(&self) -> Option<String> {
        self.written.clone()
    }

    fn verdict(&self) -> Result<(), String> {
        if self.summary.found == 0 {
            return Err(format!("none of {} records was identified; the reasons are in their rows", self.rows.len()));
        }
        Ok(())
    }
}

/// A part of a campaign that is done, of which nothing can be said yet.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Part {
    /// The part that is done, and the one that comes next.
    done: String,
}

impl Answer for Part {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        Ok(self.done.clone())
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("part-1", self).pretty()
    }
}

pub(crate) fn batch(arguments: &Arguments, host: &Host<'_>) -> Result<Box<dyn Answer>, Box<dyn Error>> {
    let mut options = arguments.options.clone();
    if !arguments.search && !options.iter().any(|option| option == "--law" || option.starts_with("--law=")) {
        options.extend(["--law".to_owned(), LAW.to_owned()]);
    }
    let mut campaign = match (&arguments.manifest, &arguments.group) {
        (Some(manifest), group) => Campaign::of_manifest(manifest, options, group.clone(), host)?,
        (None, Some(group)) => {
            let what = "a manifest says which records belong together, and none is given; list them in one, and give \
                        it by --manifest";
            return Err(format!("--group {group}: {what}").into());
        }
        (None, None) => Campaign::of_files(&arguments.records, options)?,
    };
    campaign.without_curves = arguments.no_curves;
    arguments.asked.check(&campaign)?;
    // As many as there are processors, to rayon.
    let jobs = arguments.jobs.map_or(0, usize::from);
    let Some(folder) = &arguments.out else {
        let all: Vec<usize> = (0..campaign.entries.len()).collect();
        let rows = in_parallel(&all, jobs, host, |index| Ok(Row::of(&campaign, index, host)))?;
        let rows = Row::without_copies(rows);
        let summary = arguments.asked.summary(&campaign, &rows, host)?;
        return Ok(Box::new(Found { campaign, rows, summary, written: None }));
    };
    campaign.keep(folder)?;
    let entries = &campaign.entries;
    let (part, parts) = arguments.shard.unwrap_or((1, 1));
    let waiting: Vec<usize> = (part - 1..entries.len())
        .step_by(parts)
        .filter(|index| Row::is_due(folder, *index, &entries[*index]))
        .collect();
    in_parallel(&waiting, jobs, host, |index| Row::of(&campaign, index, host).write(folder, index))?;
    if arguments.shard.is_some() {
        let folder = folder.display();
        let done = format!("part {part} of {parts} is done; `fmm merge {folder}` puts all together");
        return Ok(Box::new(Part { done }));
    }
    Ok(Box::new(put_together(folder, campaign, &arguments.asked, host)?))
}

pub(crate) fn merge(arguments: &Merge, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    let campaign = Campaign::read(&arguments.folder)?;
    arguments.asked.check(&campaign)?;
    put_together(&arguments.folder, campaign, &arguments.asked, host)
}

fn put_together(folder: &Path, campaign: Campaign, asked: &Asked, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    let entries = campaign.entries.iter().enumerate();
    let rows: Vec<Option<Row>> = entries.map(|(index, entry)| Row::read(folder, index, entry)).collect();
    let missing = rows.iter().filter(|row| row.is_none()).count();
    if missing > 0 {
        return Err(format!(
            "{missing} of {} records are still to be done; run the parts that are missing",
            rows.len()
        )
        .into());
    }
    let rows = Row::without_copies(rows.into_iter().flatten().collect());
    let summary = asked.summary(&campaign, &rows, host)?;
    let written = Some(format!("written: {}", folder.join("campaign.{csv,json,jsonld,html}").display()));
    let found = Found { campaign, rows, summary, written };
    for (name, text) in [
        ("campaign.csv", table::csv(&found.campaign, &found.rows)?),
        ("campaign.json", found.document(Detail::Brief)?),
        ("campaign.jsonld", linked::document(&found.campaign, &found.rows, &found.summary)?),
        ("campaign.html", page::page(&found.campaign, &found.rows, &found.summary)),
    ] {
        files::write(&folder.join(name), &text)?;
    }
    Ok(found)
}

/// Results of all `tasks` in their order, `jobs` at a time, with a bar of progress; the first error ends it.
fn in_parallel<T: Send>(
    tasks: &[usize],
    jobs: usize,
    host: &Host<'_>,
    work: impl Fn(usize) -> Result<T, String> + Sync,
) -> Result<Vec<T>, Box<dyn Error>> {
    let count = tasks.len();
    let bar = host.tasks(count as u64, "{wide_bar} {pos} of {len} records, {eta} left")?;
    let one = |task: &usize| {
        let done = work(*task);
        bar.inc(1);
        if host.is_watched() && host.told(&bar, format!("{} of {count} records", bar.position())).is_break() {
            return Err("stopped before the end".to_owned());
        }
        done
    };
    let pool = ThreadPoolBuilder::new().num_threads(jobs).build()?;
    let done: Result<Vec<T>, _> = pool.install(|| tasks.par_iter().map(one).collect());
    bar.finish_and_clear();
    Ok(done?)
}

#[cfg(test)]
mod tests;
