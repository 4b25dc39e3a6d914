//! v and its flux at quadrature points of the boundary, other ones than the rows of the fit.

use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::spectral::complex::ln;
use crate::spectral::fit::{Fit, conditions, continue_logs, panels, spots_on};
use crate::spectral::geometry::boundary::State;
use crate::spectral::geometry::panels::{Spot, gauss};
use crate::spectral::setup::{Level, Setup};

/// Values at a point of the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneNode {
    pub spot: Spot,
    /// v.
    pub value: f64,
    /// dv/dn.
    pub flux: f64,
    /// Im g.
    pub conjugate: f64,
    pub psi: f64,
    /// dpsi/dn.
    pub psi_flux: f64,
    pub state: State,
    pub law: Law,
    /// Value of the law.
    pub at: f64,
    /// True if the split next to it is an end of contact, and if another law begins there.
    pub by_end: bool,
    pub by_joint: bool,
    /// By how much the condition is missed: by v where it is given, by the integral of dv/dn elsewhere.
    pub residual: f64,
    /// Distance along the loop.
    pub t: f64,
    pub ring: usize,
}

impl PlaneNode {
    /// v less the value of the law.
    pub(crate) fn above(&self) -> f64 {
        self.value - self.at
    }

    /// Outer normal.
    pub(crate) fn normal(&self) -> Complex {
        -self.spot.tangent.turned()
    }
}

/// Sizes that all checks refer to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sizes {
    /// Mean of |dv/dn|.
    pub flux: f64,
    /// That times the diameter, or the largest value of a law.
    pub value: f64,
    /// Largest residual.
    pub residual: f64,
    /// Integral of dv/dn over the boundary.
    pub force: f64,
    /// That of dv/dn - dpsi/dn, which is zero but for errors.
    pub balance: f64,
}

/// Nodes of the boundary in walking order.
pub(crate) fn boundary_nodes(
    setup: &Setup,
    fit: &Fit,
    level: &Level,
    points: usize,
) -> Vec<PlaneNode> {
    let panels = panels(setup, &fit.walk, &fit.functions, level, [1.0, 0.0]);
    let spots = spots_on(&fit.walk, &panels, gauss(points));
    let mut nodes = nodes_at(setup, fit, &spots);
    for (node, condition) in nodes.iter_mut().zip(conditions(setup, &fit.walk, &spots)) {
        node.residual = match node.state {
            State::Held => node.above(),
            State::Flux(_) => node.conjugate - condition,
        };
    }
    // The constants of runs are those of the rows: the integrals here begin elsewhere.
    for run in 0..fit.walk.runs {
        let mut first = None;
        for node in &mut nodes {
            if fit.walk.intervals[node.spot.interval].run == run {
                node.residual -= *first.get_or_insert(node.residual);
            }
        }
    }
    nodes
}

/// Nodes at spots.
pub(crate) fn nodes_at(setup: &Setup, fit: &Fit, spots: &[Spot]) -> Vec<PlaneNode> {
    let [mut g, slopes] = fit.at(spots, true);
    let points: Vec<Complex> = spots.iter().map(|spot| spot.z).collect();
    for (hole, &c) in fit.functions.holes.iter().zip(&fit.logs) {
        let principal: Vec<Complex> = points.iter().map(|&z| ln(z - hole.middle)).collect();
        let mut continued = principal.clone();
        continue_logs(&fit.walk, spots, &mut continued);
        for (g, (log, own)) in g.iter_mut().zip(continued.iter().zip(&principal)) {
            g.im += c * (log.im - own.im);
        }
    }
    let psi = &setup.jumps.psi;
    let (values, gradients) = (psi.values(&points), psi.gradients(&points));
    let mut nodes = Vec::with_capacity(spots.len());
    for (k, &spot) in spots.iter().enumerate() {
        nodes.push(node(setup, fit, spot, [g[k], slopes[k]], (values[k], gradients[k])));
    }
    nodes
}

/// Node at a spot, from g with its derivative, and psi with its gradient.
pub(crate) fn node(
    setup: &Setup,
    fit: &Fit,
    spot: Spot,
    [g, slope]: [Complex; 2],
    (psi, gradient): (f64, Complex),
) -> PlaneNode {
    let normal = -spot.tangent.turned();
    let interval = &fit.walk.intervals[spot.interval];
    let psi_flux = gradient.dot(normal);
    PlaneNode {
        spot,
        value: psi + g.re,
        flux: psi_flux + (slope * normal).re,
        conjugate: g.im,
        psi,
        psi_flux,
        state: interval.state,
        residual: 0.0,
        law: interval.law,
        at: setup.domain.value(setup.domain.side(interval), spot.z).0,
        by_end: fit.walk.splits.get(spot.split).is_some_and(|split| split.end.is_some()),
        by_joint: fit.walk.splits.get(spot.split).is_some_and(|split| split.joint),
        t: fit.walk.splits[interval.splits[0]].t + spot.s,
        ring: interval.ring,
    }
}

/// An error over a size: zero without an error, as where f and v are zero.
pub(crate) fn share(error: f64, size: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / size }
}

impl Sizes {
    /// Share of the flux that f does not balance.
    pub(crate) fn unbalanced(&self, balance: f64) -> f64 {
        share(balance.abs(), self.force.abs().max(self.flux))
    }

    pub(crate) fn new(setup: &Setup, nodes: &[PlaneNode]) -> Self {
        /// Difference of v from a constant, over that, which is none.
        const CONSTANT: f64 = 1e-7;
        let mut sizes = Self::default();
        for node in nodes {
            sizes.force += node.spot.weight * node.flux;
            sizes.balance += node.spot.weight * (node.flux - node.psi_flux);
            sizes.flux += node.spot.weight * node.flux.abs() / setup.perimeter;
            sizes.residual = sizes.residual.max(node.residual.abs());
        }
        let at = nodes.iter().fold(0.0f64, |most, node| most.max(node.at.abs()));
        // v may be a constant but for rounding.
        sizes.flux = sizes.flux.max(CONSTANT * at / setup.diameter);
        sizes.value = (sizes.flux * setup.diameter).max(at);
        sizes
    }
}
