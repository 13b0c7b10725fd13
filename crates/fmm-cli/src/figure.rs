//! The one file that draws: palette, sizes and tick formats of every figure, on top of the crate `kuva`.
//!
//! Grey is what was measured, red is what was fitted, ink is what is left over.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::{ColorMap, Heatmap, Histogram, LinePlot, ScatterPlot};
use kuva::render::figure::Figure as Grid;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::theme::Theme;

const MEASURED: &str = "#9a9a9a";
const FITTED: &str = "#c8102e";
const RESIDUAL: &str = "#1d2a44";

/// Width of every figure (px).
const WIDTH: f64 = 900.0;
/// Points drawn per horizontal pixel at most; more cannot be seen.
const COLUMNS: usize = 1200;
/// Smallest share of an axis that is left free above the data, for the legend.
const HEADROOM: f64 = 0.28;
/// Height of a line of the legend, and of a panel without its axis (px).
const LINE: f64 = 20.0;
const AROUND: f64 = 75.0;

/// Steps between ticks along x at most, and in the narrow panels of a triangle.
const STEPS: f64 = 8.0;
const CORNER_STEPS: f64 = 3.0;

/// Left and right of the axes (px): equal for all panels, so that their time axes agree.
const MARGINS: (f64, f64) = (90.0, 24.0);

/// The label of an axis, quantity over unit; a unit that is a product or quotient is put in brackets.
pub fn label(quantity: impl std::fmt::Display, unit: &str) -> String {
    if unit.contains(['/', ' ']) { format!("{quantity} / ({unit})") } else { format!("{quantity} / {unit}") }
}

/// Content of a layer; it decides colour and stroke.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A measured curve.
    Measured,
    /// A fitted curve.
    Fitted,
    /// One of many measured curves.
    Each,
    /// Mean of many curves.
    Mean,
    /// Residuals of a fit.
    Residual,
    /// A second model or a truth to compare with.
    Reference,
    /// Single measured points.
    Points,
    /// Single fitted points.
    FittedPoints,
    /// Single points of what is left over, or of a second fit.
    ResidualPoints,
}

impl Role {
    /// Colour, and width of the line (px) unless it is single points.
    fn style(self) -> (&'static str, Option<f64>) {
        match self {
            Self::Measured => (MEASURED, Some(2.4)),
            Self::Fitted => (FITTED, Some(1.1)),
            Self::Each => (MEASURED, Some(0.7)),
            Self::Mean => (FITTED, Some(2.4)),
            Self::Residual => (RESIDUAL, Some(0.8)),
            Self::Reference => (RESIDUAL, Some(1.4)),
            Self::Points => (MEASURED, None),
            Self::FittedPoints => (FITTED, None),
            Self::ResidualPoints => (RESIDUAL, None),
        }
    }
}

/// One curve or set of points.
#[derive(Debug, Clone)]
struct Layer {
    role: Role,
    label: String,
    points: Vec<(f64, f64)>,
}

impl Layer {
    fn plot(&self) -> Plot {
        let (color, width) = self.role.style();
        let (points, label) = (self.points.clone(), self.label.as_str());
        if let Some(width) = width {
            let line = LinePlot::new().with_data(points).with_color(color).with_stroke_width(width);
            return Plot::Line(if label.is_empty() { line } else { line.with_legend(label) });
        }
        let dots = ScatterPlot::new().with_data(points).with_color(color).with_size(3.5);
        Plot::Scatter(if label.is_empty() { dots } else { dots.with_legend(label) })
    }
}

/// Cells of a plane, darker where more is.
#[derive(Debug, Clone)]
pub struct Cells {
    /// Rows from the lowest y on, each from the lowest x on; all of one length.
    pub rows: Vec<Vec<f64>>,
    /// Ends of the first and the last cell along x.
    pub x: (f64, f64),
    /// Ends of the first and the last cell along y.
    pub y: (f64, f64),
}

impl Cells {
    fn plot(&self) -> Plot {
        let rows = self.rows.iter().cloned();
        let map = Heatmap::new().with_data(rows).with_color_map(ColorMap::Custom(Arc::new(|share: f64| {
            let level = (255.0 * (1.0 - share.clamp(0.0, 1.0))).round() as u8;
            format!("#{level:02x}{level:02x}{level:02x}")
        })));
        Plot::Heatmap(map.with_x_range(self.x.0, self.x.1).with_y_range(self.y.0, self.y.1).with_cell_size(1.0))
    }
}

