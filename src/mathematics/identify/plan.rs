//! A request made ready, and the two ways of going through its space.

use super::evaluate::Evaluator;
use super::random::Random;
use super::rank::{Best, Found, Ranked, count_misfit_below, evaluate, explain};
use super::request::{Method, Part, Request};
use super::space::{Candidate, Geometry, Lattice, Space, decimals};
use super::variant::Order;
use super::{IdentifyError, Target};
use crate::discrete::load::LoadRule;
use crate::problem::source::Tie;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Candidates in one item of an enumeration.
const ITEM: u64 = 4096;
/// Items in one block: what is done for one depends on nothing outside its block, so that whole blocks
/// can be done by different machines.
pub(super) const BLOCK: u64 = 128;
/// Largest number of candidates that is surely counted without rounding.
const MOST: f64 = 9_007_199_254_740_992.0;

/// What the workers tell and are told while a batch is under way.
pub(super) struct Live<'a> {
    pub(super) stop: &'a AtomicBool,
    /// Set some time after `stop`, or when the time is over.
    pub(super) halt: &'a AtomicBool,
    /// Candidates tried.
    pub(super) tried: AtomicU64,
    /// Bits of the smallest objective; those of non-negative doubles are ordered like the doubles.
    pub(super) best: AtomicU64,
}

impl<'a> Live<'a> {
    /// Before a batch is begun that follows upon these candidates.
    pub(super) fn new(stop: &'a AtomicBool, halt: &'a AtomicBool, best: &Best) -> Self {
        let best = best.list().iter().map(|ranked| ranked.rank.1).fold(f64::INFINITY, f64::min);
        Self { stop, halt, tried: AtomicU64::new(0), best: AtomicU64::new(best.to_bits()) }
    }

    /// Counts candidates; whether to go on.
    fn go_on(&self, tried: u64) -> bool {
        self.tried.fetch_add(tried, Ordering::Relaxed);
        ![self.stop, self.halt].iter().any(|flag| flag.load(Ordering::Relaxed))
    }

    fn note(&self, Ranked { rank: (_, objective), .. }: &Ranked) {
        self.best.fetch_min(objective.to_bits(), Ordering::Relaxed);
    }
}

/// A request made ready.
pub(super) struct Plan<'a> {
    request: &'a Request,
    geometries: Vec<Geometry>,
    areas: Vec<Vec<f64>>,
    pub(super) evaluator: Evaluator<'a>,
    /// One per piece, all with the same number of places.
    lattices: Vec<Lattice>,
    per_geometry: u64,
    /// The items of this request's part.
    pub(super) items: Range<u64>,
    /// Whether transposing the square changes nothing but the picture.
    transposable: bool,
}

/// What one item found.
pub(super) struct Item {
    pub(super) best: Best,
    pub(super) tried: u64,
    pub(super) entered: Vec<u64>,
    /// Whether it was not cut short.
    pub(super) whole: bool,
}

impl<'a> Plan<'a> {
    pub(super) fn new(request: &'a Request, target: &'a Target) -> Result<Self, IdentifyError> {
        let geometries = request.space.geometries();
        let pieces = geometries[0].pieces();
        let places = request.values.iter().map(Lattice::places).max().unwrap_or(0);
        let lattices: Vec<Lattice> = match &request.values[..] {
            [one] => vec![one.refined(places); pieces],
            many if many.len() == pieces => many.iter().map(|l| l.refined(places)).collect(),
            many => {
                return Err(IdentifyError::ValueCount { lists: many.len(), pieces });
            }
        };
        let product: f64 = lattices.iter().map(|l| l.ticks().len() as f64).product();
        let count = product * geometries.len() as f64;
        let (per_geometry, items) = match request.method {
            Method::Enumerate if count > MOST => return Err(IdentifyError::TooMany),
            Method::Enumerate => (product as u64, (count as u64).div_ceil(ITEM)),
            Method::Anneal { chains, .. } => (0, chains),
        };
        // Chains know nothing of each other, so that any of them may go elsewhere.
        let block = if request.method == Method::Enumerate { BLOCK } else { 1 };
        let part = request.part.unwrap_or(Part { number: 1, of: 1 });
        // One from a file need not have been read as a text.
        if !(1..=part.of).contains(&part.number) {
            return Err(IdentifyError::Part(part.to_string()));
        }
        let share = part.share(items.div_ceil(block));
        let items = share.start * block..(share.end * block).min(items);
        let evaluator = Evaluator::new(target, &request.variant, &geometries)?;
        let variant = &request.variant;
        let even_ties = match variant.load {
            LoadRule::Nodal { tie, .. } => matches!(tie, Tie::LowerLeft | Tie::UpperRight),
            LoadRule::Exact { .. } | LoadRule::Bilinear {} | LoadRule::LumpedAverage {} => true,
        };
        Ok(Self {
            request,
            areas: geometries.iter().map(Geometry::areas).collect(),
            geometries,
            evaluator,
            lattices,
            per_geometry,
            items,
            transposable: even_ties
                && request.space == Space::Quadrants
                && variant.order == Order::Lexicographic
                && !matches!(variant.mirrored(), (true, false) | (false, true)),
        })
    }

