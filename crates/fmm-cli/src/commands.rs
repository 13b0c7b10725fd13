//! The commands of the program, and what it tells the shell.

use std::error::Error;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;

use crate::answer::Answer;
use crate::files::create_folder;
use crate::host::Host;
use crate::output::{Form, Output, Wanted, print, print_refusal};
use crate::refusal::Refusal;
use crate::{backbone, batch, budget, design, force, frf, identify, lists, simulate};

/// Friction parameters out of ring-down, driven, force and impact records, with uncertainties that can be defended.
#[derive(Debug, Parser)]
#[command(name = "fmm", version, after_help = AFTER_HELP, max_term_width = 120)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

const AFTER_HELP: &str = "Begin with `fmm identify`, which takes a bundled record. Exit codes: 0 found, 1 refused or \
                          failed, 2 wrong usage. Results go to standard output, everything else to \
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
    /// Estimate the frequency response of a machine from impact tests, and its modes from these or measured responses
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
        #[command(flatten)]
        form: Form,
    },
    /// List the file formats that are read
    Formats {
        #[command(flatten)]
        form: Form,
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
    let is_json = |argument: &OsString| argument.to_str().is_some_and(|a| a == "--json" || a.starts_with("--json="));
    let wants_json = arguments.iter().take_while(|argument| *argument != "--").any(is_json);
    // What cannot be printed cannot be told either.
    let refuse = |refusal: &Refusal| drop(wants_json.then(|| print_refusal(refusal)));
    let line = line(&arguments);
    let program = match Program::try_parse_from(arguments) {
        Ok(program) => program,
        Err(error) => {
            if error.use_stderr() {
                refuse(&Refusal::usage(&error));
            }
            // There is nowhere left to say that this could not be printed.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let wanted = program.command.wanted();
    let answer = wanted.check().and_then(|()| program.command.answer(&line, &Host::default()));
    let done = match answer.and_then(|answer| {
        answer.as_deref().map_or(Ok(()), |answer| wanted.give_out(answer))?;
        Ok(answer)
    }) {
        Ok(answer) => answer.map_or(Ok(()), |answer| answer.verdict()),
        Err(error) => {
            refuse(&Refusal::of(&*error));
            Err(error.to_string())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The answer of a command for a host that is no shell: `arguments` are those of [`run`], and nothing is printed. What
/// says in which form a result is given out (`--json`, `--figures`, `--report`) has no effect.
///
/// ```
/// use fmm_cli::{Answer, Detail, Host, answer};
///
/// let budget = r#"{"input": [{"name": "a", "unit": "m", "value": 2, "u": 0.1}],
///                  "result": [{"name": "y", "unit": "m", "formula": "3*a"}]}"#;
/// let host = Host::default().with_file("budget.json", budget.into());
/// let answer: Box<dyn Answer> = answer(["fmm", "budget", "budget.json", "--trials", "10000"], &host)?;
/// assert!(answer.document(Detail::Brief).unwrap().contains("\"estimate\": 6.0"));
/// # Ok::<(), fmm_cli::Refusal>(())
/// ```
///
/// # Errors
/// Fault of the arguments or of the input, in the words of the program.
pub fn answer(
    arguments: impl IntoIterator<Item = impl Into<OsString>>,
    host: &Host<'_>,
) -> Result<Box<dyn Answer>, Refusal> {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let line = line(&arguments);
    let program = Program::try_parse_from(arguments).map_err(|error| Refusal::usage(&error))?;
    let answer = program.command.answer(&line, host).map_err(|error| Refusal::of(&*error))?;
    answer.ok_or_else(|| Refusal {
        code: "usage",
        message: "this command has no answer but files or scripts".to_owned(),
        remedy: Some("run it in a shell".to_owned()),
    })
}

/// The command line as it was typed.
fn line(arguments: &[OsString]) -> String {
    let rest: Vec<_> = arguments.iter().skip(1).map(|argument| argument.to_string_lossy()).collect();
    format!("fmm {}", rest.join(" "))
}

impl Command {
    /// Answer of a command; `None` for one that writes by itself. `line` is what was typed.
    fn answer(&self, line: &str, host: &Host<'_>) -> Result<Option<Box<dyn Answer>>, Box<dyn Error>> {
        Ok(Some(match self {
            Self::Identify(arguments) => Box::new(identify::identify(arguments, line, host)?),
            Self::Compare(arguments) => Box::new(identify::compare(arguments, line, host)?),
            Self::Force(arguments) => Box::new(force::force(arguments, host)?),
            Self::Backbone(arguments) => Box::new(backbone::backbone(arguments, host)?),
            Self::Simulate(arguments) => Box::new(simulate::simulate(arguments, host)?),
            Self::Frf(arguments) => frf::frf(arguments, host)?,
            Self::Budget(arguments) => Box::new(budget::budget(arguments, host)?),
            Self::Design(arguments) => Box::new(design::design(arguments, host)?),
            Self::Batch(arguments) => batch::batch(arguments, host)?,
            Self::Merge(arguments) => Box::new(batch::merge(arguments, host)?),
            Self::Laws { .. } => Box::new(lists::laws()),
            Self::Formats { .. } => Box::new(lists::formats()),
            Self::Completions { shell } => return completions(*shell).map(|()| None),
            Self::Manual { folder } => return manual(folder).map(|()| None),
        }))
    }

    /// Forms in which the answer is wanted.
    fn wanted(&self) -> Wanted {
        let of_form = |form: &Form| Output { form: form.clone(), ..Output::default() };
        let output = match self {
            Self::Identify(arguments) | Self::Compare(arguments) => return arguments.wanted(),
            Self::Force(force::Arguments { output, .. })
            | Self::Backbone(backbone::Arguments { output, .. })
            | Self::Simulate(simulate::Arguments { output, .. })
            | Self::Frf(frf::Arguments { output, .. })
            | Self::Design(design::Arguments { output, .. }) => output.clone(),
            Self::Budget(budget::Arguments { form, .. })
            | Self::Batch(batch::Arguments { form, .. })
            | Self::Merge(batch::Merge { form, .. })
            | Self::Laws { form }
            | Self::Formats { form } => of_form(form),
            Self::Completions { .. } | Self::Manual { .. } => Output::default(),
        };
        Wanted { output, report: None }
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
    use std::ops::ControlFlow;

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

    /// A host hears how far a fit is, ends it, and gives files that are on no disk.
    #[test]
    fn a_host_watches_stops_and_gives_files() {
        let told = std::sync::Mutex::new(Vec::new());
        let line = ["fmm", "identify", "run", "--law", "coulomb"];
        let run = include_bytes!("../../../examples/data/flexure/run_1.csv");
        let host = Host::default().with_file("run", run.to_vec()).watched_by(|step| {
            told.lock().unwrap().push(step.to_owned());
            ControlFlow::Continue(())
        });
        let found = answer(line, &host).unwrap_or_else(|refusal| panic!("{refusal:?}"));
        assert!(found.text().unwrap().starts_with("run, channel velocity"));
        assert!(told.lock().unwrap().iter().any(|step| step.starts_with("coulomb: step ")), "{told:?}");
        let host = Host::default().with_file("run", run.to_vec()).watched_by(|_| ControlFlow::Break(()));
        let refusal = answer(line, &host).err().expect("a stopped fit is no answer");
        assert!(refusal.message.contains("stopped before the end"), "{refusal:?}");
        let refusal = answer(["fmm", "identify", "run"], &Host::default()).err().expect("there is no such file");
        assert_eq!(refusal.code, "unreadable");
    }
}
