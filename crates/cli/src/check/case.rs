//! [`Case`]: a row of the catalogue as data, with what is expected of it.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::Invariant;
use equip_scalar::{Constant, DoubleDouble, Float};
use equip_scenes::Instance;
use std::error::Error;

/// Why a problem could not be built.
pub(crate) type BuildFault = Box<dyn Error + Send + Sync>;

/// A Hamiltonian with its start.
#[derive(Debug)]
pub(crate) struct Problem {
    start: Start,
    /// Quadratic and linear invariants, which every method here keeps.
    pub(crate) invariants: Vec<Invariant>,
}

#[derive(Debug)]
enum Start {
    Scene(Box<Instance>),
    Given {
        hamiltonian: Hamiltonian,
        q: Vec<Constant>,
        p: Vec<Constant>,
    },
}

/// Positions and momenta.
pub(crate) type State<T> = (Vec<T>, Vec<T>);

impl Problem {
    pub(crate) fn new<C: Into<Constant> + Copy>(
        hamiltonian: Hamiltonian,
        q: &[C],
        p: &[C],
    ) -> Self {
        let [q, p] = [q, p].map(|all| all.iter().map(|&x| x.into()).collect());
        Problem {
            start: Start::Given { hamiltonian, q, p },
            invariants: Vec::new(),
        }
    }

    /// The energy of a function, started from doubles.
    pub(crate) fn recorded(
        energy: impl FnOnce(&[Var], &[Var]) -> Var,
        q: &[f64],
        p: &[f64],
    ) -> Result<Self, BuildFault> {
        Ok(Problem::new(Hamiltonian::new(q.len(), energy)?, q, p))
    }

    /// The same with a further invariant to watch.
    pub(crate) fn keeping(mut self, name: &str, function: Hamiltonian) -> Self {
        self.invariants.push(Invariant::new(name, function));
        self
    }

    pub(crate) fn hamiltonian(&self) -> &Hamiltonian {
        match &self.start {
            Start::Scene(instance) => instance.hamiltonian(),
            Start::Given { hamiltonian, .. } => hamiltonian,
        }
    }

    pub(crate) fn initial<T: Float>(&self) -> State<T> {
        match &self.start {
            Start::Scene(instance) => instance.initial(),
            Start::Given { q, p, .. } => {
                let read = |all: &[Constant]| all.iter().map(|c| c.to()).collect();
                (read(q), read(p))
            }
        }
    }

    /// The scene, if it is one: it knows closed forms and stored references.
    pub(crate) fn instance(&self) -> Option<&Instance> {
        match &self.start {
            Start::Scene(instance) => Some(instance),
            Start::Given { .. } => None,
        }
    }
}

impl From<Instance> for Problem {
    fn from(instance: Instance) -> Self {
        let kept = instance.invariants().iter();
        let kept = kept.filter(|i| i.is_at_most_quadratic());
        Problem {
            invariants: kept
                .map(|i| Invariant::new(i.name, i.quantity.clone()))
                .collect(),
            start: Start::Scene(Box::new(instance)),
        }
    }
}

/// The number type of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Numbers {
    F64,
    Dd,
}

impl Numbers {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Numbers::F64 => f64::NAME,
            Numbers::Dd => DoubleDouble::NAME,
        }
    }
}

/// The part of the state whose error is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Judged {
    /// All of q and p.
    State,
    /// The first m positions and momenta: the slow ones of FPU.
    First(usize),
    /// Angle and angular momentum of a point in the plane.
    Polar,
}

/// What the trajectory is compared with.
pub(crate) enum Reference {
    /// Nothing.
    None,
    /// The scene's closed form, from the run's own start, in double-double.
    Closed,
    /// The scene's stored state, at the end only.
    Stored,
    /// Gauss with `stages` stages and each step divided by `divide`.
    Fine { stages: usize, divide: u64 },
    /// Gauss with steps `grid / divide`, kept at the multiples of `grid` up to `end`, and shared by the rows
    /// with this `key`.
    Shared {
        key: String,
        grid: f64,
        divide: u64,
        stages: usize,
        end: f64,
    },
    /// The same method on the same problem in other units, with step `h`.
    Scaled { problem: Builder, h: f64 },
}

impl Reference {
    pub(crate) fn fine(stages: usize, divide: u64) -> Self {
        Reference::Fine { stages, divide }
    }
}

/// Builds the problem of a row; called once, in the thread that runs the row.
pub(crate) type Builder = Box<dyn Fn() -> Result<Problem, BuildFault> + Send + Sync>;

/// How the run is to end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// At the end of the interval.
    Complete,
    /// With one of these errors, not before the given time: it is the right answer.
    Error(&'static [Kind], f64, &'static str),
    /// At the end of the interval or with one of these errors.
    Either(&'static [Kind], &'static str),
}

