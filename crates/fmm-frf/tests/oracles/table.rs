//! The stored tables and records.

use std::path::Path;

use fmm_frf::{AverageOptions, Complex64, ResponseForm, TrialAverage};
use fmm_record::DataFile;

/// The numbers of a table, row by row, without comments, without the header and from column `first` on.
pub(crate) fn rows(table: &str, first: usize) -> Vec<Vec<f64>> {
    let lines = table.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').skip(first).map(|cell| cell.parse().unwrap()).collect()).collect()
}

/// The complex number in two columns.
pub(crate) fn complex(row: &[f64], column: usize) -> Complex64 {
    Complex64::new(row[column], row[column + 1])
}

pub(crate) struct Recording {
    file: DataFile,
}

impl Recording {
    pub(crate) fn read(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
        Self { file: fmm_record::open(path).unwrap() }
    }

    /// A channel whose whole numbers count `per_unit` to the unit.
    pub(crate) fn channel(&self, name: &str, per_unit: f64) -> Vec<f64> {
        self.file.array(name).unwrap().values().iter().map(|count| count / per_unit).collect()
    }
}

/// Force (N) and velocity (m/s) of one of the four impacts at 512 Hz.
pub(crate) fn impact(trial: usize) -> (Vec<f64>, Vec<f64>) {
    let recording = Recording::read("impact4.mat");
    (recording.channel(&format!("force{trial}"), 1e4), recording.channel(&format!("velocity{trial}"), 1e8))
}

/// The average over the four impacts.
pub(crate) fn impacts(options: &AverageOptions) -> TrialAverage {
    let mut average = TrialAverage::new(ResponseForm::Mobility, 512.0, 8192, options).unwrap();
    for trial in 1..=4 {
        let (force, velocity) = impact(trial);
        average.add(&force, &velocity).unwrap();
    }
    average
}
