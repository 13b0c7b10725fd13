//! Settings: the amount of computation, and the receiver of its progress.

/// Settings that a chapter is told before it starts.
#[derive(Clone, Copy)]
pub struct Settings<'a> {
    quick: bool,
    seed: u64,
    progress: &'a (dyn Fn(f64) + Sync),
}

impl Settings<'_> {
    /// The whole work with the seed 1, in silence.
    pub fn new() -> Self {
        Self { quick: false, seed: 1, progress: &|_| () }
    }

    /// Fewer repetitions where they only make an average sharper; targets that need them get wider criteria, which say
    /// so.
    #[must_use]
    pub fn quick(self, quick: bool) -> Self {
        Self { quick, ..self }
    }

    /// Another seed of every random number.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Tells `progress` the share of the work that is done, 0 to 1, from any thread.
    #[must_use]
    pub fn with_progress(self, progress: &(dyn Fn(f64) + Sync)) -> Settings<'_> {
        Settings { quick: self.quick, seed: self.seed, progress }
    }

    /// True if fewer repetitions are wanted.
    pub fn is_quick(&self) -> bool {
        self.quick
    }

    /// `whole`, or `few` if quick.
    pub fn repetitions(&self, whole: usize, few: usize) -> usize {
        if self.quick { few } else { whole }
    }

    /// The seed of all random numbers.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Tells that a `share` of the work is done.
    pub fn done(&self, share: f64) {
        (self.progress)(share);
    }
}

impl Default for Settings<'_> {
    fn default() -> Self {
        Self::new()
    }
}
