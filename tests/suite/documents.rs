//! Names in ARCHITECTURE.md: what stands there in backticks exists.

use crate::common::files_below;
use crate::layout::{ROOMS, module, source_folder, sources};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Folders from which paths are named: the root, and the sources of the packages.
const FOLDERS: [&str; 5] = ["", "src", "src/mathematics/src", "src/pipeline/src", "src/book/src"];

/// Words before the name of an item.
const KEYWORDS: [&str; 8] = ["fn", "struct", "enum", "trait", "const", "static", "type", "mod"];

fn architecture() -> String {
    fs::read_to_string(Path::new(ROOT).join("ARCHITECTURE.md")).unwrap()
}

/// Code of a module, with its words and the names of its items.
#[derive(Default)]
struct Module {
    code: String,
    words: BTreeSet<String>,
    items: BTreeSet<String>,
}

impl Module {
    fn add(&mut self, code: &str) {
        self.code += code;
        self.words.extend(words(code).map(str::to_owned));
        self.items.extend(items(code).map(str::to_owned));
    }
}

/// Texts in which names are looked up.
struct Texts {
    /// Modules of the packages, by their paths from the room.
    modules: BTreeMap<Vec<String>, Module>,
    /// All modules, tests, and what cargo reads.
    all: Module,
}

impl Texts {
    fn read() -> Self {
        let (mut modules, mut all) = (BTreeMap::<_, Module>::new(), Module::default());
        for file in sources(&source_folder()) {
            let code = fs::read_to_string(&file).unwrap();
            // The roots of two packages are both called `lib`.
            modules.entry(module(&file)).or_default().add(&code);
            all.add(&code);
        }
        for (name, bytes) in files_below(&Path::new(ROOT).join("tests/suite")) {
            if name.ends_with(".rs") && name != "documents.rs" {
                all.add(std::str::from_utf8(&bytes).unwrap());
            }
        }
        for folder in ["", "src/book", "src/mathematics", "src/pipeline"] {
            let path = Path::new(ROOT).join(folder).join("Cargo.toml");
            all.add(&fs::read_to_string(path).unwrap());
        }
        Self { modules, all }
    }

    /// True if a path is there, or is named by the program, which makes it.
    fn has_path(&self, path: &str) -> bool {
        let made = format!("\"{}\"", path.trim_end_matches('/'));
        FOLDERS.iter().any(|folder| Path::new(ROOT).join(folder).join(path).exists())
            || self.all.code.contains(&made)
    }

    /// True if names that are joined by `::` lead through modules to a module, an item, or a member of an item.
    fn resolves(&self, path: &[&str]) -> bool {
        let names: Vec<String> = path.iter().map(|&name| name.to_owned()).collect();
        let known =
            (1..=path.len()).rev().find(|&depth| self.modules.contains_key(&names[..depth]));
        let depth = known.unwrap_or(0);
        let Some((item, member)) = path[depth..].split_first() else { return true };
        // What is defined below a module is named in its own file.
        let is_named = depth == 0 || self.modules[&names[..depth]].words.contains(*item);
        let mut inside =
            self.modules.iter().filter(|(module, _)| module.starts_with(&names[..depth]));
        let is_item = is_named && inside.any(|(_, module)| module.items.contains(*item));
        let mut codes = self.modules.values().map(|module| &module.code);
        match member {
            [] => is_item,
            [member] => is_item && codes.any(|code| has_member(code, item, member)),
            _ => false,
        }
    }

    /// Parts of a text in backticks that do not exist.
    fn missing<'a>(&self, quoted: &'a str) -> Vec<&'a str> {
        let parts = quoted.split_whitespace().map(|part| part.trim_end_matches([',', ';']));
        parts.filter(|part| !self.has(part)).collect()
    }

    fn has(&self, part: &str) -> bool {
        if part.contains('=') {
            // A variable of the environment, which another program reads.
            return true;
        }
        if is_path(part) {
            return self.has_path(part);
        }
        if part.contains("::") {
            return self.resolves(&part.split("::").collect::<Vec<_>>());
        }
        match part.starts_with(char::is_uppercase) {
            true => self.all.items.contains(part),
            false => words(part).all(|word| self.all.words.contains(word)),
        }
    }
}

