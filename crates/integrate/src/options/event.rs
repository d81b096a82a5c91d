//! [`Event`]: a function of time and state whose roots along the run are found.

use equip_autodiff::{Hamiltonian, StateFunction};
use equip_scalar::Float;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

/// The direction in which g crosses zero along the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Direction {
    /// Both directions.
    #[default]
    Both,
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
}

type Function<T> = Arc<dyn Fn(T, &[T], &[T]) -> T + Send + Sync>;

/// The change of the state (q, p) by an event at a time. `Break` ends the run.
pub(crate) type Action<T> = Arc<dyn Fn(T, &mut [T], &mut [T]) -> ControlFlow<()> + Send + Sync>;

/// The source of g.
#[derive(Clone)]
enum Source<T> {
    Closure(Function<T>),
    Recording(Box<Hamiltonian>),
}

/// A function g(t, q, p). All its sign changes along the run are found, including several within a step.
///
/// A root is a sign change; zero counts as positive. Two neighbouring roots are both found if |g| between
/// them exceeds its rounding error. If g only touches zero, its rounding decides whether there are two
/// roots or none.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_integrate::{Equip, Event};
///
/// let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (q[0] * q[0] + p[0] * p[0]))?;
/// let run = Equip::stages(8)
///     .tolerance(1e-14)
///     .event(Event::new("turning point", |_t, _q, p| p[0]).falling())
///     .integrate(&oscillator, &[0.0], &[1.0], 0.0..=20.0)?;
/// let times: Vec<f64> = run.events().iter().map(|event| event.time).collect();
/// assert_eq!(times.len(), 3);
/// assert!((times[2] - 4.5 * std::f64::consts::PI).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Event<T> {
    name: String,
    source: Source<T>,
    pub(crate) direction: Direction,
    pub(crate) terminal: bool,
    pub(crate) action: Option<Action<T>>,
}

impl<T> Event<T> {
    /// An event for the roots of `function`, a smooth function (t, q, p) ↦ g.
    pub fn new(
        name: impl Into<String>,
        function: impl Fn(T, &[T], &[T]) -> T + Send + Sync + 'static,
    ) -> Self {
        Event {
            name: name.into(),
            source: Source::Closure(Arc::new(function)),
            direction: Direction::Both,
            terminal: false,
            action: None,
        }
    }

    /// An event for the roots of a function that is traced like an energy, by [`Hamiltonian::new`] or
    /// [`Hamiltonian::with_time`]. Its constants are exact in the floating-point type of the run.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::{Equip, Event};
    ///
    /// let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (q[0] * q[0] + p[0] * p[0]))?;
    /// let moving = Hamiltonian::with_time(1, |t, q, _| q[0] - 0.1 * t)?;
    /// let run = Equip::stages(8)
    ///     .tolerance(1e-13)
    ///     .event(Event::recorded("a wall that moves", moving).terminal())
    ///     .integrate(&oscillator, &[0.0], &[1.0], 0.0..=20.0)?;
    /// let (t, q, _) = run.last();
    /// assert!(run.stopped() && (q[0] - 0.1 * t).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn recorded(name: impl Into<String>, function: Hamiltonian) -> Self {
        Event {
            name: name.into(),
            source: Source::Recording(Box::new(function)),
            direction: Direction::Both,
            terminal: false,
            action: None,
        }
    }

    /// Restricts the event to roots where g rises.
    #[must_use]
    pub fn rising(mut self) -> Self {
        self.direction = Direction::Rising;
        self
    }

    /// Restricts the event to roots where g falls.
    #[must_use]
    pub fn falling(mut self) -> Self {
        self.direction = Direction::Falling;
        self
    }

    /// Whether a root ends the run or changes its state.
    pub(crate) fn acts(&self) -> bool {
        self.terminal || self.action.is_some()
    }

    /// The first root ends the run. The state at the root is the last state of the run.
    #[must_use]
    pub fn terminal(mut self) -> Self {
        self.terminal = true;
        self
    }

    /// At every root `action(t, q, p)` changes the state, as a bounce or a kick does, and the run continues
    /// from there; `ControlFlow::Break(())` ends the run. H and the invariants are conserved at their values
    /// after the change, and fixed steps are counted from the time of the root. Costs one gradient.
    ///
    /// Roots within 256 ε|t| are simultaneous: the changes of all events there are applied,
    /// in the order in which the events were given.
    ///
    /// The state in [`Occurrence`] is the one before the change. The states of the run are those after the
    /// change.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::{Equip, Event};
    /// use std::ops::ControlFlow;
    ///
    /// // A ball that falls from a height of 50 and bounces: t = √(100/9.8) (2n − 1).
    /// let ball = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + 9.8 * q[0])?;
    /// let floor = Event::new("floor", |_, q: &[f64], _: &[f64]| q[0]).falling();
    /// let floor = floor.then(|_, _, p| {
    ///     p[0] = -p[0];
    ///     ControlFlow::Continue(())
    /// });
    /// let options = Equip::stages(4).tolerance(1e-12).event(floor);
    /// let run = options.integrate(&ball, &[50.0], &[0.0], 0.0..=100.0)?;
    /// let exact = |n: f64| (100.0 / 9.8_f64).sqrt() * (2.0 * n - 1.0);
    /// assert_eq!(run.events().len(), 16);
    /// assert!((run.events()[15].time - exact(16.0)).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn then(
        mut self,
        action: impl Fn(T, &mut [T], &mut [T]) -> ControlFlow<()> + Send + Sync + 'static,
    ) -> Self {
        self.action = Some(Arc::new(action));
        self
    }

    /// The name of the event.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The traced function, if there is one.
    pub(crate) fn recording(&self) -> Option<&Hamiltonian> {
        match &self.source {
            Source::Closure(_) => None,
            Source::Recording(function) => Some(function),
        }
    }

    /// g in a form that can be evaluated.
    pub(crate) fn function(&self) -> EventFunction<T>
    where
        T: Float,
    {
        match &self.source {
            Source::Closure(function) => EventFunction::Closure(Arc::clone(function)),
            Source::Recording(function) => EventFunction::Recording(Box::new(function.function())),
        }
    }
}

/// g of an event in one run.
pub(crate) enum EventFunction<T: Float> {
    Closure(Function<T>),
    Recording(Box<StateFunction<T>>),
}

impl<T: Float> EventFunction<T> {
    pub(crate) fn value(&mut self, t: T, q: &[T], p: &[T]) -> T {
        match self {
            EventFunction::Closure(function) => function(t, q, p),
            EventFunction::Recording(function) => function.value(t, q, p),
        }
    }
}

impl<T: Float> fmt::Debug for EventFunction<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("EventFunction")
    }
}

impl<T> fmt::Debug for Event<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Event")
            .field("name", &self.name)
            .field("direction", &self.direction)
            .field("terminal", &self.terminal)
            .finish_non_exhaustive()
    }
}

/// A root of an event function.
#[derive(Debug, Clone, PartialEq)]
pub struct Occurrence<T> {
    /// The index of the event, in the order in which the events were added.
    pub event: usize,
    /// The time of the root.
    pub time: T,
    /// The positions at the root.
    pub q: Vec<T>,
    /// The momenta at the root.
    pub p: Vec<T>,
    /// Whether g rises at the root, in the direction of the run.
    pub rising: bool,
}
