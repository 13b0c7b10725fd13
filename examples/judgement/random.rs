//! Random numbers of one record.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

/// A stream of random numbers that depends on the name of a cell and the number of a record, and on nothing else.
pub(crate) struct Random(ChaCha8Rng);

impl Random {
    /// The stream of record number `record` of the cell called `name`.
    pub(crate) fn of(name: &str, record: u64) -> Self {
        // FNV-1a: the same on every machine and in every version.
        let seed = name
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        stream.set_stream(record);
        Self(stream)
    }

    /// A number between `low` and `high`.
    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let share: f64 = StandardUniform.sample(&mut self.0);
        low + (high - low) * share
    }

    /// A number between `low` and `high`, each octave as probable as the next.
    pub(crate) fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    /// A phase (rad).
    pub(crate) fn phase(&mut self) -> f64 {
        self.uniform(0.0, TAU)
    }

    /// True as often as not.
    pub(crate) fn coin(&mut self) -> bool {
        self.uniform(0.0, 1.0) < 0.5
    }

    /// A number of mean zero and standard deviation one.
    pub(crate) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}
