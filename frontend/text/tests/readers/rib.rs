//! RenderMan RIB.

use jbt_model::walk::walk;
use jbt_testkit::samples;
use jbt_text::import::rib;

use crate::common::{bad, compare, ends, field, files, good, messages, near, truncated};

#[test]
fn every_sample_agrees_with_its_table() {
    let Some(folder) = samples::folder("rib") else { return };
    let files = files(&folder, "rib");
    for (name, bytes) in &files {
        truncated(rib, bytes);
        if name == "blobplane.rib" {
            let errors = messages(bytes, &rib(bytes).unwrap_err());
            assert!(errors.contains("scene:20:12: error: ") && errors.contains("(9000) `dbo_plane`"), "{errors}");
            continue;
        }
        let imported = good(rib, bytes);
        println!("{name}: {}", messages(bytes, &imported.warnings));
        let table = folder.join(name.replace(".rib", ".oracle.csv"));
        compare(&imported.model, &table, ["r", "g", "b"], &|_| true);
    }
    assert_eq!(files.len(), 12);
}
