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
mod truth;

use super::output::{OutputFile, say_json, tell};
use super::{Suggested, name_parser, solver_parser};
use crate::pipeline::error::{Error, Result};
use adapting::ShownMeshes;
use answer::Answer;
use clap::builder::PossibleValue;
use clap::{ArgGroup, Args, ValueEnum};
use files::{Format, PictureKind};
use request::Request;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::levels::Levels;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::law::LawParameter;
use signorini_mathematics::problem::source::Tie;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{Solver, recovered};
use std::path::PathBuf;

#[derive(Args)]
#[command(group = ArgGroup::new("problem").required(true).args(["scene", "f"]))]
pub(super) struct SolveArgs {
    /// A scene of the project
    ///
    /// r is the scene's `draw_r`, the stopping rule its first, all else as the scene says.
    #[arg(value_parser = name_parser)]
    scene: Option<String>,
    /// The right-hand side, e.g. 'rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5' or 'formula(3*x*y - 1.1)'
    #[arg(long)]
    f: Option<String>,
    /// Domain: square, cube, disc, lshape, annulus, ball, or a Gmsh file [default: square]
    ///
    /// A file, of formats 2.0 to 4.1, holds triangles or tetrahedra; physical groups name regions, for
    /// `region(name)=value` in --f, in quotes if the name has = or ;, and parts of the boundary. In space f is made of
    /// box(x0,x1,y0,y1,z0,z1), ball(x,y,z,radius) and halfspace(a,b,c,d).
    #[arg(long, value_name = "NAME|FILE", requires = "f", hide_possible_values = true,
        value_parser = Suggested(AnyMesh::built_in_names()), conflicts_with = "scene")]
    domain: Option<String>,
    /// Number of refinements of the mesh [default: up to 20 000 nodes]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u8).range(0..=20))]
    refine: Option<u8>,
    /// Part of the mesh's boundary where dv/dn = 0; the rest is in contact
    #[arg(long, value_name = "PART", hide_short_help = true)]
    free: Vec<String>,
    /// Part of the mesh's boundary where v = 0
    #[arg(long, value_name = "PART", hide_short_help = true)]
    fixed: Vec<String>,
    /// Circle, sphere or cylinder on which a part of the boundary lies, e.g. hole=0,0,0.3
    ///
    /// Refinement puts new nodes there. A circle is x,y,radius; a sphere x,y,z,radius; a cylinder a point, a direction
    /// and a radius.
    #[arg(long, value_name = "PART=NUMBERS", hide_short_help = true)]
    curve: Vec<String>,
    /// Friction on the boundary: |dv/dn| is at most G, and v leaves zero only where it is G
    #[arg(long, value_name = "G", conflicts_with_all = ["limit", "scene"], allow_negative_numbers = true)]
    friction: Option<f64>,
    /// Limited flow: the paper's law, but dv/dn is at most LIMIT, and v < 0 where it is LIMIT
    #[arg(
        long,
        value_name = "LIMIT",
        conflicts_with = "scene",
        allow_negative_numbers = true,
        hide_short_help = true
    )]
    limit: Option<f64>,
    /// Width of the finest grid of the square or the cube, as 1/256 [default: the scene's, or 1/64; on the cube 1/16]
    ///
    /// 0.00390625, and 256 cells per side, are the same width.
    #[arg(long, value_name = "1/N", allow_negative_numbers = true)]
    h: Option<String>,
    /// Solver [default: the scene's, or multigrid]
    ///
    /// With --r, --stop or --max-iterations the default is arrow-hurwicz, unless the scene's takes them.
    #[arg(long, value_parser = solver_parser())]
    solver: Option<Solver>,
    /// Quadrature of the load vector [default: the scene's, or bilinear; with an accuracy: bilinear]
    #[arg(long, value_enum, hide_short_help = true)]
    load: Option<Rule>,
    /// Duality parameter [default: the scene's, or 10]
    #[arg(long, allow_negative_numbers = true)]
    r: Option<f64>,
    /// Stopping rule: signed (as in the tables), printed (as in (13)), signed-dual, printed-dual
    /// [default: the scene's, or printed]
    #[arg(long, value_name = "RULE", hide_short_help = true, hide_possible_values = true,
        value_parser = Suggested(StopRule::ALL.map(StopRule::name).to_vec()))]
    stop: Option<String>,
    /// Cap on iterations per grid; for the Uzawa solvers, on sweeps [default: the scene's, or 1000000]
    #[arg(long, value_name = "N", hide_short_help = true, value_parser = clap::value_parser!(u64).range(1..))]
    max_iterations: Option<u64>,
    /// KKT residual over the largest load at which multigrid stops [default: the rounding floor]
    #[arg(long, value_name = "RESIDUAL", hide_short_help = true, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Guaranteed relative error in the energy norm; chooses the grid by itself, or refines the mesh where it is coarse
    #[arg(long, value_name = "REL", allow_negative_numbers = true,
        conflicts_with_all = ["h", "tolerance"])]
    accuracy: Option<f64>,
    /// Guaranteed relative error of the energy; chooses the grid by itself, or refines the mesh where it is coarse
    #[arg(long, value_name = "REL", hide_short_help = true, allow_negative_numbers = true,
        conflicts_with_all = ["accuracy", "h", "tolerance"])]
    accuracy_energy: Option<f64>,
    /// With an accuracy on a mesh, a line for each mesh: nodes and error
    #[arg(short, long, hide_short_help = true)]
    verbose: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
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
    fn file(&self, request: &Request, levels: &dyn Levels) -> Result<Option<(OutputFile, Format)>> {
        let Some(out) = self.out.as_deref() else { return Ok(None) };
        let named = out.to_str().filter(|ending| Format::from_str(ending, false).is_ok());
        let name = request.scene.as_deref().unwrap_or("solution");
        let path = named.map_or(out.to_path_buf(), |ending| format!("{name}.{ending}").into());
        let format = Format::of(&path)?;
        format.check(levels)?;
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

    /// Returns the law on the boundary, if it is another than the paper's.
    fn law(&self) -> Result<Option<LawParameter>> {
        let (option, value, parameter) = match (self.friction, self.limit) {
            (Some(g), _) => ("--friction", g, LawParameter::Friction(g)),
            (None, Some(limit)) => ("--limit", limit, LawParameter::Limit(limit)),
            (None, None) => return Ok(None),
        };
        match parameter.law() {
            Ok(_) => Ok(Some(parameter)),
            Err(_) => Err(Error::input(format!(
                "{option} {value}: must be a positive number, e.g. {option} 0.3"
            ))),
        }
    }

    fn accuracy(&self) -> Option<Accuracy> {
        let energy = self.accuracy_energy.map(Accuracy::Energy);
        self.accuracy.map(Accuracy::Error).or(energy)
    }

    fn tolerance(&self) -> Result<Option<f64>> {
        match self.tolerance {
            Some(tolerance) if !(tolerance > 0.0 && tolerance.is_finite()) => Err(Error::input(
                format!("--tolerance {tolerance}: must be a positive number, e.g. 1e-8"),
            )),
            tolerance => Ok(tolerance),
        }
    }
}

