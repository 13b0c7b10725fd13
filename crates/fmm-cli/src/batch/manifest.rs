//! The manifest of a campaign: its records as a table of CSV, or as a list of TOML.

use std::error::Error;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::sheet::Sheet;
use crate::files::named;
use crate::host::Host;
use crate::refusal::Kind;

/// Content of a manifest, from CSV or TOML.
#[derive(Debug)]
pub(super) struct Manifest {
    /// Among them `file`.
    pub(super) columns: Vec<String>,
    /// A cell for each column, empty where nothing is said.
    pub(super) records: Vec<Vec<String>>,
    /// The column that says which records belong together.
    pub(super) group: Option<String>,
    pub(super) sheet: Option<Sheet>,
}

/// The column with the path of the record.
pub(super) const FILE: &str = "file";

/// Names for an error, the first of many.
pub(super) fn listed(names: &[impl AsRef<str>]) -> String {
    /// A screen of them, by judgement.
    const MOST: usize = 20;
    let first: Vec<&str> = names.iter().take(MOST).map(AsRef::as_ref).collect();
    let others = names.len().saturating_sub(MOST);
    if others > 0 { format!("{} and {others} more", first.join(", ")) } else { first.join(", ") }
}

/// The column that leaves a record out.
pub(super) const EXCLUDE: &str = "exclude";

/// Reason for which a cell of the column leaves its record out, empty where it is `true` alone; `None` where it does
/// not.
pub(super) fn exclusion(cell: &str) -> Option<String> {
    match cell.to_lowercase().as_str() {
        "" | "false" | "no" | "0" => None,
        "true" | "yes" | "1" | "x" => Some(String::new()),
        _ => Some(cell.to_owned()),
    }
}

impl Manifest {
    /// Reads TOML if the name or the beginning of the file looks so, and CSV otherwise.
    pub(super) fn read(path: &Path, host: &Host<'_>) -> Result<Self, Box<dyn Error>> {
        let text = host.text(path)?;
        let read = if is_toml(path, &text) { Self::of_toml(&text) } else { Self::of_csv(&text) };
        let wrong = |what: String| Kind::Document.refusal(named(path)(what));
        let manifest = read.and_then(Self::with_columns_once).map_err(wrong)?;
        if manifest.records.is_empty() {
            return Err(wrong("the manifest has no records".to_owned()).into());
        }
        Ok(manifest)
    }

    /// The same; refused if a column stands twice, written with hyphens or underscores, as one of the two would count
    /// in silence.
    fn with_columns_once(self) -> Result<Self, String> {
        let plain = |column: &String| column.replace('-', "_");
        for (place, column) in self.columns.iter().enumerate().filter(|(_, column)| !column.is_empty()) {
            if let Some(first) = self.columns[..place].iter().find(|first| plain(first) == plain(column)) {
                let written = if first == column { String::new() } else { format!(", first as `{first}`") };
                return Err(format!("the column `{column}` stands twice{written}; give it once"));
            }
        }
        Ok(self)
    }

    fn of_csv(text: &str) -> Result<Self, String> {
        // Spreadsheets in many countries save semicolons, others tabs.
        let head = text.lines().next().unwrap_or_default();
        let delimiter = [b';', b'\t'].into_iter().find(|sign| head.as_bytes().contains(sign)).unwrap_or(b',');
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader =
            csv::ReaderBuilder::new().delimiter(delimiter).trim(csv::Trim::All).from_reader(text.as_bytes());
        let columns: Vec<String> =
            reader.headers().map_err(|error| error.to_string())?.iter().map(str::to_owned).collect();
        if !columns.iter().any(|column| column == FILE) {
            return Err(format!("there is no column `{FILE}`; there are {}", listed(&columns)));
        }
        let line = |line: Result<csv::StringRecord, csv::Error>| {
            line.map(|line| line.iter().map(|cell| with_point(cell, delimiter)).collect())
                .map_err(|error| error.to_string())
        };
        let records = reader.records().map(line).collect::<Result<_, _>>()?;
        Ok(Self { columns, records, group: None, sheet: None })
    }

