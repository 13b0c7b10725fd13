//! The search for the ends of a profile interval.

use std::time::Instant;

use fmm_model::Rounded;

use crate::error::FitError;
use crate::fitting::solve::solve;
use crate::problem::knowledge::WithFixed;
use crate::problem::residuals::Residuals;
use crate::result::estimate::EstimateStatus;
use crate::result::fit::Fit;
use crate::solver::minimizer::Minimizer;
use crate::solver::options::Options;
use crate::solver::outcome::Outcome;
use crate::uncertainty::profile_interval::{ProfileEnd, ProfileInterval, ResidualVariance};

/// Farthest distance of a search for an end, in first guesses of it (1).
const FARTHEST: f64 = 1e9;
/// A sum of squares lower by more than this share of the threshold means that the fit was not at its minimum.
const LOWER: f64 = 1e-6;
/// Relative accuracy of t at an end; the interval is as accurate.
const ACCURACY: f64 = 1e-10;

/// Even steps of a curve beyond each end, as a share of its distance from the estimate.
const BEYOND: f64 = 0.15;

impl ProfileInterval {
    /// The interval that covers the parameter called `name` with probability `level`, from the sum of squares itself
    /// instead of its curvature at the minimum.
    ///
    /// ```text
    /// S_k(θ) = min S over all other parameters with θ_k = θ
    /// (S_k(θ) − S_min)/s² = t²,     t = t_{(1 + level)/2, ν}
    /// ```
    ///
    /// s² and ν are those of the `variance`: S_min over the degrees of freedom; 1; or another estimate.
    ///
    /// For a linear model this is [`Fit::interval`]. For others it follows the bends of the valley and is that of any
    /// monotonic reparametrisation, which the Wald interval is not; where a parameter ends at a bound it is one-sided.
    /// An end is open if the profile stays below its threshold a thousand million first guesses away.
    ///
    /// `fit` must be the fit of `problem`; each point of the profile is a fit from the nearest ones before. The limit
    /// of the options on iterations holds for each of them, those on evaluations and time for all.
    ///
    /// ```
    /// # use fmm_fit::EvaluationError;
    /// use fmm_fit::{Options, ProfileEnd, ProfileInterval, ResidualVariance, Residuals, solve};
    /// # use fmm_model::Parameter;
    ///
    /// # struct Rise<'a>(&'a [(f64, f64)], [Parameter; 2]);
    /// # impl Residuals for Rise<'_> {
    /// #     fn parameters(&self) -> &[Parameter] { &self.1 }
    /// #     fn len(&self) -> usize { self.0.len() }
    /// #     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
    /// #         residuals.iter_mut().zip(self.0).for_each(|(r, (t, y))| *r = p[0] * (1.0 - (-p[1] * t).exp()) - y);
    /// #         Ok(())
    /// #     }
    /// # }
    /// // A rise that is over at the first reading but one: its rate may be anything above 1.17/s.
    /// let data = [(1.0, 0.97), (2.0, 1.01), (3.0, 0.98), (4.0, 1.02), (5.0, 0.99)];
    /// let rise = Rise(&data, [Parameter::new("height", "a", "1"), Parameter::new("rate", "b", "1/s")]);
    /// let options = Options::default();
    /// let fit = solve(&rise, &[1.0, 1.0], &options)?;
    /// let interval = ProfileInterval::of(&rise, &fit, "rate", 0.95, ResidualVariance::Estimated, &options).unwrap();
    /// assert!(matches!(interval.lower(), ProfileEnd::At(_)));
    /// assert_eq!(interval.upper(), ProfileEnd::Open);
    /// # Ok::<(), fmm_fit::FitError>(())
    /// ```
    ///
    /// # Errors
    /// [`FitError`] if the fit is not one of this problem or not at its lowest minimum, if the level or the parameter
    /// is impossible, or if the fit with the fixed parameter fails.
    ///
    /// # References
    /// D. M. Bates, D. G. Watts, "Nonlinear Regression Analysis and Its Applications", Wiley (1988), ch. 6.
    pub fn of<P: Residuals + ?Sized>(
        problem: &P,
        fit: &Fit,
        name: &str,
        level: f64,
        variance: ResidualVariance,
        options: &Options,
    ) -> Result<Self, FitError> {
        fit.require_of(problem)?;
        let position = problem.parameters().iter().position(|parameter| parameter.name() == name);
        let index = position.ok_or_else(|| FitError::unknown_name(format!("there is no parameter called {name}")))?;
        if fit.estimates()[index].status() == EstimateStatus::Fixed {
            return Err(FitError::problem(format!("{name} is fixed and has no interval")));
        }
        if !(level > 0.0 && level < 1.0) {
            let what = format!("the level of an interval must be above 0 and below 1, but is {level}");
            return Err(FitError::out_of_range(what, level));
        }
        if !fit.outcome().is_success() {
            return Err(FitError::no_minimum(format!("the fit is not at a minimum: {}", fit.outcome())));
        }
        let scale = variance.scale(fit, level).ok_or_else(|| {
            FitError::undetermined(
                "the fit leaves no residual or no degree of freedom, so the variance cannot be estimated from it",
            )
        })?;
        let mut profile = Profile::new(problem, fit, index, scale, options);
        let lower = profile.end(-1.0)?;
        let upper = profile.end(1.0)?;
        profile.points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Self {
            level,
            index,
            scale,
            lower,
            upper,
            points: profile.points,
            residual_evaluations: profile.residual_evaluations,
        })
    }

    /// The profile as a curve to be drawn: values of the parameter, ascending, and (S_k − S_min)/s² there, at up to
    /// `count` even steps on either side of the estimate, as far as a little beyond the end, or up to a bound or edge
    /// that ends it.
    ///
    /// Beside it belongs the parabola (θ − θ̂)²/(s² C), with C the [unit covariance](Fit::unit_covariance), to which
    /// the curve is equal for a linear model. An open side is drawn as far as the other, or as far as the parabola
    /// would need.
    ///
    /// `problem`, `fit` and `options` are those of the interval.
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn curve<P: Residuals + ?Sized>(
        &self,
        problem: &P,
        fit: &Fit,
        count: usize,
        options: &Options,
    ) -> Result<Vec<(f64, f64)>, FitError> {
        fit.require_of(problem)?;
        let unknown = || FitError::unknown_name(format!("there is no parameter with the number {}", self.index));
        let bounds = problem.parameters().get(self.index).ok_or_else(unknown)?.bounds();
        let best = fit.values()[self.index];
        let mut profile = Profile::new(problem, fit, self.index, self.scale, options);
        let reach = |end: ProfileEnd| match end {
            ProfileEnd::At(value) => Some((1.0 + BEYOND) * (value - best).abs()),
            ProfileEnd::Bound(value) | ProfileEnd::Edge(value) => Some((value - best).abs()),
            ProfileEnd::Open => None,
        };
        let of_open = reach(self.lower).or(reach(self.upper)).filter(|reach| *reach > 0.0);
        let of_open = of_open.unwrap_or_else(|| (1.0 + BEYOND) * profile.guess());
        let mut curve = vec![(best, 0.0)];
        for (end, direction) in [(self.lower, -1.0), (self.upper, 1.0)] {
            let reach = reach(end).unwrap_or(of_open);
            let mut trace = vec![Trace { values: fit.values().to_vec(), distance: 0.0 }];
            for step in 1..=count {
                let value = bounds.clamp(best + direction * reach * step as f64 / count as f64);
                if value == trace[trace.len() - 1].values[self.index] {
                    break;
                }
                let Some(point) = profile.point(value, &trace)? else { break };
                curve.push((value, point.distance.powi(2)));
                trace.push(point);
            }
        }
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(curve)
    }
}

