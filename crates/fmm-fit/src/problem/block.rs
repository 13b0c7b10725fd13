//! Blocks of residuals with the parameters that they depend on.

use std::ops::Range;

use crate::algebra::sums::{dot, sum_of_squares};
use crate::algebra::triangle::Triangle;
use crate::error::FitError;
use crate::problem::residuals::Residuals;

/// Neighbouring residuals that depend on some of the parameters only, such as those of one record in a joint fit.
///
/// ```text
///        shared  own 1  own 2
/// r ⎡ 1 ⎤  ⎡ ■      ■      ·   ⎤
///   ⎣ 2 ⎦  ⎣ ■      ·      ■   ⎦      only ■ is stored and factored
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Block {
    rows: usize,
    parameters: Vec<usize>,
}

impl Block {
    /// The next `rows` residuals, which depend on the parameters of these indices only. Their order is that of the
    /// block's columns in the Jacobian.
    pub fn new(rows: usize, parameters: impl Into<Vec<usize>>) -> Self {
        Self { rows, parameters: parameters.into() }
    }

    /// Number of residuals of the block.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Indices of the parameters on which they depend, in the order of the columns.
    pub fn parameters(&self) -> &[usize] {
        &self.parameters
    }
}

/// Places of the elements of the Jacobian of a problem.
#[derive(Debug, Clone, Default)]
pub(crate) struct Structure {
    parts: Vec<Part>,
    is_dense: bool,
}

#[derive(Debug, Clone)]
struct Part {
    rows: Range<usize>,
    parameters: Vec<usize>,
    /// Index of its first element in the Jacobian.
    first: usize,
}

/// One column of one block.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub(crate) block: usize,
    /// The residuals of the block.
    pub(crate) rows: Range<usize>,
    /// Places of their derivatives.
    pub(crate) elements: Range<usize>,
}

/// Places of the elements of a row.
#[derive(Debug, Clone)]
pub(crate) struct ByRow {
    count: usize,
    /// The first row after each block.
    ends: Vec<usize>,
    /// For each block and parameter, what to add to a row to find its element.
    shifts: Vec<Option<usize>>,
}

impl ByRow {
    /// ∂rᵢ/∂θⱼ for i = `row`, j = `parameter`.
    pub(crate) fn element(&self, jacobian: &[f64], row: usize, parameter: usize) -> f64 {
        let block = self.ends.partition_point(|&end| end <= row);
        self.shifts[block * self.count + parameter].map_or(0.0, |shift| jacobian[shift.wrapping_add(row)])
    }
}

/// Multiplies every element of the Jacobian of `problem` by the one of `factors` that belongs to its residual.
pub(crate) fn scale_rows<P: Residuals + ?Sized>(problem: &P, jacobian: &mut [f64], factors: &[f64]) {
    let whole = [Block::new(factors.len(), Vec::new())];
    let blocks = if problem.blocks().is_empty() { &whole } else { problem.blocks() };
    let (mut row, mut rest) = (0, jacobian);
    for Block { rows, parameters } in blocks {
        let factors = &factors[row..row + rows];
        row += rows;
        // The one block of all residuals has all columns.
        let count = if blocks.len() == 1 { rest.len() } else { rows * parameters.len() };
        let (own, others) = rest.split_at_mut(count);
        for column in own.chunks_exact_mut((*rows).max(1)) {
            column.iter_mut().zip(factors).for_each(|(derivative, factor)| *derivative *= factor);
        }
        rest = others;
    }
}

/// Buffers that a factorisation needs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    pub(crate) block: Vec<f64>,
    triangle: Triangle,
    columns: Vec<(usize, usize)>,
    locals: Vec<usize>,
    places: Vec<usize>,
}

