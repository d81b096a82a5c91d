//! Signals that ask the program to end: the run stops after its present step, with everything written.

use crate::fault::Fault;
use signal_hook::flag;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

static CAUGHT: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// From here on the first SIGINT (Ctrl-C), SIGTERM, SIGHUP or SIGUSR1 ends the run after its present step;
/// the second ends the program at once. SIGXCPU and SIGXFSZ end the run the same way; the system repeats
/// both, so that a second one of these ends nothing.
///
/// # Errors
/// If the system does not allow it.
pub(crate) fn catch() -> Result<(), Fault> {
    let fault = |error| Fault::Start(Box::new(error));
    let asked = Arc::new(AtomicBool::new(false));
    for &signal in ENDING {
        flag::register_conditional_shutdown(signal, exit_code(signal).into(), asked.clone())
            .map_err(fault)?;
    }
    for &signal in ENDING.iter().chain(LIMITS) {
        flag::register(signal, asked.clone()).map_err(fault)?;
        flag::register_usize(signal, CAUGHT.clone(), signal as usize).map_err(fault)?;
    }
    Ok(())
}

/// The signal that came, if one did.
pub(crate) fn caught() -> Option<i32> {
    match CAUGHT.load(Ordering::Relaxed) {
        0 => None,
        signal => i32::try_from(signal).ok(),
    }
}

/// The exit code of a program that a signal ended, as shells have it.
pub(crate) fn exit_code(signal: i32) -> u8 {
    u8::try_from(128 + signal).unwrap_or(u8::MAX)
}

/// Signals by which a user, a terminal that closes, a system that shuts down, and the queue of a cluster
/// (SIGUSR1, before the time of a job is over) end a program.
#[cfg(unix)]
const ENDING: &[i32] = &[
    signal_hook::consts::SIGINT,
    signal_hook::consts::SIGTERM,
    signal_hook::consts::SIGHUP,
    signal_hook::consts::SIGUSR1,
];
#[cfg(not(unix))]
const ENDING: &[i32] = &[signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM];

/// Signals of a limit that is reached: of processor time, with some seconds left, and of the size of files.
/// The write that went beyond the latter has failed.
#[cfg(unix)]
const LIMITS: &[i32] = &[signal_hook::consts::SIGXCPU, signal_hook::consts::SIGXFSZ];
#[cfg(not(unix))]
const LIMITS: &[i32] = &[];
