//! Pairs of a law and an engine.

use fmm_friction::{
    AccelerationCoulomb, Berger, BoucWen, BristleLaw, Coulomb, CoulombStatic, CoulombViscous, Dahl, ExponentialPair,
    Gms, Hyperbolic, Karnopp, LuGre, MakkarDixon, MaxwellSlip, PiecewiseLinearLaw, PowerLaw, RegularisedStribeck,
    ShiftedMakkarDixon, SlidingLaw, Smoothed, Stribeck, StribeckLorentzian, Viscous,
};
use fmm_model::{Dual, Scalar};
use fmm_sim::{Bristle, Exact, Moreau, RungeKutta, Thesis};

use crate::case::{Case, Choice, Contact, Law};
use crate::motion::check;

/// Runs the case; none if its numbers make no law.
pub(crate) fn run(case: &Case) -> Option<()> {
    match case.engine {
        Choice::Gradient if case.is_everyday() => with_law::<Dual<2>>(case),
        _ => with_law::<f64>(case),
    }
}

impl Contact {
    fn at<D: Scalar>(&self, index: usize) -> D {
        D::from(self.numbers[index].value())
    }

    fn positive<D: Scalar>(&self, index: usize) -> D {
        D::from(self.numbers[index].positive())
    }

    /// Two levels, the second not below the first.
    fn levels<D: Scalar>(&self) -> (D, D) {
        let (one, other) = (self.numbers[0].value(), self.numbers[1].value());
        (D::from(one.min(other)), D::from(one.max(other)))
    }

    fn stribeck<D: Scalar>(&self) -> Option<Stribeck<D>> {
        let (sliding, breakaway) = self.levels();
        let exponent = D::from(0.5 + self.numbers[3].value() % 1.5);
        Stribeck::new(sliding, breakaway, self.positive(2), exponent, self.at(4)).ok()
    }

    fn makkar_dixon<D: Scalar>(&self) -> Option<MakkarDixon<D>> {
        let (one, other) = (self.numbers[1].positive(), self.numbers[2].positive());
        let (rise, fall) = (D::from(one.max(other)), D::from(one.min(other)));
        MakkarDixon::six(self.at(0), rise, fall, self.at(3), self.at(4), self.at(5)).ok()
    }

    /// Three elements of which none has a number that is zero.
    fn elements<D: Scalar>(&self) -> [(D, D); 3] {
        [0, 2, 4].map(|index| (self.positive(index), self.positive(index + 1)))
    }
}