/// Axes with their layers.
#[derive(Debug, Clone)]
pub struct Panel {
    x_label: String,
    y_label: String,
    height: f64,
    /// Ends of the y axis, if it does not follow what is drawn.
    ends: Option<(f64, f64)>,
    is_logarithmic: bool,
    cells: Option<Cells>,
    layers: Vec<Layer>,
}

impl Panel {
    /// Empty axes, `height` pixels high.
    pub fn new(x_label: impl Into<String>, y_label: impl Into<String>, height: f64) -> Self {
        Self {
            x_label: x_label.into(),
            y_label: y_label.into(),
            height,
            ends: None,
            is_logarithmic: false,
            cells: None,
            layers: Vec::new(),
        }
    }

    /// The same axes with the y axis from `low` to `high`.
    #[must_use]
    pub fn between(mut self, low: f64, high: f64) -> Self {
        self.ends = Some((low, high));
        self
    }

    /// The same axes, both logarithmic, for positive coordinates.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.is_logarithmic = true;
        self
    }

    /// The same axes with a curve or single points on top. The legend has each text once, and no empty one.
    #[must_use]
    pub fn with(mut self, role: Role, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (mut label, points) = (label.into(), points.into_iter().collect());
        if self.layers.iter().any(|layer| layer.label == label) {
            label.clear();
        }
        let points = if role.style().1.is_some() { thinned(points) } else { points };
        self.layers.push(Layer { role, label, points });
        self
    }

    /// The same axes with points (x, y, standard uncertainty of y) with bars of two standard uncertainties.
    pub(crate) fn with_bars(self, label: &str, points: &[(f64, f64, f64)]) -> Self {
        /// Points at most; of more, bars say nothing and weigh much.
        const MOST: usize = 100;
        let dots = points.iter().map(|(x, y, _)| (*x, *y));
        let panel = self.with(Role::Points, format!("{label}, with two standard uncertainties"), dots);
        let bars = points.iter().filter(|_| points.len() <= MOST);
        bars.fold(panel, |panel, (x, y, u)| panel.with(Role::Measured, "", [(*x, y - 2.0 * u), (*x, y + 2.0 * u)]))
    }

    /// The same axes with cells below the layers.
    #[must_use]
    pub fn over(mut self, cells: Cells) -> Self {
        self.cells = Some(cells);
        self
    }

    fn plots(&self) -> Vec<Plot> {
        self.cells.iter().map(Cells::plot).chain(self.layers.iter().map(Layer::plot)).collect()
    }

    /// Share of the data's range that the legend needs above it.
    fn headroom(&self) -> f64 {
        let entries = self.layers.iter().filter(|layer| !layer.label.is_empty()).count();
        let share = (LINE * (entries as f64 + 0.8) / (self.height - AROUND).max(LINE)).min(0.6);
        HEADROOM.max(1.05 * share / (1.0 - share))
    }

    /// Layout with this share of the data's range free above it, and at most this number of steps of ticks along x.
    fn layout_below(&self, headroom: f64, steps: f64) -> Layout {
        let corners = self.cells.iter().flat_map(|cells| [(cells.x.0, cells.y.0), (cells.x.1, cells.y.1)]);
        let points = self.layers.iter().flat_map(|layer| layer.points.iter().copied());
        let shown: Vec<(f64, f64)> = corners.chain(points).collect();
        let all = || shown.iter();
        let (x_low, x_high) = range(all().map(|point| point.0));
        let (y_low, y_high) = range(all().map(|point| point.1));
        if self.is_logarithmic {
            let beyond = |(low, high): (f64, f64), below: f64, above: f64| {
                (low * (high / low).powf(-below), high * (high / low).powf(above))
            };
            let x = (&*self.x_label, beyond((x_low, x_high), 0.015, 0.015));
            return framed(&self.plots(), x, (&self.y_label, beyond((y_low, y_high), 0.05, headroom)))
                .with_log_scale()
                .with_tick_format(TickFormat::Custom(Arc::new(|value: f64| value.to_string())));
        }
        let (width, height) = (x_high - x_low, y_high - y_low);
        if let Some((low, high)) = self.ends {
            let x = (&*self.x_label, (x_low - 0.015 * width, x_high + 0.015 * width));
            return framed(&self.plots(), x, (&self.y_label, (low, high)))
                .with_x_tick_step(step(width, steps))
                .with_x_tick_format(ticks(width))
                .with_y_tick_step((high - low) / 4.0)
                .with_y_tick_format(ticks(high - low));
        }
        framed(
            &self.plots(),
            (&self.x_label, (x_low - 0.015 * width, x_high + 0.015 * width)),
            (&self.y_label, (y_low - 0.05 * height, y_high + headroom * height)),
        )
        .with_x_tick_step(step(width, steps))
        .with_x_tick_format(ticks(width))
        .with_y_tick_format(ticks((1.05 + headroom) * height))
    }
}

