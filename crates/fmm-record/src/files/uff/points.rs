//! Points as they are read, number by number.

use super::Ordinate;
use super::records::Form;

/// Collects the numbers of points: abscissa if it is uneven, then the ordinate or its two parts.
pub(super) struct Points {
    width: usize,
    uneven: bool,
    numbers: [f64; 3],
    filled: usize,
    abscissae: Vec<f64>,
    ordinate: Ordinate,
}

impl Points {
    pub(super) fn new(form: &Form) -> Self {
        let ordinate = if form.complex { Ordinate::Complex(Vec::new()) } else { Ordinate::Real(Vec::new()) };
        Self {
            width: form.numbers(),
            uneven: form.even.is_none(),
            numbers: [0.0; 3],
            filled: 0,
            abscissae: Vec::new(),
            ordinate,
        }
    }

    pub(super) fn push(&mut self, number: f64) {
        self.numbers[self.filled] = number;
        self.filled += 1;
        if self.filled < self.width {
            return;
        }
        self.filled = 0;
        let first = usize::from(self.uneven);
        if self.uneven {
            self.abscissae.push(self.numbers[0]);
        }
        match &mut self.ordinate {
            Ordinate::Real(values) => values.push(self.numbers[first]),
            Ordinate::Complex(values) => values.push([self.numbers[first], self.numbers[first + 1]]),
        }
    }

    /// Number of complete points.
    pub(super) fn len(&self) -> usize {
        self.ordinate.len()
    }

    /// Number of points with numbers that are not finite.
    pub(super) fn not_finite(&self) -> usize {
        let finite = |index: usize| {
            let ordinate = match &self.ordinate {
                Ordinate::Real(values) => values[index].is_finite(),
                Ordinate::Complex(values) => values[index].iter().all(|part| part.is_finite()),
            };
            ordinate && self.abscissae.get(index).is_none_or(|value| value.is_finite())
        };
        (0..self.len()).filter(|index| !finite(*index)).count()
    }

    /// The abscissae, `None` if they are even, and the ordinates.
    pub(super) fn into_parts(self) -> (Vec<f64>, Ordinate) {
        (self.abscissae, self.ordinate)
    }
}
