//! A small project in a temporary folder, and the binary run in it.

use crate::explore::book;
pub(crate) use crate::samples::{
    Dice, Row, config, gmsh_file, mesh, mesh_path, paper_problems, random_source, rows,
};

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::time::SystemTime;
use tempfile::TempDir;

/// Both kinds of output: a table, and every figure.
pub(crate) const EVERYTHING: &str =
    "[\"table\", \"source\", \"surface\", \"history\", \"contact\"]";

/// Two cells, one table, by the method and with the load of the paper.
pub(crate) const TABLE: &str = "title = \"Suction\"\nf = \"else=-1\"\ngrids = [4, 8]\nr = [10, 1]\noutputs = [\"table\"]\n\
    solver = \"arrow-hurwicz\"\nload = { rule = \"nodal\", diagonal = \"rising\" }\nstop = [\"signed\"]\n";

/// Published values for grids 1/4, 1/8 and r = 10, 1; the last count is one that nobody computes.
pub(crate) const PAPER: &str = "r = [10.0, 1.0]\n\n[[table]]\nnumber = 1\ncounts = [[1, 2], [1, 100000]]\n\
    delta_a = [1e-4, 1e-4]\ncount_share = 0.1\ncount_slack = 1000\ndelta_a_factor = 1e30\n";

/// Variables of the environment that change how the program talks.
pub(crate) const TALK: [&str; 5] = ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "COLUMNS", "CI"];

/// [`TABLE`] with other outputs.
pub(crate) fn wanting(outputs: &str) -> String {
    TABLE.replace("[\"table\"]", outputs)
}

/// The number of a value in JSON. Compared as an option, one that is missing would be less than every number.
#[track_caller]
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A project folder with its cache inside.
pub(crate) struct Project {
    folder: TempDir,
}

/// What a command said and how it ended.
#[derive(Debug)]
pub(crate) struct Said {
    /// Exit code; `None` if a signal ended it.
    pub code: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).expect("UTF-8 on standard output"),
            err: String::from_utf8(output.stderr).expect("UTF-8 on standard error"),
        }
    }
}

impl Said {
    /// The lines of a successful command.
    #[track_caller]
    pub(crate) fn lines(&self) -> Vec<&str> {
        assert_eq!(self.code, Some(0), "{self:?}");
        self.out.lines().collect()
    }

    /// Checks that a command found nothing to do, and says so first.
    #[track_caller]
    pub(crate) fn nothing_to_do(&self) {
        assert!(self.lines()[0].starts_with("nothing to do: up to date"), "{self:?}");
    }

    /// The error of a command that refused with exit code 2: one line, after lines of progress at most.
    #[track_caller]
    pub(crate) fn refusal(&self) -> &str {
        assert_eq!(self.code, Some(2), "{self:?}");
        assert_eq!(self.out, "", "{self:?}");
        let mut others = self.err.lines().filter(|line| !line.contains(" to run"));
        let error = others.next().unwrap_or_default();
        assert!(
            error.starts_with("error: ") && self.err.ends_with(&format!("{error}\n")),
            "{self:?}"
        );
        assert_eq!(others.next(), None, "{self:?}");
        error
    }

    /// Ids of the tasks that `run -v` says it ran.
    #[track_caller]
    pub(crate) fn ran(&self) -> Vec<&str> {
        assert_eq!(self.code, Some(0), "{self:?}");
        let mut ran: Vec<_> = self
            .err
            .lines()
            .filter_map(|line| line.strip_prefix("ran ")?.split(" (").next())
            .collect();
        ran.sort_unstable();
        ran
    }

    /// Standard output as JSON.
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }
}

/// Folder in memory, where there is one with room for the projects of all tests: for a disk, the program waits until
/// each file that it writes is there.
fn folder_in_memory() -> Option<&'static Path> {
    const FOLDER: &str = "/dev/shm";
    const ROOM: u64 = 4 << 30;
    static HAS_ROOM: LazyLock<bool> = LazyLock::new(|| {
        let free = Command::new("df").args(["--output=avail", "-B1", FOLDER]).output();
        let free = free.ok().and_then(|said| String::from_utf8(said.stdout).ok());
        let free = free.and_then(|text| text.lines().last()?.trim().parse::<u64>().ok());
        free.is_some_and(|free| free > ROOM)
    });
    HAS_ROOM.then_some(Path::new(FOLDER))
}

