//! Short version of the fuzzing in `fuzz/`, on any toolchain and with repeatable inputs. The environment variable
//! `FUZZ_ROUNDS` multiplies the number of inputs. Inputs that once failed are literal tests here.

#[path = "../fuzz/checks.rs"]
mod checks;

use std::env;
use std::path::Path;
use std::sync::OnceLock;

use mesh_io::{Conversion, MeshFile};
use support::SplitMix64;

/// Returns the number of rounds: `usual`, which takes about a second, times `FUZZ_ROUNDS`.
fn rounds(usual: usize) -> usize {
    let factor = env::var("FUZZ_ROUNDS").ok().and_then(|text| text.parse().ok());
    usual * factor.unwrap_or(1)
}

/// Returns the content with random bytes cut, replaced, inserted and doubled.
fn damaged(content: &[u8], random: &mut SplitMix64) -> Vec<u8> {
    let bytes = b"0123456789 \n\r\t#$<>/=-+.eEnaif\"\0\x01\x7F\xFF";
    let mut damaged = content.to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(damaged.len());
        let byte = bytes[random.below(bytes.len())];
        match random.below(6) {
            0 => damaged.truncate(at + 1),
            1 => damaged[at] = byte,
            2 => damaged.insert(at, byte),
            3 => damaged[at] ^= 1 << random.below(8),
            4 => damaged.extend_from_within(at..),
            _ => drop(damaged.drain(at..(at + 1 + random.below(9)).min(damaged.len() - 1).max(at))),
        }
    }
    damaged
}

/// Returns a small mesh as text in each format that is written, and as the joined files of a Triangle mesh.
fn samples() -> &'static (Vec<Vec<u8>>, Vec<u8>) {
    static SAMPLES: OnceLock<(Vec<Vec<u8>>, Vec<u8>)> = OnceLock::new();
    SAMPLES.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let mesh = support::perturb_random(&support::lattice(3, 3), 0.3, 1);
        let [node, ele] = support::triangle_text(&mesh, "made for a test");
        std::fs::write(folder.path().join("a.node"), &node).unwrap();
        std::fs::write(folder.path().join("a.ele"), &ele).unwrap();
        let file = MeshFile::read(&folder.path().join("a.node")).unwrap();
        let text = |(_, format)| Conversion::new(&file, format).unwrap().unwrap().text();
        let inputs = [ABAQUS, NASTRAN].map(str::to_owned);
        let texts = Conversion::targets().filter_map(text).chain(inputs);
        let texts = texts.map(String::into_bytes).collect();
        let poly = "0 2 0 0\n1 0\n1 5 6\n0\n";
        (texts, [node.as_bytes(), ele.as_bytes(), poly.as_bytes()].join(&0xFF))
    })
}

#[test]
fn arbitrary_bytes_as_a_file_never_panic() {
    let mut random = SplitMix64::new(11);
    let (texts, _) = samples();
    assert!(texts.len() > 8);
    texts.iter().for_each(|text| checks::any_file(text));
    for round in 0..rounds(600) {
        checks::any_file(&damaged(&texts[round % texts.len()], &mut random));
    }
}

/// The error message once quoted the whole tag, including its line ends.
#[test]
fn a_closing_tag_of_several_lines_is_quoted_on_one_line() {
    checks::any_file(b"<?xml version=\"1.0\"?>\n</P 2.0 1.78 0.0\n12 3.0 1.73 0.0\n>\n");
    let long = ["<?xml version=\"1.0\"?>\n</", &"long ".repeat(1000), ">\n"].concat();
    checks::any_file(long.as_bytes());
    checks::any_file(b"<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n</Xdmf>\n</4 5 6\n4 5 10 Center=\"Node\">\n");
}

/// An input file of Abaqus with a part, sets, sections, a surface and an instance.
const ABAQUS: &str = "*Heading\n** made\n*Part, name=P\n*Node, nset=all\n1, 0., 0., 1.\n2, 2., 0.\n3, 2., 2.\n4, 0., 2.\n5, -.9D-3, 1.\n\
*Element, type=CPS3\n1, 1, 2,\n5\n2, 2, 3, 5\n3, 3, 4, 5\n4, 4, 1, 5\n*Element, type=SPRINGA, elset=s\n5, 1, 3\n\
*Elset, elset=a, generate\n1, 3, 2\n*Elset, elset=b\na, 4\n*Solid Section, elset=a, material=M\n1.,\n*Solid Section, elset=B, material=N\n\
*End Part\n*Assembly, name=A\n*Instance, name=P-1, part=P\n*End Instance\n*Nset, nset=n, instance=P-1\n1, 5\n*Surface, name=S\nP-1.a, S1\n\
*Element, type=CONN2D2\n1, P-1.2, 1\n*End Assembly\n*Include, input=none.inp\n*Step\n*End Step\n";

/// Bulk data of Nastran in small, large and free field, with a rigid element, a mass and names of properties.
const NASTRAN: &str = "SOL 101\nCEND\nBEGIN BULK\n$HMNAME PROP 1\"skin\" 4\nGRDSET,,0\n\
GRID    1               0.      0.      1.\nGRID    2               2.              1.\nGRID*   3                               2.\
              2.              +A\n*A      1.\nGRID,4,,0.,2.,1.\nGRID\t5\t0\t1.\t9.-1\t1.\nCTRIA3,1,1,1,2,5\n$\nCTRIA3  2       1\
       2       3       5\nCTRIA3* 3               2               3               4\n*       5\nCTRIAR,4,,4,1,5\nRBE2,5,1,123,2,3,\n\
+,4\nCONM2,6,4,,1.\nCBAR,7,3,1,2\nENDDATA\n";

/// HDF5 files and a raw file: the first is Exodus, the others belong to XDMF files.
const HDF5: [&[u8]; 4] = [
    include_bytes!("formats/h5/netcdf4.exo"),
    include_bytes!("formats/h5/dolfin.h5"),
    include_bytes!("formats/h5/latest.h5"),
    include_bytes!("formats/h5/raw.bin"),
];

#[test]
fn arbitrary_bytes_as_an_hdf5_file_never_panic() {
    let mut random = SplitMix64::new(16);
    let folder = tempfile::tempdir().unwrap();
    for round in 0..rounds(120) {
        let bytes = HDF5[round % HDF5.len()];
        let bytes = if round < HDF5.len() { bytes.to_vec() } else { damaged(bytes, &mut random) };
        checks::any_file(&bytes);
        checks::any_file_beside(folder.path(), &bytes);
    }
}

#[test]
fn triangle_files_of_any_bytes() {
    let mut random = SplitMix64::new(12);
    let folder = tempfile::tempdir().unwrap();
    let (_, parts) = samples();
    checks::any_triangle_files(folder.path(), parts);
    assert!(MeshFile::read(&folder.path().join("fuzzed.node")).is_ok());
    for _ in 0..rounds(150) {
        checks::any_triangle_files(folder.path(), &damaged(parts, &mut random));
    }
}

/// Writes the start inputs of the fuzzer, if the environment variable FUZZ_CORPUS names a folder.
#[test]
fn the_corpus_can_be_written() {
    let Some(folder) = env::var_os("FUZZ_CORPUS") else { return };
    let write = |target: &str, name: usize, bytes: &[u8]| {
        let folder = Path::new(&folder).join(target);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(name.to_string()), bytes).unwrap();
    };
    let (texts, parts) = samples();
    let all = texts.iter().map(Vec::as_slice).chain(HDF5);
    all.enumerate().for_each(|(name, bytes)| write("read", name, bytes));
    write("read_triangle", 0, parts);
}
