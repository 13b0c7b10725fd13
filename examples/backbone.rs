//! A first look at a decay, in a few lines: `cargo run --release --example backbone`.
//!
//! The program `fmm backbone` does the same for any file, and draws it.

use std::error::Error;
use std::path::Path;

use fmm_frf::{Backbone, BackboneOptions, decay_modes};
use fmm_record::{Quantity, Reader};

fn main() -> Result<(), Box<dyn Error>> {
    // A pendulum of 1.6 rad.
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/single_pendulum_55s_1khz.csv");
    let reader = Reader::default().channel("theta_rad").quantity(Quantity::Displacement).unit("rad");
    let record = reader.read(file)?.record;
    for mode in decay_modes(&record).iter().filter(|mode| mode.multiple.is_none()) {
        println!("mode at {:.3} Hz with {:.1} % of the energy", mode.frequency, 100.0 * mode.share);
    }

    let backbone = Backbone::of(&record, &BackboneOptions::default())?;
    for point in backbone.points().iter().step_by(8) {
        println!(
            "A = {} {}, f = {} Hz, c/m = {} 1/s",
            point.amplitude,
            backbone.unit(),
            point.frequency,
            point.damping
        );
    }
    println!("suggested: {}", backbone.suggestion());
    // The series of the sine begins with k3 = -1/6.
    println!("k3 = {}", backbone.spring()[1]);
    Ok(())
}
