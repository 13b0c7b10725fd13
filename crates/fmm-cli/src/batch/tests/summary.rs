//! Summaries of campaigns: consensus, influence, dependences, joint fits, copies and doubts.

use std::ops::ControlFlow;

use super::*;
use crate::host::Host;

/// Of four records one lies far off: without it the consensus moves most.
#[test]
fn the_most_influential_record_is_named() {
    let row = |(index, value): (usize, &f64)| {
        let contributions = vec![Part { source: "residuals of the fit".into(), u: 0.1 }];
        let told = Told {
            name: "mu".into(),
            unit: "1".into(),
            value: *value,
            u: Some(0.1),
            degrees_of_freedom: None,
            contributions,
        };
        let found = Found {
            origin: String::new(),
            law: LAW.to_owned(),
            is_decided: true,
            findings: vec![told],
            declared: BTreeMap::new(),
            stated: Vec::new(),
            rms_residual: 1.0,
            unit: "m".to_owned(),
            amplitude: 1.0,
            half_swings: 9,
            rate_hz: 100.0,
            duration_s: 5.0,
            warnings: Vec::new(),
            doubts: if index == 2 { vec!["the residuals are structured".to_owned()] } else { Vec::new() },
            friction_curve: Outcome::Refused("left out".to_owned()),
            samples: index.to_string(),
        };
        let file = PathBuf::from(format!("run_{index}.csv"));
        Row { file, description: BTreeMap::new(), is_excluded: false, outcome: Outcome::Found(found) }
    };
    let rows: Vec<Row> = [1.0, 1.1, 5.0, 0.9].iter().enumerate().map(row).collect();
    let campaign =
        Campaign { options: Vec::new(), group: None, sheet: None, without_curves: true, entries: Vec::new() };
    let all = Asked { count_doubtful: true, ..NOTHING };
    let summary = Summary::of(&campaign, &rows, &all, None);
    let (file, moved) = summary.quantities[0].most_influential.as_ref().unwrap();
    assert!(file == "run_2.csv" && *moved < -0.5, "{file}: {moved}");
    // It counts where that is asked for, but not in silence: doubted, and far from the others.
    let told = |summary: &Summary| [table::text(&rows, summary), page::page(&campaign, &rows, summary)];
    for text in told(&summary) {
        assert!(text.contains("doubtful, counted as was asked: run_2.csv: the residuals are structured"), "{text}");
        assert!(text.contains("far from the others, but counted: run_2.csv: its mu lies +400.0 % off"), "{text}");
    }
    // Otherwise it stands apart, with the reason, and does not move the mean.
    let summary = Summary::of(&campaign, &rows, &NOTHING, None);
    assert_eq!((summary.found, summary.counted, summary.quantities[0].records), (4, 3, 3));
    assert!((summary.quantities[0].mean - 1.0).abs() < 1e-12 && summary.quantities[0].outlying.is_empty());
    for text in told(&summary) {
        assert!(text.contains("doubtful, not counted: run_2.csv: the residuals are structured"), "{text}");
        assert!(text.contains("mu = 1.00, U = 0.12 (k = 2); 95 % within [0.75, 1.25] by Student"), "{text}");
    }
    // Where nothing is left, the way out is named.
    let summary = Summary::of(&campaign, &rows[1..3], &NOTHING, None);
    let text = table::text(&rows, &summary);
    assert!(summary.quantities.is_empty() && text.contains("--count-doubtful counts the others as well"), "{text}");
    // The page says its count once, and has no table without a row.
    let page = page::page(&campaign, &rows, &summary);
    assert!(page.matches("records identified").count() == 1 && !page.contains("class=\"findings\""), "{page}");
    assert!(page.contains("No quantity has a consensus"), "{page}");
}

