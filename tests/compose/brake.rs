//! A measured band brake: what its two bands hold is the force, at two tensions alike.

use fmm_identify::{Candidate, ForceRecord, Machine, compare};
use fmm_record::Column;

fn record(name: &str) -> ForceRecord {
    let file = fmm_record::open(format!("{}/examples/data/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let column = |name: &str| file.channel(Column::from(name)).unwrap();
    let values = |name: &str| column(name).record.values().to_vec();
    let time = column("force [N]").record;
    let times: Vec<f64> = time.times().collect();
    let record = ForceRecord::of_positions(&times, &values("displacement [m]"), &values("force [N]")).unwrap();
    let record = record.with_velocities(&values("velocity [m/s]")).unwrap();
    let channel =
        |record: ForceRecord, name: &str| record.with_channel(name, &values(&format!("{name} [N]")), 0.02).unwrap();
    channel(channel(record, "band_1"), "band_2")
}

/// By a law of the motion alone a sixth of the force is left; the bands leave a fourteenth, and say the brake under
/// less tension, to which nothing is fitted, as well.
#[test]
fn one_law_says_both_tensions() {
    let (tight, slack) = (record("damper_1Hz_36lb_1amplitude.csv"), record("damper_1Hz_30lb_1amplitude.csv"));
    let models = ["coulomb + linear + asymmetry", "coulomb + linear + zero + inertia + channels"];
    let models = models.map(|name| Candidate::named(name).unwrap());
    let compared = compare(&Machine::per_unit_mass(), std::slice::from_ref(&tight), &models).unwrap();
    let [by_motion, by_bands] = compared.identifications() else { panic!("{compared}") };
    assert_eq!(compared.preferred().law(), by_bands.law(), "{compared}");
    assert!(compared.is_decided() && compared.p_values()[0] < 1e-6, "{compared}");
    // The sensor of a motion has no part in it.
    assert!(!compared.to_string().contains("a filter in the sensor"), "{compared}");
    let share = |record: &ForceRecord| by_bands.validate(record).unwrap().share().unwrap();
    println!("{by_bands}");
    assert!(by_motion.validate(&tight).unwrap().share().unwrap() > 0.15);
    assert!(share(&tight) < 0.07 && share(&slack) < 0.085, "{} {}", share(&tight), share(&slack));
    // Each band holds about twice what is measured in it.
    for (name, sign) in [("share_of_band_1", -1.0), ("share_of_band_2", 1.0)] {
        let finding = by_bands.finding(name).unwrap();
        assert!((1.85..2.2).contains(&(sign * finding.value())), "{name}: {}", finding.value());
    }
}
