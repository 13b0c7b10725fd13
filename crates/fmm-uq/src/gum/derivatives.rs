//! Derivatives of a model: exact ones in Taylor numbers, or differences for models of plain numbers.

use std::cell::RefCell;
use std::error::Error;

use fmm_model::{Rounded, Scalar};

use crate::error::UncertaintyError;
use crate::inputs::{Input, Inputs};
use crate::model::{ModelOutput, Taylor};

/// Derivatives of one output along two directions, each taken over a whole step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Expansion {
    pub(crate) a: f64,
    pub(crate) aa: f64,
    pub(crate) aaa: f64,
    pub(crate) ab: f64,
    pub(crate) aab: f64,
    pub(crate) abb: f64,
}

impl Expansion {
    /// The same with the output in another unit.
    pub(crate) fn in_units_of(self, unit: f64) -> Self {
        let Self { a, aa, aaa, ab, aab, abb } = self;
        Self { a: a / unit, aa: aa / unit, aaa: aaa / unit, ab: ab / unit, aab: aab / unit, abb: abb / unit }
    }
}

/// Values of the outputs, and the sensitivities of each to every input.
pub(crate) struct Slopes {
    pub(crate) values: Vec<f64>,
    pub(crate) sensitivities: Vec<Vec<f64>>,
}

/// A model that can be differentiated at the estimates of its inputs.
pub(crate) trait Derivatives {
    /// First derivatives with respect to every input.
    fn slopes(&self) -> Result<Slopes, UncertaintyError>;
    /// The outputs for any values of the inputs; `None` where the model fails.
    fn outputs_at(&self, x: &[f64]) -> Option<Vec<f64>>;
    /// Derivatives up to the third order along two directions, for every output; along the first alone if there is
    /// no second.
    fn expand(&self, first: &[f64], second: Option<&[f64]>) -> Result<Vec<Expansion>, UncertaintyError>;
}

/// Place at which the model was evaluated: "V = 4.999 V, I = 0.019661 A".
pub(crate) fn place(inputs: &Inputs, at: impl Iterator<Item = f64>) -> String {
    let value = |(input, x): (&Input, f64)| format!("{} = {} {}", input.name(), Rounded::every_digit(x), input.unit());
    inputs.as_slice().iter().zip(at).map(value).collect::<Vec<_>>().join(", ")
}

/// The error of a model that failed at a place.
fn failed(at: &str, source: Box<dyn Error + Send + Sync>) -> UncertaintyError {
    UncertaintyError::Model { what: format!("the model failed at {at}"), source: Some(source) }
}

/// Refuses outputs that are not finite.
fn finite(outputs: impl IntoIterator<Item = f64>, here: impl Fn() -> String) -> Result<(), UncertaintyError> {
    match outputs.into_iter().find(|y| !y.is_finite()) {
        Some(result) => Err(UncertaintyError::model(format!("the model gives {result} at {}", here()))),
        None => Ok(()),
    }
}

/// Refuses outputs that are not those of the `first` evaluation at the same place.
fn repeated(first: &[f64], again: &[f64], here: impl Fn() -> String) -> Result<(), UncertaintyError> {
    if first.len() != again.len() {
        return Err(UncertaintyError::output_count_changed(first.len(), again.len()));
    }
    match first.iter().zip(again).find(|(first, again)| first != again) {
        Some((first, again)) => {
            let here = here();
            let what = format!("the model gives {first}, then {again}, for the same values {here}");
            Err(UncertaintyError::model(what + "; it must be deterministic"))
        }
        None => Ok(()),
    }
}

/// A model that is evaluated in Taylor numbers.
pub(crate) struct Exact<'a, F> {
    inputs: &'a Inputs,
    model: F,
    values: RefCell<Option<Vec<f64>>>,
}

