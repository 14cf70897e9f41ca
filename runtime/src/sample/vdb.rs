//! Samples as an OpenVDB file (`.vdb`, file version 224), which Blender, Houdini and others read.
//!
//! ```text
//! root ─ nodes of 4096^3 ─ nodes of 128^3 ─ leaves of 8^3 points       a mask says which points are active
//! ```
//!
//! A point is active where the field is not 0, and only active values are in the file. The field is the
//! grid `density`, a fog; three planes of one name are a grid of vectors, as `color` and `gradient`; every
//! other plane is a grid of its own name.

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::block::Block;
use crate::mesh::Lattice;

/// " BDV", as a word of 64 bits.
const MAGIC: u64 = 0x5644_4220;
/// Versions of the file, and of the library that first wrote it.
const VERSIONS: [u32; 3] = [224, 10, 0];
/// Of inactive values, which are all the background, nothing is kept.
const ACTIVE_MASK: u32 = 2;
/// Said in front of the values of a node: all inactive ones are the background.
const BACKGROUND: u8 = 0;
/// The binary logarithm of the points along a side of a leaf; then of children along a side of the nodes
/// above.
const LEAF: u32 = 3;
const LOWER: u32 = 4;
const UPPER: u32 = 5;

/// What is sampled where.
#[derive(Clone, Copy, Debug)]
pub struct VdbVolume<'a> {
    /// The lattice of the blocks.
    pub lattice: &'a Lattice,
    /// Where the coordinates of the lattice count from, in the world.
    pub origin: [f64; 3],
    /// The names of the planes, as the evaluator's layout has them.
    pub names: &'a [String],
}

/// Writes blocks of samples, of which no two have a point in common. Points of no block are not active.
///
/// # Errors
/// Those of the writer.
pub fn write_vdb(volume: VdbVolume<'_>, blocks: &[Block], writer: &mut dyn Write) -> io::Result<()> {
    let grids = grids(volume.names);
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
        let bytes = grid.bytes(volume, blocks, place);
        writer.write_all(&bytes)?;
        place += bytes.len() as u64;
    }
    Ok(())
}

/// A grid: its name, and its planes, one or three.
struct VdbGrid {
    name: String,
    planes: Vec<usize>,
    /// The plane that says which points are active, if there is a field.
    field: Option<usize>,
}

