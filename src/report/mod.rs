//! Templates and computed data become Markdown, Markdown becomes a book that needs no network; knows nothing
//! of this paper.

mod build;
mod fields;
mod filters;
mod mathml;
mod pages;
mod tables;

pub use build::build;
pub(crate) use build::settings;
pub(crate) use fields::Fields;
pub use pages::pages;
pub(crate) use pages::stubs;
pub(crate) use tables::with_data;

/// Why no book came out.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {message}")]
pub struct ReportError {
    /// The place to look at: a file, and where it is known a line in it.
    pub place: String,
    /// What is wrong there, and how it is mended.
    pub message: String,
}

impl ReportError {
    fn at(place: impl ToString, message: impl ToString) -> Self {
        Self { place: place.to_string(), message: message.to_string() }
    }
}
