//! Every sliding law of the catalogue at thirteen speeds: value, slope and derivative in each parameter, to 50 digits.

use fmm_friction::{
    Berger, Coulomb, Hyperbolic, LawFamily, MakkarDixon, PowerLaw, RegularisedStribeck, SlidingLaw, Smoothed, Stribeck,
    StribeckLorentzian,
};
use fmm_model::{Dual, Scalar};
use serde_json::Value;

use crate::oracle::{number, read};

/// A number with derivatives in up to six parameters of the file and in the speed.
type Gradient = Dual<7>;

/// The direction of the speed.
const SPEED: usize = 6;

/// The formulas are exact; f64 loses a few units in the last place times the condition of each term.
const RELATIVE: f64 = 1e-12;

/// Error that a relative error cannot express. Differences of numbers near 1 in 50 digits are rounded to about 1e-50.
/// At the peak of the regularised law the derivatives are small differences of terms up to 50, rounded in f64.
fn absolute(law: &str) -> f64 {
    if law == "simscape" { 50.0 * f64::EPSILON } else { 1e-48 }
}

/// Where a parameter of ours comes from.
#[derive(Clone, Copy)]
enum Input {
    /// A parameter of the file.
    Of(&'static str),
    /// A value that the file's formula has built in.
    Fixed(f64),
}
use Input::{Fixed, Of};

/// The law's parameters, those of the file being the variables of the directions in which it lists its derivatives.
fn parameters<D: Scalar>(entry: &Value, inputs: &[Input]) -> Vec<D> {
    let order = entry["param_order"].as_array().unwrap();
    let parameter = |input: &Input| match *input {
        Fixed(value) => D::from(value),
        Of(name) => {
            let direction =
                order.iter().position(|key| key == name).unwrap_or_else(|| panic!("no {name} in {order:?}"));
            D::variable(number(&entry["params"][name]), direction)
        }
    };
    inputs.iter().map(parameter).collect()
}

/// Compares a law at plain numbers and at dual numbers with an entry of the file.
fn compare(entry: &Value, plain: impl Fn(f64) -> f64, dual: impl Fn(Gradient) -> Gradient) {
    let name = entry["law"].as_str().unwrap();
    let agree = |what: &str, speed: f64, got: f64, expected: &Value| {
        let Some(expected) = expected.as_f64() else {
            assert!(got.is_finite(), "{name}: {what} at {speed} m/s is {got}, where the file has none");
            return;
        };
        let error = (got - expected).abs();
        let bound = RELATIVE * expected.abs() + absolute(name);
        assert!(error <= bound, "{name}: {what} at {speed} m/s is {got:e} instead of {expected:e}, off by {error:.1e}");
    };
    let points = entry["points"].as_array().unwrap();
    assert_eq!(points.len(), 13, "{name}");
    for point in points {
        let speed = number(&point["v"]);
        let gradient = dual(Gradient::variable(speed, SPEED));
        agree("coefficient", speed, plain(speed), &point["value"]);
        assert_eq!(gradient.value(), plain(speed), "{name}: every number type has the same values");
        agree("slope", speed, gradient.partial(SPEED), &point["d_dv"]);
        for (direction, expected) in point["d_dparam"].as_array().unwrap().iter().enumerate() {
            agree(&format!("derivative {direction}"), speed, gradient.partial(direction), expected);
        }
    }
}

fn check<F: LawFamily>(entry: &Value, inputs: &[Input])
where
    F::At<f64>: SlidingLaw<f64>,
    F::At<Gradient>: SlidingLaw<Gradient>,
{
    let plain = F::at(&parameters::<f64>(entry, inputs)).unwrap();
    let dual = F::at(&parameters::<Gradient>(entry, inputs)).unwrap();
    compare(entry, |speed| plain.coefficient(speed), |speed| dual.coefficient(speed));
}

#[test]
fn pointwise() {
    let file = read("laws_pointwise");
    let entries = file["laws"].as_array().unwrap();
    assert_eq!(entries.len(), 12);
    for entry in entries {
        let stribeck = |exponent| [Of("Fc"), Of("Fs"), Of("vs"), exponent, Of("F2")];
        let makkar_dixon = |viscous| [Of("g1"), Of("g2"), Of("g3"), Of("g4"), Of("g5"), viscous];
        match entry["law"].as_str().unwrap() {
            "coulomb" => check::<Coulomb>(entry, &[Of("mu")]),
            "berger" => check::<Berger>(entry, &[Of("mu0"), Of("mu1"), Of("alpha")]),
            "stribeck_exponential" => check::<Stribeck>(entry, &stribeck(Fixed(1.0))),
            "stribeck_gaussian" => check::<Stribeck>(entry, &stribeck(Fixed(2.0))),
            "stribeck_general" => check::<Stribeck>(entry, &stribeck(Of("delta"))),
            "stribeck_lorentzian" => check::<StribeckLorentzian>(entry, &[Of("Fc"), Of("Fs"), Of("vs"), Of("F2")]),
            "leine_hyperbolic" => check::<Hyperbolic>(entry, &[Of("Fs"), Of("delta")]),
            "makkar_dixon5" => check::<MakkarDixon>(entry, &makkar_dixon(Fixed(0.0))),
            "makkar_dixon6" => check::<MakkarDixon>(entry, &makkar_dixon(Of("g6"))),
            "power_law" => check::<PowerLaw>(entry, &[Of("a"), Of("p"), Of("b")]),
            "simscape" => check::<RegularisedStribeck>(entry, &[Of("Fbrk"), Of("Fc"), Of("vbrk"), Of("f")]),
            "coulomb_tanh" => compare(entry, smoothed::<f64>(entry), smoothed::<Gradient>(entry)),
            unknown => panic!("no law for {unknown}"),
        }
    }
}

fn smoothed<D: Scalar>(entry: &Value) -> impl Fn(D) -> D {
    let values = parameters(entry, &[Of("F"), Of("eps")]);
    let law = Smoothed::new(Coulomb::new(values[0]).unwrap(), values[1]).unwrap();
    move |speed| law.coefficient(speed)
}

/// The Stribeck law of exponents 1 and 2 has a derivative in the exponent too, which the file gives for 0.5 only: the
/// exact derivatives at 1 ± h must close in on it.
#[test]
fn derivative_in_the_exponent_is_continuous() {
    let slope = |exponent: f64, speed: f64| {
        let values = [1.75, 3.5, 0.02, exponent, 0.5];
        let mut values = values.map(Dual::<1>::from);
        values[3] = Dual::variable(exponent, 0);
        Stribeck::at(&values).unwrap().coefficient(Dual::from(speed)).partial(0)
    };
    for speed in [0.0, 1e-4, 0.01, 0.02, 0.05, 0.3] {
        for exponent in [1.0, 2.0] {
            let (at, below) = (slope(exponent, speed), slope(exponent - 1e-7, speed));
            // The second derivative is a few times the drop of 1.75; over 1e-7 it changes the slope by up to 1e-5 of
            // it.
            assert!((at - below).abs() < 1e-5, "{at} against {below} at {speed} m/s, δ = {exponent}");
        }
    }
}
