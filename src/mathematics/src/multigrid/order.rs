//! Orders of the nodes of a network: for memory, and for factors.

use crate::discrete::network::Network;

/// Most nodes of a network whose factors have a band.
const MOST_IN_BAND: usize = 64;

/// Returns the place of each node in an order in which coupled nodes are near each other: breadth first from a node
/// with few couplings in each connected component, reversed (Cuthill and McKee 1969; George 1971).
pub(crate) fn reverse_cuthill_mckee(network: &Network) -> Vec<u32> {
    let nodes = network.nodes();
    let degree = |node: u32| network.row(node as usize).others.len();
    let mut starts: Vec<u32> = (0..nodes as u32).collect();
    starts.sort_by_key(|&node| degree(node));
    let (mut order, mut seen) = (Vec::with_capacity(nodes), vec![false; nodes]);
    for start in starts {
        if seen[start as usize] {
            continue;
        }
        seen[start as usize] = true;
        order.push(start);
        let mut next = order.len() - 1;
        while next < order.len() {
            let before = order.len();
            for &other in network.row(order[next] as usize).others {
                if !seen[other as usize] {
                    seen[other as usize] = true;
                    order.push(other);
                }
            }
            order[before..].sort_by_key(|&node| degree(node));
            next += 1;
        }
    }
    let mut places = vec![0; nodes];
    for (place, node) in order.into_iter().rev().enumerate() {
        places[node as usize] = place as u32;
    }
    places
}

/// Returns the place of each node in an order that leaves few entries in factors: by minimum degree, with the upper
/// bound of the degrees of P. R. Amestoy, T. A. Davis and I. S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996) 886-905.
/// Small networks have the order of [`reverse_cuthill_mckee`].
///
/// A node that is eliminated becomes an element, which couples all nodes that were coupled to it, and takes in the
/// elements that it was in.
pub(crate) fn minimum_degree(network: &Network) -> Vec<u32> {
    let nodes = network.nodes();
    if nodes <= MOST_IN_BAND {
        return reverse_cuthill_mckee(network);
    }
    let mut graph = Elimination::new(network);
    let mut places = vec![0; nodes];
    for place in 0..nodes as u32 {
        let node = graph.queue.take_least();
        places[node as usize] = place;
        graph.eliminate(node);
    }
    places
}

/// Graph of the nodes that are left, and the elements.
struct Elimination {
    /// Nodes to which a node is coupled, but for those that share an element with it.
    nodes_of: Vec<Vec<u32>>,
    /// Elements in which a node is.
    elements_of: Vec<Vec<u32>>,
    /// Nodes of an element, by the number of its node; empty for others.
    in_element: Vec<Vec<u32>>,
    /// Element that has seen a node or an element last.
    seen: Vec<u32>,
    /// Number of nodes of an element that are not in the one that has seen it.
    outside: Vec<u32>,
    queue: DegreeQueue,
}

/// Number of no node.
const NONE: u32 = u32::MAX;

impl Elimination {
    fn new(network: &Network) -> Self {
        let nodes = network.nodes();
        let nodes_of: Vec<_> = (0..nodes).map(|node| network.row(node).others.to_vec()).collect();
        let mut queue = DegreeQueue::new(nodes);
        for node in (0..nodes).rev() {
            queue.put(node as u32, nodes_of[node].len());
        }
        Self {
            nodes_of,
            elements_of: vec![Vec::new(); nodes],
            in_element: vec![Vec::new(); nodes],
            seen: vec![NONE; nodes],
            outside: vec![0; nodes],
            queue,
        }
    }

