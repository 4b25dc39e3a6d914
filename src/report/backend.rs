//! Further outputs of the book, made by programs that `book.toml` names.

use mdbook_driver::errors::{Error, Result};
use mdbook_renderer::{RenderContext, Renderer};
use serde::Deserialize;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{MAIN_SEPARATOR, Path};
use std::process::{Command, Stdio};

/// Settings in `[output.NAME]`.
#[derive(Deserialize)]
pub(super) struct Settings {
    command: Option<String>,
    #[serde(default)]
    optional: bool,
}

/// Output made by another program. mdBook can run the program itself, but with our standard output, which carries data.
pub(super) struct Backend {
    name: String,
    settings: Settings,
}

impl Backend {
    /// Returns the output with this name, unless mdBook makes it without another program.
    pub(super) fn new((name, settings): (String, Settings)) -> Option<Self> {
        let is_inside = name == "html" || name == "markdown";
        (!is_inside).then_some(Self { name, settings })
    }

    /// Returns the program with its arguments; a path begins in the folder of `book.toml`.
    fn command(&self, root: &Path) -> Result<Command> {
        let line = self.settings.command.clone().unwrap_or(format!("mdbook-{}", self.name));
        let words = shlex::split(&line).filter(|words| !words.is_empty());
        let words = words.ok_or_else(|| {
            Error::msg(format!(
                "`{line}` is no command; mend [output.{}] in report/book.toml",
                self.name
            ))
        })?;
        let is_path = words[0].contains(MAIN_SEPARATOR);
        let program = if is_path { root.join(&words[0]) } else { words[0].clone().into() };
        let mut command = Command::new(program);
        command.args(&words[1..]);
        Ok(command)
    }

    fn failure(&self, why: &str) -> Error {
        let name = &self.name;
        Error::msg(format!(
            "the output {name} fails: {why}; mend [output.{name}] in report/book.toml"
        ))
    }
}

impl Renderer for Backend {
    fn name(&self) -> &str {
        &self.name
    }

    fn render(&self, context: &RenderContext) -> Result<()> {
        fs::create_dir_all(&context.destination)?;
        let mut command = self.command(&context.root)?;
        command.stdin(Stdio::piped()).stdout(io::stderr()).current_dir(&context.destination);
        let mut child = match command.spawn() {
            Err(e) if self.settings.optional && e.kind() == ErrorKind::NotFound => return Ok(()),
            Err(e) => return Err(self.failure(&format!("its program cannot be started ({e})"))),
            Ok(child) => child,
        };
        // A program need not read its input: an error of writing it is ignored.
        let _ = child
            .stdin
            .take()
            .map(|stdin| serde_json::to_writer(io::BufWriter::new(stdin), context));
        match child.wait()? {
            status if status.success() => Ok(()),
            status => Err(self.failure(&format!("its program ended with {status}"))),
        }
    }
}