/// The grids of planes with these names.
fn grids(names: &[String]) -> Vec<VdbGrid> {
    let field = names.iter().position(|name| name == "field");
    let stem = |name: &str| match name {
        "field" => "density".to_owned(),
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

/// Points of a leaf: which are active, and the values of those, point by point.
#[derive(Clone)]
struct VdbLeaf {
    mask: [u64; 8],
    values: Vec<f32>,
}

impl VdbGrid {
    /// The whole grid, which begins at this place of the file.
    fn bytes(&self, volume: VdbVolume<'_>, blocks: &[Block], place: u64) -> Vec<u8> {
        let (width, leaves) = (self.planes.len(), self.leaves(blocks));
        let mut bytes = Vec::new();
        push_text(&mut bytes, &self.name);
        push_text(&mut bytes, if width == 1 { "Tree_float_5_4_3" } else { "Tree_vec3s_5_4_3" });
        push_text(&mut bytes, "");
        let offsets = bytes.len();
        let here = |bytes: &Vec<u8>| place + bytes.len() as u64;
        bytes.extend_from_slice(&[0; 24]);
        let start = here(&bytes);
        push_word(&mut bytes, ACTIVE_MASK);
        let class = if self.name == "density" { "fog volume" } else { "unknown" };
        push_meta(&mut bytes, &[("class", class), ("name", &self.name)]);
        push_transform(&mut bytes, volume);
        self.push_topology(&mut bytes, &leaves);
        let values = here(&bytes);
        for leaf in leaves.values() {
            leaf.mask.iter().for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
            bytes.push(BACKGROUND);
            let active = (0..512).filter(|&offset| leaf.mask[offset >> 6] >> (offset & 63) & 1 == 1);
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

    /// The leaves with active points, in the order of the file.
    fn leaves(&self, blocks: &[Block]) -> BTreeMap<VdbPlace, VdbLeaf> {
        let width = self.planes.len();
        let mut leaves: BTreeMap<VdbPlace, VdbLeaf> = BTreeMap::new();
        for block in blocks {
            let (first, points) = (block.first(), block.points());
            let is_active = |at| match self.field {
                Some(field) => block.get(field, at) != 0.0,
                None => self.planes.iter().any(|&plane| block.get(plane, at) != 0.0),
            };
            if block.is_constant() && !is_active([0; 3]) {
                continue;
            }
            for z in 0..points[2] {
                for y in 0..points[1] {
                    for x in 0..points[0] {
                        if !is_active([x, y, z]) {
                            continue;
                        }
                        let at = [first[0] + x, first[1] + y, first[2] + z];
                        let leaf = leaves
                            .entry(VdbPlace::of(at.map(|at| at as u32 >> LEAF)))
                            .or_insert_with(|| VdbLeaf { mask: [0; 8], values: vec![0.0; 512 * width] });
                        let offset = offset(at.map(|at| at as u32), LEAF);
                        leaf.mask[offset >> 6] |= 1 << (offset & 63);
                        for (value, &plane) in leaf.values[offset * width..].iter_mut().zip(&self.planes) {
                            *value = block.get(plane, [x, y, z]);
                        }
                    }
                }
            }
        }
        leaves
    }

    /// The tree without the values of its leaves.
    fn push_topology(&self, bytes: &mut Vec<u8>, leaves: &BTreeMap<VdbPlace, VdbLeaf>) {
        let places: Vec<VdbPlace> = leaves.keys().copied().collect();
        let uppers: Vec<&[VdbPlace]> = places.chunk_by(|a, b| a.upper == b.upper).collect();
        // One buffer; the background; tiles, and nodes.
        push_word(bytes, 1);
        self.planes.iter().for_each(|_| bytes.extend_from_slice(&0.0f32.to_le_bytes()));
        push_word(bytes, 0);
        push_word(bytes, uppers.len() as u32);
        for upper in uppers {
            for axis in upper[0].upper {
                push_word(bytes, axis << (LEAF + LOWER + UPPER));
            }
            let lowers: Vec<&[VdbPlace]> = upper.chunk_by(|a, b| a.lower == b.lower).collect();
            push_node(bytes, UPPER, lowers.iter().map(|lower| lower[0].lower));
            for lower in lowers {
                push_node(bytes, LOWER, lower.iter().map(|place| place.leaf));
                for place in lower {
                    leaves[place].mask.iter().for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
                }
            }
        }
    }
}

/// Where a leaf is: the indices of its node of 4096^3, and its offsets in the nodes below. Its order is that
/// of the file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct VdbPlace {
    upper: [u32; 3],
    lower: usize,
    leaf: usize,
}

impl VdbPlace {
    /// The place of a leaf, by its indices.
    fn of(leaf: [u32; 3]) -> Self {
        let lower = leaf.map(|axis| axis >> LOWER);
        Self {
            upper: lower.map(|axis| axis >> UPPER),
            lower: offset(lower, UPPER),
            leaf: offset(leaf, LOWER),
        }
    }
}

/// The place of a child in a node: z is fastest.
fn offset([x, y, z]: [u32; 3], side: u32) -> usize {
    let part = |axis: u32| (axis & ((1 << side) - 1)) as usize;
    part(x) << (2 * side) | part(y) << side | part(z)
}

/// A node with children at these places: their mask, the mask of active tiles, of which there are none, and
/// no values.
fn push_node(bytes: &mut Vec<u8>, side: u32, children: impl Iterator<Item = usize>) {
    let size = (1 << (3 * side)) / 8;
    let start = bytes.len();
    bytes.resize(start + 2 * size, 0);
    for child in children {
        bytes[start + child / 8] |= 1 << (child % 8);
    }
    bytes.push(BACKGROUND);
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
        let volume = VdbVolume { lattice: &lattice, origin: [1e5, 0.0, 0.0], names: &names };
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
