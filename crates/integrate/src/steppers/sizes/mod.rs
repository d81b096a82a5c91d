//! Step control: fixed steps, and steps by a tolerance.

mod adaptive_steps;
mod by_tolerance;
mod fixed_steps;
mod grid;
mod made;
mod over_switches;
mod prepare;
