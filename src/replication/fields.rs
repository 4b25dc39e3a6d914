//! Fields of a statement as users write them: options of `solve`, and keys of a scene.
//!
//! Central is [`Fields`], whose members are both at once: what stands above one is the help of the option, and an
//! underscore of the key is a dash of the option. Which fields go with which solvers, domains and other fields is said
//! in the table [`table::FIELDS`], by which [`read`] turns fields into a statement, and [`write`] statements into
//! fields.

pub(crate) mod described;
pub(crate) mod keys;
pub(crate) mod lists;
pub(crate) mod member;
mod names;
pub(crate) mod read;
pub(crate) mod table;
pub(crate) mod values;
pub(crate) mod vary;
pub(crate) mod write;

use crate::figures::Print;
use crate::replication::output::Output;
use clap::{ArgAction, Args};
use keys::{ChartFields, curves, law, name_or_table, one_number, width};
use serde::Deserialize;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::Solver;
use values::{LoadParser, Suggested, prolongation_parser, solver_parser};
use vary::Vary;

/// Heading of the options that the paper's method has.
const PAPERS: &str = "For the paper's method";

/// Fields about parts of the boundary, by their names.
const PARTS: [&str; 2] = ["free", "fixed"];

/// Fields that are given.
#[derive(Args, Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Fields {
    /// Title of a scene.
    #[arg(skip)]
    pub title: Option<String>,
    /// Number of the published table with which a scene is compared.
    #[arg(skip)]
    pub paper_table: Option<u8>,
    /// The right-hand side, as 'disc(0,0,0.2)=4; else=-1'
    ///
    /// 'formula(3*x*y - 1.1)' is another.
    #[arg(long, allow_negative_numbers = true)]
    pub f: Option<String>,
    #[command(flatten)]
    #[serde(deserialize_with = "name_or_table")]
    pub domain: DomainFields,
    #[command(flatten)]
    #[serde(deserialize_with = "law")]
    pub law: LawFields,
    /// Width of the finest grid, as 1/256 [default: the scene's, or 1/64; on the cube 1/16]
    ///
    /// 0.00390625, and 256 cells per side, are the same width. On a mesh --refine takes its place.
    #[arg(long, value_name = "1/N", allow_negative_numbers = true)]
    #[serde(deserialize_with = "width")]
    pub h: Option<String>,
    /// Cells per side of the grids, as 4,8,16 [default: the scene's, or all of h]
    ///
    /// The grids of the square are nested, the coarsest first.
    #[arg(long, help_heading = PAPERS, value_name = "N,..", hide_short_help = true, value_delimiter = ',', num_args = 1,
        action = ArgAction::Set)]
    pub grids: Option<Vec<usize>>,
    /// Solver [default: the scene's, or multigrid]
    ///
    /// With --r, --stop or --max-iterations the default is arrow-hurwicz, unless the scene's takes them.
    #[arg(long, value_parser = solver_parser())]
    pub solver: Option<Solver>,
    /// Quadrature of the load [default: the scene's, or bilinear]
    ///
    /// With an accuracy it is bilinear.
    #[arg(long, help_heading = PAPERS, hide_short_help = true, value_parser = LoadParser)]
    pub load: Option<LoadRule>,
    /// Duality parameter [default: the scene's, or 10]
    #[arg(long, help_heading = PAPERS, allow_negative_numbers = true, num_args = 1,
        action = ArgAction::Set)]
    pub r: Option<Vec<f64>>,
    /// Stopping rule: signed (of the tables), printed, signed-dual, printed-dual [default: the scene's, or printed]
    #[arg(long, help_heading = PAPERS, value_name = "RULE", hide_short_help = true, hide_possible_values = true,
        num_args = 1,
        action = ArgAction::Set, value_parser = Suggested(StopRule::ALL.map(StopRule::name).to_vec()))]
    pub stop: Option<Vec<String>>,
    /// r whose solution a scene draws.
    #[arg(skip)]
    pub draw_r: Option<f64>,
    /// Most iterations per grid, of Uzawa's method sweeps [default: the scene's, or 1000000]
    #[arg(long, help_heading = PAPERS, value_name = "N", hide_short_help = true,
        value_parser = clap::value_parser!(u64).range(1..))]
    pub max_iterations: Option<u64>,
    /// Value at the centre of a coarse cell on the next grid [default: the scene's, or bilinear]
    #[arg(long, help_heading = PAPERS, value_name = "RULE", hide_short_help = true,
        value_parser = prolongation_parser())]
    pub prolongation: Option<Prolongation>,
    /// KKT residual where multigrid stops [default: rounding floor]
    ///
    /// It is relative to the largest load.
    #[arg(long, value_name = "RESIDUAL", hide_short_help = true, allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// Refine to this guaranteed relative error in the energy norm
    ///
    /// A grid is refined everywhere, a mesh in the plane where its error is large.
    #[arg(long, value_name = "REL", allow_negative_numbers = true)]
    pub accuracy: Option<f64>,
    /// Refine to this guaranteed relative error of the energy
    #[arg(long, value_name = "REL", hide_short_help = true, allow_negative_numbers = true)]
    pub accuracy_energy: Option<f64>,
    /// Outputs of a scene.
    #[arg(skip)]
    pub outputs: Option<Vec<Output>>,
    /// Values of fields, and of names in f, that a scene varies.
    #[arg(skip)]
    pub vary: Option<Vary>,
    /// Width of pictures in print, and whether they have titles.
    #[arg(skip)]
    pub picture: Option<Print>,
    /// Axes of the chart of a study.
    #[arg(skip)]
    pub chart: Option<ChartFields>,
    /// Columns of the table of a study.
    #[arg(skip)]
    pub columns: Option<Vec<String>>,
}

