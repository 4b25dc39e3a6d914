//! f on a mesh: its load vector, its integrals, and its means over the cells.
//!
//! A cell on which f is constant, or which the borders of shapes with constant f [cut](super::cut), is integrated
//! exactly. Any other f is sampled: the cells are divided until two formulas agree. Its values at the points that cells
//! share, the nodes and the midpoints of edges, are taken once.

use super::cut::{CellCutter, CellPart, ConstantPieces, CutShape};
use super::{Edges, Mesh, measure, volume};
use crate::discrete::adaptive::{
    COST, CellValues, LEAST_PARTS, SETTLED, SHARED_POINTS, SampledCell, Sampler, Settling,
};
use crate::machine::threads::{items_per_task, map, map_range, map_with_room};
use crate::problem::error::SourceError;
use crate::problem::law::Law;
use crate::problem::shape::Shape;

/// f on the cells of a mesh.
pub trait OnCells<const D: usize>: Sync {
    /// The constant pieces of f on the cells of a region; none if f is known there by its values only.
    fn pieces(&self, region: u16) -> Option<ConstantPieces<'_, D>>;

    /// Value at a point of a cell of this region.
    fn at(&self, region: u16, point: [f64; D]) -> f64;
}

/// Function on the cells of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct CellData {
    /// Mean over each cell.
    pub mean: Vec<f64>,
    /// L2 norm over each cell of the function less the mean; none if the function is constant on each cell.
    pub deviation: Option<Vec<f64>>,
    /// Integrals over each cell of the function times the hat function of each vertex, one cell after the other; none
    /// if the function is constant on each cell, or if they are not known.
    pub shares: Option<Vec<f64>>,
}

/// f on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshLoad {
    /// Load vector (6): integrals of f times the hat functions, and of the flux on free parts of the boundary.
    pub load: Vec<f64>,
    /// f on the cells.
    pub cells: CellData,
    /// Integral of f.
    pub integral: f64,
    /// Integral of |f|.
    pub size: f64,
    /// Integral of the absolute value of the flux over the free parts of the boundary.
    pub(crate) given: f64,
    /// Flux out through the free parts of the boundary.
    pub(crate) given_flux: f64,
    /// Sum of the differences of the formulas by which f was sampled; none if all integrals are exact.
    pub unsettled: Option<f64>,
    /// Sum of the differences between the integrals over cells and the formula of degree 5 on each whole cell.
    pub(crate) moved: f64,
}

impl MeshLoad {
    /// Part of the integral of |f| that the quadrature of f may have missed; none if all integrals are exact.
    pub fn missed(&self) -> Option<f64> {
        self.unsettled.map(|unsettled| unsettled / self.size)
    }
}

impl<const V: usize> CellPart<V> {
    fn sampled(volume: f64, cell: &SampledCell<V>) -> Self {
        Self {
            shares: cell.shares.map(|share| volume * share),
            mean: cell.mean,
            deviation: (volume * cell.variance.max(0.0)).sqrt(),
            size: volume * cell.size,
        }
    }
}

/// Parts of cells at most over a whole mesh, besides one for each cell.
const MOST_PARTS: usize = 1 << 17;
/// Cells between which their parts are added to the sums.
const RUN: usize = 1 << 12;

/// Cells of the mesh before, with the same f.
#[derive(Clone, Copy)]
pub(crate) struct CellsBefore<'a> {
    /// Number of the cell before in which each cell lies.
    pub origins: &'a [u32],
    /// f on the cells before.
    pub f: &'a CellData,
}

impl CellsBefore<'_> {
    /// Value of f on a cell, if the deviation from the mean says that it is constant on the cell before.
    fn constant(&self, cell: usize) -> Option<f64> {
        let origin = self.origins[cell] as usize;
        let is_constant = self.f.deviation.as_ref().is_none_or(|all| all[origin] == 0.0);
        is_constant.then_some(self.f.mean[origin])
    }
}

