//! Workbooks of spreadsheets: the cells of one sheet.

use std::io::{Cursor, Read};

use calamine::{Data, Range, Reader, open_workbook_auto_from_rs};
use zip::ZipArchive;

use super::Text;
use crate::error::RecordError;
use crate::files::reading::{MOST_INFLATED, too_large};

/// The cells of a sheet as text, and a sentence if there are several sheets: the one whose number is given, counted
/// from 1, or else the one with most cells.
pub(in crate::files) fn text(bytes: Vec<u8>, table: Option<usize>) -> Result<(Vec<u8>, Option<String>), RecordError> {
    let damaged = |error| RecordError::undecoded("the workbook cannot be read", error);
    check_size(&bytes)?;
    let mut book = open_workbook_auto_from_rs(Cursor::new(bytes)).map_err(damaged)?;
    let names = book.sheet_names();
    let mut sheets = Vec::new();
    for name in &names {
        // A sheet of nothing but a chart has no cells.
        sheets.push(book.worksheet_range(name).unwrap_or_default());
    }
    let filled: Vec<usize> = (0..sheets.len()).filter(|sheet| !sheets[*sheet].is_empty()).collect();
    let listed: Vec<String> = filled.iter().map(|sheet| format!("\"{}\" ({})", names[*sheet], sheet + 1)).collect();
    let listed = listed.join(", ");
    let largest = || filled.iter().copied().max_by_key(|sheet| (cells(&sheets[*sheet]), usize::MAX - sheet));
    let chosen = match table {
        Some(table) => table.checked_sub(1).filter(|sheet| filled.contains(sheet)),
        None => largest(),
    };
    let chosen = chosen.ok_or_else(|| RecordError::channel(format!("there is no such sheet; filled are: {listed}")))?;
    let remark =
        format!("the workbook has the sheets {listed}; \"{}\" was read; `table` chooses another", names[chosen]);
    let mut text = Text::new();
    sheets[chosen].rows().for_each(|row| text.line(row.iter().map(written)));
    Ok((text.0, (table.is_none() && filled.len() > 1).then_some(remark)))
}

fn cells(sheet: &Range<Data>) -> usize {
    sheet.used_cells().count()
}

/// Text of a cell. A date has a time of day behind the number of its day.
fn written(cell: &Data) -> String {
    match cell {
        Data::DateTime(time) => {
            let (days, seconds) = (time.as_f64().floor(), time.as_f64().rem_euclid(1.0) * 86_400.0);
            let (minutes, seconds) = ((seconds / 60.0).floor(), seconds.rem_euclid(60.0));
            let (hours, minutes) = ((minutes / 60.0).floor(), minutes.rem_euclid(60.0));
            // Days have about a microsecond.
            format!("{days} {hours}:{minutes}:{:.6}", seconds.min(59.999_999))
        }
        cell => cell.to_string(),
    }
}

/// Refuses a workbook whose compressed parts expand to more than other files may.
fn check_size(bytes: &[u8]) -> Result<(), RecordError> {
    let Ok(mut archive) = ZipArchive::new(Cursor::new(bytes)) else { return Ok(()) };
    let mut left = MOST_INFLATED as u64;
    for index in 0..archive.len() {
        let Ok(part) = archive.by_index(index) else { continue };
        let size = std::io::copy(&mut part.take(left + 1), &mut std::io::sink()).unwrap_or(0);
        left = left.checked_sub(size).ok_or_else(too_large)?;
    }
    Ok(())
}