    /// Does one item, in the light of what earlier batches found.
    pub(super) fn run(
        &self,
        item: u64,
        evaluator: &mut Evaluator<'a>,
        so_far: &Best,
        live: &Live<'_>,
    ) -> Item {
        let before = evaluator.entered().to_vec();
        // What the batches of this block before this one found is the same on every machine.
        let mut best = so_far.successor();
        let (tried, whole) = match self.request.method {
            Method::Enumerate => self.enumerate(item, evaluator, &mut best, live),
            Method::Anneal { steps, .. } => self.anneal(item, steps, evaluator, &mut best, live),
        };
        let entered = evaluator.entered().iter().zip(&before).map(|(now, before)| now - before);
        Item { best, tried, entered: entered.collect(), whole }
    }

    fn enumerate(
        &self,
        item: u64,
        evaluator: &mut Evaluator<'a>,
        best: &mut Best,
        live: &Live<'_>,
    ) -> (u64, bool) {
        let all = self.per_geometry * self.geometries.len() as u64;
        let exact = self.request.exact_grids;
        let (mut next, end) = (item * ITEM, ((item + 1) * ITEM).min(all));
        let (mut tried, mut candidates) = (0, Vec::new());
        while next < end {
            let geometry = (next / self.per_geometry) as usize;
            let last = end.min((geometry as u64 + 1) * self.per_geometry);
            let (numbers, values) = self.admitted(geometry, next..last);
            let values: Vec<_> = values.chunks_exact(self.lattices.len()).collect();
            let passed = evaluator.screened(geometry, &values, exact);
            tried += (numbers.len() - passed.len()) as u64;
            candidates.extend(passed.into_iter().map(|k| Candidate {
                geometry,
                ticks: self.ticks(numbers[k]).collect(),
                places: self.lattices[0].places(),
            }));
            next = last;
        }
        if !live.go_on(tried) {
            return (0, false);
        }
        let (more, whole) = self.run_each(candidates, evaluator, best, live);
        (tried + more, whole)
    }

    /// The candidates with these numbers, all of this geometry, that the request does not leave out, and the
    /// values of f of one after the other.
    fn admitted(&self, geometry: usize, numbers: Range<u64>) -> (Vec<u64>, Vec<f64>) {
        let (mut admitted, mut values, mut ticks) = (Vec::new(), Vec::new(), Vec::new());
        for number in numbers {
            ticks.clear();
            ticks.extend(self.ticks(number));
            if self.admits(geometry, &ticks) && !self.has_preferred_twin(&ticks) {
                admitted.push(number);
                values.extend(decimals(&ticks, self.lattices[0].places()));
            }
        }
        (admitted, values)
    }

    /// The values of a candidate, by its number.
    fn ticks(&self, number: u64) -> impl Iterator<Item = i64> {
        let mut rest = number % self.per_geometry;
        self.lattices.iter().map(move |lattice| {
            let ticks = lattice.ticks();
            let digit = rest % ticks.len() as u64;
            rest /= ticks.len() as u64;
            ticks[digit as usize]
        })
    }

    /// Runs candidates one after the other, each only as far as the best so far allow.
    fn run_each(
        &self,
        candidates: Vec<Candidate>,
        evaluator: &mut Evaluator<'a>,
        best: &mut Best,
        live: &Live<'_>,
    ) -> (u64, bool) {
        let mut tried = 0;
        for candidate in candidates {
            if !live.go_on(1) {
                return (tried, false);
            }
            tried += 1;
            if let Some(ranked) = evaluate(evaluator, candidate, best.misfit_limit()) {
                live.note(&ranked);
                best.offer(ranked);
            }
        }
        // The last candidate may have been given up.
        (tried, live.go_on(0))
    }

