//! A law of the sliding speed that is known at run time only.

use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::Debug;

use fmm_model::Scalar;

use crate::law::parameter::all_checked;
use crate::law::{LawError, LawParameter, SlidingLaw};

/// Step of a central difference over its argument, ε^(1/3), and the least one.
const STEP: f64 = 6e-6;
const LEAST_STEP: f64 = 1e-8;

/// Formula of a law in plain numbers, for laws that no compiler sees: those of another language, or out of a file.
pub trait SpeedFormula: Debug + Send + Sync {
    /// Friction coefficients (1) at several points: `arguments` are the speeds ≥ 0 (m/s), and then the values of each
    /// parameter, one a point. What is negative or not finite ends the simulation at these values.
    fn coefficients(&self, arguments: &[Vec<f64>]) -> Vec<f64>;

    /// Derivatives of the coefficient at one point by each argument, the speed first; `None`, the default, for a
    /// formula that does not know them.
    fn derivatives(&self, arguments: &[f64]) -> Option<Vec<f64>> {
        let _ = arguments;
        None
    }
}

/// A law of the sliding speed whose name, parameters and formula are known at run time only. It holds its contact at
/// rest up to the level at zero speed.
///
/// Where an engine or a fit asks for derivatives that the formula does not know, they are central differences, within
/// the bounds of a parameter: of nine or ten digits, at two evaluations each. A [`LawFamily`](crate::LawFamily) is far
/// faster.
///
/// ```
/// use fmm_friction::{LawParameter, OwnLaw, Role, SlidingLaw, SpeedFormula};
/// use fmm_model::{Bounds, Dual, Parameter, Scalar};
///
/// #[derive(Debug)]
/// struct Root;
/// impl SpeedFormula for Root {
///     fn coefficients(&self, arguments: &[Vec<f64>]) -> Vec<f64> {
///         let [speed, level, rise] = arguments else { return Vec::new() };
///         speed.iter().zip(level).zip(rise).map(|((v, level), rise)| level + rise * v.sqrt()).collect()
///     }
/// }
///
/// let parameter = |name, unit| Parameter::new(name, name, unit).bounded(Bounds::NOT_NEGATIVE);
/// let parameters = vec![
///     LawParameter::new(parameter("coefficient", "1"), Role::Level),
///     LawParameter::new(parameter("rise", "(s/m)^0.5"), Role::Level).typically(0.1),
/// ];
/// let law = OwnLaw::new("root", parameters, Box::new(Root))?;
/// let member = law.at(&[Dual::<2>::variable(0.2, 0), Dual::variable(0.1, 1)])?;
/// let coefficient = member.coefficient(Dual::from(0.25));
/// assert_eq!((coefficient.value(), member.breakaway().value()), (0.25, 0.2));
/// assert!((coefficient.partial(0) - 1.0).abs() < 1e-9 && (coefficient.partial(1) - 0.5).abs() < 1e-9);
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
#[derive(Debug)]
pub struct OwnLaw {
    name: String,
    parameters: Vec<LawParameter>,
    formula: Box<dyn SpeedFormula>,
}

