//! Driven motion: the law comes back from a measured force or a measured motion of the base.

use fmm_friction::CoulombViscous;
use fmm_identify::{Drive, Experiment, IdentifyError, Known, Machine, Preparation, Source, Warning, identify};
use fmm_record::{Quantity, Record};

use crate::simulated::{INTERVAL, LOAD, MASS, Motion, STIFFNESS, machine, record, share_inside};

const SAMPLES: usize = 3000;
const COEFFICIENT: f64 = 0.25;
const SLOPE: f64 = 0.1;

/// Inertial force of a base that moves harmonically at 0.9 of the resonance.
fn force_of_base(amplitude: f64) -> Vec<f64> {
    let angular = 0.9 * (STIFFNESS / MASS).sqrt();
    let at = |i: usize| MASS * amplitude * angular * angular * (angular * i as f64 * INTERVAL).cos();
    (0..SAMPLES).map(at).collect()
}

fn motion(force: &[f64]) -> fmm_sim::Trajectory {
    let law = [COEFFICIENT, SLOPE];
    let (damping, initial) = (0.0, (0.0, 0.0));
    let motion =
        Motion { damping, law: &law, load: LOAD, initial, force: Some(force), samples: SAMPLES, interval: INTERVAL };
    motion.of::<CoulombViscous>()
}

/// Base of 6 mm: the machine sticks between its swings, the contact holds 3.5 N.
#[test]
fn stick_slip_on_a_base_gives_the_law_back() {
    let force = force_of_base(2.6e-3);
    let motion = motion(&force);
    assert!(motion.events().iter().any(|event| event.next == fmm_sim::Mode::Stick), "it sticks");
    let base: Vec<f64> = force.iter().map(|force| -force / MASS).collect();
    let base = Record::new(0.0, INTERVAL, base, Quantity::Acceleration, "m/s²").unwrap();
    let machine = machine();
    let mut inside = 0.0;
    let share = share_inside(COEFFICIENT, 200, |seed| {
        let response = record(motion.velocity().values(), 1e-3, seed, Quantity::Velocity, "m/s");
        let experiment = Experiment::driven(&response, Drive::base(&base).unwrap(), &Preparation::default()).unwrap();
        let found = identify::<CoulombViscous>(&machine, &[experiment]).unwrap();
        let (low, high) = found.interval("damping_per_mass", 0.95).unwrap();
        inside += f64::from(u8::from((low..=high).contains(&(SLOPE * LOAD / MASS)))) / 200.0;
        found.interval("mu", 0.95).unwrap()
    });
    println!("mu {share}, damping {inside}");
    assert!((0.92..=0.98).contains(&share) && (0.92..=0.98).contains(&inside), "{share} {inside}");
}

/// A measured force tells mass, stiffness and friction in N, of displacements and velocities.
#[test]
fn a_force_tells_the_scale() {
    let force = force_of_base(8e-3);
    let motion = motion(&force);
    let drive = Drive::force(&Record::new(0.0, INTERVAL, force, Quantity::Force, "N").unwrap()).unwrap();
    for (values, noise, quantity, unit) in [
        (motion.velocity().values(), 1e-3, Quantity::Velocity, "m/s"),
        (motion.position().values(), 5e-6, Quantity::Displacement, "m"),
    ] {
        let response = record(values, noise, 7, quantity, unit);
        let experiment = Experiment::driven(&response, drive.clone(), &Preparation::default()).unwrap();
        let found = identify::<CoulombViscous>(&Machine::unknown(), std::slice::from_ref(&experiment)).unwrap();
        println!("{found}");
        for (name, truth) in [
            ("mass", MASS),
            ("stiffness", STIFFNESS),
            ("friction_force", COEFFICIENT * LOAD),
            ("damping", SLOPE * LOAD),
        ] {
            let finding = found.finding(name).unwrap();
            let (error, u) = ((finding.value() - truth).abs(), finding.uncertainty().unwrap());
            assert!(error < 3.5 * u && u < 0.1 * truth, "{quantity}: {name} = {} ± {u}", finding.value());
        }
        let refused = identify::<CoulombViscous>(&Machine::per_unit_mass(), &[experiment]);
        assert!(matches!(refused, Err(IdentifyError::Contradiction { .. })), "{refused:?}");
    }
}

