//! `solve`: one problem, without cache or book.
//!
//! Central is [`solve`]: read the problem, solve, judge, print, write.

mod adapting;
mod answer;
mod bound;
mod clock;
mod files;
mod points;
mod request;
mod save;
pub(super) mod study;

use super::interrupt::at_work;
use super::name_parser;
use super::output::{OutputFile, quoted, say_json, talk, tell};
use crate::figures::Width;
use crate::pipeline::error::{Error, Result};
use crate::replication::fields::Fields;
use crate::replication::fields::lists::{Varied, varied};
use crate::replication::scene::Scene;
use adapting::ShownMeshes;
use answer::Answer;
use clap::{Args, ValueEnum};
use files::{Format, PictureKind};
use points::PointArgs;
use request::Request;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::solvers::Solver;
use signorini_mathematics::statement::Statement;
use std::path::{Path, PathBuf};

/// Heading of the options for what is written.
const FILES: &str = "Files and pictures";

#[derive(Args)]
// That one of them may be missing is for studies of f.
#[command(override_usage = "signorini solve [OPTIONS] <SCENE|--f <F>>")]
pub(super) struct SolveArgs {
    /// A scene of the project
    ///
    /// r is the scene's `draw_r`, the stopping rule its first, all else as the scene says. Each option from --f to
    /// --accuracy-energy, but for --domain, replaces what the scene has.
    #[arg(value_parser = name_parser)]
    scene: Option<String>,
    #[command(flatten)]
    fields: Fields,
    /// Most nodes of a mesh that is refined to an accuracy
    ///
    /// The mesh that is reached with them has the answer. Ctrl-C ends a run to an accuracy in the same way, a
    /// second one at once.
    #[arg(long, value_name = "N", hide_short_help = true)]
    most_nodes: Option<usize>,
    /// A line for each mesh on the way to an accuracy
    #[arg(short, long, hide_short_help = true)]
    verbose: bool,
    #[command(flatten)]
    points: PointArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// A row for each value of an option, or of a $NAME in f
    ///
    /// Several are combined: --vary friction=0.2,0.4 --vary refine=2,3 are four members. FIRST:LAST:STEP is a range of
    /// numbers. Values with commas end with |, as grids=4,8|8,16|. A $NAME is a number. --json prints a line for each
    /// member. One without a solution is a row that says why. With --save NAME, `run NAME` keeps the results, and makes
    /// the table, report/tables/NAME.csv, also in LaTeX, and a chart.
    #[arg(long, value_name = "NAME=A,B,..", value_parser = varied)]
    vary: Vec<Varied>,
    /// Write the table of --vary with all digits
    #[arg(long, help_heading = FILES, value_name = "FILE", hide_short_help = true)]
    csv: Option<PathBuf>,
    /// Write what is asked as a scene, pipeline/scenes/NAME.toml
    ///
    /// `run NAME` then solves the same, keeps the result, and draws it.
    #[arg(long, help_heading = FILES, value_name = "NAME", value_parser = name_parser)]
    save: Option<String>,
    /// Write the solution: .svg .vti .vtu .npz .npy .csv
    ///
    /// An .svg is a picture, .vti and on a mesh .vtu are for ParaView, .npz and .npy for NumPy. An .npz has v,
    /// multiplier and f, on a mesh also region and local_error, an .npy v alone. The multiplier is zero inside and on
    /// fixed and free parts. A .csv has v and its gradient at the points of --at and --line. The ending alone, `vti`,
    /// names the file after the scene. The spectral solver's solution is written at the nodes of --h, or of the mesh of
    /// --refine. A picture is a shaded surface on the square and a map on every other domain in the plane, unless
    /// --map or --surface says otherwise; a solution in space has none.
    #[arg(long, help_heading = FILES, value_name = "FILE")]
    out: Option<PathBuf>,
    /// In an .svg, a map with isolines [default on meshes]
    #[arg(long, help_heading = FILES, requires = "out", conflicts_with_all = ["surface", "mesh"])]
    map: bool,
    /// In an .svg, a shaded surface [default on the square]
    #[arg(long, help_heading = FILES, hide_short_help = true, requires = "out", conflicts_with = "mesh")]
    surface: bool,
    /// In an .svg, the mesh with f in colour, or a coarser one
    #[arg(long, help_heading = FILES, hide_short_help = true, requires = "out")]
    mesh: bool,
    /// In an .svg, width in print, as 85mm, or in pixels
    #[arg(long, help_heading = FILES, value_name = "LENGTH", hide_short_help = true, requires = "out")]
    width: Option<Width>,
    /// In an .svg, no title
    #[arg(long, help_heading = FILES, hide_short_help = true, requires = "out")]
    no_title: bool,
}

