//! All that takes time.

use fmm_fit::{Options, solve};
use fmm_sim::Exact;

use crate::table_3::{Row, Sensitivities, euler_rows, exact_rows, problem};
use crate::{Found, Settings};

/// Fits of the exact motion in each row: those of the thesis.
const EXACT: u64 = 100_000;
/// Fits of the Euler motion in the rows of m, k, c and all. What is required of c and all is ten times as sharp.
const EULER: [u64; 4] = [6000, 6000, 10_000, 10_000];
/// More starts about the best values so far, and fits in each row with them.
pub(super) const KICKS: usize = 3;
const RESTARTED: u64 = 250;

/// Derivatives, and the rows by refits.
pub(super) struct Computed {
    pub(super) sensitivities: Sensitivities,
    pub(super) exact: Vec<Row>,
    /// The thesis' Euler motion from its own start, and from more.
    pub(super) euler: Vec<Row>,
    pub(super) restarted: Vec<Row>,
}

impl Computed {
    pub(super) fn new(settings: &Settings<'_>) -> Found<Self> {
        let problem = problem(&Exact)?;
        let fit = solve(&problem, problem.values(), &Options::default())?;
        let sensitivities = Sensitivities::of(&problem, &fit)?;
        let fewer = |trials: u64, divisor: u64| if settings.is_quick() { trials / divisor } else { trials };
        let (exact, euler, restarted) = (fewer(EXACT, 20), EULER.map(|trials| fewer(trials, 20)), fewer(RESTARTED, 5));
        let seed = settings.seed();
        // An Euler fit takes about fifty times as long as an exact one, a restarted one another (1 + KICKS) times.
        let work =
            |exact: u64, euler: u64, restarted: u64| (exact + 50 * (euler + restarted * (1 + KICKS as u64))) as f64;
        let (all_exact, all_euler, all_restarted) = (4 * exact, euler.iter().sum(), 4 * restarted);
        let whole = work(all_exact, all_euler, all_restarted);
        let tell = |exact, euler, restarted| settings.done(work(exact, euler, restarted) / whole);
        Ok(Self {
            sensitivities,
            exact: exact_rows(&problem, &fit, exact, seed, &|done| tell(done, 0, 0))?,
            euler: euler_rows(euler, seed, 0, &|done| tell(all_exact, done, 0))?,
            restarted: euler_rows([restarted; 4], seed, KICKS, &|done| tell(all_exact, all_euler, done))?,
        })
    }
}
