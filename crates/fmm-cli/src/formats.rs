//! The file formats that are read: `fmm formats`.

use std::error::Error;

use crate::output::print;

/// Names of the formats and what they are.
const FORMATS: [(&str, &str); 5] = [
    (
        "text",
        "columns of numbers with or without a header: CSV, TSV, LVM and the like; any separator, decimal points or commas",
    ),
    ("matlab", "MATLAB 5 to 7 (.mat), and 7.3, which is HDF5"),
    ("hdf5", "HDF5 (.h5)"),
    ("numpy", "NumPy (.npy, .npz)"),
    ("universal", "Universal File, data sets 58 and 58b (.uff, .unv, .58)"),
];

pub(crate) fn run(json: bool) -> Result<(), Box<dyn Error>> {
    if json {
        let formats = FORMATS.map(|(name, files)| serde_json::json!({ "name": name, "files": files }));
        return print(serde_json::to_string_pretty(&formats)?);
    }
    let lines = FORMATS.map(|(name, files)| format!("{name:<10} {files}\n"));
    print(format_args!(
        "A format is told by what a file begins with, whatever its name.\n\n{}\n\
         A channel is chosen by its name, its number or its quantity; `fmm identify FILE` says what was found in a file and what must be said.",
        lines.concat()
    ))
}
