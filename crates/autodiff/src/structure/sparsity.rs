//! The sparsity pattern of ∇²H.
//!
//! Every operation with non-zero second derivatives couples the inputs of its operands: a product ab couples
//! those of a with those of b, a quotient a/b those of b with all, any other nonlinear function all with all.
//! The union over the operations is the pattern; cancellation is not detected. Sets of inputs are computed
//! only for operands of such operations, so a final sum over all particles costs nothing. Equal sets are
//! stored once, so that a dense H does not repeat its n² couplings for each operation.

use crate::Pattern;
use crate::recording::graph::Graph;
use crate::recording::op::{Curvature, Op};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;

/// The diagonal block of ∇²H with these rows and columns, counted from 0.
pub(crate) fn hessian_pattern(graph: &Graph, variables: Range<usize>) -> Pattern {
    let wanted = wanted(graph);
    let mut sets = Sets::default();
    let mut rows = Rows::new(variables.len());
    let mut dependence: Vec<u32> = Vec::with_capacity(graph.nodes.len());
    let mut coupled: HashSet<(u32, u32)> = HashSet::new();
    for (i, node) in graph.nodes.iter().enumerate() {
        let (a, b) = match node.op.arity() {
            0 => (Sets::EMPTY, Sets::EMPTY),
            _ => (dependence[node.a as usize], dependence[node.b as usize]),
        };
        let own = match node.op {
            Op::Input(k) if variables.contains(&(k as usize)) => {
                sets.intern(vec![k - variables.start as u32])
            }
            Op::Input(_) => Sets::EMPTY,
            _ if !wanted[i] => Sets::EMPTY,
            Op::Sum(_) => {
                let terms: Vec<u32> = graph.operands(i).map(|x| dependence[x as usize]).collect();
                sets.union_of(terms)
            }
            _ => sets.union(a, b),
        };
        dependence.push(own);
        let couplings: &[(u32, u32)] = match graph.curvature(i) {
            Curvature::None => &[],
            Curvature::Product => &[(a, b)],
            Curvature::Quotient => &[(a, b), (b, b)],
            Curvature::Full => &[(a, a), (a, b), (b, b)],
        };
        for &(a, b) in couplings {
            if coupled.insert((a.min(b), a.max(b))) {
                rows.couple(sets.get(a), sets.get(b));
            }
        }
    }
    rows.into_pattern()
}

/// The nodes whose set of inputs is needed: operands of nonlinear operations, and operands of such nodes.
fn wanted(graph: &Graph) -> Vec<bool> {
    let mut wanted = vec![false; graph.nodes.len()];
    for i in (0..graph.nodes.len()).rev() {
        if wanted[i] || graph.curvature(i) != Curvature::None {
            graph.operands(i).for_each(|x| wanted[x as usize] = true);
        }
    }
    wanted
}

/// Sets of inputs, each stored once.
#[derive(Default)]
struct Sets {
    sets: Vec<Rc<[u32]>>,
    known: HashMap<Rc<[u32]>, u32>,
    unions: HashMap<(u32, u32), u32>,
}

impl Sets {
    const EMPTY: u32 = u32::MAX;

    fn get(&self, id: u32) -> &[u32] {
        self.sets.get(id as usize).map_or(&[], |set| &**set)
    }

    /// The set with these elements, in ascending order.
    fn intern(&mut self, elements: Vec<u32>) -> u32 {
        if elements.is_empty() {
            return Sets::EMPTY;
        }
        let set: Rc<[u32]> = elements.into();
        *self.known.entry(Rc::clone(&set)).or_insert_with(|| {
            self.sets.push(set);
            self.sets.len() as u32 - 1
        })
    }

    fn union(&mut self, a: u32, b: u32) -> u32 {
        if a == b || b == Sets::EMPTY {
            return a;
        }
        if a == Sets::EMPTY {
            return b;
        }
        let key = (a.min(b), a.max(b));
        if let Some(&id) = self.unions.get(&key) {
            return id;
        }
        let id = self.union_of(vec![a, b]);
        self.unions.insert(key, id);
        id
    }

    fn union_of(&mut self, mut ids: Vec<u32>) -> u32 {
        ids.sort_unstable();
        ids.dedup();
        let mut elements: Vec<u32> = ids
            .into_iter()
            .flat_map(|id| self.get(id).iter().copied())
            .collect();
        elements.sort_unstable();
        elements.dedup();
        self.intern(elements)
    }
}

/// The columns of each row. Duplicates are removed whenever the length of a row has doubled.
struct Rows {
    columns: Vec<Vec<u32>>,
    limits: Vec<usize>,
}

impl Rows {
    fn new(n: usize) -> Self {
        Rows {
            columns: vec![Vec::new(); n],
            limits: vec![64; n],
        }
    }

    /// Adds every entry of a × b and b × a.
    fn couple(&mut self, a: &[u32], b: &[u32]) {
        for (rows, columns) in [(a, b), (b, a)] {
            for &row in rows {
                self.extend(row as usize, columns);
            }
        }
    }

    fn extend(&mut self, row: usize, columns: &[u32]) {
        let own = &mut self.columns[row];
        own.extend_from_slice(columns);
        if own.len() > self.limits[row] {
            own.sort_unstable();
            own.dedup();
            self.limits[row] = 2 * own.len() + 64;
        }
    }

    fn into_pattern(self) -> Pattern {
        let mut pattern = Pattern {
            row_starts: vec![0],
            columns: Vec::new(),
        };
        for mut row in self.columns {
            row.sort_unstable();
            row.dedup();
            pattern
                .columns
                .extend(row.into_iter().map(|column| column as usize));
            pattern.row_starts.push(pattern.columns.len());
        }
        pattern
    }
}
