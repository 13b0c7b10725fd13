//! A film of a slip played backwards.

use fmm_friction::Coulomb;
use fmm_model::Oscillator;
use fmm_sim::{Engine, Exact, Excitation, Mode, RungeKutta, Sampling, Scenario, State, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::case::log_uniform;

/// One stretch of sliding in one direction, at its beginning and after `duration`.
struct Slip {
    machine: Oscillator,
    friction: f64,
    /// Amplitude (N), angular frequency (rad/s) and phase (rad).
    wave: [f64; 3],
    begin: State,
    duration: f64,
}

impl Slip {
    fn draw(random: &mut ChaCha8Rng) -> Self {
        let (mass, angular) = (log_uniform(random, -3.0, 3.0), 6.3 * log_uniform(random, -1.0, 3.0));
        let (length, stiffness) = (log_uniform(random, -6.0, 0.0), mass * angular * angular);
        let force = stiffness * length;
        let wave_angular = angular * random.random_range(0.1..0.8);
        let wave = [force * random.random_range(0.0..1.0), wave_angular, random.random_range(-3.0..3.0)];
        let begin = State { position: length * random.random_range(-1.0..1.0), velocity: length * angular };
        let friction = force * log_uniform(random, -2.0, 0.0);
        let duration = random.random_range(0.05..1.0) / angular;
        Self { machine: Oscillator::new(mass, stiffness).unwrap(), friction, wave, begin, duration }
    }

    /// The motion from `begin` under the wave and a constant `extra` force.
    fn run(&self, stepped: bool, begin: State, wave: [f64; 3], extra: f64) -> Trajectory {
        let scenario = Scenario::new(self.machine, Coulomb::new(self.friction).unwrap(), 1.0)
            .and_then(|scenario| scenario.starting_at(begin.position, begin.velocity))
            .unwrap()
            .driven_by(Excitation::harmonic(wave[0], wave[1], wave[2]).unwrap())
            .driven_by(Excitation::harmonic(extra, 0.0, 0.0).unwrap());
        let sampling = Sampling::at(vec![self.duration]).unwrap();
        if stepped { RungeKutta::default().run(&scenario, &sampling) } else { Exact.run(&scenario, &sampling) }.unwrap()
    }
}

/// Backwards in time friction drives the motion: m y″ + k y + F = f(T − τ) for a slip with a friction of +F, y′ being
/// negative. A slip backwards has −F, so that a constant force of −2 F makes up for it.
#[test]
fn a_slip_played_backwards_returns_to_its_start() {
    let mut random = ChaCha8Rng::seed_from_u64(121);
    let mut checked = 0;
    for _ in 0..3000 {
        let slip = Slip::draw(&mut random);
        for stepped in [false, true] {
            let forth = slip.run(stepped, slip.begin, slip.wave, 0.0);
            if forth.events().len() > 1 || !matches!(forth.events()[0].next, Mode::Slip(_)) {
                continue;
            }
            let end = State { position: forth.position().values()[0], velocity: -forth.velocity().values()[0] };
            let [amplitude, angular, phase] = slip.wave;
            let mirrored = [amplitude, angular, -(angular * slip.duration + phase)];
            let back = slip.run(stepped, end, mirrored, -2.0 * slip.friction);
            assert_eq!(back.events().len(), 1, "{:?}", back.events());
            let natural = slip.machine.natural_angular_frequency();
            let size = slip.begin.position.abs().max(slip.begin.velocity / natural);
            let off = [
                back.position().values()[0] - slip.begin.position,
                (back.velocity().values()[0] + slip.begin.velocity) / natural,
            ];
            let error = off[0].abs().max(off[1].abs()) / size;
            assert!(error < 1e-12, "{error:e} of the amplitude off, stepped: {stepped}");
            checked += 1;
        }
    }
    assert!(checked > 2000, "{checked} slips");
}
