//! Counts of iterations of the paper's method on nested meshes, and for other numberings of the nodes.

use super::{DomainPlan, DomainsPlan, problem};
use crate::discrete::domain::DiscreteDomain;
use crate::discrete::end::End;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::{Coupling, Network};
use crate::experiments::numbers::RandomNumbers;
use crate::levels::Problem;
use crate::problem::law::ContactNode;
use crate::saddle::jobs::{NestedJob, run_all_nested};
use crate::saddle::{NestedLevels, Pair, StopRule};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Counts on one domain.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CountedDomain {
    /// Name of the domain.
    pub name: String,
    /// f, as text.
    pub f: String,
    /// Number of dimensions.
    pub dimension: u8,
    /// Nodes of the nested meshes, coarsest first.
    pub nodes: Vec<usize>,
    /// Counts for each r.
    pub rows: Vec<CountsRow>,
}

/// Counts for one r, on each mesh; those of a limit are counted as such.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CountsRow {
    /// Duality parameter.
    pub r: f64,
    /// Iterations under the signed rule, as in Tables 1 and 2.
    pub signed: Vec<usize>,
    /// Iterations under the rule as printed.
    pub printed: Vec<usize>,
    /// Change of the multiplier at the last stop under the signed rule, Delta a.
    pub delta_a: f64,
}

/// Order of the nodes on the refined meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Numbering {
    /// Old nodes, then new ones in the order of their edges.
    Refinement,
    /// The reverse.
    Reversed,
    /// By y, then by x: rows as on the square.
    Rows,
    /// At random.
    Random,
}

/// Counts on the disc for one numbering, signed rule.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NumberingCounts {
    /// Order of the nodes.
    pub numbering: Numbering,
    /// Duality parameter.
    pub r: f64,
    /// Iterations on each mesh.
    pub counts: Vec<usize>,
}

/// Comparisons of counts on the finest meshes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CountsSummary {
    /// Number of pairs of a domain and an r.
    pub rows: usize,
    /// Number of these with fewer iterations under the signed rule than under the printed one.
    pub earlier: usize,
    /// Least change of the multiplier at the stop of the signed rule.
    pub least_delta_a: f64,
    /// Greatest ratio, less 1, between the counts of one domain under the printed rule for r from 10 on.
    pub printed_spread: f64,
    /// Greatest ratio between the counts of two numberings for the same r.
    pub numbering_factor: f64,
}

/// Least r from which on the method is near the projection.
const LARGE: f64 = 10.0;

impl CountsSummary {
    pub(super) fn of(counts: &[CountedDomain], numberings: &[NumberingCounts]) -> Self {
        let rows: Vec<_> = counts.iter().flat_map(|domain| &domain.rows).collect();
        let spread = |domain: &CountedDomain| {
            let rows = domain.rows.iter().filter(|row| row.r >= LARGE);
            ratio(rows.filter_map(|row| row.printed.last()))
        };
        let of_r = |r: f64| {
            ratio(numberings.iter().filter(|of| of.r == r).filter_map(|of| of.counts.last()))
        };
        Self {
            rows: rows.len(),
            earlier: rows.iter().filter(|row| row.signed.last() < row.printed.last()).count(),
            least_delta_a: rows.iter().fold(f64::INFINITY, |least, row| row.delta_a.min(least)),
            printed_spread: counts.iter().map(spread).fold(1.0, f64::max) - 1.0,
            numbering_factor: numberings.iter().map(|of| of_r(of.r)).fold(1.0, f64::max),
        }
    }
}

/// Greatest of some counts over the least.
fn ratio<'a>(counts: impl Iterator<Item = &'a usize>) -> f64 {
    let counts: Vec<f64> = counts.map(|&count| count as f64).collect();
    let (least, most) =
        counts.iter().fold((f64::INFINITY, 1.0f64), |(l, m), &c| (c.min(l), c.max(m)));
    if least.is_finite() { most / least } else { 1.0 }
}

/// Counts iterations on one domain.
pub(super) fn counted(domain: &DomainPlan, plan: &DomainsPlan) -> Result<CountedDomain, String> {
    let made = problem(domain, domain.first + plan.levels - 1)?;
    let Nested { networks, loads } = nested(&made)?;
    let (levels, loads) = (&networks[domain.first..], &loads[domain.first..]);
    let rules = [StopRule::Signed, StopRule::Printed];
    let runs = plan.r.iter().flat_map(|&r| rules.map(|rule| (r, rule)));
    let ends = ends(levels, &made, loads, runs, plan.max_iterations);
    let mut rows = Vec::new();
    for (&r, ends) in plan.r.iter().zip(ends.chunks(rules.len())) {
        let [signed, printed] = [0, 1].map(|rule: usize| iterations(&ends[rule]));
        let delta_a = ends[0].last().map_or(0.0, End::change);
        rows.push(CountsRow { r, signed, printed, delta_a });
    }
    Ok(CountedDomain {
        name: domain.name.clone(),
        f: made.levels().facts().f.clone(),
        dimension: made.levels().facts().dimension,
        nodes: levels.iter().map(|level| level.network.nodes()).collect(),
        rows,
    })
}

