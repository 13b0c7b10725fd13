//! The model of a measurement as a line of text.

mod parser;

use fmm_model::Scalar;

use crate::error::UncertaintyError;
use crate::model::formula::parser::Step;

/// A formula over named quantities, read from text and evaluated in any [`Scalar`]: in plain numbers for trials, in
/// [`Taylor`](crate::Taylor) numbers for exact derivatives.
///
/// ```text
/// numbers      2, 0.5, .5, 6.02e23           constants    pi, π
/// operators    + - * / ^ and ² ³             functions    sqrt exp ln log10 sin cos tan asin acos atan
///                                                         sinh cosh tanh abs, atan2(y, x)
/// ```
///
/// They bind as in a textbook: −2² is −4, 2^3^2 is 2^9, a/b/c is (a/b)/c. A product needs its sign. Angles are in
/// radians. Names begin with a letter or an underscore and go on with letters, digits, underscores and indices such as
/// ₀.
///
/// ```
/// use fmm_uq::{Formula, Input, Inputs, MonteCarlo, propagate};
///
/// let inputs = Inputs::new([
///     Input::new("mass", 10.391, 0.005, "kg")?,
///     Input::new("frequency", 2.198_08, 0.0004, "Hz")?,
/// ])?;
/// let stiffness = Formula::new("mass * (2 * pi * frequency)^2", &["mass", "frequency"])?;
/// let budget = propagate(&inputs, |x| stiffness.evaluate(x))?;
/// assert!((budget.standard_uncertainty() - 1.1958).abs() < 5e-5);
/// let trials = MonteCarlo::new(&inputs, 10_000)?.run(|x| stiffness.evaluate(x))?;
/// assert!((trials.standard_uncertainty(0)? - 1.196).abs() < 0.04);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    text: String,
    quantities: usize,
    /// Steps in the order of evaluation, operands before their operator.
    steps: Vec<Step>,
}

impl Formula {
    /// Reads a formula over quantities with these `names`, in the order in which [`Formula::evaluate`] is given their
    /// values.
    ///
    /// # Errors
    /// [`UncertaintyError::Model`] if the text is no formula, has more than 200 parentheses, powers and signs within
    /// each other, or has a name that is not among `names`; [`UncertaintyError::Invalid`] for a name given twice, for one that no formula
    /// can contain, and for that of a constant or function.
    pub fn new(text: &str, names: &[&str]) -> Result<Self, UncertaintyError> {
        for (place, name) in names.iter().enumerate() {
            if !parser::is_name(name) {
                return Err(UncertaintyError::invalid(format!(
                    "a formula cannot contain a quantity `{name}`; a name is made of letters, digits and underscores, \
                     begins with no digit, and is no constant or function"
                )));
            }
            if names[..place].contains(name) {
                return Err(UncertaintyError::duplicate_name(name));
            }
        }
        let steps = parser::parse(text)?.into_iter().map(|step| {
            let Step::Name(name) = step else { return Ok(step) };
            let unknown = || {
                let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
                UncertaintyError::model(format!("there is no quantity {name}; there is {known}"))
            };
            names.iter().position(|other| *other == name).map(Step::Quantity).ok_or_else(unknown)
        });
        Ok(Self { text: text.trim().to_owned(), quantities: names.len(), steps: steps.collect::<Result<_, _>>()? })
    }

    /// The text that was read.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its value for these `values` of the quantities, which may be infinite or no number where the formula is.
    ///
    /// # Errors
    /// [`UncertaintyError::Model`] unless there is one value for each name.
    pub fn evaluate<D: Scalar>(&self, values: &[D]) -> Result<D, UncertaintyError> {
        if values.len() != self.quantities {
            let (needed, found) = (self.quantities, values.len());
            let what = format!("the formula has {needed} quantities, but {found} values were given");
            return Err(UncertaintyError::model(what));
        }
        let mut stack: Vec<D> = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            // The parser leaves operands before every operator; without them there would be no value at the end.
            let value = match step {
                Step::Number(value) => Some(D::from(*value)),
                Step::Quantity(place) => values.get(*place).copied(),
                Step::OfOne(function) => stack.pop().map(|x| function.of(x)),
                Step::Power(exponent) => stack.pop().map(|x| x.powi(*exponent)),
                Step::Name(_) => None,
                Step::OfTwo(operator) => {
                    let second = stack.pop();
                    stack.pop().zip(second).map(|(first, second)| operator.of(first, second))
                }
            };
            stack.extend(value);
        }
        stack.pop().ok_or_else(|| parser::not_a_formula(&self.text, ""))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::taylor::Taylor;

    fn value(text: &str) -> f64 {
        let (names, values) = (["x", "μ_0", "N", "F₀"], [3.0, 0.25, 14.0, 5.0]);
        Formula::new(text, &names).unwrap_or_else(|error| panic!("{text}: {error}")).evaluate(&values).unwrap()
    }

