//! JSON as programs write tables: an object of arrays, a list of objects or of rows, an object a line.

use serde_json::{Deserializer, Map, Value};

use super::Text;
use crate::error::RecordError;
use crate::units::label::Label;

/// The table as text: the longest arrays become columns, called by the path to them; single values stand above.
pub(in crate::files) fn text(bytes: &[u8]) -> Result<Vec<u8>, RecordError> {
    let bytes = bytes.strip_prefix("\u{FEFF}".as_bytes()).unwrap_or(bytes);
    let damaged = |error: serde_json::Error| RecordError::Damaged {
        line: Some(error.line() as u64),
        what: format!("the JSON file is damaged: {error}"),
        source: Some(std::sync::Arc::new(error)),
    };
    let values: Vec<Value> = Deserializer::from_slice(bytes).into_iter().collect::<Result<_, _>>().map_err(damaged)?;
    let whole = if let [_] = values[..] { values.into_iter().next() } else { Some(Value::Array(values)) };
    let mut found = Found::default();
    found.add("", whole.unwrap_or_default());
    let length = found.columns.iter().map(|(_, column)| column.len()).max().unwrap_or(0);
    found.columns.retain(|(_, column)| column.len() == length);
    let names: Vec<String> = found.columns.iter().map(|(name, _)| found.with_unit(name)).collect();
    let mut text = Text::new();
    let scalars = found.scalars.iter().filter(|(_, value)| value.parse::<f64>().is_ok());
    scalars.for_each(|(name, value)| text.line([leaf(name).to_owned(), value.clone()]));
    // Without names, the columns go by their positions.
    if names.iter().any(|name| name.parse::<usize>().is_err()) {
        text.line(names);
    }
    for row in 0..length {
        text.line(found.columns.iter().map(|(_, column)| column[row].clone()));
    }
    Ok(text.0)
}

/// Values in the document by the paths to them, as `run.v`.
#[derive(Default)]
struct Found {
    columns: Vec<(String, Vec<String>)>,
    scalars: Vec<(String, String)>,
}

impl Found {
    fn add(&mut self, path: &str, value: Value) {
        match value {
            Value::Object(object) => self.add_object(path, object),
            Value::Array(list) if list.iter().any(holds_list) => {
                for (index, channel) in list.into_iter().enumerate() {
                    let name = channel.get("name").and_then(Value::as_str).map_or(index.to_string(), str::to_owned);
                    self.add(&below(path, &name), channel);
                }
            }
            Value::Array(list) if list.iter().any(Value::is_object) => self.add_object(path, columns_of_objects(list)),
            Value::Array(list) if list.iter().any(Value::is_array) => self.add_object(path, columns_of_rows(list, &[])),
            Value::Array(list) => self.columns.push((path.to_owned(), list.iter().map(written).collect())),
            value => self.scalars.push((path.to_owned(), written(&value))),
        }
    }

    fn add_object(&mut self, path: &str, mut object: Map<String, Value>) {
        // The split form of pandas has the names beside the rows.
        if let (Some(Value::Array(names)), Some(Value::Array(rows))) = (object.get("columns"), object.get("data")) {
            let names: Vec<String> = names.iter().map(written).collect();
            let table = columns_of_rows(rows.clone(), &names);
            return self.add_object(path, table);
        }
        // Its table form has them beside a description.
        if let Some(rows @ Value::Array(_)) = object.get("data").filter(|_| object.contains_key("schema")) {
            return self.add(path, rows.clone());
        }
        // Rows by their numbers.
        if object.len() > 1 && object.iter().all(|(key, row)| key.parse::<u64>().is_ok() && row.is_object()) {
            let mut rows: Vec<(u64, Value)> =
                object.into_iter().filter_map(|(key, row)| Some((key.parse().ok()?, row))).collect();
            rows.sort_by_key(|(row, _)| *row);
            let rows = rows.into_iter().map(|(_, row)| row).collect();
            return self.add_object(path, columns_of_objects(rows));
        }
        // A column by the numbers of its rows, as pandas writes one.
        let is_row =
            |(key, value): (&String, &Value)| key.parse::<u64>().is_ok() && !value.is_array() && !value.is_object();
        if object.len() > 1 && object.iter().all(is_row) {
            let mut rows: Vec<(u64, String)> =
                object.iter().filter_map(|(key, value)| Some((key.parse().ok()?, written(value)))).collect();
            rows.sort_by_key(|(row, _)| *row);
            return self.columns.push((path.to_owned(), rows.into_iter().map(|(_, value)| value).collect()));
        }
        for (key, value) in std::mem::take(&mut object) {
            self.add(&below(path, &key), value);
        }
    }

    /// The name of a column, with the unit that a text beside it states unless the name has one.
    fn with_unit(&self, name: &str) -> String {
        let own = Label::of(name);
        let scalar = |path: String| self.scalars.iter().find(|(other, _)| *other == path).map(|(_, text)| text);
        let parent = name.rsplit_once('.').map_or("", |(parent, _)| parent);
        let beside = |key: &str| below(parent, key);
        let of_name = [format!("{name}_unit"), format!("{name}_units"), beside(&format!("units.{}", leaf(name)))];
        let of_all = ["unit", "units", "y_unit"].map(beside);
        let is_time = crate::files::clock::Clock::of(leaf(name)).is_time;
        let unit = of_name.into_iter().find_map(scalar);
        let unit = unit.or_else(|| of_all.into_iter().find_map(scalar).filter(|_| !is_time));
        match unit.filter(|_| own.unit().is_none() && own.unknown_unit().is_none()) {
            Some(unit) => format!("{name} [{unit}]"),
            None => name.to_owned(),
        }
    }
}

