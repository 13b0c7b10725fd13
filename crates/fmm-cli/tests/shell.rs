//! The program in a shell: codes, documents, completions, manual pages, no colours.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn fmm(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fmm")).args(arguments).output().unwrap()
}

/// The words of `line` as arguments, typed in `folder`.
fn fmm_in(folder: &Path, line: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fmm")).args(line.split_whitespace()).current_dir(folder).output().unwrap()
}

#[test]
fn codes_tell_what_is_found_refused_and_wrong() {
    for (arguments, code) in [
        (&["formats"][..], 0),
        (&["--version"], 0),
        (&["identify", "--help"], 0),
        (&["compare", "no such file.csv"], 1),
        (&["budget", "no such file.toml"], 1),
        (&["identify", "--no-such-option"], 2),
        (&["no-such-command"], 2),
        (&[], 2),
    ] {
        assert_eq!(fmm(arguments).status.code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn lists_are_documents_too() {
    for (command, name) in [("laws", "coulomb"), ("formats", "matlab")] {
        let document: serde_json::Value = serde_json::from_slice(&fmm(&[command, "--json"]).stdout).unwrap();
        let names: Vec<&str> =
            document[command].as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap()).collect();
        assert!(names.contains(&name), "{names:?}");
        let text = String::from_utf8(fmm(&[command]).stdout).unwrap();
        assert!(names.iter().all(|name| text.contains(name)), "{text}");
    }
}

/// Runs of both directions are one problem, which shows the slope; the loads of records are as many as these.
#[test]
fn several_records_are_fitted_as_one() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let folder = std::env::temp_dir().join(format!("fmm-run-down-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let record = |name: &str| folder.join(name).display().to_string();
    for (scenario, name, seed) in [("coast_down", "there.csv", 1), ("coast_down_back", "back.csv", 2)] {
        let line = format!("simulate scenarios/{scenario}.json --record {} --noise 1e-3 --seed {seed}", record(name));
        assert!(fmm_in(&examples, &line).status.success(), "{line}");
    }
    let runs = format!("--run-down --mass 1200 --mass-u 6 {} {}", record("there.csv"), record("back.csv"));
    let output = fmm_in(&examples, &format!("identify {runs} --json=full"));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["preferred"], "coulomb + quadratic");
    assert_eq!(document["further_fits"].as_array().map(Vec::len), Some(1));
    let models = document["models"].as_array().unwrap();
    let model = models.iter().find(|model| model["law"] == document["preferred"]).unwrap();
    for (name, truth, most) in [("slope_force", 35.3, 1.0), ("friction_force", 144.0, 3.0), ("wind", 0.0, 0.04)] {
        let finding = &model["parameters"][name];
        assert!((finding["value"].as_f64().unwrap() - truth).abs() < most, "{finding}");
    }
    let output = fmm_in(&examples, &format!("compare {runs} --normal-loads 14"));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("--normal-loads has 1 load(s) for 2 record(s)"), "{error}");
    std::fs::copy(folder.join("there.csv"), folder.join("copy.csv")).unwrap();
    let output = fmm_in(&examples, &format!("compare {runs} {}", record("copy.csv")));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        error.contains("copy.csv holds the same bytes as") && error.contains("there.csv, and a copy is no"),
        "{error}"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

/// The findings of one record are the guess of a plan, by any law.
#[test]
fn a_plan_is_made_from_a_result() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let file = std::env::temp_dir().join(format!("fmm-result-{}.json", std::process::id()));
    for (law, machine, aim) in [
        ("coulomb_viscous", "--mass 10.391 --mass-u 0.005 --normal-load 14", "mu"),
        ("berger+linear", "--mass 10.391 --normal-load 14", "mu"),
        ("stribeck", "--stiffness 1982", "sliding_friction_force"),
        ("coulomb+quadratic", "", "friction_per_mass"),
    ] {
        let line = format!("identify data/flexure/run_1.csv --law {law} {machine} --json");
        std::fs::write(&file, fmm_in(&examples, &line).stdout).unwrap();
        let output = fmm_in(&examples, &format!("design --from {}", file.display()));
        let (text, error) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
        assert!(
            output.status.success() && text.contains(&format!("this record gives {aim} = ")),
            "{law}: {text}{error}"
        );
        // The plan that is printed is one.
        let plan = text.split_once("[machine]").and_then(|(_, plan)| plan.split_once("this record gives")).unwrap().0;
        let of_plan = file.with_extension("toml");
        std::fs::write(&of_plan, format!("[machine]{plan}")).unwrap();
        let output = fmm_in(&examples, &format!("design {}", of_plan.display()));
        let planned = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success() && text.ends_with(&planned), "{law}: {planned}");
        std::fs::remove_file(of_plan).unwrap();
    }
    std::fs::remove_file(file).unwrap();
}

