//! Shared by the tests: seeded points, and energies of well-known systems.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    dead_code,
    missing_docs,
    unreachable_pub
)]

use equip_autodiff::Hamiltonian;
use equip_scalar::{Constant, DoubleDouble, FirstOrder, Float, Num, Scalar, decimal, ratio};

/// xorshift64*, Vigna 2016.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() >> 33) as usize % n
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 * (-53_f64).exp2()
    }
}

/// Equal in every bit; any NaN is any other.
pub fn same_bits<T: Float>(a: T, b: T) -> bool {
    let bits = |x: T| x.expansion().map(f64::to_bits);
    bits(a) == bits(b) || (Float::is_nan(a) && Float::is_nan(b))
}

pub fn widened(y: &[f64]) -> Vec<DoubleDouble> {
    y.iter().map(|&x| DoubleDouble::exact(x)).collect()
}

/// An energy written for every kind of number: recorded, and evaluated without a recording.
pub trait Energy {
    fn degrees_of_freedom(&self) -> usize;
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S>;

    fn hamiltonian(&self) -> Hamiltonian {
        Hamiltonian::new(self.degrees_of_freedom(), |q, p| self.energy(q, p)).unwrap()
    }

    /// H(y) by the operations as they are written.
    fn direct<S: Scalar>(&self, y: &[S]) -> S {
        let y: Vec<Num<S>> = y.iter().copied().map(Num).collect();
        let (q, p) = y.split_at(self.degrees_of_freedom());
        self.energy(q, p).0
    }

    /// The same with all first derivatives, by num-dual.
    fn by_num_dual<T: Float, const N: usize>(&self, y: &[T]) -> T::Forward<N> {
        let y: [_; N] = std::array::from_fn(|i| T::Forward::variable(y[i], i));
        self.direct(&y)
    }
}

/// Energies without data.
macro_rules! energies {
    ($($(#[$doc:meta])* $name:ident($m:expr): |$q:ident, $p:ident| $h:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $name;

        impl Energy for $name {
            fn degrees_of_freedom(&self) -> usize {
                $m
            }
            fn energy<S: Scalar>(&self, $q: &[Num<S>], $p: &[Num<S>]) -> Num<S> {
                $h
            }
        }
    )*};
}

energies! {
    Kepler(2): |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    };
    HenonHeiles(2): |q, p| {
        let squares = (p[0].powi(2) + p[1].powi(2) + q[0].powi(2) + q[1].powi(2)) / 2.0;
        squares + q[0].powi(2) * q[1] - ratio(1, 3) * q[1].powi(3)
    };
    Pendulum(1): |q, p| p[0] * p[0] / 2.0 - q[0].cos();
    /// Unit masses and lengths: not separable, the mass matrix depends on the angles.
    DoublePendulum(2): |q, p| {
        let c = (q[0] - q[1]).cos();
        let kinetic = (p[0] * p[0] + 2.0 * p[1] * p[1] - 2.0 * p[0] * p[1] * c)
            / (2.0 * (2.0 - c * c));
        kinetic - 2.0 * q[0].cos() - q[1].cos()
    };
    /// In the field of a constant magnetic field and a quadrupole: q and p meet in (p − A(q))².
    ChargedParticle(3): |q, p| {
        let (x, y) = (p[0] + q[1] * 0.5, p[1] - q[0] * 0.5);
        (x * x + y * y + p[2] * p[2]) * 0.5 + q[2].powi(2) - 0.5 * (q[0].powi(2) + q[1].powi(2))
    };
    /// Burrau's three bodies, masses 3, 4, 5.
    Pythagorean(6): |q, p| {
        let masses = [3.0, 4.0, 5.0];
        let mut h = Num::from(0.0);
        for i in 0..3 {
            h += (p[2 * i] * p[2 * i] + p[2 * i + 1] * p[2 * i + 1]) / (2.0 * masses[i]);
            for j in 0..i {
                let (x, y) = (q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]);
                h -= masses[i] * masses[j] / (x * x + y * y).sqrt();
            }
        }
        h
    };
}

/// Fermi, Pasta, Ulam, Tsingou: quadratic and quartic springs, fixed ends.
pub struct Chain(pub usize);

impl Energy for Chain {
    fn degrees_of_freedom(&self) -> usize {
        self.0
    }
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        let spring = |stretch: Num<S>| stretch.powi(2) / 2.0 + ratio(1, 12) * stretch.powi(4);
        let kinetic: Num<S> = p.iter().map(|p| p.powi(2)).sum();
        let inner: Num<S> = q.windows(2).map(|q| spring(q[1] - q[0])).sum();
        kinetic / 2.0 + inner + spring(q[0]) + spring(q[self.0 - 1])
    }
}

/// Degrees of freedom of random programs.
pub const PROGRAM_M: usize = 3;
const PROGRAM_LENGTH: usize = 60;

/// A straight-line program: operation number and two operands among all earlier results.
pub struct Program {
    steps: Vec<(usize, usize, usize)>,
    constants: Vec<Constant>,
}

impl Program {
    pub fn new(random: &mut Random) -> Self {
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
        let first = 2 * PROGRAM_M + constants.len();
        let operand = |random: &mut Random, known: usize| {
            // Mostly recent results, so that programs are deep.
            if random.below(3) == 0 {
                random.below(known)
            } else {
                known - 1 - random.below(6)
            }
        };
        let steps = (first..first + PROGRAM_LENGTH)
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

    /// Makes constants those of doubles, and operations on constants alone operations on the state: nothing
    /// is rounded but what depends on the state.
    pub fn without_rounded_constants(&mut self) {
        self.constants[4..].fill(Constant::double(0.5));
        let first = 2 * PROGRAM_M;
        let mut is_constant = vec![false; first];
        is_constant.resize(first + self.constants.len(), true);
        for (k, (_, a, b)) in self.steps.iter_mut().enumerate() {
            if is_constant[*a] {
                *a = k % first;
            }
            if is_constant[*b] && k % 3 > 0 {
                *b = (k + 1) % first;
            }
            is_constant.push(false);
        }
    }
}

impl Energy for Program {
    fn degrees_of_freedom(&self) -> usize {
        PROGRAM_M
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
