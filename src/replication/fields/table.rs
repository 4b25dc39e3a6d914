//! The table of fields: names, values, and which solvers, domains and other fields they go with.

use super::parts::{names as names_in, one_line, said, texts_of_law, under};
use super::{Fields, PAPERS};
use crate::pipeline::error::Error;
use clap::builder::PossibleValue;
use serde::Deserialize;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::law::LawNumber;
use signorini_mathematics::problem::text::Written;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{SOLVERS, SaddleSettings, Solver};
use signorini_mathematics::statement::{Domain, Fineness, Statement};
use std::collections::BTreeMap;
use std::str::FromStr;
use toml::Value;

/// Field of a statement.
pub(crate) struct Field {
    /// Name as a key; an option has dashes in place of underscores.
    pub(crate) name: &'static str,
    /// Table of a scene in which the key stands; none at the top.
    pub(crate) table: Option<&'static str>,
    /// Meaning of its numbers in the laws on the boundary; such a key stands in the table of the boundary too.
    pub(super) law: Option<LawNumber>,
    /// Help of the option, and what the manual page has besides.
    pub(super) help: &'static str,
    pub(super) more: &'static str,
    /// Name of the value of the option in its help.
    pub(super) value_name: &'static str,
    /// Heading in the help.
    pub(super) heading: Option<&'static str>,
    /// True if the short help leaves the option out.
    pub(super) is_rare: bool,
    /// True if the option may be given several times.
    pub(super) is_list: bool,
    /// Values that shells suggest.
    pub(super) suggested: fn() -> Vec<PossibleValue>,
    /// Solvers that take it.
    solvers: fn(Solver) -> bool,
    /// Domains that have it.
    pub(super) domains: Domains,
    /// True if another value makes another problem of a scene.
    pub(crate) is_of_problem: bool,
    /// Facts that it says, in words: of all fields that say the same, one is given.
    pub(super) says: &'static [&'static str],
    /// Value in a statement on a domain that has the field, in texts as options have it; none where it has none.
    texts: fn(&Statement) -> Vec<String>,
    /// Statement with the value that texts say; the reason if they say none.
    pub(super) set: fn(Statement, &[String]) -> Result<Statement, String>,
}

/// Domains that have a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Domains {
    All,
    /// The square, where it has grids.
    Grids,
    SquareAndCube,
    /// Domains in the plane, as is seen when the mesh has been read.
    Plane,
    Meshes,
}

impl Domains {
    /// True if the domain of a statement is among them, as far as is seen without its mesh.
    fn contain(self, of: &Statement) -> bool {
        let (is_square, is_cube) = (of.domain.is_square(), of.domain.is_cube());
        match self {
            Self::All | Self::Plane => true,
            Self::Grids => of.has_grids(),
            Self::SquareAndCube => is_square || is_cube,
            Self::Meshes => !is_square,
        }
    }
}

/// Table of a scene with what holds on each part of the boundary.
pub(crate) const BOUNDARY: &str = "boundary";
/// Folder of the project from which scenes name their meshes.
pub(crate) const FOLDER: &str = "pipeline";

/// Way in which fields are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Voice {
    /// As options of `solve`.
    Options,
    /// As options of `solve` beside the name of a scene.
    OverScene,
    /// As keys of a scene.
    Keys,
}

/// Facts that several fields say.
const HOW_FINE: &str = "how fine";
const LAW: &str = "which law holds";
const GOAL: &str = "where the solver stops";

/// Field for all solvers on all domains, which an option may change.
const ANY: Field = Field {
    name: "",
    table: None,
    law: None,
    help: "",
    more: "",
    value_name: "",
    heading: None,
    is_rare: false,
    is_list: false,
    suggested: Vec::new,
    solvers: |_| true,
    domains: Domains::All,
    is_of_problem: false,
    says: &[],
    texts: |_| Vec::new(),
    set: |of, _| Ok(of),
};