/// Integrates f over all cells.
///
/// # Errors
/// [`SourceError::NoValue`] with a point where f is not finite.
pub fn mesh_load<const D: usize, const V: usize, F: OnCells<D> + ?Sized>(
    mesh: &Mesh<D, V>,
    f: &F,
) -> Result<MeshLoad, SourceError>
where
    Shape<D>: CutShape<D, V>,
{
    integrated(mesh, f, None)
}

/// As [`mesh_load`], on a mesh whose cells lie in those of another: where f is constant on shapes, and on a cell there,
/// it need not be cut again.
///
/// # Errors
/// As [`mesh_load`].
pub(crate) fn mesh_load_after<const D: usize, const V: usize, F: OnCells<D> + ?Sized>(
    before: CellsBefore<'_>,
    mesh: &Mesh<D, V>,
    f: &F,
) -> Result<MeshLoad, SourceError>
where
    Shape<D>: CutShape<D, V>,
{
    integrated(mesh, f, Some(before))
}

fn integrated<const D: usize, const V: usize, F: OnCells<D> + ?Sized>(
    mesh: &Mesh<D, V>,
    f: &F,
    before: Option<CellsBefore<'_>>,
) -> Result<MeshLoad, SourceError>
where
    Shape<D>: CutShape<D, V>,
{
    let cells = mesh.cells().len();
    let least_parts = LEAST_PARTS.div_ceil(cells).next_power_of_two();
    // The parts of a cell that is divided have other points.
    let shared = (least_parts == 1).then(|| shared_values(mesh, f)).flatten();
    let (sampler, volume) = (Sampler::default(), mesh.volume());
    let work = CellWork { mesh, f, before, sampler, shared, volume };
    let mut made = LoadSums::new(mesh);
    // Cells that are not settled as far as f is known, with their parts.
    let mut open = Vec::new();
    let once = Settling { least_parts, most_parts: 0, tolerance: f64::INFINITY };
    for start in (0..cells).step_by(RUN) {
        let run = start..cells.min(start + RUN);
        let each = items_per_task(run.len(), COST);
        let constants = map_range(run, each, |cell| work.constant(cell));
        let others: Vec<_> =
            (start..).zip(&constants).filter(|(_, value)| value.is_none()).collect();
        let parts = map_with_room(0..others.len(), each, CellCutter::new, |cutter, k| {
            let cell = others[k].0;
            let part = work.integrate(cutter, cell, once)?;
            let is_whole = least_parts == 1 || part.difference.is_none();
            let whole = Settling { least_parts: 1, ..once };
            let on_whole = if is_whole { None } else { Some(work.integrate(cutter, cell, whole)?) };
            let coarse = on_whole.map_or(part.part.mean, |whole| whole.part.mean);
            Ok::<_, SourceError>((part, coarse))
        });
        let mut parts = parts.into_iter();
        for (cell, &constant) in (start..).zip(&constants) {
            let (part, coarse) = match constant {
                Some(value) => {
                    let of_cell = super::volume(mesh.vertices(&mesh.cells()[cell]));
                    (WeighedPart::exact(CellPart::constant(of_cell, value)), value)
                }
                None => parts.next().expect("a part for each other cell")?,
            };
            made.size += part.part.size;
            if part.worst > SETTLED * made.size {
                open.push((cell, part, coarse));
            } else {
                made.add(cell, &part, coarse);
            }
        }
    }
    let size = made.size;
    let (open, settled): (Vec<_>, Vec<_>) =
        open.into_iter().partition(|(_, part, _)| part.worst > SETTLED * size);
    settled.iter().for_each(|(cell, part, coarse)| made.add(*cell, part, *coarse));
    let more = Settling {
        most_parts: once.least_parts + MOST_PARTS.div_ceil(open.len().max(1)),
        tolerance: SETTLED * size,
        ..once
    };
    let each = items_per_task(open.len(), COST * more.most_parts);
    let finer = map_with_room(0..open.len(), each, CellCutter::new, |cutter, k| {
        work.integrate(cutter, open[k].0, more)
    });
    for ((cell, before, coarse), part) in open.iter().zip(finer) {
        let part = part?;
        made.size += part.part.size - before.part.size;
        made.add(*cell, &part, *coarse);
    }
    Ok(made.finished())
}

