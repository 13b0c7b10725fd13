//! The page of worked examples: every command of it, and the lines that it says the command prints.

use std::path::Path;
use std::process::Command;

const PAGE: &str = include_str!("../../../docs/worked-examples.md");

/// `text` with one space between words, so that columns do not matter.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn run(arguments: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let program = Command::new(env!("CARGO_BIN_EXE_fmm")).args(arguments.split_whitespace()).current_dir(root).output();
    let output = program.unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "fmm {arguments}: {told}");
    words(&format!("{} {told}", String::from_utf8_lossy(&output.stdout)))
}

#[test]
fn the_page_prints_what_it_says() {
    let mut blocks = PAGE.split("```sh\n").skip(1).peekable();
    assert!(blocks.peek().is_some());
    for block in blocks {
        let (command, rest) = block.split_once("\n```").unwrap();
        let arguments = command.trim().strip_prefix("fmm ").unwrap_or_else(|| panic!("{command} is none of fmm"));
        let (_, lines) = rest.split_once("```text\n").unwrap_or_else(|| panic!("{command} has no result"));
        let (lines, _) = lines.split_once("\n```").unwrap();
        let printed = run(arguments);
        for line in lines.lines() {
            assert!(printed.contains(&words(line)), "fmm {arguments}\ndoes not print: {line}\nbut: {printed}");
        }
    }
}
