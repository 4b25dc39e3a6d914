//! The discrete problem on any triangulation: nodes, the couplings between them, and their parts of the boundary.
//!
//! The energy of a nodal vector y is half the sum of `weight (y_i - y_j)^2` over all couplings, less `<F, y>`: the
//! stiffness matrix (5) has `-weight` beside the diagonal, and rows that sum to zero; a reaction adds to the diagonal,
//! and half of the sum of `c mass y_i^2` to the energy. In (7)-(12) the part of the boundary at a node takes the place
//! of h.

use crate::machine::extremes::max_or_nan;
use crate::problem::law::{ContactNode, Law, LawSum};

/// Coupling of two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coupling {
    /// Numbers of the nodes.
    pub nodes: [u32; 2],
    /// Minus the entry of the stiffness matrix (5).
    pub weight: f64,
}

/// Discrete problem without its load vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// Position of the first coupling of each node in `others` and `weights`, and the number of all.
    starts: Vec<u32>,
    /// Coupled nodes, for each node in cyclic order from itself on: first those with higher numbers, then those with
    /// lower ones, both increasing. The order of additions is part of the method.
    others: Vec<u32>,
    /// Position of the first coupling of each node to one with a lower number.
    middles: Vec<u32>,
    /// Weights of the couplings.
    weights: Vec<f64>,
    /// Diagonal of the stiffness matrix.
    diagonal: Vec<f64>,
    /// Nodes with a law: first those in the order of a boundary vector, then those where y is given.
    boundary: Vec<ContactNode>,
    /// Number of the first ones.
    moving: usize,
    /// Position in `boundary` of each node, or [`INNER`].
    places: Vec<u32>,
    /// Integrals of the hat functions over the domain, the lumped mass matrix.
    masses: Vec<f64>,
    /// Factor of these in the diagonal.
    reaction: f64,
    /// Sum of j over the facets with the nodes at their values: not 0 where a facet has another value than its node.
    potential: f64,
}

/// Place of a node without a law, inside or on a free part of the boundary.
const INNER: u32 = u32::MAX;

/// Rows of a symmetric matrix without its diagonal, each coupling in two of them, in any order.
pub(crate) struct MatrixRows {
    /// Position of the first coupling of each row, and the number of all.
    starts: Vec<u32>,
    others: Vec<u32>,
    weights: Vec<f64>,
}

impl MatrixRows {
    /// No rows, with memory for so many rows and couplings.
    pub(crate) fn with_capacity(rows: usize, couplings: usize) -> Self {
        let mut starts = Vec::with_capacity(rows + 1);
        starts.push(0);
        let (others, weights) = (Vec::with_capacity(couplings), Vec::with_capacity(couplings));
        Self { starts, others, weights }
    }

    /// Adds the next row: the other nodes with the weights of the couplings.
    pub(crate) fn push(&mut self, row: impl Iterator<Item = (u32, f64)>) {
        for (other, weight) in row {
            self.others.push(other);
            self.weights.push(weight);
        }
        self.starts.push(self.others.len() as u32);
    }
}

/// Row of the stiffness matrix without its diagonal.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    /// Numbers of the coupled nodes.
    pub others: &'a [u32],
    /// Weights of the couplings.
    pub weights: &'a [f64],
}

/// Row of a node with a law during a sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactRow {
    /// Load plus the sum of weight times y over the coupled nodes.
    pub sum: f64,
    /// Diagonal entry of the stiffness matrix.
    pub diagonal: f64,
    /// Length or area of the boundary at the node.
    pub measure: f64,
    /// Law there.
    pub law: Law,
}

impl Row<'_> {
    /// Returns `start` plus the sum of weight times y over the coupled nodes, added from left to right.
    #[inline(always)]
    pub(crate) fn add_to(self, start: f64, y: &[f64]) -> f64 {
        let mut sum = start;
        for (&other, weight) in self.others.iter().zip(self.weights) {
            sum += weight * y[other as usize];
        }
        sum
    }
}

