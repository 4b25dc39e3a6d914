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
        wanted: "an obstacle that is given at points",
        instead: "`gap` gives each part a number or a formula, as bottom=0.1*x for v >= 0.1 x",
    },
    Limit {
        words: &["upper"],
        wanted: "an upper obstacle on a part with a lower one",
        instead: "a part has one of the two, `gap` or `below`, a number or a formula, as bottom=0.1*x for v <= 0.1 x",
    },
    Limit {
        words: &["dirichlet", "value", "displacement", "bc"],
        wanted: "a value on a fixed part that is given at points",
        instead: "`fixed` gives each part a number or a formula, as top=0.1*x for v = 0.1 x",
    },
    Limit {
        words: &["neumann", "traction"],
        wanted: "a flux by a formula on a part that is not free",
        instead: "`free` gives a part a number or a formula, as left=sin(pi*y) for dv/dn = sin(pi y), and \
            `flux` the law of other parts a number",
    },
    Limit {
        words: &["robin"],
        wanted: "a flux or an f that depends on v otherwise than by a law",
        instead: "the laws are obstacles, friction and a limit; `reaction` adds c v to the equation",
    },
    Limit {
        words: &[
            "coefficient",
            "material",
            "conductivity",
            "diffusion",
            "permeability",
            "stiffness",
        ],
        wanted: "a coefficient that varies within a region or with the direction",
        instead: "`k` is a positive number on each region of a Gmsh file, as region(core)=5; else=1",
    },
    Limit {
        words: &["elasticity", "young", "poisson"],
        wanted: "elasticity, with a displacement that is a vector",
        instead: "the problem is the scalar one",
    },
    Limit {
        words: &[],
        wanted: "the true solution for every f on every domain",
        instead: "the spectral solver takes straight sides and arcs in the plane, and f of pieces, a polynomial, \
            or a sum of sines, cosines and exponentials of linear functions; on curved boundaries the bounds \
            of elements hold for the polygon",
    },
];

/// Returns the sentence on a word by which something that is not solved is asked for, if it is known.
pub(crate) fn of_word(word: &str) -> Option<String> {
    let word = word.trim_start_matches('-').to_lowercase();
    let limit = LIMITS.iter().find(|limit| limit.words.contains(&&*word))?;
    Some(format!("{} is not solved: {}", limit.wanted, limit.instead))
}
