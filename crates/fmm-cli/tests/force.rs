//! `fmm force` on tables whose truth is known: columns, units in names and by options, signs, and what is refused.

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

/// A table of these columns, row by row.
fn table_of(name: &str, columns: &[(&str, &[f64])]) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("force").join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut text = columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",");
    for row in 0..columns[0].1.len() {
        text.push('\n');
        text += &columns.iter().map(|(_, values)| values[row].to_string()).collect::<Vec<_>>().join(",");
    }
    std::fs::write(&path, text).unwrap();
    path
}

/// Times, positions, velocities, and forces (N) of 3 N of friction and 20 N s/m, with small noise.
fn rubbed() -> [Vec<f64>; 4] {
    let times: Vec<f64> = (0..1500).map(|i| 0.004 * f64::from(i)).collect();
    let phase = |t: &f64| 3.0 * t + 0.4;
    let velocities: Vec<f64> = times.iter().map(|t| 0.06 * phase(t).cos()).collect();
    let noise = |i: usize| 0.02 * (1.7 * (i * i) as f64).sin();
    let forces = velocities.iter().enumerate().map(|(i, v)| 3.0 * v.signum() + 20.0 * v + noise(i)).collect();
    [times.clone(), times.iter().map(|t| 0.02 * phase(t).sin()).collect(), velocities, forces]
}

fn by(factor: f64, values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| factor * value).collect()
}

/// The columns that were taken are printed; one that a normal load is in by its name is not taken for the force.
#[test]
fn the_columns_are_said_and_a_normal_load_is_no_friction() {
    let [t, x, _, f] = rubbed();
    let (normal, micro) = (vec![5e6; t.len()], by(1e6, &f));
    let both = table_of(
        "normal.csv",
        &[("t [s]", &t), ("x [mm]", &by(1e3, &x)), ("Normal [uN]", &normal), ("Lateral [uN]", &micro)],
    );
    let said = document(&both, &[]);
    assert_eq!(said["columns"][0]["columns"]["force"], "Lateral [uN]", "{said}");
    assert_eq!(said["columns"][0]["columns"]["position"], "x [mm]");
    assert_eq!(said["columns"][0]["columns"]["unused"][0], "Normal [uN]");
    assert!(said["warnings"][0].as_str().unwrap().contains("say so by --load"), "{said}");
    let (_, text) = fmm(&both, &["--load", "Normal", "--model", "coulomb"]);
    let line = "time \"t [s]\", position \"x [mm]\", force \"Lateral [uN]\", normal load \"Normal [uN]\"";
    assert!(text.contains(line), "{text}");
    // Friction in volts is nearer than a normal load in newtons.
    let volts = table_of("volts.csv", &[("t [s]", &t), ("x [m]", &x), ("Fn [N]", &normal), ("Friction [V]", &f)]);
    assert_eq!(document(&volts, &[])["columns"][0]["columns"]["force"], "Friction [V]");
    let alone = table_of("alone.csv", &[("t [s]", &t), ("x [m]", &x), ("Normal force [N]", &f)]);
    refused(&alone, &[], &["\"Normal force [N]\", which is across the motion by its name; name the force by --force"]);
    let twice = table_of("two.csv", &[("t [s]", &t), ("x [m]", &x), ("A [N]", &f), ("B [N]", &f)]);
    let (_, text) = fmm(&twice, &["--model", "coulomb"]);
    assert!(
        text.contains("\"A [N]\" was taken for the force, which may be \"B [N]\" as well: say it by --force"),
        "{text}"
    );
    let named = table_of("named_force.csv", &[("t [s]", &t), ("x [m]", &x), ("A [N]", &f), ("force [N]", &f)]);
    assert_eq!(document(&named, &[])["columns"][0]["columns"]["force"], "force [N]");
    let still = table_of("still.csv", &[("t [s]", &t), ("F [N]", &f), ("Temp [degC]", &t)]);
    refused(
        &still,
        &[],
        &["no column is a position or a velocity, along which friction acts", "--position or --velocity"],
    );
}

/// The reaction in place of the force is named, with the option that turns it.
#[test]
fn a_force_of_the_other_sign_is_named_and_turned() {
    let [t, x, _, f] = rubbed();
    let path = table_of("reaction.csv", &[("t [s]", &t), ("x [m]", &x), ("F [N]", &by(-1.0, &f))]);
    let said = document(&path, &[]);
    let warnings = said["models"][0]["warnings"].to_string();
    assert!(warnings.contains("the force drives the motion: turn its sign (`--turn-sign`"), "{warnings}");
    let said = document(&path, &["--turn-sign"]);
    assert!((finding(&said, "friction_force").0 / 3.6 - 1.0).abs() < 0.2, "{said}");
    assert!(!said["models"][0]["warnings"].to_string().contains("drives"), "{said}");
}