/// The errors a row may expect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    NotFinite,
    NoConvergence,
    Singular,
    EnergyNotFinite,
    Escape,
    Astray,
    Other,
}

/// What is asked of the trajectory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Trajectory {
    /// At most three times the error of Gauss.
    Resolved,
    /// The same in the slow variables.
    Slow,
    /// At most this relative error, whatever Gauss does.
    Within(f64),
    /// Shown, not judged.
    Open(&'static str),
}

/// The designed answer of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expect {
    pub(crate) end: End,
    pub(crate) trajectory: Trajectory,
    /// Of a row that is known to fail: its trajectory error over that of Gauss, as measured.
    pub(crate) deficit: Option<f64>,
}

/// A row of the catalogue.
pub(crate) struct Case {
    pub(crate) theme: &'static str,
    pub(crate) name: String,
    pub(crate) problem: Builder,
    pub(crate) stages: usize,
    pub(crate) h: f64,
    pub(crate) steps: u64,
    /// Fastest frequency, where it is known.
    pub(crate) omega: Option<f64>,
    pub(crate) numbers: Numbers,
    pub(crate) judged: Judged,
    pub(crate) reference: Reference,
    pub(crate) expect: Expect,
    /// Whether it belongs to the quick run too.
    pub(crate) quick: bool,
}

impl Case {
    /// A row in `f64` with s = 4, 100 steps of 0.1, no reference: complete, in both runs. The catalogue sets
    /// its theme.
    pub(crate) fn new(
        name: impl Into<String>,
        problem: impl Fn() -> Result<Problem, BuildFault> + Send + Sync + 'static,
    ) -> Self {
        Case {
            theme: "",
            name: name.into(),
            problem: Box::new(problem),
            stages: 4,
            h: 0.1,
            steps: 100,
            omega: None,
            numbers: Numbers::F64,
            judged: Judged::State,
            reference: Reference::None,
            expect: Expect {
                end: End::Complete,
                trajectory: Trajectory::Resolved,
                deficit: None,
            },
            quick: true,
        }
    }

    /// The same of a scene with parameters.
    pub(crate) fn scene(
        name: impl Into<String>,
        scene: &'static str,
        parameters: &[(&str, &str)],
    ) -> Self {
        let owned = |&(name, value): &(&str, &str)| (name.to_owned(), value.to_owned());
        let parameters: Vec<_> = parameters.iter().map(owned).collect();
        Case::new(name, move || {
            let values = parameters.iter().map(|(n, v)| (n.as_str(), v.as_str()));
            let instance = equip_scenes::find(scene)?.instance(&values.collect::<Vec<_>>())?;
            Ok(instance.into())
        })
    }

    pub(crate) fn stages(mut self, stages: usize) -> Self {
        self.stages = stages;
        self
    }

    pub(crate) fn steps(mut self, steps: u64, h: f64) -> Self {
        (self.steps, self.h) = (steps, h);
        self
    }

    pub(crate) fn omega(mut self, omega: f64) -> Self {
        self.omega = Some(omega);
        self
    }

    pub(crate) fn double_double(mut self) -> Self {
        self.numbers = Numbers::Dd;
        self
    }

    pub(crate) fn judging(mut self, judged: Judged) -> Self {
        self.judged = judged;
        self
    }

    pub(crate) fn against(mut self, reference: Reference) -> Self {
        self.reference = reference;
        self
    }

    pub(crate) fn ending(mut self, end: End) -> Self {
        self.expect.end = end;
        self
    }

    pub(crate) fn trajectory(mut self, trajectory: Trajectory) -> Self {
        self.expect.trajectory = trajectory;
        self
    }

    /// Marks a row that is known to fail, with its trajectory error over that of Gauss.
    pub(crate) fn known_deficit(mut self, ratio: f64) -> Self {
        self.expect.deficit = Some(ratio);
        self
    }

    /// Whether the row belongs to the quick run too; else it is left to the complete one.
    pub(crate) fn quick(mut self, is_quick: bool) -> Self {
        self.quick = is_quick;
        self
    }

    /// Method and step in words.
    pub(crate) fn setting(&self) -> String {
        let mut text = format!("s={} h={}", self.stages, short(self.h));
        if let Some(omega) = self.omega {
            text.push_str(&format!(" hω={}", short(self.h * omega)));
        }
        if self.numbers == Numbers::Dd {
            text.push_str(" dd");
        }
        text
    }
}

/// A number of at most three digits.
pub(crate) fn short(x: f64) -> String {
    let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    if rounded == 0.0 || (1e-3..1e5).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}
