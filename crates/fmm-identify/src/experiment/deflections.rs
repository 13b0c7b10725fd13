//! Deflections of a free vibration along the path that it slides.

use fmm_model::Bounds;

/// Squares of the deflections of a free vibration, in the square of the unit of its displacement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Deflections {
    /// Mean over the path slid.
    pub(crate) mean_square: f64,
    /// Largest of them.
    pub(crate) largest_square: f64,
}

impl Deflections {
    /// Those of half swings with these shares of the path (1), each beside its time (s), and the amplitude `largest`:
    ///
    /// ```text
    /// ⟨x²⟩ = Σ Aᵢ³/3 / Σ Aᵢ
    /// ```
    pub(super) fn of(shares: &[(f64, f64)], largest: f64) -> Self {
        let most = shares.iter().map(|(_, share)| *share).fold(f64::MIN_POSITIVE, f64::max);
        let mean = |(_, share): &(f64, f64)| share * (share / most * largest).powi(2) / 3.0;
        Self { mean_square: shares.iter().map(mean).sum(), largest_square: largest * largest }
    }

    /// Curvatures of the friction, over its mean along the path, by which it is positive at all deflections.
    pub(crate) fn curvatures(self) -> Bounds {
        /// Share of the curvature by which friction vanishes somewhere (1). Origin: chosen, short of a kink.
        const MOST: f64 = 0.95;
        let Self { mean_square, largest_square } = self;
        Bounds::UNBOUNDED.at_least(-MOST / (largest_square - mean_square)).at_most(MOST / mean_square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫x² dx over ∫dx of half swings of 3 and 1; with β = 1/⟨x²⟩ there is no friction in the middle.
    #[test]
    fn the_mean_is_that_along_the_path() {
        let deflections = Deflections::of(&[(0.0, 0.75), (1.0, 0.25)], 3.0);
        assert!((deflections.mean_square - (27.0 + 1.0) / 3.0 / 4.0).abs() < 1e-14, "{deflections:?}");
        let bounds = deflections.curvatures();
        assert!((bounds.upper() * deflections.mean_square - 0.95).abs() < 1e-14);
        assert!((bounds.lower() * (9.0 - deflections.mean_square) + 0.95).abs() < 1e-14);
    }
}
