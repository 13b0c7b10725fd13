//! Forwarding of a problem by a wrapper, in one place so that no wrapper forgets a part.

/// Hands on the shape of a problem, for a wrapper that changes values only: `forward_shape!(self => self.problem)`.
macro_rules! forward_shape {
    ($self:ident => $inner:expr) => {
        fn len(&$self) -> usize {
            $inner.len()
        }
        fn is_cheaper_combined(&$self) -> bool {
            $inner.is_cheaper_combined()
        }
        fn blocks(&$self) -> &[$crate::Block] {
            $inner.blocks()
        }
        fn derivatives(&$self) -> $crate::Derivatives {
            $inner.derivatives()
        }
    };
}

/// Hands on the values of a problem and their derivatives.
macro_rules! forward_values {
    ($self:ident => $inner:expr) => {
        fn evaluate(
            &$self,
            p: &[f64],
            residuals: &mut [f64],
            jacobian: Option<&mut [f64]>,
        ) -> Result<(), $crate::EvaluationError> {
            $inner.evaluate(p, residuals, jacobian)
        }
        fn block_residuals(
            &$self,
            block: usize,
            p: &[f64],
            residuals: &mut [f64],
        ) -> Result<bool, $crate::EvaluationError> {
            $inner.block_residuals(block, p, residuals)
        }
    };
}

pub(crate) use {forward_shape, forward_values};
