//! Chapter 5 of the thesis, modal parameters:
//! `cargo run --release --example chapter_5_modal -- [--json] [--figures DIR] [--quick]`.
//!
//! What free vibrations tell of mass, stiffness and damping, and what they cannot; the damping that grows with
//! velocity.

fn main() -> std::process::ExitCode {
    fmm_thesis::program(fmm_thesis::chapter_5_modal::chapter)
}