/// Panels one below the other, as SVG.
pub fn drawn(panels: &[Panel]) -> String {
    let heights: Vec<f64> = panels.iter().map(|panel| panel.height).collect();
    let mut grid = Grid::new(panels.len(), 1)
        .with_plots(panels.iter().map(Panel::plots).collect())
        .with_layouts(panels.iter().map(|panel| panel.layout_below(panel.headroom(), STEPS)).collect())
        .with_keep_panel_legends()
        .with_cell_size(WIDTH, heights[0]);
    for (row, height) in heights.into_iter().enumerate() {
        grid = grid.with_row_height(row, height);
    }
    renumbered(&SvgBackend.render_scene(&grid.render()))
}

/// Panels of a triangle, row below row with one more in each, as SVG; all as high as the first, and without room for a
/// legend.
pub fn drawn_corner(rows: &[Vec<Panel>]) -> String {
    let count = rows.len();
    let cells = || rows.iter().flat_map(|row| row.iter().map(Some).chain(std::iter::repeat_n(None, count - row.len())));
    let layout = |panel: Option<&Panel>| {
        panel.map_or_else(|| Layout::new((0.0, 1.0), (0.0, 1.0)), |panel| panel.layout_below(0.03, CORNER_STEPS))
    };
    let grid = Grid::new(count, count)
        .with_plots(cells().map(|panel| panel.map_or_else(Vec::new, Panel::plots)).collect())
        .with_layouts(cells().map(layout).collect())
        .with_keep_panel_legends();
    let height = rows.first().and_then(|row| row.first()).map_or(0.0, |panel| panel.height);
    renumbered(&SvgBackend.render_scene(&grid.with_cell_size(1.25 * height, height).render()))
}

/// The histogram of `values` with the normal density of the same mean and standard deviation, as SVG.
pub fn histogram(x_label: &str, name: &str, values: &[f64]) -> String {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    // Four standard deviations either way, so that a few outliers do not squeeze the picture.
    let (low, high) = (mean - 4.0 * deviation, mean + 4.0 * deviation);
    let bins = 60usize;
    let width = (high - low) / bins as f64;
    let mut counts = vec![0.0; bins];
    for value in values {
        if let Some(bin) = counts.get_mut(((value - low) / width) as usize).filter(|_| *value >= low) {
            *bin += 1.0;
        }
    }
    let density: Vec<f64> = counts.iter().map(|n| n / (count * width)).collect();
    let edges = (0..=bins).map(|i| low + i as f64 * width).collect();
    let normal: Vec<(f64, f64)> = (0..=200)
        .map(|i| {
            let x = low + (high - low) * f64::from(i) / 200.0;
            let z = (x - mean) / deviation;
            (x, (-0.5 * z * z).exp() / (deviation * (2.0 * std::f64::consts::PI).sqrt()))
        })
        .collect();
    let top = normal.iter().map(|point| point.1).chain(density.iter().copied()).fold(0.0, f64::max);
    let plots = vec![
        Plot::Histogram(Histogram::from_bins(edges, density).with_color(MEASURED).with_legend(name)),
        Layer { role: Role::Fitted, label: "normal density".to_owned(), points: normal }.plot(),
    ];
    let layout = framed(&plots, (x_label, (low, high)), ("density", (0.0, top * (1.0 + HEADROOM))))
        .with_x_tick_step(step(high - low, STEPS))
        .with_x_tick_format(ticks(high - low))
        .with_y_tick_format(ticks(top));
    let grid = Grid::new(1, 1).with_plots(vec![plots]).with_layouts(vec![layout]).with_keep_panel_legends();
    renumbered(&SvgBackend.render_scene(&grid.with_cell_size(0.7 * WIDTH, 380.0).render()))
}

