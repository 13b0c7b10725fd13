//! A dual number has the value of the plain one.

use fmm_friction::{
    AccelerationCoulomb, Berger, BoucWen, CoulombStatic, CoulombViscous, Dahl, Karnopp, LuGre, Stribeck,
    StribeckLorentzian,
};
use fmm_model::{Damping, Dual, Oscillator, Restoring, Scalar};
use fmm_sim::{Bristle, Channels, Engine, Exact, Excitation, RungeKutta, Sampling, Scenario, Trajectory};

/// A machine, mostly on a belt, under a wave whose amplitude may be zero. `number` makes a value and a direction a
/// number.
fn scenario<D: Scalar, L>(
    kind: usize,
    law: L,
    belt: D,
    seed: &[f64; 6],
    number: impl Fn(f64, usize) -> D,
) -> Scenario<D, L> {
    let machine = Oscillator::new(number(seed[0], 0), number(seed[1], 1)).unwrap();
    let machine = match kind {
        0 | 1 => machine.with_damping(Damping::linear(number(0.3, 2)).unwrap()),
        2 => machine.with_damping(Damping::new(number(0.3, 2), number(0.2, 2)).unwrap()),
        3 => machine.with_restoring(Restoring::sine(number(0.3, 2)).unwrap()),
        _ => machine,
    };
    let scenario = Scenario::new(machine, law, number(10.0, 3)).unwrap();
    let scenario = scenario.starting_at(number(seed[2], 4), number(seed[3], 5)).unwrap();
    let scenario = if kind == 1 { scenario } else { scenario.driven_by(Excitation::belt(belt).unwrap()) };
    scenario.driven_by(Excitation::harmonic(number(seed[4], 6), number(seed[5], 7), number(0.3, 8)).unwrap())
}

fn compare(plain: &Trajectory, dual: &Trajectory<Dual<10>>, case: &str) {
    assert_eq!(plain.position().values(), dual.position().values(), "{case}");
    assert_eq!(plain.velocity().values(), dual.velocity().values(), "{case}");
    assert_eq!(plain.acceleration().values(), dual.acceleration().values(), "{case}");
    let times: Vec<f64> = plain.events().iter().map(|event| event.time).collect();
    assert_eq!(times, dual.events().iter().map(|event| event.time.value()).collect::<Vec<_>>(), "{case}");
}

/// Numbers in (0, 1) that look random.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

macro_rules! same {
    ($engine:expr, $case:expr, $law:expr, $($parameter:expr),+) => {{
        let sampling = Sampling::uniform(0.013, 300).unwrap().keeping(Channels::All);
        let mut draws = Draws(7);
        for index in 0..24 {
            let mut draw = |least: f64, most: f64| least * (most / least).powf(draws.next());
            let wave = if index % 2 == 0 { 0.0 } else { draw(0.1, 10.0) };
            let (kind, mass, stiffness) = (index % 6, draw(0.5, 20.0), draw(30.0, 3e3));
            let seed = [mass, stiffness, draw(1e-3, 0.1), draw(1e-2, 0.5), wave, draw(1.0, 30.0)];
            let belt = draw(1e-2, 1.0) * if index % 4 < 2 { 1.0 } else { -1.0 };
            let case = format!("{}, {index}, belt {belt} m/s, {seed:?}", $case);
            let plain = scenario(kind, $law($($parameter),+).unwrap(), belt, &seed, |value, _| value);
            let number = Dual::<10>::variable;
            let law = $law($(Dual::from($parameter)),+).unwrap();
            let dual = scenario(kind, law, number(belt, 9), &seed, number);
            match ($engine.run(&plain, &sampling), $engine.run(&dual, &sampling)) {
                (Ok(plain), Ok(dual)) => compare(&plain, &dual, &case),
                (plain, dual) => assert_eq!(plain.err(), dual.err(), "{case}"),
            }
        }
    }};
}

#[test]
fn values_are_those_of_plain_numbers() {
    same!(Exact, "exact", CoulombStatic::new, 0.2, 0.35);
    same!(Exact, "exact", CoulombViscous::new, 0.2, 0.1);
    same!(Exact, "exact", AccelerationCoulomb::new, 0.3, 0.2);
    same!(RungeKutta::default(), "runge_kutta coulomb", CoulombStatic::new, 0.2, 0.35);
    same!(RungeKutta::default(), "runge_kutta stribeck", Stribeck::new, 0.2, 0.3, 0.1, 1.0, 0.05);
    same!(RungeKutta::default(), "runge_kutta lorentz", StribeckLorentzian::new, 0.2, 0.3, 0.1, 0.05);
    same!(RungeKutta::default(), "runge_kutta acceleration", AccelerationCoulomb::new, 0.3, 0.2);
    same!(RungeKutta::default(), "runge_kutta karnopp", Karnopp::new, 0.2, 0.3, 0.01);
    same!(RungeKutta::default(), "runge_kutta berger", Berger::new, 0.2, 0.1, 3.0);
    same!(Bristle::default(), "bristle dahl", Dahl::new, 0.2, 1e3, 1.0);
    same!(Bristle::default(), "bristle bouc", BoucWen::new, 1e3, 1.0, 2e3, 1e3, 1.0);
    same!(Bristle::default(), "bristle lugre", LuGre::new, 0.2, 0.3, 0.1, 2.0, 1e4, 30.0, 0.1);
}
