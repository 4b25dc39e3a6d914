//! The loop of the saddle-point methods, over the runs in the lanes of an engine.
//!
//! An engine holds the iterates of one run, or of several side by side, one per lane. [`run`] is the only loop over
//! iterations: it is Arrow-Hurwicz, and Uzawa's algorithm, whatever the engine. What ends a run besides its limit is in
//! the [`Goals`].

use super::Pair;
use super::method::Method;
use super::stopping::{GradientMeasure, RoundingFloor, SWEEPS_TO_FLOOR};
use crate::discrete::end::{End, Stop};
use std::array::from_fn;
use std::borrow::Cow;

/// Iterates of up to `K` runs, and the steps of the method on them.
pub(crate) trait Engine<const K: usize> {
    /// Minimises M(., a) of (7) over one component of y after the other, with the proximal term: (9)-(11), in every
    /// lane.
    fn sweep(&mut self);

    /// Replaces a by `P(a - r y)` (12) in these lanes; returns the largest change in each, NaN if a value is no longer
    /// finite.
    fn dual_step(&mut self, lanes: [bool; K]) -> [f64; K];

    /// Centres the proximal term at the present y.
    fn centre(&mut self, lane: usize);

    /// True in each lane that has a bound and where a measure is at most this bound at every node; NaN never is.
    fn within(&mut self, measure: GradientMeasure, bounds: [Option<f64>; K]) -> [bool; K];

    /// Largest value of a measure over all nodes in each lane, NaN if one is.
    fn worst(&mut self, measure: GradientMeasure) -> [f64; K];

    /// Rounding errors of the gradient at the present pair; not finite if a value is not.
    fn floor(&self, lane: usize) -> RoundingFloor;

    /// Present pair of a run.
    fn pair(&self, lane: usize) -> Cow<'_, Pair>;
}

/// Start of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunStart<'a> {
    /// Load vector F.
    pub load: &'a [f64],
    /// Method.
    pub method: Method,
    /// Duality parameter r > 0.
    pub r: f64,
    /// Pair from which the run starts.
    pub pair: &'a Pair,
}

/// State of a run in a lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunState {
    method: Method,
    /// Sweeps after which the run ends, at the earliest after the first.
    limit: usize,
    /// [Unit](crate::discrete::domain::DiscreteDomain::unit) of F.
    pub(super) load: f64,
    /// Bound on the gradient of the inner problem; `None` if one sweep is enough.
    inner: Option<f64>,
    /// Rounding errors of Uzawa's method.
    pub(super) floor: RoundingFloor,
    /// Steps of the multiplier done.
    pub iterations: usize,
    /// Sweeps done.
    pub sweeps: usize,
    /// Last change of the multiplier.
    pub delta_a: f64,
}

/// Conditions that end the runs in the lanes of an engine.
pub(crate) trait Goals<E, const K: usize> {
    /// Called after the sweeps over y, before the multiplier's step (12).
    fn before_step(&mut self, _engine: &mut E, _runs: &[Option<RunState>; K]) {}

    /// True in each lane whose run has reached its goal; asked after each sweep of the `runs` that have then taken the
    /// step (12).
    fn reached(&mut self, engine: &mut E, runs: [Option<&RunState>; K]) -> [bool; K];

    /// Takes the end of the run in a lane, and returns the run that enters this lane instead.
    fn ended(&mut self, engine: &mut E, lane: usize, end: End) -> Option<RunState>;
}

impl RunState {
    /// State before the first sweep of a run of a method that ends after `limit` sweeps, with the
    /// [unit](crate::discrete::domain::DiscreteDomain::unit) of its load.
    pub(crate) fn new(method: Method, load: f64, limit: usize) -> Self {
        Self {
            method,
            limit,
            load,
            inner: method.inner_bound(load),
            floor: RoundingFloor::default(),
            iterations: 0,
            sweeps: 0,
            delta_a: 0.0,
        }
    }

    fn has_diverged(&self) -> bool {
        self.delta_a.is_nan() || !self.floor.gradient.is_finite()
    }

    /// The method whose minimisations are as exact as is of use.
    fn method(&self) -> Method {
        self.method.above(self.floor.gradient)
    }

