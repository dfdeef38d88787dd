//! Writer of binary files in either byte order: numbers, and gmsh's `.msh`.

use super::{Mesh, Precision};

/// The bytes of a binary file under construction.
pub struct Binary {
    /// Bytes written so far.
    pub bytes: Vec<u8>,
    /// Whether numbers are big-endian.
    pub big: bool,
}

impl Binary {
    /// Starts an empty file.
    pub fn empty(big: bool) -> Binary {
        Binary { bytes: Vec::new(), big }
    }

    /// Starts a `.msh` file of the given version with its section `$MeshFormat`.
    pub fn new(version: &str, big: bool) -> Binary {
        let mut file = Binary::empty(big);
        file.text(&format!("$MeshFormat\n{version} 1 8\n"));
        file.ints(&[1]);
        file.text("\n$EndMeshFormat\n");
        file
    }

    /// Appends a text.
    pub fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    fn put<const N: usize>(&mut self, mut little: [u8; N]) {
        if self.big {
            little.reverse();
        }
        self.bytes.extend_from_slice(&little);
    }

    /// Appends integers of 4 bytes.
    pub fn ints(&mut self, numbers: &[i32]) {
        numbers.iter().for_each(|n| self.put(n.to_le_bytes()));
    }

    /// Appends integers of 8 bytes.
    pub fn sizes(&mut self, numbers: &[u64]) {
        numbers.iter().for_each(|n| self.put(n.to_le_bytes()));
    }

    /// Appends numbers of 8 bytes.
    pub fn doubles(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|x| self.put(x.to_le_bytes()));
    }

    /// Appends numbers rounded to a precision, 4 or 8 bytes each.
    pub fn reals(&mut self, precision: Precision, numbers: &[f64]) {
        match precision {
            Precision::Single => numbers.iter().for_each(|x| self.put((*x as f32).to_le_bytes())),
            _ => self.doubles(numbers),
        }
    }
}

/// Writes gmsh 2.2 in binary, with a header before each element, as gmsh does, or with a single
/// header.
pub fn write_msh22_binary(mesh: &Mesh, big: bool, header_each: bool) -> Vec<u8> {
    let mut file = Binary::new("2.2", big);
    let n = mesh.triangles.len() as i32;
    file.text(&format!("$Nodes\n{}\n", mesh.points.len()));
    for (tag, [x, y]) in (1..).zip(&mesh.points) {
        file.ints(&[tag]);
        file.doubles(&[*x, *y, 0.]);
    }
    file.text(&format!("\n$EndNodes\n$Elements\n{n}\n"));
    if !header_each {
        file.ints(&[2, n, 2]);
    }
    for (tag, t) in (1..).zip(&mesh.triangles) {
        if header_each {
            file.ints(&[2, 1, 2]);
        }
        let [a, b, c] = t.map(|v| v as i32 + 1);
        file.ints(&[tag, 1, 1, a, b, c]);
    }
    file.text("\n$EndElements\n");
    file.bytes
}

/// Writes gmsh 4.1 in binary, with one block of nodes and one of elements.
pub fn write_msh41_binary(mesh: &Mesh, big: bool) -> Vec<u8> {
    let mut file = Binary::new("4.1", big);
    let (n, m) = (mesh.points.len() as u64, mesh.triangles.len() as u64);
    file.text("$Nodes\n");
    file.sizes(&[1, n, 1, n]);
    file.ints(&[2, 1, 0]);
    file.sizes(&[n]);
    (1..=n).for_each(|tag| file.sizes(&[tag]));
    mesh.points.iter().for_each(|[x, y]| file.doubles(&[*x, *y, 0.]));
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes(&[1, m, 1, m]);
    file.ints(&[2, 1, 2]);
    file.sizes(&[m]);
    for (tag, t) in (1..).zip(&mesh.triangles) {
        let [a, b, c] = t.map(|v| u64::from(v) + 1);
        file.sizes(&[tag, a, b, c]);
    }
    file.text("\n$EndElements\n");
    file.bytes
}
