//! Run times and the machine they were measured on: the only room that looks at the clock.

mod bandwidth;
pub mod machine;
pub mod measure;
pub mod recorded;