impl Project {
    /// A folder with nothing in it.
    pub(crate) fn empty() -> Self {
        let folder = match folder_in_memory() {
            Some(memory) => tempfile::tempdir_in(memory),
            None => tempfile::tempdir(),
        };
        Self { folder: folder.expect("a temporary folder") }
    }

    /// A project with one scene, `a`.
    pub(crate) fn with(scene: &str) -> Self {
        let project = Self::empty();
        fs::create_dir_all(project.path("pipeline/scenes")).unwrap();
        fs::create_dir_all(project.path("report")).unwrap();
        project.write("pipeline/paper.toml", PAPER);
        project.scene("a", scene);
        project
    }

    /// Text of a file of the project.
    #[track_caller]
    pub(crate) fn read(&self, path: &str) -> String {
        fs::read_to_string(self.path(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
    }

    /// Rows of the table of all results, which a run makes for a book.
    #[track_caller]
    pub(crate) fn results(&self) -> Vec<Row> {
        rows(&self.read("report/results.csv"))
    }

    /// Answer of `solve --json` to the words of a line, which are split as a shell does it.
    #[track_caller]
    pub(crate) fn answer(&self, line: &str) -> Value {
        self.line(&format!("solve --json {line}")).json()
    }

    /// Runs the binary with the words of a line, which are split as a shell does it.
    pub(crate) fn line(&self, line: &str) -> Said {
        let words = shlex::split(line).expect("quotes in pairs");
        self.run(&words.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Adds a book of one page, `one`, with this text.
    pub(crate) fn add_book(&self, page: &str) {
        fs::create_dir_all(self.path("report/templates")).unwrap();
        self.write("report/templates/SUMMARY.md", "- [One](one.md)\n");
        self.write("report/templates/one.md", page);
    }

    /// A copy of the project that these tests belong to.
    pub(crate) fn copied() -> Self {
        let project = Self::empty();
        for part in ["pipeline", "report", "figures"] {
            copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join(part), &project.path(part));
        }
        project
    }

    /// A copy of the project that these tests belong to, with the cache of the run that made the book of all tests.
    pub(crate) fn whole() -> Self {
        let project = Self::copied();
        copy(&book().join("../../.signorini"), &project.path(".signorini"));
        project
    }

    /// Writes a scene file.
    pub(crate) fn scene(&self, name: &str, text: &str) {
        self.write(&format!("pipeline/scenes/{name}.toml"), text);
    }

    /// Writes a file of the project.
    pub(crate) fn write(&self, path: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path(path), text).unwrap();
    }

    /// A path in the project.
    pub(crate) fn path(&self, path: &str) -> PathBuf {
        self.folder.path().join(path)
    }

    /// The binary, to be run in the project, without anything of the environment that changes its talk.
    pub(crate) fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_signorini"));
        command.args(args).current_dir(self.folder.path()).stdin(Stdio::null());
        TALK.iter().for_each(|name| _ = command.env_remove(name));
        command
    }

    /// Runs the binary to its end.
    pub(crate) fn run(&self, args: &[&str]) -> Said {
        self.command(args).output().expect("the binary starts").into()
    }

    /// Ids of the tasks that a run would run, now or after others.
    pub(crate) fn stale(&self) -> Vec<String> {
        let status = self.run(&["status", "--json"]).json();
        let tasks = status["tasks"].as_object().expect("tasks by id");
        let stale = tasks.iter().filter(|(_, verdict)| verdict["state"] != "fresh");
        stale.map(|(id, _)| id.clone()).collect()
    }

    /// All files under a folder of the project with their contents, by path from there.
    pub(crate) fn files(&self, folder: &str) -> BTreeMap<String, Vec<u8>> {
        files_below(&self.path(folder))
    }

    /// When each file under the project was last written.
    pub(crate) fn times(&self) -> BTreeMap<PathBuf, SystemTime> {
        let mut times = BTreeMap::new();
        walk(self.folder.path(), &mut |path| {
            times.insert(path.into(), fs::metadata(path).unwrap().modified().unwrap());
        });
        times
    }

    /// Temporary files, which no run leaves behind.
    pub(crate) fn leftovers(&self) -> Vec<String> {
        let files = self.times().into_keys().map(|file| file.to_string_lossy().into_owned());
        files.filter(|file| file.contains(".signorini-")).collect()
    }

    /// What a run makes, as far as it must be reproducible: objects, manifests, figures, lock file.
    pub(crate) fn made(&self) -> BTreeMap<String, Vec<u8>> {
        let mut made = BTreeMap::new();
        let of_engines = |name: &str| name.starts_with("locks/") || name.starts_with("stamps/");
        for folder in ["figures", ".signorini/v2"] {
            let files = self.files(folder).into_iter().filter(|(name, _)| !of_engines(name));
            made.extend(files.map(|(name, bytes)| (format!("{folder}/{name}"), bytes)));
        }
        made.insert("lock.toml".into(), fs::read(self.path("pipeline/lock.toml")).unwrap());
        made
    }
}

/// Bracket of the true energy in an answer.
#[track_caller]
pub(crate) fn bracket(json: &Value) -> [f64; 2] {
    [0, 1].map(|end| number(&json["bound"]["energy"][end]))
}

/// The commands that the help of the program lists, but for `help` itself.
pub(crate) fn commands(help: &str) -> Vec<&str> {
    let listed = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    // A description that goes on in the next line is further in.
    let entries = listed.lines().filter_map(|line| line.strip_prefix("  "));
    let names = entries.filter_map(|entry| entry.split(' ').next());
    names.filter(|name| !name.is_empty() && *name != "help").collect()
}

/// The project that these tests belong to, as a run reads it.
pub(crate) fn this_project() -> signorini::replication::project::Project {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf();
    signorini::replication::project::Project::read(root).unwrap()
}

/// Says that something is not tested here, past libtest's capture; in CI that is a failure, because `.ci/run` installs
/// what is needed.
pub(crate) fn skip(why: &str) {
    let ci = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty() && ci != "false");
    assert!(!ci, "skipped in CI: {why}");
    let _ = writeln!(std::io::stderr(), "SKIPPED: {why}");
}

