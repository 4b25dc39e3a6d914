//! Solutions on nested networks, by the levels that take the least work.

use super::levels::{Components, NestedProblem, NetworkLevels};
use super::run::NetworkRun;
use super::smoothed::{STRONG, VERY_STRONG};
use crate::discrete::end::{End, Stop};
use crate::discrete::load_stats::LoadStats;
use crate::discrete::nested::NestedNetwork;
use crate::multigrid::driver::{self, Hierarchy};
use crate::multigrid::{InputError, MultigridParams, check_length};
use crate::problem::law::{ContactNode, OneSided};

/// Minimises the energy `1/2 y'Ay - F'y` with the law's term at the contact nodes on the last of nested networks, where
/// y is given at its fixed nodes. `load` is the load vector F there. Returns the nodal vector, and the end.
///
/// # Errors
/// If the length of `load` is wrong, a number is not finite, or the flux cannot balance the load over a connected
/// component without fixed nodes; for the paper's law, if its sum is not negative there.
///
/// # Panics
/// If there are no levels.
pub fn solve_nested_networks(
    levels: &[NestedNetwork],
    load: &[f64],
    params: &MultigridParams,
) -> Result<(Vec<f64>, End), InputError> {
    let Improved { y, end, .. } =
        improve_on_nested_networks(levels, load, Start::default(), params)?;
    Ok((y, end))
}

/// Facts known before a run on nested networks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Start<'a> {
    /// Nodal vector near the solution of the last network, in place of the solutions on the networks before it.
    pub y: Option<&'a [f64]>,
    /// True if the networks before the last one are of little use, as a run before has found.
    pub is_slow: bool,
}

/// End of a run on nested networks.
pub struct Improved {
    /// Nodal vector of the last network.
    pub y: Vec<f64>,
    /// End of the iteration.
    pub end: End,
    /// True if the networks before the last one have been of little use, or are said to be, as on stretched cells.
    pub is_slow: bool,
}

/// As [`solve_nested_networks`], with a start. Where the steps are slow, aggregates of the last network along its very
/// strong couplings take the place of the networks before it; where those are slow as well, the rest is done on the
/// levels that lower the residual more for their work.
///
/// # Errors
/// As [`solve_nested_networks`].
///
/// # Panics
/// If there are no levels.
pub fn improve_on_nested_networks(
    levels: &[NestedNetwork],
    load: &[f64],
    start: Start<'_>,
    params: &MultigridParams,
) -> Result<Improved, InputError> {
    let last = &levels[levels.len() - 1..];
    if start.is_slow {
        return Ok(solve_on(last, load, start, true, params)?.improved);
    }
    let nested = solve_on(levels, load, start, false, params)?;
    if !nested.improved.is_slow {
        return Ok(nested.improved);
    }
    let again = Start { y: Some(&nested.improved.y), is_slow: true };
    let aggregated = solve_on(last, load, again, false, params)?;
    if !aggregated.is_cut_short {
        let runs = [nested.improved.end, aggregated.improved.end];
        return Ok(together(&runs, aggregated.improved));
    }
    // Both are slow: go on with the one that lowers the residual more for its work.
    let is_slow = aggregated.speed >= nested.speed;
    let from = Start { y: Some(&aggregated.improved.y), is_slow };
    let chosen = if is_slow { last } else { levels };
    let rest = solve_on(chosen, load, from, true, params)?;
    let runs = [&nested, &aggregated, &rest].map(|run| run.improved.end);
    Ok(together(&runs, rest.improved))
}

/// Run on some levels.
struct LevelRun {
    improved: Improved,
    /// True if it ended since its steps were slow.
    is_cut_short: bool,
    /// Part by which the last measured steps lowered the logarithm of the residual, over their work.
    speed: f64,
}

