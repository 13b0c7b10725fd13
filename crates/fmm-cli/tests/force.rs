//! `fmm force` on tables whose truth is known: units in names and by options, and what is refused.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Path of a table in which each column with this name has its values divided by the size of its unit: time (s),
/// position (m), velocity (m/s), and the force (N) of 3 N of friction and a spring of 200 N/m.
fn table(name: &str, columns: [(&str, f64); 4]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("force");
    std::fs::create_dir_all(&folder).unwrap();
    let mut text = columns.map(|(name, _)| name).join(",") + ",load [N]\n";
    for i in 0..2000 {
        let time = 0.002 * f64::from(i);
        let (sine, cosine) = (3.0 * time + 0.4).sin_cos();
        let (x, v) = (0.02 * sine, 0.06 * cosine);
        let numbers = [time, x, v, 3.0 * v.signum() + 200.0 * x];
        for (number, (_, size)) in numbers.into_iter().zip(columns) {
            write!(text, "{},", number / size).unwrap();
        }
        text.push_str("10\n");
    }
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn fmm(path: &Path, options: &[&str]) -> (bool, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_fmm")).arg("force").arg(path).args(options).output().unwrap();
    let said = if output.status.success() { output.stdout } else { output.stderr };
    (output.status.success(), String::from_utf8(said).unwrap())
}

fn document(path: &Path, options: &[&str]) -> serde_json::Value {
    let (is_done, said) = fmm(path, &[options, &["--model", "coulomb+stiffness+zero", "--json"]].concat());
    assert!(is_done, "{options:?}: {said}");
    serde_json::from_str(&said).unwrap()
}

/// Value and unit of a finding.
fn finding(document: &serde_json::Value, name: &str) -> (f64, String) {
    let findings = document["models"][0]["findings"].as_array().unwrap();
    let found = findings.iter().find(|found| found["name"] == name).unwrap_or_else(|| panic!("{name}: {document}"));
    (found["value"].as_f64().unwrap(), found["unit"].as_str().unwrap().to_owned())
}

fn is_close(value: f64, truth: f64) -> bool {
    (value / truth - 1.0).abs() < 1e-3
}

fn refused(path: &Path, options: &[&str], words: &[&str]) {
    let (is_done, said) = fmm(path, &[options, &["--model", "coulomb"]].concat());
    assert!(!is_done && words.iter().all(|words| said.contains(words)), "{options:?}: {said}");
    assert!(said.contains(path.file_name().unwrap().to_str().unwrap()), "{said}");
}

const TIME: (&str, f64) = ("t [s]", 1.0);

/// A unit by an option does what the same unit in the name of the column does, wherever it stands.
#[test]
fn units_convert_by_name_and_by_option() {
    let velocity = ("v [m/s]", 1.0);
    for (name, columns, options) in [
        ("named.csv", [TIME, ("x [mm]", 1e-3), velocity, ("F [kN]", 1e3)], &["--load", "load"][..]),
        (
            "by_option.csv",
            [TIME, ("x", 1e-3), velocity, ("F", 1e3)],
            &["--load", "load", "--position", "x", "--position-unit", "mm", "--force", "F", "--force-unit", "kN"],
        ),
        (
            "velocity_by_option.csv",
            [TIME, ("x", 1e-3), ("v", 1e-3), ("F [N]", 1.0)],
            &["--load", "load", "--position", "x", "--velocity", "v", "--position-unit", "mm"],
        ),
        (
            "velocity_alone.csv",
            [TIME, ("y", 1.0), ("v", 1e-3), ("F [N]", 1.0)],
            &["--load", "load", "--velocity", "v", "--position-unit", "mm"],
        ),
        // What the option says is what the name says.
        (
            "twice.csv",
            [TIME, ("x [mm]", 1e-3), ("v", 1e-3), ("F [kN]", 1e3)],
            &["--load", "load", "--velocity", "v", "--position-unit", "mm", "--force-unit", "kN"],
        ),
    ] {
        let document = document(&table(name, columns), options);
        let (coefficient, stiffness) = (finding(&document, "coefficient"), finding(&document, "stiffness"));
        assert!(is_close(coefficient.0, 0.3) && coefficient.1 == "1", "{name}: {coefficient:?}");
        assert!(is_close(stiffness.0, 200.0) && stiffness.1 == "N/m", "{name}: {stiffness:?}");
        // 3 N over 80 mm to and fro.
        let energy = document["loops"][0][0]["energy_u"][0].as_f64().unwrap();
        assert!((energy / 0.24 - 1.0).abs() < 0.01, "{name}: {energy}");
    }
    let angles = table("angles.csv", [TIME, ("angle", 0.017_453_3), ("omega [rad/s]", 1.0), ("M", 1e-3)]);
    let options = ["--position", "angle", "--position-unit", "deg", "--force", "M", "--force-unit", "N mm"];
    let (level, unit) = finding(&document(&angles, &options), "friction_force");
    assert!(is_close(level, 3.0) && unit == "N m", "{level} {unit}");
}

/// Both sides of a contradiction are named, and what a column is that cannot be what it is named as.
#[test]
fn units_that_contradict_are_refused() {
    let path = table("told.csv", [TIME, ("x [m]", 1.0), ("v [m/s]", 1.0), ("F [N]", 1.0)]);
    for (options, words) in [
        (&["--force-unit", "kN"][..], &["channel \"F [N]\" is in N, not in kN as --force-unit says"][..]),
        (&["--position-unit", "mm"], &["channel \"x [m]\" is in m, not in mm as --position-unit says"]),
        (
            &["--force", "x"],
            &["channel \"x [m]\" is in m, but --force needs a unit of force or torque, such as N or N m"],
        ),
        (&["--position", "F"], &["channel \"F [N]\" is in N, but --position needs a unit of length or angle"]),
        (&["--velocity", "x"], &["channel \"x [m]\" is in m, but --velocity needs a unit of velocity"]),
        (&["--load", "x"], &["channel \"x [m]\" is in m, but --load needs a unit of force"]),
    ] {
        refused(&path, options, words);
    }
    let path = table("untold.csv", [TIME, ("x", 1.0), ("v [m/s]", 1.0), ("F", 1.0)]);
    for (options, words) in [
        (&["--force", "F", "--force-unit", "m"][..], &["in m, but --force needs a unit of force or torque"][..]),
        (&["--force", "F", "--position", "x", "--position-unit", "N"], &["in N, but --position needs"]),
        (&["--force", "F", "--position-unit", "N"], &["--position-unit is N, but --position needs"]),
        (
            &["--force", "F", "--position-unit", "mm"],
            &["channel \"v [m/s]\" is in m/s, not in mm per second as --position-unit says"],
        ),
        (
            &["--force", "F", "--position", "x", "--position-unit", "deg"],
            &["channel \"v [m/s]\" is in m/s, not in deg per second as belongs to the positions"],
        ),
    ] {
        refused(&path, options, words);
    }
    let (is_done, said) = fmm(&path, &["--force", "F", "--position-unit", "furlong"]);
    assert!(!is_done && said.contains("the unit \"furlong\" is not known"), "{said}");
}

/// A model is as little told of a record in other units as it is fitted to it.
#[test]
fn a_record_in_other_units_is_not_predicted() {
    let path = table("metres.csv", [TIME, ("x [m]", 1.0), ("v [m/s]", 1.0), ("F [N]", 1.0)]);
    let other = table("angles_beside.csv", [TIME, ("angle [rad]", 1.0), ("omega [rad/s]", 1.0), ("torque [N m]", 1.0)]);
    let words = "angles_beside.csv: the records are in different units: m and N beside rad and N m";
    for options in [&["--validate", other.to_str().unwrap()][..], &["--validate", other.to_str().unwrap(), "--json"]] {
        let (is_done, said) = fmm(&path, &[&["--model", "coulomb"], options].concat());
        assert!(!is_done && said.contains(words), "{said}");
    }
    let (is_done, said) = fmm(&path, &["--model", "coulomb+stiffness", "--validate", path.to_str().unwrap()]);
    assert!(is_done && said.contains("not fitted: "), "{said}");
}

/// A sample that is missing is named with its time, and does not matter in a column that is not used.
#[test]
fn gaps_are_named_with_their_time() {
    let path = table("gap.csv", [("t [ms]", 1e-3), ("x [m]", 1.0), ("v [m/s]", 1.0), ("F [N]", 1.0)]);
    let text = std::fs::read_to_string(&path).unwrap();
    let with_gap = |column: usize| {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let mut cells: Vec<&str> = lines[101].split(',').collect();
        cells[column] = "nan";
        lines[101] = cells.join(",");
        std::fs::write(&path, lines.join("\n")).unwrap();
    };
    with_gap(3);
    refused(&path, &[], &["channel \"F [N]\" is not finite at sample 100 (at 0.2 s); cut the record there"]);
    with_gap(1);
    refused(&path, &[], &["channel \"x [m]\" is not finite at sample 100 (at 0.2 s)"]);
    with_gap(0);
    refused(&path, &[], &["channel \"t [ms]\" is not finite at sample 100; cut"]);
    with_gap(4);
    let (is_done, said) = fmm(&path, &["--model", "coulomb"]);
    assert!(is_done, "{said}");
}
