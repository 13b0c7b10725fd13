//! Friction curves of campaigns: what is pooled, what is shared, and what has no mean.

use super::*;

/// The summary of runs with these lines of a manifest, its text and its page.
fn summary(home: &Path, manifest: &str) -> (Campaign, Vec<Row>, Summary) {
    std::fs::write(home.join("runs.csv"), manifest).unwrap();
    let campaign = Campaign::of_manifest(&home.join("runs.csv"), law(), None, &Host::default()).unwrap();
    let rows = rows(&campaign);
    let summary = Summary::of(&campaign, &rows, &NOTHING, None);
    (campaign, rows, summary)
}

/// Six runs under one load have one curve, in which the load and the smoothness that all are given stay, and which text,
/// table and page show.
#[test]
fn curves_are_pooled_and_what_they_share_stays() {
    let home = folder("pooled");
    records(&home, &[0.02, 0.0202, 0.0199, 0.0201, 0.0198, 0.0200]);
    let mut manifest = "file,mass,normal_load,normal_load_u\n".to_owned();
    for run in 0..6 {
        manifest.extend([format!("run_{run:02}.csv,10,2,0.01\n")]);
    }
    let (campaign, rows, summary) = summary(&home, &manifest);
    let pooled = summary.friction_curve.as_ref().unwrap();
    let [curve] = pooled.curves.as_slice() else { panic!("{pooled:?}") };
    assert_eq!((curve.unit.as_str(), curve.records.len(), pooled.left_out.len()), ("1", 6, 0), "{pooled:?}");
    let speeds: Vec<f64> = curve.levels.iter().filter_map(|level| level.speed).collect();
    assert_eq!(speeds, [0.005, 0.01, 0.02, 0.05, 0.1, 0.2]);
    for level in &curve.levels {
        let friction = &level.friction;
        // μ = 0.1 + 0.25 s/m v by friction and damping per mass, 10 kg and 2 N.
        if let Some(speed) = level.speed {
            let truth = 0.1 + 0.25 * speed;
            let [low, high] = friction.interval_95;
            assert!((low..=high).contains(&truth), "{truth} at {speed}: {friction:?}");
        }
        let by_load = friction.shared.iter().find(|part| part.input.source == "normal load").unwrap();
        assert!(by_load.records == 6 && (by_load.u / (0.005 * friction.mean) - 1.0).abs() < 0.02, "{friction:?}");
        assert!(friction.shared_u >= by_load.u && friction.u > friction.shared_u && level.over_load.is_none());
    }
    let smoothness = |level: &super::super::pooled::PooledLevel| {
        level.friction.shared.iter().find(|part| part.input.source == "smoothness of the curve").map(|part| part.u)
    };
    assert!(curve.levels[0].speed.is_none() && smoothness(&curve.levels[0]) > smoothness(&curve.levels[1]));
    let text = table::text(&rows, &summary);
    assert!(
        text.contains("friction over speed, no law assumed, of 6 records;") && text.contains("at 0.05 m/s"),
        "{text}"
    );
    let page = page::page(&campaign, &rows, &summary);
    assert!(page.contains("id=\"friction_curve-0\"") && page.contains("<h2>Friction over speed</h2>"), "{page}");
    let csv = table::csv(&campaign, &rows).unwrap();
    assert!(csv.lines().next().unwrap().contains("friction_over_path [1],u(friction_over_path) [1]"), "{csv}");
    // Without curves nothing is said of them.
    let campaign = Campaign { without_curves: true, ..campaign };
    let rows = super::rows(&campaign);
    let summary = Summary::of(&campaign, &rows, &NOTHING, None);
    assert!(rows.iter().all(|row| row.found().is_some() && row.curve().is_none()) && summary.friction_curve.is_none());
    assert!(!table::text(&rows, &summary).contains("friction over speed"));
}