/// Six runs under one load that is known to 0.5 %: the consensus does not know μ better than that. Two loads that are
/// weighed apart average out between them, and an input of one record alone is its own.
#[test]
fn what_records_share_does_not_average_out() {
    let home = folder("shared");
    records(&home, &[0.02, 0.0202, 0.0199, 0.0201, 0.0198, 0.0200]);
    let mu = |loads: [(f64, f64); 6]| {
        let mut manifest = "file,mass,normal_load,normal_load_u\n".to_owned();
        for (run, (load, u)) in loads.iter().enumerate() {
            manifest.extend([format!("run_{run:02}.csv,10,{load},{u}\n")]);
        }
        std::fs::write(home.join("runs.csv"), manifest).unwrap();
        let campaign = Campaign::of_manifest(&home.join("runs.csv"), law(), None, &Host::default()).unwrap();
        let rows = rows(&campaign);
        let summary = Summary::of(&campaign, &rows, &NOTHING, None);
        let text = table::text(&rows, &summary);
        (summary.quantities.into_iter().find(|quantity| quantity.name == "mu").unwrap(), text)
    };
    let (without, text) = mu([(2.0, 0.0); 6]);
    assert!(without.shared.is_empty() && !text.contains("of u shared"), "{text}");
    let (one_load, text) = mu([(2.0, 0.01); 6]);
    let by_load = 0.005 * one_load.mean;
    assert!((one_load.shared_u / by_load - 1.0).abs() < 1e-3 && one_load.u > by_load, "{one_load:?}");
    assert!((one_load.u / without.u.hypot(one_load.shared_u) - 1.0).abs() < 1e-9, "{one_load:?}");
    // The weights and what differs are those of the records' own.
    assert_eq!((one_load.mean, one_load.between), (without.mean, without.between));
    assert!(one_load.shared[0].records == 6 && one_load.shared[0].input.value == 2.0, "{one_load:?}");
    assert!(text.contains("from 6 records (of u shared by records: 0.00050 by normal load)"), "{text}");
    // Values that differ by less than their uncertainty, to leave μ alike: half of each contribution, in squares.
    let (two_loads, _) = mu([(2.0, 0.01), (2.0, 0.01), (2.0, 0.01), (2.001, 0.01), (2.001, 0.01), (2.001, 0.01)]);
    let records: Vec<usize> = two_loads.shared.iter().map(|part| part.records).collect();
    assert!(records == [3, 3] && (two_loads.shared_u / (by_load / 2_f64.sqrt()) - 1.0).abs() < 0.01, "{two_loads:?}");
    let (one_apart, _) = mu([(2.0, 0.01), (2.0, 0.01), (2.0, 0.01), (2.0, 0.01), (2.0, 0.01), (2.001, 0.01)]);
    assert!(one_apart.shared.len() == 1 && one_apart.shared[0].records == 5, "{one_apart:?}");
}

/// Friction in proportion to the load is seen, what is beside it as well, and a column that cannot be set against says
/// why.
#[test]
fn friction_stands_against_load_and_columns() {
    let home = folder("against");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None, &Host::default()).unwrap();
    let rows = rows(&campaign);
    let columns = ["temperature".to_owned(), "operator".to_owned(), "mass".to_owned()];
    let summary = Summary::of(&campaign, &rows, &Asked { against: columns.to_vec(), ..NOTHING }, None);
    let against: Vec<&str> = summary.dependences.iter().map(|found| found.against.as_str()).collect();
    // Releases are alike to within the friction of a half swing.
    assert_eq!(against, ["normal_load", "temperature", "operator", "mass"]);
    let line = summary.dependences[0].line.as_ref().unwrap();
    let (low, high) = line.slope_interval_95.unwrap();
    assert!(low < 0.1 && 0.1 < high && high - low < 1e-2, "{low} to {high}");
    assert!(line.intercept_interval_95.is_some_and(|(low, high)| low < 0.0 && 0.0 < high), "{line:?}");
    assert!(summary.dependences[0].statement.contains("in proportion to the load between 2 N and 8 N"));
    let temperature = &summary.dependences[1];
    assert!(
        temperature.quantity == "mu" && temperature.statement.contains("does not show to depend"),
        "{temperature:?}"
    );
    assert!(summary.dependences[2].line.is_none() && summary.dependences[3].line.is_none());
    assert!(summary.dependences[3].statement.contains("fewer than two different values"));
    let two = Summary::of(&campaign, &rows[1..3], &NOTHING, None);
    let statement = "friction force against normal load: 2 runs are given; at least 3 are needed";
    assert_eq!(two.dependences[0].statement, statement);
    let page = page::page(&campaign, &rows, &summary);
    assert!(page.contains("id=\"dependence-0\"") && page.contains("Friction against load"));
    let asked = Asked { against: vec!["weather".to_owned()], ..NOTHING };
    assert!(asked.check(&campaign).unwrap_err().contains("there is no column `weather`; there are file,"));
}