/// The last of some runs, with the steps and the work of all.
fn together(runs: &[End], last: Improved) -> Improved {
    let iterations = runs.iter().map(|run| run.iterations).sum();
    let work_units = runs.iter().map(|run| run.work_units).sum();
    Improved { end: End { iterations, work_units, ..last.end }, ..last }
}

/// Runs on these levels, and levels of aggregates below them: after a slow run of very strongly coupled nodes. Slow
/// steps end the run unless it is `to_the_end`.
fn solve_on(
    levels: &[NestedNetwork],
    load: &[f64],
    start: Start<'_>,
    to_the_end: bool,
    params: &MultigridParams,
) -> Result<LevelRun, InputError> {
    check_length(levels[levels.len() - 1].network.nodes(), load)?;
    let levels = NetworkLevels::new(levels, if start.is_slow { VERY_STRONG } else { STRONG });
    let load = &levels.renumbered(load);
    let components = Components::of(&levels, load)?;
    let finest = levels.network(levels.finest());
    let (laws, has_limits) = (finest.laws(), finest.contact().iter().any(|of| of.law.is_bounded()));
    let one_sided = OneSided::new(&laws, load);
    let shifted = one_sided.load(load, finest.contact());
    let mut stats = LoadStats::measure(&shifted);
    stats.largest = stats.largest.max(finest.size_of_values());
    let scale = stats.scale();
    let mesh = levels.network(levels.coarsest_mesh);
    let mut values = vec![0.0; mesh.nodes()];
    for ContactNode { node, law, .. } in mesh.held() {
        values[*node] = one_sided.signed(law.at()) / scale;
    }
    let load = shifted.iter().map(|value| value / scale).collect();
    let loads = levels.restricted(load, &values);
    let nested = NestedProblem { levels, loads, components, scale, one_sided };
    let mut run = NetworkRun::new(&nested);
    let factor = one_sided.signed(1.0) / scale;
    let scaled = |y: &[f64]| y.iter().map(|value| factor * value).collect::<Vec<f64>>();
    run.start = start.y.map(|y| scaled(&nested.levels.renumbered(y)));
    run.has_other_levels = !to_the_end;
    let end = driver::solve(&mut run, has_limits, params)?;
    let is_cut_short = end.stop == Stop::IterationLimit && run.is_slow();
    let (is_slow, speed) = (start.is_slow || is_cut_short, run.speed());
    let mut y = nested.levels.in_order_of_mesh(run.take_y());
    y.iter_mut().for_each(|value| *value *= one_sided.signed(scale));
    Ok(LevelRun { improved: Improved { y, end, is_slow }, is_cut_short, speed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::kkt::judge;
    use crate::discrete::norms::largest;
    use crate::mesh::{AnyMesh, gmsh, mesh_load, on_regions, refined};
    use crate::problem::law::Law;

    #[test]
    fn meshes_take_over_again_where_aggregates_are_slower() {
        let file = include_bytes!("../../../../tests/meshes/plate60.msh");
        let AnyMesh::Space(mesh) = gmsh::read(file).unwrap() else { panic!("a mesh in space") };
        let mesh = mesh.with_law(Law::friction(0.00595).unwrap());
        let (networks, mesh) = refined(&mesh, 2).unwrap();
        let f = on_regions::<3>("formula(4*x-3)", mesh.region_names(), mesh.extent()).unwrap();
        let load = mesh_load(&mesh, &f[..]).unwrap().load;
        let params = MultigridParams::default();
        let (y, end) = solve_nested_networks(&networks, &load, &params).unwrap();
        let network = &networks[2].network;
        let kkt = judge(network, &y, &load).kkt;
        assert!(
            end.stop == Stop::RoundingFloor && end.iterations < 200,
            "{} {end:?} {kkt:?}",
            y.len()
        );
        // Each row is a sum of products, each of which is rounded.
        let rounding =
            network.row_length() * f64::EPSILON * largest(network.diagonal()) * largest(&y);
        assert!(kkt.natural < rounding, "{kkt:?} {rounding:e}");
    }
}
