//! Any sliding law as one type, so that one kind of scenario serves all of them.

use fmm_friction::{
    AccelerationCoulomb, Affine, Berger, Coulomb, CoulombStatic, CoulombViscous, Element, ExponentialPair, Hyperbolic,
    Karnopp, LawFamily, MakkarDixon, MaxwellSlip, PiecewiseLinearLaw, PowerLaw, RegularisedStribeck,
    ShiftedMakkarDixon, SlidingLaw, Stribeck, StribeckLorentzian, Viscous,
};
use fmm_model::Scalar;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::case::log_uniform;

macro_rules! any_law {
    (affine: $($affine:ident = $affine_law:ty),+; curved: $($curved:ident = $curved_law:ty),+) => {
        /// Which law.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Family { $($affine,)+ MaxwellSlip, $($curved),+ }

        /// A law of any family.
        #[derive(Debug, Clone)]
        pub(crate) enum AnyLaw<D: Scalar> {
            $($affine(<$affine_law as LawFamily>::At<D>),)+
            MaxwellSlip(MaxwellSlip<D>),
            $($curved(<$curved_law as LawFamily>::At<D>)),+
        }

        impl Family {
            /// Those that are a level plus a slope on each branch.
            pub(crate) const AFFINE: &'static [Self] = &[$(Self::$affine),+];
            /// Those that the exact engine takes.
            pub(crate) const EXACT: &'static [Self] = &[$(Self::$affine,)+ Self::MaxwellSlip];
            /// Those that the Runge-Kutta engine takes.
            pub(crate) const SLIDING: &'static [Self] = &[$(Self::$affine,)+ $(Self::$curved),+];

            /// The law of these parameters, if they make one.
            pub(crate) fn law<D: Scalar>(self, values: &[D]) -> Option<AnyLaw<D>> {
                Some(match self {
                    $(Self::$affine => AnyLaw::$affine(<$affine_law as LawFamily>::at(values).ok()?),)+
                    Self::MaxwellSlip => {
                        let elements: Vec<_> = values.chunks(2).map(|pair| (pair[0], pair[1])).collect();
                        AnyLaw::MaxwellSlip(MaxwellSlip::new(&elements).ok()?)
                    }
                    $(Self::$curved => AnyLaw::$curved(<$curved_law as LawFamily>::at(values).ok()?)),+
                })
            }
        }

        impl<D: Scalar> AnyLaw<D> {
            fn sliding(&self) -> &dyn SlidingLaw<D> {
                match self {
                    $(Self::$affine(law) => law,)+
                    Self::MaxwellSlip(_) => panic!("elements are no law of the sliding speed"),
                    $(Self::$curved(law) => law),+
                }
            }

            fn piecewise_linear(&self) -> &dyn PiecewiseLinearLaw<D> {
                match self {
                    $(Self::$affine(law) => law,)+
                    Self::MaxwellSlip(law) => law,
                    $(Self::$curved(_) => panic!("a curved law"),)+
                }
            }
        }
    };
}

any_law! {
    affine: Viscous = Viscous, Coulomb = Coulomb, CoulombStatic = CoulombStatic, CoulombViscous = CoulombViscous,
        AccelerationCoulomb = AccelerationCoulomb;
    curved: Stribeck = Stribeck, StribeckLorentzian = StribeckLorentzian, Hyperbolic = Hyperbolic, Berger = Berger,
        PowerLaw = PowerLaw, ExponentialPair = ExponentialPair, Karnopp = Karnopp, MakkarDixon = MakkarDixon,
        Shifted = ShiftedMakkarDixon, RegularisedStribeck = RegularisedStribeck
}

impl<D: Scalar> SlidingLaw<D> for AnyLaw<D> {
    fn coefficient(&self, speed: D) -> D {
        self.sliding().coefficient(speed)
    }
    fn breakaway(&self) -> D {
        self.sliding().breakaway()
    }
    fn depends_on_acceleration(&self) -> bool {
        self.sliding().depends_on_acceleration()
    }
    fn coefficient_losing_speed(&self, speed: D) -> D {
        self.sliding().coefficient_losing_speed(speed)
    }
    fn capture_speed(&self) -> D {
        self.sliding().capture_speed()
    }
}

impl<D: Scalar> PiecewiseLinearLaw<D> for AnyLaw<D> {
    fn affine(&self) -> Affine<D> {
        self.piecewise_linear().affine()
    }
    fn affine_losing_speed(&self) -> Option<Affine<D>> {
        self.piecewise_linear().affine_losing_speed()
    }
    fn elements(&self) -> &[Element<D>] {
        self.piecewise_linear().elements()
    }
}

impl Family {
    /// Parameters that matter to a motion in which a force of the contact's size is a coefficient of `level` and speeds
    /// are about `speed` (m/s), on a machine that a viscous coefficient of `critical` (s/m) damps critically and whose
    /// spring is a coefficient of `spring` per displacement (1/m).
    pub(crate) fn draw(self, random: &mut ChaCha8Rng, level: f64, speed: f64, critical: f64, spring: f64) -> Vec<f64> {
        let breakaway = level * if random.random_bool(0.3) { 1.0 } else { random.random_range(1.0..2.5) };
        let viscous = if random.random_bool(0.3) { 0.0 } else { critical * log_uniform(random, -3.0, -0.5) };
        let bend = speed * log_uniform(random, -1.5, 0.5);
        match self {
            Self::Viscous => vec![viscous],
            Self::Coulomb => vec![level],
            Self::CoulombStatic => vec![level, breakaway],
            Self::CoulombViscous => vec![level, viscous],
            Self::AccelerationCoulomb => vec![level, level * random.random_range(0.3..1.7)],
            Self::MaxwellSlip => {
                let count = random.random_range(1..5);
                let mut element = || [spring * log_uniform(random, -1.0, 2.0), level * random.random_range(0.1..1.0)];
                (0..count).flat_map(|_| element()).collect()
            }
            Self::Stribeck => {
                let exponent = [1.0, 2.0, random.random_range(0.5..2.0)][random.random_range(0..3)];
                vec![level, breakaway, bend, exponent, viscous]
            }
            Self::StribeckLorentzian => vec![level, breakaway, bend, viscous],
            Self::Hyperbolic => vec![breakaway, 1.0 / bend],
            Self::Berger => vec![level, breakaway - level, 1.0 / bend],
            Self::PowerLaw => {
                let exponent: f64 = random.random_range(0.7..1.0);
                vec![level * random.random_range(0.1..1.0) / speed.powf(exponent), exponent, level]
            }
            Self::ExponentialPair => vec![level, breakaway, 1.0 / bend, 1.0 / bend * random.random_range(0.3..3.0)],
            Self::Karnopp => vec![level, breakaway, speed * log_uniform(random, -3.0, -1.0)],
            Self::MakkarDixon | Self::Shifted => {
                let rise = 10.0 / bend;
                vec![breakaway, rise, rise * random.random_range(0.05..0.5), level, rise, viscous]
            }
            Self::RegularisedStribeck => vec![breakaway, level, bend, viscous],
        }
    }
}
