//! A reference solution of system (7) for one step, with the energy as the only constraint: plain loops, full
//! Newton for Z, and the secant method for t around it. Every path of this crate must find this solution. H
//! does not depend on time.
//!
//! With Z_i = Y_i − y0 and L_i = h b_i J∇H(Y_i), the unknowns are Z and α:
//!
//! $$ Z_i = \sum_j K_{ij}(\alpha) L_j, \qquad \alpha = D\, t, \qquad H\Big(y_0 + \sum_i L_i\Big) = H_{ref}
//! . \tag{7} $$
//!
//! | part | in the paper | here |
//! |---|---|---|
//! | K(α) = ½ 1 1ᵀ + Σ (ξ_k + α_k) T_k | (3)–(6), A = K B | [`equip_tableau::Coefficients::matrix_into`] |
//! | residual Z − K L | (7), first line | [`stages`] |
//! | g = H(y1) − H_ref and its round-off level | (7), second line | [`Oracle::step`] |
//! | D at α = 0, the direction of least displacement | docs/adr/0026 | [`direction`] |
//! | admissible α | docs/adr/0013 | [`Oracle::step`] |
//!
//! Cost: dense matrices of size s·2m, allocated and computed in every iteration. Only tests call it, to
//! compare the solver with it.

use crate::outcome::outcome::Outcome;
use crate::policy::{FARTHEST, LEADING, RIDGE, SMALL};
use equip_autodiff::{Evaluator, Hamiltonian, turned};
use equip_linear::DenseLu;
use equip_scalar::Float;
use equip_tableau::Coefficients;
use nalgebra::{DMatrix, DVector};

/// The reference step.
pub(crate) struct Oracle<T: Float> {
    energy: Evaluator<T>,
    /// Rows and columns of the entries of ∇²H.
    places: Vec<(usize, usize)>,
    h_ref: T,
    alpha_bound: T,
}

/// The result of a step.
pub(crate) struct Solution<T> {
    pub(crate) end: Vec<T>,
    pub(crate) alphas: Vec<T>,
    pub(crate) outcome: Outcome,
}

/// The stages of one step.
struct Stages<T> {
    z: Vec<Vec<T>>,
    l: Vec<Vec<T>>,
    end: Vec<T>,
}

impl<T: Float> Oracle<T> {
    pub(crate) fn new(system: &Hamiltonian, h_ref: T, alpha_bound: T) -> Self {
        let pattern = &system.structure().hessian;
        let rows = 0..pattern.dimension();
        let places = rows.flat_map(|i| pattern.row(i).map(move |(_, j)| (i, j)));
        Oracle {
            energy: system.evaluator::<T>(),
            places: places.collect(),
            h_ref,
            alpha_bound,
        }
    }