impl Network {
    /// Network of as many nodes as there are `masses`, with each coupling given once.
    ///
    /// # Panics
    /// If there are more couplings than 32 bits number, or a node does not exist.
    pub(crate) fn new(
        couplings: &[Coupling],
        boundary: Vec<ContactNode>,
        masses: Vec<f64>,
    ) -> Self {
        let nodes = masses.len();
        assert!(2 * couplings.len() < u32::MAX as usize, "more couplings than 32 bits number");
        let mut starts = vec![0; nodes + 1];
        // Number of couplings of each node to one with a higher number, which stand first in its row.
        let mut later = vec![0; nodes];
        for &Coupling { nodes: [one, two], .. } in couplings {
            starts[one as usize + 1] += 1;
            starts[two as usize + 1] += 1;
            later[one.min(two) as usize] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
            later[node] += starts[node];
        }
        let mut next = [starts.clone(), later];
        let (mut others, mut weights) =
            (vec![0; 2 * couplings.len()], vec![0.0; 2 * couplings.len()]);
        for &Coupling { nodes: [one, two], weight } in couplings {
            for (node, other) in [(one, two), (two, one)] {
                let place = &mut next[usize::from(other < node)][node as usize];
                others[*place as usize] = other;
                weights[*place as usize] = weight;
                *place += 1;
            }
        }
        Self::of_rows(MatrixRows { starts, others, weights }, boundary, masses)
    }

    /// Network with each coupling in the rows of both of its nodes.
    pub(crate) fn of_rows(
        MatrixRows { starts, mut others, mut weights }: MatrixRows,
        boundary: Vec<ContactNode>,
        masses: Vec<f64>,
    ) -> Self {
        let nodes = masses.len();
        let (mut diagonal, mut middles) = (vec![0.0; nodes], vec![0; nodes]);
        let mut row = Vec::new();
        for node in 0..nodes {
            let range = starts[node] as usize..starts[node + 1] as usize;
            let (others, weights) = (&mut others[range.clone()], &mut weights[range]);
            if !others.is_sorted_by_key(|&other| (other < node as u32, other)) {
                row.clear();
                row.extend(others.iter().copied().zip(weights.iter().copied()));
                row.sort_unstable_by_key(|&(other, _)| (other < node as u32, other));
                for ((other, weight), entry) in others.iter_mut().zip(&mut *weights).zip(&row) {
                    (*other, *weight) = *entry;
                }
            }
            diagonal[node] = weights.iter().sum();
            let later = others.iter().take_while(|other| **other > node as u32).count();
            middles[node] = starts[node] + later as u32;
        }
        let mut network = Self {
            starts,
            others,
            middles,
            weights,
            diagonal,
            boundary: Vec::new(),
            moving: 0,
            places: vec![INNER; nodes],
            masses,
            reaction: 0.0,
            potential: 0.0,
        };
        network.set_boundary(boundary);
        network
    }

    /// Network with this sum of j over the facets, the nodes at their values.
    pub(crate) fn with_potential(self, potential: f64) -> Self {
        Self { potential, ..self }
    }

    /// Sum of j over the facets with the nodes at their values, which the laws of the nodes lack.
    pub(crate) fn potential(&self) -> f64 {
        self.potential
    }

    /// Network whose diagonal entries have these numbers added: what the couplings to further nodes, at zero, add.
    pub(crate) fn with_additions(mut self, additions: &[f64]) -> Self {
        for (diagonal, addition) in self.diagonal.iter_mut().zip(additions) {
            *diagonal += addition;
        }
        self
    }

    /// Network with other numbers of the nodes; `places` has the new number of each.
    pub(crate) fn renumbered(&self, places: &[u32]) -> Self {
        let nodes = self.nodes();
        let mut old = vec![0; nodes];
        places.iter().zip(0..).for_each(|(&place, node)| old[place as usize] = node);
        let mut rows = MatrixRows::with_capacity(nodes, self.others.len());
        let (mut masses, mut additions) = (Vec::with_capacity(nodes), Vec::with_capacity(nodes));
        for &node in &old {
            let Row { others, weights } = self.row(node);
            let entries = others.iter().zip(weights);
            rows.push(entries.map(|(&other, &weight)| (places[other as usize], weight)));
            masses.push(self.masses[node]);
            additions.push(self.diagonal[node] - weights.iter().sum::<f64>());
        }
        let mut boundary = self.boundary.clone();
        boundary.iter_mut().for_each(|contact| contact.node = places[contact.node] as usize);
        boundary.sort_unstable_by_key(|contact| contact.node);
        let renumbered = Self::of_rows(rows, boundary, masses).with_additions(&additions);
        Self { reaction: self.reaction, ..renumbered }
    }