/// Values at the points that cells share of an f that is known by its values alone; none where regions differ.
fn shared_values<const D: usize, const V: usize, F: OnCells<D> + ?Sized>(
    mesh: &Mesh<D, V>,
    f: &F,
) -> Option<SharedValues> {
    let (&region, others) = mesh.regions().split_first()?;
    let is_one = f.pieces(region).is_none() && others.iter().all(|other| *other == region);
    is_one.then(|| SharedValues::of(mesh, |point| f.at(region, point)))
}

/// Integrals over one cell, and how far they are settled.
struct WeighedPart<const V: usize> {
    part: CellPart<V>,
    /// Difference of the formulas; none if the integrals are exact.
    difference: Option<f64>,
    /// Largest difference on a part of the cell, to be compared with that of [`SETTLED`].
    worst: f64,
}

impl<const V: usize> WeighedPart<V> {
    fn exact(part: CellPart<V>) -> Self {
        Self { part, difference: None, worst: 0.0 }
    }
}

/// Mesh and function to be integrated.
struct CellWork<'a, F: ?Sized, const D: usize, const V: usize> {
    mesh: &'a Mesh<D, V>,
    f: &'a F,
    before: Option<CellsBefore<'a>>,
    sampler: Sampler<V>,
    shared: Option<SharedValues>,
    /// Volume of the mesh.
    volume: f64,
}

impl<F: OnCells<D> + ?Sized, const D: usize, const V: usize> CellWork<'_, F, D, V>
where
    Shape<D>: CutShape<D, V>,
{
    /// Value of f on a cell, if it is quickly seen that there is one.
    fn constant(&self, cell: usize) -> Option<f64> {
        let pieces = self.f.pieces(self.mesh.regions()[cell])?;
        let before = self.before.and_then(|before| before.constant(cell));
        before.or_else(|| pieces.constant_on(&self.mesh.vertices(&self.mesh.cells()[cell])))
    }

    /// Integrates over a cell. A tolerance is for the mesh, as [`SETTLED`].
    fn integrate(
        &self,
        cutter: &mut CellCutter<D, V>,
        cell: usize,
        settling: Settling,
    ) -> Result<WeighedPart<V>, SourceError> {
        let (mesh, region) = (self.mesh, self.mesh.regions()[cell]);
        let vertices = mesh.vertices(&mesh.cells()[cell]);
        let volume = volume(vertices);
        if let Some(pieces) = self.f.pieces(region) {
            return Ok(WeighedPart::exact(cutter.integrate(vertices, volume, pieces)));
        }
        let fraction = volume / self.volume;
        let power = libm::pow(fraction, (D as f64 - 1.0) / D as f64);
        // The tolerance is 0 for f = 0, and the volume of a flat cell.
        let tolerance = settling.tolerance * power / volume;
        let settling =
            Settling { tolerance: if tolerance.is_nan() { 0.0 } else { tolerance }, ..settling };
        let values = |point| self.f.at(region, point);
        let shared = self.shared.as_ref().map(|shared| shared.on(mesh.cells()[cell]));
        let values = CellValues { vertices, f: &values, shared };
        let found = self.sampler.integrate(&values, settling)?;
        Ok(WeighedPart {
            part: CellPart::sampled(volume, &found),
            difference: Some(volume * found.difference),
            worst: volume * found.worst / power,
        })
    }
}

/// Sums over the cells.
struct LoadSums<'a, const D: usize, const V: usize> {
    mesh: &'a Mesh<D, V>,
    load: Vec<f64>,
    mean: Vec<f64>,
    deviation: Vec<f64>,
    shares: Vec<[f64; V]>,
    size: f64,
    unsettled: Option<f64>,
    moved: f64,
}

