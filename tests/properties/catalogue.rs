//! Every family of the catalogue, by parameters drawn from their units and roles: a law that is added is tested here as
//! it is.

use fmm_friction::{FamilyVisitor, LawFamily, LawParameter, Role, catalogue};
use fmm_model::{Dual, Oscillator, Scalar, Unit};
use fmm_sim::{Sampling, Scenario, Trajectory, simulate_into};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Scales of the motion: friction coefficient (1), amplitude (m), largest speed (m/s).
const LEVEL: f64 = 0.2;
const LENGTH: f64 = 0.02;
const SPEED: f64 = 0.28;
const MASS: f64 = 10.0;
const STIFFNESS: f64 = 2000.0;
const LOAD: f64 = 15.0;

/// A value of the size that `parameter` typically has in the motion; coefficients that lie above others are drawn
/// above.
fn draw(parameter: &LawParameter, exponent: f64, random: &mut ChaCha8Rng) -> f64 {
    let unit = Unit::of(parameter.parameter().unit()).dimension(|_| Some(exponent)).expect("a unit that is known");
    let is_force = !matches!(parameter.role(), Role::Shape);
    let level = match parameter.role() {
        Role::LevelAbove | Role::Breakaway => 2.5 * LEVEL / parameter.typical(),
        _ if is_force => LEVEL,
        _ => 1.0,
    };
    let scale = level * LENGTH.powf(unit.length() + unit.time()) * SPEED.powf(-unit.time());
    let slope = if parameter.role() == Role::Slope { 0.1 } else { 1.0 };
    let value = parameter.typical() * slope * scale * 10f64.powf(random.random_range(-0.2..0.2));
    parameter.parameter().bounds().clamp(value)
}

struct Moves<'a>(&'a mut ChaCha8Rng);

impl FamilyVisitor for Moves<'_> {
    /// Name, and how many of the laws that were drawn exist.
    type Output = (&'static str, usize);

    fn visit<F: LawFamily>(&mut self) -> Self::Output {
        let mut found = 0;
        for _ in 0..DRAWN {
            let exponent = self.0.random_range(0.8..1.5);
            let values: Vec<f64> = F::PARAMETERS.iter().map(|parameter| draw(parameter, exponent, self.0)).collect();
            if F::at::<f64>(&values).is_ok() {
                found += 1;
                moves::<F>(&values);
            }
        }
        (F::NAME, found)
    }
}

const DRAWN: usize = 12;

/// The free vibration of a law of family `F`, in numbers of type `D`.
fn motion<F: LawFamily, D: Scalar>(values: &[D]) -> Trajectory<D> {
    let oscillator = Oscillator::new(D::from(MASS), D::from(STIFFNESS)).unwrap();
    let scenario = Scenario::new(oscillator, F::at(values).unwrap(), D::from(LOAD)).unwrap();
    let scenario = scenario.starting_at(D::from(LENGTH), D::from(0.0)).unwrap();
    let mut trajectory = Trajectory::new();
    let sampling = Sampling::uniform(2e-3, 1000).unwrap();
    simulate_into::<F, _>(&scenario, &sampling, None, &mut trajectory).unwrap_or_else(|error| {
        panic!("{} {:?}: {error}", F::NAME, values.iter().map(|v| v.value()).collect::<Vec<_>>())
    });
    trajectory
}

/// A free vibration ends, is finite, loses energy, and has the same bits with derivatives and without.
fn moves<F: LawFamily>(values: &[f64]) {
    let plain = motion::<F, f64>(values);
    let samples = plain.position().values().iter().zip(plain.velocity().values());
    let energies: Vec<f64> = samples
        .map(|(x, v)| 0.5 * (STIFFNESS * x * x + MASS * v * v))
        .inspect(|energy| assert!(energy.is_finite()))
        .collect();
    // Bristles give back what they have stored, which came from the machine.
    let most = energies.iter().copied().fold(0.0, f64::max);
    assert!(most < energies[0] * (1.0 + 1e-9), "{} {values:?} gains energy: {most} J", F::NAME);
    assert!(energies[999] < 0.99 * energies[0], "{} {values:?} loses nothing", F::NAME);
    let seeded: Vec<Dual<1>> = values.iter().enumerate().map(|(j, value)| Dual::variable(*value, j)).collect();
    let with_derivatives = motion::<F, Dual<1>>(&seeded);
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(plain.position().values()), bits(with_derivatives.position().values()), "{} {values:?}", F::NAME);
}

#[test]
fn every_law_of_the_catalogue_moves() {
    let mut random = ChaCha8Rng::seed_from_u64(23);
    for (name, found) in catalogue(&mut Moves(&mut random)) {
        assert!(2 * found >= DRAWN, "{name}: {found} of {DRAWN} laws that were drawn exist");
    }
}
