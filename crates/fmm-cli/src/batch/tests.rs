//! Campaigns of simulated records: no file is lost, any split gives the same bytes, and the interval holds.

use std::path::{Path, PathBuf};

use std::collections::BTreeMap;

use super::row::{Found, Outcome, Part, Told};
use super::*;

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join("fmm-cli").join(format!("batch-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A decay with friction of this level (m/s²) and white-looking noise, as text.
fn decay(level: f64, seed: u64) -> String {
    use fmm_friction::CoulombViscous;
    use fmm_model::Oscillator;
    use fmm_sim::{Engine, Exact, Sampling, Scenario};
    let law = CoulombViscous::new(level, 0.05).unwrap();
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0).unwrap(), law, 1.0).unwrap();
    let scenario = scenario.starting_at(0.02, 0.0).unwrap();
    let motion = Exact.run(&scenario, &Sampling::uniform(5e-3, 800).unwrap()).unwrap();
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut text = "t [s],v [mm/s]\n".to_owned();
    for (i, velocity) in motion.velocity().values().iter().enumerate() {
        text.extend([format!("{:.3},{:.6}\n", i as f64 * 5e-3, 1e3 * (velocity + 1e-3 * noise()))]);
    }
    text
}

fn records(folder: &Path, levels: &[f64]) -> Vec<PathBuf> {
    let one = |(i, level): (usize, &f64)| {
        let path = folder.join(format!("run_{i:02}.csv"));
        std::fs::write(&path, decay(*level, i as u64)).unwrap();
        path
    };
    levels.iter().enumerate().map(one).collect()
}

/// No question beside the rows.
const NOTHING: Asked = Asked { joint: false, count_doubtful: false, against: Vec::new() };

fn law() -> Vec<String> {
    vec!["--law".to_owned(), LAW.to_owned()]
}

#[test]
fn parts_are_read_as_they_are_meant() {
    assert_eq!((shard("1/1"), shard("3/10")), (Ok((1, 1)), Ok((3, 10))));
    for wrong in ["0/3", "4/3", "1", "a/b", "1/0", "-1/3"] {
        assert!(shard(wrong).is_err(), "{wrong}");
    }
}

/// Broken files are rows with their reason, and any split into parts, in any order, with parts done twice, gives the
/// same bytes.
#[test]
fn any_split_gives_the_same_bytes() {
    let home = folder("split");
    let data = home.join("data");
    std::fs::create_dir_all(&data).unwrap();
    records(&data, &[0.02, 0.021, 0.019, 0.02, 0.022]);
    std::fs::write(data.join("empty.csv"), "").unwrap();
    std::fs::write(data.join("words.csv"), "this,is\nno,record\n").unwrap();
    std::fs::write(data.join("noise.bin"), [0_u8, 159, 146, 150]).unwrap();
    let campaign = Campaign::of_files(&[data], law()).unwrap();
    assert_eq!(campaign.entries.len(), 8);
    assert!(campaign.require_column("lab").unwrap_err().ends_with("; there are file"));
    let done = |name: &str, parts: &[(usize, usize)]| {
        let out = home.join(name);
        campaign.keep(&out).unwrap();
        for (part, parts) in parts {
            for index in
                (part - 1..8).step_by(*parts).filter(|index| Row::is_due(&out, *index, &campaign.entries[*index]))
            {
                Row::of(&campaign, index).write(&out, index).unwrap();
            }
        }
        put_together(&out, &campaign, &NOTHING, true).unwrap();
        ["campaign.csv", "campaign.json", "campaign.html"].map(|name| std::fs::read(out.join(name)).unwrap())
    };
    let whole = done("whole", &[(1, 1)]);
    assert!(
        whole == done("three", &[(3, 3), (1, 3), (2, 3), (1, 3)]) && whole == done("mixed", &[(2, 2), (1, 5), (1, 1)])
    );
    let read = |index: usize| Row::read(&home.join("whole"), index, &campaign.entries[index]);
    let rows: Vec<Row> = (0..8).map(|index| read(index).unwrap()).collect();
    assert_eq!(rows.iter().filter_map(Row::found).count(), 5);
    assert!(rows.iter().all(|row| !matches!(&row.outcome, Outcome::Refused(why) if why.is_empty())));
    // A row of which only a part was written is done again, and one that does not say what was stated.
    std::fs::write(home.join("whole/rows/0000003.json"), "{\"file\":").unwrap();
    let found =
        home.join("whole/rows").join(format!("{:07}.json", rows.iter().position(|row| row.found().is_some()).unwrap()));
    let text = std::fs::read_to_string(&found).unwrap();
    std::fs::write(&found, text.replace("\"stated\":[],", "")).unwrap();
    assert_eq!((0..8).filter(|index| read(*index).is_none()).count(), 2);
    assert!(whole == done("whole", &[(1, 1)]));
    // Another campaign does not go into the same folder.
    let other = Campaign { options: Vec::new(), ..campaign.clone() };
    assert!(other.keep(&home.join("whole")).is_err());
}

