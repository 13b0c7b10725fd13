//! The parameters of a fit of blows: their order, what is held, and what they say.

use std::borrow::Cow;

use fmm_friction::Role;
use fmm_model::{Bounds, Parameter};

use crate::impact::{ImpactMachine, ImpactOptions};
use crate::law::Law;
use crate::{IdentifyError, Known};

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
const FORCE_GAIN: Parameter = Parameter::new("force_gain", "g_f", "1").bounded(Bounds::POSITIVE);
const OFFSET: Parameter = Parameter::new("offset", "b", "m/s");

/// All parameters: machine, gain of the response, law, then for each trial gain of the force and offset.
#[derive(Debug, Clone)]
pub(crate) struct Parameters {
    pub(crate) all: Vec<Parameter>,
    /// Values of those that are held, and starts of those that are not and are not of the law.
    pub(crate) values: Vec<f64>,
    /// Standard uncertainties of what is held.
    pub(crate) uncertainties: Vec<f64>,
    /// How many all trials share.
    pub(crate) shared: usize,
}

impl Parameters {
    pub(crate) fn of(
        law: &Law,
        machine: &ImpactMachine,
        trials: usize,
        options: &ImpactOptions,
    ) -> Result<Self, IdentifyError> {
        let known = [machine.mass(), machine.stiffness(), machine.damping(), machine.normal_load()];
        let mut values: Vec<f64> = known.iter().map(Known::value).chain([1.0]).collect();
        let gain = options.response_gain_uncertainty;
        let mut uncertainties: Vec<f64> = known.iter().map(Known::uncertainty).chain([gain]).collect();
        let mut all = SHARED.to_vec();
        for law_parameter in law.fitted() {
            let parameter = law_parameter.parameter();
            let name = match law_parameter.role() {
                Role::LevelAbove => parameter.name().replace("coefficient", "excess_coefficient"),
                // Some laws have a stiffness too.
                _ if SHARED.iter().any(|shared| shared.name() == parameter.name()) => {
                    format!("contact_{}", parameter.name())
                }
                _ => parameter.name().to_owned(),
            };
            let (symbol, unit) = (parameter.symbol().to_owned(), parameter.unit().to_owned());
            all.push(Parameter::named(name, symbol, unit).bounded(parameter.bounds()));
            values.push(0.0);
            uncertainties.push(0.0);
        }
        let shared = all.len();
        for trial in 0..trials {
            for parameter in [FORCE_GAIN, OFFSET] {
                let name: Cow<'static, str> = match trials {
                    1 => parameter.name().to_owned().into(),
                    _ => format!("{}_{}", parameter.name(), trial + 1).into(),
                };
                let (symbol, unit) = (parameter.symbol().to_owned(), parameter.unit().to_owned());
                all.push(Parameter::named(name, symbol, unit).bounded(parameter.bounds()));
            }
            values.extend([1.0, 0.0]);
            uncertainties.extend([0.0, 0.0]);
        }
        let mut parameters = Self { all, values, uncertainties, shared };
        parameters.hold(law, options)?;
        Ok(parameters)
    }

    /// Narrows the bounds of what is held.
    fn hold(&mut self, law: &Law, options: &ImpactOptions) -> Result<(), IdentifyError> {
        let mut is_held: Vec<bool> = (0..self.all.len()).map(|index| !(LAW..self.shared).contains(&index)).collect();
        for name in &options.free {
            let indices = self.named(name)?;
            if indices == [DAMPING] && law.has_slope() {
                return Err(IdentifyError::TwoDampings { law: law.name });
            }
            for index in indices {
                is_held[index] = false;
            }
        }
        for (name, value) in &options.held {
            for index in self.named(name)? {
                (is_held[index], self.values[index]) = (true, *value);
            }
        }
        for ((parameter, value), _) in self.all.iter_mut().zip(&self.values).zip(is_held).filter(|(_, held)| *held) {
            let bounds = parameter.bounds();
            if !bounds.contains(*value) {
                let (name, lower, upper) = (parameter.name().to_owned(), bounds.lower(), bounds.upper());
                return Err(IdentifyError::HeldOutOfBounds { name, value: *value, lower, upper });
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
            let known = shared.chain([FORCE_GAIN.name(), OFFSET.name()]).collect::<Vec<_>>().join(", ");
            return Err(IdentifyError::UnknownParameter { name: name.to_owned(), known });
        }
        Ok(indices)
    }

    /// Index of the gain of the force of `trial`; its offset follows.
    pub(crate) fn gain(&self, trial: usize) -> usize {
        self.shared + 2 * trial
    }

    pub(crate) fn is_held(&self, index: usize) -> bool {
        self.all[index].bounds().is_fixed()
    }

    /// Indices of the parameters on which `trial` depends.
    pub(crate) fn of_trial(&self, trial: usize) -> Vec<usize> {
        (0..self.shared).chain([self.gain(trial), self.gain(trial) + 1]).collect()
    }
}

fn is_number(text: &str) -> bool {
    text.parse::<usize>().is_ok()
}
