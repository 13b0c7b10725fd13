//! Modes from trials, Universal Files and tables, and files that should be refused.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::answer::{Answer, Detail};
use crate::commands::answer;
use crate::frf::tests::npy;
use crate::host::Host;
use crate::refusal::Refusal;

/// The responses of a chain of six masses, with noise, as another program wrote them.
const CHAIN: &str = "../fmm-frf/tests/data/chain_of_six.uff";
/// Its natural frequencies (Hz).
const FREQUENCIES: [f64; 6] = [24.266_06, 71.387_94, 114.361_00, 150.687_82, 178.257_22, 195.466_95];

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn run(words: &[&str], host: &Host<'_>) -> Result<Box<dyn Answer>, Refusal> {
    answer(["fmm", "frf", "--modes"].iter().chain(words), host)
}

fn found(words: &[&str], host: &Host<'_>) -> Value {
    let answer = run(words, host).unwrap_or_else(|refusal| panic!("{words:?}: {refusal:?}"));
    serde_json::from_str(&answer.document(Detail::Full).unwrap()).unwrap()
}

fn refusal(words: &[&str], host: &Host<'_>) -> Refusal {
    run(words, host).err().unwrap_or_else(|| panic!("{words:?} was not refused"))
}

fn frequencies(document: &Value) -> Vec<f64> {
    let modes = document["modes"].as_array().unwrap().iter();
    modes.map(|mode| mode["natural_frequency_hz"]["value"].as_f64().unwrap()).collect()
}

fn require_chain(document: &Value) {
    let found = frequencies(document);
    assert_eq!(found.len(), FREQUENCIES.len(), "{found:?}");
    for (found, expected) in found.iter().zip(FREQUENCIES) {
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} Hz, not {expected}");
    }
}

/// The lines of a table with the response of the first mass, by what the document of a fit says was measured.
fn table(document: &Value, header: &str, cells: impl Fn(f64, f64) -> (f64, f64)) -> Vec<u8> {
    let lines = document["curves"]["frequencies_hz"].as_array().unwrap().iter();
    let measured = document["curves"]["measured"][0].as_array().unwrap().iter();
    let mut text = format!("{header}\n");
    for (frequency, value) in lines.zip(measured) {
        let (one, other) = cells(value["real"].as_f64().unwrap(), value["imag"].as_f64().unwrap());
        writeln!(text, "{frequency},{one},{other}").unwrap();
    }
    text.into_bytes()
}

#[test]
fn a_universal_file_in_all_forms_of_the_answer() {
    let file = path(CHAIN);
    let saved = std::env::temp_dir().join(format!("fmm-modes-{}.uff", std::process::id()));
    let words = [file.to_str().unwrap(), "--save-responses", saved.to_str().unwrap()];
    let host = Host::default();
    let answer = run(&words, &host).unwrap_or_else(|refusal| panic!("{refusal:?}"));
    let text = answer.text().unwrap();
    assert!(text.contains("6 responses, receptance: 512 lines") && text.contains("\n   6  195.46"), "{text}");
    assert!(text.contains("shapes, by their largest deflection"), "{text}");
    let pictures = answer.pictures().unwrap();
    let names: Vec<&str> = pictures.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["stabilisation.svg", "fit.svg"]);
    assert!(pictures[0].1.contains("stable in frequency and damping"));
    let document = found(&[saved.to_str().unwrap()], &host);
    std::fs::remove_file(&saved).unwrap();
    assert_eq!(document["schema"], "modes-1");
    assert_eq!(document["modes"][0]["shape"].as_array().unwrap().len(), 6);
    assert!(document["diagram"].as_array().unwrap().len() > 100);
    require_chain(&document);
}

