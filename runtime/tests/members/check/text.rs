//! What is printed reads back as the same model.

use jbt::text::{Options, parse, print};

use super::Verdict;
use crate::subject::Subject;

pub fn check(subject: &Subject) -> Verdict {
    let printed = print(&subject.model);
    let again = parse(printed.as_bytes(), &Options::default())
        .map_err(|errors| format!("{errors:?} in\n{printed}"))?;
    if again != subject.model {
        return Err(format!("expected the model, got\n{printed}"));
    }
    let tree = again.check().map_err(|errors| format!("{errors:?} in\n{printed}"))?;
    let kinds = |tree: &jbt::CheckedTree| -> Vec<_> {
        tree.nodes().iter().map(|node| (node.kind.clone(), node.children.clone())).collect()
    };
    if kinds(&tree) == kinds(&subject.tree) {
        Ok(())
    } else {
        Err(format!("the tree has other nodes when it is read from\n{printed}"))
    }
}
