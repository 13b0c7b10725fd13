//! Warnings: statements of a file that its points contradict.

/// Something in a Universal File that is not as it should be and did not keep it from being read.
///
/// Lines count from 1 and are those of an editor; the line is that on which the data set begins, unless stated.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Warning {
    /// The header promises more points than there are. Those that are there were read; a data set without any is
    /// left out.
    FewerPoints {
        /// Line at which the data set begins.
        line: u64,
        /// Number of points that its header promises.
        promised: u64,
        /// Number of points that are present.
        present: usize,
    },
    /// Points follow those that the header promises. They were not read.
    MorePoints {
        /// Line at which the data set begins.
        line: u64,
        /// Number of points that its header promises.
        promised: u64,
    },
    /// The header of a binary data set states another number of bytes than its points have. The points were read.
    ByteCount {
        /// Line at which the data set begins.
        line: u64,
        /// The number stated.
        stated: u64,
        /// Value of the points themselves.
        actual: u64,
    },
    /// Values that are infinite or not a number.
    NotFinite {
        /// Line at which the data set begins.
        line: u64,
        /// Number of such points.
        count: usize,
    },
    /// The file ends within a header. The data set is left out.
    HeaderCut {
        /// Line at which the data set begins.
        line: u64,
    },
    /// The file ends without the line that closes the data set. A number at the very end was not read, because it
    /// may be cut off.
    NotClosed {
        /// Line at which the data set begins.
        line: u64,
    },
    /// Text between data sets.
    Stray {
        /// The first line of it.
        line: u64,
    },
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::FewerPoints { line, promised, present } => {
                write!(f, "the data set at line {line} promises {promised} points, but {present} are there")
            }
            Self::MorePoints { line, promised } => {
                write!(f, "the data set at line {line} promises {promised} points, but more are there")
            }
            Self::ByteCount { line, stated, actual } => {
                write!(f, "the data set at line {line} states {stated} bytes, but its points have {actual}")
            }
            Self::NotFinite { line, count } => {
                write!(f, "the data set at line {line} has {count} points that are not finite")
            }
            Self::HeaderCut { line } => write!(f, "the file ends within the header of the data set at line {line}"),
            Self::NotClosed { line } => write!(f, "the file ends before the data set at line {line} does"),
            Self::Stray { line } => write!(f, "line {line} belongs to no data set"),
        }
    }
}
