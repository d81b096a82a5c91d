//! Output between the points of a grid.

use crate::dense::piece::Piece;
use crate::runs::run::Run;
use crate::steppers::integration::Integration;
use equip_scalar::Float;
use equip_solver::Part;

/// States at chosen times, each by one step of the same method from the last grid point. If such a step
/// fails, the state comes from the polynomial of the stages of the following step of the run.
#[derive(Debug)]
pub(crate) struct Outputs<'a, T: Float> {
    stepper: Integration<T>,
    times: &'a [T],
    done: usize,
}

impl<'a, T: Float> Outputs<'a, T> {
    /// The extra steps are made by `stepper`.
    pub(crate) fn new(stepper: Integration<T>, times: &'a [T]) -> Self {
        Outputs {
            stepper,
            times,
            done: 0,
        }
    }

    /// Called if the run continues from another state within the step: the outputs beyond it are recomputed.
    pub(crate) fn rewind(&mut self, run: &Run<T>) {
        self.done = run.output_times.len();
    }

    /// Computes the outputs before `end`, or all remaining ones, from the present state of `main`, up to the
    /// first one whose step fails.
    pub(crate) fn up_to(&mut self, main: &Integration<T>, end: Option<T>, run: &mut Run<T>) {
        let is_due = |time: T| end.is_none_or(|end| main.direction.is_before(time, end));
        while let Some(&time) = self.times.get(self.done).filter(|&&time| is_due(time)) {
            let h = time - main.time;
            if main.direction.is_before(main.time, time) {
                self.stepper.core.forget();
                let side = &mut self.stepper;
                match side.aside((&main.y, main.time), h) {
                    Ok(y) => {
                        run.output(time, y);
                        run.certificate.output_steps += 1;
                    }
                    // The output is at the end of the run, up to rounding.
                    Err(_) if end.is_none() => run.output(time, &main.y.hi),
                    Err(_) => return,
                }
            } else {
                run.output(time, &main.y.hi);
            }
            self.done += 1;
        }
    }

    /// Computes the outputs within the last step of `main` whose separate steps failed.
    pub(crate) fn within(&mut self, main: &Integration<T>, run: &mut Run<T>) {
        let is_due = |time: T| main.direction.is_before(time, main.time);
        let mut y = Vec::new();
        let mut is_counted = false;
        while let Some(&time) = self.times.get(self.done).filter(|&&time| is_due(time)) {
            let parts = main.parts();
            let is_behind = |part: &Part<T>| !main.direction.is_before(time, part.time);
            let i = parts.partition_point(is_behind).saturating_sub(1);
            let Some(part) = parts.get(i) else {
                return;
            };
            let end = parts.get(i + 1).map_or(&main.y, |next| &next.start);
            let piece = Piece::of_stages(main.core.method(), part, T::int(0), end);
            y.resize(2 * main.m, T::int(0));
            piece.state_at(piece.place_of(time), &mut y);
            run.output(time, &y);
            run.certificate.coarse_outputs += u64::from(!is_counted);
            is_counted = true;
            self.done += 1;
        }
    }
}
