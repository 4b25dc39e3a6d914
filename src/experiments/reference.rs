//! The paper's iteration (9)-(13) once more, as a plain loop over any arithmetic: what rounding does to it.
//!
//! [`Plain`] in double precision gives the iterates and counts of [`crate::saddle`] to the last bit. The
//! others change one thing each: the precision, the order of operations, the last digits of a result.

use crate::discrete::grid::Grid;
use crate::discrete::transfer::Prolongation;
use crate::identify::random::Random;
use crate::saddle::{Pair, tolerance};
use std::ops::{Add, Div, Mul, Sub};

/// A format of floating-point numbers.
pub trait Number:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// The nearest number of this format.
    fn of(value: f64) -> Self;
    /// The same number in double precision.
    fn wide(self) -> f64;
    /// `x * y + z`, rounded once.
    fn fused(x: Self, y: Self, z: Self) -> Self;
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn wide(self) -> f64 {
        self
    }
    fn fused(x: Self, y: Self, z: Self) -> Self {
        libm::fma(x, y, z)
    }
}

impl Number for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
    fn fused(x: Self, y: Self, z: Self) -> Self {
        libm::fmaf(x, y, z)
    }
}

/// The operations of the iteration that an arithmetic may round in its own way.
///
/// All others are exact but for one rounding each: the mesh width and the diagonals are powers of two.
pub trait Arithmetic<N: Number> {
    /// `south + north + east + load + west`.
    fn star(&mut self, [south, north, east, load, west]: [N; 5]) -> N {
        ((south + north) + (east + load)) + west
    }
    /// `along + inward + load`: the neighbours on the edge, already halved, and the one inside.
    fn edge(&mut self, [along, inward, load]: [N; 3]) -> N {
        along + inward + load
    }
    /// `a - r y`.
    fn step(&mut self, a: N, r: N, y: N) -> N {
        a - r * y
    }
    /// The new value of a node.
    fn node(&mut self, y: N) -> N {
        y
    }
}

/// Every operation as in [`crate::saddle`].
#[derive(Clone, Copy, Debug)]
pub struct Plain;

impl<N: Number> Arithmetic<N> for Plain {}

/// All sums from the other end.
#[derive(Clone, Copy, Debug)]
pub struct Reversed;

impl<N: Number> Arithmetic<N> for Reversed {
    fn star(&mut self, [south, north, east, load, west]: [N; 5]) -> N {
        (((west + load) + east) + north) + south
    }
    fn edge(&mut self, [along, inward, load]: [N; 3]) -> N {
        load + inward + along
    }
}

/// A product and the sum it enters rounded together, as compilers may.
#[derive(Clone, Copy, Debug)]
pub struct Fused;

impl<N: Number> Arithmetic<N> for Fused {
    fn step(&mut self, a: N, r: N, y: N) -> N {
        N::fused(N::of(-1.0) * r, y, a)
    }
}

/// The value of each node off by a random relative error of at most `size`.
pub struct Noisy {
    /// Largest relative error.
    pub size: f64,
    /// Where the errors come from.
    pub random: Random,
}

impl Arithmetic<f64> for Noisy {
    fn node(&mut self, y: f64) -> f64 {
        y + y * (self.size * (2.0 * self.random.unit() - 1.0))
    }
}

/// One grid of a run.
pub struct Problem<'a, N> {
    /// The grid.
    pub grid: Grid,
    /// Nodal vector: the load.
    pub load: &'a [N],
    /// Duality parameter.
    pub r: N,
}

