//! Aggregates: sets of strongly coupled nodes, each of which becomes one node of a coarser level.

use crate::discrete::network::Network;

/// Aggregates of a network.
pub(super) struct Aggregates {
    /// Number of the aggregate of each node; [`NONE`] at fixed nodes.
    pub(super) of_nodes: Vec<u32>,
    /// Number of aggregates.
    pub(super) count: usize,
}

/// Number of a node in no aggregate.
pub(super) const NONE: u32 = u32::MAX;

/// Couplings that count as strong: those whose weight exceeds a part of the geometric mean of the two diagonal entries.
pub(super) struct Strength<'a> {
    network: &'a Network,
    /// Roots of the diagonal times the root of the part.
    roots: Vec<f64>,
}

impl<'a> Strength<'a> {
    pub(super) fn new(network: &'a Network, part: f64) -> Self {
        let roots = network.diagonal().iter().map(|diagonal| (part * diagonal).sqrt()).collect();
        Self { network, roots }
    }

    /// Strong couplings of a node: the other nodes and the weights.
    #[inline(always)]
    pub(super) fn of(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let row = self.network.row(node);
        row.others.iter().zip(row.weights).filter_map(move |(&other, &weight)| {
            let other = other as usize;
            (weight > self.roots[node] * self.roots[other]).then_some((other, weight))
        })
    }
}

/// Nodes that may share an aggregate.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Inner,
    Contact,
    Fixed,
}

/// Aggregates in the making.
struct Builder<'a> {
    strength: &'a Strength<'a>,
    kinds: Vec<Kind>,
    of_nodes: Vec<u32>,
    count: u32,
}

/// Finds the aggregates of a network: first of contact nodes, then of inner nodes (P. Vanek, J. Mandel and M. Brezina,
/// Computing 56 (1996) 179-196, with nodes of one kind in an aggregate). A contact node without a strong coupling to
/// another one, as in a layer of thin cells, makes its aggregate with inner nodes. Fixed nodes are in none.
pub(super) fn aggregates(network: &Network, strength: &Strength<'_>) -> Aggregates {
    let kinds = (0..network.nodes()).map(|node| match network.at(node).law {
        law if law.is_free() => Kind::Inner,
        law if law.is_fixed() => Kind::Fixed,
        _ => Kind::Contact,
    });
    let mut builder = Builder {
        strength,
        kinds: kinds.collect(),
        of_nodes: vec![NONE; network.nodes()],
        count: 0,
    };
    let contact: Vec<usize> = network.contact().iter().map(|contact| contact.node).collect();
    builder.begin_layers(&contact);
    builder.aggregate(Kind::Contact, contact);
    let inner = (0..network.nodes()).filter(|&node| builder.kinds[node] == Kind::Inner).collect();
    builder.aggregate(Kind::Inner, inner);
    builder.numbered()
}

impl Builder<'_> {
    /// Other nodes of this kind with a strong coupling to a node, and the weights.
    fn strong(&self, node: usize, kind: Kind) -> impl Iterator<Item = (usize, f64)> {
        self.strength.of(node).filter(move |&(other, _)| self.kinds[other] == kind)
    }

    fn is_free(&self, node: usize) -> bool {
        self.of_nodes[node] == NONE
    }

    /// True if a node has strong couplings to nodes of a kind, and none of these nodes is in an aggregate.
    fn is_among_free(&self, node: usize, kind: Kind) -> bool {
        let mut count = 0;
        self.strong(node, kind).all(|(other, _)| {
            count += 1;
            self.is_free(other)
        }) && count > 0
    }

    /// Makes an aggregate of a node and its strongly coupled nodes of a kind that are in none.
    fn begin(&mut self, node: usize, kind: Kind) {
        let row: Vec<usize> = self.strong(node, kind).map(|(other, _)| other).collect();
        self.of_nodes[node] = self.count;
        for other in row {
            if self.is_free(other) {
                self.of_nodes[other] = self.count;
            }
        }
        self.count += 1;
    }

    /// Makes an aggregate of each contact node without a strong coupling to another one.
    fn begin_layers(&mut self, contact: &[usize]) {
        for &node in contact {
            if self.strong(node, Kind::Contact).next().is_none() {
                self.begin(node, Kind::Inner);
            }
        }
    }

    /// Aggregates all nodes of a kind.
    fn aggregate(&mut self, kind: Kind, mut nodes: Vec<usize>) {
        for &node in &nodes {
            if self.is_free(node) && self.is_among_free(node, kind) {
                self.begin(node, kind);
            }
        }
        nodes.retain(|&node| self.is_free(node));
        let joined: Vec<u32> = nodes.iter().map(|&node| self.strongest(node, kind)).collect();
        for (&node, aggregate) in nodes.iter().zip(joined) {
            self.of_nodes[node] = aggregate;
        }
        for node in nodes {
            if self.is_free(node) {
                self.begin(node, kind);
            }
        }
    }

    /// Aggregate of the node of this kind to which a node has the strongest coupling; [`NONE`] without one.
    fn strongest(&self, node: usize, kind: Kind) -> u32 {
        let mut best = (0.0, NONE);
        for (other, weight) in self.strong(node, kind) {
            if weight > best.0 && !self.is_free(other) {
                best = (weight, self.of_nodes[other]);
            }
        }
        best.1
    }

    /// Numbers the aggregates in the order of their first nodes, so that neighbours have near numbers.
    fn numbered(self) -> Aggregates {
        let Self { mut of_nodes, count, .. } = self;
        let (mut numbers, mut next) = (vec![NONE; count as usize], 0);
        for aggregate in of_nodes.iter_mut().filter(|aggregate| **aggregate != NONE) {
            let number = &mut numbers[*aggregate as usize];
            if *number == NONE {
                *number = next;
                next += 1;
            }
            *aggregate = *number;
        }
        Aggregates { of_nodes, count: count as usize }
    }
}