    /// The step of size `h` from `y` with the energy error `start_error` at its start. `None` if Newton's
    /// method does not converge.
    pub(crate) fn step(
        &mut self,
        gauss: &Coefficients<T>,
        y: &[T],
        h: T,
        start_error: T,
    ) -> Option<Solution<T>> {
        let s = gauss.stages();
        let mut alphas = vec![T::int(0); s - 1];
        let unperturbed = self.stages(gauss, (y, h), &alphas, None)?;
        let (mut g, gradient, round_off) = self.residual(&unperturbed.end);
        let uncorrected = |outcome| {
            Some(Solution {
                end: unperturbed.end.clone(),
                alphas: vec![T::int(0); s - 1],
                outcome,
            })
        };
        if g.abs() <= round_off {
            return uncorrected(Outcome::AtRoundOff);
        }
        if self.fastest(gauss, (y, h), &unperturbed) > T::int(s as i64) {
            return uncorrected(Outcome::Unresolved);
        }
        let mut start_gradient = y.to_vec();
        self.energy.gradient(y, &mut start_gradient);
        let units = motion(y, &unperturbed);
        let worth = |units: &[T]| dot_abs(&gradient, units) + dot_abs(&start_gradient, units);
        let error = self.local_error(gauss, (y, h), &unperturbed)?;
        let most = units.each_ref().map(|units| {
            let own = T::int(2) * (g - start_error).abs() / worth(units);
            let error = error
                .iter()
                .zip(units)
                .fold(T::int(0), |a, (&e, &x)| a.max((e / x).abs()));
            let most = T::int(FARTHEST) * own.max(error);
            most.min(T::ratio(1, SMALL))
        });
        let gradients = [&start_gradient, &gradient];
        let Some((d, mut derivative)) =
            self.direction(gauss, (y, h), &unperturbed, gradients, &units[0])
        else {
            return uncorrected(Outcome::NoEffect);
        };
        let mut at = self.stages(gauss, (y, h), &alphas, None)?;
        let mut t = T::int(0);
        for _ in 0..30 {
            let (change, before) = (-g / derivative, g);
            t += change;
            let along = alphas.iter_mut().zip(&d);
            along.for_each(|(alpha, &d)| *alpha = d * t);
            if !alphas.iter().all(|alpha| alpha.abs() <= self.alpha_bound) {
                return uncorrected(Outcome::BeyondBound);
            }
            at = self.stages(gauss, (y, h), &alphas, Some(at.z))?;
            g = self.residual(&at.end).0;
            if g.abs() <= round_off / T::int(4) {
                break;
            }
            derivative = (g - before) / change;
        }
        let moved = |c: usize| (at.end[c] - unperturbed.end[c]).abs();
        let is_within = units
            .iter()
            .zip(most)
            .all(|(units, most)| (0..y.len()).all(|c| moved(c) <= most * units[c]));
        if is_within {
            Some(Solution {
                end: at.end,
                alphas,
                outcome: Outcome::Solved,
            })
        } else {
            uncorrected(Outcome::TooFar)
        }
    }

    /// Solves Z − K(α) L(Z) = 0 by Newton's method, from Z = 0 or from a guess.
    fn stages(
        &mut self,
        gauss: &Coefficients<T>,
        (y, h): (&[T], T),
        alphas: &[T],
        guess: Option<Vec<Vec<T>>>,
    ) -> Option<Stages<T>> {
        let (s, n) = (gauss.stages(), y.len());
        let k = matrix(gauss, alphas);
        let mut z = guess.unwrap_or_else(|| vec![vec![T::int(0); n]; s]);
        let mut last = T::INFINITY;
        for _ in 0..60 {
            let l = self.increments(gauss, (y, h), &z);
            let mut residual = DVector::zeros(s * n);
            for i in 0..s {
                for c in 0..n {
                    let kl = (0..s).fold(T::int(0), |sum, j| sum + k[(i, j)] * l[j][c]);
                    residual[i * n + c] = kl - z[i][c];
                }
            }
            let size = residual.amax();
            if size == T::int(0) || size >= last && size <= T::EPSILON.sqrt() {
                let end = (0..n).map(|c| y[c] + (0..s).fold(T::int(0), |sum, i| sum + l[i][c]));
                return Some(Stages {
                    end: end.collect(),
                    z,
                    l,
                });
            }
            last = size;
            let b = self.linearise(gauss, (y, h), &z);
            let lu = factor(&k, &b, n)?;
            lu.solve(&mut residual);
            for (i, z) in z.iter_mut().enumerate() {
                (0..n).for_each(|c| z[c] += residual[i * n + c]);
            }
        }
        None
    }

    /// L_i = h b_i J∇H(y0 + Z_i).
    fn increments(
        &mut self,
        gauss: &Coefficients<T>,
        (y, h): (&[T], T),
        z: &[Vec<T>],
    ) -> Vec<Vec<T>> {
        let n = y.len();
        let each = z.iter().zip(gauss.weights()).map(|(z, &b)| {
            let point: Vec<T> = y.iter().zip(z).map(|(&y, &z)| y + z).collect();
            let (mut gradient, mut l) = (vec![T::int(0); n], vec![T::int(0); n]);
            self.energy.flow_gradient(&point, &mut gradient);
            for (c, &g) in gradient.iter().enumerate() {
                let (row, sign) = turned::<T>(c, n);
                l[row] = sign * (h * b) * g;
            }
            l
        });
        each.collect()
    }

