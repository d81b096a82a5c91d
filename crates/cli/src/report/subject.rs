//! The scenes of the report, with end times and end states.
//!
//! End states come from the scene's exact flow of the rounded start, from its stored reference, or, where
//! there is neither, from Gauss(16) in double-double with half the step of another run, whose difference
//! bounds the error. Kepler's problem ends at a time that is no whole number of periods: at whole periods a
//! method that does nothing scores zero.

use crate::fault::Fault;
use crate::text::symbol;
use End::{Periods, Time};
use Source::{Reference, Scene};
use equip_integrate::{Gauss, Record};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::Instance;

/// A scene of the report as it is listed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    /// Name in files; the scene's with what sets it apart.
    pub(super) name: &'static str,
    source: Source,
    /// Steps of the coarsest run with s = 4; the others follow.
    pub(super) fewest: f64,
    /// Whether it belongs to the quick report.
    pub(super) quick: bool,
    /// Whether it is also run in double-double.
    pub(super) extended: bool,
}

#[derive(Debug, Clone, Copy)]
enum Source {
    /// A scene with these parameters, up to a time.
    Scene(&'static str, &'static [(&'static str, &'static str)], End),
    /// A stored reference solution, up to its time.
    Reference(&'static str),
}

#[derive(Debug, Clone, Copy)]
enum End {
    Periods(f64),
    Time(f64),
}

const fn entry(name: &'static str, source: Source, fewest: f64) -> Entry {
    let (quick, extended) = (false, false);
    Entry {
        name,
        source,
        fewest,
        quick,
        extended,
    }
}

impl Entry {
    const fn quick(mut self) -> Self {
        self.quick = true;
        self
    }

    const fn extended(mut self) -> Self {
        self.extended = true;
        self
    }
}

/// The scenes in the order of the page.
pub(super) const ENTRIES: [Entry; 9] = [
    entry(
        "kepler-0.6",
        Scene("kepler", &[("e", "0.6")], Periods(10.3)),
        100.0,
    )
    .quick()
    .extended(),
    entry(
        "kepler-0.9",
        Scene("kepler", &[("e", "0.9")], Periods(3.3)),
        200.0,
    ),
    entry("henon-heiles", Reference("henon_heiles_1_12"), 80.0)
        .quick()
        .extended(),
    entry(
        "pendulum",
        Scene("pendulum", &[("p", "1.5")], Time(50.0)),
        40.0,
    )
    .extended(),
    entry("double-pendulum", Reference("double_pendulum"), 20.0).quick(),
    entry("outer-solar-system", Reference("outer_ss"), 200.0),
    entry("fpu", Scene("fpu", &[], Time(20.0)), 600.0),
    entry(
        "fput-beta",
        Scene("fput-beta", &[("n", "64")], Time(50.0)),
        40.0,
    ),
    entry(
        "spring-pendulum",
        Scene("spring-pendulum", &[], Time(5.0)),
        200.0,
    ),
];

/// A scene with its end state in the float type of the runs.
#[derive(Debug)]
pub(super) struct Subject<T> {
    pub(super) name: &'static str,
    pub(super) title: String,
    pub(super) fewest: f64,
    pub(super) instance: Instance,
    /// (q, p) at the start.
    pub(super) start: Vec<T>,
    pub(super) end: T,
    reference: Vec<DoubleDouble>,
    /// Where the end state comes from, in words.
    pub(super) source: String,
}

impl<T: Float> Subject<T> {
    /// Builds the scene and finds its end state.
    ///
    /// # Errors
    /// If the scene cannot be built, or integrated where its end state is not known.
    pub(super) fn new(entry: &Entry) -> Result<Self, Fault> {
        let instance = match entry.source {
            Scene(name, values, _) => equip_scenes::find(name)?.instance(values)?,
            Reference(name) => Instance::from_reference(name)?,
        };
        let end = match entry.source {
            Scene(.., Periods(n)) => T::exact(n * instance.period::<f64>()),
            Scene(.., Time(t)) => T::exact(t),
            Reference(_) => instance.reference().map_or(T::NAN, |r| r.end()),
        };
        let (q, p) = instance.initial::<T>();
        let start = [q, p].concat();
        let (reference, source) = end_state(&instance, entry, &start, end)?;
        let parameters: Vec<_> = instance
            .parameters()
            .map(|(n, v)| format!("{} = {}, ", symbol(n), v.replace('-', "−")))
            .collect();
        let title = format!(
            "{}, {}t = {}",
            instance.scene().title,
            parameters.concat(),
            (1e3 * end.to_f64()).round() / 1e3
        );
        Ok(Subject {
            name: entry.name,
            title,
            fewest: entry.fewest,
            instance,
            start,
            end,
            reference,
            source,
        })
    }

    /// The largest difference from the end state in any component of q and p.
    pub(super) fn error(&self, y: &[T]) -> f64 {
        let far = |(&y, &r): (&T, &DoubleDouble)| (wide(y) - r).to_f64().abs();
        y.iter()
            .zip(&self.reference)
            .map(far)
            .fold(0.0, |a, b| if b <= a { a } else { b })
    }
}

fn wide<T: Float>(x: T) -> DoubleDouble {
    DoubleDouble::from_expansion(x.expansion())
}

fn end_state<T: Float>(
    instance: &Instance,
    entry: &Entry,
    start: &[T],
    end: T,
) -> Result<(Vec<DoubleDouble>, String), Fault> {
    let (q, p) = start.split_at(start.len() / 2);
    let all = |x: &[T]| x.iter().map(|&x| wide(x)).collect::<Vec<_>>();
    if let Some((q, p)) = instance.flow(&(all(q), all(p)), wide(end)) {
        return Ok(([q, p].concat(), "exact flow of the initial state".into()));
    }
    if let (Some(reference), Reference(_)) = (instance.reference(), entry.source) {
        let (q, p) = reference.state();
        return Ok((
            [q, p].concat(),
            format!("stored reference {}", reference.name()),
        ));
    }
    // Steps of half the length of the coarsest run's: errors of order 32 are far below round-off of f64.
    let computed = |steps: f64| {
        let h = wide(end) / DoubleDouble::exact(steps);
        let integrator = Gauss::stages(16).step(h).record(Record::Ends);
        let interval = DoubleDouble::int(0)..=wide(end);
        let run = integrator.integrate(instance.hamiltonian(), &all(q), &all(p), interval);
        run.map(|run| [run.last().1, run.last().2].concat())
            .map_err(|failure| Fault::start(failure.error))
    };
    let (coarse, fine) = (computed(2.0 * entry.fewest)?, computed(4.0 * entry.fewest)?);
    let far = |(&a, &b): (&DoubleDouble, &DoubleDouble)| (a - b).to_f64().abs();
    let off = coarse.iter().zip(&fine).map(far).fold(0.0, f64::max);
    Ok((
        fine,
        format!("Gauss(16) in double-double, error below {off:.0e}"),
    ))
}