    fn of_toml(text: &str) -> Result<Self, String> {
        let document = DeTable::parse(text).map_err(|error| error.to_string())?;
        let (mut common, mut records, mut group, mut sheet) = (Vec::new(), Vec::new(), None, None);
        for (key, value) in document.get_ref() {
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("common", DeValue::Table(table)) => common = cells(text, table)?,
                ("record", DeValue::Array(list)) => {
                    for record in list {
                        let DeValue::Table(table) = record.get_ref() else {
                            return Err(at(text, record, "a record is a table; begin each with [[record]]"));
                        };
                        let cells = cells(text, table)?;
                        if !cells.iter().any(|(column, _)| column == FILE) {
                            return Err(at(text, record, "this record has no `file`; give the path of its data"));
                        }
                        records.push(cells);
                    }
                }
                ("group", DeValue::String(column)) => group = Some((column.to_string(), value)),
                ("sheet", DeValue::Table(table)) => sheet = Some(Sheet::of_toml(text, table)?),
                ("common" | "sheet", _) => {
                    return Err(at(text, key, &format!("`{0}` is a table; write [{0}]", key.get_ref())));
                }
                ("record", _) => return Err(at(text, key, "`record` is a list of tables; write [[record]]")),
                ("group", _) => {
                    return Err(at(text, key, "`group` is the name of a column, as in group = \"operator\""));
                }
                (other, _) => {
                    let what = "is not known here; a manifest has group, [common], [[record]] and [sheet]";
                    return Err(at(text, key, &format!("`{other}` {what}")));
                }
            }
        }
        if let Some((key, _)) = common.iter().find(|(column, _)| column == FILE) {
            return Err(format!("`{key}` stands under [common]; each record has one of its own"));
        }
        let mut columns: Vec<String> = Vec::new();
        for (column, _) in records.iter().flatten().chain(&common) {
            if !columns.contains(column) {
                columns.push(column.clone());
            }
        }
        if let Some((column, value)) = group.as_ref().filter(|(column, _)| !columns.contains(column)) {
            return Err(at(text, value, &format!("no record has `{column}`; they have {}", columns.join(", "))));
        }
        let value = |record: &Vec<(String, String)>, column: &String| {
            let own = record.iter().chain(&common).find(|(name, _)| name == column);
            own.map_or_else(String::new, |(_, value)| value.clone())
        };
        let records = records.iter().map(|record| columns.iter().map(|column| value(record, column)).collect());
        Ok(Self { records: records.collect(), group: group.map(|(column, _)| column), columns, sheet })
    }
}

/// A cell with a decimal point in place of the decimal comma that a number beside semicolons may have.
fn with_point(cell: &str, delimiter: u8) -> String {
    let point = cell.replacen(',', ".", 1);
    if delimiter != b',' && point.parse::<f64>().is_ok() { point } else { cell.to_owned() }
}

/// True for a manifest in TOML: by its ending, or else by its first line that is not empty.
fn is_toml(path: &Path, text: &str) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("toml") => true,
        Some("csv") => false,
        _ => {
            let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
            lines.next().is_some_and(|line| {
                line.starts_with('[') || line.split_once('=').is_some_and(|(key, _)| !key.contains(','))
            })
        }
    }
}

/// The entries of a table as text, numbers as they are written.
pub(super) fn cells(text: &str, table: &DeTable<'_>) -> Result<Vec<(String, String)>, String> {
    let cell = |(key, value): (&Spanned<std::borrow::Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
        let cell = match value.get_ref() {
            DeValue::String(words) => words.trim().to_owned(),
            DeValue::Integer(number) => number.to_string(),
            DeValue::Float(number) => number.as_str().to_owned(),
            DeValue::Boolean(yes) => yes.to_string(),
            DeValue::Datetime(time) => time.to_string(),
            DeValue::Array(_) | DeValue::Table(_) => {
                let what = format!("`{}` must be a text or a number, as in {0} = \"…\"", key.get_ref());
                return Err(at(text, value, &what));
            }
        };
        Ok((key.get_ref().to_string(), cell))
    };
    table.iter().map(cell).collect()
}

