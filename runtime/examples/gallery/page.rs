//! Puts the steps of the tutorial into its page: the text of each scene, and its picture.

use std::error::Error;
use std::fs;
use std::path::Path;

/// What ends a step in the page.
const END: &str = "<!-- end -->";

/// Writes what is between `<!-- tutorial/NAME -->` and `<!-- end -->` again, for each of these steps.
pub fn write(root: &Path, steps: &[&str]) -> Result<(), Box<dyn Error>> {
    let path = root.join("docs/tutorial.md");
    let mut page = fs::read_to_string(&path)?;
    for step in steps {
        let text = fs::read_to_string(root.join(format!("docs/{step}.jbt")))?;
        let begin = format!("<!-- {step} -->");
        let (before, rest) = page.split_once(&begin).ok_or_else(|| format!("the page has no {begin}"))?;
        let (_, after) = rest.split_once(END).ok_or_else(|| format!("{begin} has no end"))?;
        page = format!("{before}{begin}{}{END}{after}", block(step, &text));
    }
    fs::write(path, page)?;
    Ok(())
}

/// What the page has of a step.
fn block(step: &str, text: &str) -> String {
    let name = step.rsplit('/').next().unwrap_or(step);
    let number = name.split('_').next().unwrap_or(name);
    format!(
        "\n\n[`{name}.jbt`]({step}.jbt):\n\n```jbt\n{text}```\n\n![Step {number}](pictures/{step}.png)\n\n"
    )
}
