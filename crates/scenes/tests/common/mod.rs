//! Instances at the ends of their parameters' ranges, and random states.
#![allow(clippy::unwrap_used, clippy::expect_used, dead_code)]

use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_scenes::{Instance, Parameter, Scene, SceneError, all};

/// Sizes above this are left to the tests of size: they say nothing more about correctness.
const LARGEST_SIZE: f64 = 40.0;

/// The scene at its defaults and with each parameter in turn at either end of its range.
pub(crate) fn extremes(scene: &'static Scene) -> Vec<Instance> {
    let mut instances = vec![scene.instance(&[]).unwrap()];
    for parameter in scene.parameters {
        for text in ends(parameter) {
            match scene.instance(&[(parameter.name, &text)]) {
                Ok(instance) => instances.push(instance),
                Err(SceneError::EnergyTooLow { .. }) if scene.name == "henon-heiles" => {}
                Err(error) => panic!("{} {} = {text}: {error}", scene.name, parameter.name),
            }
        }
    }
    instances
}

/// Every scene's extremes.
pub(crate) fn every_instance() -> impl Iterator<Item = Instance> {
    all().iter().flat_map(extremes)
}

fn ends(parameter: &Parameter) -> [String; 2] {
    let range = parameter.range;
    let inward = (range.high - range.low) * 1e-3;
    let low = if range.low_included {
        range.low
    } else {
        range.low + inward
    };
    let high = if range.high_included {
        range.high
    } else {
        range.high - inward
    };
    let is_size = parameter.integer && parameter.name != "seed";
    [
        low,
        if is_size {
            high.min(LARGEST_SIZE)
        } else {
            high
        },
    ]
    .map(|x| format!("{x}"))
}

/// (q₀, p₀) in one slice.
pub(crate) fn start<T: Float>(instance: &Instance) -> Vec<T> {
    let (mut q, p) = instance.initial();
    q.extend(p);
    q
}

/// The start moved by seeded amounts of a tenth of its size.
pub(crate) fn random_state<T: Float>(instance: &Instance, seed: u64) -> Vec<T> {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        T::ratio((state >> 33) as i64 - (1 << 30), 1 << 30)
    };
    let y = start::<T>(instance);
    let m = y.len() / 2;
    let size = |part: &[T]| {
        let largest = part.iter().fold(T::int(0), |a, &x| a.max(x.abs()));
        if largest > T::int(0) {
            largest
        } else {
            T::int(1)
        }
    };
    let sizes = [size(&y[..m]), size(&y[m..])];
    y.iter()
        .enumerate()
        .map(|(i, &x)| x + T::ratio(1, 10) * sizes[i / m] * next())
        .collect()
}

/// (H, ∇H) at y.
pub(crate) fn gradient<T: Float>(h: &Hamiltonian, y: &[T]) -> (T, Vec<T>) {
    let mut gradient = vec![T::int(0); y.len()];
    let value = h.evaluator::<T>().gradient(y, &mut gradient);
    (value, gradient)
}

/// H at y.
pub(crate) fn value<T: Float>(h: &Hamiltonian, y: &[T]) -> T {
    h.evaluator::<T>().value(y)
}
