//! Recordings as bytes: what comes back has every bit, and what is damaged is refused.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use crate::allocations::peak;
use crate::common::{Energy, PROGRAM_M, Program, Random, same_bits, widened};
use equip_autodiff::{BuildError, BytesError, Hamiltonian, Var};
use equip_scalar::{Constant, DoubleDouble, Float, Num, Outside, Scalar, decimal, ratio};
use std::sync::Arc;

/// Every function, and constants of every kind.
fn all_functions(q: &[Var], p: &[Var]) -> Var {
    let x = q[0] * q[0] + decimal("0.1234567890123456789012345678901").unwrap();
    let functions = [
        x.cbrt()
            + x.exp2()
            + x.asinh()
            + (x + 1.0).acosh()
            + (x * 0.01).atanh()
            + x.erf()
            + x.erfc(),
        x.recip()
            + x.sqrt()
            + x.exp()
            + x.ln()
            + x.exp_m1()
            + x.ln_1p()
            + x.sin()
            + x.cos()
            + x.tan(),
        (x * 0.01).asin() + (x * 0.01).acos() + x.atan() + x.sinh() + x.cosh() + x.tanh() + x.abs(),
        x.pow(p[0]) + x.atan2(p[0]) + x.hypot(p[0]) + x.min(p[0]) + x.max(p[0]) + x.signum() * p[0],
        x.powi(-3) + x.powf(1.5) + x.powf(ratio(1, 3)) - p[0] / x + p[0].select(x, -x),
    ];
    let third = Constant::from_expansion((DoubleDouble::ONE / DoubleDouble::from(3.0)).expansion());
    functions.into_iter().sum::<Var>() * Var::from(third)
}

/// Value, gradient and Hessian at a point.
fn evaluated<T: Float>(h: &Hamiltonian, y: &[T]) -> Vec<T> {
    let mut evaluator = h.evaluator::<T>();
    let mut results = vec![T::int(0); y.len() + h.structure().hessian.len()];
    let value = evaluator.gradient(y, &mut results[..y.len()]);
    evaluator.hessian(y, &mut results[y.len()..]);
    results.push(value);
    results
}

fn assert_same(h: &Hamiltonian, again: &Hamiltonian, y: &[f64]) {
    let of = |h: &Hamiltonian| {
        (
            h.operations(),
            h.gradient_operations(),
            h.hessian_operations(),
            h.has_time(),
        )
    };
    assert_eq!(of(h), of(again));
    let pairs = evaluated(h, y).into_iter().zip(evaluated(again, y));
    pairs.for_each(|(a, b)| assert!(same_bits(a, b), "{a:e} {b:e}"));
    let wide = widened(y);
    let pairs = evaluated(h, &wide).into_iter().zip(evaluated(again, &wide));
    pairs.for_each(|(a, b)| assert!(same_bits(a, b), "{a:e} {b:e}"));
}

fn back(h: &Hamiltonian) -> Hamiltonian {
    Hamiltonian::from_bytes(&h.to_bytes().unwrap()).unwrap()
}

#[test]
fn every_operation_comes_back() {
    let h = Hamiltonian::new(1, all_functions).unwrap();
    let again = back(&h);
    for y in [[0.3, 0.7], [-1.1, -0.2], [2.0, 1.5]] {
        assert_same(&h, &again, &y);
    }
    assert_eq!(again.to_bytes(), h.to_bytes());
}

#[test]
fn random_expressions_come_back() {
    let mut random = Random(0x5eed_0041);
    let mut compared = 0;
    for _ in 0..200 {
        let program = Program::new(&mut random);
        let Ok(h) = Hamiltonian::new(PROGRAM_M, |q, p| program.energy(q, p)) else {
            continue;
        };
        let y: Vec<f64> = (0..2 * PROGRAM_M)
            .map(|_| random.within(-2.0, 2.0))
            .collect();
        assert_same(&h, &back(&h), &y);
        compared += 1;
    }
    assert!(compared > 100);
}

#[test]
fn time_and_long_sums_come_back() {
    let pushed = Hamiltonian::with_time(1, |t, q, p| p[0] * p[0] / 2 - q[0] * t.cos()).unwrap();
    let again = back(&pushed);
    assert_same(&pushed, &again, &[0.3, 0.1, 0.2, 0.0]);
    let energy = again.function::<f64>().value(0.0, &[2.0], &[1.0]);
    assert_eq!(energy, -1.5);
    let chain = Hamiltonian::new(50, |q, p| {
        let springs = q.windows(2).map(|q| (q[1] - q[0]).powi(4)).sum::<Var>();
        springs + p.iter().map(|p| p.powi(2)).sum::<Var>()
    });
    let chain = chain.unwrap();
    let y: Vec<f64> = (0..100).map(|i| f64::from(i).sin()).collect();
    assert_same(&chain, &back(&chain), &y);
}