/// Forces under different loads have no mean: each load has its own, and the coefficient one of all.
#[test]
fn what_differs_by_design_has_no_consensus() {
    let home = folder("design");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None, &Host::default()).unwrap();
    let rows = rows(&campaign);
    let summary = Summary::of(&campaign, &rows, &NOTHING, None);
    let of = |name: &str| summary.quantities.iter().filter(|one| one.name == name).collect::<Vec<_>>();
    let forces: Vec<(Option<(f64, f64)>, usize)> =
        of("friction_force").iter().map(|one| (one.loads, one.records)).collect();
    assert_eq!(forces, [(Some((2.0, 2.0)), 2), (Some((4.0, 4.0)), 2), (Some((8.0, 8.0)), 2)]);
    for (force, load) in of("friction_force").iter().zip([2.0, 4.0, 8.0]) {
        assert!((force.mean / (0.1 * load) - 1.0).abs() < 0.03, "{force:?}");
    }
    assert_eq!((of("mu").len(), of("mu")[0].loads, of("mu")[0].records), (1, None, 6));
    let (text, page) = (table::text(&rows, &summary), page::page(&campaign, &rows, &summary));
    assert!(text.contains("friction_force under 2 N = ") && !text.contains("\n  friction_force = "), "{text}");
    // Mu with its expanded uncertainty comes first, and its budget.
    let verdict = page.split("class=\"verdict\">").nth(1).unwrap().split('<').next().unwrap();
    assert!((of("mu")[0].mean / 0.1 - 1.0).abs() < 0.01, "{:?}", of("mu")[0]);
    assert!(verdict.starts_with("mu = 0.") && verdict.contains("(k = 2)"), "{verdict}");
    assert!(page.contains("Budget of mu") && page.contains("a column `date` of the manifest says it"), "{page}");
}

/// All records as one problem: the coefficient between those of the records, and known better than it deserves where
/// they differ.
#[test]
fn a_joint_fit_says_what_it_takes_for_granted() {
    let home = folder("joint");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None, &Host::default()).unwrap();
    let rows = rows(&campaign);
    let joint = |campaign: &Campaign, rows: &[Row]| {
        Outcome::from(Together::of(campaign, rows, false, &Host::default(), |_, _| ControlFlow::Continue(())))
    };
    let found = joint(&campaign, &rows);
    let together = found.found().unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!((together.records, together.law.as_str(), together.reference_load), (6, "coulomb + linear", Some(2.0)));
    let mu = together.findings.iter().find(|told| told.name == "mu").unwrap();
    assert!((mu.value - 0.1).abs() < 2e-3, "{mu:?}");
    let summary = Summary::of(&campaign, &rows, &NOTHING, Some(found.clone()));
    let of = |name: &str| summary.quantities.iter().find(|quantity| quantity.name == name).unwrap();
    assert_eq!(of("mu").joint, Some((mu.value, mu.u)));
    // These runs differ by a hundredth, which no joint fit allows for.
    let why = summary.against_joint().unwrap();
    assert!(
        why.starts_with("the records differ in mu beyond their uncertainties") && why.contains("`exclude`"),
        "{why}"
    );
    let asked = Asked { joint: true, ..NOTHING };
    let refused = asked.summary(&campaign, &rows, &Host::default()).unwrap();
    assert!(matches!(&refused.joint, Some(Outcome::Refused(said)) if *said == why), "{:?}", refused.joint);
    // A force at one load is none of the records at the others.
    assert!(of("friction_force").joint.is_none() && of("natural_frequency_hz").joint.is_some());
    let text = table::text(&rows, &summary);
    assert!(
        text.contains("joint fit of 6 records by coulomb + linear") && text.contains("levels at a load of 2 N"),
        "{text}"
    );
    assert!(text.contains("takes machine and law for the same in all records"), "{text}");
    assert!(page::page(&campaign, &rows, &summary).contains("<h2>Joint fit</h2>"));

    let refused = |campaign: &Campaign, rows: &[Row]| match joint(campaign, rows) {
        Outcome::Refused(why) => why,
        Outcome::Found(together) => panic!("{together:?}"),
    };
    let mut other = campaign.clone();
    let mass = other.entries[3].options.iter_mut().find(|option| option.starts_with("--mass=")).unwrap();
    *mass = "--mass=11".to_owned();
    let why = refused(&other, &rows);
    assert!(why.contains("--mass is 10 for") && why.contains("and 11 for") && why.contains("run_03.csv"), "{why}");
    let mut other = campaign.clone();
    other.entries[2].options.retain(|option| !option.starts_with("--normal-load"));
    assert!(refused(&other, &rows).contains("the normal load of all records or of none"));
    let mut mixed = rows.clone();
    if let Outcome::Found(found) = &mut mixed[1].outcome {
        found.law = "viscous".to_owned();
    }
    assert!(refused(&campaign, &mixed).contains("different laws: coulomb_viscous (5), viscous (1)"));
    assert!(refused(&campaign, &rows[..1]).contains("two identified records"));
}

