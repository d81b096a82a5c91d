//! Scratch.
#![allow(missing_docs, dead_code, clippy::all, clippy::unwrap_used)]
#[path = "../grid/scenes.rs"]
mod scenes;
use cpu_time::ThreadTime;
use equip_integrate::{Equip, Gauss, Preconditioner};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let scene = scenes::all().unwrap().into_iter().find(|s| s.name == a[1]).unwrap();
    let (s, h, steps): (usize, f64, u64) = (a[2].parse().unwrap(), a[3].parse().unwrap(), a[4].parse().unwrap());
    let start: u64 = a.get(5).map_or(0, |x| x.parse().unwrap());
    let only = a.get(6).map(String::as_str).unwrap_or("");
    let (q, p) = scene.start(start, 1);
    let mut first = 0.0;
    for (name, method) in [("gauss", Gauss::stages(s)), ("equip", Equip::stages(s))] {
        if !only.is_empty() && only != "full" && only != "always" && only != name { continue; }
        
        let mut best = f64::INFINITY;
        let mut text = String::new();
        for _ in 0..5 {
            let mut i = method.step(h); if only == "always" { i = i.reach(equip_integrate::Reach::Always); } if only == "full" { i = i.preconditioner(Preconditioner::Full); } let mut r = i.start(&scene.hamiltonian, &q, &p, 0.0).unwrap();
            let t = ThreadTime::now();
            for _ in 0..steps { if let Err(e) = r.advance() { println!("{e}"); break; } }
            best = best.min(t.elapsed().as_secs_f64());
            let c = r.counts();
            let n = c.steps as f64;
            text = format!("sw {:.2} nw {:.2} g {:.2} H {:.2} d {:.2} m {:.2} le {:.2} fac {:.2} halv {} unc {}", c.sweeps as f64/n, c.newton_iterations as f64/n, c.gradients as f64/n, c.hessians as f64/n, c.directions as f64/n, c.alpha_moves as f64/n, c.local_errors as f64/n, (c.factorisations+c.simplified_factorisations) as f64/n, c.halvings, c.carried());
        }
        if first == 0.0 { first = best; }
        println!("{name} {:.3} µs/step  ratio {:.2}  {text}", best / steps as f64 * 1e6, best / first);
    }
}
