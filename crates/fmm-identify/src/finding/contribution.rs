//! Contribution to the uncertainty of a finding.

use std::fmt;

/// Source of a part of an uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Source {
    /// Residuals of the fit: noise, and misfits of the law.
    Residuals,
    /// The mass that was given.
    Mass,
    /// The stiffness that was given.
    Stiffness,
    /// The machine's own damping that was given.
    Damping,
    /// The normal load that was given.
    NormalLoad,
    /// The gain of the instrument that recorded the motion.
    Gain,
    /// The gain of the instrument that measured the force.
    ForceGain,
    /// The time at which a pulse acts.
    Timing,
    /// The steadiness of the friction that was declared.
    Steadiness,
    /// Laws that the records do not exclude, and that would give another value.
    OtherLaws,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Residuals => "residuals of the fit",
            Self::Mass => "mass",
            Self::Stiffness => "stiffness",
            Self::Damping => "damping of the machine",
            Self::NormalLoad => "normal load",
            Self::Gain => "gain of the record",
            Self::ForceGain => "gain of the force",
            Self::Timing => "time of the pulse",
            Self::Steadiness => "steadiness of the friction",
            Self::OtherLaws => "laws that are not excluded",
        })
    }
}

/// A part of the uncertainty of a [`Finding`](crate::Finding): an entry of its budget.
///
/// ```text
/// u² = Σ uᵢ²,     ν = u⁴ / Σ (uᵢ⁴/νᵢ)
/// ```
///
/// The parts are independent of each other: first order for what was given, JCGM 100:2008, 5.1.2 and G.4.1.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Contribution {
    /// Its source.
    pub source: Source,
    /// uᵢ, what it alone makes of the uncertainty, in the unit of the finding.
    pub uncertainty: f64,
    /// uᵢ²/u², its share of the variance (1).
    pub share: f64,
    /// νᵢ, the degrees of freedom with which it is known (1); infinite for what was given.
    pub degrees_of_freedom: f64,
}
