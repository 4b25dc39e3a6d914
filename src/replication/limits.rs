//! Problems that are not solved, with the way around where there is one: said by refusals and by the book.

use serde::Serialize;

/// Something that is not solved.
#[derive(Debug, Serialize)]
pub(crate) struct Limit {
    /// Words by which it is asked for, as options, keys and names of what varies.
    words: &'static [&'static str],
    /// Feature that is wanted.
    wanted: &'static str,
    /// Feature that there is, with the way around.
    instead: &'static str,
}

/// All that users of other programs ask for.
pub(crate) static LIMITS: [Limit; 6] = [
    Limit {
        words: &["obstacle", "gap", "lower", "upper"],
        wanted: "an obstacle other than 0",
        instead: "without a fixed part, a constant c is the same problem: v becomes v + c, and the energy J(v) less c \
            times the integral of f",
    },
    Limit {
        words: &["dirichlet", "value", "displacement", "boundary", "bc"],
        wanted: "a value other than 0 on a fixed part",
        instead: "a fixed part holds v at 0; if each part is fixed or free, a constant c is the same problem with \
            v + c",
    },
    Limit {
        words: &["neumann", "flux", "robin", "traction"],
        wanted: "a given flux through the boundary",
        instead: "on a free part it is 0, elsewhere it follows from the law",
    },
    Limit {
        words: &[
            "coefficient",
            "material",
            "conductivity",
            "diffusion",
            "permeability",
            "stiffness",
            "k",
        ],
        wanted: "a coefficient k before the gradient",
        instead: "a constant one divides f and the bound of friction or of a limit; the energy is then k times that of \
            the answer",
    },
    Limit {
        words: &["elasticity", "young", "poisson"],
        wanted: "elasticity, with a displacement that is a vector",
        instead: "the problem is the scalar one",
    },
    Limit {
        words: &[],
        wanted: "the true solution for every f on every domain",
        instead: "the spectral solver takes straight sides and arcs in the plane, and f of pieces or a polynomial; on \
            curved boundaries the bounds of elements hold for the polygon",
    },
];

/// Returns the sentence on a word by which something that is not solved is asked for, if it is known.
pub(crate) fn of_word(word: &str) -> Option<String> {
    let word = word.trim_start_matches('-').to_lowercase();
    let limit = LIMITS.iter().find(|limit| limit.words.contains(&&*word))?;
    Some(format!("{} is not solved: {}", limit.wanted, limit.instead))
}
