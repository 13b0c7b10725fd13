//! Inputs of a plan: known values of machine, loads and sensors, with errors that tests have in common.

use crate::design::planned_test::{Load, Motion};
use crate::design::{PlannedSensor, PlannedTest};
use crate::machine::Scale;
use crate::machine::{Known, Machine};

/// A known value with an error, and the tests that share the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Input {
    /// Mass or stiffness of the machine: all tests.
    Scale,
    /// The machine's own damping: all tests.
    Damping,
    /// The normal load of the machine, of which loads of tests are multiples: all tests.
    NormalLoad,
    /// The channel of the force that sets the scale of a machine of unknown mass: all tests.
    ForceChannel,
    /// The setup of a load: tests under equal loads.
    Load(Known),
    /// A mass or a spring that is added: tests with equal ones.
    AddedMass(Known),
    AddedStiffness(Known),
    /// The gain of a sensor (1): tests by equal sensors.
    Gain(PlannedSensor),
}

/// The uncertain inputs of a plan, each with its standard uncertainty. Beside the shared parameters they are
/// parameters: their errors in standard uncertainties, known to ± 1.
#[derive(Debug, Clone)]
pub(crate) struct Inputs(Vec<(Input, f64)>);

impl Inputs {
    pub(crate) fn of(machine: &Machine, tests: &[PlannedTest]) -> Self {
        let mut inputs = Self(Vec::new());
        if let Scale::Mass(scale) | Scale::Stiffness(scale) = machine.scale() {
            inputs.add(Input::Scale, scale.uncertainty());
        }
        inputs.add(Input::Damping, machine.damping().map_or(0.0, |known| known.uncertainty()));
        inputs.add(Input::NormalLoad, machine.normal_load().map_or(0.0, |known| known.uncertainty()));
        for test in tests {
            if let (Motion::Pushed(_, uncertainty), Scale::Unknown) = (&test.motion, machine.scale()) {
                inputs.add(Input::ForceChannel, *uncertainty);
            }
            if let Load::Other(load) = test.load {
                inputs.add(Input::Load(load), load.uncertainty());
            }
            if let Some(mass) = test.added_mass {
                inputs.add(Input::AddedMass(mass), mass.uncertainty());
            }
            if let Some(stiffness) = test.added_stiffness {
                inputs.add(Input::AddedStiffness(stiffness), stiffness.uncertainty());
            }
            inputs.add(Input::Gain(test.sensor), test.sensor.gain_uncertainty());
        }
        inputs
    }

    fn add(&mut self, input: Input, uncertainty: f64) {
        if uncertainty > 0.0 && self.find(input).is_none() {
            self.0.push((input, uncertainty));
        }
    }

    /// Number of inputs.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Place and standard uncertainty of an input; `None` if it is exact.
    pub(crate) fn find(&self, input: Input) -> Option<(usize, f64)> {
        let place = self.0.iter().position(|(other, _)| *other == input)?;
        Some((place, self.0[place].1))
    }
}