    /// B_i = h b_i J∇²H(y0 + Z_i).
    fn linearise(
        &mut self,
        gauss: &Coefficients<T>,
        (y, h): (&[T], T),
        z: &[Vec<T>],
    ) -> Vec<DMatrix<T>> {
        let n = y.len();
        let each = z.iter().zip(gauss.weights()).map(|(z, &weight)| {
            let point: Vec<T> = y.iter().zip(z).map(|(&y, &z)| y + z).collect();
            let mut entries = vec![T::int(0); self.places.len()];
            self.energy.hessian(&point, &mut entries);
            let mut b = DMatrix::zeros(n, n);
            for (&(i, j), &x) in self.places.iter().zip(&entries) {
                let (row, sign) = turned::<T>(i, n);
                b[(row, j)] = sign * (h * weight) * x;
            }
            b
        });
        each.collect()
    }

    /// hω, with ω the largest |λ| of the mean of J∇²H over the step, by power iteration on the square.
    fn fastest(&mut self, gauss: &Coefficients<T>, step: (&[T], T), at: &Stages<T>) -> T {
        let b = self.linearise(gauss, step, &at.z);
        let n = step.0.len();
        let mean = b.iter().fold(DMatrix::zeros(n, n), |sum, b| sum + b);
        let mut x = DVector::from_fn(n, |i, _| T::int(i as i64 + 1).sin());
        let mut square = T::int(0);
        for _ in 0..64 {
            x = &mean * (&mean * &x);
            square = x.amax();
            x /= square.max(T::MIN_POSITIVE);
        }
        square.sqrt()
    }

    /// D for the energy alone, and ∂g/∂t. The largest entry of D is 1, and the entries of the parameters that
    /// do not change are 0.
    fn direction(
        &mut self,
        gauss: &Coefficients<T>,
        (y, h): (&[T], T),
        at: &Stages<T>,
        [start_gradient, gradient]: [&Vec<T>; 2],
        units: &[T],
    ) -> Option<(Vec<T>, T)> {
        let (s, n) = (gauss.stages(), y.len());
        let free = (s - 1).min(LEADING);
        let b = self.linearise(gauss, (y, h), &at.z);
        let lu = factor(&matrix(gauss, &vec![T::int(0); s - 1]), &b, n)?;
        let solve = |mut x: DVector<T>| {
            lu.solve(&mut x);
            (0..s).fold(DVector::zeros(n), |sum, i| sum + &b[i] * x.rows(i * n, n))
        };
        // Ψ, the derivative of the end point by the start, column by column.
        let mut psi = DenseLu::new(n);
        for c in 0..n {
            let unit = DVector::from_fn(s * n, |row, _| T::int(i64::from(row % n == c)));
            let end = solve(unit);
            for row in 0..n {
                psi.matrix_mut()[(row, c)] = end[row] + T::int(i64::from(row == c));
            }
        }
        psi.factor().ok()?;
        let (mut rows, mut v, mut derivative) = (Vec::new(), Vec::new(), vec![T::int(0); s - 1]);
        for k in 1..=free {
            let t = gauss.skew_basis(k);
            let end = solve(DVector::from_fn(s * n, |row, _| {
                let (i, c) = (row / n, row % n);
                (0..s).fold(T::int(0), |sum, j| sum + t[i * s + j] * at.l[j][c])
            }));
            let mut start = -&end;
            psi.solve(&mut start);
            let weighted = |x: &DVector<T>| {
                x.iter()
                    .zip(units)
                    .map(|(&x, &unit)| x / unit)
                    .collect::<Vec<_>>()
            };
            rows.push([weighted(&end), weighted(&start)].concat());
            derivative[k - 1] = dot(gradient, end.as_slice());
            v.push(derivative[k - 1] - dot(start_gradient, start.as_slice()));
        }
        let ridge = T::int(1) + T::ratio(1, RIDGE);
        let mut gram = DenseLu::new(free);
        for i in 0..free {
            for j in 0..free {
                let x = dot(&rows[i], &rows[j]);
                gram.matrix_mut()[(i, j)] = if i == j { ridge * x } else { x };
            }
        }
        gram.factor().ok()?;
        let mut d = DVector::from_vec(v);
        gram.solve(&mut d);
        let largest = d.amax();
        let mut direction = vec![T::int(0); s - 1];
        direction
            .iter_mut()
            .zip(d.iter())
            .for_each(|(to, &d)| *to = d / largest);
        let along = dot(&derivative, &direction);
        (largest > T::int(0)).then_some((direction, along))
    }

