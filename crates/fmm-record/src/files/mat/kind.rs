//! Kind of a variable that is not a real numeric array.

/// Kind of a variable that is not a real numeric array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Cell,
    Structure,
    /// An object, a function or another thing of MATLAB's own.
    Object,
    Text,
    Sparse,
    Complex,
}

impl Kind {
    /// The kind of a class of arrays by its number; `None` for the numeric classes, 6 to 15.
    pub(super) fn of_class(class: u32) -> Option<Self> {
        match class {
            1 => Some(Self::Cell),
            2 => Some(Self::Structure),
            4 => Some(Self::Text),
            5 => Some(Self::Sparse),
            6..=15 => None,
            _ => Some(Self::Object),
        }
    }
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Cell => "a cell array",
            Self::Structure => "a structure",
            Self::Object => "an object",
            Self::Text => "text",
            Self::Sparse => "a sparse matrix",
            Self::Complex => "complex",
        })
    }
}