#[test]
fn a_manifest_sets_options_and_groups() {
    let home = folder("manifest");
    records(&home, &[0.02, 0.0201, 0.0301, 0.03]);
    let manifest = home.join("runs.csv");
    let lines = "file,mass,mass_u,normal-load,operator\nrun_00.csv,10,0.01,2,A\nrun_01.csv,10,0.01,2,A\n\
                 run_02.csv,10,0.01,3,B\nrun_03.csv,10,0.01,3,B\nmissing.csv,10,0.01,3,B\n";
    std::fs::write(&manifest, lines).unwrap();
    let campaign = Campaign::of_manifest(&manifest, law(), Some("operator".to_owned())).unwrap();
    let rows: Vec<Row> = (0..5).map(|index| Row::of(&campaign, index)).collect();
    for (row, coefficient) in rows.iter().zip([0.1, 0.1005, 0.100_333, 0.1]) {
        let found = row.told(("mu", "1")).unwrap_or_else(|| panic!("{row:?}"));
        let off: f64 = (found.value - coefficient).abs();
        assert!(off < 4.0 * found.u.unwrap() && off < 0.08 * coefficient, "{found:?}");
    }
    assert!(matches!(&rows[4].outcome, Outcome::Refused(why) if why.contains("missing.csv")), "{:?}", rows[4]);
    let summary = Summary::of(&campaign, &rows, &NOTHING, None);
    assert_eq!((summary.records, summary.found), (5, 4));
    // Of records that do not say their loads, forces are taken for alike by design.
    let unsaid = rows.iter().cloned().map(|mut row| {
        row.description.remove("normal-load");
        row
    });
    let unsaid = Summary::of(&campaign, &unsaid.collect::<Vec<_>>(), &NOTHING, None);
    let force = unsaid.quantities.iter().find(|quantity| quantity.name == "friction_force").unwrap();
    let group = force.precision.as_ref().unwrap();
    // The initial state and the offset belong to each record, not to the machine.
    let names: Vec<&str> = summary.quantities.iter().map(|quantity| quantity.name.as_str()).collect();
    assert!(names.contains(&"natural_frequency_hz") && !names.contains(&"offset"), "{names:?}");
    assert!(group.groups == ["A", "B"] && group.between > 10.0 * group.repeatability, "{group:?}");
    // The consensus takes each force once, and every record weighs about the same.
    let rest: f64 = rows[..4].iter().map(|row| row.told(("friction_force", "N")).unwrap().value).sum();
    assert!((force.mean / (rest / 4.0) - 1.0).abs() < 0.02 && force.records == 4, "{force:?}");
    assert!(force.p < 1e-6 && force.weighted_mean[1] < 0.2 * force.u, "{force:?}");

    let csv = table::csv(&campaign, &rows).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert!(lines.len() == 6 && lines[0][..6] == ["file", "mass", "mass_u", "normal-load", "operator", "law"]);
    let place = lines[0].iter().position(|name| *name == "mu [1]").unwrap();
    assert_eq!(lines[2][place].parse::<f64>().unwrap(), rows[1].told(("mu", "1")).unwrap().value);
    assert_eq!((lines[2][4], lines[2][5], lines[5][5]), ("A", LAW, ""));
    let document: serde_json::Value = serde_json::from_str(&table::document(&rows, &summary).unwrap()).unwrap();
    assert!(document["records"][1]["found"]["law"] == LAW && document["records"][4]["refused"].is_string());
    let page = page::page(&campaign, &rows, &summary);
    assert!(rows.iter().all(|row| page.contains(&row.file.display().to_string())) && !page.contains("http"));
    let text = table::text(&rows, &summary);
    assert!(text.contains("4 of 5 records identified") && text.contains("by 2 groups: s_r ="), "{text}");
    assert!(
        !text.lines().any(|line| line.split(", ").any(|value| value.ends_with(" 1"))),
        "a number has no unit: {text}"
    );

    let missing = Campaign::of_manifest(&manifest, law(), Some("lab".to_owned())).unwrap_err().to_string();
    assert!(missing.contains("there is no column `lab`") && missing.contains("operator"), "{missing}");
    for (header, words) in [
        ("file,mass,mass", "runs.csv: the column `mass` stands twice"),
        ("file,force,day", "runs.csv: column `force` is meant for --force, but a campaign is of free vibrations"),
    ] {
        std::fs::write(&manifest, format!("{header}\nrun_00.csv,10,20\n")).unwrap();
        let refused = Campaign::of_manifest(&manifest, law(), None).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
    }
}

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
            samples: index.to_string(),
        };
        let file = PathBuf::from(format!("run_{index}.csv"));
        Row { file, description: BTreeMap::new(), is_excluded: false, outcome: Outcome::Found(found) }
    };
    let rows: Vec<Row> = [1.0, 1.1, 5.0, 0.9].iter().enumerate().map(row).collect();
    let campaign = Campaign { options: Vec::new(), group: None, sheet: None, entries: Vec::new() };
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
        let campaign = Campaign::of_manifest(&home.join("runs.csv"), law(), None).unwrap();
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

