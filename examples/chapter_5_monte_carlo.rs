//! Chapter 5.3 of the thesis, Monte Carlo:
//! `cargo run --release --example chapter_5_monte_carlo -- [--json] [--figures DIR] [--quick]`.
//!
//! Table 3 by derivatives, by refits of the exact motion and by refits of the thesis' own, beside what is printed.

fn main() -> std::process::ExitCode {
    fmm_thesis::program(fmm_thesis::chapter_5_monte_carlo::chapter)
}
