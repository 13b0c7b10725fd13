//! Arrays in files of NumPy: npy, a single array, and npz, an archive of several.
//!
//! Arrays of other types than real numbers (complex numbers, text, structures, Python objects) are not read, but those
//! of an archive are listed.

mod file;
mod header;
#[cfg(test)]
mod tests;

pub(crate) use file::parse;
