//! Section 9.2, future work: `cargo run --release --example chapter_9_future -- [--json] [--figures DIR] [--quick]`.

fn main() -> std::process::ExitCode {
    fmm_thesis::program(fmm_thesis::chapter_9_future::chapter)
}
