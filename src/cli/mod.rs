//! Command line: commands and options, the function of each command, errors and exit codes.
//!
//! Central is [`main`].

mod bench;
mod certificate;
mod dag;
mod diff;
mod gc;
mod help;
mod identify;
mod init;
mod interrupt;
mod list;
mod man;
mod output;
mod pipeline;
mod report;
mod run;
mod shown;
mod solve;
mod status;

use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::{composed, shortened};
use crate::replication::limits;
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use crate::timing::machine;
use clap::builder::Resettable;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use output::{say, styled, talk};
use std::convert::Infallible;
use std::panic::PanicHookInfo;
use std::path::PathBuf;
use std::process::ExitCode;

/// Columns of help, in a terminal as wide or wider and in the book.
const HELP_WIDTH: usize = 90;

/// Replicates N. N. Maksimova's study of the semicoercive scalar Signorini problem.
///
/// Without a command, runs the full replication: solves both problems, tabulates, compares with the
/// published tables, draws the figures and builds the book. What is up to date is not run again.
#[derive(Parser)]
#[command(
    name = "signorini",
    version,
    args_conflicts_with_subcommands = true,
    // As shells expand an alias that has the option already.
    args_override_self = true,
    disable_help_subcommand = true,
    max_term_width = HELP_WIDTH,
    after_help = "`--help` shows all options, examples and exit codes.",
    after_long_help = "Examples:\n  \
        signorini                         the whole paper; then open report/book/index.html\n  \
        signorini diff                    our tables against the published ones\n  \
        signorini run problem1 -n         what a run of one scene would do\n  \
        signorini solve --f 'rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5' --h 1/128\n\n\
        Exit codes: 0 done, 1 stale or outside tolerance, 2 wrong input, 3 a task failed or an answer is not what \
        `solve` was asked for, 130 interrupted."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    run: run::RunArgs,
}

