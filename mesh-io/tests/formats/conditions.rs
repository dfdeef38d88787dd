//! The list of boundary conditions beside a SELAFIN.

use super::Folder;
use mesh_io::{Conversion, Format, MeshFile, WriteError};

/// A ring of triangles around a square island, whose lower side is open.
fn ring() -> String {
    let points = [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [2, 1], [2, 2], [1, 2]];
    let mut text = "ring\n8 8\n".to_owned();
    for (i, [x, y]) in points.iter().enumerate() {
        text += &format!("{} {x}.0 {y}.0 0.0\n", i + 1);
    }
    for side in 0..4 {
        let next = (side + 1) % 4;
        let [a, b, c, d] = [side, next, 4 + next, 4 + side].map(|v| v + 1);
        text += &format!("{} 3 {a} {b} {c}\n{} 3 {a} {c} {d}\n", 2 * side + 1, 2 * side + 2);
    }
    text + "1 = open\n2 = nodes\n2\n1\n2\n2 = land\n9 = nodes\n4 0\n2\n3\n4\n1\n5 1\n5\n6\n7\n8\n5\n"
}

/// The row of the list for a point.
fn row(types: &str, point: usize, place: usize) -> String {
    format!("{types}  0.000 0.000 0.000 0.000  2  0.000 0.000 0.000 {point:>9} {place:>9}\n")
}

fn convert(folder: &Folder, from: &str, to: (Format, &str)) -> Result<Vec<String>, WriteError> {
    let conversion = Conversion::new(&folder.read(from), to.0).unwrap().unwrap();
    conversion.write(&folder.path(to.1))?;
    Ok(conversion.losses().to_vec())
}

fn groups(folder: &Folder, name: &str) -> Vec<(String, Vec<u32>)> {
    let groups = folder.read(name).groups().unwrap();
    groups.iter().map(|own| (own.name.clone().unwrap(), own.vertices().to_vec())).collect()
}

/// Makes `a.14`, and `a.slf` with its list.
fn grid_and_selafin() -> Folder {
    let folder = Folder::new(&[("a.14", &ring())]);
    assert_eq!(convert(&folder, "a.14", (Format::Selafin, "a.slf")).unwrap(), [""; 0]);
    folder
}

#[test]
fn boundaries_of_grids_are_conditions_of_telemac_and_return() {
    let folder = grid_and_selafin();
    let outer =
        row("5 4 4", 1, 1) + &row("5 4 4", 2, 2) + &row("2 2 2", 3, 3) + &row("2 2 2", 4, 4);
    let island =
        [(5, 5), (8, 6), (7, 7), (6, 8)].map(|(point, at)| row("2 2 2", point, at)).concat();
    assert_eq!(folder.text("a.cli"), outer + &island);
    let names = ["open1", "land1", "island2"].map(str::to_owned);
    let vertices = [vec![0, 1], vec![0, 1, 2, 3], vec![4, 5, 6, 7]];
    let expected: Vec<_> = names.into_iter().zip(vertices).collect();
    assert_eq!(groups(&folder, "a.slf"), expected);
    for (format, name) in
        [(Format::Adcirc, "b.14"), (Format::Sms2dm, "b.2dm"), (Format::Mike, "b.mesh")]
    {
        assert_eq!(convert(&folder, "a.slf", (format, name)).unwrap(), [""; 0], "{name}");
        let back = format!("{name}.slf");
        assert_eq!(convert(&folder, name, (Format::Selafin, &back)).unwrap(), [""; 0], "{name}");
        assert_eq!(folder.text(&format!("{name}.cli")), folder.text("a.cli"), "{name}");
    }
    assert_eq!(groups(&folder, "b.14"), expected);
}

