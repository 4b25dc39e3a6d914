//! Loops compiled for the vector instructions that the processor has.

/// Does the work with the widest vectors that the processor has; the bits are the same with all of them.
///
/// Only what is inlined here is compiled for them: the closure, and what it calls, want `#[inline(always)]`.
#[inline(always)]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        // DQ extends F.
        if std::arch::is_x86_feature_detected!("avx512dq") && allowed(Vectors::Avx512) {
            // SAFETY: the processor has the features that the function is compiled for.
            return unsafe { avx512(work) };
        }
        if std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("fma")
            && allowed(Vectors::Avx2)
        {
            // SAFETY: as above.
            return unsafe { avx2(work) };
        }
    }
    work()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq")]
fn avx512<R>(work: impl FnOnce() -> R) -> R {
    work()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Kinds of vector instructions, each with those before it.
#[cfg(any(target_arch = "x86_64", test))]
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Vectors {
    #[cfg(test)]
    None,
    Avx2,
    Avx512,
}

/// Returns true: only tests forbid instructions.
#[cfg(all(target_arch = "x86_64", not(test)))]
#[inline(always)]
fn allowed(_: Vectors) -> bool {
    true
}

/// Returns true if [`with_each`] does not forbid these instructions.
#[cfg(test)]
fn allowed(vectors: Vectors) -> bool {
    MOST.get().is_none_or(|most| vectors <= most)
}

#[cfg(test)]
thread_local! {
    /// Most that [`vectorised`] may use in this thread; `None` stands for all that there is.
    static MOST: std::cell::Cell<Option<Vectors>> = const { std::cell::Cell::new(None) };
}

/// Numbers that are compared side by side: too many for the compiler to write out one by one, after which it would
/// gather those of several blocks in one vector.
pub(crate) const LANES: usize = 64;

/// The largest absolute value of many rows, NaN if a number is; kept in independent lanes so that it vectorises.
///
/// As integers the bits of absolute values have the order of the numbers, and those of NaN come last.
#[derive(Clone, Copy)]
pub(crate) struct Largest([i64; LANES]);

impl Default for Largest {
    fn default() -> Self {
        Self([0; LANES])
    }
}

impl Largest {
    /// Takes `factor` times each number into account.
    #[inline(always)]
    pub(crate) fn see(&mut self, factor: f64, x: &[f64]) {
        for block in x.chunks(LANES) {
            for (largest, value) in self.0.iter_mut().zip(block) {
                *largest = ((factor * value).abs().to_bits() as i64).max(*largest);
            }
        }
    }

    /// Takes a number into account.
    #[inline(always)]
    pub(crate) fn put(&mut self, value: f64) {
        self.0[0] = self.0[0].max(value.abs().to_bits() as i64);
    }

    /// The largest; 0 if there was no number.
    #[inline(always)]
    pub(crate) fn value(self) -> f64 {
        f64::from_bits(self.0.into_iter().fold(0, i64::max) as u64)
    }
}

/// The results of the same work without vector instructions and with each kind that the processor has, in one thread:
/// of what is inlined in the closure, and of each call of [`vectorised`] below it.
#[cfg(test)]
pub(crate) fn with_each<R: Send>(work: impl Fn() -> R + Sync) -> Vec<R> {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let with = |most: Vectors, work: &(dyn Fn() -> R + Sync)| {
        alone.install(|| {
            MOST.set(Some(most));
            work()
        })
    };
    let mut results = vec![with(Vectors::None, &work)];
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
        {
            // SAFETY: the processor has the features that the function is compiled for.
            results.push(with(Vectors::Avx2, &|| unsafe { avx2(&work) }));
        }
        if std::arch::is_x86_feature_detected!("avx512dq") {
            // SAFETY: as above.
            results.push(with(Vectors::Avx512, &|| unsafe { avx512(&work) }));
        }
    }
    results
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::grid::Grid;
    use crate::discrete::load::{Diagonal, LoadRule};
    use crate::levels::Problem;
    use crate::multigrid::{Goal, MultigridParams};
    use crate::problem::exact::Exact;
    use crate::problem::law::Law;
    use crate::problem::source::Source;
    use crate::saddle::batch::{LANES, Lanes, Order};
    use crate::saddle::{Engine, GradientMeasure, Method, Pair, RunStart};
    use crate::square::bounds::bounds;
    use crate::square::errors::errors;
    use crate::square::load::load;
    use crate::square::multigrid::solve_square;
    use std::fmt::Debug;

    /// Two arcs of contact and one, with straight jumps and with circles.
    const SOURCES: [&str; 3] = [
        "quadrant(ll)=3; else=-1.1",
        "disc(0.1,-0.2,0.3)=3; disc(-0.1,0.1,0.25)=-4; else=-1",
        "disc(-0.5,-0.5,0.4)=14; rect(0.2,0.5,0.2,0.5)=16; else=-5",
    ];

    fn sources() -> impl Iterator<Item = Source> {
        SOURCES.iter().map(|f| f.parse().expect("a valid f"))
    }

    /// Fails if vector instructions change a bit of what a computation gives; `{:?}` shows each number in full.
    #[track_caller]
    fn compare<T: Debug>(work: impl Fn() -> T + Sync) {
        let results = with_each(|| format!("{:?}", work()));
        let other = results.iter().find(|result| **result != results[0]);
        assert!(other.is_none(), "{} instead of {}", other.unwrap_or(&results[0]), results[0]);
    }

    fn waves(many: usize) -> Vec<f64> {
        (0..many).map(|k| libm::sin(12.9898 * k as f64)).collect()
    }

    #[test]
    fn each_kind_of_instructions_is_tried_by_itself() {
        let kinds = with_each(|| [Vectors::Avx2, Vectors::Avx512].map(allowed));
        let expected = [[false, false], [true, false], [true, true]];
        assert_eq!(kinds, expected[..kinds.len()]);
    }

    #[test]
    fn vector_instructions_change_no_bit_of_errors() {
        // Rows that are no multiple of the lanes.
        let grid = Grid::new(37).expect("fine enough");
        let y = waves(grid.nodes());
        Exact::ALL.iter().for_each(|&exact| compare(|| errors(grid, exact, &y)));
    }

    #[test]
    fn vector_instructions_change_no_bit_of_a_batch() {
        compare(|| {
            let grid = Grid::new(11).expect("fine enough");
            let f = sources().next().expect("one");
            let (load, start) =
                (load(grid, &f, LoadRule::Bilinear {}), Pair::zero((grid, Law::SIGNORINI)));
            let uzawa = Method::Uzawa { weight: 1.0, inner: 1e-5, loose: false };
            let mut lanes: Lanes = Lanes::new(grid, Law::SIGNORINI, Order::Lexicographic, 1.0);
            for lane in 0..LANES {
                let method = if lane % 2 == 0 { Method::ArrowHurwicz } else { uzawa };
                let r = 0.3 * (1 + lane * lane * lane) as f64;
                let run = RunStart { load: &load, method, r, pair: &start };
                lanes.enter(lane, &run);
            }
            let mut seen = Vec::new();
            for _ in 0..50 {
                lanes.sweep();
                let changes = lanes.dual_step([true; LANES]);
                seen.push((changes, GradientMeasure::ALL.map(|measure| lanes.worst(measure))));
            }
            (seen, (0..LANES).map(|lane| lanes.pair(lane).into_owned()).collect::<Vec<_>>())
        });
    }

    #[test]
    fn vector_instructions_change_no_bit_of_true_solutions() {
        for f in sources() {
            let grids = vec![Grid::new(2).expect("fine enough")];
            let problem = Problem::on_square(grids, f, LoadRule::default(), Law::SIGNORINI);
            let problem = problem.expect("a problem");
            compare(|| {
                let solution = problem.true_solution().expect("a solution");
                (solution.energy, solution.bracket, solution.contact, solution.checks)
            });
        }
    }

    #[test]
    fn vector_instructions_change_no_bit_of_multigrid_and_bounds() {
        const GOALS: [Goal; 3] = [Goal::DiscretisationError, Goal::Kkt(1e-8), Goal::RoundingFloor];
        let params = GOALS.map(|goal| MultigridParams { goal, ..MultigridParams::default() });
        let exact = LoadRule::Exact { diagonal: Diagonal::default() };
        for f in sources() {
            let grid = Grid::new(40).expect("fine enough");
            let load = load(grid, &f, exact);
            compare(|| {
                params
                    .each_ref()
                    .map(|params| solve_square(grid.cells(), Law::SIGNORINI, &load, params))
            });
            compare(|| bounds(grid, &f, Law::SIGNORINI, &waves(grid.nodes())));
        }
    }
}
