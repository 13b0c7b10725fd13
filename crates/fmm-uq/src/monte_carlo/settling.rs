//! Settling of the ends of the shortest interval.

use fmm_model::coverage_factor;

use crate::error::UncertaintyError;
use crate::moments::Moments;
use crate::monte_carlo::output_sample::shortest;

/// Fewest batches of equal length that the sequences are divided into; the most are twice as many.
const FEWEST_BATCHES: usize = 10;
/// Exponent at which the ends settle where the density crosses the level of the interval with a slope.
const REGULAR_RATE: f64 = 1.0 / 3.0;

/// The ends of the shortest interval of all trials so far, which settle more slowly than any average does.
///
/// A shift of the interval changes its width by the square of the shift only, and so the random width decides on where
/// it lies: the ends scatter as M^(−1/3) at best, and not less at all with more trials where the density is flat. The
/// scatter between sequences therefore does not tell that of the pooled ends. Batches that grow with the run do:
///
/// ```text
/// s(M) = s_b (M_b/M)^r,   r = ln(s_1/s_b)/ln(M_b/M_1), 0 ≤ r ≤ 1/3
/// ```
///
/// with s_1 between sequences of M_1 trials and s_b between batches of M_b.
///
/// # References
/// J. Kim, D. Pollard, "Cube root asymptotics", Ann. Statist. 18 (1990) 191, doi:10.1214/aos/1176347498.
#[derive(Debug, Clone)]
pub(crate) struct Settling {
    level: f64,
    /// Number of values after each sequence.
    marks: Vec<usize>,
    sequences: [Vec<f64>; 2],
    batches: [Vec<f64>; 2],
    /// Sequences of a batch, a power of two.
    length: usize,
}

impl Settling {
    pub(crate) fn new(level: f64) -> Self {
        Self { level, marks: Vec::new(), sequences: Default::default(), batches: Default::default(), length: 1 }
    }

    /// Takes in the values of the next sequence, which are the last ones of `pooled`.
    pub(crate) fn add(&mut self, pooled: &[f64]) -> Result<(), UncertaintyError> {
        self.marks.push(pooled.len());
        let count = self.marks.len();
        let ends = self.ends(pooled, count - 1, 1)?;
        append(&mut self.sequences, ends);
        if count.is_multiple_of(self.length) {
            let ends = self.ends(pooled, count - self.length, self.length)?;
            append(&mut self.batches, ends);
        }
        if self.batches[0].len() == 2 * FEWEST_BATCHES {
            self.length *= 2;
            self.batches = Default::default();
            for batch in 0..FEWEST_BATCHES {
                let ends = self.ends(pooled, batch * self.length, self.length)?;
                append(&mut self.batches, ends);
            }
        }
        Ok(())
    }

    /// Largest error of either end at 95 %; infinite before there are enough batches.
    pub(crate) fn doubt(&self) -> f64 {
        let count = self.batches[0].len();
        if count < FEWEST_BATCHES {
            return f64::INFINITY;
        }
        let factor = coverage_factor(0.95, (count - 1) as f64).unwrap_or(f64::INFINITY);
        let ends = self.sequences.iter().zip(&self.batches);
        ends.map(|(sequences, batches)| factor * self.scatter(sequences, batches)).fold(0.0, f64::max)
    }

    /// s(M) of one end.
    fn scatter(&self, sequences: &[f64], batches: &[f64]) -> f64 {
        let deviation = |ends: &[f64]| Moments::of_values(ends).standard_deviation().unwrap_or(f64::INFINITY);
        let (single, batched) = (deviation(sequences), deviation(batches));
        if batched == 0.0 {
            return 0.0;
        }
        let length = self.length as f64;
        let rate = if self.length == 1 { 0.0 } else { (single / batched).ln() / length.ln() };
        batched * (length / self.marks.len() as f64).powf(rate.clamp(0.0, REGULAR_RATE))
    }

    /// Ends of the shortest interval of some sequences.
    fn ends(&self, pooled: &[f64], first: usize, count: usize) -> Result<[f64; 2], UncertaintyError> {
        let start = first.checked_sub(1).map_or(0, |before| self.marks[before]);
        let interval = shortest(&pooled[start..self.marks[first + count - 1]], self.level)?;
        Ok([interval.low, interval.high])
    }
}

fn append(lists: &mut [Vec<f64>; 2], ends: [f64; 2]) {
    for (list, end) in lists.iter_mut().zip(ends) {
        list.push(end);
    }
}