/// The contributions of a row between two levels are nearly those of the curve itself, and never less by much.
#[test]
fn a_row_tells_its_curve_between_the_levels() {
    use fmm_identify::{Experiment, FrictionCurve, Machine, Preparation};
    let home = folder("between");
    let path = records(&home, &[0.02]).remove(0);
    let file = fmm_record::open(path).unwrap();
    let record = file.channel("v [mm/s]").unwrap().record.with_quantity(fmm_record::Quantity::Velocity);
    let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
    let curve = FrictionCurve::of(&Machine::per_unit_mass(), &[decay]).unwrap();
    let row = curve::RowCurve::of(&curve, std::iter::empty());
    for pair in curve.speeds().windows(2) {
        let speed = 0.5 * (pair[0] + pair[1]);
        let (told, level) = (row.at(speed).unwrap(), curve.at(speed).unwrap());
        let ratio = told.u.unwrap() / level.uncertainty();
        // Levels are cut off at zero, and near rest that is seen.
        let off = (told.value - level.value()).abs() / level.uncertainty();
        assert!(off < 0.05 && (0.97..1.2).contains(&ratio), "{ratio}, {off} at {speed}");
    }
    assert!(row.at(1.01 * row.top()).is_none() && row.at(row.top()).is_some());
}

/// A coefficient is pooled over all loads, with the force against the load beside it; forces have a curve for each
/// load; what differs in kind has none, and says so.
#[test]
fn what_differs_is_not_mixed() {
    let home = folder("kinds");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None, &Host::default()).unwrap();
    let mut rows = rows(&campaign);
    let summary = Summary::of(&campaign, &rows, &NOTHING, None);
    let pooled = summary.friction_curve.as_ref().unwrap();
    let [curve] = pooled.curves.as_slice() else { panic!("{pooled:?}") };
    for level in &curve.levels {
        let line = level.over_load.as_ref().unwrap().line.as_ref().unwrap();
        let (low, high) = line.intercept_interval_95.unwrap();
        // Damping per mass is that of the machine, and does not go with the load: it is a force without load.
        let truth = level.speed.map_or(0.0, |speed| 10.0 * 0.05 * speed);
        if level.speed.is_some() {
            assert!(low - 0.01 < truth && truth < high + 0.01, "{truth} at {:?}: {line:?}", level.speed);
        }
    }
    assert!(table::text(&rows, &summary).contains("force without load / N (p)"));
    // Each load has its forces, where there is no coefficient.
    let per_mass = |row: &mut Row| {
        let Outcome::Found(found) = &mut row.outcome else { panic!("{row:?}") };
        let Outcome::Found(curve) = &mut found.friction_curve else { panic!("{found:?}") };
        curve.unit = "m/s²".to_owned();
        curve.stated.iter_mut().for_each(|told| told.unit = "m/s²".to_owned());
    };
    per_mass(&mut rows[0]);
    let mixed = Summary::of(&campaign, &rows, &NOTHING, None);
    let text = table::text(&rows, &mixed);
    let why =
        "curves of different kinds have no mean: friction / (m/s²) over m/s (1), friction coefficient over m/s (5)";
    assert!(mixed.friction_curve.unwrap().curves.is_empty() && text.contains(why), "{text}");
    rows[1..].iter_mut().for_each(per_mass);
    let forces = Summary::of(&campaign, &rows, &NOTHING, None).friction_curve.unwrap();
    let loads: Vec<_> = forces.curves.iter().map(|curve| (curve.loads, curve.records.len())).collect();
    assert_eq!(loads, [(Some((2.0, 2.0)), 2), (Some((4.0, 4.0)), 2), (Some((8.0, 8.0)), 2)]);
    // A curve that is doubted, or that cannot be made, is named and does not count; its record does.
    if let Outcome::Found(found) = &mut rows[1].outcome {
        found.friction_curve = Outcome::Refused("the record does not tell".to_owned());
    }
    if let Outcome::Found(found) = &mut rows[3].outcome
        && let Outcome::Found(curve) = &mut found.friction_curve
    {
        curve.limits = vec!["something beside friction acts".to_owned()];
    }
    let fewer = Summary::of(&campaign, &rows, &NOTHING, None);
    let text = table::text(&rows, &fewer);
    assert_eq!((fewer.counted, fewer.friction_curve.as_ref().unwrap().curves.len()), (6, 1), "{text}");
    for line in ["run_01.csv: the record does not tell", "run_03.csv: something beside friction acts"] {
        assert!(text.contains("no friction curve that counts: ") && text.contains(line), "{text}");
    }
}
