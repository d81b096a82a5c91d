//! A polynomial on which symmetric methods drift in energy and symplectic ones do not.
//!
//! H = p³/3 − p/2 + q⁶/30 + q⁴/4 − q³/3 + 1/6, [Faou, Hairer, Pham, Energy conservation with non-symplectic
//! methods: examples and counter-examples, BIT 44, 2004], from (q, p) = (0, 1), where H = 0. The solution is
//! not symmetric in time.

use crate::entry::scene;
use crate::model::{Model, State};
use equip_autodiff::Var;
use equip_scalar::{Float, ratio};

scene! {
    /// p³/3 − p/2 + q⁶/30 + q⁴/4 − q³/3 + 1/6.
    pub struct FaouHairerPham {}
    name: "faou-hairer-pham",
    title: "Faou, Hairer and Pham's polynomial",
    formula: "H = p^3/3 - p/2 + q^6/30 + q^4/4 - q^3/3 + 1/6",
    source: "Faou, Hairer, Pham, Energy conservation with non-symplectic methods: examples and counter-examples, BIT 44 (2004)",
    invariants: "none besides H",
    solution: "none stored",
    hard: "H_ref = 0 and the kinetic part is not quadratic: relative energy errors are meaningless, and the positions alone cannot be the unknowns",
    units: "",
    period: "",
}

impl Model for FaouHairerPham {
    fn energy(&self, q: &[Var], p: &[Var]) -> Var {
        let (q, p) = (q[0], p[0]);
        let kinetic = ratio(1, 3) * p.powi(3) - 0.5 * p;
        kinetic + ratio(1, 30) * q.powi(6) + 0.25 * q.powi(4) - ratio(1, 3) * q.powi(3)
            + ratio(1, 6)
    }

    fn initial<T: Float>(&self) -> State<T> {
        (vec![T::int(0)], vec![T::int(1)])
    }

    /// The unit of time.
    fn period<T: Float>(&self, _: &State<T>) -> T {
        T::int(1)
    }

    fn step(&self) -> f64 {
        0.1
    }

    fn end(&self) -> f64 {
        100.0
    }
}
