//! Samples as an OpenVDB file (`.vdb`, file version 224), which Blender, Houdini and others read.
//!
//! ```text
//! root ─ nodes of 4096^3 ─ nodes of 128^3 ─ leaves of 8^3 points       a mask says which points are active
//! ```
//!
//! Only active values are in the file. Of a *fog* a point is active where the field is not 0; the field is
//! the grid `density`. Of a *level set* it is active within a [band](super::band) around the surface, where
//! the grid `surface` has distances; the file says of every other point on which side it is. Three planes of
//! one name are a grid of vectors, as `color` and `gradient`; every other plane is a grid of its own name.

use std::io::{self, Write};

use jbt_ir::memory::NoMemory;
use jbt_ir::watch;

use super::band::{band, width};
use super::block::Block;
use super::leaf::{LEAF, LOWER, LeafMask, UPPER, VdbLeaf, VdbLeaves, VdbPlace, leaf_at, offset};
use crate::mesh::Lattice;

/// " BDV", as a word of 64 bits.
const MAGIC: u64 = 0x5644_4220;
/// Versions of the file, and of the library that first wrote it.
const VERSIONS: [u32; 3] = [224, 10, 0];
/// Of inactive values, which are all the background, nothing is kept.
const ACTIVE_MASK: u32 = 2;
/// Said in front of the values of a node: all inactive ones are the background; or a mask follows, of those
/// that are, and the others have its negative.
const BACKGROUND: u8 = 0;
const BACKGROUND_OR_NEGATIVE: u8 = 3;

/// What the field becomes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum VdbField {
    /// A grid `density`: the field as it is.
    Fog,
    /// A grid `surface`: the distance from the surface, negative inside, up to three cells to both sides. The
    /// planes have the field and its gradient, and the distance is what they tell of it: `(iso - field) /
    /// |gradient|`, exact to first order in the distance.
    LevelSet {
        /// The value of the field at the surface.
        iso: f32,
    },
}

/// What is sampled where.
#[derive(Clone, Copy, Debug)]
pub struct VdbVolume<'a> {
    /// The lattice of the blocks.
    pub lattice: &'a Lattice,
    /// Where the coordinates of the lattice count from, in the world.
    pub origin: [f64; 3],
    /// The names of the planes, as the evaluator's layout has them.
    pub names: &'a [String],
    /// What becomes of the field.
    pub field: VdbField,
}

/// Writes blocks of samples, of which no two have a point in common. Points of no block are not active, and
/// outside.
///
/// # Errors
/// Those of the writer; `InvalidInput` if a level set is wanted and no planes have field and gradient; and
/// `OutOfMemory`, where the error below it is a [`NoMemory`].
pub fn write_vdb(volume: VdbVolume<'_>, blocks: &[Block], writer: &mut dyn Write) -> io::Result<()> {
    watch::guarded(|| write_grids(volume, blocks, writer))
        .unwrap_or_else(|error: NoMemory| Err(io::Error::new(io::ErrorKind::OutOfMemory, error)))
}

fn write_grids(volume: VdbVolume<'_>, blocks: &[Block], writer: &mut dyn Write) -> io::Result<()> {
    let (grids, band) = match volume.field {
        VdbField::Fog => (grids(volume.names), None),
        VdbField::LevelSet { iso } => {
            let planes = ["field", "gx", "gy", "gz"].map(|name| plane_of(volume.names, name));
            let [Some(field), Some(x), Some(y), Some(z)] = planes else {
                let problem = "a level set is made of the field and its gradient";
                return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
            };
            let band = band(blocks, [field, x, y, z], iso, volume.lattice.spacing());
            (grids(volume.names), Some(band))
        }
    };
    let band = band.as_ref();
    let is_kept = |grid: &VdbGrid| band.is_none() || grid.name != "gradient";
    let grids: Vec<VdbGrid> = grids.into_iter().filter(is_kept).collect();
    let mut head = Vec::new();
    head.extend_from_slice(&MAGIC.to_le_bytes());
    VERSIONS.iter().for_each(|version| head.extend_from_slice(&version.to_le_bytes()));
    // Grids have their offsets; then an identity, which is the same for all files.
    head.push(1);
    head.extend_from_slice(b"00000000-0000-0000-0000-000000000000");
    push_meta(&mut head, &[("creator", "jbt")]);
    push_word(&mut head, grids.len() as u32);
    writer.write_all(&head)?;
    let mut place = head.len() as u64;
    for grid in &grids {
        let bytes = match band {
            Some(band) if grid.name == DENSITY => {
                let surface = VdbGrid { name: "surface".to_owned(), ..grid.clone() };
                let background = width(volume.lattice.spacing());
                surface.bytes(volume, ("level set", background), band, place)
            }
            Some(band) => grid.bytes(volume, ("unknown", 0.0), &grid.leaves_of(blocks, band), place),
            None => {
                let is_active = |block: &Block, at: [usize; 3]| match grid.field {
                    Some(field) => block.get(field, at) != 0.0,
                    None => grid.planes.iter().any(|&plane| block.get(plane, at) != 0.0),
                };
                let class = if grid.name == DENSITY { "fog volume" } else { "unknown" };
                grid.bytes(volume, (class, 0.0), &grid.leaves(blocks, is_active), place)
            }
        };
        writer.write_all(&bytes)?;
        place += bytes.len() as u64;
    }
    Ok(())
}

