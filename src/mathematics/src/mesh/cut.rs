//! Integrals over one cell of a mesh of a function that is constant on shapes, of which the last one wins.
//!
//! Most cells lie inside or outside each shape. The others are integrated exactly, in coordinates in which the cell
//! just fits into the unit box, whatever the scale of the mesh.
//!
//! A triangle is one more convex set: the function less its background, painted over with zero on the three half-planes
//! outside, has the integrals over the triangle as those over the unit cell, which the sweep of the square takes.

use super::geometry::{Element, bounds, centroid, dot, longest_side};
use crate::discrete::cells::SweepCut;
use crate::problem::shape::{Shape, plain};

/// Shapes whose borders may cut triangles, V = 3, or tetrahedra, V = 4.
pub trait CutShape<const D: usize, const V: usize> {
    /// Storage for the work on one cell.
    type Storage: Default;

    /// Integrals over a cell of a function less `background`, which is its value where no piece is; of the pieces the
    /// first one wins. Cell and pieces are in the coordinates of the frame.
    fn integrate(
        storage: &mut Self::Storage,
        cell: &FramedCell<D, V>,
        background: f64,
        pieces: &[(Shape<D>, f64)],
    ) -> CutMoments<D>;
}

/// Function that is constant on shapes, of which the last one wins.
#[derive(Clone, Copy, Debug)]
pub struct ConstantPieces<'a, const D: usize> {
    /// Value where no shape is.
    pub background: f64,
    /// Shapes with their values.
    pub pieces: &'a [(Shape<D>, f64)],
}

/// Integrals of f over a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellPart<const V: usize> {
    /// Of f times the hat functions of the vertices.
    pub shares: [f64; V],
    /// Mean of f.
    pub mean: f64,
    /// L2 norm of f less its mean.
    pub deviation: f64,
    /// Integral of |f|.
    pub size: f64,
}

impl<const V: usize> CellPart<V> {
    /// Integrals of a constant.
    pub(super) fn constant(volume: f64, value: f64) -> Self {
        Self {
            shares: [volume * (value / V as f64); V],
            mean: value,
            deviation: 0.0,
            size: volume * value.abs(),
        }
    }
}

/// Integrals of a function f over a cell, in the coordinates of its frame. c is the value where no piece is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutMoments<const D: usize> {
    /// Of f - c.
    pub one: f64,
    /// Of f - c times each coordinate.
    pub first: [f64; D],
    /// Of the square of f - c.
    pub square: f64,
    /// Of |f| - |c|.
    pub size: f64,
}

/// Cell in the frame in which its bounding box has the centre 0 and the longest side 1.
#[derive(Clone, Copy, Debug)]
pub struct FramedCell<const D: usize, const V: usize> {
    /// Centre of the bounding box.
    origin: [f64; D],
    /// Longest side of the bounding box.
    unit: f64,
    /// Vertices as they are in the mesh.
    vertices: [[f64; D]; V],
    /// Vertices in the frame.
    pub(super) framed: [[f64; D]; V],
    /// Element of the framed vertices.
    pub(super) element: Element<D, V>,
    /// Least and greatest coordinates in the mesh along each axis.
    pub(super) bounds: [[f64; 2]; D],
}

impl<const D: usize, const V: usize> FramedCell<D, V> {
    /// Cell with these vertices.
    pub(super) fn new(vertices: [[f64; D]; V]) -> Self {
        let bounds = bounds(&vertices);
        let origin = bounds.map(|[least, greatest]| 0.5 * least + 0.5 * greatest);
        let unit = longest_side(bounds);
        let framed = vertices.map(|x| std::array::from_fn(|d| (x[d] - origin[d]) / unit));
        Self { origin, unit, vertices, framed, element: Element::new(framed), bounds }
    }

    /// True if a shape, in the coordinates of the mesh, certainly has no point inside the cell.
    fn is_missed_by(&self, shape: &Shape<D>) -> bool {
        match *shape {
            Shape::Ball { centre, radius } if self.is_away_from(centre, radius) => true,
            _ => is_outside(shape, &self.vertices, &self.bounds),
        }
    }

    /// The half-planes or half-spaces, in the frame, that the sides of the cell separate from it.
    pub(super) fn outside(&self) -> [Shape<D>; V] {
        std::array::from_fn(|vertex| {
            // The hat function of the vertex is negative there.
            let normal = self.element.gradients[vertex];
            Shape::HalfSpace { normal, d: dot(normal, self.framed[(vertex + 1) % V]) }
        })
    }

    /// True if the circle or sphere does not reach across the line or plane of a side of the cell, or across the one at
    /// a right angle to the way from its centre to that of the cell.
    fn is_away_from(&self, centre: [f64; D], radius: f64) -> bool {
        let centre: [f64; D] = std::array::from_fn(|d| (centre[d] - self.origin[d]) / self.unit);
        let radius = radius / self.unit;
        for (vertex, gradient) in self.element.gradients.iter().enumerate() {
            // The side opposite to a vertex holds the next one.
            let on_side = self.framed[(vertex + 1) % V];
            let from_side = std::array::from_fn(|d| on_side[d] - centre[d]);
            if dot(*gradient, from_side) >= radius * dot(*gradient, *gradient).sqrt() {
                return true;
            }
        }
        let middle = centroid(self.framed);
        let way: [f64; D] = std::array::from_fn(|d| middle[d] - centre[d]);
        let reach = radius * dot(way, way).sqrt();
        self.framed.iter().all(|x| dot(way, std::array::from_fn(|d| x[d] - centre[d])) >= reach)
    }
}

