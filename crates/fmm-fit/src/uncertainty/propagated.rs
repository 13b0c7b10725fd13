//! Covariance of estimates by uncertain inputs, and the reasons why there may be none.


/// Covariance of the estimates of a fit that the uncertainty of its inputs brings about (JCGM 100:2008, 5.2.2, and
/// JCGM 102:2011, 6.2.1).
#[derive(Debug, Clone, PartialEq)]
pub struct PropagatedCovariance {
    count: usize,
    elements: Vec<Option<f64>>,
}

impl PropagatedCovariance {
    pub(crate) fn new(count: usize, element: impl Fn(usize, usize) -> Option<f64>) -> Self {
        let elements = (0..count * count).map(|index| element(index / count, index % count)).collect();
        Self { count, elements }
    }

    /// Covariance of the estimates of parameters `i` and `j`, in the product of their units; `None` if either is fixed
    /// or not determined.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        if i < self.count && j < self.count { self.elements[i * self.count + j] } else { None }
    }

    /// Standard uncertainty of the estimate of parameter `i` from the inputs alone, in its unit.
    pub fn standard_uncertainty(&self, i: usize) -> Option<f64> {
        self.covariance(i, i).map(|variance| variance.max(0.0).sqrt())
    }
}