impl<'a, const D: usize, const V: usize> LoadSums<'a, D, V> {
    fn new(mesh: &'a Mesh<D, V>) -> Self {
        let cells = mesh.cells().len();
        Self {
            mesh,
            load: vec![0.0; mesh.points().len()],
            mean: vec![0.0; cells],
            deviation: vec![0.0; cells],
            shares: vec![[0.0; V]; cells],
            size: 0.0,
            unsettled: None,
            moved: 0.0,
        }
    }

    /// Adds the integrals over a cell, but for that of |f|, with the mean by the formula on the whole cell.
    fn add(
        &mut self,
        cell: usize,
        WeighedPart { part, difference, .. }: &WeighedPart<V>,
        coarse: f64,
    ) {
        for (&node, share) in self.mesh.cells()[cell].iter().zip(part.shares) {
            self.load[node as usize] += share;
        }
        self.mean[cell] = part.mean;
        self.deviation[cell] = part.deviation;
        self.shares[cell] = part.shares;
        if let Some(difference) = difference {
            *self.unsettled.get_or_insert(0.0) += difference;
            let volume = volume(self.mesh.vertices(&self.mesh.cells()[cell]));
            self.moved += volume * (part.mean - coarse).abs();
        }
    }

    fn finished(self) -> MeshLoad {
        let Self { mesh, mut load, mean, deviation, shares, size, unsettled, moved } = self;
        let (mut given, mut given_flux) = (0.0, 0.0);
        for facet in mesh.facets() {
            let law = mesh.law(facet);
            if !law.is_free() || mesh.parts()[usize::from(facet.part)].law == Law::FREE {
                continue;
            }
            let measure = measure(mesh.corners(facet));
            let outflow = law.lo() * measure;
            (given, given_flux) = (given + outflow.abs(), given_flux + outflow);
            for node in facet.nodes {
                load[node as usize] += mesh.law_at(facet, node).lo() * measure / D as f64;
            }
        }
        let masses = mesh.cells().iter().zip(&mean);
        let integral: f64 = masses.map(|(cell, mean)| volume(mesh.vertices(cell)) * mean).sum();
        let is_constant = deviation.iter().all(|deviation| *deviation == 0.0);
        let deviation = (!is_constant).then_some(deviation);
        let shares = (!is_constant).then(|| shares.into_flattened());
        let cells = CellData { mean, deviation, shares };
        MeshLoad { load, cells, integral, size, given, given_flux, unsettled, moved }
    }
}

/// Values of f at the nodes of a mesh, and at the midpoints of its edges.
pub(super) struct SharedValues {
    nodes: Vec<f64>,
    edges: Edges,
    middles: Vec<f64>,
}

impl SharedValues {
    /// Values of a function of the point alone.
    pub(super) fn of<const D: usize, const V: usize>(
        mesh: &Mesh<D, V>,
        f: impl Fn([f64; D]) -> f64 + Sync,
    ) -> Self {
        let points = mesh.points();
        let edges = Edges::new(points.len(), mesh.cells());
        let ends = edges.ends();
        // Zeros have one sign, whatever the order of the vertices.
        let nodes = map(points, COST, |point| f(point.map(|x| x + 0.0)));
        let middles = map(&ends, COST, |nodes| {
            let [p, q] = nodes.map(|node| points[node as usize]);
            f(std::array::from_fn(|d| 0.5 * p[d] + 0.5 * q[d] + 0.0))
        });
        Self { nodes, edges, middles }
    }

    /// Values at the vertices of a cell, behind each those at the midpoints of its edges to the vertices before.
    pub(super) fn on<const V: usize>(&self, cell: [u32; V]) -> [f64; SHARED_POINTS] {
        let (mut values, mut count) = ([f64::NAN; SHARED_POINTS], 0);
        for a in 0..V {
            values[count] = self.nodes[cell[a] as usize];
            for b in 0..a {
                values[count + 1 + b] = self.middles[self.edges.between(cell[a], cell[b])];
            }
            count += 1 + a;
        }
        values
    }
}