impl<N: Number> Problem<'_, N> {
    /// Iterates on `y` and `a` until `max dM/dy <= tolerance` or the cap; returns the iterations and whether
    /// the rule was met.
    pub fn iterate(
        &self,
        arithmetic: &mut impl Arithmetic<N>,
        tolerance: f64,
        cap: usize,
        (y, a): (&mut [N], &mut [N]),
    ) -> (usize, bool) {
        let boundary: Vec<usize> = self.grid.boundary().collect();
        let zero = N::of(0.0);
        let tolerance = N::of(tolerance);
        let mut failed = 0;
        for iteration in 1..=cap {
            self.sweep(arithmetic, y, a);
            for (a, &node) in a.iter_mut().zip(&boundary) {
                let next = arithmetic.step(*a, self.r, y[node]);
                *a = if next > zero { next } else { zero };
            }
            // The row that failed last is the likeliest to fail again.
            let side = self.grid.side();
            let fails = |&j: &usize| !self.row_within(j, y, a, tolerance);
            match (failed..side).chain(0..failed).find(fails) {
                Some(j) => failed = j,
                None => return (iteration, true),
            }
        }
        (cap, false)
    }

    fn sweep(&self, arithmetic: &mut impl Arithmetic<N>, y: &mut [N], a: &[N]) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let quarter = N::of(0.25);
        for j in 0..=n {
            for i in 0..=n {
                let node = j * side + i;
                let next = if i == 0 || j == 0 || i == n || j == n {
                    self.boundary_node(arithmetic, y, a, i, j)
                } else {
                    let load = self.load[node];
                    let parts = [y[node - side], y[node + side], y[node + 1], load, y[node - 1]];
                    quarter * arithmetic.star(parts)
                };
                y[node] = arithmetic.node(next);
            }
        }
    }

    /// (10) and (11).
    fn boundary_node(
        &self,
        arithmetic: &mut impl Arithmetic<N>,
        y: &[N],
        a: &[N],
        i: usize,
        j: usize,
    ) -> N {
        let (n, half) = (self.grid.cells(), N::of(0.5));
        let load = self.load[self.grid.index(i, j)];
        let (b, along, inward) = self.neighbours(y, i, j);
        let (sum, diagonal) = match inward {
            Some(inward) => (arithmetic.edge([half * along, inward, load]), N::of(2.0)),
            None => (half * along + load, N::of(1.0)),
        };
        let (a, h) = (a[b], N::of(1.0 / n as f64));
        let psi = N::of(1.0) / diagonal * sum;
        if psi >= a / self.r { psi } else { (sum + h * a) / (diagonal + h * self.r) }
    }

    /// Place of a boundary node in boundary order, the sum of its neighbours on the boundary, and, but for
    /// corners, the one inside.
    fn neighbours(&self, y: &[N], i: usize, j: usize) -> (usize, N, Option<N>) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let node = j * side + i;
        let inner = |k: usize| if k == 0 { 1 } else { n - 1 };
        let (beside, above) = (j * side + inner(i), inner(j) * side + i);
        match (i == 0 || i == n, j == 0 || j == n) {
            (true, true) => {
                let b = match (i, j) {
                    (0, 0) => 0,
                    (_, 0) => n,
                    (0, _) => 3 * n,
                    _ => 2 * n,
                };
                (b, y[beside] + y[above], None)
            }
            (false, _) => {
                let b = if j == 0 { i } else { 3 * n - i };
                (b, y[node - 1] + y[node + 1], Some(y[above]))
            }
            _ => {
                let b = if i == n { n + j } else { 4 * n - j };
                (b, y[node - side] + y[node + side], Some(y[beside]))
            }
        }
    }

    /// Whether row `j` of the gradient (8) is at most `tolerance` everywhere.
    fn row_within(&self, j: usize, y: &[N], a: &[N], tolerance: N) -> bool {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let border = |i: usize| self.boundary_gradient(y, a, i, j) <= tolerance;
        if j == 0 || j == n {
            return (0..=n).all(border);
        }
        let row = |j: usize| &y[j * side..][..side];
        let (below, here, above) = (row(j - 1), row(j), row(j + 1));
        let load = &self.load[j * side..][..side];
        let four = N::of(4.0);
        let inside = (1..n).fold(true, |ok, i| {
            let sums = (below[i] + above[i], here[i - 1] + here[i + 1]);
            ok & (four * here[i] - sums.0 - sums.1 - load[i] <= tolerance)
        });
        inside && border(0) && border(n)
    }

    fn boundary_gradient(&self, y: &[N], a: &[N], i: usize, j: usize) -> N {
        let (n, node) = (self.grid.cells(), self.grid.index(i, j));
        let (half, h) = (N::of(0.5), N::of(1.0 / n as f64));
        let (b, along, inward) = self.neighbours(y, i, j);
        let residual = match inward {
            Some(inward) => N::of(2.0) * y[node] - half * along - inward - self.load[node],
            None => y[node] - half * along - self.load[node],
        };
        let pull = a[b] - self.r * y[node];
        residual - h * if pull > N::of(0.0) { pull } else { N::of(0.0) }
    }
}

/// A run over nested grids as the paper makes it, stopped by the signed rule; the count on each grid, `None`
/// where the cap came first, and the last pair.
///
/// The prolongation is computed in double precision and rounded once. `cap(k)` bounds the k-th grid.
pub fn nested_counts<N: Number>(
    arithmetic: &mut impl Arithmetic<N>,
    grids: &[Grid],
    loads: &[Vec<N>],
    r: f64,
    prolongation: Prolongation,
    cap: impl Fn(usize) -> usize,
) -> (Vec<Option<usize>>, Pair) {
    let mut pair = Pair::zero(grids[0]);
    let mut counts = Vec::with_capacity(grids.len());
    for (k, (&grid, load)) in grids.iter().zip(loads).enumerate() {
        if k > 0 {
            pair = pair.prolonged(grids[k - 1], prolongation);
        }
        let narrow = |v: &[f64]| -> Vec<N> { v.iter().map(|&x| N::of(x)).collect() };
        let (mut y, mut a) = (narrow(&pair.y), narrow(&pair.a));
        let problem = Problem { grid, load, r: N::of(r) };
        let (count, met) = problem.iterate(arithmetic, tolerance(k + 1), cap(k), (&mut y, &mut a));
        counts.push(met.then_some(count));
        let wide = |v: &[N]| v.iter().map(|x| x.wide()).collect();
        pair = Pair { y: wide(&y), a: wide(&a) };
    }
    (counts, pair)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::grid::nested;
    use crate::discrete::load::{LoadRule, load};
    use crate::saddle::{Params, solve_nested};

    #[test]
    fn plain_is_the_library_to_the_last_bit() {
        let grids = nested(&[4, 8, 16, 32]).unwrap();
        for (f, rule) in [
            ("quadrant(ll)=3; else=-1.002", LoadRule::default()),
            ("quadrant(ll)=-6; else=1.998", LoadRule::LumpedAverage),
        ] {
            let f = f.parse().unwrap();
            let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &f, rule)).collect();
            for r in [0.3, 5.0, 1e6] {
                let params = Params { r, ..Params::default() };
                let bilinear = Prolongation::Bilinear;
                let (outcomes, want) = solve_nested(&grids, &loads, &params, bilinear, &mut ());
                let (counts, pair) =
                    nested_counts(&mut Plain, &grids, &loads, r, bilinear, |_| 10_000);
                let want_counts: Vec<_> = outcomes.iter().map(|o| Some(o.iterations)).collect();
                assert_eq!(counts, want_counts, "{f} {r}");
                assert!(pair == want, "{f} {r}");
            }
        }
    }
}
