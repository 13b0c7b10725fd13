//! The result of a search among designs.

/// A set of measurements that a [`DesignSearch`](crate::DesignSearch) chose.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenDesign {
    pub(crate) measurements: Vec<usize>,
    pub(crate) score: f64,
    pub(crate) is_exhaustive: bool,
}

impl ChosenDesign {
    /// Places of the chosen candidates, ascending; one that is to be repeated is there as often.
    pub fn measurements(&self) -> &[usize] {
        &self.measurements
    }

    /// Each chosen candidate with how often it is to be measured.
    pub fn counts(&self) -> Vec<(usize, usize)> {
        let groups = self.measurements.chunk_by(|a, b| a == b);
        groups.map(|group| (group[0], group.len())).collect()
    }

    /// The logarithm of the standard uncertainty that was made small, see
    /// [`DesignSearch::score`](crate::DesignSearch::score).
    pub fn score(&self) -> f64 {
        self.score
    }

    /// Whether every possible set was looked at, so that there is no better one.
    pub fn is_exhaustive(&self) -> bool {
        self.is_exhaustive
    }
}