    /// Makes an element of a node.
    fn eliminate(&mut self, node: u32) {
        let mut element = Vec::new();
        self.seen[node as usize] = node;
        let own = std::mem::take(&mut self.nodes_of[node as usize]);
        let absorbed = std::mem::take(&mut self.elements_of[node as usize]);
        let of_absorbed =
            absorbed.iter().flat_map(|&other| std::mem::take(&mut self.in_element[other as usize]));
        for other in own.into_iter().chain(of_absorbed) {
            if std::mem::replace(&mut self.seen[other as usize], node) != node {
                element.push(other);
            }
        }
        self.count_outside(node, &element);
        for &member in &element {
            let member = member as usize;
            let (seen, in_element) = (&self.seen, &self.in_element);
            self.nodes_of[member].retain(|&other| seen[other as usize] != node);
            self.elements_of[member].retain(|&other| !in_element[other as usize].is_empty());
            let outside: u32 =
                self.elements_of[member].iter().map(|&other| self.outside[other as usize]).sum();
            self.elements_of[member].push(node);
            let degree = self.nodes_of[member].len() + element.len() - 1 + outside as usize;
            self.queue.take(member as u32);
            self.queue.put(member as u32, degree);
        }
        self.in_element[node as usize] = element;
    }

    /// Counts the nodes outside a new element of all elements that share some with it, and takes in those without any.
    fn count_outside(&mut self, node: u32, element: &[u32]) {
        let mut met = Vec::new();
        for &member in element {
            for &other in &self.elements_of[member as usize] {
                let count = self.in_element[other as usize].len() as u32;
                if count == 0 {
                    continue;
                }
                let outside = &mut self.outside[other as usize];
                // Elements have the numbers of nodes that are gone: their marks are free.
                if std::mem::replace(&mut self.seen[other as usize], node) != node {
                    *outside = count;
                    met.push(other);
                }
                *outside -= 1;
            }
        }
        for other in met {
            if self.outside[other as usize] == 0 {
                self.in_element[other as usize].clear();
            }
        }
    }
}

/// Nodes by their degrees, in doubly linked lists.
struct DegreeQueue {
    /// First node of each degree.
    first: Vec<u32>,
    next: Vec<u32>,
    before: Vec<u32>,
    degree: Vec<u32>,
    /// No degree below has a node.
    least: usize,
}

impl DegreeQueue {
    fn new(nodes: usize) -> Self {
        Self {
            first: vec![NONE; nodes],
            next: vec![NONE; nodes],
            before: vec![NONE; nodes],
            degree: vec![0; nodes],
            least: 0,
        }
    }

    fn put(&mut self, node: u32, degree: usize) {
        let degree = degree.min(self.first.len() - 1);
        let next = std::mem::replace(&mut self.first[degree], node);
        (self.next[node as usize], self.before[node as usize]) = (next, NONE);
        if next != NONE {
            self.before[next as usize] = node;
        }
        self.degree[node as usize] = degree as u32;
        self.least = self.least.min(degree);
    }

    fn take(&mut self, node: u32) {
        let (before, next) = (self.before[node as usize], self.next[node as usize]);
        match before {
            NONE => self.first[self.degree[node as usize] as usize] = next,
            before => self.next[before as usize] = next,
        }
        if next != NONE {
            self.before[next as usize] = before;
        }
    }

    /// Takes a node of least degree.
    ///
    /// # Panics
    /// If there is none.
    fn take_least(&mut self) -> u32 {
        while self.first[self.least] == NONE {
            self.least += 1;
        }
        let node = self.first[self.least];
        self.take(node);
        node
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::grid::Grid;
    use crate::multigrid::direct::{Direct, FactorOrder};
    use crate::problem::law::Law;

    #[test]
    fn minimum_degree_is_an_order_with_fewer_entries_in_factors() {
        let network = Network::of_square(Grid::new(64).unwrap(), Law::SIGNORINI);
        let mut places = minimum_degree(&network);
        places.sort_unstable();
        assert!(places.iter().zip(0..).all(|(place, number)| *place == number));
        let [natural, least] = [FactorOrder::Natural, FactorOrder::MinimumDegree]
            .map(|order| Direct::new(&network, order).factor_work());
        assert!(5.0 * least < natural, "{least} {natural}");
    }
}
