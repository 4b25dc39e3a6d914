//! Functions given by value, gradient and Laplacian at a point, from which known solutions are made.

/// Value, first and second derivative of a function of one variable.
pub(super) type Jet = (f64, f64, f64);

/// `1 - 4 s^2`, zero at both ends of (-1/2, 1/2).
#[inline(always)]
pub(super) fn hill(s: f64) -> Jet {
    (1.0 - 4.0 * s * s, -8.0 * s, -8.0)
}

/// `1 - t^2`, zero at the far end of (0, 1).
#[inline(always)]
pub(super) fn falling(t: f64) -> Jet {
    (1.0 - t * t, -2.0 * t, -2.0)
}

/// `t^2 (1 - t)`, zero at both ends of (0, 1), at the near one with its slope.
#[inline(always)]
pub(super) fn bump(t: f64) -> Jet {
    (t * t * (1.0 - t), 2.0 * t - 3.0 * t * t, 2.0 - 6.0 * t)
}

/// Value and first derivatives of the solution, and `f = -Laplacian`, at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<const D: usize = 2> {
    /// v.
    pub value: f64,
    /// Derivatives of v along the axes.
    pub gradient: [f64; D],
    /// -Laplacian of v.
    pub f: f64,
}

/// A function of `D` variables at a point.
#[derive(Clone, Copy)]
pub(super) struct Field<const D: usize> {
    pub(super) value: f64,
    pub(super) gradient: [f64; D],
    pub(super) laplacian: f64,
}

/// The product of one function of each variable.
#[inline(always)]
pub(super) fn product<const D: usize>(factors: [Jet; D]) -> Field<D> {
    // The product with one factor replaced; a loop, because an iterator's fold is not always inlined.
    let with = |axis: usize, replacement: f64| {
        let mut product = 1.0;
        for (a, jet) in factors.iter().enumerate() {
            product *= if a == axis { replacement } else { jet.0 };
        }
        product
    };
    let (mut gradient, mut laplacian) = ([0.0; D], 0.0);
    for (axis, jet) in factors.iter().enumerate() {
        gradient[axis] = with(axis, jet.1);
        laplacian += with(axis, jet.2);
    }
    Field { value: with(0, factors[0].0), gradient, laplacian }
}

impl<const D: usize> Field<D> {
    #[inline(always)]
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            gradient: self.gradient.map(|slope| factor * slope),
            laplacian: factor * self.laplacian,
        }
    }

    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        let slopes: [_; D] = std::array::from_fn(|d| (self.gradient[d], other.gradient[d]));
        let dot: f64 = slopes.iter().map(|(a, b)| a * b).sum();
        Self {
            value: self.value * other.value,
            gradient: slopes.map(|(a, b)| a * other.value + self.value * b),
            laplacian: self.laplacian * other.value + 2.0 * dot + self.value * other.laplacian,
        }
    }

    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            gradient: std::array::from_fn(|d| self.gradient[d] - other.gradient[d]),
            laplacian: self.laplacian - other.laplacian,
        }
    }
}

impl<const D: usize> From<Field<D>> for Sample<D> {
    #[inline(always)]
    fn from(Field { value, gradient, laplacian }: Field<D>) -> Self {
        Self { value, gradient, f: -laplacian }
    }
}
