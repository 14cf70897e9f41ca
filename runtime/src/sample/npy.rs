//! Samples as a `.npy` file, which numpy and many others read (NumPy Enhancement Proposal 1).

use std::io::{self, Write};

/// Writes the planes of a lattice as one array of little-endian f32: of the shape (nx, ny, nz), or (nx, ny,
/// nz, planes) if there are several, in Fortran's order, in which x is fastest: `array[i, j, k]` is the
/// answer at the point with these indices.
///
/// Panics if a plane has another number of points.
///
/// # Errors
/// Those of the writer.
pub fn write_npy(points: [usize; 3], planes: &[Vec<f32>], writer: &mut dyn Write) -> io::Result<()> {
    let count: usize = points.iter().product();
    assert!(planes.iter().all(|plane| plane.len() == count), "a number for each point");
    let [x, y, z] = points;
    let shape = match planes.len() {
        1 => format!("({x}, {y}, {z})"),
        several => format!("({x}, {y}, {z}, {several})"),
    };
    let mut header = format!("{{'descr': '<f4', 'fortran_order': True, 'shape': {shape}, }}");
    // Magic, version and length take 10 bytes; all of it is filled up to a multiple of 64 and ends with a
    // line feed.
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    header.extend(std::iter::repeat_n(' ', length - header.len() - 1));
    header.push('\n');
    writer.write_all(b"\x93NUMPY\x01\x00")?;
    writer.write_all(&u16::try_from(length).expect("four numbers are short").to_le_bytes())?;
    writer.write_all(header.as_bytes())?;
    let mut bytes = Vec::new();
    for chunk in planes.iter().flat_map(|plane| plane.chunks(1 << 14)) {
        bytes.clear();
        bytes.extend(chunk.iter().flat_map(|number| number.to_le_bytes()));
        writer.write_all(&bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_array_byte_by_byte() {
        let mut file = Vec::new();
        write_npy([2, 1, 1], &[vec![1.0, -2.0]], &mut file).unwrap();
        assert_eq!(file.len(), 128 + 8);
        assert_eq!(&file[..10], b"\x93NUMPY\x01\x00\x76\x00");
        let header = std::str::from_utf8(&file[10..128]).unwrap();
        assert_eq!(header.trim_end(), "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 1, 1), }");
        assert!(header.ends_with(" \n"));
        assert_eq!(file[128..], [0, 0, 0x80, 0x3F, 0, 0, 0, 0xC0]);
    }

    #[test]
    fn several_planes_are_a_fourth_axis() {
        let mut file = Vec::new();
        write_npy([1, 1, 2], &vec![vec![0.0; 2]; 4], &mut file).unwrap();
        assert!(String::from_utf8_lossy(&file).contains("'shape': (1, 1, 2, 4)"));
        assert_eq!(file.len() % 64, 8 * 4);
    }
}
