//! The gallery: maps of problems of all kinds, each with the one command that makes it and three numbers.

use super::{drawing, id, made};
use crate::figures::SolutionMap;
use crate::pipeline::error::Failure;
use crate::pipeline::{InputFile, InputFiles, Inputs, Made, Task};
use crate::replication::mesh_files;
use crate::replication::project::Project;
use crate::replication::stages::artifact;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::problem::law::{Law, LawParameter};
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::solvers::{self, Run, Settings, Solver};
use signorini_mathematics::spectral::{TrueSolution, true_solution};
use signorini_mathematics::statement::{Domain, Fineness, Statement};

/// Problem of the gallery, with what `solve` is told of it.
struct Shown {
    name: &'static str,
    title: &'static str,
    f: &'static str,
    /// Nested grids of the square, by their cells per side.
    grids: &'static [usize],
    /// Domain with its number of refinements; none for the square.
    mesh: Option<(&'static str, u8)>,
    /// Options about parts of the boundary, each with its value.
    parts: &'static [(&'static str, &'static str)],
    law: Option<LawParameter>,
    solver: Solver,
}

/// Problem on the square under the paper's law, by multigrid; the others differ in what they name.
const PLAIN: Shown = Shown {
    name: "",
    title: "",
    f: "",
    // As `solve` has them.
    grids: &[4, 8, 16, 32, 64],
    mesh: None,
    parts: &[],
    law: None,
    solver: Solver::Multigrid,
};

/// Mesh from a file, as a path in the project.
const GEAR: &str = "pipeline/meshes/gear.msh";

/// Problems of the gallery, in its order.
const GALLERY: [Shown; 8] = [
    Shown {
        name: "gallery-source",
        title: "A round source in the square",
        f: "disc(0.1,0.1,0.25)=5; else=-1.5",
        ..PLAIN
    },
    Shown {
        name: "gallery-regions",
        title: "Sources and sinks of every shape",
        f: "quadrant(ur)=1; halfplane(1,1,-0.3)=-6; rect(-0.42,-0.12,-0.05,0.38)=4; disc(0.2,-0.1,0.18)=6; else=-1",
        ..PLAIN
    },
    Shown {
        name: "gallery-lshape",
        title: "The L-shape, with its re-entrant corner",
        f: "rect(-1,0,-1,0)=3; else=-2",
        mesh: Some(("lshape", 5)),
        ..PLAIN
    },
    Shown {
        name: "gallery-annulus",
        title: "An annulus whose inner circle is held at zero",
        f: "halfplane(1,0,0)=3; else=-3",
        mesh: Some(("annulus", 4)),
        parts: &[("--fixed", "inner")],
        ..PLAIN
    },
    Shown {
        name: "gallery-gear",
        title: "A gear from Gmsh, its hole free",
        f: "disc(0.5,0.3,0.4)=4; else=-1.5",
        mesh: Some((GEAR, 2)),
        parts: &[("--free", "hole"), ("--curve", "hole=0,0,0.3")],
        ..PLAIN
    },
    Shown {
        name: "gallery-friction",
        title: "Friction: up on one side, down on the other",
        f: "halfplane(1,1,0)=8; else=-8",
        law: Some(LawParameter::Friction(1.5)),
        ..PLAIN
    },
    Shown {
        name: "gallery-limit",
        title: "A disc that lets at most a given flow in",
        f: "rect(-1,0,-1,0)=-6; else=1",
        mesh: Some(("disc", 5)),
        law: Some(LawParameter::Limit(2.0)),
        ..PLAIN
    },
    Shown {
        name: "gallery-truth",
        title: "Problem 2 of the paper, solved to rounding",
        f: "quadrant(ll)=-6; else=1.998",
        solver: Solver::Spectral,
        // The values at the nodes take longer than the solution.
        grids: &[4, 8, 16, 32],
        ..PLAIN
    },
];

/// Most columns of a command on the page.
const WIDTH: usize = 86;

/// Columns of the table beside a picture.
const COLUMNS: [&str; 3] = ["energy", "error", "held"];

/// Solution of a problem of the gallery.
struct SolvedPicture {
    pair: Pair,
    energy: f64,
    /// Guaranteed bound of the error in the energy norm over the size of the solution; of a true solution, the
    /// difference of the energy at two resolutions over the latter.
    error: f64,
    /// Share of the boundary under the law on which v is held at zero.
    held: f64,
}

impl Shown {
    /// Command that solves the problem and draws the picture, as the words between which a line of it may end. A long f
    /// is broken behind its semicolons.
    fn command(&self) -> Vec<String> {
        let quote = if self.f.len() < WIDTH - 40 { '\'' } else { '"' };
        let f = format!("--f {quote}{}{quote}", self.f);
        let mut words: Vec<String> = vec!["solve".into()];
        match quote {
            '"' => words.extend(f.split_inclusive("; ").map(|part| part.trim_end().to_owned())),
            _ => words.push(f),
        }
        if let Some((domain, refine)) = self.mesh {
            words.extend([format!("--domain {domain}"), format!("--refine {refine}")]);
        }
        if let Some(finest) = self.grids.last().filter(|_| self.grids != PLAIN.grids) {
            words.push(format!("--h 1/{finest}"));
        }
        words.extend(self.parts.iter().map(|(option, value)| format!("{option} {value}")));
        match self.law {
            Some(LawParameter::Friction(g)) => words.push(format!("--friction {g}")),
            Some(LawParameter::Limit(limit)) => words.push(format!("--limit {limit}")),
            None => {}
        }
        if self.solver != Solver::Multigrid {
            words.push(format!("--solver {}", self.solver));
        }
        words.extend(["--map".into(), format!("--out target/{}.svg", self.name)]);
        words
    }

