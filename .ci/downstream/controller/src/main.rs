//! Compensates the friction of a joint as firmware would: no standard library, and a heap that has nothing to give.
//! It prints nothing; its exit status says whether the forces are right.
#![no_std]
#![no_main]

use core::alloc::{GlobalAlloc, Layout};
use core::panic::PanicInfo;
use core::ptr::null_mut;

use fmm_friction::{Dahl, FeedForward, LawError, LawFamily, SlidingLaw, Stribeck};
use fmm_model::{Dual, Scalar};

/// A heap without memory: whoever asks for some ends the program.
struct Nothing;

// SAFETY: No memory is ever given, so none is given twice and none comes back.
unsafe impl GlobalAlloc for Nothing {
    unsafe fn alloc(&self, _: Layout) -> *mut u8 {
        null_mut()
    }
    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
}

#[global_allocator]
static HEAP: Nothing = Nothing;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: It ends the program, whatever its state is.
    unsafe { abort() }
}

// The library `alloc` names it, though nothing here unwinds.
// SAFETY: The one function of this name, never called.
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}

// The sentences of errors are written by `alloc`, which names this too.
// SAFETY: The one function of this name, never called, as a panic aborts.
#[unsafe(no_mangle)]
extern "C" fn _Unwind_Resume() -> ! {
    // SAFETY: It ends the program, whatever its state is.
    unsafe { abort() }
}

// What starts a program on the host.
#[link(name = "c")]
unsafe extern "C" {
    fn abort() -> !;
}

// SAFETY: The one function of this name.
#[unsafe(no_mangle)]
extern "C" fn main() -> i32 {
    i32::from(!matches!(compensate(), Ok(true)))
}

fn compensate() -> Result<bool, LawError> {
    // μ_c, μ_s, v_s, δ and β: friction of a joint at v_s, μ_c + (μ_s − μ_c)/e, and its slope, −(μ_s − μ_c)/v_s/e.
    let law = Stribeck::at(&[0.2, 0.3, 0.1, 1.0, 0.0].map(Dual::<1>::from))?;
    let friction = law.coefficient(Dual::variable(0.1, 0));
    let falls = near(friction.value(), 0.236_787_944_117_144_22) && near(friction.partial(0), -0.367_879_441_171_442_3);
    // Bristles that yield at 3 µm, pulled by 2 µm: μ (1 − e^(−2/3)).
    let mut friction = FeedForward::new(Dahl::new(0.3, 1e5, 1.0)?, [0.0])?;
    let holds = friction.step(1e-3, 2e-3).is_some_and(|coefficient| near(coefficient, 0.145_974_864_290_222_1));
    Ok(falls && holds)
}

/// Some digits of elementary functions differ from library to library.
fn near(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < 1e-14
}
