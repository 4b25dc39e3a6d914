//! `solve`: one problem, without cache or book.
//!
//! Central is [`solve`]: read the problem, solve, judge, print, write.

mod adapting;
mod advice;
mod answer;
mod bound;
mod clock;
mod files;
mod judging;
mod request;
mod save;
mod spectral;

use super::name_parser;
use super::output::{OutputFile, check_options, say_json, tell};
use crate::pipeline::error::{Error, Result};
use crate::replication::accuracy::{of_grid, reach};
use crate::replication::fields::Fields;
use adapting::ShownMeshes;
use answer::Answer;
use clap::{ArgGroup, Args, ValueEnum};
use clock::Part;
use files::{Format, PictureKind};
use request::Request;
use serde_json::Value;
use signorini_mathematics::bounds::{Accuracy, recovery};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::transfer::prolong_boundary;
use signorini_mathematics::levels::Lattices;
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::solvers::Solver;
use signorini_mathematics::statement::Statement;
use std::path::PathBuf;

#[derive(Args)]
#[command(group = ArgGroup::new("problem").required(true).args(["scene", "f"]))]
pub(super) struct SolveArgs {
    /// A scene of the project
    ///
    /// r is the scene's `draw_r`, the stopping rule its first, all else as the scene says.
    #[arg(value_parser = name_parser)]
    scene: Option<String>,
    #[command(flatten)]
    fields: Fields,
    /// With an accuracy on a mesh, a line for each mesh: nodes and error
    #[arg(short, long, hide_short_help = true)]
    verbose: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write what is asked as a scene of the project, pipeline/scenes/NAME.toml
    ///
    /// `run NAME` then solves the same, keeps the result, and draws it.
    #[arg(long, value_name = "NAME", value_parser = name_parser)]
    save: Option<String>,
    /// Write the solution: .vti, on a mesh .vtu, for ParaView, .npz or .npy for NumPy, .svg for a picture
    ///
    /// An .npz has v, multiplier and f, on a mesh also region and local_error, an .npy v alone. The ending alone,
    /// `vti`, names the file after the scene. The spectral solver's solution is written at the nodes of --h. A picture
    /// is a shaded surface on the square and a map on every other domain in the plane, unless --map or --surface says
    /// otherwise; a solution in space has none.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// With --out FILE.svg, draw a map: v in colour with isolines, the boundary in contact red [default on meshes]
    #[arg(long, requires = "out", conflicts_with_all = ["surface", "mesh"])]
    map: bool,
    /// With --out FILE.svg, draw a shaded surface [default on the square]
    #[arg(long, hide_short_help = true, requires = "out", conflicts_with = "mesh")]
    surface: bool,
    /// With --out FILE.svg, draw the mesh with f in colour, on fine meshes a coarser one
    #[arg(long, hide_short_help = true, requires = "out")]
    mesh: bool,
    /// With --out, write the recovered solution, piecewise quadratic, on half the width
    #[arg(long, hide_short_help = true)]
    recover: bool,
}

impl SolveArgs {
    /// Returns the file to write and its format; if only a format was given, the file in the current folder is named
    /// after the problem.
    fn file(&self, request: &Request) -> Result<Option<(OutputFile, Format)>> {
        let Some(out) = self.out.as_deref() else { return Ok(None) };
        let named = out.to_str().filter(|ending| Format::from_str(ending, false).is_ok());
        let name = request.scene.as_deref().unwrap_or("solution");
        let path = named.map_or(out.to_path_buf(), |ending| format!("{name}.{ending}").into());
        let format = Format::of(&path)?;
        format.check(request.problem.levels())?;
        if self.view().is_some() && format != Format::Svg {
            let option = match (self.map, self.surface) {
                (true, _) => "--map",
                (_, true) => "--surface",
                _ => "--mesh",
            };
            return Err(Error::input(format!(
                "{option} is for a picture; let --out end with .svg, or leave {option} out"
            )));
        }
        Ok(Some((OutputFile::check(&path)?, format)))
    }

    /// Returns the kind of picture, if the user says which.
    fn view(&self) -> Option<PictureKind> {
        let kinds = [
            (self.map, PictureKind::Map),
            (self.surface, PictureKind::Surface),
            (self.mesh, PictureKind::Mesh),
        ];
        kinds.into_iter().find(|(given, _)| *given).map(|(_, kind)| kind)
    }