/// Fields of the domain: in a scene its name alone, or a table of them.
#[derive(Args, Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[serde(expecting = "a table such as { name = \"disc\", refine = 4 }")]
pub(crate) struct DomainFields {
    /// Domain: square, cube, disc, lshape, annulus, ball, or a Gmsh file [default: square]
    ///
    /// A file, of formats 2.0 to 4.1, holds triangles or tetrahedra; physical groups name regions, for
    /// `region(name)=value` in --f, in quotes if the name has = or ;, and parts of the boundary. In space f is made of
    /// box(x0,x1,y0,y1,z0,z1), ball(x,y,z,radius) and halfspace(a,b,c,d).
    #[arg(id = "domain", long = "domain", value_name = "NAME|FILE", hide_possible_values = true,
        value_parser = Suggested(AnyMesh::built_in_names()))]
    pub name: Option<String>,
    /// Refinements of the mesh [default: up to 20 000 nodes]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u8).range(0..=20))]
    pub refine: Option<u8>,
    /// Part of the boundary where dv/dn = 0; others are in contact
    #[arg(long, value_name = "PART", hide_short_help = true)]
    pub free: Vec<String>,
    /// Part of the boundary where v = 0
    #[arg(long, value_name = "PART", hide_short_help = true)]
    pub fixed: Vec<String>,
    /// Circle, sphere or cylinder of a part, as hole=0,0,0.3
    ///
    /// Refinement puts new nodes there. A circle is x,y,radius; a sphere x,y,z,radius; a cylinder a point, a direction
    /// and a radius.
    #[arg(long, value_name = "PART=NUMBERS", hide_short_help = true)]
    #[serde(deserialize_with = "curves")]
    pub curve: Vec<String>,
}

/// Fields of the law on the boundary: in a scene a table with one of them.
#[derive(Args, Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[serde(expecting = "a table such as { friction = 0.3 } or { limit = 2.0 }")]
pub(crate) struct LawFields {
    /// Law: |dv/dn| is at most G, and v is 0 where it is less
    #[arg(long, value_name = "G", allow_negative_numbers = true)]
    #[serde(deserialize_with = "one_number")]
    pub friction: Option<f64>,
    /// Law: dv/dn between 0 and LIMIT, and v < 0 where it is LIMIT
    #[arg(long, value_name = "LIMIT", allow_negative_numbers = true, hide_short_help = true)]
    #[serde(deserialize_with = "one_number")]
    pub limit: Option<f64>,
}
