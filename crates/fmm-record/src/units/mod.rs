//! Units and quantities as files spell them, and what a channel means by them.

pub(crate) mod label;
pub(crate) mod meaning;
pub(crate) mod request;
pub(crate) mod spelling;
pub(crate) mod word;
pub(crate) mod written_unit;