    /// Network with other laws of the nodes with a law, in their order.
    pub fn with_laws(&self, laws: &[Law]) -> Self {
        let mut network = self.clone();
        network.boundary.iter_mut().zip(laws).for_each(|(contact, law)| contact.law = *law);
        network
    }

    /// Replaces the nodes with a law.
    pub(super) fn set_boundary(&mut self, mut boundary: Vec<ContactNode>) {
        boundary.sort_by_key(|contact| !contact.law.may_move());
        self.places.fill(INNER);
        for (place, contact) in boundary.iter().enumerate() {
            self.places[contact.node] = place as u32;
        }
        self.moving = boundary.partition_point(|contact| contact.law.may_move());
        self.boundary = boundary;
    }

    /// Number of nodes, the length of a nodal vector.
    pub fn nodes(&self) -> usize {
        self.diagonal.len()
    }

    /// Number of couplings.
    pub fn couplings(&self) -> usize {
        self.others.len() / 2
    }

    /// Mean number of entries in a row of the stiffness matrix: the multiplications of a visit.
    pub fn row_length(&self) -> f64 {
        1.0 + self.others.len() as f64 / self.nodes() as f64
    }

    /// Number of the connected component of each node, from 0 on.
    pub fn components(&self) -> Vec<u32> {
        let mut components = vec![u32::MAX; self.nodes()];
        let (mut count, mut next) = (0, Vec::new());
        for start in 0..self.nodes() {
            if components[start] < u32::MAX {
                continue;
            }
            components[start] = count;
            next.push(start);
            while let Some(node) = next.pop() {
                for &other in self.row(node).others {
                    if components[other as usize] == u32::MAX {
                        components[other as usize] = count;
                        next.push(other as usize);
                    }
                }
            }
            count += 1;
        }
        components
    }

    /// Nodes with a law, those of a boundary vector first.
    pub fn boundary(&self) -> &[ContactNode] {
        &self.boundary
    }

    /// Contact nodes, whose law lets them slip, in the order of a boundary vector.
    pub fn contact(&self) -> &[ContactNode] {
        &self.boundary[..self.moving]
    }

    /// Nodes at which y is given.
    pub fn held(&self) -> &[ContactNode] {
        &self.boundary[self.moving..]
    }

    /// Laws of the contact nodes together.
    pub fn laws(&self) -> LawSum {
        let mut laws = LawSum::default();
        self.contact().iter().for_each(|contact| laws.add(contact.law, contact.measure));
        laws
    }

    /// Network whose matrix has the lumped mass matrix, times `weight`, added: a term c v of the equation.
    #[must_use]
    pub fn with_reaction(mut self, weight: f64) -> Self {
        if weight > 0.0 {
            for (diagonal, mass) in self.diagonal.iter_mut().zip(&self.masses) {
                *diagonal += weight * mass;
            }
            self.reaction += weight;
        }
        self
    }

    /// True if the matrix has a part of the lumped mass matrix.
    pub(crate) fn has_reaction(&self) -> bool {
        self.reaction > 0.0
    }

    /// Integral of c v for a nodal vector, the part of the load that the reaction takes; none without a reaction.
    pub fn reacted(&self, y: &[f64]) -> Option<f64> {
        self.has_reaction().then(|| {
            self.reaction * self.masses.iter().zip(y).map(|(mass, y)| mass * y).sum::<f64>()
        })
    }

    /// True for each connected component in which y is given at some nodes, or that has a reaction: it bears every
    /// load. `of_nodes` has the number of each node's component, from 0 on.
    pub(crate) fn held_components(&self, of_nodes: &[u32]) -> Vec<bool> {
        let mut are_held = vec![self.has_reaction(); count_components(of_nodes)];
        self.held().iter().for_each(|of| are_held[of_nodes[of.node] as usize] = true);
        are_held
    }

    /// Position of a node in [`Network::boundary`]; none inside and on a free part of the boundary.
    #[inline(always)]
    pub fn place(&self, node: usize) -> Option<usize> {
        let place = self.places[node];
        (place != INNER).then_some(place as usize)
    }

    /// A node with its law: a free one inside.
    pub fn at(&self, node: usize) -> ContactNode {
        let inner = ContactNode { node, measure: 0.0, law: Law::FREE };
        self.place(node).map_or(inner, |place| self.boundary[place])
    }