/// Units that nothing states are said as they were taken, and so are samples that are cut off or jump, and a record to
/// predict with a force of the other sign.
#[test]
fn what_was_taken_for_granted_is_said() {
    let [t, x, v, f] = rubbed();
    let path =
        table_of("bare.csv", &[("time", &by(1e3, &t)), ("Position", &by(1e3, &x)), ("Friction", &f), ("Load", &t)]);
    let (_, said) = fmm(&path, &["--model", "coulomb + linear"]);
    assert!(said.contains("no unit is stated, and s for \"time\", m for \"Position\", N for \"Friction\""), "{said}");
    assert!(said.contains("\"Load\" was not used; if it is the normal load, say so by --load"), "{said}");
    let units = ["--time-unit", "ms", "--position-unit", "mm", "--force-unit", "N", "--model", "coulomb + linear"];
    let (_, said) = fmm(&path, &units);
    assert!(!said.contains("no unit is stated") && said.contains("friction over speed, no law assumed:"), "{said}");
    let named = table_of("milli.csv", &[("time [ms]", &by(1e3, &t)), ("x [m]", &x), ("F [N]", &f)]);
    refused(&named, &["--time-unit", "ms"], &["\"time [ms]\" tells the unit; leave --time-unit out"]);
    let cut: Vec<f64> = v.iter().map(|v| (100.0 * v).clamp(-4.0, 4.0)).collect();
    let mut jumps = x.clone();
    jumps[700] = 1.0;
    let path = table_of("cut.csv", &[("t [s]", &t), ("x [m]", &jumps), ("F [N]", &cut)]);
    let (_, said) = fmm(&path, &["--model", "coulomb + linear"]);
    assert!(said.contains("\"F [N]\" lies on -4 and 4 in") && said.contains("first at 2.8 s"), "{said}");
    let [good, reaction] = [1.0, -1.0]
        .map(|sign| table_of(&format!("sign{sign}.csv"), &[("t [s]", &t), ("x [m]", &x), ("F [N]", &by(sign, &f))]));
    let (_, said) = fmm(&good, &["--model", "coulomb + linear", "--validate", reaction.to_str().unwrap()]);
    assert!(
        said.contains("note: ") && said.contains("sign-1.csv: the force drives the motion: turn its sign"),
        "{said}"
    );
}

/// A prediction that is off by more than the force is named, and the law that predicts better is preferred.
#[test]
fn what_was_not_fitted_ranks_the_laws() {
    let [t, x, _, f] = rubbed();
    let fitted = table_of("fitted.csv", &[("t [s]", &t), ("x [m]", &x), ("F [N]", &f)]);
    let other = table_of("other.csv", &[("t [s]", &t), ("x [m]", &x), ("F [N]", &by(-1.0, &f))]);
    // Where friction is the other way, the law that fits worse is less wrong.
    let (_, said) =
        fmm(&fitted, &["--model", "coulomb+linear,viscous", "--validate", other.to_str().unwrap(), "--json"]);
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    let rms = |model: usize| said["models"][model]["not_fitted"][0]["rms"].as_f64().unwrap();
    assert!(rms(1) < rms(0), "{said}");
    assert_eq!(
        (&said["preferred"], &said["preferred_by"], &said["is_decided"]),
        (&"viscous".into(), &"prediction".into(), &false.into())
    );
    let warnings = said["warnings"].to_string();
    assert!(warnings.contains("coulomb + linear fits best, but viscous predicts best"), "{warnings}");
    for model in 0..2 {
        let warnings = said["models"][model]["warnings"].to_string();
        assert!(warnings.contains("predicts a record that was not fitted with an error of"), "{warnings}");
    }
}

/// Parts of a record, a rate in place of times, the tare of a load, and the units of workshops.
#[test]
fn parts_rates_and_tares_are_options() {
    let [t, x, _, f] = rubbed();
    let load = vec![14.0; t.len()];
    let path = table_of(
        "parts.csv",
        &[("t [s]", &t), ("x [m]", &x), ("F [lb]", &by(1.0 / 4.448_221_615_260_5, &f)), ("N", &load)],
    );
    let said = document(&path, &["--from", "1", "--to", "4", "--load", "N", "--tare", "4"]);
    assert_eq!(said["samples"], 751, "{said}");
    let (coefficient, _) = finding(&said, "coefficient");
    assert!((coefficient / 0.36 - 1.0).abs() < 0.2, "{coefficient}");
    refused(&path, &["--from", "9"], &["no sample lies between --from and --to; the record goes from 0 s to 5.996 s"]);
    let path = table_of("untimed.csv", &[("x [m]", &x), ("F [kip]", &by(1.0 / 4_448.221_615_260_5, &f))]);
    refused(&path, &[], &["no column is the time", "--rate"]);
    let said = document(&path, &["--rate", "250"]);
    assert!((finding(&said, "friction_force").0 / 3.6 - 1.0).abs() < 0.2, "{said}");
    // A gap outside of the part does not matter, and one inside is named with its time.
    let mut gap = f.clone();
    gap[1000] = f64::NAN;
    let path = table_of("gap_outside.csv", &[("t [s]", &t), ("x [m]", &x), ("F [N]", &gap)]);
    assert!(fmm(&path, &["--to", "3", "--model", "coulomb"]).0);
    refused(&path, &["--from", "1"], &["is not finite at sample 1000 (at 4 s)"]);
}