/// Fields, in the order in which they are written.
pub(crate) static FIELDS: [Field; 25] = [
    Field {
        name: "f",
        help: "The right-hand side, as 'disc(0,0,0.2)=4; else=-1'",
        more: "'formula(3*x*y - 1.1)' is another.",
        value_name: "F",
        is_of_problem: true,
        texts: |of| vec![of.f.clone()],
        set: |of, given| Ok(Statement { f: given.concat(), ..of }),
        ..ANY
    },
    Field {
        name: "domain",
        help: "Domain: square, cube, disc, lshape, annulus, ball, or a Gmsh file [default: square]",
        more: "A file, of formats 2.0 to 4.1, holds triangles or tetrahedra; physical groups name regions, for \
            `region(name)=value` in --f, in quotes if the name has = or ;, and parts of the boundary. In space f is \
            made of box(x0,x1,y0,y1,z0,z1), ball(x,y,z,radius) and halfspace(a,b,c,d).",
        value_name: "NAME|FILE",
        suggested: || AnyMesh::built_in_names().into_iter().map(PossibleValue::new).collect(),
        texts: |of| vec![of.domain.name.clone()],
        set: |of, given| {
            let domain = Domain { name: given.concat(), ..of.domain };
            Ok(Statement { domain, ..of })
        },
        ..ANY
    },
    Field {
        name: "free",
        help: "Part of the boundary with dv/dn = FLUX [default: 0]; others are in contact",
        more: "A formula is a flux too, as in left=sin(pi*y).",
        value_name: "PART[=FLUX]",
        law: Some(LawNumber::Free),
        texts: |of| texts_of_law(of, LawNumber::Free),
        set: |of, given| under(of, LawNumber::Free, given),
        ..PART
    },
    Field {
        name: "fixed",
        help: "Part of the boundary with v = VALUE [default: 0]",
        more: "A formula is a value too, as in top=0.1*x.",
        value_name: "PART[=VALUE]",
        law: Some(LawNumber::Fixed),
        texts: |of| texts_of_law(of, LawNumber::Fixed),
        set: |of, given| under(of, LawNumber::Fixed, given),
        ..PART
    },
    Field {
        name: "curve",
        help: "Circle, sphere or cylinder of a part, as hole=0,0,0.3",
        more: "Refinement puts new nodes there. A circle is x,y,radius; a sphere x,y,z,radius; a cylinder a point, a \
            direction and a radius.",
        value_name: "PART=NUMBERS",
        domains: Domains::Meshes,
        texts: |of| of.domain.curve.iter().map(curve_in_words).collect(),
        set: |of, given| {
            let domain = Domain { curve: curves(given)?, ..of.domain };
            Ok(Statement { domain, ..of })
        },
        ..PART
    },
    Field {
        name: "friction",
        help: "Law: |dv/dn| is at most G, and v sticks at the gap, 0, where it is less",
        more: "With PART=G, as hole=0.3, it holds on this part alone.",
        value_name: "[PART=]G",
        law: Some(LawNumber::Friction),
        texts: |of| texts_of_law(of, LawNumber::Friction),
        set: |of, given| under(of, LawNumber::Friction, given),
        ..OF_LAW
    },
    Field {
        name: "limit",
        help: "Law: dv/dn between 0 and LIMIT, and v below the gap, 0, where it is LIMIT",
        more: "With PART=LIMIT, as hole=2, it holds on this part alone.",
        value_name: "[PART=]LIMIT",
        is_rare: true,
        law: Some(LawNumber::Limit),
        texts: |of| texts_of_law(of, LawNumber::Limit),
        set: |of, given| under(of, LawNumber::Limit, given),
        ..OF_LAW
    },
    Field {
        name: "below",
        help: "Law of a part: v is at most VALUE [default: 0], and dv/dn at most 0",
        value_name: "PART[=VALUE]",
        is_rare: true,
        law: Some(LawNumber::Below),
        texts: |of| texts_of_law(of, LawNumber::Below),
        set: |of, given| under(of, LawNumber::Below, given),
        ..OF_LAW
    },
    Field {
        name: "gap",
        help: "v is at least GAP; under friction or a limit it sticks at GAP [default: 0]",
        more: "With PART=GAP, as bottom=0.1, it holds on this part alone. A formula as 0.1*x is a gap too.",
        value_name: "[PART=]GAP",
        law: Some(LawNumber::Gap),
        says: &[],
        texts: |of| texts_of_law(of, LawNumber::Gap),
        set: |of, given| under(of, LawNumber::Gap, given),
        ..OF_LAW
    },
    Field {
        name: "flux",
        help: "dv/dn is FLUX off contact, and no less in contact [default: 0]",
        more: "With PART=FLUX, as outer=-1, it holds on this part alone; with --below it is no more in contact.",
        value_name: "[PART=]FLUX",
        is_rare: true,
        law: Some(LawNumber::Flux),
        says: &[],
        texts: |of| texts_of_law(of, LawNumber::Flux),
        set: |of, given| under(of, LawNumber::Flux, given),
        ..OF_LAW
    },
    Field {
        name: "k",
        help: "Factor of the flux k grad v, as 2 or 'region(core)=5; else=1' [default: 1]",
        more: "It is a positive number on each region of a Gmsh file.",
        value_name: "K",
        is_of_problem: true,
        solvers: |solver| solver != Solver::Spectral,
        texts: |of| of.k.iter().cloned().collect(),
        set: |of, given| Ok(Statement { k: Some(one_line(&given.concat())), ..of }),
        ..ANY
    },
    Field {
        name: "reaction",
        help: "Factor C of a term C v of the equation, 0 or positive [default: 0]",
        value_name: "C",
        is_of_problem: true,
        solvers: |solver| solver != Solver::Spectral,
        texts: |of| vec![Written(of.reaction.unwrap_or_default()).to_string()],
        set: |of, given| {
            let number = read(given).filter(|Written(number)| *number >= 0.0);
            let Written(number) = number.ok_or("must be 0 or a positive number, e.g. 4")?;
            Ok(Statement { reaction: Some(number).filter(|number| *number > 0.0), ..of })
        },
        ..ANY
    },
    Field {
        name: "solver",
        help: "Solver [default: the scene's, or multigrid]",
        more: "With --r, --stop or --max-iterations the default is arrow-hurwicz, unless the scene's takes them.",
        value_name: "SOLVER",
        suggested: || SOLVERS.map(|of| PossibleValue::new(of.name).help(of.description)).to_vec(),
        texts: |of| vec![of.solver.to_string()],
        set: |of, given| {
            Ok(Statement { solver: named(given, Solver::named, &SOLVERS.map(|of| of.name))?, ..of })
        },
        ..ANY
    },
    Field {
        name: "accuracy",
        help: "Refine to this guaranteed relative error in the energy norm",
        more: "A grid is refined everywhere, a mesh in the plane where its error is large.",
        texts: |of| texts_of_fineness(of, "accuracy"),
        set: |of, given| {
            Ok(within(
                of,
                Accuracy::Error(share(given, "1e-3 for an error of 0.1 % in the energy norm")?),
            ))
        },
        ..ACCURACY
    },
    Field {
        name: "accuracy_energy",
        help: "Refine to this guaranteed relative error of the energy",
        is_rare: true,
        texts: |of| texts_of_fineness(of, "accuracy_energy"),
        set: |of, given| {
            Ok(within(of, Accuracy::Energy(share(given, "1e-6 for six digits of the energy")?)))
        },
        ..ACCURACY
    },
    Field {
        name: "grids",
        help: "Cells per side of the grids, as 4,8,16 [default: the scene's, or all of h]",
        more: "The grids of the square are nested, the coarsest first.",
        value_name: "N,..",
        heading: Some(PAPERS),
        is_rare: true,
        domains: Domains::Grids,
        texts: |of| texts_of_fineness(of, "grids"),
        set: |of, given| Ok(Statement { fineness: Fineness::Grids(grids(given)?), ..of }),
        ..FINENESS
    },
    Field {
        name: "h",
        help: "Width of the finest grid, as 1/256 [default: the scene's, or 1/64; on the cube 1/16]",
        more: "0.00390625, and 256 cells per side, are the same width. On a mesh --refine takes its place.",
        value_name: "1/N",
        domains: Domains::SquareAndCube,
        texts: |of| texts_of_fineness(of, "h"),
        set: |of, given| {
            let finest = cells(&given.concat());
            let finest = finest.ok_or("write the width as 1/N, such as 1/256, or as N")?;
            let fineness = match &of.fineness {
                Fineness::Grids(_) => of.fineness.with_finest(finest),
                _ => Fineness::Width(finest),
            };
            Ok(Statement { fineness, ..of })
        },
        ..FINENESS
    },
    Field {
        name: "refine",
        table: Some("domain"),
        help: "Refinements of the mesh [default: up to 20 000 nodes]",
        value_name: "K",
        domains: Domains::Meshes,
        texts: |of| texts_of_fineness(of, "refine"),
        set: |of, given| {
            let times = read(given).filter(|times| *times <= MOST_REFINEMENTS);
            let times = times.ok_or("write a whole number from 0 to 20")?;
            Ok(Statement { fineness: Fineness::Refined(times), ..of })
        },
        ..FINENESS
    },
    Field {
        name: "load",
        help: "Quadrature of the load [default: the scene's, or bilinear]",
        more: "With an accuracy it is bilinear.",
        value_name: "LOAD",
        heading: Some(PAPERS),
        is_rare: true,
        suggested: || {
            LoadRule::ALL.map(|of| PossibleValue::new(of.name()).help(of.description())).to_vec()
        },
        solvers: |solver| solver != Solver::Spectral,
        domains: Domains::Grids,
        texts: |of| of.load.iter().map(LoadRule::to_string).collect(),
        set: |of, given| Ok(Statement { load: Some(given.concat().parse()?), ..of }),
        ..ANY
    },
    Field {
        name: "r",
        help: "Duality parameter [default: the scene's, or 10]",
        value_name: "R",
        texts: |of| of.saddle.iter().map(|of| Written(of.r).to_string()).collect(),
        set: |of, given| {
            // The name of a task shows it without an exponent.
            let r = read(given).filter(|Written(r)| (1e-12..=1e12).contains(r));
            let Written(r) = r.ok_or(
                "must be a positive number from 1e-12 to 1e12; the paper takes 0.5 to 1e6",
            )?;
            Ok(by_saddle(of, |saddle| SaddleSettings { r, ..saddle }))
        },
        ..OF_SADDLE
    },
    Field {
        name: "stop",
        help: "Stopping rule: signed (of the tables), printed, signed-dual, printed-dual [default: the scene's, or \
            printed]",
        value_name: "RULE",
        is_rare: true,
        suggested: || StopRule::ALL.map(|rule| PossibleValue::new(rule.name())).to_vec(),
        says: &[GOAL],
        texts: |of| {
            let saddle = of.saddle.filter(|_| of.tolerance.is_none());
            saddle.iter().map(|of| of.stop.to_string()).collect()
        },
        set: |of, given| {
            let stop = named(given, StopRule::named, &StopRule::ALL.map(StopRule::name))?;
            let of = Statement { tolerance: None, ..of };
            Ok(by_saddle(of, |saddle| SaddleSettings { stop, ..saddle }))
        },
        ..OF_SADDLE
    },
    Field {
        name: "max_iterations",
        help: "Most iterations per grid, of Uzawa's method sweeps [default: the scene's, or 1000000]",
        value_name: "N",
        is_rare: true,
        texts: |of| of.saddle.iter().map(|of| of.max_iterations.to_string()).collect(),
        set: |of, given| {
            let most = read(given).filter(|most| *most > 0);
            let max_iterations = most.ok_or("must be a whole number, at least 1")?;
            Ok(by_saddle(of, |saddle| SaddleSettings { max_iterations, ..saddle }))
        },
        ..OF_SADDLE
    },
    Field {
        name: "prolongation",
        help: "Value at the centre of a coarse cell on the next grid [default: the scene's, or bilinear]",
        value_name: "RULE",
        is_rare: true,
        suggested: || Prolongation::ALL.map(|rule| PossibleValue::new(rule.name())).to_vec(),
        domains: Domains::Grids,
        texts: |of| of.saddle.iter().map(|of| of.prolongation.name().to_owned()).collect(),
        set: |of, given| {
            let all = Prolongation::ALL.map(Prolongation::name);
            let prolongation = named(given, Prolongation::named, &all)?;
            Ok(by_saddle(of, |saddle| SaddleSettings { prolongation, ..saddle }))
        },
        ..OF_SADDLE
    },
    Field {
        name: "tolerance",
        help: "KKT residual where the solver stops [default: rounding floor, or --stop]",
        more: "It is relative to the largest load.",
        value_name: "RESIDUAL",
        is_rare: true,
        solvers: |solver| solver == Solver::Multigrid || solver.is_nested(),
        says: &[GOAL],
        texts: |of| of.tolerance.map(|of| Written(of).to_string()).into_iter().collect(),
        set: |of, given| {
            // The accuracy of a scene says otherwise where the solver stops.
            let fineness = without_accuracy(of.fineness);
            Ok(Statement { tolerance: Some(positive(given, "1e-8")?), fineness, ..of })
        },
        ..ANY
    },
    Field {
        name: "compare",
        help: "Compare the energy with that of the true solution: spectral",
        more: "It is found once for all members of a study with the same domain, f and law.",
        value_name: "SOLVER",
        is_rare: true,
        suggested: || vec![PossibleValue::new(Solver::Spectral.entry().name)],
        domains: Domains::Plane,
        texts: |of| of.with_truth.then(|| Solver::Spectral.to_string()).into_iter().collect(),
        set: |of, given| match Solver::named(&given.concat()) {
            Some(Solver::Spectral) => Ok(Statement { with_truth: true, ..of }),
            _ => Err("spectral alone finds true solutions; write spectral".into()),
        },
        ..ANY
    },
];