/// The grid of the field, of a fog.
const DENSITY: &str = "density";

fn plane_of(names: &[String], name: &str) -> Option<usize> {
    names.iter().position(|known| known == name)
}

/// A grid: its name, and its planes, one or three.
#[derive(Clone)]
struct VdbGrid {
    name: String,
    planes: Vec<usize>,
    /// The plane that says which points are active, if there is a field.
    field: Option<usize>,
}

/// The grids of planes with these names.
fn grids(names: &[String]) -> Vec<VdbGrid> {
    let field = plane_of(names, "field");
    let stem = |name: &str| match name {
        "field" => DENSITY.to_owned(),
        "gx" | "gy" | "gz" => "gradient".to_owned(),
        name => name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned(),
    };
    let mut grids: Vec<VdbGrid> = Vec::new();
    let mut first = 0;
    while first < names.len() {
        let name = stem(&names[first]);
        let end = (first..names.len()).find(|&plane| stem(&names[plane]) != name).unwrap_or(names.len());
        if end - first == 3 || end - first == 1 {
            grids.push(VdbGrid { name, planes: (first..end).collect(), field });
        } else {
            let alone = |plane: usize| VdbGrid { name: names[plane].clone(), planes: vec![plane], field };
            grids.extend((first..end).map(alone));
        }
        first = end;
    }
    grids
}

impl VdbGrid {
    /// The whole grid, of a class and with a background, which begins at this place of the file.
    fn bytes(
        &self,
        volume: VdbVolume<'_>,
        (class, background): (&str, f32),
        leaves: &VdbLeaves,
        place: u64,
    ) -> Vec<u8> {
        let width = self.planes.len();
        // Masks and values of the leaves and two lists of their places; nodes are few and grow by themselves.
        let active: usize = leaves.values().map(|leaf| leaf.active.count()).sum();
        let values = 4 * width * active + leaves.len() * (size_of::<[LeafMask; 3]>() + 1);
        watch::take(values + leaves.len() * 2 * size_of::<VdbPlace>());
        let mut bytes = Vec::with_capacity(values);
        push_text(&mut bytes, &self.name);
        push_text(&mut bytes, if width == 1 { "Tree_float_5_4_3" } else { "Tree_vec3s_5_4_3" });
        push_text(&mut bytes, "");
        let offsets = bytes.len();
        let here = |bytes: &Vec<u8>| place + bytes.len() as u64;
        bytes.extend_from_slice(&[0; 24]);
        let start = here(&bytes);
        push_word(&mut bytes, ACTIVE_MASK);
        push_meta(&mut bytes, &[("class", class), ("name", &self.name)]);
        push_transform(&mut bytes, volume);
        self.push_topology(&mut bytes, background, leaves);
        let values = here(&bytes);
        for leaf in leaves.values().filter(|leaf| !leaf.is_tile()) {
            leaf.active.0.iter().for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
            if leaf.inside.is_empty() {
                bytes.push(BACKGROUND);
            } else {
                bytes.push(BACKGROUND_OR_NEGATIVE);
                leaf.inside.0.iter().for_each(|word| bytes.extend_from_slice(&(!word).to_le_bytes()));
            }
            let active = (0..512).filter(|&offset| leaf.active.has(offset));
            for value in active.flat_map(|offset| &leaf.values[offset * width..(offset + 1) * width]) {
                bytes.extend_from_slice(&value.to_le_bytes());
            }
        }
        let ends = [start, values, here(&bytes)];
        for (index, end) in ends.into_iter().enumerate() {
            bytes[offsets + 8 * index..offsets + 8 * index + 8].copy_from_slice(&end.to_le_bytes());
        }
        bytes
    }

