//! Suggestion: the terms of damping and spring that a backbone shows.

use std::f64::consts::{PI, TAU};
use std::fmt;

use fmm_model::{Damping, Estimated, ModelError};

use crate::decay::point::BackbonePoint;
use crate::decay::spring::{Fitted, scales, stiffening};

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
/// those whose coefficients exceed twice their uncertainty; the `others` have a criterion of up to 6 more. `Display`
/// prints it in words.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Suggestion {
    /// The terms of damping; empty if none explains the points.
    pub damping: Vec<DampingTerm>,
    /// [Names](Self::model) of other sums of terms that the points do not exclude, the likelier first; empty if they
    /// decide.
    pub others: Vec<String>,
    /// True if a term that feeds the motion explains the points better: friction that falls as the speed rises, for
    /// which there is no term.
    pub falls: bool,
    /// f₀ (Hz), k₃ and k₅, without those that the frequencies do not show.
    pub spring: Vec<Estimated>,
}

/// Relative error of the closed forms for the damping (1).
const ACCURACY: f64 = 1e-3;
/// Least value of the coefficient of a term, in its standard uncertainties.
const SIGNIFICANT: f64 = 2.0;
/// Bayesian criterion above the least up to which terms are not excluded: a weight of 1/20.
const NOT_EXCLUDED: f64 = 6.0;
/// Least share of the energy for a term to make another explanation (1).
const LEAST_SHARE: f64 = 0.05;
/// Least and largest power of the amplitude with which c_eq goes (1).
const POWERS: (f64, f64) = (-2.0, 4.0);
/// n and q if there is no fit, by judgement (1).
const UNKNOWN: Estimated = Estimated::new(0.0, 1.0);
/// Uncertainty of n and q of a known sum of terms, by judgement (1).
const OTHER_TERMS: [f64; 2] = [0.1, 0.2];

/// Terms of damping that may explain the points.
pub(super) struct Explanation {
    terms: Vec<(DampingTermKind, Estimated)>,
    /// Bayesian criterion above that of the best (1).
    above: f64,
}

impl Explanation {
    /// All sums of terms, the best first, and the [scale](scales) of their noise; also those with terms that feed the
    /// motion, as falling friction does.
    pub(super) fn all(points: &[BackbonePoint]) -> (Vec<Self>, f64) {
        let dampings: Vec<Estimated> = points.iter().map(|point| point.damping).collect();
        let column = |kind: &DampingTermKind| points.iter().map(|p| kind.equivalent_damping(velocity(p))).collect();
        let fitted = |subset: u32| {
            let kinds = DampingTermKind::ALL.into_iter().filter(|kind| subset >> *kind as u32 & 1 == 1);
            let kinds: Vec<DampingTermKind> = kinds.collect();
            let columns: Vec<Vec<f64>> = kinds.iter().map(column).collect();
            Some((kinds, Fitted::of(&columns, &dampings, ACCURACY)?))
        };
        let fits: Vec<_> = (1_u32..1 << DampingTermKind::ALL.len()).filter_map(fitted).collect();
        let [scale, noise] = scales(&fits.iter().map(|(_, fit)| fit).collect::<Vec<_>>(), points.len());
        let criterion = |fit: &Fitted| fit.criterion(points.len(), scale);
        let least = fits.iter().map(|(_, fit)| criterion(fit)).fold(f64::INFINITY, f64::min);
        let explanation = |(kinds, fit): (Vec<DampingTermKind>, Fitted)| {
            let above = criterion(&fit) - least;
            Self { terms: kinds.into_iter().zip(fit.found).collect(), above }
        };
        let mut all: Vec<Self> = fits.into_iter().map(explanation).collect();
        all.sort_by(|a, b| a.above.total_cmp(&b.above));
        (all, noise)
    }