/// The same picture with the names of its clip paths counted within it: `kuva` counts them through a process, so that
/// the same picture would have other bytes each time.
fn renumbered(svg: &str) -> String {
    const NAME: &str = "kuva-clip-";
    let mut parts = svg.split(NAME);
    let mut text = parts.next().unwrap_or_default().to_owned();
    let mut seen: Vec<&str> = Vec::new();
    for part in parts {
        let end = part.find(|character: char| !character.is_ascii_digit()).unwrap_or(part.len());
        let (number, rest) = part.split_at(end);
        let place = seen.iter().position(|other| *other == number).unwrap_or_else(|| {
            seen.push(number);
            seen.len() - 1
        });
        text.extend([NAME, &place.to_string(), rest]);
    }
    text
}

/// Fonts, frame and legend that all figures share, with the label and the range of each axis.
fn framed(
    plots: &[Plot],
    (x_label, (x_low, x_high)): (&str, (f64, f64)),
    (y_label, (y_low, y_high)): (&str, (f64, f64)),
) -> Layout {
    let mut layout = Layout::auto_from_plots(plots);
    let theme = Theme { font_family: Some("Helvetica, Arial, sans-serif".into()), ..Theme::minimal() };
    // The bar of shades that `kuva` adds to cells would lie on them, as all panels have the same margins.
    layout.show_colorbar = false;
    layout
        .with_theme(theme)
        .with_label_size(14)
        .with_tick_size(12)
        .with_body_size(12)
        .with_legend_position(kuva::plot::LegendPosition::InsideTopRight)
        .with_legend_box(false)
        .with_ticks(6)
        .with_x_label(x_label)
        .with_y_label(y_label)
        .with_x_axis_min(x_low)
        .with_x_axis_max(x_high)
        .with_y_axis_min(y_low)
        .with_y_axis_max(y_high)
        .with_force_margins(MARGINS.0, MARGINS.1)
}

/// The smallest tick step of 1, 2 or 5 times a power of ten of which `span` has `most` at most.
fn step(span: f64, most: f64) -> f64 {
    let power = 10f64.powf((span / most).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    steps.into_iter().find(|step| span / step <= most).unwrap_or(10.0 * power)
}

/// Enough decimals for about six ticks over `span`.
fn ticks(span: f64) -> TickFormat {
    let step = span / 6.0;
    if !(1e-4..1e5).contains(&step) {
        return TickFormat::Sci;
    }
    // One more than the leading digit of the step, as steps of 2.5 are common; none that is always zero.
    let decimals = (1.0 - step.log10().floor()).max(0.0) as usize;
    TickFormat::Custom(Arc::new(move |value: f64| {
        let text = format!("{value:.decimals$}");
        let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        short.replace('-', "−")
    }))
}

/// The smallest and the largest value; infinite and in the wrong order without any.
pub(crate) fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = ends(values);
    if low < high { (low, high) } else { (low - 1.0, low + 1.0) }
}

/// At most two points per column, the lowest and the highest: what a pen would leave on paper.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    if points.len() <= 2 * COLUMNS {
        return points;
    }
    let mut kept = Vec::with_capacity(2 * COLUMNS);
    for column in points.chunks(points.len().div_ceil(COLUMNS)) {
        let by_height = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        if let (Some(low), Some(high)) = (column.iter().min_by(by_height), column.iter().max_by(by_height)) {
            let mut pair = [*low, *high];
            pair.sort_by(|a, b| a.0.total_cmp(&b.0));
            kept.extend(pair);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_picture_has_the_same_bytes() {
        let panels = || {
            let panel = |y| Panel::new("x", "y", 200.0).with(Role::Fitted, "line", [(0.0, 0.0), (1.0, y)]);
            drawn(&[panel(1.0), panel(2.0)])
        };
        let first = panels();
        assert!(first == panels() && first.matches("id=\"kuva-clip-1\"").count() == 1);
    }

    #[test]
    fn equal_ratios_are_equal_distances_on_logarithmic_axes() {
        let panel = Panel::new("x", "y", 300.0).logarithmic().with(Role::Fitted, "", [(1.0, 0.1), (1000.0, 10.0)]);
        let svg = drawn(&[panel]);
        let place = |tick: &str| -> f64 {
            let before = svg.split(&format!(">{tick}</text>")).next().unwrap();
            before.rsplit("<text x=\"").next().unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let decades = [place("10") - place("1"), place("100") - place("10"), place("1000") - place("100")];
        assert!(decades.iter().all(|decade| (decade - decades[0]).abs() < 1.0 && *decade > 100.0), "{decades:?}");
    }
}