    #[test]
    fn operators_bind_as_in_a_textbook() {
        for (text, expected) in [
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("-x^2", -9.0),
            ("-x²*2", -18.0),
            ("x³", 27.0),
            ("2 - 1 - 3", -2.0),
            ("8/4/2", 1.0),
            ("8/4*2", 4.0),
            ("1 + 2*3^2", 19.0),
            ("(1+2)*3", 9.0),
            ("2*-3", -6.0),
            ("+x - -1", 4.0),
            ("1.5e-3*2E3", 3.0),
            (".5 + 2.", 2.5),
            ("μ_0*N", 3.5),
            ("F₀/2", 2.5),
            ("sqrt(16)^0.5", 2.0),
            ("x^μ_0", 3f64.powf(0.25)),
            ("(-x)^3", -27.0),
            ("-2^-2", -0.25),
        ] {
            assert_eq!(value(text), expected, "{text}");
        }
    }

    type Named = (&'static str, fn(f64) -> f64);

    #[test]
    fn functions_are_what_they_are_called() {
        let of = |name: &str, x: f64| Formula::new(&format!("{name}(y)"), &["y"]).unwrap().evaluate(&[x]).unwrap();
        let functions: [Named; 14] = [
            ("sqrt", f64::sqrt),
            ("exp", f64::exp),
            ("ln", f64::ln),
            ("log10", f64::log10),
            ("sin", f64::sin),
            ("cos", f64::cos),
            ("tan", f64::tan),
            ("asin", f64::asin),
            ("acos", f64::acos),
            ("atan", f64::atan),
            ("sinh", f64::sinh),
            ("cosh", f64::cosh),
            ("tanh", f64::tanh),
            ("abs", f64::abs),
        ];
        for (name, function) in functions {
            for x in [0.125, 0.7] {
                assert!((of(name, x) / function(x) - 1.0).abs() < 4e-15, "{name}({x})");
            }
        }
        for (name, function) in &functions[4..] {
            assert!((of(name, -0.3) / function(-0.3) - 1.0).abs() < 4e-15, "{name}(-0.3)");
        }
        assert_eq!(value("atan2(1, -1)"), 0.75 * std::f64::consts::PI);
        assert_eq!(value("pi - π"), 0.0);
    }

    #[test]
    fn derivatives_are_exact() {
        let formula = Formula::new("a^2*b - (a-4)^3/b + a^b", &["a", "b"]).unwrap();
        let of = |a: f64, b: f64| {
            let value = formula.evaluate(&[Taylor::variable(a, 0), Taylor::variable(b, 1)]).unwrap();
            (value.partial(0), value.partial(1))
        };
        let (a, b) = (3.0_f64, 2.0_f64);
        let expected = (
            2.0 * a * b - 3.0 * (a - 4.0).powi(2) / b + b * a.powf(b - 1.0),
            a * a + (a - 4.0).powi(3) / (b * b) + a.powf(b) * a.ln(),
        );
        let found = of(a, b);
        assert!((found.0 - expected.0).abs() < 1e-13 && (found.1 - expected.1).abs() < 1e-13, "{found:?} {expected:?}");
    }

    #[test]
    fn what_is_no_formula_is_refused_where_it_ends_to_be_one() {
        for (text, part) in [
            ("2x", "from \"x\" on"),
            ("2 3", "from \"3\" on"),
            ("x +", "at its end"),
            ("", "at its end"),
            ("(x", "at its end"),
            ("x)", "from \")\" on"),
            ("x.y", "from \".y\" on"),
            ("atan2(x)", "from \")\" on"),
            ("sqrt x", "from \"x\" on"),
            ("log(x)", "no function log"),
            ("--x", "from \"-x\" on"),
            ("y + 1", "no quantity y; there is x"),
            ("inf", "no quantity inf"),
            ("2e", "from \"e\" on"),
        ] {
            let error = Formula::new(text, &["x"]).unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
        assert!(Formula::new("x", &["x y"]).unwrap_err().to_string().contains("`x y`"));
        assert!(Formula::new("pi", &["pi"]).unwrap_err().to_string().contains("`pi`"));
        assert!(Formula::new("x²", &["x²"]).is_err());
        assert!(Formula::new("x", &["x", "y", "x"]).unwrap_err().to_string().contains("given twice"));
        assert!(Formula::new("x", &["x"]).unwrap().evaluate(&[1.0, 2.0]).is_err());
        // A depth that no stack could hold.
        for deep in ["(", "-(", "2^", "sqrt(", "atan2("] {
            for depth in [201, 100_000] {
                let error = Formula::new(&deep.repeat(depth), &["x"]).unwrap_err();
                assert!(error.to_string().contains("at most 200 "), "{error}");
            }
        }
        // Nor a time that doubles with each level.
        assert!(Formula::new(&"atan2(".repeat(200), &["x"]).is_err());
        let deep = format!("{}x{}", "(".repeat(200), ")".repeat(200));
        assert_eq!(Formula::new(&deep, &["x"]).unwrap().evaluate(&[2.0]).unwrap(), 2.0);
    }

    /// Terms and factors beside each other take the parser no deeper.
    #[test]
    fn sums_are_as_long_as_they_like() {
        let long = "x + (-x)^2*2 - x/(x - -1) + ".repeat(1000) + "x";
        let found = Formula::new(&long, &["x"]).unwrap().evaluate(&[2.0]).unwrap();
        assert!((found - (1000.0 * (10.0 - 2.0 / 3.0) + 2.0)).abs() < 1e-9, "{found}");
        assert!(Formula::new(&("2^".repeat(201) + "x"), &["x"]).is_err());
        assert!(Formula::new(&"x)".repeat(300), &["x"]).is_err());
    }
}
