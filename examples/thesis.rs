//! The whole thesis beside ours, as a page and a document in `target/thesis`:
//! `cargo run --release --example thesis -- [--out DIR] [--quick] [--seed N]`.

fn main() -> std::process::ExitCode {
    fmm_thesis::report::program()
}
