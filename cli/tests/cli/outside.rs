//! Mesh files that refer to files outside of their directory.

use super::Folder;
use std::fs;
use std::path::Path;

/// Returns a folder with two meshes in `mesh`: an XDMF with numbers in an HDF5 file in `other`, and an Abaqus input
/// file that includes a file in `other`.
fn apart() -> Folder {
    let made = Path::new(env!("CARGO_MANIFEST_DIR")).join("../mesh-io/tests/formats/h5");
    let folder = Folder::new(&[]);
    ["mesh", "other"].iter().for_each(|name| fs::create_dir(folder.path(name)).unwrap());
    fs::copy(made.join("dolfin.h5"), folder.path("other/v.h5")).unwrap();
    let text = fs::read_to_string(made.join("dolfin.xdmf")).unwrap();
    let absolute = folder.path("other/v.h5").display().to_string();
    for (name, file) in [("up", "../other/v.h5"), ("root", &absolute), ("link", "v.h5")] {
        fs::write(folder.path(&format!("mesh/{name}.xdmf")), text.replace("dolfin.h5", file))
            .unwrap();
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink("../other/v.h5", folder.path("mesh/v.h5")).unwrap();
    let deck = "*NODE\n1, 0., 0.\n2, 2., 0.\n3, 2., 2.\n4, 0., 2.\n5, .9, 1.1\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 5\n2, 2, 3, 5\n\
                3, 3, 4, 5\n4, 4, 1, 5\n*INCLUDE, INPUT=../other/steel.inp\n";
    fs::write(folder.path("mesh/a.inp"), deck).unwrap();
    fs::write(folder.path("other/steel.inp"), "*MATERIAL, NAME=STEEL\n").unwrap();
    folder
}

#[test]
fn files_outside_of_the_directory_of_a_mesh_are_read_and_replaced_by_leave_only() {
    let folder = apart();
    let numbers = || fs::read(folder.path("other/v.h5")).unwrap();
    let before = numbers();
    let names = if cfg!(unix) { &["up", "root", "link"][..] } else { &["up", "root"] };
    for name in names {
        let mesh = format!("mesh/{name}.xdmf");
        let file = format!("{mesh}:7: it names ");
        let parts = [&file, "v.h5, outside of the directory of the mesh", "--allow-outside"];
        folder.line(&format!("{mesh} {mesh} --engine cpu")).refused(&parts);
        folder.line(&format!("quality {mesh}")).refused(&parts);
        assert!(numbers() == before, "{name} has changed the file");
    }
    folder.line("mesh/up.xdmf out.xdmf -q --engine cpu --allow-outside");
    assert!(numbers() == before && folder.path("out_v.h5").is_file());
    let run = folder.line("mesh/up.xdmf mesh/up.xdmf -q --engine cpu --allow-outside");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(numbers() != before);
}

#[test]
fn files_that_abaqus_includes_from_elsewhere_are_read_by_leave_only() {
    let folder = apart();
    folder
        .line("mesh/a.inp out.inp --engine cpu")
        .refused(&["mesh/a.inp:12: it names ../other/steel.inp, which is ", "--allow-outside"]);
    folder.line("mesh/a.inp out.inp --engine cpu --allow-outside").clean();
    fs::copy(folder.path("mesh/a.inp"), folder.path("a.inp")).unwrap();
    // A file that does not exist is not read, so the run must not mention it.
    assert_eq!(folder.line("a.inp out.inp --engine cpu").code, Some(0));
}