    /// The leaves with active points.
    fn leaves(&self, blocks: &[Block], is_active: impl Fn(&Block, [usize; 3]) -> bool) -> VdbLeaves {
        let mut leaves = VdbLeaves::new();
        for block in blocks {
            if block.is_constant() && !is_active(block, [0; 3]) {
                continue;
            }
            for at in block.places().filter(|&at| is_active(block, at)) {
                self.put(leaf_at(&mut leaves, VdbPlace::around(block.index(at))), block, at);
            }
        }
        leaves
    }

    /// Leaves with the active points of those of another grid.
    fn leaves_of(&self, blocks: &[Block], others: &VdbLeaves) -> VdbLeaves {
        let mut leaves = VdbLeaves::new();
        for block in blocks {
            // Of neighbours along x eight are in one leaf.
            let mut last = None;
            for at in block.places() {
                let (index, place) = (block.index(at), VdbPlace::around(block.index(at)));
                let other = match last {
                    Some((known, other)) if known == place => other,
                    _ => last.insert((place, others.get(&place))).1,
                };
                if other.is_some_and(|other| other.active.has(offset(index, LEAF))) {
                    self.put(leaf_at(&mut leaves, place), block, at);
                }
            }
        }
        leaves
    }

    /// Makes a point of a block active in its leaf.
    fn put(&self, leaf: &mut VdbLeaf, block: &Block, at: [usize; 3]) {
        let mut values = [0.0; 3];
        for (value, &plane) in values.iter_mut().zip(&self.planes) {
            *value = block.get(plane, at);
        }
        leaf.put(offset(block.index(at), LEAF), &values[..self.planes.len()]);
    }

    /// The tree without the values of its leaves.
    fn push_topology(&self, bytes: &mut Vec<u8>, background: f32, leaves: &VdbLeaves) {
        let places: Vec<VdbPlace> = leaves.keys().copied().collect();
        let uppers: Vec<&[VdbPlace]> = places.chunk_by(|a, b| a.upper == b.upper).collect();
        // One buffer; the background; tiles, and nodes.
        push_word(bytes, 1);
        self.planes.iter().for_each(|_| bytes.extend_from_slice(&background.to_le_bytes()));
        push_word(bytes, 0);
        push_word(bytes, uppers.len() as u32);
        for upper in uppers {
            for axis in upper[0].upper {
                push_word(bytes, axis << (LEAF + LOWER + UPPER));
            }
            let lowers: Vec<&[VdbPlace]> = upper.chunk_by(|a, b| a.lower == b.lower).collect();
            let is_tile = |lower: &[VdbPlace]| {
                lower.len() == 1 << (3 * LOWER) && lower.iter().all(|place| leaves[place].is_tile())
            };
            let (tiles, lowers): (Vec<_>, Vec<_>) = lowers.into_iter().partition(|lower| is_tile(lower));
            let place = |lower: &&[VdbPlace]| lower[0].lower;
            push_node(bytes, UPPER, lowers.iter().map(place), tiles.iter().map(place));
            for lower in lowers {
                let (tiles, places): (Vec<&VdbPlace>, Vec<_>) =
                    lower.iter().partition(|place| leaves[place].is_tile());
                let place = |place: &&VdbPlace| place.leaf;
                push_node(bytes, LOWER, places.iter().map(place), tiles.iter().map(place));
                for place in places {
                    leaves[place]
                        .active
                        .0
                        .iter()
                        .for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
                }
            }
        }
    }
}

