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
    let damaged = |error| RecordError::undecoded("the workbook cannot be read; save its sheet as CSV", error);
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
    let listed = crate::error::listed(&listed);
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

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write};

    use zip::write::{SimpleFileOptions, ZipWriter};

    use crate::error::says;
    use crate::files::{Format, Reader};

    /// A workbook of these sheets, each of rows of cells.
    fn workbook(sheets: &[&[&[&str]]]) -> Vec<u8> {
        const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
        const RELATION: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
        const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        let mut part = |name: &str, text: &str| {
            archive.start_file(name, SimpleFileOptions::default()).unwrap();
            archive.write_all(text.as_bytes()).unwrap();
        };
        let numbers = || 1..=sheets.len();
        let sheet = |n: usize| format!("<sheet name=\"S{n}\" sheetId=\"{n}\" r:id=\"rId{n}\"/>");
        let relation = |n: usize| {
            format!("<Relationship Id=\"rId{n}\" Type=\"{RELATION}/worksheet\" Target=\"worksheets/sheet{n}.xml\"/>")
        };
        let (listed, related) = (numbers().map(sheet).collect::<Vec<_>>(), numbers().map(relation).collect::<Vec<_>>());
        let (listed, related) = (listed.concat(), related.concat());
        let book = format!("<workbook xmlns=\"{MAIN}\" xmlns:r=\"{RELATION}\"><sheets>{listed}</sheets></workbook>");
        part("xl/workbook.xml", &book);
        let document =
            format!("<Relationship Id=\"r\" Type=\"{RELATION}/officeDocument\" Target=\"xl/workbook.xml\"/>");
        part("_rels/.rels", &format!("<Relationships xmlns=\"{PACKAGE}\">{document}</Relationships>"));
        let relations = format!("<Relationships xmlns=\"{PACKAGE}\">{related}</Relationships>");
        part("xl/_rels/workbook.xml.rels", &relations);
        for (n, rows) in (1..).zip(sheets) {
            let cell = |cell: &&str| match cell.parse::<f64>() {
                Ok(_) => format!("<c><v>{cell}</v></c>"),
                Err(_) => format!("<c t=\"inlineStr\"><is><t>{cell}</t></is></c>"),
            };
            let row = |row: &&[&str]| format!("<row>{}</row>", row.iter().map(cell).collect::<Vec<_>>().concat());
            let rows = rows.iter().map(row).collect::<Vec<_>>().concat();
            let sheet = format!("<worksheet xmlns=\"{MAIN}\"><sheetData>{rows}</sheetData></worksheet>");
            part(&format!("xl/worksheets/sheet{n}.xml"), &sheet);
        }
        archive.finish().unwrap().into_inner()
    }

    #[test]
    fn the_fullest_sheet_is_read_and_others_on_request() {
        let notes: &[&[&str]] = &[&["Operator", "Bob"]];
        let run: &[&[&str]] = &[
            &["My run"],
            &["Time [s]", "v [m/s]"],
            &["0", "0.1"],
            &["0.002", "0.30000000000000004"],
            &["0.004", "-1e-3"],
        ];
        let other: &[&[&str]] = &[&["t", "v [m/s]"], &["0.5", "7"], &["1", "8"]];
        let bytes = workbook(&[notes, run, other]);
        let file = Reader::default().parse(&bytes[..]).unwrap();
        let reading = file.reading().unwrap();
        assert_eq!((file.format(), &reading.channel[..]), (Format::Workbook, "v [m/s]"));
        assert_eq!((reading.record.values(), reading.record.rate()), (&[0.1, 0.1 + 0.2, -1e-3][..], 500.0));
        let listed =
            "the workbook has the sheets \"S1\" (1), \"S2\" (2), \"S3\" (3); \"S2\" was read; `table` chooses another";
        assert_eq!(file.warnings(), [listed]);
        let third = Reader::default().table(3).parse(&bytes[..]).unwrap();
        assert_eq!((third.reading().unwrap().record.values(), third.warnings().len()), (&[7.0, 8.0][..], 0));
        assert!(says(&Reader::default().table(4).parse(&bytes[..]), "there is no such sheet; filled are: \"S1\" (1)"));
        assert!(says(&Reader::default().parse(&bytes[..bytes.len() / 2]), "the workbook cannot be read"));
    }
}
