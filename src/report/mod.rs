//! Templates and computed data become Markdown, Markdown becomes a book that needs no network; independent of this
//! paper. Errors are sentences that begin with the place of the mistake: a file, and a line if it is known.
//!
//! Central are [`pages`] and [`build`].

mod build;
mod contents;
mod data;
mod filters;
mod includes;
mod labels;
mod links;
mod markdown;
mod mathml;
mod outputs;
mod pages;
mod rows;
mod settings;
mod summary;

pub use build::build;
pub(crate) use build::{FIRST, check_settings};
pub use pages::pages;
pub(crate) use pages::{PAGE as TEMPLATE, in_template, stubs};
