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
use serde::Serialize;
use std::borrow::Cow;

/// Iterations of the paper's method on a mesh of a domain; those of a limit are counted as such.
#[derive(Clone, Serialize)]
pub(super) struct MeshCount {
    /// Name of the domain.
    name: String,
    /// f, as text.
    f: String,
    /// Number of dimensions.
    dimension: u8,
    /// Duality parameter.
    r: f64,
    /// Number of the mesh among the nested ones, the coarsest the first.
    mesh: usize,
    /// Number of nodes.
    nodes: usize,
    /// Iterations under the signed rule, as in Tables 1 and 2.
    signed: usize,
    /// Iterations under the rule as printed.
    printed: usize,
    /// True if the former are fewer.
    is_earlier: bool,
    /// Last change of the multiplier under the signed rule, Delta a.
    delta_a: f64,
}

/// Order of the nodes on the refined meshes.
#[derive(Clone, Copy, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Numbering {
    /// Old nodes, then new ones in the order of their edges.
    Refinement,
    /// The reverse.
    Reversed,
    /// By y, then by x: rows as on the square.
    Rows,
    /// At random.
    Random,
}

/// Iterations on a mesh of the disc for one numbering, signed rule.
#[derive(Serialize)]
pub(super) struct NumberingCount {
    /// Order of the nodes.
    numbering: Numbering,
    /// Duality parameter.
    r: f64,
    /// Number of the mesh among the nested ones, the coarsest the first.
    mesh: usize,
    /// Iterations.
    iterations: usize,
}

/// Counts iterations on one domain.
pub(super) fn counted(domain: &DomainPlan, plan: &DomainsPlan) -> Result<Vec<MeshCount>, String> {
    let made = problem(domain, domain.first + plan.levels - 1)?;
    let Nested { networks, loads } = nested(&made)?;
    let (levels, loads) = (&networks[domain.first..], &loads[domain.first..]);
    let rules = [StopRule::Signed, StopRule::Printed];
    let runs = plan.r.iter().flat_map(|&r| rules.map(|rule| (r, rule)));
    let ends = ends(levels, &made, loads, runs, plan.max_iterations);
    let mut counts = Vec::new();
    for (&r, ends) in plan.r.iter().zip(ends.chunks(rules.len())) {
        for (k, (signed, printed)) in ends[0].iter().zip(&ends[1]).enumerate() {
            counts.push(MeshCount {
                name: domain.name.clone(),
                f: made.levels().facts().f.clone(),
                dimension: made.levels().facts().dimension,
                r,
                mesh: k + 1,
                nodes: levels[k].network.nodes(),
                signed: signed.iterations,
                printed: printed.iterations,
                is_earlier: signed.iterations < printed.iterations,
                delta_a: signed.change(),
            });
        }
    }
    Ok(counts)
}

/// Counts iterations on the disc for each numbering.
pub(super) fn numberings(plan: &DomainsPlan) -> Result<Vec<NumberingCount>, String> {
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
            let iterations = ends.iter().map(|end| end.iterations).enumerate();
            counts.extend(iterations.map(|(k, iterations)| NumberingCount {
                numbering,
                r,
                mesh: k + 1,
                iterations,
            }));
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