#[test]
fn every_flipped_bit_and_every_missing_byte_is_refused() {
    let bytes = Hamiltonian::new(1, all_functions)
        .unwrap()
        .to_bytes()
        .unwrap();
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << bit;
            let error = Hamiltonian::from_bytes(&damaged).unwrap_err();
            match at {
                0..8 => assert_eq!(error, BytesError::NotAnEnergy),
                8..12 => {
                    assert!(matches!(error, BytesError::Format { known: 2, found } if found != 2))
                }
                _ => assert!(matches!(error, BytesError::Damaged { .. }), "{at} {error}"),
            }
        }
        assert!(Hamiltonian::from_bytes(&bytes[..at]).is_err());
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(Hamiltonian::from_bytes(&longer).is_err());
    let newer = [&bytes[..8], &[3, 0, 0, 0], &bytes[12..]].concat();
    let message = Hamiltonian::from_bytes(&newer).unwrap_err().to_string();
    assert!(
        message.contains("format 3, but this version of the library reads format 2"),
        "{message}"
    );
}

/// The same bytes with another content, and its checksum.
fn sealed(bytes: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut content = bytes[20..].to_vec();
    change(&mut content);
    let mix = |sum: u64, &byte: &u8| (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    let sum = content.iter().fold(0xcbf2_9ce4_8422_2325, mix);
    [&bytes[..12], &sum.to_le_bytes(), &content].concat()
}

/// What is read is evaluated; the reader's memory is bounded by the number of bytes.
fn read_within_bounds(bytes: &[u8]) -> Result<Hamiltonian, BytesError> {
    let (read, most) = peak(|| Hamiltonian::from_bytes(bytes));
    let bound = (64 << 20) + 100 * bytes.len();
    assert!(most <= bound, "{most} bytes of memory for {}", bytes.len());
    read
}

#[test]
fn content_is_checked_too() {
    let h = Hamiltonian::new(1, all_functions).unwrap();
    let bytes = h.to_bytes().unwrap();
    assert_eq!(sealed(&bytes, |_| ()), bytes);
    let (mut refused, mut read) = (0, 0);
    for at in 0..bytes.len() - 20 {
        for value in [0, 1, 7, 127, 200, 255] {
            let other = sealed(&bytes, |content| content[at] = value);
            match read_within_bounds(&other) {
                Ok(h) => {
                    let n = 2 * h.structure().degrees_of_freedom;
                    evaluated(&h, &[0.3, 0.7].repeat(n / 2));
                    read += 1;
                }
                Err(error) => {
                    assert!(error.to_string().contains(';'), "{error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 1000 && read > 100, "{refused} {read}");
}

/// A recording with these five counts, and the rest of its content.
fn recording(counts: [u32; 5], rest: &[u8]) -> Vec<u8> {
    [&counts.map(u32::to_le_bytes).concat(), rest].concat()
}

/// A file of the recordings, with its head.
fn file_of(recordings: &[Vec<u8>]) -> Vec<u8> {
    let head = Hamiltonian::new(1, |q, _| q[0])
        .unwrap()
        .to_bytes()
        .unwrap();
    sealed(&head, |content| {
        *content = vec![recordings.len() as u8];
        content.extend(recordings.concat());
    })
}

/// The square of the first component.
const SQUARE: [u8; 5] = [3, 0, 0, 0, 0];

#[test]
fn counts_are_bounded_by_the_bytes_that_are_left() {
    let damaged = |recordings: &[Vec<u8>]| {
        let read = read_within_bounds(&file_of(recordings));
        assert!(
            matches!(read, Err(BytesError::Damaged { .. })),
            "{:?}",
            read.err()
        );
    };
    let many = 1 << 30;
    let file = file_of(&[recording([many, 0, 0, 1, many], &SQUARE)]);
    assert_eq!(file.len(), 46);
    damaged(&[recording([many, 0, 0, 1, many], &SQUARE)]);
    damaged(&[recording([1 << 17, 0, 0, 1, 1 << 17], &SQUARE)]);
    damaged(&[recording([2, many, 0, 1, 2], &SQUARE)]);
    damaged(&[recording([2, 0, many, 1, 2], &SQUARE)]);
    damaged(&[recording([2, 0, 0, many, 2], &SQUARE)]);
    // Of an energy with time, the second recording; and more recordings than an energy has.
    let small = recording([2, 0, 0, 1, 2], &SQUARE);
    damaged(&[small.clone(), recording([many, 0, 0, 1, many], &SQUARE)]);
    damaged(&[small.clone(), recording([4, 0, 0, 1, 4], &SQUARE)]);
    damaged(&vec![recording([60_000, 0, 0, 1, 60_000], &SQUARE); 255]);
    damaged(&[]);
    // What is left of a long file counts: here one byte for each component is not enough.
    let long = [&SQUARE[..], &vec![0; 1 << 20]].concat();
    damaged(&[recording([1 << 20, 0, 0, 1, 1 << 20], &long)]);
    assert!(read_within_bounds(&file_of(&[small])).is_ok());
}

#[test]
fn components_that_no_operation_needs_are_few() {
    let first = |q: &[Var], _: &[Var]| q[0];
    let h = Hamiltonian::new(1 << 15, first).unwrap();
    assert_same(&h, &back(&h), &vec![0.5; 1 << 16]);
    let h = Hamiltonian::new(1 << 16, first).unwrap();
    let components = 1 << 17;
    let error = BytesError::ComponentsNotUsed { components };
    assert_eq!(h.to_bytes().unwrap_err(), error);
    // If H depends on half of them, all have their place.
    let h = Hamiltonian::new(1 << 16, |q, _| q.iter().map(|q| q.powi(2)).sum::<Var>());
    let bytes = h.unwrap().to_bytes().unwrap();
    let again = read_within_bounds(&bytes).unwrap();
    assert_eq!(again.structure().degrees_of_freedom, 1 << 16);
}

/// Another content: bytes set, lost, added or repeated, words that are counts or places in particular.
fn mutant(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    sealed(bytes, |content| {
        for _ in 0..=random.below(3) {
            if content.len() < 24 {
                return;
            }
            let at = random.below(content.len() - 4);
            let count = 1 + 4 * random.below(5);
            let word = match random.below(4) {
                0 => random.bits() as u32,
                1 => 1 << random.below(32),
                2 => u32::MAX >> random.below(32),
                _ => random.below(200) as u32,
            };
            match random.below(8) {
                0 | 1 => content[count..count + 4].copy_from_slice(&word.to_le_bytes()),
                2 => content[count + random.below(4)] = word as u8,
                3 => content[at..at + 4].copy_from_slice(&word.to_le_bytes()),
                4 => content[at] ^= 1 << random.below(8),
                5 => content.truncate(at),
                6 => content.insert(at, word as u8),
                _ => {
                    let end = content.len().min(at + random.below(64));
                    content.extend_from_within(at..end);
                }
            }
        }
    })
}

/// The most memory that one of so many mutants takes, as a part of what is allowed.
fn fuzz(mutants: usize) -> f64 {
    let mut random = Random(0x5eed_0042);
    let mut originals = vec![
        Hamiltonian::new(1, all_functions).unwrap(),
        Hamiltonian::with_time(2, |t, q, p| p[0] * p[1] - q[0] * (t * q[1]).cos()).unwrap(),
        Hamiltonian::new(100, |q, _| {
            q.windows(2).map(|q| (q[1] - q[0]).powi(4)).sum()
        })
        .unwrap(),
    ];
    while originals.len() < 8 {
        let program = Program::new(&mut random);
        originals.extend(Hamiltonian::new(PROGRAM_M, |q, p| program.energy(q, p)));
    }
    let originals: Vec<_> = originals.iter().map(|h| h.to_bytes().unwrap()).collect();
    let (mut most, mut read) = (0.0_f64, 0);
    for number in 0..mutants {
        let mutant = mutant(&originals[number % originals.len()], &mut random);
        let (found, memory) = peak(|| Hamiltonian::from_bytes(&mutant));
        most = most.max(memory as f64 / ((64 << 20) + 100 * mutant.len()) as f64);
        read += usize::from(found.is_ok());
    }
    assert!(most <= 1.0, "{most} of the memory that is allowed");
    println!("{read} of {mutants} mutants are energies; {most:.3} of the memory that is allowed");
    assert!(50 * read > mutants && read < mutants, "{read}");
    most
}

#[test]
fn mutants_take_little_memory() {
    fuzz(1000);
}

#[test]
#[ignore = "long: cargo test --release -p equip-autodiff --test all -- --ignored --nocapture bytes::"]
fn many_mutants_take_little_memory() {
    fuzz(20_000);
}

#[test]
fn constants_are_refused_as_in_a_recording() {
    let h = Hamiltonian::new(1, |q, p| q[0] * 0.7 + p[0]).unwrap();
    let bytes = h.to_bytes().unwrap();
    let place = bytes[20..]
        .windows(8)
        .position(|w| w == 0.7_f64.to_le_bytes())
        .unwrap();
    for (x, expected) in [
        (f64::NAN, BuildError::ConstantNotANumber),
        (f64::INFINITY, BuildError::ConstantInfinite),
    ] {
        let other = sealed(&bytes, |content| {
            content[place..place + 8].copy_from_slice(&x.to_le_bytes());
        });
        assert_eq!(
            Hamiltonian::from_bytes(&other).unwrap_err(),
            BytesError::Refused(expected)
        );
    }
}

/// A function that is code.
#[derive(Debug)]
struct Sine;

impl Outside for Sine {
    fn variables(&self) -> usize {
        1
    }

    fn derivative(&self, [order, _]: [u8; 2], [x, _]: [f64; 2]) -> f64 {
        (x + f64::from(order) * std::f64::consts::FRAC_PI_2).sin()
    }

    fn derivative_in_pairs(&self, orders: [u8; 2], [[x, _], y]: [[f64; 2]; 2]) -> [f64; 2] {
        [self.derivative(orders, [x, y[0]]), 0.0]
    }
}

#[test]
fn code_from_outside_is_named() {
    let sine: Arc<dyn Outside> = Arc::new(Sine);
    let at = |x: Var| Num(Scalar::outside(&sine, [0, 0], [x.0, x.0]));
    let h = Hamiltonian::new(1, |q, _| at(q[0])).unwrap();
    let error = h.to_bytes().unwrap_err();
    let function = "Sine".to_string();
    assert_eq!(error, BytesError::NotData { function });
}
