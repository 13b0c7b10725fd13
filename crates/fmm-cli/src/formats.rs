//! The file formats that are read: `fmm formats`.

use std::error::Error;

use crate::output::print;

/// A format is told by what a file begins with, whatever its name.
const FORMATS: &str = "\
A format is told by what a file begins with, whatever its name.

text       columns of numbers with or without a header: CSV, TSV, LVM and the like; any separator, decimal points or commas
matlab     MATLAB 5 to 7 (.mat), and 7.3, which is HDF5
hdf5       HDF5 (.h5)
numpy      NumPy (.npy, .npz)
universal  Universal File, data sets 58 and 58b (.uff, .unv, .58)

A channel is chosen by its name, its number or its quantity; `fmm identify FILE` says what was found in a file and what must be said.";

pub(crate) fn run() -> Result<(), Box<dyn Error>> {
    print(FORMATS)
}
