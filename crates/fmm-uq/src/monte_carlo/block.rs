//! A thousand trials: the smallest part of a Monte Carlo.

use crate::failure::{Failure, FailureKind, Failures};
use crate::model::ModelOutput;
use crate::monte_carlo::sampler::Sampler;
use crate::stream::Stream;

/// Trials of a block. Small enough that a hundred thousand trials keep a hundred processors busy, large enough that
/// starting a stream costs nothing beside them.
pub(crate) const BLOCK_TRIALS: usize = 1000;
/// Trials whose inputs are drawn together; a divisor of the block.
const BATCH: usize = 100;

/// The results of one block, by trial and within a trial by output.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Block {
    pub(crate) index: u64,
    pub(crate) trials: usize,
    pub(crate) outputs: usize,
    pub(crate) failures: Failures,
    #[cfg_attr(feature = "serde", serde(with = "crate::monte_carlo::block::bits"))]
    pub(crate) values: Vec<f64>,
}

impl Block {
    /// Runs a block, or gives up where `watch` says so: it is asked after each batch, with the number of trials done
    /// since and that of failures so far.
    pub(crate) fn run<R: ModelOutput<f64>>(
        (seed, index, trials): (u64, u64, usize),
        sampler: &Sampler,
        model: &impl Fn(&[f64]) -> R,
        watch: &impl Fn(usize, u64) -> bool,
    ) -> Self {
        let mut rng = Stream::new(seed, index);
        let width = sampler.width();
        let mut rows = vec![0.0; width * BATCH];
        let mut block = Self { index, trials: 0, outputs: 0, failures: Failures::default(), values: Vec::new() };
        while block.trials < trials {
            let batch = BATCH.min(trials - block.trials);
            sampler.fill(&mut rng, &mut rows);
            for row in rows.chunks_exact(width).take(batch) {
                let start = block.values.len();
                if let Err(kind) = block.evaluate(row, model, trials) {
                    block.values.truncate(start);
                    block.failures.add(Failure { block: index, trial: block.trials, kind });
                }
                block.trials += 1;
            }
            if !watch(batch, block.failures.count()) {
                break;
            }
        }
        block
    }

    /// The inputs of one trial.
    pub(crate) fn inputs(seed: u64, index: u64, trial: usize, sampler: &Sampler) -> Vec<f64> {
        let mut rng = Stream::new(seed, index);
        let width = sampler.width();
        let mut rows = vec![0.0; width * BATCH];
        for _ in 0..=trial / BATCH {
            sampler.fill(&mut rng, &mut rows);
        }
        rows[trial % BATCH * width..][..width].to_vec()
    }

    fn evaluate<R: ModelOutput<f64>>(
        &mut self,
        row: &[f64],
        model: &impl Fn(&[f64]) -> R,
        trials: usize,
    ) -> Result<(), FailureKind> {
        let start = self.values.len();
        model(row).append_to(&mut self.values).map_err(|error| FailureKind::Error(error.to_string()))?;
        let found = self.values.len() - start;
        if found != self.outputs {
            if self.outputs != 0 || found == 0 {
                return Err(FailureKind::OutputCount { found });
            }
            self.outputs = found;
            self.values.reserve_exact(trials.saturating_mul(found) - found);
        }
        match self.values[start..].iter().position(|value| !value.is_finite()) {
            Some(output) => Err(FailureKind::NotFinite { output }),
            None => Ok(()),
        }
    }
}

#[cfg(feature = "serde")]
mod bits {
    //! Numbers as the hexadecimal digits of their bits, so that no format rounds them on the way.

    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    /// Digits of one number.
    const DIGITS: usize = 16;

    pub(crate) fn serialize<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
        const HEXADECIMAL: &[u8; 16] = b"0123456789abcdef";
        let mut text = String::with_capacity(values.len() * DIGITS);
        for value in values {
            let bits = value.to_bits();
            text.extend((0..DIGITS).rev().map(|digit| char::from(HEXADECIMAL[(bits >> (4 * digit)) as usize & 15])));
        }
        serializer.serialize_str(&text)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
        let text = String::deserialize(deserializer)?;
        let whole = text.as_bytes().chunks_exact(DIGITS);
        if !whole.remainder().is_empty() {
            return Err(D::Error::custom(format!("{} hexadecimal digits are no whole number of values", text.len())));
        }
        let value = |digits: &[u8]| {
            digits.iter().try_fold(0_u64, |bits, &digit| Some(bits << 4 | u64::from(char::from(digit).to_digit(16)?)))
        };
        let values = whole.map(|digits| value(digits).map(f64::from_bits)).collect::<Option<Vec<f64>>>();
        values.ok_or_else(|| D::Error::custom("values must be hexadecimal digits"))
    }
}
