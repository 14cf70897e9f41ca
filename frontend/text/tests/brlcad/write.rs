//! Databases for tests: records of binary files.

/// An object of a binary file.
pub fn record(name: &str, major: u8, minor: u8, attributes: &[(&str, &str)], body: &[u8]) -> Vec<u8> {
    let mut parts = vec![name.bytes().chain([0]).collect::<Vec<u8>>()];
    let mut pairs: Vec<u8> = Vec::new();
    for (key, value) in attributes {
        pairs.extend(key.bytes().chain([0]).chain(value.bytes()).chain([0]));
    }
    if !pairs.is_empty() {
        pairs.push(0);
        parts.push(pairs);
    }
    parts.push(body.to_vec());
    let width = |present: bool| if present { 0b1010_0000 } else { 0b1000_0000 };
    let mut bytes = vec![0x76, 0b1011_0000, width(!attributes.is_empty()), width(true), major, minor];
    let inner: usize = parts.iter().map(|part| part.len() + 4).sum();
    let length = (bytes.len() + 4 + inner + 1).next_multiple_of(8);
    bytes.extend((length as u32 / 8).to_be_bytes());
    for part in parts {
        bytes.extend((part.len() as u32).to_be_bytes());
        bytes.extend(part);
    }
    bytes.resize(length - 1, 0);
    bytes.push(0x35);
    bytes
}

/// A file of objects.
pub fn file(objects: impl IntoIterator<Item = Vec<u8>>) -> Vec<u8> {
    let mut bytes = vec![0x76, 1, 0, 0, 0, 0, 1, 0x35];
    bytes.extend(objects.into_iter().flatten());
    bytes
}

/// Numbers as a body has them.
pub fn reals(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_be_bytes()).collect()
}

/// A solid.
pub fn solid(name: &str, minor: u8, numbers: &[f64]) -> Vec<u8> {
    record(name, 1, minor, &[], &reals(numbers))
}

/// A list of entries behind whole numbers.
pub fn list(name: &str, minor: u8, head: &[u32], numbers: &[f64]) -> Vec<u8> {
    let head = head.iter().flat_map(|number| number.to_be_bytes());
    record(name, 1, minor, &[], &head.chain(reals(numbers)).collect::<Vec<u8>>())
}

/// The steps of combinations.
pub const MEMBER: u8 = 1;
pub const UNION: u8 = 2;
pub const INTERSECTION: u8 = 3;
pub const DIFFERENCE: u8 = 4;
pub const EXCLUSIVE: u8 = 5;
pub const COMPLEMENT: u8 = 6;

/// A combination of members with their matrices.
pub fn combination(
    name: &str,
    attributes: &[(&str, &str)],
    members: &[(&str, Option<[f64; 16]>)],
    steps: &[u8],
) -> Vec<u8> {
    let (mut list, mut matrices) = (Vec::new(), Vec::new());
    for (member, matrix) in members {
        list.extend(member.bytes().chain([0]));
        let index = matrix.map_or(u32::MAX, |_| matrices.len() as u32 / 128);
        list.extend(index.to_be_bytes());
        matrices.extend(matrix.iter().flat_map(|matrix| reals(matrix)));
    }
    let mut body = vec![2];
    let numbers = [matrices.len() / 128, members.len(), list.len(), steps.len(), 1];
    body.extend(numbers.iter().flat_map(|number| (*number as u32).to_be_bytes()));
    body.extend(matrices);
    body.extend(list);
    body.extend(steps);
    record(name, 1, 31, attributes, &body)
}
