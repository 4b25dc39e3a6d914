//! The tests of the whole: one binary, a module per subject.

mod accuracy;
mod book;
mod cache;
mod claims;
mod cli;
mod common;
mod cube;
mod cube_loads;
mod disks;
mod explore;
mod faults;
mod fuzz;
mod identify;
mod identify_cli;
mod interruption;
mod loads;
mod multigrid;
mod readme;
mod records;
mod replication;
mod solvers;
mod spectral;
mod stress;
mod terminal;
