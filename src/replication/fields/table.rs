//! The table of fields: names, values, and which solvers, domains and other fields they go with.

use super::Fields;
use crate::pipeline::error::Error;
use serde::Deserialize;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::problem::law::LawParameter;
use signorini_mathematics::problem::text::Written;
use signorini_mathematics::solvers::{SOLVERS, SaddleSettings, Solver};
use signorini_mathematics::statement::{Domain, Fineness, Statement};
use toml::Value;

/// Field of a statement.
pub(crate) struct Field {
    /// Name as a key; an option has dashes in place of underscores.
    pub(crate) name: &'static str,
    /// Table of a scene in which the key stands; none at the top.
    pub(crate) table: Option<&'static str>,
    /// Solvers that take it.
    solvers: fn(Solver) -> bool,
    /// Domains that have it.
    pub(super) domains: Domains,
    /// True if another value makes another problem of a scene.
    pub(super) is_of_problem: bool,
    /// Facts that it says, in words: of all fields that say the same, one is given.
    pub(super) says: &'static [&'static str],
    /// True if it is among the fields.
    pub(super) given: fn(&Fields) -> bool,
    /// Value in a statement on a domain that has the field; none where it has none.
    value: fn(&Statement) -> Option<Value>,
}

/// Domains that have a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Domains {
    All,
    Square,
    SquareAndCube,
    /// Domains in the plane, as is seen when the mesh has been read.
    Plane,
    Meshes,
}

impl Domains {
    /// True if a domain is among them, as far as is seen without its mesh.
    fn contain(self, domain: &Domain) -> bool {
        let (is_square, is_cube) = (domain.is_square(), domain.is_cube());
        match self {
            Self::All | Self::Plane => true,
            Self::Square => is_square,
            Self::SquareAndCube => is_square || is_cube,
            Self::Meshes => !is_square,
        }
    }
}

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
    solvers: |_| true,
    domains: Domains::All,
    is_of_problem: false,
    says: &[],
    given: |_| false,
    value: |_| None,
};

/// Fields, in the order in which they are written.
pub(crate) const FIELDS: [Field; 19] = [
    Field {
        name: "f",
        is_of_problem: true,
        given: |of| of.f.is_some(),
        value: |of| Some(of.f.clone().into()),
        ..ANY
    },
    Field {
        name: "domain",
        given: |of| of.domain.name.is_some(),
        value: |of| Some(of.domain.name.clone().into()),
        ..ANY
    },
    Field {
        name: "free",
        given: |of| !of.domain.free.is_empty(),
        value: |of| texts(&of.domain.free),
        ..PART
    },
    Field {
        name: "fixed",
        given: |of| !of.domain.fixed.is_empty(),
        value: |of| texts(&of.domain.fixed),
        ..PART
    },
    Field {
        name: "curve",
        given: |of| !of.domain.curve.is_empty(),
        value: |of| curves(&of.domain),
        ..PART
    },
    Field {
        name: "friction",
        given: |of| of.law.friction.is_some(),
        value: |of| match of.law {
            Some(LawParameter::Friction(g)) => Some(g.into()),
            _ => None,
        },
        ..OF_LAW
    },
    Field {
        name: "limit",
        given: |of| of.law.limit.is_some(),
        value: |of| match of.law {
            Some(LawParameter::Limit(limit)) => Some(limit.into()),
            _ => None,
        },
        ..OF_LAW
    },
    Field {
        name: "solver",
        given: |of| of.solver.is_some(),
        value: |of| Some(of.solver.to_string().into()),
        ..ANY
    },
    Field {
        name: "accuracy",
        given: |of| of.accuracy.is_some(),
        value: |of| match of.fineness {
            Fineness::Within(Accuracy::Error(wanted)) => Some(wanted.into()),
            _ => None,
        },
        ..ACCURACY
    },
    Field {
        name: "accuracy_energy",
        given: |of| of.accuracy_energy.is_some(),
        value: |of| match of.fineness {
            Fineness::Within(Accuracy::Energy(wanted)) => Some(wanted.into()),
            _ => None,
        },
        ..ACCURACY
    },
    Field {
        name: "grids",
        domains: Domains::Square,
        given: |of| of.grids.is_some(),
        value: |of| match &of.fineness {
            Fineness::Grids(cells) => {
                Some(Value::Array(cells.iter().map(|&n| Value::Integer(n as i64)).collect()))
            }
            _ => None,
        },
        ..FINENESS
    },
    Field {
        name: "h",
        domains: Domains::SquareAndCube,
        given: |of| of.h.is_some(),
        value: |of| match of.fineness {
            Fineness::Width(cells) => Some(format!("1/{cells}").into()),
            _ => None,
        },
        ..FINENESS
    },
    Field {
        name: "refine",
        table: Some("domain"),
        domains: Domains::Meshes,
        given: |of| of.domain.refine.is_some(),
        value: |of| match of.fineness {
            Fineness::Refined(times) => Some(i64::from(times).into()),
            _ => None,
        },
        ..FINENESS
    },
    Field {
        name: "load",
        solvers: |solver| solver != Solver::Spectral,
        domains: Domains::Square,
        given: |of| of.load.is_some(),
        value: |of| Some(Value::try_from(of.load?).expect("a rule is a table")),
        ..ANY
    },
    Field {
        name: "r",
        given: |of| of.r.is_some(),
        value: |of| Some(vec![of.saddle?.r].into()),
        ..OF_SADDLE
    },
    Field {
        name: "stop",
        says: &[GOAL],
        given: |of| of.stop.is_some(),
        value: |of| {
            let saddle = of.saddle.filter(|_| of.tolerance.is_none());
            Some(vec![saddle?.stop.name()].into())
        },
        ..OF_SADDLE
    },
    Field {
        name: "max_iterations",
        given: |of| of.max_iterations.is_some(),
        value: |of| Some((of.saddle?.max_iterations as i64).into()),
        ..OF_SADDLE
    },
    Field {
        name: "prolongation",
        domains: Domains::Square,
        given: |of| of.prolongation.is_some(),
        value: |of| Some(of.saddle?.prolongation.name().into()),
        ..OF_SADDLE
    },
    Field {
        name: "tolerance",
        solvers: |solver| solver == Solver::Multigrid || solver.is_nested(),
        says: &[GOAL],
        given: |of| of.tolerance.is_some(),
        value: |of| of.tolerance.map(Value::from),
        ..ANY
    },
];

