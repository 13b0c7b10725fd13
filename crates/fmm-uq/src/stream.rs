//! Random numbers of one block of trials.

use std::convert::Infallible;

use rand::SeedableRng;
use rand::rand_core::{Rng, TryRng};
use rand_chacha::ChaCha8Rng;

/// Numbers that are made at once.
const WORDS: usize = 128;

/// The generator of a block: ChaCha8 with the seed as its key and the index of the block as its stream.
///
/// It gives the numbers of [`ChaCha8Rng`] in their order. Taking them from a buffer of its own is short enough for a
/// sampler to have it inlined.
pub(crate) struct Stream {
    words: [[u8; 8]; WORDS],
    next: usize,
    generator: ChaCha8Rng,
}

impl Stream {
    pub(crate) fn new(seed: u64, block: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(block);
        Self { words: [[0; 8]; WORDS], next: WORDS, generator }
    }

    #[cold]
    #[inline(never)]
    fn refill(&mut self) {
        self.generator.fill_bytes(self.words.as_flattened_mut());
        self.next = 0;
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
        if self.next >= WORDS {
            self.refill();
        }
        let word = self.words[self.next];
        self.next += 1;
        Ok(u64::from_le_bytes(word))
    }

    #[inline]
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        let mut rest = bytes;
        while !rest.is_empty() {
            if self.next >= WORDS {
                self.refill();
            }
            let ready = self.words[self.next..].as_flattened();
            let (now, later) = rest.split_at_mut(rest.len().min(ready.len()));
            now.copy_from_slice(&ready[..now.len()]);
            self.next += now.len().div_ceil(8);
            rest = later;
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
        // The same numbers as bytes, in pieces that end inside of a number and of the buffer.
        let mut bytes = [0; 1003];
        for length in [1_usize, 8, 803, 1003, 16] {
            let expected: Vec<u8> = (0..length.div_ceil(8)).flat_map(|_| plain.next_u64().to_le_bytes()).collect();
            stream.fill_bytes(&mut bytes[..length]);
            assert_eq!(bytes[..length], expected[..length]);
        }
        assert_ne!(Stream::new(7, 4).next_u64(), Stream::new(7, 3).next_u64());
        assert_ne!(Stream::new(8, 3).next_u64(), Stream::new(7, 3).next_u64());
    }
}
