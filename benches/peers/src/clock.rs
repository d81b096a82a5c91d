//! CPU time of this thread, and the core it stays on.

use std::io::Error;
use std::mem::{size_of, zeroed};

/// CPU seconds this thread has used: what other programs do on the machine does not enter.
pub fn cpu_seconds() -> f64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the pointer is valid for the call, and this clock exists wherever Linux runs.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Keeps this thread, and the processes it starts from now on, on one core.
///
/// # Errors
/// If the system has no such core or does not allow it.
pub fn pin(core: usize) -> Result<(), Error> {
    // SAFETY: an all-zero cpu_set_t is the empty set, and the pointer is valid for the call.
    let done = unsafe {
        let mut set: libc::cpu_set_t = zeroed();
        libc::CPU_SET(core, &mut set);
        libc::sched_setaffinity(0, size_of::<libc::cpu_set_t>(), &set)
    };
    if done == 0 {
        Ok(())
    } else {
        Err(Error::last_os_error())
    }
}

/// Seconds of CPU time one turn may use for repeats.
const TURN: f64 = 5e-3;
/// Repeats in a turn at most.
const REPEATS: usize = 9;

/// Times `run` after `prepare`, once to warm caches and then until a turn is used up; slow runs are timed
/// once. Returns the median.
///
/// # Errors
/// The first error of `run`.
pub fn turn<S, E>(
    mut prepare: impl FnMut() -> S,
    mut run: impl FnMut(&mut S) -> Result<(), E>,
) -> Result<(f64, S), E> {
    let mut state = prepare();
    let mut timed = |state: &mut S| {
        let begun = cpu_seconds();
        run(state).map(|()| cpu_seconds() - begun)
    };
    let first = timed(&mut state)?;
    if first > TURN {
        return Ok((first, state));
    }
    let mut seconds = Vec::with_capacity(REPEATS);
    while seconds.len() < REPEATS && (seconds.is_empty() || seconds.iter().sum::<f64>() < TURN) {
        state = prepare();
        seconds.push(timed(&mut state)?);
    }
    seconds.sort_by(f64::total_cmp);
    Ok((seconds[seconds.len() / 2], state))
}
