//! Manifests of campaigns: options, groups, record sheets, records left out, and the plan of the next tests.

use super::*;
use crate::host::Host;

#[test]
fn a_manifest_sets_options_and_groups() {
    let home = folder("manifest");
    records(&home, &[0.02, 0.0201, 0.0301, 0.03]);
    let manifest = home.join("runs.csv");
    let lines = "file,mass,mass_u,normal-load,operator\nrun_00.csv,10,0.01,2,A\nrun_01.csv,10,0.01,2,A\n\
                 run_02.csv,10,0.01,3,B\nrun_03.csv,10,0.01,3,B\nmissing.csv,10,0.01,3,B\n";
    std::fs::write(&manifest, lines).unwrap();
    let campaign = Campaign::of_manifest(&manifest, law(), Some("operator".to_owned()), &Host::default()).unwrap();
    let rows: Vec<Row> = (0..5).map(|index| Row::of(&campaign, index, &Host::default())).collect();
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

    let missing =
        Campaign::of_manifest(&manifest, law(), Some("lab".to_owned()), &Host::default()).unwrap_err().to_string();
    assert!(missing.contains("there is no column `lab`") && missing.contains("operator"), "{missing}");
    for (header, words) in [
        ("file,mass,mass", "runs.csv: the column `mass` stands twice"),
        ("file,force,day", "runs.csv: column `force` is meant for --force, but a campaign is of free vibrations"),
    ] {
        std::fs::write(&manifest, format!("{header}\nrun_00.csv,10,20\n")).unwrap();
        let refused = Campaign::of_manifest(&manifest, law(), None, &Host::default()).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
    }
}

/// A list in TOML and a table of the same give the same rows, tables and groups.
#[test]
fn both_kinds_of_manifest_say_the_same() {
    let home = folder("kinds");
    let [csv, toml] = three_loads(&home);
    let table = Campaign::of_manifest(&csv, law(), Some("operator".to_owned()), &Host::default()).unwrap();
    let list = Campaign::of_manifest(&toml, law(), None, &Host::default()).unwrap();
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

/// The document of a campaign is enough for a plan of the next tests.
#[test]
fn the_next_tests_follow_from_a_campaign() {
    let home = folder("next");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None, &Host::default()).unwrap();
    let rows = rows(&campaign);
    let document = table::document(&rows, &Summary::of(&campaign, &rows, &NOTHING, None)).unwrap();
    let (plan, more) = crate::design::of_document(&document).unwrap();
    assert!(plan.contains("mass = { value = 10, u = 0.01 }") && plan.contains("normal_load = [2, 4, 8]"), "{plan}");
    assert!(plan.contains("law = \"coulomb + linear\"") && plan.contains("aim = \"mu\""), "{plan}");
    assert!(more.starts_with("the consensus of mu has u = ") && more.contains("by 6 records; 3 more"), "{more}");
    // Mass and stiffness tell the frequency: a plan with all three would be refused.
    assert!(plan.contains("\nfrequency = ") && !plan.contains("stiffness"), "{plan}");
    let stiff = document.replace("\"mass\": [", "\"stiffness\": [2467.4, 1.0], \"mass\": [");
    let (plan, _) = crate::design::of_document(&stiff).unwrap();
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
    let campaign = Campaign::of_manifest(&manifest, law(), None, &Host::default()).unwrap();
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
    let rows = rows(&Campaign::of_manifest(&home.join("runs.toml"), law(), None, &Host::default()).unwrap());
    assert!(rows[1].is_excluded && rows[1].outcome == Outcome::Refused("left out by the manifest".to_owned()));
}

/// The fields of the sheet: given, known by the records, and not given.
#[test]
fn the_record_sheet_says_what_is_missing() {
    let home = folder("sheet");
    let [_, toml] = three_loads(&home);
    let campaign = Campaign::of_manifest(&toml, law(), None, &Host::default()).unwrap();
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
