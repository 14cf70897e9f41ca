//! Files of particles and atoms: tables of other programs, and files that are wrong.

mod oracle;
mod readers;