#[test]
fn every_command_prints_one_document() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for (arguments, key) in [
        ("identify data/flexure/run_1.csv --law coulomb_viscous --json", "models"),
        ("compare data/flexure/run_1.csv --law coulomb,coulomb_viscous --json", "models"),
        ("force data/damper_1Hz_36lb_1amplitude.csv --average 0.05 --model coulomb --json", "models"),
        ("backbone --json", "points"),
        ("simulate scenarios/berger_16mm.json --json", "samples"),
        ("frf data/hammer_1.mat --json", "modes"),
        ("budget budgets/stiffness.toml --trials 10000 --json", "results"),
        ("design designs/berger.toml --json", "tests"),
        ("batch data/flexure --json -- --law coulomb_viscous", "records"),
    ] {
        let output = fmm_in(&examples, arguments);
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(output.status.success() && document.get(key).is_some(), "{arguments}: {document}");
        assert_eq!(document["version"], env!("CARGO_PKG_VERSION"), "{arguments}");
        let command = arguments.split(' ').next().unwrap().replace("compare", "identify");
        assert_eq!(document["schema"], format!("{command}-1"));
    }
}

/// Under `--json` standard output is one document, of an error too; the code stays.
#[test]
fn errors_are_documents_too() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for (arguments, status, code, remedy) in [
        ("identify no_such_file.csv --json", 1, "unreadable", None),
        ("identify data/bicycle_wheel_radial_gyro.csv --json", 1, "unclear", Some("--unit")),
        ("identify data/flexure/run_1.csv --law coulom --json", 1, "name", None),
        ("identify data/flexure/run_1.csv --stifness 1 --json", 2, "usage", Some("--stiffness")),
        ("budget budgets/stiffness.toml --trials 1 --json", 2, "usage", None),
    ] {
        let output = fmm_in(&examples, arguments);
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let error = &document["error"];
        assert_eq!(
            (output.status.code(), error["code"].as_str()),
            (Some(status), Some(code)),
            "{arguments}: {document}"
        );
        assert!(error["message"].as_str().is_some_and(|message| message.len() > 10), "{document}");
        let told = error["remedy"].as_str().unwrap_or_default();
        assert!(remedy.is_none_or(|remedy| told.contains(remedy)), "{arguments}: {document}");
        assert!(!output.stderr.is_empty(), "a person is told as well");
    }
}

/// A full document has the samples of the fit, and the residuals are what is left.
#[test]
fn a_full_document_has_the_samples() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let document =
        |line: &str| -> serde_json::Value { serde_json::from_slice(&fmm_in(&examples, line).stdout).unwrap() };
    let found = document("identify data/flexure/run_1.csv --law coulomb --json=full");
    let series = |key: &str| -> Vec<f64> {
        found["fit"][key].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let [times, measured, fitted, residuals] = ["time_s", "measured", "fitted", "residuals"].map(series);
    assert_eq!(times.len(), found["preparation"]["samples"].as_u64().unwrap() as usize);
    assert!((0..times.len()).all(|i| residuals[i] == measured[i] - fitted[i]));
    let forces = "force data/damper_1Hz_36lb_1amplitude.csv --average 0.05 --model coulomb --json";
    assert!(document(forces)["models"][0].get("fits").is_none());
    let full = document(&format!("{forces}=full"));
    assert_eq!(
        full["models"][0]["fits"][0]["residuals"].as_array().unwrap().len() as u64,
        full["samples"].as_u64().unwrap()
    );
}

#[test]
fn nothing_has_colours() {
    for arguments in [&["--help"][..], &["identify", "--no-such-option"], &["laws"], &["compare", "no such file.csv"]] {
        let output = fmm(arguments);
        assert!(!output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b), "{arguments:?}");
    }
}

