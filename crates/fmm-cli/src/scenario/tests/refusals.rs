//! Scenarios that should be refused, each with its reason and what would be right.

use super::{run, with};
use crate::scenario::laws;

fn refused(scenario: &str) -> String {
    run(scenario).expect_err(scenario).to_string()
}

#[test]
fn no_key_means_two_parameters() {
    for entry in laws() {
        let slots = (entry.slots)();
        for (index, slot) in slots.iter().enumerate() {
            assert!(
                slot.is(slot.name) && slot.is(slot.symbol) || slot.symbol.is_empty(),
                "{} {}",
                entry.name,
                slot.name
            );
            for key in slot.keys() {
                assert!(key.is_ascii(), "{}: {key}", entry.name);
                let others = slots[index + 1..].iter().filter(|other| other.is(&key)).count();
                assert_eq!(others, 0, "{}: {key} is {} and another", entry.name, slot.name);
            }
        }
    }
    let keys = ["coefficient", "excess_coefficient", "decay"].map(String::from);
    let berger = laws().into_iter().find(|entry| entry.name == "berger").unwrap();
    for (slot, (name, symbol)) in (berger.slots)().iter().zip(keys.iter().zip(["mu0", "mu1", "alpha"])) {
        assert!(slot.keys().contains(name) && slot.is(symbol), "{name}");
    }
}