/// Most refinements of a mesh.
const MOST_REFINEMENTS: u8 = 20;

/// Field about parts of the boundary of a mesh.
const PART: Field = Field {
    table: Some("domain"),
    value_name: "PART",
    is_rare: true,
    is_list: true,
    is_of_problem: true,
    ..ANY
};
/// Field of the law.
const OF_LAW: Field =
    Field { table: Some("law"), says: &[LAW], is_of_problem: true, is_list: true, ..ANY };
/// Field that says how fine grids or meshes are.
const FINENESS: Field = Field { says: &[HOW_FINE], ..ANY };
/// Field that asks for an accuracy.
const ACCURACY: Field = Field {
    value_name: "REL",
    solvers: |solver| solver == Solver::Multigrid,
    domains: Domains::Plane,
    says: &[HOW_FINE, GOAL],
    ..ANY
};
/// Field of the saddle-point methods.
const OF_SADDLE: Field = Field { heading: Some(PAPERS), solvers: Solver::is_nested, ..ANY };

/// The statement by a saddle-point method with other settings.
fn by_saddle(of: Statement, other: impl FnOnce(SaddleSettings) -> SaddleSettings) -> Statement {
    Statement { saddle: Some(other(of.saddle.unwrap_or_default())), ..of }
}

/// The statement with an accuracy, which concerns the solution for f, whatever load a scene takes; with the bilinear
/// one bounds are closest.
fn within(of: Statement, accuracy: Accuracy) -> Statement {
    let (fineness, load) = (Fineness::Within(accuracy), of.load.map(|_| Statement::LOAD));
    Statement { fineness, load, tolerance: None, ..of }
}

