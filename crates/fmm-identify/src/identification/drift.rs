//! Slow drift of an instrument, as the residuals of a fit show it.

use std::f64::consts::TAU;

use fmm_fit::FTest;

use crate::experiment::Experiment;
use crate::experiment::nuisance::{DRIFT, Nuisance};
use crate::finding::Finding;
use crate::identification::Identification;
use crate::problem::Problem;
use crate::problem::tangent::Tangent;
use crate::residuals::rules::{BETWEEN_HARMONICS, CHANCE_OF_DRIFT, NEAR_NOISE};

/// The experiments with a slow polynomial beside the motion of each whose residuals, those of `found`, hold more of the
/// polynomial than of vibrations just above the motion; `None` if no record shows a drift.
///
/// ```text
/// F = Σ (qᵀr)²/3 : Σ (cᵀr)²/12,     q polynomials of degree 1 to 3, c cosines and sines at 1.5, 2.5 … 6.5 f₀
/// ```
///
/// q and c are of unit length, without the part that the parameters of the fit can follow. Noise that is white, or
/// correlated over a few samples, has as much of either. Frequencies above half the sampling rate are left out.
pub(crate) fn with_drift(
    found: &Identification,
    problem: &Problem<'_>,
    decays: &[Experiment],
) -> Option<Vec<Experiment>> {
    if !found.structure.is_noisy() {
        return None;
    }
    let tangent = Tangent::of(problem, &found.fitted.fit)?;
    let mut any = false;
    let mut drifting = Vec::with_capacity(decays.len());
    for (decay, rows) in decays.iter().zip(problem.row_ranges()) {
        let (start, end) = (decay.record().start(), decay.record().end());
        let times: Vec<f64> = decay.kept().iter().cloned().flatten().map(|index| decay.record().time(index)).collect();
        let energy = |shape: &dyn Fn(f64) -> f64| -> Option<f64> {
            let mut direction = vec![0.0; found.fit().residuals().len()];
            direction[rows.clone()].iter_mut().zip(&times).for_each(|(d, time)| *d = shape(*time));
            tangent.span.take_out(&mut direction);
            let square: f64 = direction.iter().map(|d| d * d).sum();
            let product: f64 = direction.iter().zip(found.fit().residuals()).map(|(d, r)| d * r).sum();
            (square > 0.0).then(|| product * product / square)
        };
        let slow: f64 = DRIFT.iter().filter_map(|nuisance| energy(&|time| nuisance.at(time, start, end))).sum();
        let frequency = decay.guess.frequency();
        let is_sampled = |factor: &&f64| **factor * frequency < 0.5 * decay.record().rate();
        let controls: Vec<&f64> = BETWEEN_HARMONICS.iter().filter(is_sampled).collect();
        let above: f64 = controls
            .iter()
            .flat_map(|factor| {
                let phase = move |time: f64| TAU * **factor * frequency * (time - start);
                [energy(&|time| phase(time).cos()), energy(&|time| phase(time).sin())]
            })
            .flatten()
            .sum();
        let (degrees, controls) = (DRIFT.len() as f64, 2.0 * controls.len() as f64);
        let ratio = (slow / degrees) / (above / controls);
        // What is left must be near the noise, or it is a law that misses something.
        let left = (found.fit().sum_of_squares() - slow).max(0.0) / found.fit().residuals().len() as f64;
        let drifts = above > 0.0
            && left.sqrt() < NEAR_NOISE * found.structure.noise
            && FTest::tail(ratio, degrees, controls).is_some_and(|p| p < CHANCE_OF_DRIFT);
        any |= drifts;
        drifting.push(if drifts { decay.clone().beside(DRIFT.to_vec()) } else { decay.clone() });
    }
    any.then_some(drifting)
}

/// The `decays` with the disturbances that `found` was fitted with, which may be more than they carry.
pub(crate) fn as_fitted(decays: &[Experiment], disturbances: &[Vec<Nuisance>]) -> Vec<Experiment> {
    let further = |(decay, all): (&Experiment, &Vec<Nuisance>)| {
        let missing = all.iter().skip(decay.nuisances.len()).copied().collect();
        decay.clone().beside(missing)
    };
    decays.iter().zip(disturbances).map(further).collect()
}

/// True for a fit beside a drift of which the intervals contain zero: what looked like one beside a simple law is
/// friction that changes with speed.
pub(crate) fn drifts_in_vain(found: &Identification) -> bool {
    let is_seen = |finding: &Finding| finding.interval(0.95).is_none_or(|(low, high)| low > 0.0 || high < 0.0);
    let is_drift = |finding: &&Finding| finding.parameter().name().starts_with("drift");
    let mut drifts = found.findings().iter().filter(is_drift).peekable();
    drifts.peek().is_some() && !drifts.any(is_seen)
}

#[cfg(test)]
mod tests {
    use fmm_friction::{LawFamily, Stribeck};
    use fmm_model::{Damping, Oscillator};
    use fmm_record::{Quantity, Record};
    use fmm_sim::{Sampling, Scenario, Trajectory, simulate_into};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::Inquiry;
    use crate::experiment::Preparation;
    use crate::machine::Machine;
    use crate::warning::Warning;

    /// A decay by Stribeck friction, of which Coulomb and viscous friction leave a little more than the noise.
    fn decay(seed: u64) -> Experiment {
        let damping = Damping::linear(0.0716).unwrap();
        let machine = Oscillator::new(1.0, 593.9).unwrap().with_damping(damping);
        let law = Stribeck::at(&[0.1106, 0.1634, 0.02615, 2.0, 0.0]).unwrap();
        let scenario = Scenario::new(machine, law, 1.0).unwrap().starting_at(0.010_086_5, 0.0).unwrap();
        let mut motion = Trajectory::new();
        simulate_into::<Stribeck, _>(&scenario, &Sampling::uniform(1e-3, 2500).unwrap(), None, &mut motion).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        let values = motion.position().values().iter().map(|x| x + 1.04e-5 * draw()).collect();
        let record = Record::new(0.0, 1e-3, values, Quantity::Displacement, "m").unwrap();
        Experiment::ring_down(&record, &Preparation::default()).unwrap()
    }

    #[test]
    fn friction_that_changes_with_speed_is_no_drift() {
        let (decays, machine) = ([decay(1)], Machine::per_unit_mass());
        let inquiry = Inquiry::of(&machine, &decays);
        // Beside coulomb_viscous the record shows a drift, which the preferred law needs no more.
        assert!(drifts_in_vain(inquiry.search_here(&decays, true, None).unwrap().preferred()));
        let found = inquiry.search().unwrap();
        let preferred = found.preferred();
        assert!(preferred.findings().iter().all(|finding| !finding.parameter().name().starts_with("drift")));
        assert!(!found.warnings().iter().any(|warning| matches!(warning, Warning::Drift)));
    }
}