/// Folder of the cache.
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
        signorini run problem1            what concerns one scene alone\n  \
        signorini run --only figures      the figures, and what they need\n  \
        signorini run --locked            fail if anything differs from pipeline/lock.toml\n  \
        signorini run --task diff/problem1  one task, beside others at work")]
    Run(run::RunArgs),
    /// Show what is up to date and what is stale, stage by stage
    #[command(
        after_help = "Lines are cut at the width of the terminal, or at COLUMNS. `signorini run -n` also says \
        whether what is stale can be run.\n\
        Example:\n  signorini status --exit-code || signorini run"
    )]
    Status(status::StatusArgs),
    /// Tell why a stage or task would run: each input that changed, old -> new
    #[command(
        after_help = "Examples:\n  signorini explain report\n  signorini explain solve/problem1"
    )]
    Explain(status::ExplainArgs),
    /// Print the graph of tasks, to look at or as a workflow for Snakemake
    #[command(after_help = dag::EXAMPLES)]
    Dag(dag::DagArgs),
    /// Compare our tables with the published ones, cell by cell
    #[command(
        after_help = "Exits with 1 if a cell is outside the tolerance declared in pipeline/paper.toml.\n\
        Examples:\n  signorini diff\n  signorini diff --md > tables.md\n  \
        signorini diff --tex > tables.tex"
    )]
    Diff(diff::DiffArgs),
    /// Solve one problem once, or with each of several values by --vary
    #[command(
        after_help = "Examples:\n  signorini solve problem2\n  \
        signorini solve --f 'disc(-0.25,0,0.2)=6; else=-1' --accuracy 1e-3\n  \
        signorini solve --f 'halfplane(1,0,0)=8; else=-9' --vary friction=0.5,1\n\
        `--help` shows all options, and the regions on which f may be given.",
        after_long_help = "Examples:\n  signorini solve problem2 --json\n  \
        signorini solve --f 'quadrant(ll)=3; else=-1.1' --h 1/256 --out v.vti\n  \
        signorini solve --f 'disc(0,0,$R)=4; else=-1' --vary R=0.1,0.2 --csv t.csv\n\n\
        f is a list of `region=value` and one `else=value`, separated by `;`; the last region that covers a point \
        wins. Regions: rect(x0,x1,y0,y1), quadrant(ll|lr|ul|ur), halfplane(a,b,c) for ax+by<=c, disc(x,y,radius), of \
        a mesh region(name); in space box(x0,x1,y0,y1,z0,z1), halfspace(a,b,c,d), ball(x,y,z,radius). The square is \
        [-0.5,0.5]^2, the cube [-0.5,0.5]^3. Or formula(3*x*y - 1.1), with + - * / ^, pi, e, sin, cos, tan, exp, ln, \
        sqrt, abs, min, max, atan2; or exact(NAME), see `signorini list`.\n\n\
        Exit code 3: there is no solution, it is not reached, or an accuracy is not."
    )]
    Solve(Box<solve::SolveArgs>),
    /// Search for the right-hand sides of Figure 1 that give the published tables
    #[command(after_help = identify::EXAMPLES)]
    Identify(identify::IdentifyArgs),
    /// Measure how long the members of a study take on this machine
    #[command(
        after_help = "Times depend on the machine and on what else it does: leave it idle. A time is that\n\
        of the solver alone, with mesh and load vector made before; with an accuracy, that\n\
        of all.\n\n\
        Examples:\n  signorini bench\n  signorini bench accuracy --csv target/times.csv"
    )]
    Bench(bench::BenchArgs),
    /// Build the book, as `run --only report` does, and open it with --open
    Report(report::ReportArgs),
    /// Write what a reviewer attaches to a review: CODECHECK files and an RO-Crate
    #[command(
        after_help = "Only for a run that is up to date. If no scene has a `paper_table`, it is an RO-Crate \
        of the run\nwith a page on it, without the files of CODECHECK.\n\
        Examples:\n  signorini certificate --name 'A. Reviewer'\n  \
        signorini certificate --output ../review"
    )]
    Certificate(certificate::CertificateArgs),
    /// List the scenes, solvers, domains, and problems with known solutions
    #[command(after_help = "Examples:\n  signorini list\n  signorini list domains\n  \
        signorini list plate              the command that solves a scene")]
    List(list::ListArgs),
    /// Begin a study of your own: two scenes, one page, and a run that works
    #[command(after_help = "Example:\n  signorini init study && cd study && signorini run")]
    Init(init::InitArgs),
    /// Remove from the cache what no scene needs any more
    #[command(
        after_help = "No scene of this project, that is: from a cache that several projects share, \
        the results of all others go as well."
    )]
    Gc(gc::GcArgs),
    /// Print a completion script for a shell
    #[command(
        after_help = "Example:\n  signorini completions bash > ~/.local/share/bash-completion/completions/signorini"
    )]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write those of all commands to a folder
    #[command(
        after_help = "Examples:\n  signorini man | man -l -\n  signorini man --output ~/.local/share/man/man1"
    )]
    Man {
        /// Folder for a page per command, which must exist
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
}

/// Reads a name that is looked up, in the form that the names of a project have.
#[expect(clippy::unnecessary_wraps, reason = "a parser may fail")]
fn name_parser(text: &str) -> std::result::Result<String, Infallible> {
    Ok(composed(text))
}