/// Beside an exact force the record tells the mass: one that is given is one more observation of it, and what it leaves
/// open is a part of each uncertainty.
#[test]
fn a_mass_that_is_given_is_one_more_observation() {
    let force = force_of_base(8e-3);
    let motion = motion(&force);
    let drive = Drive::force(&Record::new(0.0, INTERVAL, force, Quantity::Force, "N").unwrap()).unwrap();
    let response = record(motion.velocity().values(), 1e-3, 7, Quantity::Velocity, "m/s");
    let experiment = [Experiment::driven(&response, drive, &Preparation::default()).unwrap()];
    let of = |machine: &Machine| identify::<CoulombViscous>(machine, &experiment).unwrap();
    let given = |u: f64| of(&Machine::of_mass(Known::new(MASS, u).unwrap()).unwrap());
    let (alone, exact) = (of(&Machine::unknown()), given(0.0));
    let u = |found: &fmm_identify::Identification, name: &str| found.finding(name).unwrap().uncertainty().unwrap();
    // Two independent observations: 1/u² is the sum of both.
    let of_record = u(&alone, "mass");
    for given_u in [0.3 * of_record, of_record, 3.0 * of_record] {
        let both = given(given_u);
        let expected = (of_record.powi(-2) + given_u.powi(-2)).powf(-0.5);
        assert!((u(&both, "mass") / expected - 1.0).abs() < 0.02, "{} for {expected}", u(&both, "mass"));
        let friction = both.finding("friction_force").unwrap();
        let budget = friction.budget().unwrap();
        let by_mass = budget.contributions().find(|part| part.input.name() == Source::Mass.to_string()).unwrap();
        assert!(by_mass.uncertainty > 0.0 && by_mass.share < 1.0, "{by_mass:?}");
        let (least, most) = (u(&exact, "friction_force"), u(&alone, "friction_force"));
        let found = u(&both, "friction_force");
        assert!(least < found && found < 1.01 * most, "{least} {found} {most}");
    }
    // A mass that is far from what the record shows is said to be.
    let wrong = of(&Machine::of_mass(Known::new(1.1 * MASS, 0.01 * MASS).unwrap()).unwrap());
    let is_said =
        |warning: &Warning| matches!(warning, Warning::KnowledgeContradicted { parameter, .. } if parameter == "mass");
    assert!(wrong.warnings().iter().any(is_said), "{wrong}");
}

#[test]
fn drives_that_do_not_fit_are_refused() {
    let force = force_of_base(8e-3);
    let motion = motion(&force);
    let response = record(motion.velocity().values(), 1e-3, 1, Quantity::Velocity, "m/s");
    let short = Record::new(0.0, INTERVAL, force[..2000].to_vec(), Quantity::Force, "N").unwrap();
    let refused = Experiment::driven(&response, Drive::force(&short).unwrap(), &Preparation::default());
    assert!(matches!(refused, Err(IdentifyError::NotSeen { .. })), "{refused:?}");
    let kept = Experiment::driven(&response, Drive::force(&short).unwrap(), &Preparation::default().to(1.9));
    assert!(kept.is_ok(), "{kept:?}");
    let volts = Record::new(0.0, INTERVAL, force, Quantity::Other, "V").unwrap();
    assert!(Drive::force(&volts).is_err() && Drive::base(&volts).is_err());
    // A force in N moves no radians.
    let force = Drive::force(&Record::new(0.0, INTERVAL, vec![1.0; SAMPLES], Quantity::Force, "N").unwrap()).unwrap();
    let angular = response.clone().with_unit("rad/s");
    let experiment = Experiment::driven(&angular, force, &Preparation::default()).unwrap();
    let refused = identify::<CoulombViscous>(&Machine::unknown(), &[experiment]);
    assert!(
        matches!(refused, Err(IdentifyError::WrongRecord { ref what }) if what.starts_with("the drive")),
        "{refused:?}"
    );
}
