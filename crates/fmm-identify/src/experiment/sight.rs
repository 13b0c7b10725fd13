//! Motion as a sensor sees it: the channel that was recorded, behind the filter of the sensor.

use fmm_model::Scalar;
use fmm_record::Quantity;
use fmm_sim::{Channels, Samples, Trajectory};

use crate::experiment::Experiment;
use crate::experiment::Filter;

/// View of an experiment on a motion that is simulated window by window.
pub(crate) struct Sight {
    quantity: Quantity,
    filtering: Option<Filtering>,
}

/// Filters of the values and of each direction of derivative, and what they gave in the last window.
struct Filtering {
    fresh: Filter,
    filters: Vec<Filter>,
    columns: Vec<Vec<f64>>,
    /// Filters with the corner a little lower and higher, if it is fitted.
    beside: Option<Beside>,
}

struct Beside {
    filters: [Filter; 2],
    columns: [Vec<f64>; 2],
    /// Difference of the two corners (Hz).
    difference: f64,
}

/// Relative step of the corner for its derivative. The output is analytic in it: the error is of the order of the
/// step's square.
const STEP: f64 = 1e-4;

impl Sight {
    /// View of `experiment` with the `corner` (Hz) of its sensor, if that filters.
    pub(crate) fn of(experiment: &Experiment, corner: Option<f64>) -> Self {
        let (sensor, interval) = (experiment.sensor(), experiment.record().interval());
        let filtering = corner.map(|corner| Filtering {
            fresh: sensor.filter(corner, interval),
            filters: Vec::new(),
            columns: Vec::new(),
            beside: sensor.has_free_corner().then(|| Beside {
                filters: [1.0 - STEP, 1.0 + STEP].map(|factor| sensor.filter(factor * corner, interval)),
                columns: [Vec::new(), Vec::new()],
                difference: 2.0 * STEP * corner,
            }),
        });
        Self { quantity: experiment.record().quantity(), filtering }
    }

    /// True if a filter remembers what came before a window.
    pub(crate) fn is_filtered(&self) -> bool {
        self.filtering.is_some()
    }

    /// Channels to be simulated. The rate of a filtered velocity is the filtered acceleration, without the error that a
    /// jump between two samples makes.
    pub(crate) fn channels(&self) -> Channels {
        match self.quantity {
            Quantity::Displacement => Channels::Position,
            Quantity::Acceleration if !self.is_filtered() => Channels::All,
            _ => Channels::Velocity,
        }
    }

    /// View of the next window.
    pub(crate) fn see<'s, D: Scalar>(&'s mut self, trajectory: &'s Trajectory<D>) -> Seen<'s, D> {
        let samples = match self.channels() {
            Channels::Position => trajectory.position(),
            Channels::All => trajectory.acceleration(),
            _ => trajectory.velocity(),
        };
        let wants_rate = self.quantity == Quantity::Acceleration;
        let Some(filtering) = &mut self.filtering else { return Seen::Plain(samples) };
        let Filtering { fresh, filters, columns, beside } = filtering;
        filters.resize(1 + D::DIRECTIONS, fresh.clone());
        columns.resize(1 + D::DIRECTIONS, Vec::new());
        let inputs = std::iter::once(Some(samples.values())).chain((0..D::DIRECTIONS).map(|at| samples.partial(at)));
        for ((filter, column), input) in filters.iter_mut().zip(columns.iter_mut()).zip(inputs) {
            column.clear();
            filter.run(input.unwrap_or_default(), wants_rate, column);
        }
        if let Some(Beside { filters, columns, difference }) = beside {
            for (filter, column) in filters.iter_mut().zip(columns.iter_mut()) {
                column.clear();
                filter.run(samples.values(), wants_rate, column);
            }
            let [below, above] = columns;
            above.iter_mut().zip(below).for_each(|(above, below)| *above = (*above - *below) / *difference);
        }
        Seen::Filtered(
            filtering.columns.as_slice(),
            filtering.beside.as_ref().map(|beside| beside.columns[1].as_slice()),
        )
    }
}

/// A window of samples as they are seen, with their derivatives.
pub(crate) enum Seen<'a, D> {
    /// Samples as they were simulated.
    Plain(&'a Samples<D>),
    /// Filtered values and columns of derivatives, and the derivatives by the corner of the filter, if it is fitted.
    Filtered(&'a [Vec<f64>], Option<&'a [f64]>),
}

impl<D: Scalar> Seen<'_, D> {
    /// The values.
    pub(crate) fn values(&self) -> &[f64] {
        match self {
            Self::Plain(samples) => samples.values(),
            Self::Filtered(columns, _) => &columns[0],
        }
    }

    /// The derivatives in one direction, if the number carries it.
    pub(crate) fn partial(&self, direction: usize) -> Option<&[f64]> {
        match self {
            Self::Plain(samples) => samples.partial(direction),
            Self::Filtered(columns, _) => columns.get(1 + direction).map(Vec::as_slice),
        }
    }

    /// The derivatives by the corner frequency of the sensor, if it is fitted.
    pub(crate) fn by_corner(&self) -> Option<&[f64]> {
        match self {
            Self::Plain(_) => None,
            Self::Filtered(_, by_corner) => *by_corner,
        }
    }
}
