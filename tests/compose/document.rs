//! The JSON document that other programs read.

use fmm_identify::{Candidate, Experiment, Known, Machine, Preparation, compare};
use serde_json::Value;

use crate::measurement::{LOAD, MASS, release};
use crate::real_records::fork;

fn document(record: &fmm_record::Record, machine: &Machine) -> Value {
    let decay = Experiment::ring_down(record, &Preparation::default()).unwrap();
    serde_json::to_value(compare(machine, &[decay], &Candidate::standard()).unwrap()).unwrap()
}

fn model<'a>(document: &'a Value, law: &str) -> &'a Value {
    let models = document["models"].as_array().expect("models");
    models.iter().find(|model| model["law"] == law).unwrap_or_else(|| panic!("no model {law}"))
}

#[test]
fn per_unit_mass() {
    let document = document(&fork(), &Machine::per_unit_mass());
    assert_eq!(document["preferred"], "coulomb_viscous");
    assert_eq!(document["models"].as_array().unwrap().len(), 3);
    let both = model(&document, "coulomb_viscous");
    for (name, unit) in [("natural_frequency_hz", "Hz"), ("damping_per_mass", "1/s"), ("friction_per_mass", "V/s")] {
        let parameter = &both["parameters"][name];
        assert!(parameter["value"].is_f64() && parameter["u"].is_f64(), "{name}: {parameter}");
        assert_eq!((&parameter["unit"], &parameter["status"]), (&Value::from(unit), &Value::from("fitted")), "{name}");
    }
    assert!(both["rms_residual"].is_f64() && both["aicc"].is_f64());
    assert_eq!((&both["rank"], &both["swings"]), (&Value::from(6), &Value::from(38)));
    assert!(both["stop_time_s"].is_null());
    assert!(both["parameters"].get("mu").is_none());
    assert_eq!(document["preparation"]["samples"], 30_000);
    let warnings = document["warnings"].as_array().expect("warnings");
    assert!(warnings.iter().any(|warning| warning.as_str().is_some_and(|text| text.contains("hence no"))));
}

#[test]
fn with_mass_and_load() {
    let known = |value| Known::exact(value).unwrap();
    let machine = Machine::of_mass(known(MASS)).unwrap().with_normal_load(known(LOAD)).unwrap();
    let document = document(&release(22e-3, 2e-4, 11), &machine);
    let model = model(&document, "coulomb");
    let mu = &model["parameters"]["mu"];
    assert!((mu["value"].as_f64().unwrap() - 0.25).abs() < 0.01, "{mu}");
    assert_eq!(mu["status"], "derived");
    let stop = model["stop_time_s"].as_f64().expect("a stop");
    assert!((2.3..2.5).contains(&stop), "stops at {stop} s");
}