/// The usual fineness in place of an accuracy.
pub(super) fn without_accuracy(fineness: Fineness) -> Fineness {
    if matches!(fineness, Fineness::Within(_)) { Fineness::Usual } else { fineness }
}

/// Texts of the fineness, if the field of this name states it.
fn texts_of_fineness(of: &Statement, name: &str) -> Vec<String> {
    let fineness = Some(&of.fineness).filter(|of| **of != Fineness::Usual && of.field() == name);
    fineness.into_iter().map(Fineness::to_string).collect()
}

/// Text of the curve of a part.
fn curve_in_words((part, numbers): (&String, &Vec<f64>)) -> String {
    let numbers: Vec<_> = numbers.iter().map(|&number| Written(number).to_string()).collect();
    format!("{part}={}", numbers.join(","))
}

/// Reads the text that is given.
fn read<T: FromStr>(given: &[String]) -> Option<T> {
    given.concat().trim().parse().ok()
}

/// Reads a choice by its name.
fn named<T>(given: &[String], of_name: fn(&str) -> Option<T>, all: &[&str]) -> Result<T, String> {
    of_name(&given.concat()).ok_or_else(|| format!("choose one of {}", all.join(", ")))
}

/// Reads a positive number, of which there is an example.
fn positive(given: &[String], example: &str) -> Result<f64, String> {
    let number = read(given).filter(|Written(number)| *number > 0.0);
    let number = number.ok_or_else(|| format!("must be a positive number, e.g. {example}"));
    number.map(|Written(number)| number)
}