    /// The end of the run at its present state.
    pub(super) fn end(&self, stop: Stop) -> End {
        let &Self { iterations, sweeps, delta_a, .. } = self;
        End { iterations, work_units: sweeps as f64, stop, delta_a: Some(delta_a) }
    }
}

/// Iterates until all runs have ended, those that enter a lane later included.
pub(crate) fn run<const K: usize, E: Engine<K>>(
    engine: &mut E,
    mut runs: [Option<RunState>; K],
    goals: &mut impl Goals<E, K>,
) {
    while runs.iter().any(Option::is_some) {
        engine.sweep();
        let minimised = count_sweep(engine, &mut runs);
        goals.before_step(engine, &runs);
        take_step(engine, &mut runs, minimised);
        let asked = from_fn(|lane| {
            runs[lane].as_ref().filter(|run| minimised[lane] && !run.has_diverged())
        });
        let reached = goals.reached(engine, asked);
        for (lane, place) in runs.iter_mut().enumerate() {
            let Some(run) = place else { continue };
            let stop = if run.has_diverged() {
                Stop::Diverged
            } else if reached[lane] {
                Stop::Converged
            } else if run.sweeps >= run.limit {
                Stop::IterationLimit
            } else {
                continue;
            };
            *place = goals.ended(engine, lane, run.end(stop));
        }
    }
}

/// Counts a sweep, and returns the lanes where y is close enough to the minimiser of M(., a) for a step of the
/// multiplier.
fn count_sweep<const K: usize>(
    engine: &mut impl Engine<K>,
    runs: &mut [Option<RunState>; K],
) -> [bool; K] {
    let mut bounds = [None; K];
    for (lane, run) in runs.iter_mut().enumerate() {
        let Some(run) = run else { continue };
        run.sweeps += 1;
        if run.inner.is_some() && run.sweeps.is_multiple_of(SWEEPS_TO_FLOOR) {
            run.floor = engine.floor(lane);
        }
        bounds[lane] = run.inner.map(|bound| bound.max(run.floor.gradient));
    }
    let mut minimised = [false; K];
    if bounds.iter().any(Option::is_some) {
        minimised = engine.within(GradientMeasure::Inner, bounds);
    }
    from_fn(|lane| runs[lane].is_some() && (bounds[lane].is_none() || minimised[lane]))
}

/// Takes the step of the multiplier in some lanes, and relaxes the bounds of their inner problems if they are loose.
fn take_step<const K: usize>(
    engine: &mut impl Engine<K>,
    runs: &mut [Option<RunState>; K],
    lanes: [bool; K],
) {
    if lanes == [false; K] {
        return;
    }
    let (changes, mut gradients) = (engine.dual_step(lanes), None);
    for (lane, run) in runs.iter_mut().enumerate() {
        let Some(run) = run.as_mut().filter(|_| lanes[lane]) else { continue };
        run.iterations += 1;
        run.delta_a = changes[lane];
        if run.inner.is_none() {
            continue;
        }
        if matches!(run.method(), Method::Uzawa { loose: true, .. }) {
            let gradients = gradients.get_or_insert_with(|| engine.worst(GradientMeasure::Printed));
            run.inner = run.method().inner_bound(gradients[lane]);
        }
        if run.method.weight() > 0.0 {
            engine.centre(lane);
        }
    }
}

/// Bound of a measure that ends a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasureBound {
    /// Measure.
    pub(super) measure: GradientMeasure,
    /// Bound on it at every node.
    pub(super) bound: f64,
}

/// True in each lane that has a bound and is within it.
pub(super) fn within<const K: usize>(
    engine: &mut impl Engine<K>,
    bounds: [Option<MeasureBound>; K],
) -> [bool; K] {
    let mut within = [false; K];
    for measure in GradientMeasure::ALL {
        let of_measure = bounds.map(|of| of.filter(|of| of.measure == measure).map(|of| of.bound));
        if of_measure.iter().any(Option::is_some) {
            let lanes = engine.within(measure, of_measure);
            within = from_fn(|lane| within[lane] || lanes[lane]);
        }
    }
    within
}