/// The path to a value of an object.
fn below(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// True for an object with a list of its own, as a channel has.
fn holds_list(value: &Value) -> bool {
    value.as_object().is_some_and(|object| object.values().any(Value::is_array))
}

fn leaf(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// Text of a single value; nothing for a missing one.
fn written(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        value => value.to_string(),
    }
}

/// Objects, one a row, as columns.
fn columns_of_objects(rows: Vec<Value>) -> Map<String, Value> {
    let mut columns = Map::new();
    let count = rows.len();
    for (row, value) in rows.into_iter().enumerate() {
        let Value::Object(object) = value else { continue };
        for (key, value) in object {
            let column = columns.entry(key).or_insert_with(|| Value::Array(vec![Value::Null; count]));
            if let Some(place) = column.get_mut(row) {
                *place = value;
            }
        }
    }
    columns
}

/// Lists, one a row, as columns; or one a column, if they are longer than there are lists.
fn columns_of_rows(rows: Vec<Value>, names: &[String]) -> Map<String, Value> {
    let width = rows.iter().filter_map(Value::as_array).map(Vec::len).max().unwrap_or(0);
    let name = |column: usize| names.get(column).cloned().unwrap_or_else(|| column.to_string());
    if rows.len() < width && names.is_empty() {
        return rows.into_iter().enumerate().map(|(column, values)| (name(column), values)).collect();
    }
    let column = |column: usize| rows.iter().map(|row| row.get(column).cloned().unwrap_or_default()).collect();
    (0..width).map(|index| (name(index), Value::Array(column(index)))).collect()
}

#[cfg(test)]
mod tests {
    use crate::files::{Format, Reader};

    #[test]
    fn every_way_to_write_a_table_is_read() {
        for text in [
            r#"{"time": [0.0, 0.002, 0.004], "velocity": [1.5, 2.5, -1], "unit": "m/s"}"#,
            r#"[{"time": 0.0, "velocity [m/s]": 1.5}, {"time": 0.002, "velocity [m/s]": 2.5}, {"time": 0.004, "velocity [m/s]": -1}]"#,
            "{\"time\": 0.0, \"velocity [m/s]\": 1.5}\n{\"time\": 0.002, \"velocity [m/s]\": 2.5}\n{\"time\": 0.004, \"velocity [m/s]\": -1}\n",
            "[[0.0, 1.5], [0.002, 2.5], [0.004, -1.0]]",
            "[[0.0, 0.002, 0.004, 0.006], [1.5, 2.5, -1.0, 0.5]]",
            r#"{"run": {"fs": 500, "v": [1.5, 2.5, -1], "v_unit": "m/s"}, "name": "a"}"#,
            r#"{"time": {"0": 0.0, "2": 0.004, "1": 0.002}, "v [m/s]": {"0": 1.5, "1": 2.5, "2": -1}}"#,
            r#"{"columns": ["time", "v [m/s]"], "index": [0, 1, 2], "data": [[0.0, 1.5], [0.002, 2.5], [0.004, -1]]}"#,
            r#"{"t": ["10:00:00.000", "10:00:00.002", "10:00:00.004"], "units": {"v": "m/s"}, "v": [1.5, 2.5, -1]}"#,
            r#"{"1": {"t": 0.002, "v [m/s]": 2.5}, "0": {"t": 0.0, "v [m/s]": 1.5}, "2": {"t": 0.004, "v [m/s]": -1}}"#,
            r#"{"schema": {"fields": [{"name": "t"}]}, "data": [{"index": 0, "t": 0.0, "v [m/s]": 1.5}, {"index": 1, "t": 0.002, "v [m/s]": 2.5}, {"index": 2, "t": 0.004, "v [m/s]": -1}]}"#,
            r#"{"channels": [{"name": "v", "unit": "m/s", "sampling_rate": 500, "data": [1.5, 2.5, -1]}]}"#,
            "[1.5, 2.5, -1]",
        ] {
            let reader = if text.starts_with("[1.5") { Reader::default().rate(500.0) } else { Reader::default() };
            let file = reader.parse(text).unwrap();
            let reading = file.reading().unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!((file.format(), reading.record.rate()), (Format::Json, 500.0), "{text}");
            assert_eq!(reading.record.values()[..3], [1.5, 2.5, -1.0], "{text}");
            let has_name = reading.channel != "1" && reading.channel != "0" && !reading.channel.is_empty();
            assert_eq!(has_name, reading.channel.ends_with("[m/s]"), "{text}: {}", reading.channel);
        }
    }

    #[test]
    fn damage_is_named() {
        let error = Reader::default().parse("{\"t\": [0, 1],\n\"v\": [1, }\n").unwrap_err().to_string();
        assert!(error.starts_with("the JSON file is damaged: ") && error.contains("line 2"), "{error}");
        let gap = Reader::default().parse("{\"t\": [0, 1], \"v\": [1, null]}").unwrap().reading().unwrap_err();
        assert!(gap.to_string().contains("column \"v\": \"\" is not a number"), "{gap}");
    }
}