/// Reads a number between 0 and 1, of which there is an example.
fn share(given: &[String], example: &str) -> Result<f64, String> {
    let number = positive(given, example).ok().filter(|number| *number < 1.0);
    number.ok_or_else(|| format!("must be between 0 and 1, e.g. {example}"))
}

/// Reads the cells per side of grids.
fn grids(given: &[String]) -> Result<Vec<usize>, &'static str> {
    let cells = given.iter().flat_map(|text| text.split(',')).map(|n| n.trim().parse().ok());
    cells.collect::<Option<_>>().ok_or("write numbers of cells, as 4,8,16")
}

/// Reads the curves of parts, each as `PART=NUMBERS`.
fn curves(given: &[String]) -> Result<BTreeMap<String, Vec<f64>>, String> {
    let mut curves = BTreeMap::new();
    for text in given {
        // A name may have the sign.
        let read = text.rsplit_once('=').and_then(|(part, numbers)| {
            let numbers = numbers.split(',').map(|number| number.trim().parse().ok());
            Some((part.trim().to_owned(), numbers.collect::<Option<_>>()?))
        });
        let (part, numbers) = read.ok_or(
            "write PART=NUMBERS, e.g. hole=0,0,0.3 for a circle of radius 0.3 around (0, 0)",
        )?;
        if curves.insert(part, numbers).is_some() {
            return Err("the part has one already; name it once".into());
        }
    }
    Ok(curves)
}