/// The same record three times, under other names and masses, is one record; a disturbed one is doubted.
#[test]
fn copies_count_once_and_doubts_are_named() {
    let home = folder("copies");
    let paths = records(&home, &[0.02, 0.0202]);
    let text = std::fs::read_to_string(&paths[0]).unwrap();
    std::fs::write(home.join("run_02.csv"), &text).unwrap();
    std::fs::write(home.join("run_03.csv"), text.replace("t [s]", "Time [s]")).unwrap();
    let disturbed: String = std::iter::once("t [s],v [mm/s]\n".to_owned())
        .chain(text.lines().skip(1).map(|line| {
            let (time, value) = line.split_once(',').unwrap();
            let (at, value): (f64, f64) = (time.parse().unwrap(), value.parse().unwrap());
            format!("{time},{}\n", value + 3.0 * (5.1 * at).sin() * (-0.1 * at).exp())
        }))
        .collect();
    std::fs::write(home.join("run_04.csv"), disturbed).unwrap();
    let campaign = Campaign::of_files(std::slice::from_ref(&home), law()).unwrap();
    let rows = Row::without_copies(rows(&campaign));
    let asked = Asked { count_doubtful: true, ..NOTHING };
    let refused: Vec<bool> = rows.iter().map(|row| row.found().is_none()).collect();
    assert_eq!(refused, [false, false, true, true, false], "{rows:?}");
    let Outcome::Refused(why) = &rows[3].outcome else { panic!("{rows:?}") };
    assert!(why.starts_with("the same samples as ") && why.contains("run_00.csv"), "{why}");
    assert_eq!(Summary::of(&campaign, &rows, &NOTHING, None).quantities[0].records, 2);
    let summary = Summary::of(&campaign, &rows, &asked, None);
    assert_eq!((summary.found, summary.quantities[0].records), (3, 3));
    let doubted: Vec<&str> = summary.doubted.iter().map(|record| record.file.as_str()).collect();
    assert!(doubted.len() == 1 && doubted[0].ends_with("run_04.csv"), "{:?}", summary.doubted);
    assert!(table::text(&rows, &summary).contains("refused: the same samples as "));
    let verdict = |rows: &[Row], summary| {
        let (campaign, rows) = (campaign.clone(), rows.to_vec());
        super::super::Found { campaign, rows, summary, written: None }.verdict()
    };
    verdict(&rows, summary).unwrap();
    let none = &rows[2..4];
    let failed = verdict(none, Summary::of(&campaign, none, &NOTHING, None)).unwrap_err();
    assert!(failed.starts_with("none of 2 records was identified"), "{failed}");
}
