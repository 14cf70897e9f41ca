//! Meshes block by block: each for itself, and in any process.

use crate::compiled::Compiled;
use crate::job::Job;
use crate::mesh::{self, BlockWork, Lattice, LatticeBlock, MeshBlock, MeshError};

use super::{Kernels, Polygonize, PolygonizeError};

impl Polygonize {
    /// The blocks of a lattice that the surface may cross, in Morton order. The edge of blocks is a power of
    /// two from 32 on, in cells. Only ranges of the field are asked.
    ///
    /// # Errors
    /// See [`PolygonizeError`].
    pub fn busy_blocks<'a>(
        &self,
        compiled: &'a Compiled,
        lattice: &'a Lattice,
        edge: usize,
    ) -> Job<'a, Vec<BlockWork>, PolygonizeError> {
        let settings = *self;
        Job::new(move |hook| {
            of_one_solid(compiled)?;
            let options = settings.options(compiled.tree());
            // Ranges ask nothing else.
            let kernels = Kernels::new(compiled, false)?;
            Ok(mesh::busy(&kernels, lattice, (&options, edge), hook)?)
        })
    }

    /// The part of the mesh that belongs to a block. [`mesh::join_blocks`] makes the whole of all of them.
    /// Region and fineness are not asked, and thin parts are not searched for.
    ///
    /// ```
    /// use jbt::mesh::{LatticeBlock, join_blocks};
    /// use jbt::{Compiler, Model, Polygonize, build::point};
    /// let tree = Model::new(point([0, 0, 0], 1)).check()?;
    /// let compiled = Compiler::new().compile(&tree);
    /// let settings = Polygonize::default();
    /// let lattice = settings.lattice(&tree)?;
    /// let mut blocks = Vec::new();
    /// for work in settings.busy_blocks(&compiled, &lattice, 64).run()? {
    ///     let block = LatticeBlock::new(&lattice, 64, work.place).ok_or("a block of the lattice")?;
    ///     blocks.push(settings.block(&compiled, &lattice, block).run()?);
    /// }
    /// assert_eq!(join_blocks(&blocks)?, settings.with(&compiled).run()?.mesh);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// See [`PolygonizeError`].
    pub fn block<'a>(
        &self,
        compiled: &'a Compiled,
        lattice: &'a Lattice,
        block: LatticeBlock,
    ) -> Job<'a, MeshBlock, PolygonizeError> {
        let settings = *self;
        Job::new(move |hook| {
            of_one_solid(compiled)?;
            let mut reach = LatticeBlock::REACH;
            loop {
                match settings.block_hooked(compiled, lattice, (block, reach), hook) {
                    Err(PolygonizeError::Mesh(MeshError::Reach { .. })) => reach *= 4,
                    result => return result,
                }
            }
        })
    }

    /// The part of the mesh that belongs to a block, if it can be told with so much reach.
    pub(crate) fn block_hooked(
        &self,
        compiled: &Compiled,
        lattice: &Lattice,
        (block, reach): (LatticeBlock, usize),
        hook: crate::job::Hook<'_>,
    ) -> Result<MeshBlock, PolygonizeError> {
        let tree = compiled.tree();
        let kernels = Kernels::new(compiled, self.sharp)?;
        let options = self.options(tree);
        let mut made = mesh::extract_block(&kernels, lattice, (&options, block, reach), hook)?;
        made.mesh.origin = tree.origin().point();
        made.mesh.orientation = tree.orientation();
        Ok(made)
    }
}

fn of_one_solid(compiled: &Compiled) -> Result<(), PolygonizeError> {
    if compiled.tree().parts().is_empty() { Ok(()) } else { Err(PolygonizeError::Parts) }
}
