//! Random expressions: the replayed value has every bit of the energy evaluated directly.
#![allow(clippy::unwrap_used)]

use crate::common::{Random, same_bits, widened};
use equip_autodiff::{Energy, Evaluate, Hamiltonian, System};
use equip_scalar::{Constant, DoubleDouble, Float, Num, Scalar, decimal, ratio};

const EXPRESSIONS: usize = 400;
const LENGTH: usize = 60;
const M: usize = 3;

/// A straight-line program: operation number and two operands among all earlier results.
struct Program {
    steps: Vec<(usize, usize, usize)>,
    constants: Vec<Constant>,
}

impl Program {
    fn new(random: &mut Random) -> Self {
        let constants = vec![
            Constant::double(0.0),
            Constant::double(-0.0),
            Constant::double(1.0),
            Constant::double(-1.0),
            Constant::double(random.within(-2.0, 2.0)),
            ratio(1, 3),
            decimal("0.1").unwrap(),
            Constant::from(DoubleDouble::ratio(2, 7)),
        ];
        let first = 2 * M + constants.len();
        let operand = |random: &mut Random, known: usize| {
            // Mostly recent results, so that programs are deep.
            if random.below(3) == 0 {
                random.below(known)
            } else {
                known - 1 - random.below(6)
            }
        };
        let steps = (first..first + LENGTH)
            .map(|known| {
                (
                    random.below(40),
                    operand(random, known),
                    operand(random, known),
                )
            })
            .collect();
        Program { steps, constants }
    }
}

impl Energy for Program {
    fn degrees_of_freedom(&self) -> usize {
        M
    }

    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        let mut all: Vec<Num<S>> = q.iter().chain(p).copied().collect();
        all.extend(self.constants.iter().map(|&c| Num::from(c)));
        for &(operation, a, b) in &self.steps {
            let (x, y) = (all[a], all[b]);
            all.push(match operation {
                0..6 => x + y,
                6..10 => x - y,
                10..14 => x * y,
                14 => x / y,
                15 => -x,
                16 => x.recip(),
                17 => x.sqrt(),
                18 => x.powi(2),
                19 => x.powi(3),
                20 => x.powi(-2),
                21 => x.powi(5),
                22 => x.powf(1.5),
                23 => x.powf(ratio(1, 3)),
                24 => x.abs().pow(y),
                25 => x.exp(),
                26 => x.abs().ln(),
                27 => x.sin(),
                28 => x.cos(),
                29 => x.atan2(y),
                30 => x.hypot(y),
                31 => x.min(y),
                32 => x.max(y),
                33 => x.abs(),
                34 => x.tanh(),
                35 => x.atan(),
                36 => x * x,
                37 => x.powi(0) + y.powi(1),
                38 => x + 0.0,
                _ => x - 0.0,
            });
        }
        let last = all.len() - 1;
        all[last] + all[last - 1] + all[last - 2]
    }
}

#[test]
fn replay_has_every_bit_of_direct_evaluation() {
    let mut random = Random(0x5eed_0002);
    let mut finite = 0;
    for _ in 0..EXPRESSIONS {
        let program = Program::new(&mut random);
        // A random program may fold its constants to NaN; that is refused, and tested elsewhere.
        let Ok(h) = Hamiltonian::new(M, |q, p| program.energy(q, p)) else {
            continue;
        };
        for _ in 0..3 {
            let y: Vec<f64> = (0..2 * M).map(|_| random.within(-2.0, 2.0)).collect();
            let replayed = h.evaluator::<f64>().value(&y);
            assert!(same_bits(replayed, direct(&program, &y)), "{y:?}");
            finite += usize::from(replayed.is_finite());
            let wide = widened(&y);
            let replayed = h.evaluator::<DoubleDouble>().value(&wide);
            assert!(same_bits(replayed, direct(&program, &wide)), "{y:?}");
        }
    }
    assert!(finite > EXPRESSIONS, "only {finite} finite values");
}

#[test]
fn tangents_and_gradients_agree_on_random_expressions() {
    let mut random = Random(0x5eed_0003);
    let mut compared = 0;
    for _ in 0..EXPRESSIONS {
        let program = Program::new(&mut random);
        let Ok(h) = Hamiltonian::new(M, |q, p| program.energy(q, p)) else {
            continue;
        };
        let y: Vec<f64> = (0..2 * M).map(|_| random.within(-2.0, 2.0)).collect();
        let mut evaluator = h.evaluator::<f64>();
        let pattern = &h.structure().hessian;
        let mut entries = vec![0.0; pattern.len()];
        evaluator.hessian(&y, &mut entries);
        let v: Vec<f64> = (0..2 * M).map(|_| random.within(-1.0, 1.0)).collect();
        let mut product = vec![0.0; 2 * M];
        evaluator.hessian_vector(&y, &v, &mut product);
        let size = entries.iter().fold(1e-3_f64, |a, b| a.max(b.abs()));
        if !(entries.iter().chain(&product).all(|x| x.is_finite()) && size < 1e6) {
            continue;
        }
        for (i, found) in product.iter().enumerate() {
            let expected: f64 = pattern.row(i).map(|(entry, j)| entries[entry] * v[j]).sum();
            assert!(
                (found - expected).abs() < 1e-10 * size,
                "{found:e} {expected:e}"
            );
        }
        compared += 1;
    }
    assert!(
        compared > EXPRESSIONS / 4,
        "only {compared} expressions compared"
    );
}

fn direct<T: Float>(program: &Program, y: &[T]) -> T {
    let y: Vec<Num<T>> = y.iter().copied().map(Num).collect();
    program.energy(&y[..M], &y[M..]).0
}
