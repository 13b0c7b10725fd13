//! Documents of the program `fmm`.

use std::process::{Command, ExitCode};

use serde_json::Value;

/// Arguments of the program that this test runs in a process of its own, one a line.
const ARGUMENTS: &str = "FMM_GOLDEN_ARGUMENTS";
/// Line before the document.
const BEGIN: &str = "-- document --";

/// The document that `fmm` prints for `line`, whose words are its arguments, in the folder of the repository.
pub(crate) fn fmm(line: &str) -> (String, Value) {
    let arguments: Vec<&str> = ["fmm"].into_iter().chain(line.split_whitespace()).chain(["--json"]).collect();
    // `batch` gives what follows two dashes to each record.
    let arguments = match arguments.iter().position(|argument| *argument == "--") {
        Some(dashes) => [&arguments[..dashes], &["--json"], &arguments[dashes..arguments.len() - 1]].concat(),
        None => arguments,
    };
    let test = std::env::current_exe().unwrap();
    let output = Command::new(test)
        .args(["--exact", "program::as_the_program", "--nocapture"])
        .env(ARGUMENTS, arguments.join("\n"))
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .output()
        .unwrap();
    let (out, told) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    // The harness may say in between that a test takes long.
    let document = out.split_once(BEGIN).and_then(|(_, document)| document.get(document.find(['{', '['])?..));
    let document = document.and_then(|document| serde_json::from_str(document).ok());
    (line.to_owned(), document.unwrap_or_else(|| panic!("fmm {line} gives no document\n{out}\n{told}")))
}

/// The program, if another test asks for it.
#[test]
fn as_the_program() {
    let Ok(arguments) = std::env::var(ARGUMENTS) else { return };
    println!("{BEGIN}");
    let is_done = fmm_cli::run(arguments.lines()) == ExitCode::SUCCESS;
    std::process::exit(i32::from(!is_done));
}