#[test]
fn shells_and_man_know_every_command() {
    let commands = [
        "identify", "compare", "force", "backbone", "simulate", "frf", "budget", "design", "batch", "merge", "laws",
        "formats",
    ];
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = String::from_utf8(fmm(&["completions", shell]).stdout).unwrap();
        assert!(commands.iter().all(|command| script.contains(command)), "{shell}");
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("manual");
    assert!(fmm(&["manual", folder.to_str().unwrap()]).status.success());
    for command in commands {
        let page = std::fs::read_to_string(folder.join(format!("fmm-{command}.1"))).unwrap();
        assert!(page.contains(".TH"), "{command}");
    }
}

/// A margin that does not exist is left out, and what is wrong in a scenario is said with its file.
#[test]
fn a_machine_without_friction_has_no_margin() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join("no_friction.json");
    let scenario = r#"{"oscillator": {"mass": 1, "stiffness": 100, "restoring": {"gap": {"gap": 0.001}}},
        "initial": {"position": 0.02}, "duration": 1}"#;
    std::fs::write(&path, scenario).unwrap();
    let said = String::from_utf8(fmm(&["simulate", path.to_str().unwrap()]).stdout).unwrap();
    let row = said.lines().find(|line| line.contains("zero_velocity")).unwrap();
    assert!(row.ends_with(" -") && !said.contains("inf"), "{said}");
    std::fs::write(&path, scenario.replace("\"mass\": 1", "\"mass\": -1")).unwrap();
    let said = String::from_utf8(fmm(&["simulate", path.to_str().unwrap()]).stderr).unwrap();
    assert!(said.contains("no_friction.json: mass must be positive"), "{said}");
}

/// A simulated record is one for `fmm identify`, with the noise that was asked for.
#[test]
fn a_simulated_record_is_identified() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let [scenario, record] = ["spring.json", "spring.csv"].map(|name| folder.join(name));
    let machine = r#"{"oscillator": {"mass": 10, "stiffness": 2000}, "law": {"coulomb": {"mu": 0.1}}, "normal_load": 10,
        "initial": {"position": 0.015}, "duration": 5}"#;
    std::fs::write(&scenario, machine).unwrap();
    let [scenario, record] = [&scenario, &record].map(|path| path.to_str().unwrap());
    assert!(fmm(&["simulate", scenario, "--record", record, "--noise", "0.002"]).status.success());
    let identified = format!("identify {record} --channel velocity --mass 10 --normal-load 10 --law coulomb --json");
    let identified: Vec<&str> = identified.split(' ').collect();
    let document: serde_json::Value = serde_json::from_slice(&fmm(&identified).stdout).unwrap();
    let mu = &document["models"][0]["parameters"]["mu"];
    assert!((mu["value"].as_f64().unwrap() - 0.1).abs() < 0.002, "{mu}");
    let refused = fmm(&["simulate", scenario, "--record", record, "--noise=-1"]);
    assert!(String::from_utf8(refused.stderr).unwrap().contains("give a share of the largest value"));
}

/// Options that say something else than the file, or nothing that can be.
#[test]
fn what_is_wrong_is_named_with_what_would_be_right() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/data");
    for (arguments, sentence) in [
        ("identify flexure", "flexure is a folder; `fmm batch` takes the records in one"),
        ("identify flexure/run_1.csv --law coulomb --mass nan", "--mass: known value must be finite"),
        (
            "identify flexure/run_1.csv --law coulomb --mass 1 --mass-u=-1",
            "--mass: standard uncertainty must be zero or positive",
        ),
        (
            "identify flexure/run_1.csv --law coulomb --rate 250",
            "the 250 Hz of --rate were taken, though the file says 500 Hz",
        ),
        ("identify flexure/run_1.csv --force 1", "which is a unit of velocity, not of force; name another channel"),
        (
            "force damper_1Hz_36lb_1amplitude.csv --model coulomb --hold stribeck.exponent=2",
            "--hold stribeck.exponent: stribeck is the law of no model",
        ),
        ("batch flexure --group operator", "--group operator: a manifest says which records belong together"),
    ] {
        let output = fmm_in(&examples, arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains(sentence), "{arguments}: {said}");
    }
    let stated = fmm_in(&examples, "identify flexure/run_1.csv --law coulomb --rate 500");
    assert!(!String::from_utf8(stated.stderr).unwrap().contains("--rate"), "the same rate is no contradiction");
}

