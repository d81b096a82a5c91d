//! K(α): which identities hold to the last bit.

#![allow(clippy::unwrap_used)]

use equip_scalar::Float;
use equip_tableau::Gauss;

#[test]
fn k_plus_its_transpose_is_one_f64() {
    check::<f64>();
}

fn check<T: Float>() {
    for s in 1..=20 {
        let gauss = Gauss::<T>::new(s).unwrap();
        let k = gauss.skew(&vec![T::ratio(1, 3); s - 1]);
        for i in 0..s {
            for j in 0..s {
                assert_eq!(k[i * s + j] + k[j * s + i], T::int(1));
            }
        }
    }
}
