//! The program `fmm`.

use std::process::ExitCode;

fn main() -> ExitCode {
    fmm_cli::run(std::env::args_os())
}