#[test]
fn tables_of_real_and_imaginary_part_and_of_magnitude_and_phase() {
    let document = found(&[path(CHAIN).to_str().unwrap()], &Host::default());
    let parts = table(&document, "frequency [Hz],real,imag", |re, im| (re, im));
    let polar = table(&document, "f (Hz),magnitude,phase [deg]", |re, im| (re.hypot(im), im.atan2(re).to_degrees()));
    let bare = table(&document, "a,b,c", |re, im| (1e3 * re, 1e3 * im));
    let text = String::from_utf8(parts.clone()).unwrap();
    let numbers: Vec<f64> =
        text.lines().skip(1).flat_map(|line| line.split(',').map(|cell| cell.parse::<f64>().unwrap())).collect();
    let array = npy(&format!("({}, 3)", numbers.len() / 3), &numbers);
    let host = Host::default()
        .with_file("array.npy", array)
        .with_file("parts.csv", parts)
        .with_file("polar.csv", polar)
        .with_file("bare.csv", bare);
    for words in [
        &["parts.csv", "--quantity", "displacement"][..],
        &["polar.csv", "--quantity", "displacement"],
        &["parts.csv", "polar.csv", "--quantity", "displacement"],
        &["array.npy", "--responses", "--quantity", "displacement"],
        &["bare.csv", "--responses", "--quantity", "displacement", "--response-scale", "1e-3"],
    ] {
        let again = found(words, &host);
        require_chain(&again);
        assert_eq!(
            again["responses"].as_array().unwrap().len(),
            words.iter().filter(|word| word.contains('.') && !word.starts_with('-')).count()
        );
        let residue = |document: &Value| document["modes"][0]["residues"][0]["imag"]["value"].as_f64().unwrap();
        assert!((residue(&again) / residue(&document) - 1.0).abs() < 1e-2, "{words:?}: another size");
    }
    let silent = refusal(&["parts.csv"], &host);
    assert!(silent.remedy.is_some_and(|remedy| remedy.contains("--quantity")), "{}", silent.message);
    let chosen = found(&["parts.csv", "--quantity", "displacement", "--near", "71", "--band", "50", "90"], &host);
    assert_eq!(frequencies(&chosen).len(), 1);
}

#[test]
fn modes_of_hammer_blows() {
    let blows = [1, 2, 3].map(|hit| path(&format!("../../examples/data/hammer_{hit}.mat")));
    let mut words: Vec<&str> = blows.iter().map(|path| path.to_str().unwrap()).collect();
    words.extend(["--quantity", "acceleration", "--band", "600", "1100"]);
    let document = found(&words, &Host::default());
    let found = frequencies(&document);
    // The fits of one mode each to the same lines.
    for expected in [810.3, 851.6, 899.9] {
        assert!(found.iter().any(|frequency| (frequency - expected).abs() < 0.3), "{expected} Hz not in {found:?}");
    }
    assert!(document["responses"][0]["misfit"].as_f64().unwrap() < 0.1);
}

#[test]
fn what_is_refused_says_what_would_be_right() {
    let chain = path(CHAIN);
    let chain = chain.to_str().unwrap();
    let host = Host::default()
        .with_file("degrees.csv", b"frequency,magnitude,phase\n1,2,3\n2,2,3\n3,2,3\n".to_vec())
        .with_file("nan.csv", b"frequency,real,imag\n1,2,3\n2,nan,3\n3,2,3\n".to_vec())
        .with_file("zero.csv", b"frequency,real,imag\n1,0,0\n2,0,0\n3,0,0\n4,0,0\n5,0,0\n".to_vec())
        .with_file("one.csv", b"frequency,real,imag\n1,2,3\n".to_vec());
    for (words, code, part) in [
        (&[chain, "--order", "900"][..], "record", "--order"),
        (&[chain, "--band", "300", "400"], "record", "--band"),
        (&[chain, "--near", "40"], "fit", "--near"),
        (&["degrees.csv", "--quantity", "velocity"], "contradiction", "phase [deg]"),
        (&["zero.csv", "--quantity", "velocity"], "values", "zero at all lines"),
        (&["one.csv", "--quantity", "velocity"], "record", ""),
        (&["nan.csv", "--quantity", "velocity"], "values", ""),
    ] {
        let refused = refusal(words, &host);
        let told = format!("{} / {}", refused.message, refused.remedy.clone().unwrap_or_default());
        assert!(refused.code == code && told.contains(part), "{words:?}: {}: {told}", refused.code);
    }
}
