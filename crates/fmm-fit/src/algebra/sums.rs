//! Sums over long columns with the widest vectors of the processor, always in the same order.
//!
//! Multiplication and addition are fused where the processor can, so that the last digit of a sum depends on its kind.

use std::marker::PhantomData;

use pulp::{Arch, Simd, WithSimd};

/// Vectors that are summed side by side, so that one addition need not wait for the one before.
const SIDE_BY_SIDE: usize = 4;

/// Shorter sums are over before vectors are chosen.
const SHORT: usize = 64;

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    sum::<Product>(a, b)
}

/// `‖a‖²`.
pub(crate) fn sum_of_squares(a: &[f64]) -> f64 {
    dot(a, a)
}

/// `½ (‖a‖² − ‖b‖²)` without the cancellation of two large sums.
pub(crate) fn half_difference_of_squares(a: &[f64], b: &[f64]) -> f64 {
    0.5 * sum::<DifferenceOfSquares>(a, b)
}

/// The scalar products of every pair of `W` columns of the same length, `[row][column]` with `row ≤ column`; zeros
/// elsewhere.
///
/// Each number is read once and each sum has an accumulator of its own, which the compiler does not find by itself.
pub(crate) fn products<const W: usize>(columns: [&[f64]; W]) -> [[f64; W]; W] {
    Arch::new().dispatch(Products(columns))
}

/// A sum over two columns.
trait Term {
    /// `sum` and the terms of a vector of each column.
    fn add<S: Simd>(simd: S, a: S::f64s, b: S::f64s, sum: S::f64s) -> S::f64s;

    /// One term.
    fn of(a: f64, b: f64) -> f64;
}

struct Product;

#[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
impl Term for Product {
    #[inline(always)]
    fn add<S: Simd>(simd: S, a: S::f64s, b: S::f64s, sum: S::f64s) -> S::f64s {
        simd.mul_add_e_f64s(a, b, sum)
    }
    #[inline(always)]
    fn of(a: f64, b: f64) -> f64 {
        a * b
    }
}

struct DifferenceOfSquares;

#[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
impl Term for DifferenceOfSquares {
    #[inline(always)]
    fn add<S: Simd>(simd: S, a: S::f64s, b: S::f64s, sum: S::f64s) -> S::f64s {
        simd.mul_add_e_f64s(simd.sub_f64s(a, b), simd.add_f64s(a, b), sum)
    }
    #[inline(always)]
    fn of(a: f64, b: f64) -> f64 {
        (a - b) * (a + b)
    }
}

fn sum<T: Term>(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, b) = (&a[..length], &b[..length]);
    if length < SHORT {
        a.iter().zip(b).map(|(a, b)| T::of(*a, *b)).sum()
    } else {
        Arch::new().dispatch(Sum::<T>(a, b, PhantomData))
    }
}

struct Sum<'a, T>(&'a [f64], &'a [f64], PhantomData<T>);

impl<T: Term> WithSimd for Sum<'_, T> {
    type Output = f64;

    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let ((a, a_rest), (b, b_rest)) = (S::as_simd_f64s(self.0), S::as_simd_f64s(self.1));
        let ((a, a_few), (b, b_few)) = (a.as_chunks::<SIDE_BY_SIDE>(), b.as_chunks::<SIDE_BY_SIDE>());
        let mut sums = [simd.splat_f64s(0.0); SIDE_BY_SIDE];
        for (a, b) in a.iter().zip(b) {
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum = T::add(simd, a[i], b[i], *sum);
            }
        }
        let [first, second, third, fourth] = sums;
        let pairs = simd.add_f64s(simd.add_f64s(first, second), simd.add_f64s(third, fourth));
        let vector = a_few.iter().zip(b_few).fold(pairs, |sum, (a, b)| T::add(simd, *a, *b, sum));
        let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| T::of(*a, *b)).sum();
        simd.reduce_sum_f64s(vector) + rest
    }
}

struct Products<'a, const W: usize>([&'a [f64]; W]);

impl<const W: usize> WithSimd for Products<'_, W> {
    type Output = [[f64; W]; W];

    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let split = self.0.map(S::as_simd_f64s);
        let length = split[0].0.len();
        let vectors = split.map(|(vectors, _)| &vectors[..length]);
        let mut sums = [[simd.splat_f64s(0.0); W]; W];
        for i in 0..length {
            let rows = vectors.map(|vectors| vectors[i]);
            for row in 0..W {
                for column in row..W {
                    sums[row][column] = simd.mul_add_e_f64s(rows[row], rows[column], sums[row][column]);
                }
            }
        }
        let mut products = sums.map(|line| line.map(|sum| simd.reduce_sum_f64s(sum)));
        for i in 0..split[0].1.len() {
            for row in 0..W {
                for column in row..W {
                    products[row][column] += split[row].1[i] * split[column].1[i];
                }
            }
        }
        products
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole numbers, of which every sum is exact in whatever order.
    fn column(step: usize, length: usize) -> Vec<f64> {
        (0..length).map(|i| (i * step % 101) as f64 - 50.0).collect()
    }

    #[test]
    fn every_length_is_summed_whole() {
        for length in (0..150).chain([1501]) {
            let (a, b, c) = (column(7, length), column(31, length), column(53, length));
            let expected: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
            assert_eq!(dot(&a, &b), expected, "length {length}");
            assert_eq!(sum_of_squares(&a), dot(&a, &a), "length {length}");
            let half = 0.5 * (dot(&a, &a) - dot(&b, &b));
            assert_eq!(half_difference_of_squares(&a, &b), half, "length {length}");
            let all = products([&a, &b, &c]);
            assert_eq!([all[0][1], all[0][2], all[1][2]], [dot(&a, &b), dot(&a, &c), dot(&b, &c)], "length {length}");
            assert_eq!([all[0][0], all[1][1], all[2][2]], [dot(&a, &a), dot(&b, &b), dot(&c, &c)], "length {length}");
        }
    }

    #[test]
    fn a_small_difference_of_large_squares_keeps_its_digits() {
        let a = vec![1e8; 1501];
        let b: Vec<f64> = a.iter().map(|a| a - 1e-7).collect();
        // The distance as it is stored, and the sum of the two.
        let expected = 0.5 * 1501.0 * (a[0] - b[0]) * (a[0] + b[0]);
        assert!((half_difference_of_squares(&a, &b) / expected - 1.0).abs() < 1e-14);
    }
}