    /// Lines of the command for a shell, behind those words.
    fn lines(&self, first: &str) -> String {
        let mut lines = vec![first.to_owned()];
        for word in self.command() {
            let last = lines.len() - 1;
            if lines[last].len() + word.len() + " \\".len() < WIDTH {
                lines[last] += &format!(" {word}");
            } else {
                lines.push(format!("    {word}"));
            }
        }
        lines.join(" \\\n")
    }

    /// What the command asks.
    fn stated(&self) -> Result<Statement, Failure> {
        let all = |wanted: &str| {
            let parts = self.parts.iter().filter(|(option, _)| *option == wanted);
            parts.map(|(_, part)| (*part).to_owned()).collect()
        };
        let name = self.mesh.map_or("square", |(name, _)| name);
        let mut domain = Domain {
            free: all("--free"),
            fixed: all("--fixed"),
            ..Domain::named(name.trim_start_matches("pipeline/"))
        };
        for (part, numbers) in self.parts.iter().filter_map(|(_, value)| value.split_once('=')) {
            let numbers = numbers.split(',').map(str::parse).collect::<Result<_, _>>();
            domain.curve.insert(part.into(), numbers.map_err(|_| "a curve has numbers")?);
        }
        let fineness = match self.mesh {
            Some((_, times)) => Fineness::Refined(times),
            None => Fineness::Grids(self.grids.to_vec()),
        };
        Ok(Statement { law: self.law, fineness, ..Statement::usual(domain, self.f) })
    }

    fn solve(&self, stated: &Statement, problem: &Problem) -> Result<SolvedPicture, Failure> {
        if self.solver == Solver::Spectral {
            return self.solve_truly(stated, problem);
        }
        let run = solvers::solve(problem, &Settings::of(self.solver));
        let Run { y, ends, judgement, .. } = run.map_err(|e| format!("{}: {e}", self.name))?;
        let bounds = problem.bounds(&y).map_err(|e| format!("{}: {e}", self.name))?;
        let energy = ends.last().map_or(f64::NAN, |end| end.energy);
        let pair = Pair { a: judgement.multiplier(&y), y };
        let held = held(problem, &pair);
        Ok(SolvedPicture { pair, energy, error: bounds.relative(), held })
    }