struct Profile<'a, P: ?Sized> {
    problem: &'a P,
    fit: &'a Fit,
    index: usize,
    deviation: f64,
    quantile: f64,
    options: &'a Options,
    began: Instant,
    minimizer: Minimizer,
    points: Vec<(f64, f64)>,
    residual_evaluations: usize,
}

/// A point of the profile: all parameters, and the distance √(S − S_min)/s from the minimum.
#[derive(Debug, Clone)]
struct Trace {
    values: Vec<f64>,
    distance: f64,
}

impl<'a, P: Residuals + ?Sized> Profile<'a, P> {
    /// The profile of parameter `index` about the minimum, `scale` being s and the quantile.
    fn new(problem: &'a P, fit: &'a Fit, index: usize, scale: (f64, f64), options: &'a Options) -> Self {
        Self {
            problem,
            fit,
            index,
            deviation: scale.0,
            quantile: scale.1,
            options,
            began: Instant::now(),
            minimizer: Minimizer::default(),
            points: vec![(fit.values()[index], fit.sum_of_squares())],
            residual_evaluations: 0,
        }
    }

    /// The end in one direction: outwards until the distance passes the quantile, then between.
    fn end(&mut self, direction: f64) -> Result<ProfileEnd, FitError> {
        let bounds = self.problem.parameters()[self.index].bounds();
        let limit = if direction < 0.0 { bounds.lower() } else { bounds.upper() };
        let best = self.fit.values()[self.index];
        if best == limit {
            return Ok(ProfileEnd::Bound(limit));
        }
        let guess = self.guess();
        let mut reach = guess;
        // Where the model has no value, as far as is known.
        let mut gap: Option<f64> = None;
        let mut trace = vec![Trace { values: self.fit.values().to_vec(), distance: 0.0 }];
        loop {
            let last = &trace[trace.len() - 1];
            let at = last.values[self.index];
            let value = match gap {
                Some(gap) => 0.5 * at + 0.5 * gap,
                None if direction < 0.0 => (best - reach).max(limit),
                None => (best + reach).min(limit),
            };
            if gap.is_some_and(|gap| (value - at).abs() <= 1e-9 * (gap - best).abs()) || value == at {
                return Ok(ProfileEnd::Edge(at));
            }
            match self.point(value, &trace)? {
                None => gap = Some(value),
                Some(point) if point.distance >= self.quantile => return self.between(trace, point),
                Some(_) if value == limit => return Ok(ProfileEnd::Bound(limit)),
                Some(point) => {
                    let rise = point.distance - last.distance;
                    let ahead = (value - at).abs() * (self.quantile - point.distance) / rise;
                    reach = (value - best).abs();
                    if !(reach < FARTHEST * guess) {
                        return Ok(ProfileEnd::Open);
                    }
                    // A little beyond where the line leads, as a bracket is wanted.
                    let ahead = if rise > 0.0 { 1.1 * ahead } else { f64::INFINITY };
                    reach += ahead.clamp(0.1 * reach, 3.0 * reach);
                    trace.push(point);
                }
            }
        }
    }