fn is_path(part: &str) -> bool {
    part.contains('/') || [".rs", ".md", ".toml", ".lock"].iter().any(|end| part.ends_with(end))
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// Names after the keywords in some code, comments apart.
fn items(code: &str) -> impl Iterator<Item = &str> {
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.flat_map(|line| {
        let is_keyword = |(before, _): &(&str, &str)| KEYWORDS.contains(before);
        words(line).zip(words(line).skip(1)).filter(is_keyword).map(|(_, name)| name)
    })
}

/// True if an item, or an implementation for it, has a function, a variant or a field with this name.
fn has_member(code: &str, owner: &str, name: &str) -> bool {
    let mut is_inside = false;
    for line in code.lines().filter(|line| !line.is_empty()) {
        if !line.starts_with([' ', '/', '}', '#', ')']) {
            let is_item = line.starts_with("impl") || items(line).any(|item| item == owner);
            is_inside = is_item && words(line).any(|word| word == owner);
            continue;
        }
        let field = line.trim_start();
        let field = field.strip_prefix("pub ").unwrap_or(field);
        let field = field.strip_prefix("pub(super) ").unwrap_or(field);
        let ends = |rest: &str| rest.starts_with([':', ',', '(', ' ']);
        let is_named = field.strip_prefix(name).is_some_and(ends);
        if is_inside && (is_named || items(line).any(|item| item == name)) {
            return true;
        }
    }
    false
}

/// Texts of a page in backticks and, of its blocks, the words that name paths or items.
fn quoted(page: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for (k, part) in page.split("```").enumerate() {
        if k % 2 == 0 {
            found.extend(part.split('`').skip(1).step_by(2));
        } else {
            let names = part.split_whitespace().map(|word| word.trim_end_matches([',', ';']));
            found.extend(names.filter(|name| {
                !name.contains('*')
                    && (name.contains("::") || name.ends_with(".rs") || name.ends_with(".toml"))
            }));
        }
    }
    found
}

/// Rows of the table of a page whose head begins with this word, each as its cells.
fn rows<'a>(page: &'a str, head: &str) -> Vec<Vec<&'a str>> {
    let lines = page.lines().skip_while(|line| !line.starts_with(&format!("| {head} |"))).skip(2);
    let rows = lines.take_while(|line| line.starts_with('|'));
    rows.map(|row| row.split('|').skip(1).map(str::trim).collect()).collect()
}

#[test]
fn names_in_the_architecture_exist() {
    let (page, texts) = (architecture(), Texts::read());
    let quoted = quoted(&page);
    assert!(quoted.len() > 100, "{quoted:?}");
    let missing: Vec<_> = quoted.iter().flat_map(|quoted| texts.missing(quoted)).collect();
    assert!(missing.is_empty(), "ARCHITECTURE.md names what does not exist: {missing:#?}");
}

#[test]
fn types_of_the_map_are_defined_in_their_files_and_the_rooms_are_in_their_order() {
    let page = architecture();
    let types = rows(&page, "type");
    assert!(types.len() > 7);
    for row in types {
        let file = row[1].trim_matches('`');
        let mut there = FOLDERS.iter().map(|folder| Path::new(ROOT).join(folder).join(file));
        let code = fs::read_to_string(there.find(|path| path.exists()).unwrap()).unwrap();
        for name in row[0].split('`').skip(1).step_by(2) {
            assert!(items(&code).any(|item| item == name), "{file} does not define {name}");
        }
    }
    let rooms = rows(&page, "room");
    let rooms = rooms.iter().map(|row| row[0].trim_matches('`').trim_end_matches(".rs"));
    assert_eq!(rooms.map(|room| room.trim_end_matches('/')).collect::<Vec<_>>(), ROOMS);
}

#[test]
fn names_that_do_not_exist_are_found() {
    let texts = Texts::read();
    let there = "levels::Problem Problem::on_square Problem::on_bisected Shape::Ball Levels::discrete solvers::reach \
        solvers::SOLVERS pipeline::store::Store solvers/reach.rs pipeline/.exported.json stamps/ --exit-code";
    assert!(texts.missing(there).is_empty(), "{:?}", texts.missing(there));
    let gone = "levels::Prblem levels::SOLVERS Problem::on_sphere Problem::Ball Shape::Disc Levels::square \
        solvers::reaching nowhere::Problem SOLVER_TABLE Problems solvers/reached.rs pipeline/.unknown --unverified";
    assert_eq!(texts.missing(gone), gone.split(' ').collect::<Vec<_>>());
    assert_eq!(
        quoted("a `b c`\nd `e`\n```text\nf g::h i.rs *.rs\n```\n`j`"),
        ["b c", "e", "g::h", "i.rs", "j"]
    );
}