impl Structure {
    /// The blocks of `problem`, or the one of all its residuals and parameters.
    ///
    /// # Errors
    /// [`FitError::Problem`] and [`FitError::Count`] if the blocks do not fit the problem.
    pub(crate) fn of<P: Residuals + ?Sized>(problem: &P) -> Result<Self, FitError> {
        let (residuals, parameters) = (problem.len(), problem.parameters().len());
        let blocks = problem.blocks();
        if blocks.is_empty() {
            let whole = Part { rows: 0..residuals, parameters: (0..parameters).collect(), first: 0 };
            return Ok(Self { parts: vec![whole], is_dense: true });
        }
        let mut parts = Vec::with_capacity(blocks.len());
        let (mut row, mut first) = (0usize, 0);
        for (block, Block { rows, parameters: own }) in blocks.iter().enumerate() {
            let is_repeated = |(place, index): (usize, &usize)| own[..place].contains(index);
            if let Some((_, &index)) =
                own.iter().enumerate().find(|&(place, index)| *index >= parameters || is_repeated((place, index)))
            {
                return Err(FitError::problem(format!(
                    "block {block} names parameter {index}; it may name each of the {parameters} parameters once"
                )));
            }
            let end = row.saturating_add(*rows);
            parts.push(Part { rows: row..end, parameters: own.clone(), first });
            (row, first) = (end, first + rows.saturating_mul(own.len()));
        }
        if row != residuals {
            return Err(FitError::count(format!(
                "the blocks have {row} residuals together, but the problem has {residuals}"
            )));
        }
        let is_dense = matches!(parts.as_slice(), [part] if part.parameters.iter().copied().eq(0..parameters));
        Ok(Self { parts, is_dense })
    }

    /// Number of stored elements.
    pub(crate) fn len(&self) -> usize {
        self.parts.iter().map(|part| part.rows.len() * part.parameters.len()).sum()
    }

    /// True if every residual may depend on every parameter.
    pub(crate) fn is_dense(&self) -> bool {
        self.is_dense
    }

    /// The columns of one parameter, block by block.
    pub(crate) fn columns_of(&self, parameter: usize) -> impl Iterator<Item = Column> {
        self.parts.iter().enumerate().filter_map(move |(block, part)| {
            let place = part.parameters.iter().position(|&index| index == parameter)?;
            let first = part.first + place * part.rows.len();
            Some(Column { block, rows: part.rows.clone(), elements: first..first + part.rows.len() })
        })
    }

    /// Access by row, for `count` parameters.
    pub(crate) fn by_row(&self, count: usize) -> ByRow {
        let mut ends = Vec::with_capacity(self.parts.len());
        let mut shifts = vec![None; self.parts.len() * count];
        for (block, part) in self.parts.iter().enumerate() {
            ends.push(part.rows.end);
            for (place, &index) in part.parameters.iter().enumerate() {
                // Never negative once the row is added, and wrapping until then.
                let first = part.first + place * part.rows.len();
                shifts[block * count + index] = Some(first.wrapping_sub(part.rows.start));
            }
        }
        ByRow { count, ends, shifts }
    }

    /// Σᵢ aᵢ ∂rᵢ/∂θ for one parameter.
    pub(crate) fn product(&self, jacobian: &[f64], parameter: usize, a: &[f64]) -> f64 {
        self.columns_of(parameter).map(|column| dot(&jacobian[column.elements], &a[column.rows])).sum()
    }

    /// ‖∂r/∂θ‖² for one parameter.
    pub(crate) fn square(&self, jacobian: &[f64], parameter: usize) -> f64 {
        self.columns_of(parameter)
            .map(|column| {
                let elements = &jacobian[column.elements];
                sum_of_squares(elements)
            })
            .sum()
    }

    /// Factors the columns of the parameters `free`, given in ascending order. Each block is reduced to a triangle of
    /// its own before they are merged.
    pub(crate) fn factor(
        &self,
        jacobian: &[f64],
        free: &[usize],
        residuals: &[f64],
        triangle: &mut Triangle,
        scratch: &mut Scratch,
    ) {
        if self.is_dense {
            triangle.factor(jacobian, free, residuals, &mut scratch.block);
            return;
        }
        triangle.reset(free.len());
        for part in &self.parts {
            scratch.columns.clear();
            let placed = |(local, index): (usize, &usize)| Some((free.binary_search(index).ok()?, local));
            scratch.columns.extend(part.parameters.iter().enumerate().filter_map(placed));
            // Columns in the order of the whole keep the small triangle one when it is merged.
            scratch.columns.sort_unstable();
            scratch.places.clear();
            scratch.places.extend(scratch.columns.iter().map(|(place, _)| place));
            scratch.locals.clear();
            scratch.locals.extend(scratch.columns.iter().map(|(_, local)| local));
            let elements = part.first..part.first + part.rows.len() * part.parameters.len();
            let (small, block) = (&mut scratch.triangle, &mut scratch.block);
            small.factor(&jacobian[elements], &scratch.locals, &residuals[part.rows.clone()], block);
            triangle.merge(small, &scratch.places, block);
        }
    }
}