    /// Refuses options about the file that is written where there is none, or that a solver or a domain does not have.
    fn check_file_options(&self, statement: &Statement) -> Result<()> {
        let Statement { solver, domain, .. } = statement;
        let of_the_file = [
            ("--recover", self.recover),
            ("--h", self.fields.h.is_some() && *solver == Solver::Spectral),
        ];
        check_options("--solver", *solver, &[("--recover", self.recover, &Solver::ON_GRIDS)])?;
        if self.recover && !domain.is_square() {
            return Err(Error::input(
                "--recover is for the square; leave it out, or solve on the square",
            ));
        }
        match of_the_file.iter().find(|(_, given)| *given && self.out.is_none()) {
            None => Ok(()),
            Some((option, _)) => Err(Error::input(format!(
                "{option} is about the file that --out names; add --out FILE"
            ))),
        }
    }

    /// Prints an answer, then tells of the file that was written with it; the answer is not lost with the file.
    fn show(
        &self,
        json: impl FnOnce() -> Value,
        text: impl FnOnce() -> String,
        (file, written): (Option<(OutputFile, Format)>, Result<()>),
    ) -> Result<u8> {
        if self.json { say_json(&json()) } else { tell(&text()) }?;
        written?;
        match file.filter(|_| !self.json) {
            Some((file, _)) => tell(&format!("wrote {}\n", file.path().display())),
            None => Ok(0),
        }
    }
}

pub(super) fn solve(args: &SolveArgs) -> Result<u8> {
    let mut request = Request::read(args)?;
    let file = args.file(&request)?;
    if let Some(name) = &args.save {
        save::save(name, &request)?;
    }
    if request.solver() == Solver::Spectral {
        let answer = spectral::answer(&request)?;
        let written = file.as_ref().map_or(Ok(()), |file| answer.write(&request, file));
        let (json, text) = (|| answer.json(&request), || answer.text(&request));
        return args.show(json, text, (file, written));
    }
    let answer = match request.accuracy() {
        Some(accuracy) if request.problem.lattices().is_none() => {
            adapted_answer(&mut request, accuracy, args.verbose)?
        }
        Some(accuracy) => answer_to(&mut request, accuracy)?,
        None => answer(&request)?,
    };
    let pair = &answer.pair;
    let written = file.as_ref().map_or(Ok(()), |file| match args.recover {
        true => recovered(&request, pair)
            .and_then(|(lattices, pair)| request.write(file, &lattices, &pair)),
        false => request.write(file, request.problem.levels(), pair),
    });
    let (json, text) = (|| answer.json(&request), || answer.text(&request, args.recover));
    args.show(json, text, (file, written))?;
    let refusal = answer.refusal().map(|failure| Error::Stage(vec![failure.sentence()]));
    refusal.map_or(Ok(0), Err)
}

/// Solves and judges.
fn answer(request: &Request) -> Result<Answer> {
    // The load vector is made when it is first read.
    request.problem.load();
    request.clock.ended(Part::Load);
    let run = request.run()?;
    request.clock.ended(Part::Solver);
    let bounds = request.problem.bounds(&run.y);
    Ok(Answer::new(request, run, bounds))
}

/// Solves on adapted meshes until the guaranteed bound is small enough, and judges.
fn adapted_answer(request: &mut Request, accuracy: Accuracy, verbose: bool) -> Result<Answer> {
    let mut shown = ShownMeshes::new(accuracy, verbose);
    let found = request.adapt(accuracy, &mut |mesh| shown.show(mesh));
    shown.end();
    let (run, bounds) = found?;
    let mut answer = Answer::new(request, run, Ok(bounds));
    answer.judge_end(request, accuracy);
    Ok(answer)
}

/// Solves on one grid of the square after the other until the guaranteed bound is small enough.
fn answer_to(request: &mut Request, accuracy: Accuracy) -> Result<Answer> {
    let (mut last, mut ends, voice) = (None, Vec::new(), request.voice);
    reach(accuracy, voice, |cells| {
        request.set_grid(cells)?;
        let mut answer = answer(request)?;
        ends.append(&mut answer.run.ends);
        let bounds = of_grid(accuracy, voice, answer.bounds.clone())?;
        let bounds = answer.failure.is_none().then_some(bounds);
        last = Some(answer);
        Ok(bounds)
    })?;
    let mut answer = last.expect("at least one grid is tried");
    answer.run.ends = ends;
    Ok(answer)
}

/// Returns the recovered solution, on the grid of half the width.
fn recovered(request: &Request, pair: &Pair) -> Result<(Lattices, Pair)> {
    let (lattices, law) = (request.lattices("--recover")?, request.problem.law());
    let (y, _) = recovery(lattices.finest(), lattices.source(), law, &pair.y)
        .map_err(|reason| Error::input(format!("--recover: {reason}; leave it out")))?;
    let grid = Grid::new(2 * lattices.finest().cells()).map_err(|e| Error::input(e.to_string()))?;
    let finer = Lattices::new(vec![grid], lattices.source().clone(), lattices.rule());
    Ok((finer, Pair { y, a: prolong_boundary(&pair.a) }))
}
