//! Further outputs of the book, made by programs that `book.toml` names.

use super::programs::CommandLine;
use super::settings::Program;
use mdbook_driver::errors::{Error, Result};
use mdbook_renderer::{RenderContext, Renderer};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::process::{Command, Stdio};

/// Output made by another program. mdBook can run the program itself, but with our standard output, which carries data.
pub(super) struct Backend {
    line: CommandLine,
    optional: bool,
}

impl Backend {
    /// Returns the output with this name.
    pub(super) fn new(name: &str, table: &Program) -> Result<Self> {
        let line = CommandLine::of("output", name, table).map_err(Error::msg)?;
        Ok(Self { line, optional: table.optional })
    }

    /// Returns the program with its arguments; a path begins in the folder of `book.toml`.
    fn command(&self, root: &Path) -> Command {
        let program = match self.line.path() {
            Some(path) => root.join(path),
            None => self.line.words[0].clone().into(),
        };
        let mut command = Command::new(program);
        command.args(&self.line.words[1..]);
        command
    }

    fn failure(&self, why: &str) -> Error {
        let name = &self.line.name;
        Error::msg(format!(
            "the output {name} fails: {why}; mend [output.{name}] in report/book.toml"
        ))
    }
}

impl Renderer for Backend {
    fn name(&self) -> &str {
        &self.line.name
    }

    fn render(&self, context: &RenderContext) -> Result<()> {
        fs::create_dir_all(&context.destination)?;
        let mut command = self.command(&context.root);
        command.stdin(Stdio::piped()).stdout(io::stderr()).current_dir(&context.destination);
        let mut child = match command.spawn() {
            Err(e) if self.optional && e.kind() == ErrorKind::NotFound => return Ok(()),
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
