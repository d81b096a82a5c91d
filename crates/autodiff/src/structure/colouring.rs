//! Groups of columns of ∇²H that can be computed together.
//!
//! Two columns without a common row can share one direction: the product of ∇²H with the sum of their unit
//! vectors contains the entries of both (Curtis, Powell, Reid 1974). The colouring is greedy in the order of
//! the columns. Columns that are connected by rows are coloured together. If a row contains all of them,
//! every two columns have a common row, and no search is needed.
//!
//! Cost: for each entry of a column, the colours of its row so far, one by one or 64 at a time, whichever are
//! fewer.

use super::pattern::Pattern;
use equip_scalar::Float;

/// A direction for every column. Columns without entries have none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Colouring {
    pub(crate) colours: usize,
    of_column: Vec<Option<usize>>,
}

impl Colouring {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        let n = pattern.dimension();
        let mut colouring = Colouring {
            colours: 0,
            of_column: vec![None; n],
        };
        let mut seen = Seen::new(n);
        for component in components(pattern) {
            let is_full = |&i: &usize| pattern.row(i).len() == component.len();
            let every_two_meet = component.iter().any(is_full);
            for (place, &column) in component.iter().enumerate() {
                let colour = match every_two_meet {
                    true => place,
                    false => seen.first_free(pattern, column, &colouring.of_column),
                };
                colouring.colours = colouring.colours.max(colour + 1);
                colouring.of_column[column] = Some(colour);
            }
        }
        colouring
    }

    /// The entries of a symmetric matrix with this pattern, from its products with a vector for each colour.
    /// An entry and its mirror image are read from the same number, so the matrix is exactly symmetric.
    pub(crate) fn entries<T: Float>(
        &self,
        pattern: &Pattern,
        mut product_into: impl FnMut(&[T], &mut [T]),
        entries: &mut [T],
    ) {
        let mut direction = vec![T::int(0); pattern.dimension()];
        let mut product = direction.clone();
        for colour in 0..self.colours {
            for (place, of_column) in direction.iter_mut().zip(&self.of_column) {
                *place = T::int(i64::from(*of_column == Some(colour)));
            }
            product_into(&direction, &mut product);
            for row in 0..pattern.dimension() {
                for (place, column) in pattern.row(row) {
                    if self.of_column[row.max(column)] == Some(colour) {
                        entries[place] = product[row.min(column)];
                    }
                }
            }
        }
    }
}

/// The columns with entries, in sets without common rows, each in ascending order.
fn components(pattern: &Pattern) -> Vec<Vec<usize>> {
    let n = pattern.dimension();
    let mut parent: Vec<usize> = (0..n).collect();
    for i in 0..n {
        for (_, j) in pattern.row(i) {
            let (a, b) = (top(&mut parent, i), top(&mut parent, j));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut of_top = vec![usize::MAX; n];
    let mut components: Vec<Vec<usize>> = Vec::new();
    for i in (0..n).filter(|&i| pattern.row(i).len() > 0) {
        let top = top(&mut parent, i);
        if of_top[top] == usize::MAX {
            of_top[top] = components.len();
            components.push(Vec::new());
        }
        components[of_top[top]].push(i);
    }
    components
}

/// The representative of a set, with path halving.
fn top(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// The colours that a column cannot have.
struct Seen {
    /// The colours of each long row, as bits.
    of_row: Vec<Vec<u64>>,
    /// The colours excluded for the present column.
    taken: Vec<u64>,
}

/// The number of entries from which the colours of a row are stored.
const LONG: usize = 64;

impl Seen {
    fn new(n: usize) -> Self {
        Seen {
            of_row: vec![Vec::new(); n],
            taken: Vec::new(),
        }
    }

    /// The first colour that no column with a common row has.
    fn first_free(&mut self, pattern: &Pattern, column: usize, known: &[Option<usize>]) -> usize {
        self.taken.clear();
        for (_, row) in pattern.row(column) {
            if pattern.row(row).len() >= LONG {
                self.taken
                    .resize(self.taken.len().max(self.of_row[row].len()), 0);
                for (taken, own) in self.taken.iter_mut().zip(&self.of_row[row]) {
                    *taken |= own;
                }
            } else {
                let colours = pattern.row(row).filter_map(|(_, other)| known[other]);
                colours.for_each(|colour| mark(&mut self.taken, colour));
            }
        }
        let word = self.taken.iter().position(|&word| word != u64::MAX);
        let word = word.unwrap_or(self.taken.len());
        let bits = self.taken.get(word).map_or(0, |word| word.trailing_ones());
        let colour = 64 * word + bits as usize;
        for (_, row) in pattern.row(column) {
            if pattern.row(row).len() >= LONG {
                mark(&mut self.of_row[row], colour);
            }
        }
        colour
    }
}

fn mark(bits: &mut Vec<u64>, colour: usize) {
    bits.resize(bits.len().max(colour / 64 + 1), 0);
    bits[colour / 64] |= 1 << (colour % 64);
}
