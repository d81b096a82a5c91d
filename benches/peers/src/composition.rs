//! Reference end states: symmetric composition of order 10 in double-double, for H = T(p) + U(q).
//!
//! 35 Störmer–Verlet steps of sizes γ_i h, [Sofroniou, Spaletta, Derivation of symmetric composition constants for symmetric
//! integrators, Optim. Methods Softw. 20 (2005) 597–613].

use crate::problem::Problem;
use equip::prelude::*;

/// γ_1 … γ_18; γ_{36−i} = γ_i.
const HALF: [&str; 18] = [
    "0.078795722521686419263907679337684",
    "0.31309610341510852776481247192647",
    "0.027918383235078066109520273275299",
    "-0.22959284159390709415121339679655",
    "0.13096206107716486317465685927961",
    "-0.26973340565451071434460973222411",
    "0.074973343155891435666137105641410",
    "0.11199342399981020488957508073640",
    "0.36613344954622675119314812353150",
    "-0.39910563013603589787862981058340",
    "0.10308739852747107731580277001372",
    "0.41143087395589023782070411897608",
    "-0.0048663605831352617621956593099771",
    "-0.39203335370863990644808193642610",
    "0.051942502962449647037182904015976",
    "0.050665090759924496335874344156866",
    "0.049674370639729879054568800279461",
    "0.049317735759594537917680008339338",
];

/// (q, p) at `end`.
pub fn propagate<P: Problem>(
    problem: &P,
    q: &[f64],
    p: &[f64],
    end: f64,
    steps: u64,
) -> Vec<DoubleDouble> {
    type D = DoubleDouble;
    let read = |text: &&str| D::decimal(text).unwrap_or(D::NAN);
    let half: Vec<D> = HALF.iter().map(read).collect();
    let gammas: Vec<D> = half
        .iter()
        .chain(half.iter().rev().skip(1))
        .copied()
        .collect();
    let wide = |x: &[f64]| x.iter().map(|&x| D::exact(x)).collect::<Vec<_>>();
    let (mut q, mut p) = (wide(q), wide(p));
    let h = D::exact(end) / D::int(steps as i64);
    let (mut velocity, mut force) = (q.clone(), q.clone());
    let mut drift = |q: &mut [D], p: &[D], by: D| {
        problem.derivative(q, p, &mut velocity, &mut force);
        q.iter_mut().zip(&velocity).for_each(|(q, v)| *q += by * *v);
    };
    let mut velocity = q.clone();
    let mut force = q.clone();
    let half = D::ratio(1, 2);
    for _ in 0..steps {
        for (i, &gamma) in gammas.iter().enumerate() {
            // Neighbouring half drifts are made as one.
            let before = if i == 0 { D::int(0) } else { gammas[i - 1] };
            drift(&mut q, &p, half * (before + gamma) * h);
            problem.derivative(&q, &p, &mut velocity, &mut force);
            p.iter_mut()
                .zip(&force)
                .for_each(|(p, f)| *p += gamma * h * *f);
        }
        drift(&mut q, &p, half * gammas[0] * h);
    }
    q.into_iter().chain(p).collect()
}
