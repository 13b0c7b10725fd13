//! Row of a table: its fields, and the content of its columns.

use std::ops::Range;

use super::fields::{Separator, split};
use super::lines::Line;

/// Content of a column, by the last rows that are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    Text,
    Blank,
}

/// A line and its fields.
pub(super) struct Row<'a> {
    line: &'a Line,
    fields: Vec<Range<usize>>,
}

impl<'a> Row<'a> {
    pub(super) fn of(line: &'a Line, separator: Separator) -> Self {
        let mut fields = Vec::new();
        split(&line.text, separator, &mut fields);
        Self { line, fields }
    }

    pub(super) fn len(&self) -> usize {
        self.fields.len()
    }

    pub(super) fn field(&self, column: usize) -> &'a [u8] {
        self.fields.get(column).map_or(&[], |range| &self.line.text[range.clone()])
    }
}