/// Runs at three loads, listed as CSV and as TOML.
fn three_loads(home: &Path) -> [PathBuf; 2] {
    let loads = [2.0, 2.0, 4.0, 4.0, 8.0, 8.0];
    // Friction of μ N by 10 kg, with a coefficient of 0.1 that differs by a hundredth.
    let levels: Vec<f64> =
        loads.iter().zip([1.01, 0.99, 1.0, 1.012, 0.992, 0.997]).map(|(load, factor)| 0.1 * load * factor).collect();
    records(home, &levels.iter().map(|level| level / 10.0).collect::<Vec<_>>());
    let mut csv = "file,mass,mass_u,normal_load,unit,operator,temperature\n".to_owned();
    let mut toml = "group = \"operator\"\n[common]\nmass = 10\nmass_u = 0.01\nunit = \"mm/s\"\n".to_owned();
    for (run, load) in loads.iter().enumerate() {
        let (operator, temperature) = (["A", "B"][run % 2], 20 + run);
        csv.extend([format!("run_{run:02}.csv,10,0.01,{load},mm/s,{operator},{temperature}\n")]);
        toml.extend([format!(
            "[[record]]\nfile = \"run_{run:02}.csv\"\nnormal_load = {load}\noperator = \"{operator}\"\ntemperature = {temperature}\n"
        )]);
    }
    toml += "[sheet]\nmoving_material = \"steel\"\nnormal_load = \"dead weight\"\n[sheet.further]\ngrease_batch = 7\n";
    [("runs.csv", csv), ("runs.toml", toml)].map(|(name, text)| {
        std::fs::write(home.join(name), text).unwrap();
        home.join(name)
    })
}

fn rows(campaign: &Campaign) -> Vec<Row> {
    (0..campaign.entries.len()).map(|index| Row::of(campaign, index)).collect()
}

/// A list in TOML and a table of the same give the same rows, tables and groups.
#[test]
fn both_kinds_of_manifest_say_the_same() {
    let home = folder("kinds");
    let [csv, toml] = three_loads(&home);
    let table = Campaign::of_manifest(&csv, law(), Some("operator".to_owned())).unwrap();
    let list = Campaign::of_manifest(&toml, law(), None).unwrap();
    assert_eq!((&list.group, list.sheet.is_some()), (&table.group, true));
    let [from_table, from_list] = [rows(&table), rows(&list)];
    assert!(from_table == from_list && from_table.iter().all(|row| row.found().is_some()), "{from_table:?}");
    assert_eq!(table::csv(&table, &from_table).unwrap(), table::csv(&list, &from_list).unwrap());
    // A sheet that changes is no other campaign, nor is another mass, of which the row is made again.
    let out = home.join("out");
    list.keep(&out).unwrap();
    Campaign { sheet: None, ..list.clone() }.keep(&out).unwrap();
    assert_eq!(Campaign::read(&out).unwrap().sheet, None);
    for (index, row) in from_list.iter().enumerate() {
        row.write(&out, index).unwrap();
    }
    let mut other = list.clone();
    other.entries[0].description.insert("mass".to_owned(), "11".to_owned());
    other.keep(&out).unwrap();
    let due = |index: &usize| Row::is_due(&out, *index, &other.entries[*index]);
    assert_eq!((0..other.entries.len()).filter(due).collect::<Vec<_>>(), [0]);
}