/// A node with children at these places: their mask, the mask of active tiles, of which there are none, and
/// which inactive ones have the negative of the background.
fn push_node(
    bytes: &mut Vec<u8>,
    side: u32,
    children: impl Iterator<Item = usize>,
    inside: impl Iterator<Item = usize>,
) {
    let size = (1 << (3 * side)) / 8;
    watch::take_for(bytes, 3 * size);
    let start = bytes.len();
    bytes.resize(start + 2 * size, 0);
    for child in children {
        bytes[start + child / 8] |= 1 << (child % 8);
    }
    let mut inside = inside.peekable();
    if inside.peek().is_none() {
        bytes.push(BACKGROUND);
        return;
    }
    bytes.push(BACKGROUND_OR_NEGATIVE);
    let start = bytes.len();
    bytes.resize(start + size, 0xff);
    for tile in inside {
        bytes[start + tile / 8] &= !(1 << (tile % 8));
    }
}

/// From indices to the world: the spacing and the place of the first point.
fn push_transform(bytes: &mut Vec<u8>, VdbVolume { lattice, origin, .. }: VdbVolume<'_>) {
    push_text(bytes, "UniformScaleTranslateMap");
    let spacing = lattice.spacing();
    let corner = lattice.origin();
    let place = [0, 1, 2].map(|axis| origin[axis] + corner[axis]);
    let scales = [spacing, spacing, 1.0 / spacing, 1.0 / (spacing * spacing), 0.5 / spacing];
    for number in place.into_iter().chain(scales.into_iter().flat_map(|scale| [scale; 3])) {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
}

fn push_word(bytes: &mut Vec<u8>, word: u32) {
    bytes.extend_from_slice(&word.to_le_bytes());
}

fn push_text(bytes: &mut Vec<u8>, text: &str) {
    push_word(bytes, text.len() as u32);
    bytes.extend_from_slice(text.as_bytes());
}

/// Names with texts.
fn push_meta(bytes: &mut Vec<u8>, all: &[(&str, &str)]) {
    push_word(bytes, all.len() as u32);
    for (name, value) in all {
        push_text(bytes, name);
        push_text(bytes, "string");
        push_text(bytes, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_become_grids() {
        let names = ["field", "gx", "gy", "gz", "color.r", "color.g", "color.b", "rough", "uv.0", "uv.1"];
        let names: Vec<String> = names.map(str::to_owned).to_vec();
        let found: Vec<(String, usize)> =
            grids(&names).into_iter().map(|grid| (grid.name, grid.planes.len())).collect();
        let expected =
            [("density", 1), ("gradient", 3), ("color", 3), ("rough", 1), ("uv.0", 1), ("uv.1", 1)];
        assert_eq!(found, expected.map(|(name, planes)| (name.to_owned(), planes)));
    }

    #[test]
    fn a_file_of_one_point_byte_by_byte() {
        let lattice = Lattice::new([1.0, 2.0, 3.0], 0.5, [200, 10, 10]).unwrap();
        // The point (130, 9, 2) is in the second node of 128^3 along x, and in its leaf (0, 1, 0).
        let block = Block::new([[130, 131], [9, 10], [2, 3]], vec![vec![0.75]]);
        let names = ["field".to_owned()];
        let volume =
            VdbVolume { lattice: &lattice, origin: [1e5, 0.0, 0.0], names: &names, field: VdbField::Fog };
        let mut file = Vec::new();
        write_vdb(volume, &[block], &mut file).unwrap();
        assert_eq!(&file[..8], b" BDV\0\0\0\0");
        let tree = file.windows(12).position(|bytes| bytes == [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]).unwrap();
        let node = tree + 12 + 4 + 12;
        let upper = &file[node..node + 4096];
        assert_eq!(upper.iter().map(|byte| byte.count_ones()).sum::<u32>(), 1);
        assert_eq!(upper[(1 << 10) / 8], 1);
        let lower = &file[node + 2 * 4096 + 1..];
        assert_eq!(lower[16 / 8], 1);
        let leaf = &lower[2 * 512 + 1..];
        let at = 2 << 6 | 1 << 3 | 2;
        assert_eq!(leaf[at / 8], 1 << (at % 8));
        // Its values: the mask again, and the one number.
        assert_eq!(leaf[64..128], leaf[..64]);
        assert_eq!(leaf[128..], [&[BACKGROUND][..], &0.75f32.to_le_bytes()].concat());
    }
}