/// Reads the cells per side from `1/N`, `N`, or a decimal that is one over an integer.
fn cells(h: &str) -> Option<usize> {
    let whole = h.strip_prefix("1/").unwrap_or(h).parse().ok();
    whole.or_else(|| cells_of_width(h.parse().ok()?)).filter(|n| *n > 0)
}

/// Returns the integer whose reciprocal is the width, or is nearest to it.
fn cells_of_width(width: f64) -> Option<usize> {
    let n = (1.0 / width).round();
    (width > 0.0 && (n * width == 1.0 || 1.0 / n == width)).then_some(n as usize)
}

/// Returns the field with this name.
pub(crate) fn field(name: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.name == name)
}

impl Field {
    /// Value in a statement that a scene or a command has to name; none if it is the usual one.
    pub(crate) fn named(&self, statement: &Statement) -> Option<Vec<String>> {
        let usual = self.usual(statement.saddle.is_some());
        self.value_in(statement).filter(|texts| *texts != usual)
    }

    /// Value in a statement, in texts as options have it; none where it has none.
    pub(super) fn value_in(&self, statement: &Statement) -> Option<Vec<String>> {
        let has_it = self.domains.contain(statement);
        has_it.then(|| (self.texts)(statement)).filter(|texts| !texts.is_empty())
    }

    /// Value in a usual statement on the square, with the settings of a saddle-point method or without.
    pub(super) fn usual(&self, has_saddle: bool) -> Vec<String> {
        let saddle = has_saddle.then(SaddleSettings::default);
        (self.texts)(&Statement { saddle, ..Statement::usual(Domain::square(), "") })
    }

    /// Value as scenes have it.
    pub(super) fn toml(&self, texts: &[String]) -> Value {
        match texts {
            [text] if self.table == Some("law") => toml(text),
            _ if self.is_list => texts.to_vec().into(),
            _ => toml(&texts.concat()),
        }
    }

    /// Texts as options have them of a value as scenes have it.
    ///
    /// # Errors
    /// [`Refused`] for a table that says no value.
    pub(super) fn read(&self, value: &Value) -> Reading<Vec<String>> {
        Ok(match value {
            Value::Table(_) if self.name == "load" => {
                let rule = LoadRule::deserialize(value.clone());
                let rule =
                    rule.map_err(|e| Refused::new(self.name, format!("`load`: {}", e.message())))?;
                vec![rule.to_string()]
            }
            Value::Table(table) if self.is_list || !table.is_empty() => {
                let each = table.iter().map(|(part, value)| format!("{part}={}", listed(value)));
                each.collect()
            }
            Value::Array(values) if self.is_list => values.iter().map(text).collect(),
            value => vec![listed(value)],
        })
    }

    /// True if it says how fine grids or meshes are.
    pub(crate) fn is_about_fineness(&self) -> bool {
        self.says.contains(&HOW_FINE)
    }

    /// Values in two statements, as options have them, if they differ; where one has no setting of the solver, none.
    pub(super) fn differing(&self, statements: [&Statement; 2]) -> Option<[String; 2]> {
        let [one, other] = statements.map(|of| match self.value_in(of) {
            None if self.is_of_problem => Some("none".to_owned()),
            value => Some(value?.join(" ")),
        });
        let (one, other) = (one?, other?);
        (one != other).then_some([one, other])
    }

