//! Levels of the run, those of aggregates and the meshes above them, with the problems on them and their components.

use super::interpolation::Interpolation;
use super::smoothed::{CoarseLevel, MOST_DIRECT, coarse_levels};
use crate::discrete::domain::components;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::Network;
use crate::multigrid::order::reverse_cuthill_mckee;
use crate::multigrid::{InputError, check_load};
use crate::problem::law::{ContactNode, Law, OneSided};
use std::borrow::Cow;

/// Discrete problem with the interpolation from the next coarser one.
pub(super) struct NetworkLevel<'a> {
    pub(super) network: Cow<'a, Network>,
    /// None on the coarsest level.
    pub(super) interpolation: Option<Interpolation<'a>>,
    /// Node of the next coarser level whose aggregate has each contact node, in the order of the network; empty if that
    /// level is a mesh.
    of_contact: Vec<u32>,
}

/// Levels, coarsest first.
pub(super) struct NetworkLevels<'a> {
    pub(super) levels: Vec<NetworkLevel<'a>>,
    /// Number of the coarsest mesh: the number of levels of aggregates.
    pub(super) coarsest_mesh: usize,
    /// Number on the finest level of each node of the finest mesh, if it is another one.
    places: Option<Vec<u32>>,
}

impl<'a> NetworkLevels<'a> {
    /// Levels of nested meshes, and below them levels of aggregates until factors are cheap.
    ///
    /// In aggregates of the coarsest mesh couplings above the part `strong` of the diagonal are strong. A single mesh
    /// is renumbered, so that neighbours lie near each other in memory. Refined meshes are in a good order already.
    pub(super) fn new(meshes: &'a [NestedNetwork], strong: f64) -> Self {
        let first = &meshes[0].network;
        let is_renumbered = meshes.len() == 1 && first.nodes() > MOST_DIRECT;
        let places = is_renumbered.then(|| reverse_cuthill_mckee(first));
        let network = match &places {
            Some(places) => Cow::Owned(first.renumbered(places)),
            None => Cow::Borrowed(first),
        };
        let coarse = coarse_levels(&network, strong);
        let coarsest_mesh = coarse.len();
        let mut levels = Vec::with_capacity(coarsest_mesh + meshes.len());
        let mut finer = NetworkLevel { network, interpolation: None, of_contact: Vec::new() };
        for CoarseLevel { network, rows, of_contact } in coarse {
            finer.interpolation = Some(Interpolation::Weighted(rows));
            finer.of_contact = of_contact;
            let network = Cow::Owned(network);
            let coarser = NetworkLevel { network, interpolation: None, of_contact: Vec::new() };
            levels.push(std::mem::replace(&mut finer, coarser));
        }
        levels.push(finer);
        levels.reverse();
        levels.extend(meshes[1..].iter().map(|mesh| NetworkLevel {
            network: Cow::Borrowed(&mesh.network),
            interpolation: Some(Interpolation::Midpoints(mesh)),
            of_contact: Vec::new(),
        }));
        Self { levels, coarsest_mesh, places }
    }

    /// Number of the finest level.
    pub(super) fn finest(&self) -> usize {
        self.levels.len() - 1
    }

    /// Network of a level.
    pub(super) fn network(&self, level: usize) -> &Network {
        &self.levels[level].network
    }

