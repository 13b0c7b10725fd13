//! The two channels of a trial.

use std::fmt;

/// Which of the two channels of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Channel {
    /// What excites (N).
    Force,
    /// What is excited: displacement, velocity or acceleration.
    Response,
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Force => "force",
            Self::Response => "response",
        })
    }
}
