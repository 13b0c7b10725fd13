//! Commands of the README and of the pages: each has options that the program knows, and names files that exist.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The lines of a page that are commands for a shell, without comments.
fn commands(page: &str) -> Vec<String> {
    let blocks = page.split("```sh\n").skip(1).filter_map(|rest| rest.split_once("```"));
    let lines = blocks.flat_map(|(block, _)| block.lines());
    lines.map(|line| line.split(" #").next().unwrap().trim().to_owned()).collect()
}

/// The words of a command up to where its output goes; what stands between quotation marks is one.
fn words(command: &str) -> Vec<String> {
    let command = command.split([';', '>', '|', '&']).next().unwrap();
    let parts = command.split('"').enumerate();
    let split = |(place, part): (usize, &str)| match place % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    };
    parts.flat_map(split).collect()
}

/// The arguments of `fmm` in a command; `None` for another program, and for an example.
fn arguments(words: &[String]) -> Option<&[String]> {
    match words.first()?.as_str() {
        "fmm" => Some(&words[1..]),
        "cargo" if words[1] == "run" && !words.contains(&"--example".to_owned()) => {
            let dashes = words.iter().position(|word| word == "--")?;
            Some(&words[dashes + 1..])
        }
        _ => None,
    }
}

/// Why a command cannot be given.
fn fault(command: &str) -> Option<String> {
    let words = words(command);
    let of_tree = |word: &&String| ["examples/", "crates/", "tests/"].iter().any(|folder| word.starts_with(folder));
    if let Some(missing) = words.iter().filter(of_tree).find(|word| !root().join(word).exists()) {
        return Some(format!("there is no {missing}"));
    }
    if let Some(at) = words.iter().position(|word| word == "--example") {
        let example = format!("examples/{}.rs", words[at + 1]);
        return (!root().join(&example).exists()).then(|| format!("there is no {example}"));
    }
    let arguments = arguments(&words)?;
    // Options of one program may end in those of another; the help comes after all that is before it was understood.
    let end = arguments.iter().position(|word| word == "--").unwrap_or(arguments.len());
    let posterior = !cfg!(feature = "posterior") && arguments.iter().any(|word| word == "--posterior");
    if posterior {
        return None;
    }
    let output = Command::new(env!("CARGO_BIN_EXE_fmm")).args(&arguments[..end]).arg("--help").output().unwrap();
    (!output.status.success()).then(|| String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn every_command_is_understood() {
    let mut pages: Vec<PathBuf> =
        std::fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path()).collect();
    pages.retain(|path| path.extension().is_some_and(|ending| ending == "md"));
    pages.extend(["README.md", "crates/fmm-cli/README.md"].map(|page| root().join(page)));
    let (mut faults, mut count) = (Vec::new(), 0);
    for path in &pages {
        for command in commands(&std::fs::read_to_string(path).unwrap()) {
            count += usize::from(arguments(&words(&command)).is_some());
            faults.extend(fault(&command).map(|fault| format!("{}: {command}\n{fault}", path.display())));
        }
    }
    assert!(count > 30, "{count} commands of fmm on {} pages", pages.len());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn commands_that_cannot_be_given_are_told() {
    for wrong in [
        "fmm identify --masss 1",
        "fmm identify --mass heavy",
        "cargo run --release -- budget examples/budgets/absent.toml",
        "cargo run --example absent",
    ] {
        assert!(fault(wrong).is_some(), "{wrong}");
    }
}