    /// n = d ln c/d ln A at a point, and q, half of the sum of n² and of the second derivative of c by ln A over c, by
    /// all explanations and their weights.
    pub(super) fn powers(all: &[Self], point: &BackbonePoint) -> [Estimated; 2] {
        let velocity = velocity(point);
        let own = |explanation: &Self| {
            let moment = |order: i32| -> f64 {
                // The terms go with the powers −1 to 2.
                let power = |kind: DampingTermKind| f64::from(kind as u8) - 1.0;
                let part = |kind: DampingTermKind| kind.equivalent_damping(velocity) * power(kind).powi(order);
                explanation.terms.iter().map(|(kind, term)| term.value * part(*kind)).sum()
            };
            let [n, second] = [1, 2].map(|order| (moment(order) / moment(0)).clamp(POWERS.0, POWERS.1));
            ((-0.5 * explanation.above).exp(), [n, 0.5 * (n * n + second)])
        };
        let own: Vec<(f64, [f64; 2])> = all.iter().map(own).collect();
        let total: f64 = own.iter().map(|(weight, _)| weight).sum();
        [0, 1].map(|which| {
            let value = own.iter().map(|(weight, powers)| weight * powers[which]).sum::<f64>() / total;
            let square =
                own.iter().map(|(weight, powers)| weight * (powers[which] - value).powi(2)).sum::<f64>() / total;
            if value.is_finite() { Estimated::new(value, square.sqrt().hypot(OTHER_TERMS[which])) } else { UNKNOWN }
        })
    }
}

/// ωA of the displacement.
fn velocity(point: &BackbonePoint) -> f64 {
    TAU * point.frequency.value * point.amplitude.value
}

impl Suggestion {
    /// The terms that explain `points`, beside those of the `spring`.
    pub(crate) fn of(points: &[BackbonePoint], spring: &[Estimated]) -> Self {
        let (mut explanations, _) = Explanation::all(points);
        explanations.retain(|explanation| explanation.terms.iter().all(|(_, term)| term.value > 0.0));
        let least = explanations.first().map_or(0.0, |best| best.above);
        // Power c (ωA)² between neighbouring points.
        let velocities: Vec<f64> = points.iter().map(velocity).collect();
        let lost = |kind: DampingTermKind| -> f64 {
            let power = |i: usize| kind.equivalent_damping(velocities[i]) * velocities[i].powi(2);
            let mean = |i: usize| 0.5 * (points[i].time - points[i - 1].time) * (power(i - 1) + power(i));
            (1..points.len()).map(mean).sum()
        };
        let shared = |explanation: &Explanation| -> Vec<DampingTerm> {
            let all: f64 = explanation.terms.iter().map(|(kind, term)| lost(*kind) * term.value).sum();
            let share = |(kind, term): &(DampingTermKind, Estimated)| DampingTerm {
                kind: *kind,
                coefficient: *term,
                share: if all > 0.0 { term.scaled(lost(*kind) / all) } else { Estimated::new(1.0, 0.0) },
            };
            explanation.terms.iter().map(share).collect()
        };
        let is_sure = |(_, term): &(DampingTermKind, Estimated)| term.value > SIGNIFICANT * term.uncertainty;
        let sure = explanations.iter().find(|explanation| explanation.terms.iter().all(is_sure));
        let best = sure.or(explanations.first()).map_or_else(Vec::new, shared);
        let named = |terms: Vec<DampingTerm>| model(&terms, spring);
        let others = explanations.iter().take_while(|other| other.above - least < NOT_EXCLUDED).map(shared);
        let others = others.filter(|terms| terms.iter().all(|term| term.share.value > LEAST_SHARE));
        let others = others.map(named).filter(|other| *other != model(&best, spring)).collect();
        Self { damping: best, others, falls: least > NOT_EXCLUDED, spring: spring.to_vec() }
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
        model(&self.damping, &self.spring)
    }
}

/// Name of a law with these terms.
fn model(damping: &[DampingTerm], spring: &[Estimated]) -> String {
    let has = |kind: DampingTermKind| damping.iter().any(|term| term.kind == kind);
    let law = match (has(DampingTermKind::Coulomb), has(DampingTermKind::Linear)) {
        (true, true) => "coulomb_viscous",
        (true, false) => "coulomb",
        (false, _) => "viscous",
    };
    let further = [
        (has(DampingTermKind::Quadratic), "quadratic"),
        (has(DampingTermKind::Cubic), "cubic"),
        (spring.len() > 1, "cubic spring"),
        (spring.len() > 2, "quintic spring"),
    ];
    let further = further.into_iter().filter(|(has, _)| *has).map(|(_, name)| format!(" + {name}"));
    std::iter::once(law.to_owned()).chain(further).collect()
}

impl fmt::Display for Suggestion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.damping.is_empty() {
            return f.write_str("no terms, as the points are too few or no sum of terms explains them");
        }
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
        if self.falls {
            f.write_str("; these terms miss the points, which show friction that falls as the speed rises")?;
        }
        if !self.others.is_empty() {
            write!(f, "; not excluded: {}", self.others.join(", "))?;
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
