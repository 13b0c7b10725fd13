//! Chapter 4, the flexure: `cargo run --release --example chapter_4_flexure -- [--json] [--figures DIR] [--quick]`.

fn main() -> std::process::ExitCode {
    fmm_thesis::program(fmm_thesis::chapter_4_flexure::chapter)
}
