//! Arrays of numbers with names, as files of MATLAB and NumPy hold them, and records of them.

mod array;
mod file;
mod reader;
mod slice;

pub use array::Array;
pub(crate) use array::Notation;
pub(crate) use file::ArrayFile;
pub(crate) use slice::{Series, Slice};
