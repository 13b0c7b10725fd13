//! Suggestion: the terms of damping and spring that a backbone shows.

use std::f64::consts::{PI, TAU};
use std::fmt;

use fmm_model::{Damping, Estimated, ModelError};

use crate::decay::backbone::BackbonePoint;
use crate::decay::spring::{SIGNIFICANT, scored, stiffening};

/// Kind of friction or damping by the way in which it takes energy from a vibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DampingTermKind {
    /// F/m, dry friction (m/s², in the units of the record): c_eq/m = 4 F/m/(π ω A).
    Coulomb,
    /// c/m, viscous damping (1/s).
    Linear,
    /// c₂/m, of the square of the velocity (1/m): c_eq/m = 8 c₂/m ω A/(3 π).
    Quadratic,
    /// c₃/m, of its cube (s/m²): c_eq/m = ¾ c₃/m (ω A)².
    Cubic,
}

impl DampingTermKind {
    const ALL: [Self; 4] = [Self::Coulomb, Self::Linear, Self::Quadratic, Self::Cubic];

    /// c_eq/m (1/s) of a term of 1, of a vibration of this velocity amplitude ωA.
    pub fn equivalent_damping(self, velocity: f64) -> f64 {
        let of = |damping: Result<Damping, ModelError>| damping.map(|damping| damping.cycle_equivalent(velocity));
        match self {
            // The first harmonic of the square wave F sgn v, 4F/π, by the amplitude of the velocity.
            Self::Coulomb => 4.0 / (PI * velocity),
            Self::Linear => 1.0,
            // A coefficient of 1 is not refused.
            Self::Quadratic => of(Damping::new(0.0, 1.0)).unwrap_or(f64::NAN),
            Self::Cubic => of(Damping::none().with_cubic(1.0)).unwrap_or(f64::NAN),
        }
    }
}

/// A term of the damping with its share of the energy that the decay has lost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampingTerm {
    /// Kind of the term.
    pub kind: DampingTermKind,
    /// Its coefficient per mass, in the unit that `kind` states.
    pub coefficient: Estimated,
    /// Share of the energy lost between the first point and the last that the term has taken (1).
    pub share: Estimated,
}

/// Terms of damping and spring that explain a backbone: a start for a comparison of laws, which judges by the record
/// itself.
///
/// It is the sum of Coulomb friction and linear, quadratic and cubic damping with the least Bayesian criterion, among
/// those whose coefficients exceed twice their uncertainty. `Display` prints it in words.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Suggestion {
    /// The terms of damping; empty if none explains the points.
    pub damping: Vec<DampingTerm>,
    /// f₀ (Hz), k₃ and k₅, without those that the frequencies do not show.
    pub spring: Vec<Estimated>,
}

/// Relative error of the closed forms for the damping (1).
const ACCURACY: f64 = 1e-3;

impl Suggestion {
    /// The terms that explain `points`, beside those of the `spring`.
    pub(crate) fn of(points: &[BackbonePoint], spring: &[Estimated]) -> Self {
        let velocities: Vec<f64> =
            points.iter().map(|point| TAU * point.frequency.value * point.amplitude.value).collect();
        let mut best: Option<(f64, Vec<(DampingTermKind, Estimated)>)> = None;
        for subset in 1_u32..1 << DampingTermKind::ALL.len() {
            let kinds: Vec<DampingTermKind> =
                (0..4).filter(|bit| subset >> bit & 1 == 1).map(|bit| DampingTermKind::ALL[bit as usize]).collect();
            let columns: Vec<Vec<f64>> =
                kinds.iter().map(|kind| velocities.iter().map(|v| kind.equivalent_damping(*v)).collect()).collect();
            let dampings: Vec<Estimated> = points.iter().map(|point| point.damping).collect();
            let Some((score, found)) = scored(&columns, &dampings, ACCURACY) else { continue };
            let is_significant = |term: &Estimated| term.value > SIGNIFICANT * term.uncertainty;
            if found.iter().all(is_significant) && best.as_ref().is_none_or(|(least, _)| score < *least) {
                best = Some((score, kinds.into_iter().zip(found).collect()));
            }
        }
        let terms = best.map_or_else(Vec::new, |(_, terms)| terms);
        // Power c (ωA)² between neighbouring points.
        let lost = |kind: DampingTermKind| -> f64 {
            let power = |i: usize| kind.equivalent_damping(velocities[i]) * velocities[i].powi(2);
            points
                .windows(2)
                .enumerate()
                .map(|(i, pair)| 0.5 * (pair[1].time - pair[0].time) * (power(i) + power(i + 1)))
                .sum()
        };
        let all: f64 = terms.iter().map(|(kind, term)| lost(*kind) * term.value).sum();
        let term = |(kind, coefficient): &(DampingTermKind, Estimated)| {
            let share = if all > 0.0 { coefficient.scaled(lost(*kind) / all) } else { Estimated::new(1.0, 0.0) };
            DampingTerm { kind: *kind, coefficient: *coefficient, share }
        };
        Self { damping: terms.iter().map(term).collect(), spring: spring.to_vec() }
    }

    /// c_eq/m (1/s) of all terms together, of a vibration of this velocity amplitude ωA.
    pub fn damping_at(&self, velocity: f64) -> f64 {
        self.damping.iter().map(|term| term.coefficient.value * term.kind.equivalent_damping(velocity)).sum()
    }

    /// f (Hz) at an `amplitude` of the displacement; `None` if the points show no frequency.
    pub fn frequency_at(&self, amplitude: f64) -> Option<f64> {
        self.spring.first().map(|natural| natural.value * stiffening(&self.spring, amplitude).max(0.0).sqrt())
    }

    /// The name under which `fmm-identify` has this law with these terms, such as
    /// `coulomb_viscous + quadratic + cubic spring`.
    pub fn model(&self) -> String {
        let has = |kind: DampingTermKind| self.damping.iter().any(|term| term.kind == kind);
        let law = match (has(DampingTermKind::Coulomb), has(DampingTermKind::Linear)) {
            (true, true) => "coulomb_viscous",
            (true, false) => "coulomb",
            (false, _) => "viscous",
        };
        let further = [
            (has(DampingTermKind::Quadratic), "quadratic"),
            (has(DampingTermKind::Cubic), "cubic"),
            (self.spring.len() > 1, "cubic spring"),
            (self.spring.len() > 2, "quintic spring"),
        ];
        let further = further.into_iter().filter(|(has, _)| *has).map(|(_, name)| format!(" + {name}"));
        std::iter::once(law.to_owned()).chain(further).collect()
    }
}

impl fmt::Display for Suggestion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.model())?;
        for (index, term) in self.damping.iter().enumerate() {
            let name = match term.kind {
                DampingTermKind::Coulomb => "dry friction",
                DampingTermKind::Linear => "viscous damping",
                DampingTermKind::Quadratic => "quadratic damping",
                DampingTermKind::Cubic => "cubic damping",
            };
            let percent = term.share.scaled(100.0);
            write!(f, "{} {name} takes {percent} % of the energy", if index == 0 { ":" } else { "," })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_of_dry_friction_dissipates_as_much() {
        let (friction, amplitude, omega) = (0.7, 0.02, 13.0);
        let damping = friction * DampingTermKind::Coulomb.equivalent_damping(amplitude * omega);
        // 4 F X against π c ω X².
        let (dry, viscous) = (4.0 * friction * amplitude, PI * damping * omega * amplitude * amplitude);
        assert!((dry / viscous - 1.0).abs() < 1e-15, "{dry} J, {viscous} J");
    }
}
