//! The modes of a structure from its measured responses, in a few lines: `cargo run --release --example modes`.
//!
//! The program `fmm frf --modes` does the same for any files, and draws the stabilisation diagram.

use std::error::Error;
use std::path::Path;

use fmm_frf::{DiagramPole, MeasuredResponse, ModalFit, ModalOptions, ShapePoint, StabilisationDiagram};
use fmm_record::uff::UffFile;

/// Number of stable poles among all of a diagram.
fn stable(diagram: &StabilisationDiagram) -> usize {
    diagram.poles().iter().filter(|pole: &&DiagramPole| pole.is_stable()).count()
}

fn main() -> Result<(), Box<dyn Error>> {
    // Receptances of six masses in a chain, for a force on the first, in a binary Universal File.
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/fmm-frf/tests/data/chain_of_six.uff");
    let responses = MeasuredResponse::of_universal(&UffFile::read(file)?, None, None)?;
    let fit = ModalFit::of(&responses, &ModalOptions::default().within(1.0, 250.0))?;
    println!("{} of {} poles are stable", stable(fit.diagram()), fit.diagram().poles().len());
    for mode in fit.modes() {
        let point = |point: &ShapePoint| format!("{:6.3}", point.deflection.value);
        println!("{mode}, shape {}", mode.shape.iter().map(point).collect::<Vec<_>>().join(" "));
    }
    println!("left over: {:.2} % of a response at most", 100.0 * fit.misfits().iter().copied().fold(0.0, f64::max));
    Ok(())
}
