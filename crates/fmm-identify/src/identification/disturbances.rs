//! Warnings about what is in a record besides the free vibration of one mode in white noise, and about what it leaves
//! open.

use crate::experiment::Experiment;
use crate::identification::Identification;
use crate::warning::Warning;

impl Warning {
    /// Noise of the records, as the residuals of `identification` show it, and a slow drift, if one
    /// was fitted.
    pub(crate) fn of_noise(identification: &Identification, decays: &[Experiment]) -> Vec<Self> {
        let mut warnings = Vec::new();
        let unit = || decays.first().map_or_else(String::new, |decay| decay.record().unit().to_owned());
        if decays.iter().any(Experiment::drifts) {
            warnings.push(Self::Drift);
        }
        let structure = identification.structure();
        if !structure.is_noisy() {
            return warnings;
        }
        if let Some(growth) = identification.noise().growth() {
            let share = growth.instantaneous.hypot(growth.by_amplitude);
            warnings.push(Self::GrowingNoise { floor: growth.floor, share, unit: unit() });
        }
        warnings.extend(structure.coloured_noise(identification.inflation()));
        warnings
    }
}
