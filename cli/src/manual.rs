//! `jbt completions` and `jbt man`: what shells and `man` know about the command line, made from its own
//! description.

use std::io::Write as _;

use clap::CommandFactory as _;
use clap_complete::generate;
use clap_mangen::Man;

use crate::arguments::{Arguments, CompletionsArguments, ManArguments};
use crate::failure::Failure;
use crate::output::{Destination, Output, check_place, plural, print, print_bytes};

/// Prints a script for a shell.
pub fn completions(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut Arguments::command(), "jbt", &mut script);
    print_bytes(&script)
}

/// Writes a page for `jbt` and one for each of its commands.
pub fn man(arguments: &ManArguments, quiet: bool) -> Result<(), Failure> {
    let mut root = Arguments::command().disable_help_subcommand(true);
    root.build();
    let commands: Vec<_> = root.get_subcommands().cloned().collect();
    let pages: Vec<Man> = std::iter::once(root).chain(commands).map(Man::new).collect();
    let destination = |page: &Man| Destination {
        path: arguments.folder.join(page.get_filename()),
        kind: (),
        replace: true,
    };
    for page in &pages {
        check_place(&destination(page).path)?;
    }
    for page in &pages {
        let mut output = Output::open(&destination(page))?;
        let mut text = Vec::new();
        page.render(&mut text)
            .and_then(|()| output.write_all(&text))
            .map_err(|error| output.failure(error))?;
        output.finish()?;
    }
    if quiet {
        return Ok(());
    }
    let folder = jbt::diagnostic::escape(&arguments.folder.display().to_string());
    print(&format!("{folder}: {}", plural(pages.len() as u64, "page", "pages")))
}