/// True if a box, or a ball by the box around it, has no point inside the bounds of a cell, or a half-plane or
/// half-space none inside the cell.
fn is_outside<const D: usize, const V: usize>(
    shape: &Shape<D>,
    vertices: &[[f64; D]; V],
    bounds: &[[f64; 2]; D],
) -> bool {
    let sides = match *shape {
        Shape::Box(sides) => sides,
        Shape::Ball { centre, radius } => centre.map(|x| [x - radius, x + radius]),
        Shape::HalfSpace { normal, d } => {
            let (normal, d) = plain(normal, d);
            return vertices.iter().all(|&vertex| dot(normal, vertex) >= d);
        }
    };
    let mut both = sides.iter().zip(bounds);
    both.any(|(side, bounds)| side[1] <= bounds[0] || bounds[1] <= side[0])
}

impl<const D: usize> ConstantPieces<'_, D> {
    /// Value on a cell with these vertices, if it is quickly seen that there is one.
    pub(super) fn constant_on<const V: usize>(self, vertices: &[[f64; D]; V]) -> Option<f64> {
        let bounds = bounds(vertices);
        for (shape, value) in self.pieces.iter().rev() {
            // A convex shape covers the cell if it holds the vertices.
            if vertices.iter().all(|&vertex| shape.contains(vertex)) {
                return Some(*value);
            }
            if !is_outside(shape, vertices, &bounds) {
                return None;
            }
        }
        Some(self.background)
    }
}

/// The pieces that share a cell, with storage for the work on them.
pub(super) struct CellCutter<const D: usize, const V: usize>
where
    Shape<D>: CutShape<D, V>,
{
    storage: <Shape<D> as CutShape<D, V>>::Storage,
    /// Pieces whose borders may cross the cell, the last one first, in the frame.
    across: Vec<(Shape<D>, f64)>,
}

impl<const D: usize, const V: usize> CellCutter<D, V>
where
    Shape<D>: CutShape<D, V>,
{
    pub(super) fn new() -> Self {
        Self { storage: Default::default(), across: Vec::new() }
    }

    /// Integrates over the cell with these vertices and this volume.
    pub(super) fn integrate(
        &mut self,
        vertices: [[f64; D]; V],
        volume: f64,
        f: ConstantPieces<'_, D>,
    ) -> CellPart<V> {
        if f.pieces.is_empty() {
            return CellPart::constant(volume, f.background);
        }
        let cell = FramedCell::new(vertices);
        let background = self.find_across(&cell, f);
        if self.across.iter().all(|&(_, value)| value == background) {
            return CellPart::constant(volume, background);
        }
        let moments = Shape::integrate(&mut self.storage, &cell, background, &self.across);
        let whole = cell.element.volume;
        let (one, first) = (moments.one / whole, moments.first.map(|first| first / whole));
        let middle = centroid(cell.framed);
        let shares = cell.element.gradients.map(|slopes| {
            // The hat function is 1 / V at the centroid.
            let at_origin = 1.0 / V as f64 - dot(slopes, middle);
            volume * (background / V as f64 + (at_origin * one + dot(slopes, first)))
        });
        CellPart {
            shares,
            mean: background + one,
            deviation: (volume * (moments.square / whole - one * one).max(0.0)).sqrt(),
            size: volume * (background.abs() + moments.size / whole),
        }
    }

    /// Finds the pieces whose borders may cross the cell, and returns the value of f where none of them is.
    fn find_across(&mut self, cell: &FramedCell<D, V>, f: ConstantPieces<'_, D>) -> f64 {
        self.across.clear();
        for (shape, value) in f.pieces.iter().rev() {
            // A convex shape covers the cell if it holds the vertices.
            if cell.vertices.iter().all(|&vertex| shape.contains(vertex)) {
                return *value;
            }
            if !cell.is_missed_by(shape) {
                self.across.push((shape.seen_from(cell.origin, cell.unit), *value));
            }
        }
        f.background
    }
}

impl CutShape<2, 3> for Shape<2> {
    type Storage = SweepCut;

    fn integrate(
        storage: &mut SweepCut,
        cell: &FramedCell<2, 3>,
        background: f64,
        pieces: &[(Self, f64)],
    ) -> CutMoments<2> {
        let [f, size] = [false, true].map(|of_size| {
            let less = |value: f64| {
                if of_size { value.abs() - background.abs() } else { value - background }
            };
            let above = pieces.iter().map(|&(shape, value)| (shape, less(value)));
            storage.set(0.0, cell.outside().into_iter().map(|shape| (shape, 0.0)).chain(above));
            storage.moments()
        });
        let [one, x, y, ..] = f.f;
        CutMoments { one, first: [x, y], square: f.square, size: size.f[0] }
    }
}
