//! The parameters of a fit of blows: their order, what is held, and what they say.

use std::borrow::Cow;

use fmm_model::{Bounds, Parameter};

use crate::error::IdentifyError;
use crate::experiment::ImpactTrial;
use crate::impact::{ImpactMachine, ImpactOptions};
use crate::law::Law;
use crate::law::naming::{Level, Units};
use crate::machine::Known;

/// Indices of the parameters before those of the law.
pub(crate) const MASS: usize = 0;
pub(crate) const STIFFNESS: usize = 1;
pub(crate) const DAMPING: usize = 2;
pub(crate) const LOAD: usize = 3;
pub(crate) const RESPONSE_GAIN: usize = 4;
pub(crate) const LAW: usize = 5;

const SHARED: [Parameter; LAW] = [
    Parameter::new("mass", "m", "kg").bounded(Bounds::POSITIVE),
    Parameter::new("stiffness", "k", "N/m").bounded(Bounds::POSITIVE),
    Parameter::new("damping", "c", "N s/m").bounded(Bounds::NOT_NEGATIVE),
    Parameter::new("normal_load", "N", "N").bounded(Bounds::POSITIVE),
    Parameter::new("response_gain", "g_v", "1").bounded(Bounds::POSITIVE),
];
/// How many parameters each trial has of its own, and the order of them.
pub(crate) const PER_TRIAL: usize = 4;
const FORCE_GAIN: usize = 0;
const OFFSET: usize = 1;
const IMPULSE_ERROR: usize = 2;
const PULSE_DELAY: usize = 3;
const OWN: [Parameter; PER_TRIAL] = [
    Parameter::new("force_gain", "g_f", "1").bounded(Bounds::POSITIVE),
    Parameter::new("offset", "b", "m/s"),
    // Beyond that a pulse is not known at all.
    Parameter::new("impulse_error", "ε", "1").bounded(Bounds::UNBOUNDED.at_least(-0.5)),
    Parameter::new("pulse_delay", "δ", "s"),
];

/// All parameters: machine, gain of the response, law, then for each trial gain of the force, offset, error of the
/// impulse and delay of the pulse.
#[derive(Debug, Clone)]
pub(crate) struct Parameters {
    pub(crate) all: Vec<Parameter>,
    /// Values of those that are held, and starts of those that are not and are not of the law.
    pub(crate) values: Vec<f64>,
    /// Standard uncertainties of what is held, or known beforehand.
    pub(crate) uncertainties: Vec<f64>,
    /// Which of them are found from what is known beforehand together with the record.
    pub(crate) has_prior: Vec<bool>,
    /// How many all trials share.
    pub(crate) shared: usize,
}

