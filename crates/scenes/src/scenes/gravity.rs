//! Bodies that attract each other: H = Σ |p_i|²/(2m_i) − G Σ_{i<j} m_i m_j/|q_i − q_j|, in d dimensions, body
//! after body.

use equip_autodiff::Var;

/// The energy of bodies with masses m in d dimensions.
#[inline(always)]
pub(crate) fn energy(d: usize, gravity: Var, masses: &[Var], q: &[Var], p: &[Var]) -> Var {
    let kinetic: Var = masses
        .iter()
        .zip(p.chunks_exact(d))
        .map(|(&m, p)| p.iter().map(|&p| p * p).sum::<Var>() / (2.0 * m))
        .sum();
    let mut attraction = Vec::with_capacity(masses.len() * masses.len() / 2);
    for (i, a) in q.chunks_exact(d).enumerate() {
        for (j, b) in q.chunks_exact(d).enumerate().take(i) {
            attraction.push(masses[i] * masses[j] / distance(a, b));
        }
    }
    kinetic - gravity * attraction.into_iter().sum::<Var>()
}

fn distance(a: &[Var], b: &[Var]) -> Var {
    let square: Var = a.iter().zip(b).map(|(&a, &b)| (a - b) * (a - b)).sum();
    square.sqrt()
}
