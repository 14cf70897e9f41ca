//! `-` on the command line: the standard input or output.

use std::path::Path;

/// Whether a path of the command line means the standard input or output.
pub fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}