impl Parameters {
    pub(crate) fn of(
        law: &Law,
        machine: &ImpactMachine,
        trials: &[ImpactTrial],
        options: &ImpactOptions,
    ) -> Result<Self, IdentifyError> {
        law.require_units()?;
        let known = [machine.mass(), machine.stiffness(), machine.damping(), machine.normal_load()];
        let mut values: Vec<f64> = known.iter().map(Known::value).chain([1.0]).collect();
        let gain = options.response_gain_uncertainty;
        let mut uncertainties: Vec<f64> = known.iter().map(Known::uncertainty).chain([gain]).collect();
        let mut all = SHARED.to_vec();
        let units = Units::new("m", "N");
        for law_parameter in law.fitted() {
            all.push(units.fitted(law_parameter, Level::Coefficient));
            values.push(0.0);
            uncertainties.push(0.0);
        }
        let shared = all.len();
        for (number, trial) in (1..).zip(trials) {
            for parameter in OWN {
                let name: Cow<'static, str> = match trials {
                    [_] => parameter.name().to_owned().into(),
                    _ => format!("{}_{number}", parameter.name()).into(),
                };
                let (symbol, unit) = (parameter.symbol().to_owned(), parameter.unit().to_owned());
                all.push(Parameter::named(name, symbol, unit).bounded(parameter.bounds()));
            }
            values.extend([1.0, 0.0, 0.0, 0.0]);
            let summary = trial.summary();
            let impulse = (summary.impulse.uncertainty / summary.impulse.value).abs();
            uncertainties.extend([0.0, summary.velocity_offset.uncertainty, impulse, summary.time_uncertainty]);
        }
        let has_prior = vec![false; all.len()];
        let mut parameters = Self { all, values, uncertainties, has_prior, shared };
        parameters.hold(law, options)?;
        Ok(parameters)
    }

    /// Narrows the bounds of what is held.
    fn hold(&mut self, law: &Law, options: &ImpactOptions) -> Result<(), IdentifyError> {
        let mut is_held: Vec<bool> = (0..self.all.len()).map(|index| !(LAW..self.shared).contains(&index)).collect();
        let mut is_named = vec![false; self.all.len()];
        for name in &options.free {
            let indices = self.named(name)?;
            if indices == [DAMPING] && law.has_slope() {
                return Err(IdentifyError::two_dampings(law.name));
            }
            for index in indices {
                (is_held[index], is_named[index]) = (false, true);
            }
        }
        for (name, value) in &options.held {
            for index in self.named(name)? {
                (is_held[index], is_named[index], self.values[index]) = (true, true, *value);
            }
        }
        for first in (self.shared..self.all.len()).step_by(PER_TRIAL) {
            if !is_held[first + FORCE_GAIN] && !is_named[first + IMPULSE_ERROR] {
                // A free gain holds all that can be said of the impulse.
                (is_named[first + IMPULSE_ERROR], self.uncertainties[first + IMPULSE_ERROR]) = (true, 0.0);
            }
            for index in [first + IMPULSE_ERROR, first + PULSE_DELAY] {
                self.has_prior[index] = !is_named[index] && self.uncertainties[index] > 0.0;
                is_held[index] &= !self.has_prior[index];
            }
        }
        for ((parameter, value), _) in self.all.iter_mut().zip(&self.values).zip(is_held).filter(|(_, held)| *held) {
            let bounds = parameter.bounds();
            if !bounds.contains(*value) {
                let (name, lower, upper) = (parameter.name().to_owned(), bounds.lower(), bounds.upper());
                return Err(IdentifyError::held_out_of_bounds(&name, *value, lower, upper));
            }
            *parameter = parameter.clone().bounded(Bounds::new(*value, *value)?);
        }
        Ok(())
    }

    /// Indices of the parameters of this name; of all trials for what each has, unless it is numbered.
    fn named(&self, name: &str) -> Result<Vec<usize>, IdentifyError> {
        let is_of = |parameter: &Parameter| {
            let own = parameter.name().strip_prefix(name);
            own.is_some_and(|rest| rest.is_empty() || rest.strip_prefix('_').is_some_and(is_number))
        };
        let indices: Vec<usize> = (0..self.all.len()).filter(|&index| is_of(&self.all[index])).collect();
        if indices.is_empty() {
            let shared = self.all[..self.shared].iter().map(Parameter::name);
            let known = shared.chain(OWN.iter().map(Parameter::name)).collect::<Vec<_>>().join(", ");
            return Err(IdentifyError::unknown_parameter(name, &known));
        }
        Ok(indices)
    }

    /// Index of the gain of the force of `trial`.
    pub(crate) fn gain(&self, trial: usize) -> usize {
        self.shared + PER_TRIAL * trial + FORCE_GAIN
    }

    /// Index of what is left of the offset of its velocity.
    pub(crate) fn offset(&self, trial: usize) -> usize {
        self.shared + PER_TRIAL * trial + OFFSET
    }

    /// Index of the relative error of its impulse.
    pub(crate) fn impulse_error(&self, trial: usize) -> usize {
        self.shared + PER_TRIAL * trial + IMPULSE_ERROR
    }

    /// Index of how much later its pulse acts than its samples say.
    pub(crate) fn pulse_delay(&self, trial: usize) -> usize {
        self.shared + PER_TRIAL * trial + PULSE_DELAY
    }

    /// Whether the parameter at `index` is the error of an impulse.
    pub(crate) fn is_impulse_error(&self, index: usize) -> bool {
        index >= self.shared && (index - self.shared) % PER_TRIAL == IMPULSE_ERROR
    }

    pub(crate) fn is_held(&self, index: usize) -> bool {
        self.all[index].bounds().is_fixed()
    }

    /// Indices of the parameters on which `trial` depends: those that are shared, then its own.
    pub(crate) fn of_trial(&self, trial: usize) -> Vec<usize> {
        (0..self.shared).chain(self.gain(trial)..self.gain(trial) + PER_TRIAL).collect()
    }
}

fn is_number(text: &str) -> bool {
    text.parse::<usize>().is_ok()
}