    /// The end point of the method with two more stages, minus the end point of this step.
    fn local_error(
        &mut self,
        gauss: &Coefficients<T>,
        step: (&[T], T),
        at: &Stages<T>,
    ) -> Option<Vec<T>> {
        let finer = Coefficients::gauss(gauss.stages() + 2).ok()?;
        let finer = self.stages(&finer, step, &vec![T::int(0); gauss.stages() + 1], None)?;
        Some(
            finer
                .end
                .iter()
                .zip(&at.end)
                .map(|(&a, &b)| a - b)
                .collect(),
        )
    }

    /// g = H(y1) − H_ref, ∇H(y1), and the round-off level of g.
    fn residual(&mut self, end: &[T]) -> (T, Vec<T>, T) {
        let mut gradient = vec![T::int(0); end.len()];
        let (value, bound) = self.energy.gradient_with_bound(end, &mut gradient);
        (
            value - self.h_ref,
            gradient,
            T::EPSILON * (bound + T::MIN_POSITIVE),
        )
    }
}

/// The change of each component over the step, and the largest such change in its group (positions, momenta).
fn motion<T: Float>(y: &[T], at: &Stages<T>) -> [Vec<T>; 2] {
    let root = T::EPSILON.sqrt();
    let own: Vec<T> = (0..y.len())
        .map(|c| {
            let points = at.z.iter().map(|z| y[c] + z[c]).chain([at.end[c]]);
            let (low, high) = points.fold((y[c], y[c]), |(low, high), x| (low.min(x), high.max(x)));
            (high - low) + root * low.abs().max(high.abs())
        })
        .collect();
    let groups = own.chunks(y.len() / 2).flat_map(|group| {
        let most = group.iter().fold(T::int(0), |a, &x| a.max(x));
        vec![most; group.len()]
    });
    let groups = groups.collect();
    [own, groups]
}

/// K(α).
fn matrix<T: Float>(gauss: &Coefficients<T>, alphas: &[T]) -> DMatrix<T> {
    let s = gauss.stages();
    let mut k = vec![T::int(0); s * s];
    gauss.matrix_into(alphas, &mut k);
    DMatrix::from_row_slice(s, s, &k)
}

/// The LU factorisation of I − (K_ij B_j).
fn factor<T: Float>(k: &DMatrix<T>, b: &[DMatrix<T>], n: usize) -> Option<DenseLu<T>> {
    let s = b.len();
    let mut lu = DenseLu::new(s * n);
    let matrix = lu.matrix_mut();
    matrix.fill_with_identity();
    for i in 0..s {
        for (j, b) in b.iter().enumerate() {
            for row in 0..n {
                for column in 0..n {
                    matrix[(i * n + row, j * n + column)] -= k[(i, j)] * b[(row, column)];
                }
            }
        }
    }
    lu.factor().ok()?;
    Some(lu)
}

fn dot<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::int(0), |sum, (&x, &y)| sum + x * y)
}

fn dot_abs<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter()
        .zip(b)
        .fold(T::int(0), |sum, (&x, &y)| sum + (x * y).abs())
}