/// A motion in one direction has no levels that differ by direction, and a curve over the speed no time.
#[test]
fn rotations_and_curves_have_defaults_of_their_own() {
    let [t, ..] = rubbed();
    let omega: Vec<f64> = t.iter().map(|t| 3.0 + t.sin()).collect();
    let torque: Vec<f64> = omega.iter().map(|omega| 0.5 + 0.1 * omega).collect();
    let turns = by(1.0 / std::f64::consts::TAU, &omega);
    let path = table_of("rotation.csv", &[("t [s]", &t), ("omega [rev/s]", &turns), ("M [N m]", &torque)]);
    let (is_done, said) = fmm(&path, &["--json"]);
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert!(is_done && !said["models"].to_string().contains("asymmetry"), "{said}");
    assert!(is_close(finding(&said, "friction_force").0, 0.5) && is_close(finding(&said, "damping").0, 0.1), "{said}");
    let path = table_of("curve.csv", &[("omega [rad/s]", &omega), ("M [N m]", &torque)]);
    let (_, said) = fmm(&path, &["--model", "coulomb + linear", "--json"]);
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert!(said["warnings"][0].as_str().unwrap().contains("the rows are taken for steady states"), "{said}");
    assert!(is_close(finding(&said, "friction_force").0, 0.5), "{said}");
    let (is_done, text) = fmm(&path, &["--model", "dahl"]);
    assert!(!is_done && text.contains("dahl depends on time or position, of which steady states have none"), "{text}");
}

/// A load that pulls by its sign, an angle that begins anew after a turn and a position that jumps are mended with a
/// sentence, and the friction is what it is without them.
#[test]
fn what_an_instrument_did_is_undone() {
    let [t, x, _, f] = rubbed();
    let load = vec![-12.0; t.len()];
    let mut jumps = by(1e3, &x);
    jumps[700] = 900.0;
    let path = table_of("spoiled.csv", &[("t [s]", &t), ("x [mm]", &jumps), ("force_N", &f), ("Fz [N]", &load)]);
    let said = document(&path, &["--load", "Fz", "--model", "coulomb + linear"]);
    let warnings = said["warnings"].to_string();
    assert!(warnings.contains("straight lines between their neighbours stand for these"), "{warnings}");
    assert!(warnings.contains("\\\"Fz [N]\\\" is negative throughout: its sign was turned"), "{warnings}");
    assert!((finding(&said, "coefficient").0 / 0.25 - 1.0).abs() < 0.01, "{said}");

    let angle: Vec<f64> = t.iter().map(|t| 200.0 * t + 40.0 * t.sin()).collect();
    let torque: Vec<f64> = t.iter().map(|t| 0.5 + 0.1 * (200.0 + 40.0 * t.cos()).to_radians()).collect();
    let wound: Vec<f64> = angle.iter().map(|angle| angle.rem_euclid(360.0)).collect();
    let path = table_of("wound.csv", &[("t [s]", &t), ("angle [deg]", &wound), ("torque_Nm", &torque)]);
    let said = document(&path, &["--model", "coulomb + linear"]);
    assert!(said["warnings"].to_string().contains("begins anew after each turn, 3 times"), "{said}");
    assert!(is_close(finding(&said, "friction_force").0, 0.5) && is_close(finding(&said, "damping").0, 0.1), "{said}");
}

/// A law with more parameters than samples leaves the others, and a limit in time gives the best so far.
#[test]
fn one_law_that_fails_leaves_the_others() {
    let [t, x, v, f] = rubbed();
    let few = |values: &[f64]| values.iter().step_by(180).copied().collect::<Vec<_>>();
    let columns = [("t [s]", few(&t)), ("x [m]", few(&x)), ("v [m/s]", few(&v)), ("F [N]", few(&f))];
    let path = table_of("few.csv", &columns.each_ref().map(|(name, values)| (*name, &values[..])));
    let (is_done, said) = fmm(&path, &["--model", "gms_2,coulomb + linear", "--json"]);
    assert!(is_done, "{said}");
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["models"].as_array().unwrap().len(), 1);
    let warnings = said["warnings"].to_string();
    assert!(warnings.contains("the law gms_2 took no part in the judgement: the record has 9 samples"), "{warnings}");
    let path = table_of("limited.csv", &[("t [s]", &t), ("x [m]", &x), ("F [N]", &f)]);
    let (is_done, said) = fmm(&path, &["--model", "gms_2", "--time-limit", "1"]);
    assert!(is_done && said.contains("sliding_friction_force"), "{said}");
}
