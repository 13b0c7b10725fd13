//! Many modes of one or several measured responses.

mod band;
mod columns;
mod diagram;
mod estimation;
mod measured;
mod modal_fit;
mod mode;
mod normal_equations;
mod options;
mod partial_fractions;
mod pole;
mod refinement;
mod table;
mod tracks;
mod universal;
mod windows;

pub use diagram::{DiagramPole, StabilisationDiagram};
pub use measured::MeasuredResponse;
pub use modal_fit::ModalFit;
pub use mode::{Mode, Residue, ShapePoint};
pub use options::ModalOptions;
pub use pole::Pole;