/// Sends Ctrl-C to a process, if it has not ended.
pub(crate) fn interrupt(child: &Child) {
    send("INT", child);
}

/// Sends the signal with this name to a process, if it has not ended.
pub(crate) fn send(signal: &str, child: &Child) {
    let mut kill = Command::new("kill");
    kill.args([&format!("-{signal}"), &child.id().to_string()]).stderr(Stdio::null());
    kill.status().unwrap();
}

/// Waits until a process has its handler for Ctrl-C, so that the signal finds it ready.
pub(crate) fn wait_for_handler(child: &Child) {
    // Signals caught, as a mask; SIGINT is number 2.
    let caught = || {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
        u64::from_str_radix(mask.trim(), 16).unwrap()
    };
    while caught() & 2 == 0 {
        std::thread::yield_now();
    }
}

/// Copies a folder of this project without what a run writes below `report`.
pub(crate) fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        let generated = path.ends_with("report/book") || path.ends_with("report/src");
        if path.is_dir() && !generated {
            copy(&path, &target);
        } else if path.is_file() {
            fs::copy(&path, &target).unwrap();
        }
    }
}

/// Number of times that CONTRIBUTING.md says the tests inject this fault; the fault is the first cell of its row.
#[track_caller]
pub(crate) fn promised(fault: &str) -> usize {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("CONTRIBUTING.md");
    let page = fs::read_to_string(page).unwrap();
    let row = page.lines().find_map(|line| line.strip_prefix(&format!("| {fault} | ")));
    let count = row.and_then(|rest| rest.split(' ').next()?.parse().ok());
    count.unwrap_or_else(|| panic!("CONTRIBUTING.md has no number of `{fault}`"))
}

/// All files below a folder with their contents, by path from there.
pub(crate) fn files_below(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    walk(folder, &mut |path| {
        let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
        files.insert(name, fs::read(path).unwrap());
    });
    files
}

fn walk(folder: &Path, visit: &mut dyn FnMut(&Path)) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            walk(&path, visit);
        } else {
            visit(&path);
        }
    }
}

/// Compares two sets of files and names those that differ.
#[track_caller]
pub(crate) fn assert_same(ours: &BTreeMap<String, Vec<u8>>, theirs: &BTreeMap<String, Vec<u8>>) {
    let names: std::collections::BTreeSet<_> = ours.keys().chain(theirs.keys()).collect();
    let differ: Vec<_> =
        names.into_iter().filter(|name| ours.get(*name) != theirs.get(*name)).collect();
    assert!(differ.is_empty(), "differ or exist once only: {differ:?}");
}