/// Field about parts of the boundary of a mesh.
const PART: Field =
    Field { table: Some("domain"), domains: Domains::Meshes, is_of_problem: true, ..ANY };
/// Field of the law.
const OF_LAW: Field = Field { table: Some("law"), says: &[LAW], is_of_problem: true, ..ANY };
/// Field that says how fine grids or meshes are.
const FINENESS: Field = Field { says: &[HOW_FINE], ..ANY };
/// Field that asks for an accuracy.
const ACCURACY: Field = Field {
    solvers: |solver| solver == Solver::Multigrid,
    domains: Domains::Plane,
    says: &[HOW_FINE, GOAL],
    ..ANY
};
/// Field of the saddle-point methods.
const OF_SADDLE: Field = Field { solvers: Solver::is_nested, ..ANY };

/// Texts, if there are any.
fn texts(texts: &[String]) -> Option<Value> {
    (!texts.is_empty()).then(|| texts.to_vec().into())
}

/// Curves of parts, as a table.
fn curves(domain: &Domain) -> Option<Value> {
    let table = domain.curve.iter();
    let table = table.map(|(part, numbers)| (part.clone(), numbers.clone().into()));
    (!domain.curve.is_empty()).then(|| Value::Table(table.collect()))
}

/// Returns the field with this name.
pub(crate) fn field(name: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.name == name)
}

impl Field {
    /// Value in a statement that a scene or a command has to name; none if it is the usual one.
    pub(super) fn named(&self, statement: &Statement) -> Option<Value> {
        let usual = self.usual(statement.saddle.is_some());
        self.value_in(statement).filter(|value| Some(value) != usual.as_ref())
    }

    /// Value in a statement; none where it has none.
    pub(super) fn value_in(&self, statement: &Statement) -> Option<Value> {
        self.domains.contain(&statement.domain).then(|| (self.value)(statement)).flatten()
    }

    /// Value in a usual statement on the square, with the settings of a saddle-point method or without.
    pub(super) fn usual(&self, has_saddle: bool) -> Option<Value> {
        let saddle = has_saddle.then(SaddleSettings::default);
        (self.value)(&Statement { saddle, ..Statement::usual(Domain::square(), "") })
    }

