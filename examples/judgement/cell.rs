//! One question of the study: a kind of record, drawn as often as wanted.

use super::{Case, Found, Random, changing, coverage, disturbances, falling, laws};

/// Which question a cell asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Group {
    /// Do intervals hold the truth where the standard laws are right?
    Coverage,
    /// And where the measurement is disturbed?
    Disturbance,
    /// And where friction falls with the speed?
    Falling,
    /// And where friction changes during the record?
    Changing,
    /// Is the law told that moved the machine?
    Law,
}

impl Group {
    /// Records a cell unless another number is asked for.
    pub(crate) fn records(self) -> u64 {
        if self == Self::Law { 30 } else { 200 }
    }
}

type Draw = Box<dyn Fn(&mut Random) -> Found<Case> + Send + Sync>;

/// A kind of record.
pub(crate) struct Cell {
    pub(crate) name: String,
    pub(crate) about: String,
    pub(crate) group: Group,
    draw: Draw,
}

impl Cell {
    /// The cell of `group` called `name`, whose records `draw` makes.
    pub(crate) fn new(
        group: Group,
        name: impl Into<String>,
        about: impl Into<String>,
        draw: impl Fn(&mut Random) -> Found<Case> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), about: about.into(), group, draw: Box::new(draw) }
    }

    /// Record number `record`.
    pub(crate) fn case(&self, record: u64) -> Found<Case> {
        (self.draw)(&mut Random::of(&self.name, record))
    }
}

/// All cells.
pub(crate) fn cells() -> Vec<Cell> {
    let groups = [coverage::cells(), disturbances::cells(), falling::cells(), changing::cells(), laws::cells()];
    groups.into_iter().flatten().collect()
}