    /// Solves on the square without a grid, and evaluates the solution at the nodes of the finest grid.
    fn solve_truly(&self, stated: &Statement, problem: &Problem) -> Result<SolvedPicture, Failure> {
        let (f, finest) = (stated.source()?, *self.grids.last().ok_or("no grid")?);
        let finest = Grid::new(finest)?;
        let found = true_solution(problem.law(), &f).map_err(|e| format!("{}: {e}", self.name))?;
        let TrueSolution { solution, .. } = found;
        let pair = solution.on_grid(finest);
        let held = held(problem, &pair);
        let error = solution.checks.resolution.map_or(f64::NAN, f64::abs);
        Ok(SolvedPicture { pair, energy: solution.energy, error, held })
    }
}

/// Returns the share of the boundary under the law on which v is held at zero.
fn held(problem: &Problem, pair: &Pair) -> f64 {
    let (levels, mut held, mut all) = (problem.levels(), 0.0, 0.0);
    let states = levels.in_contact(problem.law(), pair);
    for (node, is_held) in levels.contact().iter().zip(states) {
        all += node.measure;
        held += if is_held { node.measure } else { 0.0 };
    }
    held / all
}

/// Picture of the gallery, by the name of its problem there; title and command are said for `explain`.
#[derive(Serialize, Deserialize)]
struct GalleryPicture {
    name: String,
    title: String,
    command: String,
}

/// The tasks that draw the gallery; a picture whose mesh the project lacks is left out.
pub(super) fn tasks(project: &Project) -> Vec<Task> {
    let mut tasks = Vec::new();
    for shown in &GALLERY {
        let mut files = InputFiles::new();
        if let Some((GEAR, _)) = shown.mesh {
            // A scene may have the mesh too.
            let known = project.files.get(GEAR).cloned();
            let path = project.root.join(GEAR);
            let Some(file) = known.or_else(|| path.is_file().then(|| InputFile::new(path))) else {
                continue;
            };
            files.insert(GEAR.into(), file);
        }
        let picture = GalleryPicture {
            name: shown.name.into(),
            title: shown.title.into(),
            // `explain` prints changed parameters in a line each.
            command: shown.command().join(" "),
        };
        tasks.push(drawing(shown.name, &picture, Vec::new(), draw).with_files(files));
    }
    tasks
}

/// Solves a problem of the gallery and draws its map.
fn draw(picture: &GalleryPicture, inputs: &Inputs) -> Made {
    let mut gallery = GALLERY.iter();
    let shown = gallery.find(|shown| shown.name == picture.name).ok_or("not in the gallery")?;
    let stated = shown.stated()?;
    let problem = mesh_files::problem(&stated, inputs.files)?;
    let SolvedPicture { pair, energy, error, held } = shown.solve(&stated, &problem)?;
    let on = (problem.levels(), problem.law());
    // As `solve` has it.
    let file = stated.domain.name.rsplit('/').next().filter(|_| stated.domain.is_file());
    let title = file.map_or_else(|| problem.levels().f(), str::to_owned);
    let mut drawn = SolutionMap::of(title, on, &pair)?.picture();
    drawn.table = Some(format!("{}\n{energy},{error},{held}\n", COLUMNS.join(",")));
    made(inputs, &picture.title, drawn)
}

/// Returns the pictures of the gallery that were made, each with its command and its numbers, for the templates.
pub(in crate::replication::stages) fn shown(inputs: &Inputs) -> Result<Vec<Value>, Failure> {
    let mut all = Vec::new();
    for shown in &GALLERY {
        let Ok(table) = artifact(inputs, &id(shown.name), &format!("{}.csv", shown.name)) else {
            continue;
        };
        let row = std::str::from_utf8(table)?.lines().nth(1).unwrap_or_default();
        let numbers = row.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>();
        let [energy, error, held] = numbers.map_err(|e| format!("{}: {e}", shown.name))?[..] else {
            return Err(format!("{}: not three numbers", shown.name).into());
        };
        let law = LawParameter::law_or_papers(shown.law).map_err(|e| e.to_string())?;
        all.push(json!({
            "name": shown.name,
            "title": shown.title,
            "command": shown.lines("cargo run --release --"),
            "energy": energy,
            "error": error,
            "held": held,
            "is_papers_law": law == Law::SIGNORINI,
            "is_true": shown.solver == Solver::Spectral,
        }));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_lines_that_fit_their_box_and_state_the_same_f() {
        for shown in &GALLERY {
            let lines = shown.lines("cargo run --release --");
            assert!(lines.lines().all(|line| line.len() <= WIDTH), "{lines}");
            // What a shell makes of it.
            let words: Vec<_> =
                lines.replace("\\\n", "").split_whitespace().map(str::to_owned).collect();
            assert!(
                words.join(" ").replace('"', "'").contains(&format!("--f '{}' -", shown.f)),
                "{lines}"
            );
        }
    }
}
