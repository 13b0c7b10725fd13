//! Points that fill a cube more evenly than random ones.

use crate::UncertaintyError;
use crate::random::sobol_directions::DIRECTIONS;

/// Bits of a coordinate that the sequence itself decides; scrambling adds random ones below.
const BITS: u32 = 32;

/// A Sobol sequence in up to 64 dimensions, scrambled after Owen.
///
/// Scrambling flips every bit of a coordinate by a random function of all bits above it. Each point is then uniformly
/// distributed in the cube, sets of 2^k points stay as even as before, and different seeds give independent sets whose
/// scatter is an honest error.
///
/// # Why not a library
/// A shard begins at any index, and errors are honest through Owen's scrambling, both in double precision: the crate
/// sobol gives points one after the other and unscrambled, sobol_burley scrambled ones in single precision.
///
/// # References
/// I. M. Sobol', USSR Comput. Math. Math. Phys. 7 (1967) 86; A. B. Owen, "Randomly permuted (t, m, s)-nets and (t, s)-
/// sequences", Lecture Notes in Statistics 106 (1995) 299.
#[derive(Debug, Clone)]
pub(crate) struct SobolSequence {
    directions: Vec<[u32; BITS as usize]>,
    seed: u64,
}

impl SobolSequence {
    pub(crate) fn new(dimensions: usize, seed: u64) -> Result<Self, UncertaintyError> {
        let most = DIRECTIONS.len() + 1;
        if dimensions > most {
            return Err(UncertaintyError::too_many_dimensions(dimensions, most));
        }
        Ok(Self { directions: (0..dimensions).map(direction_numbers).collect(), seed })
    }

    /// The `index`th point, below 2³²; each coordinate lies strictly between 0 and 1.
    pub(crate) fn point(&self, index: u32, point: &mut [f64]) {
        for (dimension, (x, directions)) in point.iter_mut().zip(&self.directions).enumerate() {
            let bits = plain(directions, index);
            let key = mix(self.seed ^ mix(dimension as u64 + 1));
            let scrambled = u64::from(scramble(bits, key));
            // 21 random bits below the 32 of the sequence, and half of one more, which keeps off 0 and 1.
            let below = mix(key ^ mix(u64::from(bits) | 1 << 40)) >> 43;
            *x = (((scrambled << 21) | below) as f64 + 0.5) * (1.0 / (1_u64 << 53) as f64);
            *x = x.min(1.0 - f64::EPSILON / 2.0);
        }
    }
}

/// The bits of a coordinate, the first after the binary point on top.
fn plain(directions: &[u32; BITS as usize], index: u32) -> u32 {
    let used = directions.iter().enumerate().filter(|(k, _)| index >> k & 1 == 1);
    used.fold(0, |bits, (_, direction)| bits ^ direction)
}

/// Flips each bit by a hash of the bits above it.
fn scramble(bits: u32, key: u64) -> u32 {
    (0..BITS).fold(0, |scrambled, depth| {
        let place = BITS - 1 - depth;
        // The bits above, with a leading one that tells 0 from 00.
        let above = (u64::from(bits) | 1 << BITS) >> (place + 1);
        let flip = (mix(key ^ mix(above)) >> 63) as u32;
        scrambled | ((bits >> place & 1) ^ flip) << place
    })
}

/// The finaliser of SplitMix64: every bit of the result depends on every bit of `x`.
pub(crate) const fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// v_k = m_k 2^(32 − k) with the recurrence of the primitive polynomial.
fn direction_numbers(dimension: usize) -> [u32; BITS as usize] {
    let mut v = [0; BITS as usize];
    if dimension == 0 {
        for (k, v) in v.iter_mut().enumerate() {
            *v = 1 << (31 - k);
        }
        return v;
    }
    let (coefficients, initial) = DIRECTIONS[dimension - 1];
    let degree = initial.len();
    for k in 0..BITS as usize {
        v[k] = if k < degree {
            initial[k] << (31 - k)
        } else {
            let last = v[k - degree] ^ (v[k - degree] >> degree);
            let middle = (1..degree).filter(|j| coefficients >> (degree - 1 - j) & 1 == 1);
            middle.fold(last, |sum, j| sum ^ v[k - j])
        };
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first 16 points of another implementation, in sixteenths, sorted in the order of the index as its Gray code.
    #[test]
    fn unscrambled_points_are_those_of_the_literature() {
        let sequence = SobolSequence::new(64, 0).unwrap();
        let sixteenths = |dimension: usize, index: u32| plain(&sequence.directions[dimension], index) >> 28;
        for (dimension, expected) in EXPECTED {
            let found: Vec<u32> = (0..16).map(|i: u32| sixteenths(dimension, i ^ (i >> 1))).collect();
            assert_eq!(found, expected, "dimension {dimension}");
        }
    }

    #[test]
    fn scrambled_points_keep_their_balance() {
        // Of 2^k points each dyadic interval of length 2^-k holds exactly one, in every dimension, scrambled or not.
        let sequence = SobolSequence::new(64, 99).unwrap();
        let mut point = [0.0; 64];
        let mut hits = vec![[0_u8; 64]; 256];
        for index in 0..256 {
            sequence.point(index, &mut point);
            for (dimension, x) in point.iter().enumerate() {
                assert!(*x > 0.0 && *x < 1.0);
                hits[(x * 256.0) as usize][dimension] += 1;
            }
        }
        assert!(hits.iter().flatten().all(|&count| count == 1));
        let mut other = [0.0; 64];
        SobolSequence::new(64, 100).unwrap().point(255, &mut other);
        assert_ne!(point, other);
    }

    #[test]
    fn dimensions_are_limited() {
        assert!(matches!(SobolSequence::new(65, 0), Err(UncertaintyError::NoAnswer { .. })));
    }

    const EXPECTED: [(usize, [u32; 16]); 7] = [
        (0, [0, 8, 12, 4, 6, 14, 10, 2, 3, 11, 15, 7, 5, 13, 9, 1]),
        (1, [0, 8, 4, 12, 6, 14, 2, 10, 5, 13, 1, 9, 3, 11, 7, 15]),
        (2, [0, 8, 4, 12, 10, 2, 14, 6, 15, 7, 11, 3, 5, 13, 1, 9]),
        (7, [0, 8, 12, 4, 14, 6, 2, 10, 15, 7, 3, 11, 1, 9, 13, 5]),
        (20, [0, 8, 4, 12, 2, 10, 6, 14, 3, 11, 7, 15, 1, 9, 5, 13]),
        (40, [0, 8, 4, 12, 14, 6, 10, 2, 9, 1, 13, 5, 7, 15, 3, 11]),
        (63, [0, 8, 12, 4, 2, 10, 14, 6, 11, 3, 7, 15, 9, 1, 5, 13]),
    ];
}