    /// The part that is named in a text of a law, and its number, if both are.
    pub(super) fn part_and_number<'a>(&self, text: &'a str) -> Option<(&'a str, &'a str)> {
        let (part, number) = said(self.law?, text);
        number.filter(|_| !part.is_empty()).map(|number| (part, number))
    }

    /// The part in a text of a law, empty for all that are not named, with its number, if names stand in that.
    pub(super) fn named_in<'a>(&self, text: &'a str) -> Option<(&'a str, &'a str)> {
        let (part, number) = said(self.law?, text);
        number.filter(|number| names_in(number).next().is_some()).map(|number| (part, number))
    }

    /// True if it decides which others may be given.
    pub(super) fn decides_others(&self) -> bool {
        ["domain", "k", "reaction", "solver"].contains(&self.name) || self.law.is_some()
    }

    /// True if the key may stand in this table of a scene.
    pub(super) fn stands_in(&self, table: &str) -> bool {
        self.table == Some(table) || table == BOUNDARY && self.law.is_some()
    }

    /// Fact that both this field and another say with these texts; none if they go together.
    fn says_twice(&self, texts: &[String], (other, others): (&Field, &[String])) -> Option<String> {
        let laws = self.law.zip(other.law).filter(|(law, other)| law.is_law() && other.is_law());
        let Some((law, other_law)) = laws else { return self.says_as(other).map(str::to_owned) };
        let mut others = others.iter().map(|text| said(other_law, text).0);
        let part = others.find(|part| texts.iter().any(|text| said(law, text).0 == *part))?;
        Some(if part.is_empty() { LAW.into() } else { format!("{LAW} on {part}") })
    }

    /// Fact that both this field and another say; none if they go together.
    pub(super) fn says_as(&self, other: &Field) -> Option<&'static str> {
        self.says.iter().find(|what| other.says.contains(what)).copied()
    }

    /// Key, behind the name of its table and a dot.
    pub(super) fn key(&self) -> String {
        self.table.map_or(self.name.to_owned(), |table| format!("{table}.{}", self.name))
    }

    /// Name as an option, with its dashes.
    pub(super) fn option(&self) -> String {
        format!("--{}", self.name.replace('_', "-"))
    }
}

/// Returns a value of a scene that is read as this text: a number, a list of whole numbers, or the text.
pub(super) fn toml(of: &str) -> Value {
    let list: Option<Vec<i64>> = of.split(',').map(|number| number.parse().ok()).collect();
    let value = match (list.as_deref(), of.parse()) {
        (Some(&[number]), _) => Value::Integer(number),
        (Some(numbers), _) => numbers.to_vec().into(),
        (None, Ok(number)) => Value::Float(number),
        (None, Err(_)) => of.into(),
    };
    if listed(&value) == of { value } else { of.into() }
}

/// Returns a value or a list of numbers as an option has it.
fn listed(value: &Value) -> String {
    match value {
        Value::Array(values) => values.iter().map(text).collect::<Vec<_>>().join(","),
        value => text(value),
    }
}

/// Returns a single value as an option has it.
pub(crate) fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => Written(*number).to_string(),
        value => value.to_string(),
    }
}

impl Voice {
    /// Name of a field.
    pub(crate) fn name(self, field: &str) -> String {
        match self {
            Self::Keys => format!("`{field}`"),
            Self::Options | Self::OverScene => format!("--{}", field.replace('_', "-")),
        }
    }

    /// Field with its value.
    pub(crate) fn with_value(self, field: &str, value: &str) -> String {
        match self {
            Self::Keys => format!("{field} = {value}"),
            Self::Options | Self::OverScene => format!("{} {value}", self.name(field)),
        }
    }

    /// Field with a text as its value, as it is to be written.
    pub(crate) fn with_text(self, field: &str, text: &str) -> String {
        match self {
            Self::Keys => format!("{field} = \"{text}\""),
            _ => self.with_value(field, text),
        }
    }

    /// An accuracy, as the user wrote it.
    pub(crate) fn accuracy(self, accuracy: Accuracy) -> String {
        let field = match accuracy {
            Accuracy::Error(_) => "accuracy",
            Accuracy::Energy(_) => "accuracy_energy",
        };
        self.with_value(field, &format!("{:?}", accuracy.wanted()))
    }
}

/// Result of reading fields.
pub(crate) type Reading<T> = Result<T, Refused>;

/// Refusal of a field.
#[derive(Debug)]
pub(crate) struct Refused {
    /// Name of the field, or of another key.
    pub(crate) field: String,
    /// Sentence, with the remedy.
    pub(crate) text: String,
}

impl Refused {
    pub(crate) fn new(field: &str, text: impl Into<String>) -> Self {
        Self { field: field.to_owned(), text: text.into() }
    }
}

