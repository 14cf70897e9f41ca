//! Bytes of strangers: whatever is cut, or has another byte, is read or refused, and nothing else happens.

use jbt::mesh::{Lattice, LatticeBlock, MeshBlock, join_blocks};
use jbt::remote::{ModelRows, ModelShape, RowSource, from_rows};
use jbt::{Compiler, Engine, Query};
use jbt_testkit::scene::tree;

#[test]
fn damaged_bytes_are_refused_or_read() {
    let text = "union { twist axis y rate 0.5 { sum { point { radius 1 } point { at (0.3 0 0) radius 1 } } } \
                difference { segment { from (0 0 0) to (1 0 0) radius 1 } point { at (1 0 0) radius 0.5 strength 2 } } }";
    let compiler = Compiler::for_engine(Engine::Lanes);
    let queries = [Query::FIELD, Query::GRADIENT, Query::SURFACE];
    let source = RowSource::new(&compiler.compile(&tree(text)), &queries).unwrap();
    let lattice = Lattice::covering([-1.6; 3], [1.6; 3], 0.1).unwrap();
    let block = LatticeBlock::new(&lattice, 32, [0; 3]).unwrap();
    let rows = source.rows(block.bounds(&lattice, LatticeBlock::REACH)).unwrap();
    let part = from_rows(&compiler, source.shape(), &rows).unwrap();
    let made = part.block(&lattice, block, LatticeBlock::REACH).unwrap().run().unwrap();
    assert!(made.mesh.triangles.len() > 100);
    let (shape, rows, made) = (source.shape().bytes().to_vec(), rows.to_bytes(), made.to_bytes());
    let mut random = fastrand::Rng::with_seed(7);
    let mut damaged = |bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        match random.u8(0..4) {
            0 => bytes.truncate(random.usize(0..bytes.len())),
            1 => bytes.push(random.u8(..)),
            _ => {
                for _ in 0..random.usize(1..4) {
                    let most = if random.bool() { 200 } else { usize::MAX };
                    let at = random.usize(0..bytes.len().min(most));
                    bytes[at] = random.u8(..);
                }
            }
        }
        bytes
    };
    let (mut read, mut fit) = (0, 0);
    for _ in 0..3000 {
        if let Ok(block) = MeshBlock::from_bytes(&damaged(&made)) {
            read += 1;
            let _ = join_blocks(&[block]);
        }
        if let Ok(rows) = ModelRows::from_bytes(&damaged(&rows)) {
            fit += usize::from(from_rows(&compiler, source.shape(), &rows).is_ok());
        }
    }
    for _ in 0..400 {
        // Whatever is verified compiles, and says so if it does not.
        let Ok(shape) = ModelShape::from_bytes(&damaged(&shape)) else { continue };
        let mut rows = rows.clone();
        rows[12..20].copy_from_slice(&shape.fingerprint().to_le_bytes());
        let _ = from_rows(&compiler, &shape, &ModelRows::from_bytes(&rows).unwrap())
            .map(|part| part.block(&lattice, block, LatticeBlock::REACH).map(|job| job.run().is_ok()));
    }
    assert!(read > 100 && fit > 100, "{read} blocks and {fit} parts were read: numbers may be any");
    assert!(ModelShape::from_bytes(b"PK").is_err());
}