    /// Texts as options have them of a value as scenes have it, one for each time that the option is given.
    pub(super) fn options(&self, value: &Value) -> Vec<String> {
        match value {
            Value::Table(table) if self.name == "curve" => {
                let each = table.iter().map(|(part, value)| (part, self.options(value).join(",")));
                each.map(|(part, numbers)| format!("{part}={numbers}")).collect()
            }
            Value::Table(_) => {
                let rule = LoadRule::deserialize(value.clone());
                vec![rule.map_or_else(|_| value.to_string(), |rule| rule.to_string())]
            }
            // Parts have options each.
            Value::Array(values) if values.iter().all(Value::is_str) => {
                values.iter().map(text).collect()
            }
            Value::Array(values) => vec![values.iter().map(text).collect::<Vec<_>>().join(",")],
            value => vec![text(value)],
        }
    }

    /// True if it says how fine grids or meshes are.
    pub(crate) fn is_about_fineness(&self) -> bool {
        self.says.contains(&HOW_FINE)
    }

    /// Values in two statements, as options have them, if they differ; where one has no setting of the solver, none.
    pub(super) fn differing(&self, statements: [&Statement; 2]) -> Option<[String; 2]> {
        let [one, other] = statements.map(|of| match self.value_in(of) {
            None if self.is_of_problem => Some("none".to_owned()),
            value => Some(self.options(&value?).join(" ")),
        });
        let (one, other) = (one?, other?);
        (one != other).then_some([one, other])
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
        match (self, field) {
            (Self::Keys, "load") => format!("load = {{ rule = \"{text}\" }}"),
            (Self::Keys, "stop") => format!("stop = [\"{text}\"]"),
            (Self::Keys, _) => format!("{field} = \"{text}\""),
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
    /// Name of the field.
    pub(crate) field: &'static str,
    /// Sentence, with the remedy.
    pub(crate) text: String,
}

impl Refused {
    pub(crate) fn new(field: &'static str, text: impl Into<String>) -> Self {
        Self { field, text: text.into() }
    }
}

impl From<Refused> for Error {
    fn from(refused: Refused) -> Self {
        Self::input(refused.text)
    }
}

impl Fields {
    /// Refuses fields that do not go with a solver, a domain, each other or a scene.
    pub(super) fn check(&self, voice: Voice, domain: &Domain, solver: Solver) -> Reading<()> {
        for (place, field) in FIELDS.iter().enumerate().filter(|(_, field)| (field.given)(self)) {
            if voice == Voice::OverScene && field.name == "domain" {
                let text = "does not go with a scene, which has its own; leave it out, or give --f in place of the \
                            scene";
                return Err(field.refused(voice, text));
            }
            field.check_domain(voice, domain)?;
            field.check_solver(voice, solver)?;
            let mut before = FIELDS[..place].iter().filter(|other| (other.given)(self));
            let twice = before.find_map(|other| Some((other, field.says_as(other)?)));
            if let Some((other, what)) = twice {
                let text = format!(
                    "and {} both say {what}; leave one of them out",
                    voice.name(other.name)
                );
                return Err(field.refused(voice, &text));
            }
        }
        if self.draw_r.is_some() {
            Field { name: "draw_r", ..OF_SADDLE }.check_solver(voice, solver)?;
        }
        Ok(())
    }

    /// Accuracy among the fields.
    pub(crate) fn accuracy(&self) -> Option<Accuracy> {
        self.accuracy.map(Accuracy::Error).or(self.accuracy_energy.map(Accuracy::Energy))
    }
}

impl Field {
    fn refused(&self, voice: Voice, text: &str) -> Refused {
        Refused::new(self.name, format!("{} {text}", voice.name(self.name)))
    }

    /// Refuses the field on a domain that does not have it.
    fn check_domain(&self, voice: Voice, domain: &Domain) -> Reading<()> {
        let text = match self.domains {
            _ if self.domains.contain(domain) => return Ok(()),
            _ if voice == Voice::OverScene => {
                format!("does not go with the scene's domain, {}; leave it out", domain.name)
            }
            Domains::Square => "is for the square; leave it out, or choose the square".to_owned(),
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
