//! Numbers of several cells side by side: structs of numbers, which also hold an array in the place of each number.

/// Number of cells whose sums are formed side by side.
pub(super) const LANES: usize = 16;

/// One number for each of [`LANES`] cells.
pub(super) type CellLanes = [f64; LANES];

/// Gives a struct with these fields, which are all, a method for loops over them.
macro_rules! loop_over_fields {
    ($name:ident { $($field:ident),+ }) => {
        impl<T> $name<T> {
            /// Calls `take` with each number and the same number of `other`.
            #[inline(always)]
            pub(super) fn each<U>(&mut self, other: &$name<U>, take: impl Fn(&mut T, &U)) {
                let Self { $($field: _),+ } = self;
                $(take(&mut self.$field, &other.$field);)+
            }
        }
    };
}

pub(super) use loop_over_fields;