impl OwnLaw {
    /// The law called `name`.
    ///
    /// # Errors
    /// [`LawError::Contradiction`] if two parameters have one name or one has no value within its bounds,
    /// [`LawError::WrongCount`] without a parameter.
    pub fn new(
        name: impl Into<String>,
        parameters: Vec<LawParameter>,
        formula: Box<dyn SpeedFormula>,
    ) -> Result<Self, LawError> {
        let name = name.into();
        if parameters.is_empty() {
            return Err(LawError::WrongCount { what: format!("the law {name} needs a parameter"), got: 0 });
        }
        for (place, parameter) in parameters.iter().map(LawParameter::parameter).enumerate() {
            if parameters[..place].iter().any(|other| other.parameter().name() == parameter.name()) {
                let what = format!("the law {name} has two parameters called {}", parameter.name());
                return Err(LawError::Contradiction { what });
            }
            if parameter.bounds().is_empty() {
                let what = format!("no value lies within the bounds of {}", parameter.name());
                return Err(LawError::Contradiction { what });
            }
        }
        Ok(Self { name, parameters, formula })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its parameters, in the order in which [`at`](Self::at) takes their values.
    pub fn parameters(&self) -> &[LawParameter] {
        &self.parameters
    }

    /// The law with the given parameter values.
    ///
    /// # Errors
    /// [`LawError::WrongCount`] and [`LawError::OutOfBounds`].
    pub fn at<'a, D: Scalar>(
        &'a self,
        values: &[D],
    ) -> Result<impl SlidingLaw<D> + Clone + Debug + use<'a, D>, LawError> {
        all_checked(&self.name, &self.parameters, values)?;
        Ok(OwnMember { law: self, values: values.to_vec() })
    }

    /// Argument `index` of `at` moved by a step in both directions, as far as its bounds allow.
    fn around(&self, at: &[f64], index: usize) -> [f64; 2] {
        let step = (STEP * at[index].abs()).max(LEAST_STEP);
        let ends = [at[index] - step, at[index] + step];
        match index.checked_sub(1) {
            None => ends.map(|speed| speed.max(0.0)),
            Some(parameter) => ends.map(|value| self.parameters[parameter].parameter().bounds().clamp(value)),
        }
    }

    /// Coefficient at the arguments `at`, and its derivatives by those that `vary`; NaN for what no law may give.
    fn evaluated(&self, at: &[f64], vary: &[usize]) -> (f64, Vec<f64>) {
        let known = if vary.is_empty() { Some(Vec::new()) } else { self.formula.derivatives(at) };
        let moved = if known.is_some() { &[][..] } else { vary };
        let ends: Vec<[f64; 2]> = moved.iter().map(|index| self.around(at, *index)).collect();
        let mut arguments: Vec<Vec<f64>> = at.iter().map(|value| alloc::vec![*value; 1 + 2 * moved.len()]).collect();
        for (place, (index, ends)) in moved.iter().zip(&ends).enumerate() {
            arguments[*index][1 + 2 * place..3 + 2 * place].copy_from_slice(ends);
        }
        let found = self.formula.coefficients(&arguments);
        let at_point = found.first().copied().filter(|value| *value >= 0.0).unwrap_or(f64::NAN);
        let slope = |(place, [low, high]): (usize, &[f64; 2])| {
            let pair = found.get(1 + 2 * place).zip(found.get(2 + 2 * place));
            // Fixed by its bounds, an argument has no derivative.
            if low == high { 0.0 } else { pair.map_or(f64::NAN, |(below, above)| (above - below) / (high - low)) }
        };
        let slopes = match known {
            Some(all) => vary.iter().map(|index| all.get(*index).copied().unwrap_or(f64::NAN)).collect(),
            None => ends.iter().enumerate().map(slope).collect(),
        };
        (at_point, slopes)
    }
}

/// An [`OwnLaw`] with values of its parameters.
#[derive(Debug, Clone)]
struct OwnMember<'a, D = f64> {
    law: &'a OwnLaw,
    values: Vec<D>,
}

