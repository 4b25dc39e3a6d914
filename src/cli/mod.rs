//! The command line: what there is to say, and which function says it.

mod diff;
mod identify;
mod interrupt;
mod pipeline;
mod solve;

use crate::error::{Error, Result};
use clap::{Args, CommandFactory, Parser, Subcommand};
use std::io::{self, ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Replicates N. N. Maksimova's study of the semicoercive scalar Signorini problem.
///
/// Without a command, runs the full replication: solves both problems, tabulates, compares with the
/// published tables, draws the figures and builds the book. What is up to date is not run again.
#[derive(Parser)]
#[command(
    name = "signorini",
    version,
    args_conflicts_with_subcommands = true,
    max_term_width = 100,
    after_help = "Examples:\n  \
        signorini                         the whole paper; then open report/book/index.html\n  \
        signorini diff                    our tables against the published ones\n  \
        signorini run problem1 -n         what a run of one scene would do\n  \
        signorini solve --f 'rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1' --h 1/128\n\n\
        Exit codes: 0 done, 1 stale or outside tolerance, 2 wrong input, 3 a stage failed, 130 interrupted."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    run: pipeline::RunArgs,
}

/// Where the cache is.
#[derive(Args, Clone, Debug)]
struct CacheArgs {
    /// Cache folder [default: .signorini in the project]
    #[arg(long, value_name = "DIR")]
    cache_dir: Option<PathBuf>,
}

#[derive(Subcommand)]
enum Command {
    /// Run the replication, or single scenes of it
    #[command(after_help = "Examples:\n  signorini run                     everything\n  \
        signorini run problem1            what concerns one scene alone: its cells, tables, comparison\n  \
        signorini run --only figures      the figures, and what they need\n  \
        signorini run --locked            fail if anything differs from pipeline/lock.toml")]
    Run(pipeline::RunArgs),
    /// Show what is up to date and what is stale, stage by stage
    #[command(after_help = "Example:\n  signorini status --exit-code || signorini run")]
    Status(pipeline::StatusArgs),
    /// Tell why a stage or task would run: each input that changed, old -> new
    #[command(
        after_help = "Examples:\n  signorini explain report\n  signorini explain solve/problem1"
    )]
    Explain(pipeline::ExplainArgs),
    /// Print the graph of tasks
    #[command(after_help = "Example:\n  signorini dag --dot | dot -Tsvg > dag.svg")]
    Dag(pipeline::DagArgs),
    /// Compare our tables with the published ones, cell by cell
    #[command(
        after_help = "Exits with 1 if a cell is outside the tolerance declared in pipeline/paper.toml.\n\
        Examples:\n  signorini diff\n  signorini diff --md > tables.md"
    )]
    Diff(diff::DiffArgs),
    /// Solve one problem once
    #[command(after_help = "Examples:\n  signorini solve problem2 --json\n  \
        signorini solve --f 'quadrant(ll)=3; else=-1.1' --h 1/256 --stop printed --out v.vti\n  \
        signorini solve --f 'disc(0,0,0.25)=2; else=-1' --out v.npy\n  \
        signorini solve --cube 'ball(0,0,0,0.25)=2; else=-1' --h 1/128 --out v.vti\n\n\
        f is a list of `region=value` and one `else=value`, separated by `;`; the last region that covers\n\
        a point wins. Regions: rect(x0,x1,y0,y1), quadrant(ll|lr|ul|ur), halfplane(a,b,c) for ax+by<=c,\n\
        disc(x,y,radius). The square is [-0.5,0.5]^2. exact(NAME) is a problem with known solution:\n\
        full-contact, torsion, free-segment, free-corner.\n\
        On the cube the regions are box(x0,x1,y0,y1,z0,z1) and ball(x,y,z,radius), the known solutions\n\
        full-contact, free-strip, free-disc.")]
    Solve(solve::SolveArgs),
    /// Search for the right-hand sides of the lost Figure 1 that give the published tables
    #[command(after_help = identify::EXAMPLES)]
    Identify(identify::IdentifyArgs),
    /// Build the book, and open it with --open
    Report(pipeline::ReportArgs),
    /// Remove from the cache what no scene needs any more
    Gc(pipeline::GcArgs),
    /// Print a completion script for a shell
    #[command(
        after_help = "Example:\n  signorini completions bash > ~/.local/share/bash-completion/completions/signorini"
    )]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

/// Parses the arguments, runs the command, reports an error in one line, and returns the exit code.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(e) => {
            // Help and version come this way too, and go to standard output.
            let _ = e.print();
            return ExitCode::from(if e.use_stderr() { 2 } else { 0 });
        }
    };
    match dispatch(cli) {
        Ok(code) => ExitCode::from(code),
        Err(e) => {
            // The exit code still tells if nobody reads this.
            let _ =
                writeln!(anstream::stderr(), "{}: {e}", styled("error", anstyle::AnsiColor::Red));
            ExitCode::from(e.exit_code())
        }
    }
}

fn dispatch(cli: Cli) -> Result<u8> {
    match cli.command.unwrap_or(Command::Run(cli.run)) {
        Command::Run(args) => pipeline::run(&args),
        Command::Status(args) => pipeline::status(&args),
        Command::Explain(args) => pipeline::explain(&args),
        Command::Dag(args) => pipeline::dag(&args),
        Command::Diff(args) => diff::diff(&args),
        Command::Solve(args) => solve::solve(&args),
        Command::Identify(args) => identify::identify(&args),
        Command::Report(args) => pipeline::report(&args),
        Command::Gc(args) => pipeline::gc(&args),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "signorini", &mut script);
            say(&String::from_utf8_lossy(&script))
        }
    }
}

/// Writes data to standard output; a reader that has gone away is no error.
fn say(text: &str) -> Result<u8> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(0),
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(0),
        Err(e) => Err(Error::input(format!(
            "cannot write to standard output: {e}; redirect it elsewhere"
        ))),
    }
}

fn say_json(value: &impl serde::Serialize) -> Result<u8> {
    let text = serde_json::to_string_pretty(value).expect("answers are plain data");
    say(&(text + "\n"))
}

fn styled(text: &str, color: anstyle::AnsiColor) -> String {
    let style = anstyle::Style::new().fg_color(Some(color.into())).bold();
    format!("{style}{text}{style:#}")
}

fn current_folder() -> Result<PathBuf> {
    let found: io::Result<PathBuf> = std::env::current_dir();
    found.map_err(|e| Error::input(format!("the current folder is gone ({e}); change to another")))
}
