//! Sampled values of one kinematic quantity, with their derivatives in columns.

use std::marker::PhantomData;

use fmm_model::{Scalar, widest};

use crate::error::SimulationError;

/// The samples of one quantity: one value each, and one column of partial derivatives per direction of the
/// number type `D`.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples<D> {
    pub(crate) values: Vec<f64>,
    partials: Vec<f64>,
    number: PhantomData<D>,
}

impl<D: Scalar> Samples<D> {
    pub(crate) const fn new() -> Self {
        Self { values: Vec::new(), partials: Vec::new(), number: PhantomData }
    }

    /// Makes room for `count` samples. Each must be written: until then it has the value of an earlier run.
    ///
    /// # Errors
    /// [`SimulationError::Exhausted`] if there is no such room.
    pub(crate) fn reset(&mut self, count: usize) -> Result<(), SimulationError> {
        let partials = count.checked_mul(D::DIRECTIONS).ok_or_else(|| SimulationError::memory(count))?;
        for (column, length) in [(&mut self.values, count), (&mut self.partials, partials)] {
            column.truncate(length);
            column.try_reserve_exact(length - column.len()).map_err(|_| SimulationError::memory(count))?;
            column.resize(length, 0.0);
            if cfg!(debug_assertions) {
                // Tests find a sample that was not written.
                column.fill(f64::NAN);
            }
        }
        Ok(())
    }

    /// The column of `direction`, which must be one that `D` carries.
    pub(crate) fn partial_mut(&mut self, direction: usize) -> &mut [f64] {
        let count = self.values.len();
        &mut self.partials[direction * count..(direction + 1) * count]
    }

    /// Writes one number, value and partial derivatives, at `index`.
    pub(crate) fn set(&mut self, index: usize, number: D) {
        self.values[index] = number.value();
        self.set_partials(index, number);
    }

    /// The number, value and partial derivatives, at `index`.
    pub(crate) fn get(&self, index: usize) -> D {
        let (count, value) = (self.values.len(), D::from(self.values[index]));
        (0..D::DIRECTIONS).fold(value, |number, direction| {
            number + D::variable(0.0, direction) * self.partials[direction * count + index]
        })
    }

    /// Writes the partial derivatives of one number at `index`.
    pub(crate) fn set_partials(&mut self, index: usize, number: D) {
        for direction in 0..D::DIRECTIONS {
            self.partial_mut(direction)[index] = number.partial(direction);
        }
    }

    /// Adds one number, value and partial derivatives, to the one at `index`.
    pub(crate) fn add(&mut self, index: usize, number: D) {
        self.values[index] += number.value();
        for direction in 0..D::DIRECTIONS {
            self.partial_mut(direction)[index] += number.partial(direction);
        }
    }

    /// Writes the polynomial Σ cᵢ θⁱ at every index of `range`, `theta` giving θ for an index counted from its start.
    pub(crate) fn polynomial<const N: usize>(
        &mut self,
        range: std::ops::Range<usize>,
        coefficients: &[D; N],
        theta: impl Fn(u32) -> f64,
    ) {
        widest(
            #[inline(always)]
            || {
                let fill = |out: &mut [f64], coefficients: [f64; N]| {
                    // Steps hold far fewer samples than a u32 counts, and its conversion is one that vectors have.
                    for (index, out) in (0u32..).zip(out) {
                        let theta = theta(index);
                        *out = coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * theta + coefficient);
                    }
                };
                fill(&mut self.values[range.clone()], coefficients.map(D::value));
                for direction in 0..D::DIRECTIONS {
                    let column = &mut self.partial_mut(direction)[range.clone()];
                    fill(column, coefficients.map(|coefficient| coefficient.partial(direction)));
                }
            },
        );
    }

    /// Writes `constant` plus the sum of the `terms`, samples times a factor, at every index of `range`.
    pub(crate) fn combine(&mut self, range: std::ops::Range<usize>, constant: D, terms: [(&Self, D); 2]) {
        let count = self.values.len();
        widest(
            #[inline(always)]
            || {
                let [(x, by_x), (y, by_y)] = terms;
                let (x_values, y_values) = (&x.values[range.clone()], &y.values[range.clone()]);
                let (a, b, c) = (constant.value(), by_x.value(), by_y.value());
                for ((out, x), y) in self.values[range.clone()].iter_mut().zip(x_values).zip(y_values) {
                    *out = a + b * x + c * y;
                }
                for direction in 0..D::DIRECTIONS {
                    let column = direction * count + range.start..direction * count + range.end;
                    let (x_partials, y_partials) = (&x.partials[column.clone()], &y.partials[column.clone()]);
                    let [a1, b1, c1] = [constant, by_x, by_y].map(|number| number.partial(direction));
                    let of_x = x_values.iter().zip(x_partials);
                    let of_y = y_values.iter().zip(y_partials);
                    for ((out, (x, x1)), (y, y1)) in self.partials[column].iter_mut().zip(of_x).zip(of_y) {
                        *out = a1 + (b1 * x + b * x1) + (c1 * y + c * y1);
                    }
                }
            },
        );
    }

    /// Writes one number at every index of `range`.
    pub(crate) fn fill(&mut self, range: std::ops::Range<usize>, number: D) {
        self.values[range.clone()].fill(number.value());
        for direction in 0..D::DIRECTIONS {
            self.partial_mut(direction)[range.clone()].fill(number.partial(direction));
        }
    }

    /// The values, one per sample; empty if this quantity was not asked for.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The partial derivatives in `direction`, one per sample; `None` if the number type does not carry it or the
    /// quantity was not asked for.
    pub fn partial(&self, direction: usize) -> Option<&[f64]> {
        let count = self.values.len();
        if count == 0 { None } else { self.partials.get(direction * count..(direction + 1) * count) }
    }
}
