//! Signals that ask the program to end: the run stops after its present step, with everything written.

use crate::fault::Fault;
use signal_hook::flag;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

static CAUGHT: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// From here on the first SIGINT (Ctrl-C), SIGTERM, SIGHUP or SIGUSR1 ends the run after its present step;
/// the second ends the program at once. SIGXCPU ends the run the same way; the system repeats it, so that a
/// second one ends nothing.
///
/// # Errors
/// If the system does not allow it.
pub(crate) fn catch() -> Result<(), Fault> {
    let requested = Arc::new(AtomicBool::new(false));
    for &signal in ENDING {
        flag::register_conditional_shutdown(signal, exit_code(signal).into(), requested.clone())
            .map_err(refused)?;
    }
    for &signal in ENDING.iter().chain(TIME_LIMIT) {
        flag::register(signal, requested.clone()).map_err(refused)?;
        flag::register_usize(signal, CAUGHT.clone(), signal as usize).map_err(refused)?;
    }
    Ok(())
}

/// From here on a write beyond the limit of the size of files fails; SIGXFSZ does not end the program.
///
/// # Errors
/// If the system does not allow it.
pub(crate) fn outlive_size_limit() -> Result<(), Fault> {
    let caught = |&signal| flag::register(signal, Arc::default()).map(drop);
    SIZE_LIMIT.iter().try_for_each(caught).map_err(refused)
}

fn refused(error: io::Error) -> Fault {
    Fault::Start(Box::new(error))
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
#[cfg(unix)]
const TIME_LIMIT: &[i32] = &[signal_hook::consts::SIGXCPU];
#[cfg(unix)]
const SIZE_LIMIT: &[i32] = &[signal_hook::consts::SIGXFSZ];
#[cfg(not(unix))]
const TIME_LIMIT: &[i32] = &[];
#[cfg(not(unix))]
const SIZE_LIMIT: &[i32] = &[];