/// Counts iterations on the disc for each numbering.
pub(super) fn numberings(plan: &DomainsPlan) -> Result<Vec<NumberingCounts>, String> {
    let Some(disc) = plan.domains.iter().find(|domain| domain.name == "disc") else {
        return Ok(Vec::new());
    };
    let made = problem(disc, disc.first + plan.levels - 1)?;
    let Nested { networks, loads } = nested(&made)?;
    let mut counts = Vec::new();
    for numbering in
        [Numbering::Refinement, Numbering::Reversed, Numbering::Rows, Numbering::Random]
    {
        let levels = RenumberedNetworks::new(networks, orders(&made, numbering)?);
        let loads: Vec<_> =
            loads.iter().zip(&levels.orders).map(|(load, places)| moved(load, places)).collect();
        let runs = plan.numbered_r.iter().map(|&r| (r, StopRule::Signed));
        let ends = ends(&levels, &made, &loads, runs, plan.max_iterations);
        for (&r, ends) in plan.numbered_r.iter().zip(&ends) {
            counts.push(NumberingCounts { numbering, r, counts: iterations(ends) });
        }
    }
    Ok(counts)
}

/// Ends of the paper's method on all levels, side by side for each r and rule.
fn ends<L: NestedLevels + ?Sized>(
    levels: &L,
    problem: &Problem,
    loads: &[Vec<f64>],
    runs: impl Iterator<Item = (f64, StopRule)>,
    limit: usize,
) -> Vec<Vec<End>> {
    let law = problem.law();
    let runs: Vec<_> = runs.map(|(r, rule)| NestedJob { law, loads, r, rule }).collect();
    let ended = run_all_nested(levels, &runs, |_, _| limit);
    ended.iter().map(|levels| levels.iter().map(|(end, _)| *end).collect()).collect()
}

/// Iterations on each level.
fn iterations(ends: &[End]) -> Vec<usize> {
    ends.iter().map(|end| end.iterations).collect()
}

/// Nested discrete problems of a mesh, with their load vectors.
pub(in crate::experiments) struct Nested<'a> {
    /// Discrete problems, coarsest first.
    pub(in crate::experiments) networks: &'a [NestedNetwork],
    /// Load vectors.
    pub(in crate::experiments) loads: Vec<Vec<f64>>,
}

/// Nested discrete problems of a problem on a mesh.
pub(in crate::experiments) fn nested(problem: &Problem) -> Result<Nested<'_>, String> {
    let loads = problem.loads().map_err(|e| e.to_string())?;
    let networks = problem.networks().ok_or("the experiment is for meshes")?;
    Ok(Nested { networks, loads: loads.into_iter().map(Cow::into_owned).collect() })
}

/// Place of each node on each level.
fn orders(problem: &Problem, numbering: Numbering) -> Result<Vec<Vec<u32>>, String> {
    let finest = problem.levels().mesh(problem.finest());
    let mesh = finest.plane().ok_or("the disc lies in the plane")?;
    let of_level = |level: &NestedNetwork| {
        let nodes = level.network.nodes();
        let mut order: Vec<u32> = (0..nodes as u32).collect();
        match numbering {
            Numbering::Refinement => {}
            Numbering::Reversed => order.reverse(),
            // The first nodes of the finest mesh are those of each coarser one.
            Numbering::Rows => order.sort_by(|&a, &b| {
                let [[ax, ay], [bx, by]] = [a, b].map(|node| mesh.points()[node as usize]);
                ay.total_cmp(&by).then(ax.total_cmp(&bx))
            }),
            Numbering::Random => {
                let mut random = RandomNumbers::new(1, nodes as u64);
                for last in (1..nodes).rev() {
                    order.swap(last, (random.unit() * (last + 1) as f64) as usize);
                }
            }
        }
        let mut places = vec![0; nodes];
        order.iter().enumerate().for_each(|(place, &node)| places[node as usize] = place as u32);
        places
    };
    Ok(problem.networks().unwrap_or_default().iter().map(of_level).collect())
}

/// Nested networks whose nodes are renumbered, with interpolation between the nodes as they were.
struct RenumberedNetworks<'a> {
    levels: &'a [NestedNetwork],
    /// Place of each node on each level.
    orders: Vec<Vec<u32>>,
    /// Networks with each node at its place.
    networks: Vec<Network>,
}

impl<'a> RenumberedNetworks<'a> {
    fn new(levels: &'a [NestedNetwork], orders: Vec<Vec<u32>>) -> Self {
        let networks = levels.iter().zip(&orders);
        let networks = networks.map(|(level, places)| renumbered(&level.network, places)).collect();
        Self { levels, orders, networks }
    }
}

impl NestedLevels for RenumberedNetworks<'_> {
    fn count(&self) -> usize {
        self.levels.len()
    }

    fn domain(&self, k: usize) -> DiscreteDomain<'_> {
        (&self.networks[k]).into()
    }

    fn interpolated(&self, k: usize, Pair { y, a }: &Pair) -> Pair {
        let y = self.orders[k - 1].iter().map(|&place| y[place as usize]).collect();
        let pair = self.levels.interpolated(k, &Pair { y, a: a.clone() });
        Pair { y: moved(&pair.y, &self.orders[k]), ..pair }
    }
}

/// Network with each node at its place; contact nodes stay in their order.
fn renumbered(network: &Network, places: &[u32]) -> Network {
    let mut couplings = Vec::with_capacity(network.couplings());
    for node in 0..network.nodes() {
        let later = network.later(node);
        for (&other, &weight) in later.others.iter().zip(later.weights) {
            couplings.push(Coupling { nodes: [places[node], places[other as usize]], weight });
        }
    }
    let contact = network.contact().iter();
    let contact = contact.map(|contact| ContactNode {
        node: places[contact.node] as usize,
        measure: contact.measure,
    });
    let fixed = network.fixed().iter().map(|&node| places[node as usize]);
    Network::new(&couplings, contact.collect(), fixed.collect(), moved(network.masses(), places))
}

/// Nodal vector with each value at the place of its node.
fn moved(values: &[f64], places: &[u32]) -> Vec<f64> {
    let mut moved = vec![0.0; values.len()];
    values.iter().zip(places).for_each(|(value, &place)| moved[place as usize] = *value);
    moved
}