    /// One chain: moves of one or of all values, long ones first, accepted by Metropolis's rule.
    fn anneal(
        &self,
        chain: u64,
        steps: u64,
        evaluator: &mut Evaluator<'a>,
        best: &mut Best,
        live: &Live<'_>,
    ) -> (u64, bool) {
        let mut random = Random::new(self.request.seed, chain);
        let places = self.lattices[0].places();
        let sizes: Vec<usize> = self.lattices.iter().map(|l| l.ticks().len()).collect();
        let geometry = random.below(self.geometries.len());
        let mut at: Vec<usize> = sizes.iter().map(|&n| random.below(n)).collect();
        let build = |at: &[usize]| Candidate {
            geometry,
            ticks: at.iter().zip(&self.lattices).map(|(&i, l)| l.ticks()[i]).collect(),
            places,
        };
        let mut here = f64::INFINITY;
        for step in 0..steps {
            let cooling = 1.0 - step as f64 / steps as f64;
            // From half the lattice down to single points, and from misfits of cells to rounding.
            let temperature = 2.0 * cooling.powi(3) + 1e-3;
            let next = if step > 0 { moved(&at, &sizes, cooling, &mut random) } else { at.clone() };
            let candidate = build(&next);
            if !live.go_on(1) {
                return (step, false);
            }
            if !self.admits(geometry, &candidate.ticks) {
                continue;
            }
            // Metropolis's rule, turned round: the draw comes first, and bounds what is worth running.
            let bar = here - temperature * libm::log(random.unit());
            let bar = if here.is_finite() { bar } else { f64::MAX };
            if let Some(ranked) = evaluate(evaluator, candidate, count_misfit_below(bar)) {
                live.note(&ranked);
                let (_, objective) = ranked.rank;
                if objective <= bar {
                    (at, here) = (next, objective);
                }
                best.offer(ranked);
            }
        }
        (steps, live.go_on(0))
    }

    fn admits(&self, geometry: usize, ticks: &[i64]) -> bool {
        let terms = self.areas[geometry].iter().zip(ticks);
        let integral: f64 = terms.map(|(area, &tick)| area * tick as f64).sum();
        // Areas carry rounding errors; the integral of a candidate is a multiple of a block.
        !self.request.negative_integral || integral < -1e-6
    }

    /// Whether the mirror image in the diagonal, which has the same table, comes first.
    fn has_preferred_twin(&self, ticks: &[i64]) -> bool {
        self.transposable && self.lattices[1] == self.lattices[2] && ticks[2] < ticks[1]
    }

    /// Scores in full what was kept.
    pub(super) fn explain(mut self, best: &Best) -> Vec<Found> {
        let explained = |Ranked { candidate, .. }: &Ranked| {
            explain(&mut self.evaluator, &self.geometries[candidate.geometry], candidate)
        };
        best.list().iter().map(explained).collect()
    }
}

/// A point near this one, of a lattice with so many points along each axis; the nearer the less `cooling` is left.
fn moved(at: &[usize], sizes: &[usize], cooling: f64, random: &mut Random) -> Vec<usize> {
    // Moves shrink by a factor of a hundred; each spans a decade.
    let reach = 0.5 * libm::pow(0.1, random.unit() + 2.0 * (1.0 - cooling));
    let [p, q, kind] = [sizes.len(), sizes.len(), 4].map(|n| random.below(n));
    // Opposite moves leave the integral of f nearly alone, on which most depends.
    let moves = match kind {
        0 => vec![(p, reach)],
        1 => vec![(p, -reach)],
        2 => vec![(p, reach), (q, -reach)],
        _ => (0..sizes.len()).map(|p| (p, reach * (2.0 * random.unit() - 1.0))).collect(),
    };
    let mut next = at.to_vec();
    for (p, by) in moves {
        // A move too short for the lattice still goes to the next point.
        let by = (by * sizes[p] as f64).abs().max(1.0).round().copysign(by) as i64;
        next[p] = (next[p] as i64 + by).clamp(0, sizes[p] as i64 - 1) as usize;
    }
    next
}
