//! One motion in other units, and with changes far below its noise: the statement stays.

use fmm_friction::{Coulomb, CoulombViscous, FamilyMember, Stribeck};
use fmm_identify::{Comparison, Experiment, Known, Machine, Preparation, search};
use fmm_model::{Oscillator, Restoring};
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, simulate};

use crate::simulated::{INTERVAL, record};

/// Change of a finding over its standard uncertainty that is none (1).
const UNCHANGED: f64 = 0.01;

/// 10 kg at 2 Hz under 140 N, released at 0.1 m: 2 s at 1 kHz with 0.05 mm of noise.
fn motion<L: FamilyMember<Number = f64>>(law: L, cubic: f64, seed: u64) -> Vec<f64> {
    let stiffness = 10.0 * (std::f64::consts::TAU * 2.0f64).powi(2);
    let spring = Restoring::polynomial(cubic, 0.0).unwrap();
    let machine = Oscillator::new(10.0, stiffness).unwrap().with_restoring(spring);
    let scenario = Scenario::new(machine, law, 140.0).unwrap().starting_at(0.1, 0.0).unwrap();
    let motion = simulate(&scenario, &Sampling::uniform(INTERVAL, 2000).unwrap()).unwrap();
    record(motion.position().values(), 5e-5, seed, Quantity::Displacement, "m").values().to_vec()
}

fn stated(positions: Vec<f64>, unit: &str) -> Comparison {
    let machine = Machine::of_mass(Known::exact(10.0).unwrap()).unwrap();
    let machine = machine.with_normal_load(Known::exact(140.0).unwrap()).unwrap();
    let record = Record::new(0.0, INTERVAL, positions, Quantity::Displacement, unit).unwrap();
    search(&machine, &[Experiment::ring_down(&record, &Preparation::default()).unwrap()]).unwrap()
}

/// Both name the same law, exclude the same laws, and state the same numbers where these have no unit or one of time.
fn agrees(name: &str, one: &Comparison, other: &Comparison, are_units_equal: bool) {
    assert_eq!(one.preferred().law(), other.preferred().law(), "{name}: {one}\n{other}");
    assert_eq!(one.is_decided(), other.is_decided(), "{name}: {one}\n{other}");
    let mut compared = 0;
    for finding in one.preferred().findings() {
        let unit = finding.parameter().unit().to_string();
        if !(are_units_equal || ["1", "Hz", "1/s", "N", "N s/m", "N/m"].contains(&unit.as_str())) {
            continue;
        }
        let same = other.preferred().finding(finding.parameter().name());
        // A coefficient and a force take metres.
        if same.is_none() && !are_units_equal {
            continue;
        }
        let same = same.unwrap_or_else(|| panic!("{name}: {finding} is stated once\n{one}\n{other}"));
        let (Some(u), Some(other_u)) = (finding.uncertainty(), same.uncertainty()) else { continue };
        let off = (finding.value() - same.value()).abs() / u;
        assert!(off < UNCHANGED, "{name}: {finding} and {same}: {off} u\n{one}");
        assert!((other_u / u - 1.0).abs() < UNCHANGED, "{name}: {finding} and {same}");
        compared += 1;
    }
    assert!(compared > 1, "{name}: {one}");
}

#[test]
fn units_and_rounding_change_no_statement() {
    let stribeck = Stribeck::new(0.05, 0.075, 0.08, 2.0, 0.01).unwrap();
    let motions = [
        ("coulomb", motion(Coulomb::new(0.06).unwrap(), 0.0, 1)),
        ("coulomb_viscous", motion(CoulombViscous::new(0.05, 0.04).unwrap(), 0.0, 2)),
        ("viscous", motion(CoulombViscous::new(0.0, 0.1).unwrap(), 0.0, 3)),
        ("stribeck", motion(stribeck, 0.0, 4)),
        ("bent spring", motion(CoulombViscous::new(0.05, 0.04).unwrap(), -8.0, 5)),
        ("stribeck on a bent spring", motion(stribeck, -8.0, 6)),
    ];
    for (name, motion) in motions {
        let stated_in_metres = stated(motion.clone(), "m");
        let in_millimetres = stated(motion.iter().map(|x| 1e3 * x).collect(), "mm");
        agrees(name, &stated_in_metres, &in_millimetres, false);
        let changed = motion.iter().enumerate().map(|(i, x)| x * (1.0 + 1e-9 * ((i * 7919) % 3) as f64));
        agrees(name, &stated_in_metres, &stated(changed.collect(), "m"), true);
    }
}