    /// Node of the boundary vector, with its place there; none elsewhere.
    #[inline(always)]
    pub fn contact_at(&self, node: usize) -> Option<(usize, ContactNode)> {
        let place = self.place(node).filter(|place| *place < self.moving)?;
        Some((place, self.boundary[place]))
    }

    /// Diagonal of the stiffness matrix.
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Integrals of the hat functions.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Row of a node.
    #[inline(always)]
    pub(crate) fn row(&self, node: usize) -> Row<'_> {
        self.part(self.starts[node], self.starts[node + 1])
    }

    /// Part of the row of a node with the nodes of higher numbers, which a sweep visits later.
    #[inline(always)]
    pub(crate) fn later(&self, node: usize) -> Row<'_> {
        self.part(self.starts[node], self.middles[node])
    }

    /// Part of the row of a node with the nodes of lower numbers.
    #[inline(always)]
    pub(crate) fn earlier(&self, node: usize) -> Row<'_> {
        self.part(self.middles[node], self.starts[node + 1])
    }

    #[inline(always)]
    fn part(&self, from: u32, to: u32) -> Row<'_> {
        let range = from as usize..to as usize;
        Row { others: &self.others[range.clone()], weights: &self.weights[range] }
    }

    /// One Gauss-Seidel sweep in the order of the nodes. Values at inner nodes solve their equation; `at_boundary`
    /// gives the value of the node with a law in this position from its row.
    #[inline(always)]
    pub(crate) fn sweep(
        &self,
        load: &[f64],
        y: &mut [f64],
        mut at_boundary: impl FnMut(usize, ContactRow) -> f64,
    ) {
        for node in 0..self.nodes() {
            let sum = self.row(node).add_to(load[node], y);
            let diagonal = self.diagonal[node];
            y[node] = match self.place(node) {
                None => sum / diagonal,
                Some(place) => {
                    let ContactNode { measure, law, .. } = self.boundary[place];
                    at_boundary(place, ContactRow { sum, diagonal, measure, law })
                }
            };
        }
    }

    /// Writes the gradient `A y - F` of the energy to `out`, all three nodal vectors.
    pub fn gradient(&self, y: &[f64], load: &[f64], out: &mut [f64]) {
        for (node, out) in out.iter_mut().enumerate() {
            *out = self.gradient_at(node, y, load);
        }
    }

    /// Component of the gradient at a node.
    #[inline(always)]
    pub fn gradient_at(&self, node: usize, y: &[f64], load: &[f64]) -> f64 {
        self.diagonal[node] * y[node] - self.row(node).add_to(load[node], y)
    }

    /// Natural residual of a vector whose gradient of the energy is known: the largest of `|A y - F|`, that of these
    /// laws of the nodes with a law.
    pub(crate) fn natural_residual(
        &self,
        laws: &[Law],
        y: &[f64],
        gradient: impl Fn(usize) -> f64,
    ) -> f64 {
        y.iter().enumerate().fold(0.0, |largest, (node, value)| {
            let ContactNode { measure, law, .. } = self.at(node);
            let law = self.place(node).and_then(|place| laws.get(place)).unwrap_or(&law);
            max_or_nan(largest, law.residual(*value, gradient(node), measure))
        })
    }

    /// Largest product of a value at which y sticks and the diagonal entry of its node.
    pub(crate) fn size_of_values(&self) -> f64 {
        let products = self.boundary.iter().map(|of| (self.diagonal[of.node] * of.law.at()).abs());
        products.fold(0.0, f64::max)
    }

    /// Largest product of a value and its diagonal entry.
    pub(crate) fn largest_product(&self, y: &[f64]) -> f64 {
        y.iter().zip(&self.diagonal).fold(0.0, |most, (y, d)| most.max((y * d).abs()))
    }

    /// Energy `1/2 <A y, y> - <F, y>`, without the law's term.
    pub fn energy(&self, y: &[f64], load: &[f64]) -> f64 {
        let mut energy = 0.0;
        for node in 0..self.nodes() {
            let flow = self.diagonal[node] * y[node] - self.row(node).add_to(0.0, y);
            energy += y[node] * (0.5 * flow - load[node]);
        }
        energy
    }
}

/// Number of connected components, given that of each node, as [`Network::components`] numbers them.
pub(crate) fn count_components(components: &[u32]) -> usize {
    components.iter().max().map_or(0, |last| *last as usize + 1)
}
