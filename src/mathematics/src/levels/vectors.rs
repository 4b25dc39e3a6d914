//! Numbers of a nodal vector of the finest level: contact, errors, values at points.

use super::Problem;
use crate::discrete::contact::ContactArc;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, StateCounts};
use crate::discrete::norms::Errors;
use crate::mesh::{PartShares, PointValue, arcs};
use crate::problem::law::Law;
use crate::saddle::Pair;
use std::collections::BTreeMap;

/// Part of the boundary with its law, and the force and the states there.
#[derive(Clone, Debug, PartialEq)]
pub struct OnPart {
    /// Names.
    pub name: String,
    /// Law.
    pub law: Law,
    /// Law in words.
    pub in_words: String,
    /// Integral of the flux; at a node on several parts, those whose laws do not decide it have shares by measure.
    pub force: f64,
    /// Numbers of nodes by their states; none of a free or a fixed part, or of a true solution.
    pub states: StateCounts,
}

impl Problem {
    /// Forces and states on each part of the boundary of a mesh, for a nodal vector of the finest level and its
    /// judgement; none on grids.
    pub fn on_parts(&self, y: &[f64], judgement: &Judgement) -> Vec<OnPart> {
        let Some(network) =
            self.networks().and_then(|all| all.last()).map(|finest| &finest.network)
        else {
            return Vec::new();
        };
        let (facts, load) = (self.levels().facts(), self.load());
        let shares = self.levels().mesh(self.finest()).shares();
        // Flux at each node that no law of its parts decides, and the length or area of these parts there.
        let mut open = BTreeMap::new();
        for part in shares.iter().filter(|part| !part.law.is_free()) {
            for (&node, &(share, law)) in &part.nodes {
                let (rest, of) = open.entry(node).or_insert_with(|| {
                    let flux = network.place(node).and_then(|place| judgement.flux_at(place));
                    (flux.unwrap_or_else(|| network.gradient_at(node, y, load)), 0.0)
                });
                match law.flux_of(y[node], judgement.rounding) {
                    Some(flux) => *rest -= share * flux,
                    None => *of += share,
                }
            }
        }
        let on_part = |PartShares { name, law, in_words, nodes }: PartShares| {
            let (mut force, mut states) = (0.0, StateCounts::default());
            for (node, (share, of_node)) in nodes {
                force += share
                    * of_node.flux_of(y[node], judgement.rounding).unwrap_or_else(|| {
                        let (rest, of) = open[&node];
                        rest / of
                    });
                if law.may_move()
                    && let Some((place, _)) = network.contact_at(node)
                {
                    states.add(judgement.states[place]);
                }
            }
            OnPart { name, law, in_words, force: facts.without_rounding(force), states }
        };
        shares.into_iter().map(on_part).collect()
    }

    /// Contact at the nodes of a boundary vector, as [`Pair::in_contact`] has it.
    pub fn in_contact(&self, pair: &Pair) -> Vec<bool> {
        pair.in_contact(self.domain(self.finest()))
    }

    /// Arcs in contact on the boundary of a domain in the plane, for a nodal vector and its judgement; none in space.
    pub fn arcs(&self, y: &[f64], judgement: &Judgement) -> Option<Vec<ContactArc>> {
        let is_plane = self.levels().facts().dimension == 2;
        is_plane.then(|| arcs(&self.levels().boundary(), y, judgement))
    }

    /// Names of the parts of the boundary that are in contact by a judgement, empty if there is no contact; none where
    /// the boundary has one part, and on the square, whose sides have no names.
    pub fn parts_in_contact(&self, judgement: &Judgement) -> Option<String> {
        self.networks()?;
        let touches = self.at_nodes(&judgement.in_contact(), false);
        self.levels().mesh(self.finest()).parts_of(&touches)
    }

    /// Puts values at the boundary nodes into a nodal vector with this value elsewhere.
    pub fn at_nodes<T: Copy>(&self, values: &[T], elsewhere: T) -> Vec<T> {
        let domain = self.domain(self.finest());
        let mut nodal = vec![elsewhere; domain.nodes()];
        for (contact, value) in domain.contact().iter().zip(values) {
            nodal[contact.node] = *value;
        }
        nodal
    }

    /// Errors of a nodal vector; none if the solution has no formula.
    pub fn errors(&self, y: &[f64]) -> Option<Errors> {
        let known = self.levels().facts().known?;
        match self.lattices() {
            Some(lattices) => lattices.errors(y),
            None => self.levels().mesh(self.finest()).errors(known, y),
        }
    }

    /// Values of a nodal vector of the finest level at points, each with as many coordinates as the domain has
    /// dimensions: linear on each triangle or tetrahedron, with the gradient on the one in which the point lies, and on
    /// the first of several. The squares of a grid are cut by rising diagonals, as in the paper.
    pub fn values_at(&self, y: &[f64], points: &[Vec<f64>]) -> Vec<PointValue> {
        if let Some(lattices) = self.lattices() {
            let grid = lattices.finest();
            return points.iter().map(|at| PointValue::new(at, on_grid(grid, at, y))).collect();
        }
        let mesh = self.levels().mesh(self.finest());
        points.iter().map(|at| mesh.at(at, y)).collect()
    }
}

/// Value and gradient on a grid of the square; none outside.
fn on_grid(grid: Grid, point: &[f64], y: &[f64]) -> Option<(f64, [f64; 2])> {
    let &[x0, x1] = point else { return None };
    let n = grid.cells() as f64;
    let [across, up] = [x0, x1].map(|x| (x + 0.5) * n);
    if !(0.0..=n).contains(&across) || !(0.0..=n).contains(&up) {
        return None;
    }
    let [i, j] = [across, up].map(|place| (place as usize).min(grid.cells() - 1));
    let (s, t) = (across - i as f64, up - j as f64);
    let [low, right, above, far] =
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[di, dj]| y[grid.index(i + di, j + dj)]);
    // Below the diagonal the way to the far corner leads over the right one.
    let [by_x, by_y] = if s >= t { [right - low, far - right] } else { [far - above, above - low] };
    Some((low + s * by_x + t * by_y, [by_x * n, by_y * n]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::load::LoadRule;
    use crate::mesh::uniform_square;

    #[test]
    fn a_grid_has_the_values_of_its_mesh() {
        let grid = Grid::new(4).unwrap();
        let f = "else=-1".parse().unwrap();
        let problem =
            Problem::on_square(vec![grid], f, LoadRule::default(), Law::SIGNORINI).unwrap();
        let y: Vec<f64> = (0..grid.nodes()).map(|node| ((7 * node) % 11) as f64).collect();
        let mesh = crate::mesh::AnyMesh::from(uniform_square(grid));
        let points = [[0.1, 0.2], [-0.3, 0.12], [0.5, 0.41], [-0.5, -0.5], [0.5, 0.5], [0.6, 0.0]];
        let points = points.map(Vec::from);
        for (value, point) in problem.values_at(&y, &points).into_iter().zip(&points) {
            let expected = mesh.at(point, &y);
            assert_eq!(value.v.is_some(), point[0] < 0.55, "{value:?}");
            let off = value.v.zip(expected.v).map(|(one, other)| (one - other).abs());
            assert!(off.unwrap_or(0.0) < 1e-12, "{value:?} {expected:?}");
            let gradients = value.gradient.zip(expected.gradient).unwrap_or_default();
            assert!(gradients.0.iter().zip(gradients.1).all(|(g, e)| (g - e).abs() < 1e-11));
        }
    }
}