impl<'a, F, R> Exact<'a, F>
where
    F: Fn(&[Taylor]) -> R,
    R: ModelOutput<Taylor>,
{
    pub(crate) fn new(inputs: &'a Inputs, model: F) -> Self {
        Self { inputs, model, values: RefCell::new(None) }
    }

    fn here(&self) -> String {
        place(self.inputs, self.inputs.as_slice().iter().map(Input::value))
    }

    fn evaluate(&self, x: &[Taylor]) -> Result<Vec<Taylor>, UncertaintyError> {
        let mut outputs = Vec::new();
        (self.model)(x).append_to(&mut outputs).map_err(|source| failed(&self.here(), source))?;
        let values: Vec<f64> = outputs.iter().map(|y| y.value()).collect();
        finite(values.iter().copied(), || self.here())?;
        repeated(self.values.borrow_mut().get_or_insert_with(|| values.clone()), &values, || self.here())?;
        Ok(outputs)
    }
}

impl<F, R> Derivatives for Exact<'_, F>
where
    F: Fn(&[Taylor]) -> R,
    R: ModelOutput<Taylor>,
{
    fn slopes(&self) -> Result<Slopes, UncertaintyError> {
        let inputs = self.inputs.as_slice();
        let mut x: Vec<Taylor> = inputs.iter().map(|input| Taylor::from(input.value())).collect();
        let mut slopes = Slopes { values: Vec::new(), sensitivities: Vec::new() };
        // Two inputs at a time: a Taylor number carries two directions.
        for pair in (0..inputs.len()).collect::<Vec<_>>().chunks(2) {
            for (direction, &i) in pair.iter().enumerate() {
                x[i] = Taylor::variable(inputs[i].value(), direction);
            }
            let outputs = self.evaluate(&x)?;
            slopes.sensitivities.resize(outputs.len(), Vec::new());
            for (direction, &i) in pair.iter().enumerate() {
                for (row, y) in slopes.sensitivities.iter_mut().zip(&outputs) {
                    row.push(y.partial(direction));
                }
                x[i] = Taylor::from(inputs[i].value());
            }
            slopes.values = outputs.iter().map(|y| y.value()).collect();
        }
        Ok(slopes)
    }

    fn outputs_at(&self, x: &[f64]) -> Option<Vec<f64>> {
        Taylor::at_values(&self.model)(x).ok()
    }

    fn expand(&self, first: &[f64], second: Option<&[f64]>) -> Result<Vec<Expansion>, UncertaintyError> {
        let step = |i: usize| second.map_or(0.0, |second| second[i]);
        let inputs = self.inputs.as_slice().iter().enumerate();
        let x: Vec<Taylor> = inputs.map(|(i, input)| Taylor::along(input.value(), first[i], step(i))).collect();
        let expansion = |y: &Taylor| Expansion {
            a: y.partial(0),
            aa: 2.0 * y.coefficient(2, 0),
            aaa: 6.0 * y.coefficient(3, 0),
            ab: y.coefficient(1, 1),
            aab: 2.0 * y.coefficient(2, 1),
            abb: 2.0 * y.coefficient(1, 2),
        };
        Ok(self.evaluate(&x)?.iter().map(expansion).collect())
    }
}

/// A model that is evaluated a standard uncertainty away from the estimates, on both sides.
pub(crate) struct Differences<'a, F> {
    inputs: &'a Inputs,
    model: F,
}

impl<'a, F, R> Differences<'a, F>
where
    F: Fn(&[f64]) -> R,
    R: ModelOutput<f64>,
{
    pub(crate) fn new(inputs: &'a Inputs, model: F) -> Self {
        Self { inputs, model }
    }

    /// The outputs at the estimates and the given numbers of steps from them.
    fn at(&self, steps: &[(f64, &[f64])]) -> Result<Vec<f64>, UncertaintyError> {
        let mut x: Vec<f64> = self.inputs.as_slice().iter().map(Input::value).collect();
        for (factor, direction) in steps {
            for (x, step) in x.iter_mut().zip(*direction) {
                *x += factor * step;
            }
        }
        let here = || place(self.inputs, x.iter().copied());
        let mut outputs = Vec::new();
        (self.model)(&x).append_to(&mut outputs).map_err(|source| failed(&here(), source))?;
        finite(outputs.iter().copied(), here)?;
        Ok(outputs)
    }
}

/// The same outputs, if there are as many as the `first` time.
fn as_many(outputs: Vec<f64>, first: usize) -> Result<Vec<f64>, UncertaintyError> {
    let again = outputs.len();
    if again == first { Ok(outputs) } else { Err(UncertaintyError::output_count_changed(first, again)) }
}