#[test]
fn types_of_open_boundaries_stand_behind_their_names() {
    let folder = grid_and_selafin();
    // Fortran separates numbers by commas too, and programs write names of boundaries behind the rows.
    let text = folder.text("a.cli").replace("5 4 4", "4,5,5").replacen("1\n", "1 # Inflow\n", 1);
    folder.put("a.cli", &text);
    assert_eq!(groups(&folder, "a.slf")[0].0, "open1_455");
    assert_eq!(convert(&folder, "a.slf", (Format::Sms2dm, "b.2dm")).unwrap(), [""; 0]);
    assert_eq!(convert(&folder, "b.2dm", (Format::Selafin, "b.slf")).unwrap(), [""; 0]);
    let expected = text.replace("4,5,5", "4 5 5").replace(" # Inflow", "");
    assert_eq!(folder.text("b.cli"), expected);
    // The names have no room for prescribed values.
    folder.put("a.cli", text.replacen("0.000", "1.5D0", 1));
    let lost = convert(&folder, "a.slf", (Format::Adcirc, "b.14")).unwrap();
    assert_eq!(lost, ["values and types of walls in boundary conditions (.cli)"]);
}

#[test]
fn a_selafin_is_read_with_a_damaged_list_or_without_one() {
    let folder = grid_and_selafin();
    let points = folder.read("a.slf").points().to_vec();
    let unfit = ["a list of boundary conditions (.cli), which does not fit the mesh"];
    let text = folder.text("a.cli");
    for damaged in
        ["", "\0\u{1}", "2 2 2\n", &text[..text.len() - 24], &text.replace("   8 ", "   9 ")]
    {
        folder.put("a.cli", damaged);
        assert_eq!(folder.read("a.slf").points(), points);
        assert_eq!(groups(&folder, "a.slf"), [], "{damaged}");
        assert_eq!(
            convert(&folder, "a.slf", (Format::Adcirc, "b.14")).unwrap(),
            unfit,
            "{damaged}"
        );
    }
    std::fs::remove_file(folder.path("a.cli")).unwrap();
    assert_eq!(groups(&folder, "a.slf"), []);
    assert_eq!(convert(&folder, "a.slf", (Format::Adcirc, "b.14")).unwrap(), [""; 0]);
}

#[test]
fn a_list_of_boundary_conditions_is_copied_with_a_moved_mesh_and_never_replaced() {
    let folder = grid_and_selafin();
    let file = folder.read("a.slf");
    let moved: Vec<_> = file.points().iter().map(|[x, y]| [x + 0.5, *y]).collect();
    for (out, list) in [("b.slf", "b.cli"), ("c.slf.gz", "c.cli")] {
        file.write(&folder.path(out), &moved).unwrap();
        assert_eq!(folder.text(list), folder.text("a.cli"));
        assert_eq!(groups(&folder, out).len(), 3, "{out}");
    }
    folder.put("b.cli", "by hand");
    file.write(&folder.path("b.slf"), file.points()).unwrap();
    assert_eq!(folder.text("b.cli"), "by hand");
    // A conversion does not replace another list either, and writes nothing.
    let error = convert(&folder, "a.14", (Format::Selafin, "b.slf")).unwrap_err().to_string();
    assert!(
        error.contains("b.cli exists, with other boundary conditions than the mesh"),
        "{error}"
    );
    assert!(error.contains("Remove it"), "{error}");
    convert(&folder, "a.14", (Format::Selafin, "a.slf")).unwrap();
    // The mesh is one file for standard input and output.
    let bytes = std::fs::read(folder.path("a.slf")).unwrap();
    let alone = MeshFile::from_bytes("a.slf".as_ref(), bytes.clone()).unwrap();
    assert!(alone.groups().unwrap().iter().next().is_none());
    let mut written = Vec::new();
    file.write_to("-".as_ref(), &mut written, file.points()).unwrap();
    assert_eq!(written, bytes);
    assert_eq!(
        (file.paths().count(), file.destinations(&folder.path("d.slf")).unwrap().len()),
        (1, 1)
    );
}