    /// A nodal vector of the finest mesh in the numbers of the finest level.
    pub(super) fn renumbered<'v>(&self, vector: &'v [f64]) -> Cow<'v, [f64]> {
        let Some(places) = &self.places else { return vector.into() };
        let mut moved = vec![0.0; vector.len()];
        for (&place, value) in places.iter().zip(vector) {
            moved[place as usize] = *value;
        }
        moved.into()
    }

    /// A nodal vector of the finest level in the numbers of the finest mesh.
    pub(super) fn in_order_of_mesh(&self, vector: Vec<f64>) -> Vec<f64> {
        match &self.places {
            Some(places) => places.iter().map(|&place| vector[place as usize]).collect(),
            None => vector,
        }
    }

    /// Nodal vector of a level interpolated from the next coarser one.
    pub(super) fn interpolate(&self, level: usize, coarse: &[f64]) -> Vec<f64> {
        self.interpolation(level).interpolate(coarse)
    }

    fn interpolation(&self, level: usize) -> &Interpolation<'a> {
        self.levels[level].interpolation.as_ref().expect("a level finer than the coarsest")
    }

    /// Load vectors of all levels, coarsest first, that belong to one of the finest. `values` has the one of the
    /// coarsest mesh that is zero but at nodes where y is given: aggregates do not have these.
    pub(super) fn restricted(&self, finest: Vec<f64>, values: &[f64]) -> Vec<Vec<f64>> {
        let mut loads = vec![finest];
        for level in (1..self.levels.len()).rev() {
            let coarse_nodes = self.network(level - 1).nodes();
            let load = &loads[loads.len() - 1];
            let of_others = (level == self.coarsest_mesh && values.iter().any(|v| *v != 0.0))
                .then(|| self.without_values(load, values));
            let load = of_others.as_ref().unwrap_or(load);
            loads.push(self.interpolation(level).restrict(load, coarse_nodes));
        }
        loads.reverse();
        loads
    }

    /// Load of the coarsest mesh less the products of the matrix with these values.
    fn without_values(&self, load: &[f64], values: &[f64]) -> Vec<f64> {
        let mut left = vec![0.0; load.len()];
        self.network(self.coarsest_mesh).gradient(values, load, &mut left);
        left.iter_mut().for_each(|value| *value = -*value);
        left
    }

    /// Number of the connected component of each node of the finest level, and those of the contact nodes of each
    /// level.
    pub(super) fn components(&self) -> (Vec<u32>, Vec<Vec<u32>>) {
        let mesh = self.network(self.coarsest_mesh).components();
        let mut of_contact = Vec::with_capacity(self.levels.len());
        let mut of_nodes = mesh.clone();
        for level in (0..=self.coarsest_mesh).rev() {
            of_contact.push(of_contact_nodes(self.network(level), &of_nodes));
            if level > 0 {
                let mut coarse = vec![0; self.network(level - 1).nodes()];
                for (node, &component) in of_nodes.iter().enumerate() {
                    self.interpolation(level)
                        .for_each(node, |parent, _| coarse[parent] = component);
                }
                of_nodes = coarse;
            }
        }
        of_contact.reverse();
        let mut of_nodes = mesh;
        for level in self.coarsest_mesh + 1..self.levels.len() {
            for node in of_nodes.len()..self.network(level).nodes() {
                let mut own = 0;
                self.interpolation(level).for_each(node, |parent, _| own = of_nodes[parent]);
                of_nodes.push(own);
            }
            of_contact.push(of_contact_nodes(self.network(level), &of_nodes));
        }
        (of_nodes, of_contact)
    }

    /// Writes which nodes of the next coarser level are held if these are: on a mesh the same nodes, of aggregates
    /// those whose contact nodes all are.
    pub(super) fn hold_coarser(&self, level: usize, held: &[bool], coarse: &mut [bool]) {
        if level > self.coarsest_mesh {
            coarse.copy_from_slice(&held[..coarse.len()]);
            return;
        }
        let fine = self.network(level);
        let coarser = self.network(level - 1);
        coarse.fill(false);
        coarser.contact().iter().for_each(|contact| coarse[contact.node] = true);
        for (contact, &aggregate) in fine.contact().iter().zip(&self.levels[level].of_contact) {
            coarse[aggregate as usize] &= held[contact.node];
        }
    }
}

fn of_contact_nodes(network: &Network, of_nodes: &[u32]) -> Vec<u32> {
    network.contact().iter().map(|contact| of_nodes[contact.node]).collect()
}

/// Nested problems under laws `[0, limit]` and `(-inf, 0]`.
pub(super) struct NestedProblem<'a> {
    pub(super) levels: NetworkLevels<'a>,
    /// Scaled load of each level.
    pub(super) loads: Vec<Vec<f64>>,
    pub(super) components: Components,
    /// Factor by which load and values were divided.
    pub(super) scale: f64,
    /// Way from the problem as given to this one.
    pub(super) one_sided: OneSided,
}

impl NestedProblem<'_> {
    pub(super) fn finest(&self) -> usize {
        self.levels.finest()
    }

    /// Laws of the nodes with a law of a level, with their limits or without, divided as the load.
    pub(super) fn laws(&self, has_limits: bool, level: usize) -> Result<Vec<Law>, InputError> {
        let [finest, network] = [self.finest(), level].map(|level| self.levels.network(level));
        // On curved boundaries the coarser polygons are shorter: their flux has to balance the same load.
        let longer = finest.laws().measure / network.laws().measure;
        let of_node = |contact: &ContactNode| {
            let law = self.one_sided.law(contact.law);
            let at = law.at() / self.scale;
            if law.is_fixed() {
                return Ok(law.scaled_at(at));
            }
            let hi = match has_limits || !law.lo().is_finite() {
                true => law.hi() / self.scale * longer,
                false => f64::INFINITY,
            };
            Ok(Law::new(law.lo(), hi)?.scaled_at(at))
        };
        network.boundary().iter().map(of_node).collect()
    }
}

/// Connected components of nested networks.
pub(super) struct Components {
    /// True for each component that bears every load; see [`Network::held_components`].
    pub(super) is_held: Vec<bool>,
    /// Component of each contact node, for each level.
    pub(super) of_contact: Vec<Vec<u32>>,
    /// Component of each node of the finest level.
    of_nodes: Vec<u32>,
}

impl Components {
    /// Finds the components, and checks the load on the finest level.
    pub(super) fn of(levels: &NetworkLevels<'_>, load: &[f64]) -> Result<Self, InputError> {
        let (of_nodes, of_contact) = levels.components();
        let found = components(levels.network(levels.finest()), &of_nodes, load);
        check_load(&found)?;
        let is_held = levels.network(levels.finest()).held_components(&of_nodes);
        Ok(Self { is_held, of_contact, of_nodes })
    }

    /// Flux through the boundary of each component that balances this load on the finest level.
    pub(super) fn needed(&self, load: &[f64]) -> Vec<f64> {
        let mut needed = vec![0.0; self.is_held.len()];
        for (&component, load) in self.of_nodes.iter().zip(load) {
            needed[component as usize] -= load;
        }
        needed
    }
}