impl<F, R> Derivatives for Differences<'_, F>
where
    F: Fn(&[f64]) -> R,
    R: ModelOutput<f64>,
{
    /// ```text
    /// c_i u_i = (f(x + u_i) − f(x − u_i))/2                            (JCGM 100:2008, 5.1.3, note 2)
    /// ```
    fn slopes(&self) -> Result<Slopes, UncertaintyError> {
        let inputs = self.inputs.as_slice();
        let values = self.at(&[])?;
        repeated(&values, &self.at(&[])?, || place(self.inputs, inputs.iter().map(Input::value)))?;
        let mut sensitivities = vec![Vec::with_capacity(inputs.len()); values.len()];
        for (i, input) in inputs.iter().enumerate() {
            let mut direction = vec![0.0; inputs.len()];
            let u = input.standard_uncertainty();
            // A constant has no uncertainty to step by: the cube root of the rounding balances both errors.
            let relative = f64::EPSILON.cbrt();
            let small = if input.value() == 0.0 { relative } else { relative * input.value().abs() };
            direction[i] = if u > 0.0 { u } else { small };
            let above = as_many(self.at(&[(1.0, &direction)])?, values.len())?;
            let below = as_many(self.at(&[(-1.0, &direction)])?, values.len())?;
            // The step that the numbers took, not the one that was meant.
            let step = (input.value() + direction[i]) - (input.value() - direction[i]);
            for ((row, above), below) in sensitivities.iter_mut().zip(above).zip(below) {
                row.push(if step == 0.0 { 0.0 } else { (above - below) / step });
            }
        }
        Ok(Slopes { values, sensitivities })
    }

    fn outputs_at(&self, x: &[f64]) -> Option<Vec<f64>> {
        let mut outputs = Vec::new();
        (self.model)(x).append_to(&mut outputs).ok()?;
        Some(outputs)
    }

    /// With Z(h) = (f(h) − f(−h))/2h for the whole and the half step, exact for models up to the fourth order:
    ///
    /// ```text
    /// f′ = (4 Z(1/2) − Z(1))/3,   f″ = f(1) + f(−1) − 2 f(0),   f‴ = 8 (Z(1) − Z(1/2))
    /// ```
    fn expand(&self, first: &[f64], second: Option<&[f64]>) -> Result<Vec<Expansion>, UncertaintyError> {
        let centre = self.at(&[])?;
        let get = |steps: &[(f64, &[f64])]| as_many(self.at(steps)?, centre.len());
        let (above, below) = (get(&[(1.0, first)])?, get(&[(-1.0, first)])?);
        let mut expansions = vec![Expansion::default(); centre.len()];
        let Some(second) = second else {
            let (half_above, half_below) = (get(&[(0.5, first)])?, get(&[(-0.5, first)])?);
            for (k, e) in expansions.iter_mut().enumerate() {
                let (whole, half) = (0.5 * (above[k] - below[k]), half_above[k] - half_below[k]);
                e.a = (4.0 * half - whole) / 3.0;
                e.aa = above[k] + below[k] - 2.0 * centre[k];
                e.aaa = 8.0 * (whole - half);
            }
            return Ok(expansions);
        };
        let corner = |a: f64, b: f64| get(&[(a, first), (b, second)]);
        let (pp, pm, mp, mm) = (corner(1.0, 1.0)?, corner(1.0, -1.0)?, corner(-1.0, 1.0)?, corner(-1.0, -1.0)?);
        let (right, left) = (get(&[(1.0, second)])?, get(&[(-1.0, second)])?);
        for (k, e) in expansions.iter_mut().enumerate() {
            e.ab = 0.25 * (pp[k] - pm[k] - mp[k] + mm[k]);
            e.abb = 0.5 * ((pp[k] + pm[k] - 2.0 * above[k]) - (mp[k] + mm[k] - 2.0 * below[k]));
            e.aab = 0.5 * ((pp[k] + mp[k] - 2.0 * right[k]) - (pm[k] + mm[k] - 2.0 * left[k]));
        }
        Ok(expansions)
    }
}
