//! Random numbers of one block of trials.

use std::convert::Infallible;

use rand::SeedableRng;
use rand::rand_core::{Rng, TryRng};
use rand_chacha::ChaCha8Rng;

/// Numbers that are made at once.
const WORDS: usize = 64;

/// The generator of a block: ChaCha8 with the seed as its key and the index of the block as its stream.
///
/// It gives the numbers of [`ChaCha8Rng`] in their order. Taking them from a buffer of its own is short enough for a
/// sampler to have it inlined.
pub(crate) struct Stream {
    words: [u64; WORDS],
    next: usize,
    generator: ChaCha8Rng,
}

impl Stream {
    pub(crate) fn new(seed: u64, block: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(block);
        Self { words: [0; WORDS], next: WORDS, generator }
    }

    #[cold]
    #[inline(never)]
    fn refill(&mut self) -> u64 {
        let mut bytes = [0; 8 * WORDS];
        self.generator.fill_bytes(&mut bytes);
        for (word, bytes) in self.words.iter_mut().zip(bytes.as_chunks::<8>().0) {
            *word = u64::from_le_bytes(*bytes);
        }
        self.next = 1;
        self.words[0]
    }
}

impl TryRng for Stream {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.try_next_u64().map(|word| word as u32)
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        match self.words.get(self.next) {
            Some(&word) => {
                self.next += 1;
                Ok(word)
            }
            None => Ok(self.refill()),
        }
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            chunk.copy_from_slice(&self.next_u64().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_those_of_chacha() {
        let mut plain = ChaCha8Rng::seed_from_u64(7);
        plain.set_stream(3);
        let mut stream = Stream::new(7, 3);
        for _ in 0..1000 {
            assert_eq!(stream.next_u64(), plain.next_u64());
        }
        assert_ne!(Stream::new(7, 4).next_u64(), Stream::new(7, 3).next_u64());
        assert_ne!(Stream::new(8, 3).next_u64(), Stream::new(7, 3).next_u64());
    }
}