impl SolveArgs {
    /// Returns the file to write and its format; if only a format was given, the file in the current folder is named
    /// after the problem.
    fn file(&self, request: &Request, problem: &Problem) -> Result<Option<(OutputFile, Format)>> {
        let Some(out) = self.out.as_deref() else { return Ok(None) };
        let named = out.to_str().filter(|ending| Format::from_str(ending, false).is_ok());
        let name = request.scene.as_deref().unwrap_or("solution");
        let path = named.map_or(out.to_path_buf(), |ending| format!("{name}.{ending}").into());
        let format = Format::of(&path)?;
        format.check(problem, !request.points.is_empty())?;
        let of_pictures = [
            ("--map", self.map),
            ("--surface", self.surface),
            ("--mesh", self.mesh),
            ("--width", self.width.is_some()),
            ("--no-title", self.no_title),
        ];
        if let Some((option, _)) = of_pictures.iter().find(|(_, given)| *given)
            && format != Format::Svg
        {
            return Err(Error::input(format!(
                "{option} is for a picture; let --out end with .svg, or leave {option} out"
            )));
        }
        Ok(Some((OutputFile::check(&path)?, format)))
    }

    /// Refuses arguments without a problem.
    fn check_problem(&self) -> Result<()> {
        let is_there = self.scene.is_some() || self.fields.has("f");
        match is_there || self.vary.iter().any(|list| list.name == "f") {
            true => Ok(()),
            false => Err(Error::input("nothing to solve; give the name of a scene, or --f F")),
        }
    }

    /// Refuses, of a study, options about the file, the points or the meshes of one solution.
    fn refuse_files_of_one(&self) -> Result<()> {
        let given = [
            ("--out", self.out.is_some()),
            ("--at or --line", !self.points.is_empty()),
            ("--most-nodes", self.most_nodes.is_some()),
            ("--verbose", self.verbose),
        ];
        match given.iter().find(|(_, given)| *given) {
            None => Ok(()),
            Some((option, _)) => Err(Error::input(format!(
                "{option} is about one solution, not about a study; leave it out, or write the table by --csv FILE"
            ))),
        }
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

    /// Refuses a number of nodes where no mesh is adapted.
    fn check_most_nodes(&self, statement: &Statement) -> Result<()> {
        match self.most_nodes {
            Some(most) if adapting::of_meshes(statement).is_none() => Err(Error::input(format!(
                "--most-nodes {most} is about an accuracy on a mesh; add --accuracy and --domain, or leave it out"
            ))),
            _ => Ok(()),
        }
    }

    /// Refuses options about the file that is written where there is none.
    fn check_file_options(&self, statement: &Statement) -> Result<()> {
        let Statement { solver, .. } = statement;
        let has_refine = self.fields.has("refine") && self.save.is_none();
        let of_the_file = [
            ("--h", self.fields.has("h") && *solver == Solver::Spectral),
            ("--refine", has_refine && *solver == Solver::Spectral),
        ];
        match of_the_file.iter().find(|(_, given)| *given && self.out.is_none()) {
            None => Ok(()),
            Some((option, _)) => Err(Error::input(format!(
                "{option} is about the file that --out names; add --out FILE"
            ))),
        }
    }
}

/// Returns the scene with this name; whoever names a mesh is told how.
fn named_scene(name: &str) -> Result<Scene> {
    super::scene(name).map_err(|e| match e {
        Error::Unknown(text) if Path::new(name).is_file() => Error::Unknown(format!(
            "{text}; to solve on the mesh of a file, use --domain {}",
            quoted(Path::new(name))
        )),
        other => other,
    })
}

pub(super) fn solve(args: &SolveArgs) -> Result<u8> {
    args.check_problem()?;
    let scene = args.scene.as_deref().map(named_scene).transpose()?;
    if let Some(asked) = study::Asked::read(args, scene.as_ref())? {
        return study::solve(args, &asked);
    }
    let (request, problem) = Request::read(args, scene.as_ref())?;
    let file = args.file(&request, &problem)?;
    if let Some(name) = &args.save {
        save::scene(name, &request, problem.levels().facts().dimension)?.write()?;
    }
    adapting::note(&request.statement, request.voice, &problem).iter().for_each(|note| talk(note));
    let mut shown = ShownMeshes::new(&request.statement, args.verbose);
    // The first signal ends the way to an accuracy with the answer so far.
    let _at_work = adapting::of_meshes(&request.statement).map(|_| at_work());
    let solved = request.solved(problem, &mut shown);
    shown.end();
    let answer = Answer::new(&request, solved?);
    let file = file.filter(|_| !answer.has_diverged());
    let written =
        file.as_ref().map_or(Ok(()), |file| request.write(file, &answer.solved, &answer.values));
    // The answer is not lost with the file.
    if args.json {
        say_json(&answer.json(&request))
    } else {
        let points_in_file = file.as_ref().is_some_and(|(_, format)| *format == Format::Csv);
        tell(&answer.text(&request, points_in_file))
    }?;
    written?;
    if let Some((file, _)) = file.filter(|_| !args.json) {
        tell(&format!("wrote {}\n", file.path().display()))?;
    }
    match answer.failure() {
        None => Ok(0),
        Some(failure) => {
            Err(Error::Stage(vec![format!("{}: {}", request.name, failure.sentence())]))
        }
    }
}
