//! Table of quantities: each number of machine, law, experiment and sensor, and the findings that follow from them.

pub(crate) mod derived;
pub(crate) mod force;
pub(crate) mod prior;
pub(crate) mod rows;
pub(crate) mod table;
