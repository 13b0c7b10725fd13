//! A rectangular distribution whose limits are themselves uncertain.

/// The curvilinear trapezoid CTrap(a, b, d): rectangular between limits that are each known to ±d, their mean
/// fixed (JCGM 101:2008, 6.4.3).
///
/// With w the nominal half width, the density at a distance s from the centre is
///
/// ```text
/// g(s) = ln((w + d)/max(|s|, w − d))/(4 d)                         (JCGM 101:2008, Eq. 4)
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CurvilinearTrapezoid {
    centre: f64,
    half_width: f64,
    inexactness: f64,
}

impl CurvilinearTrapezoid {
    /// The caller has seen to a < b and 0 < d ≤ (b − a)/2.
    pub(crate) fn new(lower: f64, upper: f64, inexactness: f64) -> Self {
        Self { centre: 0.5 * lower + 0.5 * upper, half_width: 0.5 * (upper - lower), inexactness }
    }

    pub(crate) fn mean(&self) -> f64 {
        self.centre
    }

    /// The root of (b − a)²/12 + d²/9.
    pub(crate) fn standard_deviation(&self) -> f64 {
        (self.half_width / 3f64.sqrt()).hypot(self.inexactness / 3.0)
    }

    /// d.
    pub(crate) const fn inexactness(&self) -> f64 {
        self.inexactness
    }

    /// The smallest and the largest value.
    pub(crate) fn limits(&self) -> (f64, f64) {
        let reach = self.half_width + self.inexactness;
        (self.centre - reach, self.centre + reach)
    }

    /// The value of two uniform numbers: the half width is drawn first, then the place within it (JCGM 101:2008,
    /// 6.4.3.4).
    #[inline]
    pub(crate) fn of(&self, [first, second]: [f64; 2]) -> f64 {
        let half_width = self.half_width + self.inexactness * (2.0 * first - 1.0);
        self.centre + half_width * (2.0 * second - 1.0)
    }

    /// Linear in the middle; in the tail, with y = s/(w + d), it solves
    ///
    /// ```text
    /// 1 − y + y ln y = 4 d p/(w + d)
    /// ```
    pub(crate) fn quantile(&self, probability: f64) -> f64 {
        let (w, d) = (self.half_width, self.inexactness);
        let tail = probability.min(1.0 - probability);
        let target = 4.0 * d * tail / (w + d);
        let inner = (w - d) / (w + d);
        let distance = if target < shortfall(1.0 - inner) {
            (w + d) * (1.0 - solve_shortfall(target, 1.0 - inner))
        } else {
            (0.5 - tail) * 4.0 * d / ((w + d) / (w - d)).ln()
        };
        if probability < 0.5 { self.centre - distance } else { self.centre + distance }
    }
}

/// e + (1 − e) ln(1 − e), which is e²/2 + e³/6 + … and would lose its digits as a difference where e is small.
fn shortfall(e: f64) -> f64 {
    if e >= 1.0 {
        return 1.0;
    }
    if e > 0.1 {
        return e + (1.0 - e) * (-e).ln_1p();
    }
    (2..=18).rev().fold(0.0, |sum, k| (sum + 1.0 / f64::from(k * (k - 1))) * e) * e
}

/// The e whose shortfall is `target`, at most `largest`. Newton's steps come down from above, since the function
/// is convex and the root of twice the target is never too small.
fn solve_shortfall(target: f64, largest: f64) -> f64 {
    let mut e = (2.0 * target).sqrt().min(largest).min(1.0 - f64::EPSILON);
    for _ in 0..60 {
        let slope = -(-e).ln_1p();
        if slope == 0.0 {
            break;
        }
        let step = (shortfall(e) - target) / slope;
        e -= step;
        if step.abs() <= f64::EPSILON * e {
            break;
        }
    }
    e
}
