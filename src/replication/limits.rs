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
pub(crate) static LIMITS: [Limit; 8] = [
    Limit {
        words: &["obstacle", "lower"],
        wanted: "an obstacle that is no constant on a part",
        instead: "`gap` gives each part a number, as bottom=0.1 for v >= 0.1",
    },
    Limit {
        words: &["upper"],
        wanted: "an upper obstacle that is no constant on a part, or on a part with a lower one",
        instead: "`below` gives a part a number, as bottom=0.1 for v <= 0.1",
    },
    Limit {
        words: &["dirichlet", "value", "displacement", "bc"],
        wanted: "a value that is no constant on a fixed part",
        instead: "`fixed` gives each part a number, as bottom=0.1 for v = 0.1",
    },
    Limit {
        words: &["neumann", "traction"],
        wanted: "a flux that is no constant on a part",
        instead: "`free` and `flux` give each part a number, as bottom=0.1 for dv/dn = 0.1",
    },
    Limit {
        words: &["robin", "reaction"],
        wanted: "a flux or an f that depends on v otherwise than by a law",
        instead: "the laws are obstacles, friction and a limit",
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
