//! Cost of runs in steps, at any stiffness.

use fmm_friction::{BoucWen, BristleLaw, Dahl, LuGre};
use fmm_model::Oscillator;

use super::*;

/// Attempts at a step for each half cycle of the thesis' machine, two in all, that starts at a `velocity` (m/s).
fn steps<L: BristleLaw<f64>>(law: L, velocity: f64) -> usize {
    let machine = Oscillator::new(10.391, 1982.0).unwrap();
    let scenario = Scenario::new(machine, law, 14.0).unwrap().starting_at(0.026, velocity).unwrap();
    // Shortly after the second turn.
    let sampling = Sampling::uniform(1e-3, 470).unwrap();
    let mut trajectory = Trajectory::new();
    let oscillator = scenario.oscillator();
    let drive = Forcing::of(&scenario);
    let field = Field::new(oscillator, scenario.law(), scenario.normal_load(), drive.belt());
    let recorder = Recorder::new("bristle", scenario.law().states(), &sampling, &mut trajectory).unwrap();
    let steps = Run::new(field, beginning(&scenario), 1e-10, recorder).run(&drive).unwrap();
    steps / trajectory.half_cycles()
}

/// From bristles that bend over a tenth of the motion to some that bend over less than an atom.
#[test]
fn a_half_cycle_takes_as_many_steps_on_stiff_bristles_as_on_soft_ones() {
    for ratio in [1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e8, 1e10] {
        let (level, stiffness) = (0.25, ratio * 0.25 / 0.026);
        let softening = stiffness / level;
        let bristles = || Dahl::new(level, stiffness, 1.0).unwrap();
        let loops = || BoucWen::new(stiffness, 1.0, softening * 0.6, softening * 0.4, 1.0).unwrap();
        for velocity in [0.0, 0.1] {
            let (dahl, bouc_wen) = (steps(bristles(), velocity), steps(loops(), velocity));
            assert!(dahl < 120 && bouc_wen < 120, "σ = {stiffness:e} 1/m: {dahl} and {bouc_wen} steps");
            for (fall_speed, damping) in [(1e-3, 0.0), (0.02, 1.0), (0.05, 0.7), (0.5, 10.0)] {
                let law = LuGre::new(level, level * 1.5, fall_speed, 1.0, stiffness, damping, 0.02).unwrap();
                let lugre = steps(law, velocity);
                assert!(lugre < 300, "σ₀ = {stiffness:e} 1/m, v_s = {fall_speed} m/s: {lugre} steps");
            }
        }
    }
}