/// A parameter of one model is held, and the others, which do not have it, are fitted beside it.
#[test]
fn a_parameter_of_one_model_of_a_force_is_held() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/data");
    let output = fmm_in(&data, "force damper_1Hz_36lb_1amplitude.csv --model coulomb,dahl --hold dahl.exponent=1");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("by dahl, exponent = 1") && said.contains("Force along a motion by coulomb\n"), "{said}");
}

#[test]
fn what_cannot_be_is_refused_in_words() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for (arguments, reason) in [
        ("identify RECORD --law coulomb --hold friction_per_mass=1 --hold friction_per_mass=2", "is held at 1 already"),
        ("compare RECORD --hold friction_per_mass=1", "viscous has no parameter called \"friction_per_mass\""),
        ("compare RECORD --time-limit 3", "is for the search"),
        ("identify RECORD --law coulomb --report no/such/folder/page.html", "there is no folder no/such/folder"),
        ("identify RECORD --law coulomb --report data", "it is a folder"),
        ("identify RECORD --law coulomb --low-pass 2:0.001", "the low-pass filter of the sensor settles for"),
        ("identify RECORD --law coulomb --pendulum 1e-9", "beyond two whole turns"),
        ("identify RECORD --law coulomb --pendulum", "the record is in m/s and not in radians"),
        ("identify RECORD --law coulomb --mass 1e300", "beyond the range of numbers"),
        ("identify RECORD --law coulomb --mass 1e-300", "beyond the range of numbers"),
    ] {
        let arguments = arguments.replace("RECORD", "data/flexure/run_1.csv");
        let output = fmm_in(&examples, &arguments);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(
            output.status.code() == Some(1) && output.stdout.is_empty() && told.contains(reason),
            "{arguments}: {told}"
        );
    }
}

#[test]
fn a_headline_says_what_was_not_measured() {
    let record = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/data/flexure/run_1.csv");
    let held = ["identify", record.to_str().unwrap(), "--law", "coulomb", "--hold", "friction_per_mass=0.2"];
    let text = String::from_utf8(fmm(&held).stdout).unwrap();
    assert!(text.contains("friction_per_mass = 0.2: friction_per_mass = 0.2 m/s² (held); "), "{text}");
    // The friction that the record shows comes before the law.
    let mut lines = text.lines().skip(1);
    assert!(
        lines.next().is_some_and(|line| line.starts_with("friction over speed, no law assumed: at rest")),
        "{text}"
    );
    assert!(lines.next().is_some_and(|line| line.starts_with("coulomb, ")), "{text}");
}

#[test]
fn standard_input_is_read_and_a_wrong_unit_of_time_is_told() {
    // 2 Hz at 500 Hz, friction takes 5 % of the first height from every half cycle; the times are in ms.
    let velocity = |i: u32| {
        let half_cycles = f64::from(i) * 2e-3 * 4.0;
        let height = 0.975 - 0.05 * half_cycles.floor();
        if height > 0.0 { height * (std::f64::consts::PI * half_cycles).sin() } else { 0.0 }
    };
    let row = |i: u32| format!("{}.0,{:.5}\n", 2 * i, velocity(i) + 1e-4 * f64::from(i * 7919 % 13));
    let text = format!("t,v [m/s]\n{}", (0..2600).map(row).collect::<String>());
    let told = |options: &str| {
        let line = format!("identify - --law coulomb {options}");
        let mut program = Command::new(env!("CARGO_BIN_EXE_fmm"))
            .args(line.split_whitespace())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        program.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        let output = program.wait_with_output().unwrap();
        assert!(output.status.success(), "{options}");
        String::from_utf8(output.stdout).unwrap()
    };
    let wrong = told("");
    let headline = wrong.lines().find(|line| line.starts_with("coulomb:")).unwrap();
    assert!(headline.contains("; but no machine has 0.002 Hz: if its times are in ms, it has 2 Hz"), "{wrong}");
    assert!(!told("--time-unit ms").contains("no machine has"));
}