impl<D: Scalar> SlidingLaw<D> for OwnMember<'_, D> {
    fn coefficient(&self, speed: D) -> D {
        let arguments = || core::iter::once(speed).chain(self.values.iter().copied());
        let at: Vec<f64> = arguments().map(Scalar::value).collect();
        let varies = |argument: &D| (0..D::DIRECTIONS).any(|direction| argument.partial(direction) != 0.0);
        let vary: Vec<usize> = arguments().enumerate().filter(|(_, one)| varies(one)).map(|(index, _)| index).collect();
        let (value, slopes) = self.law.evaluated(&at, &vary);
        let varied = arguments().filter(varies).zip(slopes);
        varied.fold(D::from(value), |sum, (argument, slope)| sum + (argument - argument.value()) * slope)
    }

    fn breakaway(&self) -> D {
        self.coefficient(D::from(0.0))
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use fmm_model::{Bounds, Dual, Parameter};

    use super::*;
    use crate::law::{LawFamily, Role};
    use crate::laws::Stribeck;

    /// Stribeck's law by plain numbers.
    #[derive(Debug)]
    struct Plain {
        knows_derivatives: bool,
    }

    impl SpeedFormula for Plain {
        fn coefficients(&self, arguments: &[Vec<f64>]) -> Vec<f64> {
            let point = |at: usize| arguments.iter().map(|argument| argument[at]).collect::<Vec<_>>();
            let points = (0..arguments[0].len()).map(point);
            points.map(|at| Stribeck::at(&at[1..]).unwrap().coefficient(at[0])).collect()
        }

        fn derivatives(&self, arguments: &[f64]) -> Option<Vec<f64>> {
            let seeded: Vec<Dual<6>> = arguments.iter().enumerate().map(|(i, at)| Dual::variable(*at, i)).collect();
            let found = Stribeck::at(&seeded[1..]).unwrap().coefficient(seeded[0]);
            self.knows_derivatives.then(|| (0..6).map(|direction| found.partial(direction)).collect())
        }
    }

    fn law(knows_derivatives: bool) -> OwnLaw {
        OwnLaw::new("plain", Stribeck::PARAMETERS.to_vec(), Box::new(Plain { knows_derivatives })).unwrap()
    }

    const VALUES: [f64; 5] = [0.1, 0.15, 0.02, 1.0, 0.3];

    #[test]
    fn derivatives_are_those_of_the_formula_generic_in_its_number() {
        for (knows_derivatives, tolerance) in [(true, 0.0), (false, 1e-8)] {
            let seeded: Vec<Dual<6>> = VALUES.iter().enumerate().map(|(i, at)| Dual::variable(*at, i + 1)).collect();
            let law = law(knows_derivatives);
            let (own, generic) = (law.at(&seeded).unwrap(), Stribeck::at(&seeded).unwrap());
            for speed in [0.0, 1e-4, 0.01, 0.4] {
                let speed = Dual::variable(speed, 0);
                let (own, generic) = (own.coefficient(speed), generic.coefficient(speed));
                assert_eq!(own.value(), generic.value());
                for direction in 1..6 {
                    let (one, other) = (own.partial(direction), generic.partial(direction));
                    assert!((one - other).abs() <= tolerance * (1.0 + other.abs()), "{direction}: {one}, {other}");
                }
            }
        }
    }

    #[test]
    fn steps_stay_within_bounds() {
        let law = law(false);
        let ends = law.around(&[0.0, 0.0, 0.15, 0.02, 2.0, 0.3], 1);
        assert_eq!(ends, [0.0, LEAST_STEP]);
        assert_eq!(law.around(&[0.0; 6], 0), [0.0, LEAST_STEP]);
        assert_eq!(law.around(&[0.0, 0.0, 0.15, 0.02, 2.0, 0.3], 4)[1], 2.0);
    }

    #[test]
    fn what_no_law_may_give_is_no_number() {
        #[derive(Debug)]
        struct Pushing;
        impl SpeedFormula for Pushing {
            fn coefficients(&self, arguments: &[Vec<f64>]) -> Vec<f64> {
                arguments[0].iter().map(|speed| 0.1 - speed).collect()
            }
        }
        let parameter = LawParameter::new(Parameter::new("a", "a", "1").bounded(Bounds::NOT_NEGATIVE), Role::Level);
        let own = OwnLaw::new("pushing", vec![parameter.clone()], Box::new(Pushing)).unwrap();
        let member = own.at(&[0.1]).unwrap();
        assert_eq!(member.coefficient(0.1), 0.0);
        assert!(member.coefficient(0.2).is_nan());
        let refused = |parameters| OwnLaw::new("own", parameters, Box::new(Pushing)).unwrap_err().to_string();
        assert_eq!(refused(vec![]), "the law own needs a parameter");
        assert_eq!(refused(vec![parameter.clone(), parameter]), "the law own has two parameters called a");
        assert!(own.at(&[0.1, 0.2]).is_err() && own.at(&[-0.1]).is_err());
    }
}
