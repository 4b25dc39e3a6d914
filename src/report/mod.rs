//! Templates and computed data become Markdown, Markdown becomes a book that needs no network; knows nothing
//! of this paper. Errors are sentences that begin with the place to look at: a file, and where it is known a line.

mod backend;
mod build;
mod data;
mod filters;
mod includes;
mod links;
mod mathml;
mod pages;

pub use build::build;
pub(crate) use build::{first_page, settings};
pub use pages::pages;
pub(crate) use pages::{PAGE as TEMPLATE, in_template, stubs};
