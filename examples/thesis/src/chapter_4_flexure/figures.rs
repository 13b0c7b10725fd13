//! Figures 3 to 6, as far as they can be computed.

use super::motion::FreeVibration;
use crate::{Chapter, Found};
use fmm_cli::figure::{Panel, Role, label};

/// Draws the releases from 6 mm and from 22 mm.
pub(super) fn draw(chapter: &mut Chapter, six: &FreeVibration, twenty_two: &FreeVibration) -> Found<()> {
    chapter.figure(
        "figure_3",
        "Figs. 3 and 4: a free vibration from 6 mm, simulated with the machine of Table 2 and the damping of Eq. 5.5, and its \
         parasitic motion by Eq. 4.3 from the integrated velocity. The measured motion was not published.",
        &[
            Panel::new("time / s", label("velocity x′", "mm/s"), 250.0).with(
                Role::Measured,
                "simulated record",
                six.velocity.times().zip(six.velocity.values().iter().map(|v| 1e3 * v)),
            ),
            Panel::new("time / s", label("parasitic motion y", "µm"), 250.0).with(
                Role::Fitted,
                "Eq. 4.3",
                six.parasitic.times().zip(six.parasitic.values().iter().map(|y| 1e6 * y)),
            ),
        ],
    );
    let cycle = six.position.crop(0.0, 0.456)?;
    let path = cycle.values().iter().zip(six.parasitic.values());
    chapter.figure(
        "figure_5",
        "Fig. 5: parasitic against linear motion over one cycle of the same simulated vibration. The measured loop was not \
         published.",
        &[Panel::new("linear motion x / mm", label("parasitic motion y", "µm"), 300.0).with(
            Role::Fitted,
            "Eq. 4.3",
            path.map(|(x, y)| (1e3 * x, 1e6 * y)),
        )],
    );
    let curve = |values: &[f64]| twenty_two.velocity.times().zip(values.iter().map(|v| 1e3 * v)).collect::<Vec<_>>();
    chapter.figure(
        "figure_6",
        "Fig. 6: a free vibration from 22 mm, simulated likewise. Top: both velocities. Middle: the speed along the path, with \
         the sign of the velocity, over the velocity. Bottom: what the parasitic motion adds, which no eye finds in the middle.",
        &[
            Panel::new("time / s", label("velocity", "mm/s"), 320.0)
                .with(Role::Measured, "simulated x′", curve(twenty_two.velocity.values()))
                .with(Role::Fitted, "parasitic y′", curve(twenty_two.parasitic_velocity.values())),
            Panel::new("time / s", label("velocity", "mm/s"), 320.0)
                .with(Role::Measured, "simulated x′", curve(twenty_two.velocity.values()))
                .with(Role::Fitted, "resultant", curve(twenty_two.resultant.values())),
            Panel::new("time / s", label("difference", "mm/s"), 200.0).with(
                Role::Residual,
                "speed less |x′|",
                curve(&twenty_two.excess()),
            ),
        ],
    );
    Ok(())
}