impl From<Refused> for Error {
    fn from(refused: Refused) -> Self {
        Self::input(refused.text)
    }
}

impl Fields {
    /// Refuses fields that do not go with the solver, the domain and the laws of a statement, each other or a scene.
    pub(super) fn check(&self, voice: Voice, of: &Statement) -> Reading<()> {
        for (place, field) in FIELDS.iter().enumerate().filter(|(_, field)| self.has(field.name)) {
            if voice == Voice::OverScene && field.name == "domain" {
                let text = "does not go with a scene, which has its own; leave it out, or give --f in place of the \
                            scene";
                return Err(field.refused(voice, text));
            }
            let is_of_mesh = field.table == Some("domain") && field.domains == Domains::Meshes;
            if voice == Voice::Keys && is_of_mesh && !self.has("domain") {
                let text =
                    "missing field `name` of `domain`, which has no meshes without it; add it";
                return Err(Refused::new("domain", text));
            }
            field.check_domain(voice, of)?;
            field.check_solver(voice, of.solver)?;
            let mut before = FIELDS[..place].iter().filter(|of| self.has(of.name));
            let twice = before.find_map(|other| {
                let others = (other, self.texts(other.name));
                Some((other, field.says_twice(self.texts(field.name), others)?))
            });
            if let Some((other, what)) = twice {
                let text = format!(
                    "and {} both say {what}; leave one of them out",
                    voice.name(other.name)
                );
                return Err(field.refused(voice, &text));
            }
        }
        Ok(())
    }
}

impl Field {
    fn refused(&self, voice: Voice, text: &str) -> Refused {
        Refused::new(self.name, format!("{} {text}", voice.name(self.name)))
    }

    /// Refuses the field on a domain that does not have it.
    fn check_domain(&self, voice: Voice, of: &Statement) -> Reading<()> {
        let domain = &of.domain;
        let text = match self.domains {
            _ if self.domains.contain(of) => return Ok(()),
            Domains::Grids if domain.is_square() => {
                "is about grids, and with k, a reaction or laws of its sides the square has a mesh; leave it out"
                    .to_owned()
            }
            _ if voice == Voice::OverScene => {
                format!("does not go with the scene's domain, {}; leave it out", domain.name)
            }
            Domains::Grids => "is for the square; leave it out, or choose the square".to_owned(),
            Domains::SquareAndCube => {
                let refine = voice.with_value("refine", "K");
                format!("is for the square and the cube; refine {} with {refine}", domain.name)
            }
            Domains::Meshes | Domains::All | Domains::Plane => {
                format!("is about a mesh; add {}, or leave it out", voice.name("domain"))
            }
        };
        Err(self.refused(voice, &text))
    }

    /// True for a setting of some solvers.
    pub(crate) fn is_of_solver(&self) -> bool {
        !SOLVERS.iter().all(|entry| (self.solvers)(entry.solver))
    }

    /// Solvers that take the field, and those that do not.
    pub(super) fn takers(&self) -> [Vec<Solver>; 2] {
        let (takers, others) =
            SOLVERS.iter().map(|entry| entry.solver).partition(|&solver| (self.solvers)(solver));
        [takers, others]
    }

    /// Refuses the field with a solver that does not take it.
    fn check_solver(&self, voice: Voice, solver: Solver) -> Reading<()> {
        if (self.solvers)(solver) {
            return Ok(());
        }
        let [takers, _] = self.takers();
        let (takers, field) = (names(&takers), voice.name("solver"));
        let text = format!("is for {takers}, not for {solver}; leave it out, or change {field}");
        Err(self.refused(voice, &text))
    }
}

/// Names of solvers, in a sentence.
pub(super) fn names(solvers: &[Solver]) -> String {
    solvers.iter().map(Solver::to_string).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_read_and_refused() {
        assert_eq!(cells("1/256"), Some(256));
        assert_eq!(cells("0.25"), Some(4));
        assert_eq!(cells("128"), Some(128));
        for n in 1..2000 {
            let width = (1.0 / n as f64).to_string();
            assert_eq!(cells(&width), Some(n));
        }
        for wrong in
            ["2/3", "0.3", "-0.25", "nan", "1/x", "x", "0", "1/0", "", "99999999999999999999"]
        {
            assert!(cells(wrong).is_none(), "{wrong}");
        }
    }
}
