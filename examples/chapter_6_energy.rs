//! Chapter 6, friction from energy rates:
//! `cargo run --release --example chapter_6_energy -- [--json] [--figures DIR] [--quick]`.

fn main() -> std::process::ExitCode {
    fmm_thesis::program(fmm_thesis::chapter_6_energy::chapter)
}
