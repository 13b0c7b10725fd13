//! Chapter 7, laws of friction:
//! `cargo run --release --example chapter_7_friction -- [--json] [--figures DIR] [--quick]`.

fn main() -> std::process::ExitCode {
    fmm_thesis::program(fmm_thesis::chapter_7_friction::chapter)
}