/// Friction in proportion to the load is seen, what is beside it as well, and a column that cannot be set against says
/// why.
#[test]
fn friction_stands_against_load_and_columns() {
    let home = folder("against");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None).unwrap();
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
    let campaign = Campaign::of_manifest(&toml, law(), None).unwrap();
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

/// The document of a campaign is enough for a plan of the next tests.
#[test]
fn the_next_tests_follow_from_a_campaign() {
    let home = folder("next");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None).unwrap();
    let rows = rows(&campaign);
    let document = table::document(&rows, &Summary::of(&campaign, &rows, &NOTHING, None)).unwrap();
    let (plan, more) = crate::design::of_campaign(&document).unwrap();
    assert!(plan.contains("mass = { value = 10, u = 0.01 }") && plan.contains("normal_load = [2, 4, 8]"), "{plan}");
    assert!(plan.contains("law = \"coulomb + linear\"") && plan.contains("aim = \"mu\""), "{plan}");
    assert!(more.starts_with("the consensus of mu has u = ") && more.contains("by 6 records; 3 more"), "{more}");
    // Mass and stiffness tell the frequency: a plan with all three would be refused.
    assert!(plan.contains("\nfrequency = ") && !plan.contains("stiffness"), "{plan}");
    let stiff = document.replace("\"mass\": [", "\"stiffness\": [2467.4, 1.0], \"mass\": [");
    let (plan, _) = crate::design::of_campaign(&stiff).unwrap();
    assert!(plan.contains("stiffness = 2467.4\n") && !plan.contains("frequency = "), "{plan}");
}

/// A record that the manifest leaves out counts in nothing, and is named with the reason.
#[test]
fn a_record_can_be_left_out() {
    let home = folder("exclude");
    records(&home, &[0.02, 0.0202, 0.03]);
    let manifest = home.join("runs.csv");
    std::fs::write(&manifest, "file,exclude\nrun_00.csv,\nrun_01.csv,false\nrun_02.csv,a finger on the mass\n")
        .unwrap();
    let campaign = Campaign::of_manifest(&manifest, law(), None).unwrap();
    let all = rows(&campaign);
    let summary = Summary::of(&campaign, &all, &NOTHING, None);
    assert_eq!((summary.found, summary.counted, summary.excluded.len()), (2, 2, 1));
    let said = "run_02.csv: left out by the manifest: a finger on the mass";
    assert!(page::page(&campaign, &all, &summary).contains(said));
    let text = table::text(&all, &summary);
    assert!(text.contains(said) && text.contains("2 of 3 records identified; 1 left out by the manifest"), "{text}");
    // The same as a truth value of TOML.
    let list = "[[record]]\nfile = \"run_00.csv\"\n[[record]]\nfile = \"run_02.csv\"\nexclude = true\n";
    std::fs::write(home.join("runs.toml"), list).unwrap();
    let rows = rows(&Campaign::of_manifest(&home.join("runs.toml"), law(), None).unwrap());
    assert!(rows[1].is_excluded && rows[1].outcome == Outcome::Refused("left out by the manifest".to_owned()));
}

/// What was excluded, corrected or added since, and what was measured anew, is done again in the same folder, and
/// nothing else is.
#[test]
fn what_changed_is_done_again() {
    let home = folder("changed");
    records(&home, &[0.02, 0.0202, 0.03]);
    let (manifest, out) = (home.join("runs.csv"), home.join("out"));
    let listed = |lines: &str| {
        std::fs::write(&manifest, format!("file,exclude,operator\n{lines}")).unwrap();
        let campaign = Campaign::of_manifest(&manifest, law(), None).unwrap();
        campaign.keep(&out).unwrap();
        let due = |index: &usize| Row::is_due(&out, *index, &campaign.entries[*index]);
        let due: Vec<usize> = (0..campaign.entries.len()).filter(due).collect();
        for index in &due {
            Row::of(&campaign, *index).write(&out, *index).unwrap();
        }
        due
    };
    assert_eq!(listed("run_00.csv,,A\nrun_01.csv,,B\n"), [0, 1]);
    assert!(listed("run_00.csv,,A\nrun_01.csv,,B\n").is_empty());
    assert_eq!(listed("run_00.csv,,A\nrun_01.csv,a finger,B\nrun_02.csv,,A\n"), [1, 2]);
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(5);
    std::fs::File::options().append(true).open(home.join("run_02.csv")).unwrap().set_modified(later).unwrap();
    assert_eq!(listed("run_00.csv,,A\nrun_01.csv,a finger,B\nrun_02.csv,,A\n"), [2]);
}

