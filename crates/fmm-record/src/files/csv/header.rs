//! Header of a table: names of the columns, their units, statements about the sampling.

use std::collections::VecDeque;

use super::lines::Line;
use super::statement::statements;
use crate::error::RecordError;
use crate::files::clock::Clock;
use crate::files::csv::fields::{Kind, Row, Separator, is_value, not_a_number, number, ragged, text};
use crate::units::{WrittenUnit, seconds_in};

/// Lines above a table.
#[derive(Debug, Default)]
pub(super) struct Header {
    /// The names of the columns with their units; their positions if they have no names.
    pub(super) names: Vec<String>,
    /// The names as they are written, without the units that a row of units gives.
    pub(super) bare: Vec<String>,
    /// Numbers that are stated by a name.
    pub(super) stated: Vec<(String, f64)>,
}

impl Header {
    /// The header of columns with these names and no units.
    fn named(self, names: Vec<String>) -> Self {
        Self { names: names.clone(), bare: names, ..self }
    }
}

/// Reads the lines above the table; its names do not stand before line `begin`, and `row` is its first row.
pub(super) fn header(
    above: &[Line],
    begin: usize,
    row: Option<&Line>,
    columns: &[Kind],
    separator: Separator,
) -> Result<Header, RecordError> {
    let width = columns.len();
    // A rule of dashes may stand between names and rows.
    let is_said = |line: &Line| line.text.iter().any(|byte| byte.is_ascii_alphanumeric() || !byte.is_ascii());
    let above = &above[..above.iter().rposition(is_said).map_or(0, |last| last + 1)];
    let comments = above.iter().chain(row).flat_map(|line| &line.comments);
    let stated = above.iter().map(|line| &line.text).chain(comments).flat_map(|text| statements(text, separator));
    let mut found = Header { stated: stated.collect(), ..Header::default() };
    let fitting =
        |line: usize| above.get(line).filter(|_| line >= begin).and_then(|line| fitted(&line.text, columns, separator));
    if let Some(names) = signal_express(above, columns, separator) {
        let interval = above.windows(2).find(|pair| is_called(&pair[0], b"dt:"));
        let interval = interval.and_then(|pair| number(Row::of(&pair[1].text, separator).field(0)));
        found.stated.extend(interval.map(|(interval, _)| ("dt".to_owned(), interval)));
        return Ok(found.named(names));
    }
    let commented = || {
        let labels = row.and_then(|row| fitted(row.labels.as_deref()?, columns, separator));
        let names = labels.or_else(|| names_in(&row?.comments, columns, separator));
        names.unwrap_or_else(|| positions(width))
    };
    let Some(last) = above.len().checked_sub(1).filter(|last| *last >= begin) else {
        return Ok(found.named(commented()));
    };
    // A row of remarks may stand below that of the units.
    let is_remark = last >= 2
        && fitting(last).is_some_and(|remarks| !are_units(&remarks))
        && fitting(last - 1).is_some_and(|units| are_units(&units))
        && fitting(last - 2).is_some_and(|names| are_names(&names));
    let last = if is_remark { last - 1 } else { last };
    let numbers: Vec<usize> = (0..width).filter(|column| columns[*column] == Kind::Number).collect();
    let Some(names) = fitting(last) else {
        let fields = Row::of(&above[last].text, separator);
        let numbered = row.filter(|row| fields.len() + 1 == width && row.text.trim_ascii_start().starts_with(b"\"1\""));
        if numbered.is_some() {
            // R gives no name to the numbers of its rows.
            let names = (0..fields.len()).map(|column| text(fields.field(column)));
            return Ok(found.named([String::new()].into_iter().chain(names).collect()));
        }
        // A preamble has numbers behind words.
        let is_preamble = !is_value(fields.field(0)) && (1..fields.len()).any(|column| is_value(fields.field(column)));
        if let (Some(row), true) = (row, fields.len() > 1 && !is_preamble) {
            return Err(ragged(row.number, fields.len(), width, separator));
        }
        return Ok(found.named(commented()));
    };
    let is_title = numbers.len() > 1 && !names[0].is_empty() && names[1..].iter().all(String::is_empty);
    if is_title {
        return Ok(found.named(commented()));
    }
    let first = numbers.first().copied();
    if numbers.iter().any(|column| number(names[*column].as_bytes()).is_some()) {
        // A row without its first number must not be lost; the last line of a preamble has a name there.
        if let (Some(column), Some(line)) = (first.filter(|first| names[*first].is_empty()), above.get(last)) {
            return Err(not_a_number(line.number, &column.to_string(), ""));
        }
        return Ok(found.named(positions(width)));
    }
    // LabVIEW has the units of its columns higher up.
    let units = above.iter().map(|line| Row::of(&line.text, separator)).find(|row| row.field(0) == b"Y_Unit_Label");
    if let Some(units) = units {
        found.names = (0..width).map(|column| with_unit(&names[column], &labview(&units, column))).collect();
        found.bare = names;
        return Ok(found);
    }
    // The units stand below the names, seldom above.
    let Some(before) = last.checked_sub(1).and_then(fitting) else { return Ok(found.named(names)) };
    let (named, units) = if are_units(&names) && are_names(&before) {
        (before, names)
    } else if are_units(&before) && are_names(&names) && !are_units(&names) {
        (names, before)
    } else {
        return Ok(found.named(names));
    };
    found.bare = named;
    for (name, unit) in found.bare.iter().zip(&units) {
        // An oscilloscope states the increment of its first column there.
        if let Some((value, _)) = number(unit.as_bytes()) {
            found.stated.push((format!("{} {name}", found.bare[0]), value));
        }
    }
    found.names = found.bare.iter().zip(&units).map(|(name, unit)| with_unit(name, unit)).collect();
    Ok(found)
}

