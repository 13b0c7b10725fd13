//! Choices for a modal fit.

/// Choices for a [`ModalFit`](super::ModalFit); the default takes all lines, and an order that they allow.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModalOptions {
    pub(super) band: Option<(f64, f64)>,
    pub(super) order: Option<usize>,
    pub(super) near: Option<Vec<f64>>,
}

impl ModalOptions {
    /// Highest order that is tried when none is asked for. Origin: chosen; that of the usual programs is 50 to 100 real
    /// coefficients, of which a complex one is two.
    pub const DEFAULT_ORDER: usize = 40;

    /// Lines from `low` to `high` (Hz) only.
    #[must_use]
    pub fn within(mut self, low: f64, high: f64) -> Self {
        self.band = Some((low, high));
        self
    }

    /// Orders from 1 to `order`: how many poles the largest model has in the band, of each reference.
    #[must_use]
    pub fn up_to_order(mut self, order: usize) -> Self {
        self.order = Some(order);
        self
    }

    /// One mode for each of these frequencies (Hz), the stable pole next to it, in place of all that are stable.
    #[must_use]
    pub fn nearest_to(mut self, frequencies: impl Into<Vec<f64>>) -> Self {
        self.near = Some(frequencies.into());
        self
    }
}
