//! The commands of the program, and what it tells the shell.

use std::error::Error;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;

use crate::files::create_folder;
use crate::output::print;
use crate::{backbone, batch, budget, design, force, frf, identify, lists, simulate};

/// Friction parameters out of ring-down, driven, force and impact records, with uncertainties that can be defended.
#[derive(Debug, Parser)]
#[command(name = "fmm", version, after_help = AFTER_HELP, max_term_width = 120)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

const AFTER_HELP: &str = "Begin with `fmm identify`, which takes a bundled record. Exit codes: 0 found, 1 refused or failed, 2 wrong usage. Results go to standard output, everything else to \
                          standard error. `fmm COMMAND --help` explains a command.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Find the friction, damping and frequency of a machine from the record of its vibration
    #[command(allow_negative_numbers = true)]
    Identify(identify::Arguments),
    /// Compare laws of friction by one record
    #[command(allow_negative_numbers = true)]
    Compare(identify::Arguments),
    /// Fit friction to a measured force along a measured motion
    #[command(allow_negative_numbers = true)]
    Force(force::Arguments),
    /// Show the modes of a decay, and how frequency and damping of one go with its amplitude
    #[command(allow_negative_numbers = true)]
    Backbone(backbone::Arguments),
    /// Simulate a machine with a sliding contact
    #[command(after_help = simulate::HELP)]
    Simulate(simulate::Arguments),
    /// Estimate the frequency response of a machine from impact tests
    #[command(allow_negative_numbers = true)]
    Frf(frf::Arguments),
    /// State the uncertainty of a result that follows from others by a formula
    #[command(after_help = budget::HELP)]
    Budget(budget::Arguments),
    /// Say which tests to make next: what each would tell, and which set of them tells most
    #[command(after_help = design::HELP)]
    Design(design::Arguments),
    /// Identify many records, each by itself and all together
    Batch(batch::Arguments),
    /// Put the parts of a campaign together
    Merge(batch::Merge),
    /// List the laws of friction with their parameters
    Laws {
        /// Print one JSON document instead of text
        #[arg(long)]
        json: bool,
    },
    /// List the file formats that are read
    Formats {
        /// Print one JSON document instead of text
        #[arg(long)]
        json: bool,
    },
    /// Print the completions for a shell
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Write the manual pages into a folder
    Manual {
        /// The folder
        folder: PathBuf,
    },
}

/// Runs the program with `arguments`, of which the first is its name. The code for the shell is 0 for a result, 1 for
/// input that is refused or a search that fails, and 2 for wrong usage.
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString>>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let rest: Vec<_> = arguments.iter().skip(1).map(|argument| argument.to_string_lossy()).collect();
    let command = format!("fmm {}", rest.join(" "));
    let program = match Program::try_parse_from(arguments) {
        Ok(program) => program,
        Err(error) => {
            // There is nowhere left to say that this could not be printed.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let done = match &program.command {
        Command::Identify(arguments) => identify::identify(arguments, &command),
        Command::Compare(arguments) => identify::compare(arguments, &command),
        Command::Force(arguments) => force::run(arguments),
        Command::Backbone(arguments) => backbone::run(arguments),
        Command::Simulate(arguments) => simulate::run(arguments),
        Command::Frf(arguments) => frf::run(arguments),
        Command::Budget(arguments) => budget::run(arguments),
        Command::Design(arguments) => design::run(arguments),
        Command::Batch(arguments) => batch::run(arguments),
        Command::Merge(arguments) => batch::merge(arguments),
        Command::Laws { json } => lists::laws(*json),
        Command::Formats { json } => lists::formats(*json),
        Command::Completions { shell } => completions(*shell),
        Command::Manual { folder } => manual(folder),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn completions(shell: Shell) -> Result<(), Box<dyn Error>> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Program::command(), "fmm", &mut script);
    print(String::from_utf8_lossy(&script).trim_end())
}

fn manual(folder: &std::path::Path) -> Result<(), Box<dyn Error>> {
    create_folder(folder)?;
    clap_mangen::generate_to(Program::command(), folder)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commands_are_consistent() {
        Program::command().debug_assert();
    }

    #[test]
    fn what_is_mistyped_gets_the_nearest_name() {
        let told = |arguments: &[&str]| Program::try_parse_from(arguments).unwrap_err().to_string();
        let option = told(&["fmm", "identify", "--chanel", "x"]);
        assert!(option.contains("a similar argument exists: '--channel'"), "{option}");
        let command = told(&["fmm", "identfy"]);
        assert!(command.contains("a similar subcommand exists: 'identify'"), "{command}");
    }

    #[test]
    fn help_is_wrapped() {
        for command in Program::command().get_subcommands_mut() {
            let help = command.clone().max_term_width(120).render_long_help().to_string();
            let longest = help.lines().max_by_key(|line| line.chars().count()).unwrap_or_default();
            assert!(longest.chars().count() <= 120, "{}: {longest}", command.get_name());
        }
    }

    #[test]
    fn wrong_usage_is_told_from_what_is_refused() {
        let code = |arguments: &[&str]| format!("{:?}", run(arguments.iter().copied()));
        assert_eq!(code(&["fmm", "laws"]), format!("{:?}", ExitCode::SUCCESS));
        assert_eq!(code(&["fmm", "identify", "no such file.csv"]), format!("{:?}", ExitCode::FAILURE));
        assert_eq!(code(&["fmm", "identify", "--no-such-option"]), format!("{:?}", ExitCode::from(2)));
        assert_eq!(code(&["fmm", "--help"]), format!("{:?}", ExitCode::SUCCESS));
    }
}
