//! Parts of a law that a step passes between its stages: what begins at a small speed, next to a turn.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::Scalar;

use crate::bristle::polynomial::{Series, StepPolynomial, value};
use crate::bristle::radau::{CENTRED_COLUMNS, STAGES, product};
use crate::bristle::run::Run;
use crate::bristle::taylor::ORDER;
use crate::mechanics::Piece;

/// Places looked at, each a quarter of the way of the one before from the end of the step that is next to a turn. At
/// the last one, an error allowed at any tolerance remains of whatever the law does.
const PLACES: usize = 9;

/// The first of them, as a part of the step: what lasts longer is seen by the stages.
const FIRST: f64 = 1.0 / 16.0;

/// Ratio of the speeds at the ends of a step above which one of the ends is next to a turn (1).
const TURNS: f64 = 16.0;

/// Greatest relative difference of two rates per speed of a law of the path alone, by rounding (1).
const ROUNDING: f64 = 1e-12;

/// True if rate over speed, or the coefficient, changes with the speed, so that a law may begin to act at a small one.
pub(super) fn depends_on_speed<D: Scalar, L: BristleLaw<D> + ?Sized>(law: &L) -> bool {
    let size = law.states();
    let [mut state, mut rate] = [vec![D::from(0.0); size], vec![D::from(0.0); size]];
    [-0.7, 0.0, 0.3, 0.9].into_iter().any(|part: f64| {
        for (index, z) in state.iter_mut().enumerate() {
            *z = law.bound(index) * part;
        }
        let mut first: Option<(Vec<f64>, f64)> = None;
        (-12..=6).any(|decade| {
            let speed = 10f64.powi(decade);
            law.rate(D::from(speed), &state, Regime::ALL_HOLD, &mut rate);
            let coefficient = law.coefficient(D::from(speed), &state, &rate).value();
            let per_speed: Vec<f64> = rate.iter().map(|rate| rate.value() / speed).collect();
            let Some((rates, before)) = &first else {
                first = Some((per_speed, coefficient));
                return false;
            };
            let differs = |a: f64, b: f64| !((a - b).abs() <= ROUNDING * (a.abs() + b.abs()));
            differs(coefficient, *before) || per_speed.iter().zip(rates).any(|(a, b)| differs(*a, *b))
        })
    })
}

impl<D: Scalar, L: BristleLaw<D> + ?Sized> Run<'_, D, L> {
    /// The part of the step of this `length` after which its polynomial may not obey the law; `None` if it does so next
    /// to a turn.
    ///
    /// The error of a velocity is what its rate is off by, times the way to the turn, which is the time for which the
    /// law may do so; that of a state is no more than what its return leaves of it.
    pub(super) fn hidden(&mut self, piece: &Piece<D>, length: f64) -> Option<f64> {
        if !self.field.depends_on_speed {
            return None;
        }
        let belt = self.field.belt.value();
        let [begin, end] = self.step.ends(1).map(|velocity| (velocity - belt).abs());
        let falls = end * TURNS <= begin;
        if !falls && begin * TURNS > end {
            return None;
        }
        let polynomials: Vec<Plain> = (0..self.step.size).map(|component| self.step.plain(component)).collect();
        let mut way = FIRST;
        for _ in 0..PLACES {
            if !self.is_seen(&polynomials, piece, length, if falls { 1.0 - way } else { way }, way) {
                // In a quarter of a step the stages see it.
                return Some(if falls { 1.0 - 4.0 * way } else { 4.0 * way });
            }
            way *= 0.25;
        }
        None
    }

    /// True if the rates at `place` of the step are those of the law, as far as they matter over a part `way` of it.
    fn is_seen(&mut self, polynomials: &[Plain], piece: &Piece<D>, length: f64, place: f64, way: f64) -> bool {
        let Self { step, field, branch, before: rates, after: state, relaxations, .. } = self;
        for (y, polynomial) in state.iter_mut().zip(polynomials) {
            *y = D::from(polynomial.at(place));
        }
        field.rates(piece.force(self.time + length * place), *branch, state, rates);
        let error = |component: usize| {
            let defect = polynomials[component].slope(place) - rates[component].value() * length;
            defect.abs() * way / (self.tolerance * step.scale(component))
        };
        if (1..step.size).all(|component| error(component) <= 1.0) {
            return true;
        }
        field.relaxations(*branch, state, relaxations);
        let returns = |component: usize| if component > 1 { relaxations[component - 2].max(0.0) } else { 0.0 };
        (1..step.size).all(|component| error(component) <= 1.0 + returns(component) * length * way)
    }
}

/// The values of a polynomial of a step, in powers of the place or of its distance from the middle.
struct Plain {
    coefficients: Series<f64>,
    terms: usize,
    origin: f64,
    unit: f64,
}

impl Plain {
    fn at(&self, place: f64) -> f64 {
        let tau = (place - self.origin) / self.unit;
        self.coefficients[..self.terms].iter().rev().fold(0.0, |sum, term| sum * tau + term)
    }

    /// Per unit of the step.
    fn slope(&self, place: f64) -> f64 {
        let tau = (place - self.origin) / self.unit;
        let terms = self.coefficients[..self.terms].iter().enumerate().skip(1).rev();
        terms.fold(0.0, |sum, (order, term)| sum * tau + order as f64 * term) / self.unit
    }
}

impl<D: Scalar> StepPolynomial<D> {
    /// Values of a component at the beginning and at the end of the step.
    fn ends(&self, component: usize) -> [f64; 2] {
        let begin = self.begin[component].value();
        if self.is_series() {
            [begin, value(&self.series[component], 1.0)]
        } else {
            [begin, begin + self.increments[component][STAGES - 1].value()]
        }
    }

    fn plain(&self, component: usize) -> Plain {
        if self.is_series() {
            let coefficients = self.plain_series(component, 0.0, 1.0);
            return Plain { coefficients, terms: ORDER + 1, origin: 0.0, unit: 1.0 };
        }
        let mut coefficients = [0.0; ORDER + 1];
        let centred = product(&CENTRED_COLUMNS, &self.increments[component].map(D::value));
        coefficients[..=STAGES].copy_from_slice(&centred);
        coefficients[0] += self.begin[component].value();
        Plain { coefficients, terms: STAGES + 1, origin: 0.5, unit: 0.5 }
    }
}