/// The names in a text of SignalExpress, where each kind of statement stands below a line that calls it.
fn signal_express(above: &[Line], columns: &[Kind], separator: Separator) -> Option<Vec<String>> {
    above.last().filter(|line| is_called(line, SIGNAL_EXPRESS))?;
    let names = above.windows(2).find(|pair| is_called(&pair[0], b"channel names:"))?;
    fitted(&names[1].text, columns, separator)
}

/// The line of SignalExpress above its table.
pub(super) const SIGNAL_EXPRESS: &[u8] = b"data:";

/// True for a line of nothing but `name`.
pub(super) fn is_called(line: &Line, name: &[u8]) -> bool {
    line.text.trim_ascii() == name
}

fn positions(width: usize) -> Vec<String> {
    (0..width).map(|column| column.to_string()).collect()
}

/// The fields of a line as one for each column, if they fit.
fn fitted(line: &[u8], columns: &[Kind], separator: Separator) -> Option<Vec<String>> {
    let width = columns.len();
    let mut fields = match separator {
        Separator::Blanks => aligned_names(line, width),
        Separator::Sign(_) => {
            let row = Row::of(line, separator);
            (0..row.len()).map(|column| text(row.field(column))).collect()
        }
    };
    // LabVIEW names a column of comments that most rows do not have; others end every line with a separator.
    while fields.len() > width && fields.last().is_some_and(|name| name.is_empty() || name == "Comment") {
        fields.pop();
    }
    while fields.len() < width && fields.len() > 1 && columns[fields.len()..].iter().all(|kind| *kind == Kind::Blank) {
        fields.push(String::new());
    }
    (fields.len() == width).then_some(fields)
}

/// Names above aligned columns: words, words with a unit in brackets behind, or whatever two blanks separate.
fn aligned_names(line: &[u8], width: usize) -> Vec<String> {
    let line = text(line.trim_ascii());
    let line = line.replace('\t', "  ");
    let words: Vec<&str> = line.split_whitespace().collect();
    if words.len() == width {
        return words.into_iter().map(str::to_owned).collect();
    }
    let mut with_units: Vec<String> = Vec::new();
    for word in words {
        match with_units.last_mut() {
            Some(name) if word.starts_with(['[', '(']) => {
                name.push(' ');
                name.push_str(word);
            }
            _ => with_units.push(word.to_owned()),
        }
    }
    if with_units.len() == width || width == 1 {
        return if width == 1 { vec![line.trim().to_owned()] } else { with_units };
    }
    line.split("  ").map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

/// Names in the last of the comments right above the first row, if one of them is that of time; or in the one before, if
/// the last has the units.
fn names_in(comments: &VecDeque<Vec<u8>>, columns: &[Kind], separator: Separator) -> Option<Vec<String>> {
    let signs = [separator, Separator::Sign(b','), Separator::Sign(b';'), Separator::Sign(b'\t'), Separator::Blanks];
    signs.into_iter().find_map(|separator| {
        let mut fitting = comments.iter().rev().map(|comment| {
            let comment = comment.trim_ascii();
            let marks = comment.iter().take_while(|byte| matches!(byte, b'#' | b'%' | b' ' | b'\t')).count();
            fitted(&comment[marks..], columns, separator)
        });
        let is_time = |names: &Vec<String>| names.iter().any(|name| Clock::of(name).is_time);
        let last = fitting.next()??;
        let before = fitting.next().flatten().filter(|names| are_units(&last) && are_names(names) && is_time(names));
        match before {
            Some(names) => Some(names.iter().zip(&last).map(|(name, unit)| with_unit(name, unit)).collect()),
            None => Some(last).filter(is_time),
        }
    })
}

/// Words of Campbell's loggers in place of the units of stamps and record numbers.
const OF_LOGGER: [&str; 2] = ["TS", "RN"];

/// True for fields that are units, or stand in the places of units.
fn are_units(fields: &[String]) -> bool {
    let is_unit = |field: &&String| {
        let plain = plain(field);
        let is_enclosed = plain.len() < field.len();
        is_enclosed || plain.parse::<WrittenUnit>().is_ok() || seconds_in(plain).is_some()
    };
    let may_be = |field: &&String| {
        is_unit(field)
            || matches!(&***field, "-" | "1" | "%")
            || OF_LOGGER.contains(&&***field)
            || field.parse::<f64>().is_ok()
            || Clock::of(field).is_no_motion()
    };
    let mut filled = fields.iter().filter(|field| !field.is_empty()).peekable();
    filled.peek().is_some() && filled.clone().any(|field| is_unit(&field)) && filled.all(|field| may_be(&field))
}

/// True for fields that may be the names above a row of units: some are filled, none is a number.
fn are_names(fields: &[String]) -> bool {
    let filled: Vec<&String> = fields.iter().filter(|field| !field.is_empty()).collect();
    !filled.is_empty() && filled.iter().all(|name| number(name.as_bytes()).is_none())
}

/// The unit of a column in the row of LabVIEW's that has them, which begins with a name.
fn labview(units: &Row, column: usize) -> String {
    if column == 0 { String::new() } else { text(units.field(column)) }
}

/// A unit without the brackets around it.
fn plain(unit: &str) -> &str {
    let inside = |open, close| unit.strip_prefix(open).and_then(|rest| rest.strip_suffix(close));
    inside('(', ')').or_else(|| inside('[', ']')).unwrap_or(unit).trim()
}

/// A name with the unit below it.
fn with_unit(name: &str, unit: &str) -> String {
    let is_none = unit.parse::<f64>().is_ok() || OF_LOGGER.contains(&unit);
    let unit = plain(unit);
    if unit.is_empty() || is_none { name.to_owned() } else { format!("{name} [{unit}]") }
}
