//! Start values of a fit of blows.

use std::f64::consts::{PI, TAU};

use fmm_frf::{SingleDegreeOfFreedom, friction_force_of_coulomb_impact, friction_force_of_viscous_coulomb_impact};
use fmm_friction::LawParameter;

use crate::impact::ImpactProblem;
use crate::impact::parameters::{DAMPING, LAW};
use crate::law::dimension::{Scales, is_force};

/// Damping ratio with which an unknown damping begins, and share of the friction that a viscous part begins with.
const DAMPING_RATIO: f64 = 1e-3;
const VISCOUS_SHARE: f64 = 0.1;

impl ImpactProblem<'_> {
    /// Height (m/N) of the peak of the measured receptance of `trial` in the band; `None` for a trial that is not
    /// there.
    ///
    /// Of a record that ends before the motion it is too low.
    pub fn peak_receptance(&self, trial: usize) -> Option<f64> {
        let of_trial = self.trials().get(trial)?;
        let lines = self.lines(trial);
        let force = lines.transform_short(of_trial.begin(), of_trial.force());
        let size = |pair: &[f64]| pair[0].hypot(pair[1]);
        let mobilities = self.spectrum(trial).chunks_exact(2).zip(force.chunks_exact(2));
        let receptances = mobilities.zip(lines.frequencies()).map(|((v, f), at)| size(v) / (size(f) * TAU * at));
        receptances.filter(|receptance| receptance.is_finite()).reduce(f64::max)
    }

    /// Friction force (N) that the closed form of [`friction_force_of_viscous_coulomb_impact`] makes of the receptance
    /// peak of `trial`; `None` for a trial that is not there, or whose peak is higher than the damping alone allows.
    ///
    /// It takes friction as independent of velocity, and the record as long enough for the motion to end. With that it
    /// is good to 0.5 % and some more between lines that miss the peak.
    pub fn closed_form(&self, trial: usize) -> Option<f64> {
        let impulse = self.trials().get(trial)?.summary().impulse.value.abs();
        let peak = self.peak_receptance(trial)?;
        let (mass, damping, stiffness) = {
            let machine = self.machine();
            (machine.mass().value(), machine.damping().value(), machine.stiffness().value())
        };
        let machine = SingleDegreeOfFreedom::new(mass, damping, stiffness).ok()?;
        let omega = machine.natural_angular_frequency();
        match damping {
            0.0 => friction_force_of_coulomb_impact(impulse, mass, omega, peak).ok(),
            _ => friction_force_of_viscous_coulomb_impact(impulse, &machine, peak).ok(),
        }
    }

    /// Coefficient of dry friction that the trials show without a fit: from the receptance peaks or, where they do not
    /// tell, from how long the motion lasts, T = π J/2F.
    pub(crate) fn coefficient_without_fit(&self) -> f64 {
        let force = |trial: usize| {
            let of_trial = &self.trials()[trial];
            let lasting = of_trial.interval() * of_trial.motion().len() as f64;
            self.closed_form(trial).unwrap_or(0.5 * PI * of_trial.summary().impulse.value.abs() / lasting)
        };
        let count = self.trials().len();
        (0..count).map(force).sum::<f64>() / count as f64 / self.machine().normal_load().value()
    }

    /// Start values around dry friction of this `coefficient`, in as many ways as the law offers.
    pub(crate) fn starts(&self, coefficient: f64) -> Vec<Vec<f64>> {
        let machine = self.machine();
        let angular = TAU * machine.natural_frequency_hz();
        let speed = self.trials().iter().map(|trial| trial.summary().speed).fold(0.0, f64::max);
        let has_level = self.law().fitted().any(|parameter| is_force(parameter.role()));
        let has_slope = self.law().has_slope();
        // A damper and Coulomb friction lose the same in a swing if F = π/4 c V, and V falls from the largest to zero.
        let as_damping = coefficient * 4.0 / PI / (0.5 * speed);
        let shares: &[f64] = match (has_level, has_slope) {
            (true, true) => &[VISCOUS_SHARE, 0.5],
            (true, false) => &[0.0],
            (false, _) => &[1.0],
        };
        let sharpnesses: &[f64] =
            if self.law().fitted().any(|parameter| self.law().bends(parameter)) { &[1.0, 8.0, 0.125] } else { &[1.0] };
        let layout = self.layout();
        let mut starts = Vec::new();
        for (share, sharpness) in shares.iter().flat_map(|share| sharpnesses.iter().map(move |s| (*share, *s))) {
            let scales = Scales {
                length: speed / angular,
                speed,
                friction: coefficient * (1.0 - share),
                damping: as_damping * share,
                sharpness,
            };
            let mut start = layout.values.clone();
            if !layout.is_held(DAMPING) && start[DAMPING] == 0.0 {
                start[DAMPING] = 2.0 * DAMPING_RATIO * machine.mass().value() * angular;
            }
            let typical = |parameter: &LawParameter| scales.typical(self.law(), parameter);
            for (index, parameter) in (LAW..).zip(self.law().fitted()) {
                start[index] = typical(parameter);
            }
            let clamped = start.iter().zip(&layout.all).map(|(value, parameter)| parameter.bounds().clamp(*value));
            starts.push(clamped.collect());
        }
        starts
    }
}