    /// The distance of an end if the model were linear.
    fn guess(&self) -> f64 {
        let relaxed = self.fit.relaxed_covariance(self.index, self.index);
        let scale = self.deviation / self.fit.residual_standard_deviation().unwrap_or(1.0);
        let straight = relaxed.map(|variance| self.quantile * scale * variance.sqrt());
        let (value, bounds) = (self.fit.values()[self.index], self.problem.parameters()[self.index].bounds());
        let width = bounds.upper() - bounds.lower();
        let size = if width.is_finite() { 0.1 * width } else { 0.1 * value.abs() };
        let is_usable = |guess: &f64| *guess > 0.0 && guess.is_finite();
        straight.filter(is_usable).or(Some(size).filter(is_usable)).unwrap_or(1.0)
    }

    /// Narrows the end down between the last of `trace`, which is inside, and `outside`, by the method of false
    /// position with halved weights (Illinois), the distance being nearly linear.
    fn between(&mut self, mut trace: Vec<Trace>, outside: Trace) -> Result<ProfileEnd, FitError> {
        let inside = trace[trace.len() - 1].clone();
        let mut ends = [inside, outside].map(|end| (end.values[self.index], end.distance - self.quantile, end));
        let mut last_replaced = None;
        for _ in 0..100 {
            let [(a, f_a, _), (b, f_b, _)] = &ends;
            let value = a + (b - a) * f_a / (f_a - f_b);
            let value = if value.is_finite() { value.max(a.min(*b)).min(a.max(*b)) } else { 0.5 * (a + b) };
            if value == *a || value == *b {
                return Ok(ProfileEnd::At(value));
            }
            // The nearer point last, as the next one starts from it.
            let is_a_nearer = (value - a).abs() < (value - b).abs();
            trace.clear();
            trace.extend(ends.iter().map(|end| end.2.clone()));
            if is_a_nearer {
                trace.reverse();
            }
            let Some(point) = self.point(value, &trace)? else {
                return Ok(ProfileEnd::Edge(*a));
            };
            let f = point.distance - self.quantile;
            if f.abs() <= ACCURACY * self.quantile {
                return Ok(ProfileEnd::At(value));
            }
            let replaced = usize::from(f > 0.0);
            ends[replaced] = (value, f, point);
            if last_replaced == Some(replaced) {
                ends[1 - replaced].1 *= 0.5;
            }
            last_replaced = Some(replaced);
        }
        Ok(ProfileEnd::At(0.5 * (ends[0].0 + ends[1].0)))
    }

