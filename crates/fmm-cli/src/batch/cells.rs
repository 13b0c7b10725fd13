//! Cells of a TOML table as text, and its mistakes with their line.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

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

/// What is wrong with a part of the text, with its line.
pub(super) fn at<T>(text: &str, part: &Spanned<T>, what: &str) -> String {
    let before = text.get(..part.span().start).unwrap_or(text);
    format!("line {}: {what}", before.matches('\n').count() + 1)
}
