#![doc = include_str!("../README.md")]

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
mod text;

pub use build::{FIRST, build};
pub use pages::{PAGE as TEMPLATE, in_template, pages, stubs};
pub use text::{code_in_markdown, csv, in_markdown};
