//! The record that an instrument would take of a simulated motion.

use std::path::{Path, PathBuf};

use clap::Args;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::files::named;
use crate::refusal::{Kind, OfKind};
use crate::scenario::{Motion, Simulation};

/// A table of the motion, as `fmm identify` reads it.
#[derive(Debug, Args)]
pub(super) struct Record {
    /// Write time, displacement and velocity into this table (CSV), a record for `fmm identify`
    #[arg(long = "record", id = "record", value_name = "FILE")]
    file: Option<PathBuf>,
    /// White noise in that table: its standard deviation over the largest value of the column
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, requires = "record")]
    noise: f64,
    /// Which noise: another number gives another noise, the same number the same
    #[arg(long, value_name = "NUMBER", default_value_t = 1, requires = "record")]
    seed: u64,
}

impl Record {
    /// Writes the table, if it is asked for, and tells where.
    pub(super) fn write(&self, scenario: &Simulation, motion: &Motion) -> Result<Option<String>, OfKind> {
        let Some(path) = &self.file else { return Ok(None) };
        if !(self.noise >= 0.0 && self.noise.is_finite()) {
            let what = format!("--noise {}: give a share of the largest value, such as 0.001", self.noise);
            return Err(Kind::Option.refusal(what));
        }
        self.table(path, scenario, motion).map_err(|error| Kind::Unwritable.refusal(named(path)(error)))?;
        Ok(Some(format!("record: {}", path.display())))
    }

    fn table(&self, path: &Path, scenario: &Simulation, motion: &Motion) -> Result<(), csv::Error> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let mut noisy = |values: &[f64]| -> Vec<f64> {
            let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
            values.iter().map(|value| value + self.noise * largest * normal()).collect()
        };
        let samples = &motion.samples;
        let columns = [noisy(&samples.x), noisy(&samples.v)];
        let [position, velocity, _] = scenario.units();
        let mut table = csv::Writer::from_path(path)?;
        let names = ["time [s]".to_owned(), format!("displacement [{position}]"), format!("velocity [{velocity}]")];
        table.write_record(names)?;
        for ((time, x), v) in samples.t.iter().zip(&columns[0]).zip(&columns[1]) {
            table.write_record([time, x, v].map(|value| format!("{value:e}")))?;
        }
        Ok(table.flush()?)
    }
}
