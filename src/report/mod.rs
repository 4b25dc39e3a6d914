//! The report: templates and computed data become Markdown, Markdown becomes a book that needs no network.

mod build;
mod cost;
mod data;
mod facts;
mod fields;
mod filters;
mod mathml;
mod pages;
pub mod results;
mod search;
mod tables;

pub use build::build;
pub use data::{
    Artifact, Column, CommandHelp, Compared, Figure, Figures, Level, Miss, Piece, Problem,
    Provenance, Report, Row, Scene, Shape, SolutionFile, Version,
};
pub use fields::Fields;
pub use pages::{context, pages, stubs};
pub use tables::with_data;

use std::path::PathBuf;

/// Why no book came out. Each names the place to look at.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A template that does not parse, or asks for something the data does not have.
    #[error("report/templates/{file}:{line}: {message}")]
    Template {
        /// Name of the template.
        file: String,
        /// Line in it, from 1; 0 if unknown.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// Results that lack what the chapters are about.
    #[error("the book lacks its data: {0}")]
    Data(String),
    /// A formula that is no LaTeX we can set.
    #[error("{chapter}: cannot set the formula `{formula}`: {message}")]
    Formula {
        /// Path of the Markdown file.
        chapter: String,
        /// The LaTeX between the dollars.
        formula: String,
        /// What is wrong.
        message: String,
    },
    /// A dollar that opens or closes nothing.
    #[error("{chapter}:{line}: unpaired `$`; write `\\$` for a dollar, or close the formula")]
    UnpairedDollar {
        /// Path of the Markdown file.
        chapter: String,
        /// Line in it, from 1.
        line: usize,
    },
    /// Two equations with one number.
    #[error("{chapter}: equation ({label}) is numbered already in {first}; tags must be unique")]
    DuplicateEquation {
        /// Path of the second Markdown file.
        chapter: String,
        /// The number.
        label: String,
        /// Path of the first.
        first: String,
    },
    /// A reference to an equation that is nowhere.
    #[error("{chapter}: no equation is tagged ({label}), but `eq:{label}` refers to it")]
    UnknownEquation {
        /// Path of the Markdown file.
        chapter: String,
        /// The number asked for.
        label: String,
    },
    /// A Markdown file that is not UTF-8.
    #[error("{0} is not UTF-8 text")]
    NotText(String),
    /// The scratch folder could not be written or read.
    #[error("{path}: {source}; building the book needs this folder for itself")]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A setting of mdBook under which its output would not be where the run looks for it.
    #[error("report/book.toml: {0}")]
    Setting(String),
    /// mdBook refused the book.
    #[error("mdBook: {0}")]
    Book(String),
}