#[cfg(test)]
mod tests {
    use fmm_model::Parameter;

    use super::*;
    use crate::fitting::solve::solve;
    use crate::problem::residuals::EvaluationError;
    use crate::solver::options::Options;

    /// Three parameters, residuals that are their own index.
    struct Blocks([Parameter; 3], Vec<Block>);

    impl Residuals for Blocks {
        fn parameters(&self) -> &[Parameter] {
            &self.0
        }
        fn len(&self) -> usize {
            7
        }
        fn evaluate(&self, _p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
            residuals.iter_mut().enumerate().for_each(|(i, r)| *r = i as f64);
            Ok(())
        }
        fn blocks(&self) -> &[Block] {
            &self.1
        }
    }

    fn problem(blocks: Vec<Block>) -> Blocks {
        Blocks(["a", "b", "c"].map(|name| Parameter::new(name, name, "1")), blocks)
    }

    #[test]
    fn blocks_that_do_not_fit_are_refused() {
        let message = |blocks| solve(&problem(blocks), &[0.0; 3], &Options::default()).unwrap_err().to_string();
        assert_eq!(
            message(vec![Block::new(4, [0, 1]), Block::new(2, [0, 2])]),
            "the blocks have 6 residuals together, but the problem has 7"
        );
        assert_eq!(
            message(vec![Block::new(4, [0, 1]), Block::new(3, [0, 3])]),
            "block 1 names parameter 3; it may name each of the 3 parameters once"
        );
        assert_eq!(
            message(vec![Block::new(4, [1, 0, 1]), Block::new(3, [2])]),
            "block 0 names parameter 1; it may name each of the 3 parameters once"
        );
    }

    #[test]
    fn the_factor_is_that_of_the_matrix_filled_with_zeros() {
        // Columns out of order, a fixed parameter (1), a block with fewer rows than columns.
        let blocks = vec![Block::new(4, [2, 0]), Block::new(1, [1, 2, 0]), Block::new(2, [1, 0])];
        let structure = Structure::of(&problem(blocks.clone())).unwrap();
        let jacobian: Vec<f64> = (0..structure.len()).map(|i| (1.7 * i as f64 + 0.3).sin()).collect();
        assert_eq!(jacobian.len(), 4 * 2 + 3 + 2 * 2);
        let mut filled = vec![0.0; 7 * 3];
        for parameter in 0..3 {
            for column in structure.columns_of(parameter) {
                for (row, element) in column.rows.zip(column.elements) {
                    filled[parameter * 7 + row] = jacobian[element];
                }
            }
        }
        let residuals = [1.0, -2.0, 0.5, 3.0, -1.0, 0.25, 2.0];
        let (mut blockwise, mut whole) = (Triangle::default(), Triangle::default());
        structure.factor(&jacobian, &[0, 2], &residuals, &mut blockwise, &mut Scratch::default());
        whole.factor(&filled, &[0, 2], &residuals, &mut Vec::new());
        for row in 0..2 {
            for column in row..=2 {
                let (a, b) = (blockwise.r(row, column).abs(), whole.r(row, column).abs());
                // A few operations on numbers of order one.
                assert!((a - b).abs() < 1e-14, "R[{row}][{column}]: {a} against {b}");
            }
        }
        let by_row = structure.by_row(3);
        for (index, element) in filled.iter().enumerate() {
            assert_eq!(by_row.element(&jacobian, index % 7, index / 7), *element);
        }
        assert!((structure.product(&jacobian, 2, &residuals) - whole.gradient(1)).abs() < 1e-14);
        assert!((structure.square(&jacobian, 0).sqrt() - whole.column_norm(0)).abs() < 1e-14);
    }
}
