//! Derivatives by differences, for models that only take plain numbers.

use crate::model::derivatives::{Derivatives, Expansion, Slopes, place};
use crate::{Inputs, ModelOutput, UncertaintyError};

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
        let mut x: Vec<f64> = self.inputs.as_slice().iter().map(crate::Input::value).collect();
        for (factor, direction) in steps {
            for (x, step) in x.iter_mut().zip(*direction) {
                *x += factor * step;
            }
        }
        let here = || place(self.inputs, x.iter().copied());
        let mut outputs = Vec::new();
        (self.model)(&x).append_to(&mut outputs).map_err(|source| UncertaintyError::model_failed(&here(), source))?;
        match outputs.iter().find(|y| !y.is_finite()) {
            Some(&result) => Err(UncertaintyError::result_not_finite(result, &here())),
            None => Ok(outputs),
        }
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
        let again = as_many(self.at(&[])?, values.len())?;
        if let Some((&first, &again)) = values.iter().zip(&again).find(|(first, again)| first != again) {
            let at = place(self.inputs, inputs.iter().map(crate::Input::value));
            return Err(UncertaintyError::model_not_repeatable(first, again, &at));
        }
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