/// A name that is not Unicode is found, printed with a sign, and found again.
#[cfg(unix)]
#[test]
fn names_that_are_not_unicode_are_found() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let home = folder("bytes");
    let data = home.join("data");
    std::fs::create_dir_all(&data).unwrap();
    records(&data, &[0.02]);
    std::fs::rename(data.join("run_00.csv"), data.join(OsStr::from_bytes(b"caf\xe9.csv"))).unwrap();
    let campaign = Campaign::of_files(&[data], law()).unwrap();
    let all = rows(&campaign);
    let summary = Summary::of(&campaign, &all, &NOTHING, None);
    assert!(
        all[0].found().is_some() && table::document(&all, &summary).unwrap().contains("caf\u{fffd}.csv"),
        "{all:?}"
    );
    let out = home.join("out");
    campaign.keep(&out).unwrap();
    all[0].write(&out, 0).unwrap();
    assert!(
        Row::read(&out, 0, &campaign.entries[0]).is_some_and(|row| row.found().is_some())
            && Campaign::read(&out).unwrap() == campaign
    );
}

/// The fields of the sheet: given, known by the records, and not given.
#[test]
fn the_record_sheet_says_what_is_missing() {
    let home = folder("sheet");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None).unwrap();
    let rows = rows(&campaign);
    let summary = Summary::of(&campaign, &rows, &NOTHING, None);
    let value = |part: &str, field: &str| {
        let fields = summary.sheet.as_ref().unwrap();
        fields.iter().find(|own| own.part == part && own.name == field).and_then(|own| own.value.clone())
    };
    assert_eq!(value("Moving specimen", "material").as_deref(), Some("steel"));
    assert_eq!(value("Fixed specimen", "material"), None);
    // What is given goes before what the records say.
    assert_eq!(value("Conditions", "normal load or pressure").as_deref(), Some("dead weight"));
    assert_eq!(value("Further", "grease batch").as_deref(), Some("7"));
    assert_eq!(value("Results", "replicates").as_deref(), Some("6 counted of 6 records"));
    let mu: Vec<f64> = rows.iter().map(|row| row.told(("mu", "1")).unwrap().value).collect();
    let mean = mu.iter().sum::<f64>() / 6.0;
    let deviation = (mu.iter().map(|mu| (mu - mean).powi(2)).sum::<f64>() / 5.0).sqrt();
    let spread = format!("coefficient of variation {:.2} %", 100.0 * deviation / mean);
    assert!(value("Results", "mu").is_some_and(|text| text.ends_with(&spread)), "{:?}", value("Results", "mu"));
    let text = table::text(&rows, &summary);
    assert!(
        text.contains("record sheet, not given: laboratory (test)") && !text.contains("material (moving"),
        "{text}"
    );
    assert!(page::page(&campaign, &rows, &summary).contains("not given"));
}

/// All records as one problem: the coefficient between those of the records, and known better than it deserves where
/// they differ.
#[test]
fn a_joint_fit_says_what_it_takes_for_granted() {
    let home = folder("joint");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None).unwrap();
    let rows = rows(&campaign);
    let joint = |campaign: &Campaign, rows: &[Row]| {
        Outcome::from(Together::of(campaign, rows, false, |_, _| ControlFlow::Continue(())))
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
    let refused = asked.summary(&campaign, &rows).unwrap();
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
    give_out(&rows, &summary, true).unwrap();
    let none = &rows[2..4];
    let failed = give_out(none, &Summary::of(&campaign, none, &NOTHING, None), true).unwrap_err().to_string();
    assert!(failed.starts_with("none of 2 records was identified"), "{failed}");
}
