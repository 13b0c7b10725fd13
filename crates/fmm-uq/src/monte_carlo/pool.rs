//! Blocks of trials put together.

use crate::error::UncertaintyError;
use crate::failure::Failures;
use crate::monte_carlo::block::Block;

/// Values of an output for which memory is reserved at once.
const ROOM: u64 = 1 << 27;

/// The values of blocks that came so far, in their order: one column for each output.
pub(crate) struct Pool {
    pub(super) columns: Vec<Vec<f64>>,
    expected: u64,
    /// Number of trials, failed ones included.
    pub(super) trials: u64,
    pub(super) failures: Failures,
}

impl Pool {
    /// An empty pool with room for the `expected` number of trials.
    pub(crate) fn new(expected: u64) -> Self {
        Self { columns: Vec::new(), expected, trials: 0, failures: Failures::default() }
    }

    /// Appends blocks.
    pub(crate) fn add(&mut self, blocks: &[Block]) -> Result<(), UncertaintyError> {
        for block in blocks {
            self.trials += block.trials as u64;
            self.failures.append(&block.failures);
            if block.outputs == 0 {
                continue;
            }
            if self.columns.is_empty() {
                self.columns.resize_with(block.outputs, Vec::new);
                for column in &mut self.columns {
                    // Without room in one piece, the column grows.
                    let _ = column.try_reserve_exact(self.expected.min(ROOM) as usize);
                }
            }
            let (first, again) = (self.columns.len(), block.outputs);
            if first != again {
                return Err(UncertaintyError::output_count_changed(first, again));
            }
            if let [column] = self.columns.as_mut_slice() {
                column.extend_from_slice(&block.values);
                continue;
            }
            for (output, column) in self.columns.iter_mut().enumerate() {
                column.extend(block.values.iter().skip(output).step_by(block.outputs));
            }
        }
        Ok(())
    }
}