/// Rule by its name in `--load`, with the default of its settings.
#[derive(Clone, Copy, Debug)]
struct Rule(LoadRule);

impl ValueEnum for Rule {
    fn value_variants<'a>() -> &'a [Self] {
        const DIAGONAL: Diagonal = Diagonal::Rising;
        &[
            Self(LoadRule::Nodal { tie: Tie::LowerLeft, diagonal: Some(DIAGONAL) }),
            Self(LoadRule::Exact { diagonal: DIAGONAL }),
            Self(LoadRule::Bilinear {}),
            Self(LoadRule::LumpedAverage {}),
        ]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, help) = match self.0 {
            LoadRule::Nodal { .. } => {
                ("nodal", "f at the nodes; on a jump from the left and below")
            }
            LoadRule::Exact { .. } => ("exact", "Integrals of f times the hat functions"),
            LoadRule::Bilinear {} => (
                "bilinear",
                "Integrals of f times bilinear hat functions: bounds are closer than with exact",
            ),
            LoadRule::LumpedAverage {} => ("lumped-average", "Mean of f around each node"),
        };
        Some(PossibleValue::new(name).help(help))
    }
}

/// Returns the name of a rule in `--load`.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "a way to show any option of `solve`")]
fn rule_name(rule: &LoadRule) -> String {
    Rule(*rule).to_possible_value().expect("no rule is hidden").get_name().into()
}

pub(super) fn solve(args: &SolveArgs) -> Result<u8> {
    let (request, problem) = Request::read(args)?;
    let file = args.file(&request, problem.levels())?;
    let mut shown = ShownMeshes::new(&request.statement, args.verbose);
    let solved = request.solved(problem, &mut shown);
    shown.end();
    let answer = Answer::new(&request, solved?);
    let written = file.as_ref().map_or(Ok(()), |file| write(args, (&request, &answer), file));
    // The answer is not lost with the file.
    if args.json {
        say_json(&answer.json(&request))
    } else {
        tell(&answer.text(&request, args.recover))
    }?;
    written?;
    if let Some((file, _)) = file.filter(|_| !args.json) {
        tell(&format!("wrote {}\n", file.path().display()))?;
    }
    let refusal = answer.refusal().map(|failure| Error::Stage(vec![failure.sentence()]));
    refusal.map_or(Ok(0), Err)
}

/// Writes the file with an answer, or with its recovered solution.
fn write(
    args: &SolveArgs,
    (request, answer): (&Request, &Answer),
    file: &(OutputFile, Format),
) -> Result<()> {
    let (problem, pair) = (&answer.solved.problem, answer.pair());
    if !args.recover {
        return request.write(file, (problem.levels(), problem.law()), &pair);
    }
    let recovered = recovered(problem, &pair)
        .map_err(|reason| Error::input(format!("--recover: {reason}; leave it out")))?;
    let (finer, pair) =
        recovered.ok_or_else(|| Error::input("--recover is for the square; leave it out"))?;
    request.write(file, (&finer, problem.law()), &pair)
}

/// Reads the cells per side from `1/N`, `N`, or a decimal that is one over an integer.
fn cells(h: &str) -> Result<usize> {
    let whole = h.strip_prefix("1/").unwrap_or(h).parse().ok();
    whole.or_else(|| cells_of_width(h.parse().ok()?)).filter(|n| *n > 0).ok_or_else(|| {
        Error::input(format!("--h {h}: write the width as 1/N, such as 1/256, or as N"))
    })
}

/// Returns one over the width if that is an integer.
fn cells_of_width(width: f64) -> Option<usize> {
    let n = (1.0 / width).round();
    (width > 0.0 && n * width == 1.0).then_some(n as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_read_and_refused() {
        assert_eq!(cells("1/256").unwrap(), 256);
        assert_eq!(cells("0.25").unwrap(), 4);
        assert_eq!(cells("128").unwrap(), 128);
        for wrong in
            ["2/3", "0.3", "-0.25", "nan", "1/x", "x", "0", "1/0", "", "99999999999999999999"]
        {
            assert!(cells(wrong).is_err(), "{wrong}");
        }
    }
}
