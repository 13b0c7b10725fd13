//! The models of NIST's nonlinear reference data.

use std::f64::consts::TAU;

use fmm_model::Scalar;
use serde_json::Value;

use crate::harness::{Formula, numbers};

/// One data set: predictors, response and the name that chooses the model.
pub(crate) struct Dataset {
    pub(crate) name: String,
    x: Vec<Vec<f64>>,
    y: Vec<f64>,
}

impl Dataset {
    pub(crate) fn read(value: &Value) -> Self {
        let mut y = numbers(&value["y"]);
        if value["response"] == "log(y)" {
            for y in &mut y {
                *y = y.ln();
            }
        }
        let x = value["x"].as_array().unwrap().iter().map(numbers).collect();
        Self { name: value["name"].as_str().unwrap().to_owned(), x, y }
    }

    pub(crate) fn len(&self) -> usize {
        self.y.len()
    }
}

impl Formula for Dataset {
    fn residual<D: Scalar>(&self, i: usize, b: &[D]) -> D {
        model(&self.name, &self.x[i], b) - self.y[i]
    }
}

fn polynomial<D: Scalar>(coefficients: &[D], x: f64) -> D {
    coefficients.iter().rev().fold(D::from(0.0), |sum, c| sum * x + *c)
}

/// A quotient of polynomials whose denominator begins with 1.
fn rational<D: Scalar>(b: &[D], numerator: usize, x: f64) -> D {
    polynomial(&b[..numerator], x) / (polynomial(&b[numerator..], x) * x + 1.0)
}

fn bell<D: Scalar>(x: f64, height: D, centre: D, width: D) -> D {
    let distance = (centre - x) / width;
    height * (-(distance * distance)).exp()
}

fn wave<D: Scalar>(x: f64, period: D, cosine: D, sine: D) -> D {
    let (sin, cos) = (D::from(TAU * x) / period).sin_cos();
    cosine * cos + sine * sin
}

fn decay<D: Scalar>(x: f64, amplitude: D, rate: D) -> D {
    amplitude * (-rate * x).exp()
}

fn model<D: Scalar>(name: &str, x: &[f64], b: &[D]) -> D {
    let one = D::from(1.0);
    let t = x[0];
    match name {
        "Misra1a" | "BoxBOD" => b[0] * (one - (-b[1] * t).exp()),
        "Misra1b" => {
            let base = b[1] * (0.5 * t) + 1.0;
            b[0] * (one - one / (base * base))
        }
        "Misra1c" => b[0] * (one - one / (b[1] * (2.0 * t) + 1.0).sqrt()),
        "Misra1d" => b[0] * b[1] * t / (b[1] * t + 1.0),
        "Chwirut1" | "Chwirut2" => (-b[0] * t).exp() / (b[1] + b[2] * t),
        "DanWood" => b[0] * D::from(t).powf(b[1]),
        "ENSO" => b[0] + wave(t, D::from(12.0), b[1], b[2]) + wave(t, b[3], b[4], b[5]) + wave(t, b[6], b[7], b[8]),
        "Eckerle4" => bell(t, b[0] / b[1], b[2], b[1] * std::f64::consts::SQRT_2),
        "Gauss1" | "Gauss2" | "Gauss3" => decay(t, b[0], b[1]) + bell(t, b[2], b[3], b[4]) + bell(t, b[5], b[6], b[7]),
        "Hahn1" | "Thurber" => rational(b, 4, t),
        "Kirby2" => rational(b, 3, t),
        "Lanczos1" | "Lanczos2" | "Lanczos3" => decay(t, b[0], b[1]) + decay(t, b[2], b[3]) + decay(t, b[4], b[5]),
        "MGH09" => b[0] * (b[1] * t + t * t) / (b[2] * t + t * t + b[3]),
        "MGH10" => b[0] * (b[1] / (b[2] + t)).exp(),
        "MGH17" => b[0] + decay(t, b[1], b[3]) + decay(t, b[2], b[4]),
        "Nelson" => b[0] - b[1] * t * (-b[2] * x[1]).exp(),
        "Rat42" => b[0] / ((b[1] - b[2] * t).exp() + 1.0),
        "Rat43" => b[0] / ((b[1] - b[2] * t).exp() + 1.0).powf(one / b[3]),
        "Roszman1" => b[0] - b[1] * t - (b[2] / (b[3] * -1.0 + t)).atan2(one) / std::f64::consts::PI,
        "Bennett5" => b[0] * (b[1] + t).powf(-one / b[2]),
        other => panic!("no model called {other}"),
    }
}
