//! The tables as text.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Summary;
use super::cell::Group;
use super::summary::{Share, quantile};

const HEAD: &str = "\
The default judgement, measured on simulated records of known truth.

n         records                       fail      no verdict but an error
no μ      none stated though there is one
bias      mean of (stated − true)/true of μ, %; a μ that changes with the speed is that at rest or at the peak speed,
          whichever is nearer, or if the law says that it changes, that beyond all speeds
scatter   standard deviation of (stated − true)/u of μ; 1 if u says how far it scatters
μ c f₀    95 % intervals that hold the truth, % of those stated
loud      intervals of μ that miss, with a warning that the law or the record is not right
silent    intervals of μ that miss, without
decided   one law is left
wrong     one law is left, and it is not the truth
far       decided, no such warning, and μ more than 5 % and more than its interval off at the peak speed and at rest
ms        median time of a record (this machine, and not the same each time)
";

const HEAD_OF_LAWS: &str = "
Which law is named.

right     one law is left, and it is the truth          among     several are left, the truth among them
loud      another is left, with a warning of that kind  others    several are left, without the truth
silent    another is left, without
";

/// All `summaries`.
pub(crate) fn text(summaries: &[Summary]) -> String {
    let mut text = HEAD.to_owned();
    rows(&mut text, summaries);
    times(&mut text, summaries);
    let laws: Vec<&Summary> = summaries
        .iter()
        .filter(|row| matches!(row.group, Some(Group::Law | Group::Falling | Group::Changing)))
        .collect();
    if !laws.is_empty() {
        text.push_str(HEAD_OF_LAWS);
        rows_of_laws(&mut text, &laws);
    }
    let failed = summaries.iter().filter_map(|row| Some((&row.name, row.failure.as_ref()?)));
    for (index, (name, reason)) in failed.enumerate() {
        let head = if index == 0 { "\nFirst failure of each cell that has one:\n" } else { "" };
        put(&mut text, format_args!("{head}{name}: {reason}\n"));
    }
    text
}

/// Writing to a text does not fail.
fn put(text: &mut String, line: std::fmt::Arguments<'_>) {
    text.write_fmt(line).unwrap_or_default();
}

fn rows(text: &mut String, summaries: &[Summary]) {
    put(
        text,
        format_args!(
            "\n{:<44}{:>4}{:>5}{:>5}{:>8}{:>8}{:>6}{:>6}{:>6}{:>6}{:>7}{:>8}{:>6}{:>5}{:>8}\n",
            "cell",
            "n",
            "fail",
            "no μ",
            "bias",
            "scatter",
            "μ",
            "c",
            "f₀",
            "loud",
            "silent",
            "decided",
            "wrong",
            "far",
            "ms"
        ),
    );
    for row in summaries {
        let share = |share: Share| number(share.percent(), 1);
        put(
            text,
            format_args!(
                "{:<44}{:>4}{:>5}{:>5}{:>8}{:>8}{:>6}{:>6}{:>6}{:>6}{:>7}{:>8}{:>6}{:>5}{:>8.1}\n",
                row.name,
                row.records,
                row.failures,
                row.without_mu,
                number(row.bias.map(|bias| 100.0 * bias), 2),
                number(row.scatter, 2),
                share(row.mu),
                share(row.damping),
                share(row.frequency),
                row.loud_misses,
                row.silent_misses,
                row.decided,
                row.wrong_loud + row.wrong_silent,
                row.silently_wrong,
                1e3 * row.median_seconds()
            ),
        );
    }
}

/// Times of the records of which a simple law is true, and of all others.
fn times(text: &mut String, summaries: &[Summary]) {
    put(text, format_args!("\nTimes of single records / s; with --threads 1 each has all threads to itself.\n\n"));
    put(text, format_args!("{:<28}{:>6}{:>9}{:>12}{:>9}\n", "cells", "n", "median", "95 of 100", "most"));
    for (name, is_simple) in [("right/", true), ("others", false)] {
        let rows = summaries.iter().filter(|row| matches!(row.group, Some(Group::Coverage)) == is_simple);
        let mut all: Vec<f64> = rows.flat_map(|row| row.seconds.iter().copied()).collect();
        all.sort_by(f64::total_cmp);
        let [median, most_of, most] = [0.5, 0.95, 1.0].map(|share| quantile(&all, share));
        put(text, format_args!("{name:<28}{:>6}{median:>9.3}{most_of:>12.3}{most:>9.3}\n", all.len()));
    }
}

fn rows_of_laws(text: &mut String, summaries: &[&Summary]) {
    put(
        text,
        format_args!(
            "\n{:<28}{:>4}{:>7}{:>7}{:>6}{:>8}{:>8}  {}\n",
            "truth", "n", "right", "among", "loud", "silent", "others", "preferred; all named"
        ),
    );
    for row in summaries {
        put(
            text,
            format_args!(
                "{:<28}{:>4}{:>7}{:>7}{:>6}{:>8}{:>8}  {}; {}\n",
                row.name,
                row.records,
                row.right,
                row.among,
                row.wrong_loud,
                row.wrong_silent,
                row.not_among,
                counted(&row.preferred),
                counted(&row.named)
            ),
        );
    }
}

/// A number, or a dash for none.
fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}

/// Names with how often each occurs, the most frequent first.
fn counted(counts: &BTreeMap<String, usize>) -> String {
    let mut counts: Vec<(&String, &usize)> = counts.iter().collect();
    counts.sort_by_key(|(name, count)| (std::cmp::Reverse(**count), name.as_str()));
    counts.iter().map(|(name, count)| format!("{name} {count}")).collect::<Vec<_>>().join(", ")
}