/// Parses the arguments, runs the command, reports an error in one line, and returns the exit code.
pub fn main() -> ExitCode {
    let mut command = Cli::command();
    let words = help::words();
    if words.iter().any(|word| word == "--help") {
        command = help::with_all_options(command);
    }
    let matches = command.try_get_matches_from_mut(words);
    let parsed = matches.and_then(|matches| Cli::from_arg_matches(&matches));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(mut e) => {
            if let Some(limit) = limit(&e) {
                return ended(Err(Error::input(limit)));
            }
            if e.kind() == ErrorKind::UnknownArgument
                && let Some(word) =
                    std::env::args_os().nth(1).and_then(|word| word.into_string().ok())
                && !word.starts_with('-')
                && command.find_subcommand(&word).is_none()
            {
                if let Some(name) = similar(&word) {
                    let text = format!("no command `{word}`; did you mean `signorini {name}`?");
                    return ended(Err(Error::Unknown(text)));
                }
                // Tip and usage name an option of `run`, for which the word is a scene.
                e.remove(ContextKind::SuggestedArg);
                e.remove(ContextKind::Usage);
            }
            if e.kind() == ErrorKind::ArgumentConflict {
                // The usage is that of one of the two options.
                e.remove(ContextKind::Usage);
            }
            let e = e.format(&mut command);
            if e.use_stderr() {
                let _ = e.print();
                return ExitCode::from(2);
            }
            // Texts of help and version are errors of the parser too.
            return ended(say(&e.render().ansi().to_string()));
        }
    };
    interrupt::survive_file_limit();
    std::panic::set_hook(Box::new(|panic| fail(&panicked(panic))));
    let Ok(result) = std::panic::catch_unwind(|| start_threads(&cli).and_then(|()| dispatch(cli)))
    else {
        return ExitCode::from(Error::Stage(Vec::new()).exit_code());
    };
    ended(result)
}

/// Returns the sentence on what is not solved, if an argument asks for it.
fn limit(error: &clap::Error) -> Option<String> {
    let option = named(error, ContextKind::InvalidArg)?.split([' ', '=']).next()?;
    let said = limits::of_word(option).filter(|_| error.kind() == ErrorKind::UnknownArgument)?;
    Some(format!("{option}: {said}"))
}

/// Returns the text of this kind that an error names, if it names one.
fn named(error: &clap::Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind)? {
        ContextValue::String(text) => Some(text),
        _ => None,
    }
}

/// Returns the exit code of a command, after a line for an error.
fn ended(result: Result<u8>) -> ExitCode {
    match result {
        Ok(code) => ExitCode::from(code),
        Err(e) => {
            fail(&e.to_string());
            ExitCode::from(e.exit_code())
        }
    }
}

/// Writes the line on the error that ends the program.
fn fail(why: &str) {
    /// Characters of an error: the beginning names the mistake, the end the remedy.
    const MOST: usize = 4000;
    let why = shortened(why, MOST);
    talk(&format!("{}: {why}", styled("error", anstyle::AnsiColor::Red)));
}

fn panicked(panic: &PanicHookInfo) -> String {
    let what = panic.payload_as_str().unwrap_or("a panic without a message").replace('\n', " ");
    // Libraries that start threads of their own report a failure only by a panic.
    if what.contains("Resource temporarily unavailable") {
        return format!("cannot start threads; raise the limit on processes (`ulimit -u`): {what}");
    }
    let at = panic.location().map(|at| format!(" at {}:{}", at.file(), at.line()));
    format!("this is a bug, please report it: {what}{}", at.unwrap_or_default())
}

/// Number of threads per core beyond which further threads would only wait.
const THREADS_PER_CORE: usize = 4;

/// Returns the number of threads `asked` for by `option`; if that is too large, a smaller number, after a note.
fn threads(option: &str, asked: usize) -> usize {
    let most = THREADS_PER_CORE * machine::cores();
    if asked > most {
        talk(&format!("note: {option} {asked} is more than helps; {most} threads are started"));
    }
    asked.min(most)
}

/// Starts the pool of threads of this process, RAYON_NUM_THREADS threads or one per core, for a command that may need
/// them.
fn start_threads(cli: &Cli) -> Result<()> {
    if let Some(Command::List(_) | Command::Completions { .. } | Command::Man { .. }) = cli.command
    {
        return Ok(());
    }
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse().ok());
    let count = match asked.filter(|&count| count > 0) {
        Some(count) => threads("RAYON_NUM_THREADS", count),
        None => machine::cores(),
    };
    let mut pool = rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .thread_name(|k| format!("helper {}", k + 1));
    if count == 1 {
        pool = pool.use_current_thread();
    }
    pool.build_global().map_err(|e| {
        Error::input(format!("cannot start {count} threads: {e}; set RAYON_NUM_THREADS=1"))
    })
}