/// Fault of a part of the text, with its line.
pub(super) fn at<T>(text: &str, part: &Spanned<T>, what: &str) -> String {
    let before = text.get(..part.span().start).unwrap_or(text);
    format!("line {}: {what}", before.matches('\n').count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_named_with_their_line() {
        let refused = |text: &str| Manifest::of_toml(text).unwrap_err();
        for (text, words) in [
            ("[common]\nmass = 1\n\n[[record]]\nload = 2\n", "line 4: this record has no `file`"),
            ("[[record]]\nfile = \"a.csv\"\nlaw = [\"coulomb\"]\n", "line 3: `law` must be a text or a number"),
            ("[comon]\nmass = 1\n", "line 1: `comon` is not known here; a manifest has group, [common]"),
            ("[record]\nfile = \"a.csv\"\n", "line 1: `record` is a list of tables"),
            ("common = 3\n", "line 1: `common` is a table; write [common]"),
            (
                "group = \"lab\"\n[[record]]\nfile = \"a.csv\"\nmass = 2\n",
                "line 1: no record has `lab`; they have file, mass",
            ),
            ("[common]\nfile = \"a.csv\"\n", "each record has one of its own"),
            ("mass = \n", "line 1"),
            ("[sheet]\noperater = \"A\"\n", "line 2: `operater` is no field of a record sheet"),
        ] {
            assert!(refused(text).contains(words), "{text:?}: {}", refused(text));
        }
        assert!(Manifest::of_csv("path,mass\na,1\n").unwrap_err().contains("no column `file`; there are path, mass"));
    }

    #[test]
    fn a_column_that_stands_twice_is_refused() {
        let read = |text: &str| Manifest::of_csv(text).and_then(Manifest::with_columns_once);
        assert_eq!(read("file,mass,mass\na,1,2\n").unwrap_err(), "the column `mass` stands twice; give it once");
        let refused = read("file,normal_load,day,normal-load\na,1,2,3\n").unwrap_err();
        assert_eq!(refused, "the column `normal-load` stands twice, first as `normal_load`; give it once");
        // A table program may end its lines with separators.
        assert_eq!(read("file,mass,,\na,1,,\n").unwrap().columns.len(), 4);
        let list = "[common]\nmass-u = 1\n[[record]]\nfile = \"a.csv\"\nmass_u = 2\n";
        assert!(Manifest::of_toml(list).and_then(Manifest::with_columns_once).is_err());
    }

    #[test]
    fn the_kind_is_told_by_ending_or_content() {
        let told = |name: &str, text: &str| is_toml(Path::new(name), text);
        assert!(told("runs.toml", "") && told("runs.TOML", "") && !told("runs.csv", "[[record]]"));
        assert!(told("runs", "# list\n\n[[record]]\n") && told("runs.txt", "group = \"operator\"\n"));
        assert!(!told("runs", "file,mass\na,1\n") && !told("runs", "file,note\na,b=c\n"));
    }

    /// Common values hold for each record that does not say otherwise; others are empty.
    #[test]
    fn common_values_are_those_of_each_record() {
        let text = "group = \"operator\"\n[common]\nmass = 10.0\nunit = \"mm/s\"\n[[record]]\nfile = \"a.csv\"\n\
                    operator = \"A\"\n[[record]]\nfile = \"b.csv\"\nmass = 1_1e0\nday = 2026-11-24\n";
        let manifest = Manifest::of_toml(text).unwrap();
        assert_eq!(manifest.group.as_deref(), Some("operator"));
        let cell = |record: usize, name: &str| {
            manifest.records[record][manifest.columns.iter().position(|column| column == name).unwrap()].as_str()
        };
        assert_eq!((cell(0, "mass"), cell(1, "mass"), cell(1, "unit")), ("10.0", "11e0", "mm/s"));
        assert_eq!((cell(0, "day"), cell(1, "day"), cell(1, "operator")), ("", "2026-11-24", ""));
    }

    #[test]
    fn semicolons_and_tabs_separate_columns_as_well() {
        for text in
            ["file;mass;law\na.csv;10,391;coulomb,berger\n", "\u{feff}file\tmass\tlaw\na.csv\t10.391\tcoulomb,berger\n"]
        {
            let manifest = Manifest::of_csv(text).unwrap();
            assert_eq!(manifest.columns, ["file", "mass", "law"]);
            assert_eq!(manifest.records, [["a.csv", "10.391", "coulomb,berger"]]);
        }
    }
}
