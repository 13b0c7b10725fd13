//! Tables of other formats, written as separated text for the reader of text, which finds names, units and times.

#[cfg(feature = "json")]
pub(super) mod json;
#[cfg(feature = "wav")]
pub(super) mod wav;
#[cfg(feature = "workbook")]
pub(super) mod workbook;

/// Separated text that grows by lines.
struct Text(Vec<u8>);

impl Text {
    fn new() -> Self {
        Self(b"sep=\t\n".to_vec())
    }

    /// Adds a line; tabs and line ends inside of a field become blanks.
    fn line(&mut self, fields: impl IntoIterator<Item = String>) {
        for (column, field) in fields.into_iter().enumerate() {
            if column > 0 {
                self.0.push(b'\t');
            }
            self.0.extend(field.bytes().map(|byte| if matches!(byte, b'\t' | b'\n' | b'\r') { b' ' } else { byte }));
        }
        self.0.push(b'\n');
    }
}