fn with_law<D: Number>(case: &Case) -> Option<()> {
    let law = &case.law;
    let (at, positive) = (|index| law.at::<D>(index), |index| law.positive::<D>(index));
    let (sliding, breakaway) = law.levels::<D>();
    match law.law {
        Law::Viscous => affine(case, Viscous::new(at(0)).ok()?),
        Law::Coulomb => affine(case, Coulomb::new(at(0)).ok()?),
        Law::CoulombStatic => affine(case, CoulombStatic::new(sliding, breakaway).ok()?),
        Law::CoulombViscous => affine(case, CoulombViscous::new(at(0), at(1)).ok()?),
        Law::AccelerationCoulomb => affine(case, AccelerationCoulomb::new(at(0), at(1)).ok()?),
        Law::MaxwellSlip => {
            let law = MaxwellSlip::new(&law.elements::<D>()).ok()?;
            match case.engine {
                Choice::RungeKutta(_) => check(case, &Bristle::default(), law, false),
                _ => check(case, &Exact, law, false),
            }
        }
        Law::Stribeck => sliding_law(case, law.stribeck::<D>()?),
        Law::StribeckLorentzian => {
            sliding_law(case, StribeckLorentzian::new(sliding, breakaway, positive(2), at(3)).ok()?)
        }
        Law::Hyperbolic => sliding_law(case, Hyperbolic::new(at(0), at(1)).ok()?),
        Law::Berger => sliding_law(case, Berger::new(at(0), at(1), at(2)).ok()?),
        Law::PowerLaw => {
            let exponent = law.numbers[1].positive() % 1.0;
            let exponent = D::from(if exponent > 0.0 { exponent } else { 1.0 });
            sliding_law(case, PowerLaw::new(at(0), exponent, at(2)).ok()?)
        }
        Law::ExponentialPair => {
            sliding_law(case, ExponentialPair::new(sliding, breakaway, positive(2), positive(3)).ok()?)
        }
        Law::Karnopp => sliding_law(case, Karnopp::new(sliding, breakaway, positive(2)).ok()?),
        Law::MakkarDixon => sliding_law(case, law.makkar_dixon::<D>()?),
        Law::ShiftedMakkarDixon => sliding_law(case, ShiftedMakkarDixon::new(law.makkar_dixon::<D>()?)),
        Law::RegularisedStribeck => {
            sliding_law(case, RegularisedStribeck::new(breakaway, sliding, positive(2), at(3)).ok()?)
        }
        Law::Smoothed => sliding_law(case, Smoothed::new(law.stribeck::<D>()?, positive(5)).ok()?),
        Law::Dahl => bristles(case, Dahl::new(positive(0), positive(1), positive(2)).ok()?),
        Law::LuGre => {
            let (one, other) = (law.numbers[0].positive(), law.numbers[1].positive());
            let exponent = D::from(0.5 + law.numbers[3].value() % 1.5);
            let (sliding, breakaway) = (D::from(one.min(other)), D::from(one.max(other)));
            let law = LuGre::new(sliding, breakaway, positive(2), exponent, positive(4), at(5), at(6));
            bristles(case, law.ok()?)
        }
        Law::BoucWen => {
            let law =
                BoucWen::new(positive(0), positive(1), positive(2), at(3), D::from(1.0 + law.numbers[4].value() % 8.0));
            bristles(case, law.ok()?)
        }
        Law::Gms => {
            let share = D::from(0.25);
            let elements = [(positive(5), share), (positive(6), share * 3.0)];
            bristles(case, Gms::new(law.stribeck::<D>()?, positive(7), &elements).ok()?)
        }
    }
    Some(())
}

fn affine<D: Number, L: PiecewiseLinearLaw<D> + SlidingLaw<D>>(case: &Case, law: L) {
    match case.engine {
        Choice::Natural | Choice::Gradient => check(case, &Exact, law, false),
        _ => sliding_law(case, law),
    }
}

fn sliding_law<D: Number, L: SlidingLaw<D>>(case: &Case, law: L) {
    match case.engine {
        Choice::Natural | Choice::Gradient => check(case, &RungeKutta::default(), law, false),
        Choice::RungeKutta(tolerance) => {
            let tolerance = 10f64.powf(-2.0 - 13.0 / 255.0 * f64::from(tolerance)).max(1e-15);
            if let Ok(engine) = RungeKutta::new(tolerance) {
                check(case, &engine, law, false);
            }
        }
        Choice::Moreau(_) | Choice::Thesis(_) => D::step(case, law),
    }
}

fn bristles<D: Scalar, L: BristleLaw<D>>(case: &Case, law: L) {
    check(case, &Bristle::default(), law, false);
}

/// A number type, and the engines of fixed step if they know it.
trait Number: Scalar {
    fn step<L: SlidingLaw<Self>>(case: &Case, law: L);
}

impl Number for f64 {
    fn step<L: SlidingLaw<f64>>(case: &Case, law: L) {
        match case.engine {
            Choice::Thesis(level) => check(case, if level % 2 == 0 { &Thesis::A3 } else { &Thesis::A6 }, law, true),
            Choice::Moreau(theta) => {
                if let Ok(engine) = Moreau::new(0.5 + f64::from(theta) / 512.0) {
                    check(case, &engine, law, true);
                }
            }
            _ => {}
        }
    }
}

impl<const N: usize> Number for Dual<N> {
    fn step<L: SlidingLaw<Self>>(_case: &Case, _law: L) {}
}