fn dispatch(cli: Cli) -> Result<u8> {
    let Some(command) = cli.command else {
        return run::run(&cli.run).map_err(|error| match (error, &cli.run.scenes[..]) {
            (Error::Unknown(_), [word, ..]) if Cli::command().find_subcommand(word).is_some() => {
                Error::Unknown(format!("options stand behind the command: `signorini {word} ...`"))
            }
            (Error::Unknown(text), [word, ..]) => Error::Unknown(text + &advice(word)),
            (error, _) => error,
        });
    };
    match command {
        Command::Run(args) => run::run(&args),
        Command::Status(args) => status::status(&args),
        Command::Explain(args) => status::explain(&args),
        Command::Dag(args) => dag::dag(&args),
        Command::Diff(args) => diff::diff(&args),
        Command::Solve(args) => solve::solve(&args),
        Command::Identify(args) => identify::identify(&args),
        Command::Bench(args) => bench::bench(&args),
        Command::Report(args) => report::report(&args),
        Command::Certificate(args) => certificate::certificate(&args),
        Command::List(args) => list::list(&args),
        Command::Init(args) => init::init(&args),
        Command::Gc(args) => gc::gc(&args),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut without_scenes(), "signorini", &mut script);
            say(&with_files(&String::from_utf8_lossy(&script)))
        }
        Command::Man { output } => man::man(output.as_deref()),
    }
}

/// Returns advice on a word that is no scene, in case that a command was meant.
fn advice(word: &str) -> String {
    let part = list::PARTS.contains(&word).then(|| format!("list {word}"));
    part.or_else(|| similar(word))
        .map_or(String::new(), |name| format!("; did you mean `signorini {name}`?"))
}

/// Returns a script for completions that suggests files, too, for the domain of `solve`: zsh and fish leave them out
/// where values are suggested.
fn with_files(script: &str) -> String {
    const ZSH: &str = ":NAME|FILE:(";
    let mut text = String::new();
    for line in script.split_inclusive('\n') {
        text += &match line
            .split_once(ZSH)
            .and_then(|(left, rest)| Some((left, rest.split_once(')')?)))
        {
            Some((left, (names, right))) => {
                format!("{left}:NAME|FILE:{{compadd {names}; _files}}{right}")
            }
            None if line.contains(" -l domain ") => line.replacen(" -r -f -a ", " -r -F -a ", 1),
            None => line.to_owned(),
        };
    }
    text
}

/// Returns the program without the argument for scenes, which in the completions for zsh would replace the commands.
fn without_scenes() -> clap::Command {
    let all = Cli::command();
    let options = all.get_arguments().filter(|argument| !argument.is_positional());
    // Some options conflict with the scenes, which are not here.
    let options = options.map(|option| option.clone().conflicts_with(Resettable::Reset));
    let commands = all.get_subcommands().cloned();
    clap::Command::new("signorini")
        .version(env!("CARGO_PKG_VERSION"))
        .args(options)
        .subcommands(commands)
}

/// Returns the command whose name is most like this word.
fn similar(word: &str) -> Option<String> {
    let commands = Cli::command().get_subcommands().cloned().collect::<Vec<_>>();
    let alone = clap::Command::new("signorini").subcommand_required(true).subcommands(commands);
    let refusal = alone.try_get_matches_from(["signorini", word]).err()?;
    match refusal.get(ContextKind::SuggestedSubcommand)? {
        // The last name is the likeliest; the first letter is rarely wrong.
        ContextValue::Strings(names) => {
            names.iter().rev().find(|name| name.chars().next() == word.chars().next()).cloned()
        }
        _ => None,
    }
}

/// Returns the root of the project that the current folder is in.
fn project_root() -> Result<PathBuf> {
    Project::find(&current_folder()?)
}

/// Returns a scene of the project, and checks none.
fn scene(name: &str) -> Result<Scene> {
    Project::read_scenes(&project_root()?)?.named(name).cloned()
}

fn current_folder() -> Result<PathBuf> {
    std::env::current_dir()
        .map_err(|e| Error::input(format!("the current folder is gone ({e}); change to another")))
}
