//! References on disk: they take longer than the grid, and do not depend on what is measured.

use equip_autodiff::Hamiltonian;
use equip_scalar::DoubleDouble;
use equip_tableau::TableauError;
use equip_tests::Reference;
use std::fs;
use std::path::Path;

/// Agreement of two solutions that is asked for.
const AGREEMENT: f64 = 1e-15;

/// The reference from the directory, or computed and put there. A directory that cannot be written is no
/// error.
pub(crate) fn reference(
    directory: &Path,
    (name, hamiltonian): (&str, &Hamiltonian),
    start: &[f64],
    times: &[f64],
    rate: f64,
) -> Result<Reference, TableauError> {
    let label: String = name
        .chars()
        .map(|c| if c.is_alphanumeric() { c } else { '_' })
        .collect();
    let path = directory.join(format!("{label}-{:016x}", key(hamiltonian, start, times)));
    if let Some(found) = read(&path, start.len(), times.len()) {
        return Ok(found);
    }
    let wanted = (rate, AGREEMENT);
    let reference = Reference::solve::<DoubleDouble>(hamiltonian, start, times, wanted)?;
    let states = reference.states.iter().flatten();
    let text: String = reference
        .errors
        .iter()
        .chain(states)
        .map(|x| format!("{:016x}\n", x.to_bits()))
        .collect();
    if fs::create_dir_all(directory).is_ok() {
        let _ = fs::write(&path, text);
    }
    Ok(reference)
}

fn read(path: &Path, n: usize, times: usize) -> Option<Reference> {
    let text = fs::read_to_string(path).ok()?;
    let numbers: Option<Vec<f64>> = text
        .lines()
        .map(|line| u64::from_str_radix(line, 16).ok().map(f64::from_bits))
        .collect();
    let numbers = numbers.filter(|x| x.len() == times * (n + 1))?;
    let (errors, states) = numbers.split_at(times);
    Some(Reference {
        errors: errors.to_vec(),
        states: states.chunks_exact(n).map(<[f64]>::to_vec).collect(),
    })
}

/// FNV-1a of the start, the times, and H and ∇H at two states.
fn key(hamiltonian: &Hamiltonian, start: &[f64], times: &[f64]) -> u64 {
    let mut evaluator = hamiltonian.evaluator::<f64>();
    let mut numbers: Vec<f64> = start.iter().chain(times).copied().collect();
    for factor in [1.0, 1.001] {
        let y: Vec<f64> = start.iter().map(|x| x * factor).collect();
        let mut gradient = vec![0.0; y.len()];
        numbers.push(evaluator.gradient(&y, &mut gradient));
        numbers.extend(gradient);
    }
    let bytes = numbers.iter().flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
