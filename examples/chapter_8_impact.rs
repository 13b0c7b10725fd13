//! Chapter 8, blows of a hammer:
//! `cargo run --release --example chapter_8_impact -- [--json] [--figures DIR] [--quick]`.

fn main() -> std::process::ExitCode {
    fmm_thesis::program(fmm_thesis::chapter_8_impact::chapter)
}