    /// The best fit with the parameter fixed at `value`, from the points of `trace`; `None` if the model has no value.
    fn point(&mut self, value: f64, trace: &[Trace]) -> Result<Option<Trace>, FitError> {
        let Ok(fixed) = WithFixed::new(self.problem, [(self.index, value)]) else { return Ok(None) };
        let last = &trace[trace.len() - 1];
        let mut failure = None;
        for mut start in [self.ahead(value, trace), last.values.clone(), self.fit.values().to_vec()] {
            start[self.index] = value;
            let left = self.options.max_evaluations.saturating_sub(self.residual_evaluations);
            self.minimizer.options = self.options.remaining(self.began).with_max_evaluations(left);
            match self.minimizer.minimize(&fixed, &start) {
                Ok(outcome) => {
                    self.residual_evaluations += self.minimizer.residual_evaluations();
                    if outcome.is_success() {
                        return self.trace(value).map(Some);
                    }
                    failure = Some(outcome);
                }
                Err(FitError::NoModel { .. }) => self.residual_evaluations += 1,
                Err(error) => return Err(error),
            }
        }
        match failure {
            Some(outcome) => {
                let (name, value) = (self.problem.parameters()[self.index].name(), Rounded::every_digit(value));
                Err(FitError::no_minimum(format!("with {name} fixed at {value} the fit ended as: {outcome}")))
            }
            None => Ok(None),
        }
    }

    /// The point that the minimiser is at, unless it is lower than the minimum.
    fn trace(&mut self, value: f64) -> Result<Trace, FitError> {
        let (sum, found) = (self.minimizer.sum_of_squares(), self.fit.sum_of_squares());
        let excess = (sum - found) / self.deviation.powi(2);
        if excess < -LOWER * self.quantile.powi(2) && self.fit.outcome() != Outcome::AtNoiseFloor {
            let freed = solve(self.problem, self.minimizer.values(), &self.options.remaining(self.began))?;
            let (lower, values) = (freed.sum_of_squares(), freed.values().to_vec());
            let what = format!(
                "the fit is not at the lowest minimum: the sum of squares is {lower} instead of {found} at {values:?}; \
                 take that for the fit"
            );
            return Err(FitError::LowerMinimum { what, values, lower });
        }
        self.points.push((value, sum));
        Ok(Trace { values: self.minimizer.values().to_vec(), distance: excess.max(0.0).sqrt() })
    }

    /// Expected values of the other parameters as this one goes to `value`: along the line through the last two points,
    /// or from the minimum as the covariance says.
    fn ahead(&self, value: f64, trace: &[Trace]) -> Vec<f64> {
        let last = &trace[trace.len() - 1].values;
        let change = value - last[self.index];
        let covariance = |j: usize| self.fit.unit_covariance(j, self.index).unwrap_or(0.0);
        let slope = |j: usize| match trace {
            [.., before, _] => (last[j] - before.values[j]) / (last[self.index] - before.values[self.index]),
            _ => covariance(j) / covariance(self.index),
        };
        let parameters = self.problem.parameters().iter().zip(last).enumerate();
        let moved = |(j, (parameter, from)): (usize, (&fmm_model::Parameter, &f64))| {
            let to = parameter.bounds().clamp(from + change * slope(j));
            if to.is_finite() { to } else { *from }
        };
        parameters.map(moved).collect()
    }
}
