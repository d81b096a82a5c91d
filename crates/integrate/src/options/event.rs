//! [`Event`]: a function of time and state whose roots along the run are wanted.

use equip_autodiff::{Hamiltonian, StateFunction};
use equip_scalar::Float;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Which way g crosses zero, in the direction in which the run goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Direction {
    /// Either way.
    #[default]
    Both,
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
}

type Function<T> = Arc<dyn Fn(T, &[T], &[T]) -> T + Send + Sync>;

/// What an event does to the state (q, p) at a time; a break ends the run there.
pub(crate) type Action<T> = Arc<dyn Fn(T, &mut [T], &mut [T]) -> ControlFlow<()> + Send + Sync>;

/// Where g comes from.
#[derive(Clone)]
enum Source<T> {
    Closure(Function<T>),
    Recording(Box<Hamiltonian>),
}

/// A function g(t, q, p) whose sign changes along the run are found, between the steps as well, all of those
/// within a step.
///
/// A root is where the sign changes; zero counts as positive. Two roots are told apart, and neither is
/// missed, if g between them exceeds the rounding of g: where g only touches zero, that decides whether there
/// are two roots or none.
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
    /// The roots of `function`, a smooth function (t, q, p) ↦ g.
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

    /// The roots of a function recorded like an energy, by [`Hamiltonian::new`] or
    /// [`Hamiltonian::with_time`]: with constants as exact as the float type of the run.
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

    /// Only roots where g rises.
    #[must_use]
    pub fn rising(mut self) -> Self {
        self.direction = Direction::Rising;
        self
    }

    /// Only roots where g falls.
    #[must_use]
    pub fn falling(mut self) -> Self {
        self.direction = Direction::Falling;
        self
    }

    /// The first root ends the run: its state is the last of the run.
    #[must_use]
    pub fn terminal(mut self) -> Self {
        self.terminal = true;
        self
    }

    /// At every root `action(t, q, p)` changes the state, as a bounce or a kick does, and the run continues
    /// from there; a `ControlFlow::Break(())` ends it. H and invariants are conserved at the values that they
    /// have after the change, and fixed steps are counted from the time of the root. Costs a gradient.
    ///
    /// The state in [`Occurrence`] is the one before the change, the states of the run are those after it.
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

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What was recorded.
    pub(crate) fn recording(&self) -> Option<&Hamiltonian> {
        match &self.source {
            Source::Closure(_) => None,
            Source::Recording(function) => Some(function),
        }
    }

    /// g, ready to be evaluated.
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
    /// Number of the event, in the order in which they were added.
    pub event: usize,
    /// When.
    pub time: T,
    /// Positions then.
    pub q: Vec<T>,
    /// Momenta then.
    pub p: Vec<T>,
    /// Whether g rises there, in the direction in which the run goes.
    pub rising: bool,
}
