//! Numbers that options of several commands read.

use equip_integrate::MAX_STAGES;

/// Reads whole numbers from `low` to `high`; others are refused with these.
pub(super) fn whole(low: u64, high: u64) -> impl Fn(&str) -> Result<u64, String> + Clone {
    move |text| match text.trim().parse() {
        Ok(number) if (low..=high).contains(&number) => Ok(number),
        _ if high == u64::MAX => Err(format!("a whole number, {low} or more")),
        _ => Err(format!("a whole number from {low} to {high}")),
    }
}

/// Reads a number of stages; which of them a method takes is known by the method.
pub(super) fn stages(text: &str) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(stages) if stages >= 1 => Ok(stages),
        _ => Err(format!("a whole number from 1 to {MAX_STAGES}")),
    }
}
