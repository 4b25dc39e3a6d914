//! Steps of the way to a solution with its bounds, for those who watch it, with a clock for instance.

/// Step that has just ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A mesh and its matrix.
    Mesh,
    /// f on the cells, and the load vector.
    Load,
    /// A solution.
    Solver,
    /// Judgement and bounds of a solution.
    Bounds,
}

/// Is told each step that has ended, by the thread that was at it: a mesh and its load are made at the same time.
pub type Watch<'a> = &'a (dyn Fn(Step) + Sync);