/// A value for each law, one parameter being left out or misspelt.
#[test]
fn every_law_says_what_it_needs() {
    for entry in laws() {
        let name = entry.name;
        let said = refused(&with(&format!(r#""law": {{"{name}": {{"nonsense": 1}}}}, "duration": 1"#)));
        assert!(said.contains("no parameter \"nonsense\""), "{said}");
        for slot in (entry.slots)() {
            assert!(said.contains(slot.name), "{name}: {said}");
        }
        let said = refused(&with(&format!(r#""law": {{"{name}": {{}}}}, "duration": 1"#)));
        let first = (entry.slots)().into_iter().find(|slot| slot.default.is_none()).unwrap();
        assert!(said.contains(&format!("needs {}", first.description())), "{name}: {said}");
    }
}

#[test]
fn unknown_names_are_answered_with_the_valid_ones() {
    let said = refused(&with(r#""law": {"colomb": {"mu": 0.1}}, "duration": 1"#));
    assert!(said.contains("no law \"colomb\""), "{said}");
    for entry in laws() {
        assert!(said.contains(entry.name), "{said}");
    }
    for (scenario, wrong, valid) in [
        (
            with(r#""friction": 1, "duration": 1"#),
            "`friction`",
            vec!["`law`", "`normal_load`", "`excitation`", "`output`"],
        ),
        (with(r#""duration": 1, "initial": {"x": 1}"#), "`x`", vec!["`position`", "`velocity`"]),
        (
            with(r#""duration": 1, "excitation": [{"hammer": {}}]"#),
            "`hammer`",
            vec!["`half_sine`", "`sampled_force`", "`belt`"],
        ),
        (
            with(r#""duration": 1, "excitation": [{"ramp": {"rate": 1, "peak": 1}}]"#),
            "`peak`",
            vec!["`rate`", "`delay`"],
        ),
        (
            with(r#""duration": 1, "engine": "euler""#),
            "`euler`",
            vec!["`auto`", "`exact`", "`runge_kutta`", "`bristle`", "`thesis`", "`moreau`"],
        ),
        (with(r#""duration": 1, "output": {"every": 1}"#), "`every`", vec!["`times`", "`rate`"]),
        (
            r#"{"oscillator": {"mass": 1, "k": 1}, "duration": 1}"#.to_owned(),
            "`k`",
            vec!["`mass`", "`stiffness`", "`damping`", "`restoring`"],
        ),
        (
            r#"{"oscillator": {"mass": 1, "stiffness": 1, "damping": {"viscous": 1}}, "duration": 1}"#.to_owned(),
            "`viscous`",
            vec!["`linear`", "`quadratic`", "`cubic`", "`power`", "`peak_velocity_line`"],
        ),
    ] {
        let said = refused(&scenario);
        assert!(said.contains(wrong), "{said}");
        for name in valid {
            assert!(said.contains(name), "{name}: {said}");
        }
    }
}

#[test]
fn wrong_values_are_answered_with_what_would_be_right() {
    let law = |law: &str| with(&format!(r#""law": {law}, "duration": 1"#));
    for (scenario, said) in [
        ("mass = 1".to_owned(), "cannot be read"),
        (String::new(), "cannot be read"),
        (with(r#""duration": 1e999"#), "number out of range"),
        (with(r#""duration": NaN"#), "cannot be read"),
        (with(r#""duration": 1, "duration": 2"#), "duplicate field `duration`"),
        (with(""), "cannot be read"),
        (r#"{"oscillator": {"mass": 1, "stiffness": 1}}"#.to_owned(), "needs a duration"),
        (r#"{"oscillator": {"mass": 1}, "duration": 1}"#.to_owned(), "missing field `stiffness`"),
        (r#"{"oscillator": {"mass": -1, "stiffness": 1}, "duration": 1}"#.to_owned(), "mass must be positive and \
            finite, but is -1 kg"),
        (r#"{"oscillator": {"mass": 1, "stiffness": 1, "damping": {"linear": 1, "peak_velocity_line": {"intercept": 1, "slope": 1}}}, "duration": 1}"#.to_owned(), "not by both ways"),
        (r#"{"oscillator": {"mass": 1, "stiffness": 1, "restoring": {"sine": {"length": 0}}}, "duration": 1}"#.to_owned(), "must be positive"),
        (with(r#""duration": 0"#), "duration must be positive"),
        (with(r#""duration": -1, "output": {"times": [0]}"#), "duration must be positive"),
        (with(r#""normal_load": -1, "duration": 1"#), "normal load must be zero or positive"),
        (with(r#""output": {"times": []}"#), "must lie between 1 and"),
        (with(r#""duration": 1, "output": {"times": []}"#), "must lie between 1 and"),
        (with(r#""output": {"times": [0, 2, 1]}"#), "time 2 is 1 s after 2 s"),
        (with(r#""output": {"times": [-1, 2]}"#), "time 0 is -1 s"),
        (with(r#""duration": 1, "output": {"rate": 0}"#), "rate of the output must be positive"),
        (with(r#""duration": 1, "output": {"rate": 1e8}"#), "100000001 samples were asked for"),
        (with(r#""duration": 1e300, "output": {"rate": 1e300}"#), "samples were asked for"),
        (with(r#""duration": 1e300, "output": {"rate": 1}"#), "1e300 samples were asked for"),
        (with(r#""duration": 1, "engine": "runge_kutta", "tolerance": 1e-30"#), "but is 1e-30"),
        (with(r#""duration": 1, "excitation": [{"half_sine": {"peak": 1, "duration": 0}}]"#), "pulse duration must be \
            positive"),
        (with(r#""duration": 1, "excitation": [{"half_sine": {"peak": 1}}]"#), "missing field `duration`"),
        (with(r#""duration": 1, "engine": "exact", "tolerance": 1e-9"#), "runge_kutta and bristle"),
        (with(r#""duration": 1, "engine": "runge_kutta", "tolerance": 1"#), "between 1e-15 and 1e-2"),
        ("[]".to_owned(), "expected a scenario, which is an object"),
        (with(r#""duration": 1, "engine": "bristle""#), "the engine bristle needs a law, and none was given; without \
                                                         one the engines are auto, exact"),
        (with(r#""duration": 1, "excitation": [{"sampled_force": {"interval": 0.1, "values": []}}]"#), "a sampled \
            force needs one value"),
        (r#"{"oscillator": {"mass": 1, "stiffness": 1, "damping": {"peak_velocity_line": {"intercept": 1, "slope": -1}}}, "duration": 1}"#.to_owned(), "slope of damping over peak velocity must be zero or positive and finite, but is -1"),
        (law(r#"{"dahl": {"mu": 1, "sigma": 1, "exponent": 0}}"#), "dahl: exponent must be greater than 0, but is 0"),
        (law("{}"), "an object with one key"),
        (law("[1]"), "an object with one key"),
        (law(r#"{"coulomb": 0.1}"#), "an object with one key"),
        (law(r#"{"coulomb": {"mu": 0.1}, "viscous": {"viscous": 1}}"#), "an object with one key"),
        (law(r#"{"coulomb": {"mu": "high"}}"#), "expected a number"),
        (law(r#"{"coulomb": {"mu": 0.1, "mu": 0.2}}"#), "duplicate field `mu`"),
        (law(r#"{"coulomb": {"mu": 0.1, "coefficient": 0.2}}"#), "coefficient twice"),
        (law(r#"{"coulomb": {"mu": -0.1}}"#), "coulomb: coefficient must be at least 0, but is -0.1"),
        (law(r#"{"coulomb": {"mu": [0.1]}}"#), "must be a number"),
        (law(r#"{"coulomb_static": {"mu_d": 0.2, "mu_s": 0.1}}"#), "must not be below"),
        (law(r#"{"maxwell_slip": {"stiffness": 1, "level": [1]}}"#), "must be a list of numbers"),
        (law(r#"{"maxwell_slip": {"stiffness": [1, 2], "level": [1]}}"#), "2 stiffnesses and 1 others"),
        (law(r#"{"maxwell_slip": {"stiffness": [], "level": []}}"#), "1 to 64"),
        (law(r#"{"smoothed": {"law": {"coulomb": {}}, "width": 1}}"#), "coulomb needs coefficient"),
        (law(r#"{"smoothed": {"law": 1, "width": 1}}"#), "must be a law"),
        (law(r#"{"smoothed": {"law": {"dahl": {"mu": 1, "sigma": 1}}, "width": 1}}"#), "cannot be smoothed"),
        (law(r#"{"smoothed": {"law": {"dahl": {"mu": 1, "sigma": 1}}, "width": 1}}"#), "a law of the speed alone can, \
            such as coulomb or stribeck"),
        (law(r#"{"smoothed": {"law": {"acceleration_coulomb": {"mu1": 1, "mu2": 1}}, "width": 1}}"#), "depends on the \
            acceleration"),
    ] {
        let message = refused(&scenario);
        assert!(message.contains(said), "{scenario} gave: {message}");
    }
    let deep = format!("{}{}", r#"{"smoothed": {"law": "#.repeat(100_000), "1");
    assert!(refused(&law(&deep)).contains("recursion limit"));
}
