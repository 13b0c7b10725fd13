//! Identification in an asynchronous service, without a runtime of its own: `cargo run --release --example service`.
//!
//! Samples come one by one. The record that they make is identified on a thread of its own, and the service awaits the
//! result, or cancels it: an observer that breaks ends a fit within one step. All types of the libraries are `Send` and
//! `Sync`, so that any runtime may move them; `spawn_blocking` of a runtime does what `Identifying` does here.

use std::error::Error;
use std::future::Future;
use std::ops::ControlFlow;
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::{self, Thread};

use fmm_friction::CoulombViscous;
use fmm_identify::{Comparison, Experiment, IdentifyError, Inquiry, Machine, Preparation};
use fmm_model::Oscillator;
use fmm_record::{GrowingRecord, Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};

type Found = Result<Comparison, IdentifyError>;

/// Result that a thread will leave here, and who waits for it.
#[derive(Default)]
struct Place {
    found: Option<Found>,
    waker: Option<Waker>,
}

/// Identification that goes on; it is cancelled when it is dropped.
struct Identifying {
    place: Arc<Mutex<Place>>,
    is_cancelled: Arc<AtomicBool>,
}

impl Identifying {
    /// Begins to identify the free vibration in a `record`.
    fn begin(record: Record) -> Self {
        let (place, is_cancelled) = (Arc::new(Mutex::new(Place::default())), Arc::new(AtomicBool::new(false)));
        let (own_place, own_cancelled) = (Arc::clone(&place), Arc::clone(&is_cancelled));
        thread::spawn(move || {
            let found = identified(&record, &own_cancelled);
            let mut place = own_place.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            place.found = Some(found);
            if let Some(waker) = place.waker.take() {
                waker.wake();
            }
        });
        Self { place, is_cancelled }
    }
}

impl Future for Identifying {
    type Output = Found;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Found> {
        let mut place = self.place.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        place.waker = Some(context.waker().clone());
        place.found.take().map_or(Poll::Pending, Poll::Ready)
    }
}

impl Drop for Identifying {
    fn drop(&mut self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }
}

/// The comparison of the laws that a `record` asks for; what was found so far if it is cancelled.
fn identified(record: &Record, is_cancelled: &AtomicBool) -> Found {
    let experiments = [Experiment::ring_down(record, &Preparation::default())?];
    let inquiry = Inquiry::of(&Machine::per_unit_mass(), &experiments).observed_by(|_, _| {
        if is_cancelled.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    inquiry.search()
}

/// The thread of the service, which sleeps until something wakes it.
struct Sleeper(Thread);

impl Wake for Sleeper {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Runs one task to its end, as the runtime of a service runs many.
fn run<T>(task: impl Future<Output = T>) -> T {
    let waker = Waker::from(Arc::new(Sleeper(thread::current())));
    let (mut task, mut context) = (pin!(task), Context::from_waker(&waker));
    loop {
        match task.as_mut().poll(&mut context) {
            Poll::Ready(value) => return value,
            Poll::Pending => thread::park(),
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    // The instrument: 2 Hz, c/m = 0.05 1/s, F/m = 0.3 m/s², at 1 kHz.
    let scenario = Scenario::new(Oscillator::per_unit_mass(2.0)?, CoulombViscous::new(0.3, 0.05)?, 1.0)?;
    let motion = Exact.run(&scenario.starting_at(0.02, 0.0)?, &Sampling::uniform(1e-3, 2000)?)?;

    let mut growing = GrowingRecord::sampled(1000.0, Quantity::Velocity, "m/s")?;
    for velocity in motion.velocity().values() {
        growing.push(*velocity)?;
        if growing.len() == 1000 {
            // A look on the way, of which nobody awaits the end.
            drop(Identifying::begin(growing.record()?));
        }
    }
    let comparison = run(Identifying::begin(growing.finish()?))?;
    println!("{}", comparison.headline());
    Ok(())
}
