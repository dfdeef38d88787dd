//! Arrays of data in VTK's two formats: their types, lengths and names.

use super::Folder;
use super::facts::remarks;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mesh_io::{Content, Conversion, Format};

/// Returns a VTU of two triangles with these sections of data.
fn vtu(data: &str) -> String {
    format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
         <Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">\n{data}\n<Points>\n\
         <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0</DataArray>\n\
         </Points>\n<Cells>\n\
         <DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 2 3</DataArray>\n\
         <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6</DataArray>\n\
         <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 5</DataArray>\n</Cells>\n</Piece>\n\
         </UnstructuredGrid>\n</VTKFile>\n"
    )
}

/// Returns the content of a file, and the losses of its conversion to another format.
fn converted(name: &str, bytes: impl AsRef<[u8]>, to: Format) -> (Content, String) {
    let folder = Folder::new(&[]);
    folder.put(name, bytes);
    let file = folder.read(name);
    let losses = Conversion::new(&file, to).unwrap().unwrap().losses().join("; ");
    (file.content().unwrap(), losses)
}

/// Memory is reserved for the numbers of a file, not for those that a damaged header announces.
#[test]
fn an_array_with_a_wrong_number_of_components_is_a_loss() {
    for count in ["400000000", "18446744073709551615"] {
        let data = format!(
            "<CellData><DataArray type=\"Float64\" Name=\"t\" NumberOfComponents=\"{count}\" \
             format=\"ascii\">1 2</DataArray></CellData>"
        );
        let (content, losses) = converted("a.vtu", vtu(&data), Format::Gmsh41);
        assert_eq!(losses, "t, whose number of values does not fit the number of elements");
        assert!(content.cell_data().is_empty());
        let of_points = data.replace("CellData", "PointData");
        let (_, losses) = converted("a.vtu", vtu(&of_points), Format::Gmsh41);
        assert_eq!(losses, "t, whose number of values does not fit the number of vertices");
    }
}

/// Returns a binary legacy VTK of two triangles, with sections before the points and after the cells.
fn legacy(before: &[u8], data: &[u8]) -> Vec<u8> {
    let mut file = b"# vtk DataFile Version 4.2\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\n".to_vec();
    file.extend(before);
    file.extend(b"POINTS 4 double\n");
    let points: [f64; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
    file.extend(points.into_iter().flat_map(f64::to_be_bytes));
    file.extend(b"\nCELLS 2 8\n");
    file.extend([3, 0, 1, 2, 3, 0, 2, 3].into_iter().flat_map(i32::to_be_bytes));
    file.extend(b"\nCELL_TYPES 2\n");
    file.extend([5, 5].into_iter().flat_map(i32::to_be_bytes));
    file.extend(b"\n");
    file.extend(data);
    file
}

/// Returns the bytes of whole numbers, big-endian, in `width` bytes each.
fn whole(numbers: &[i64], width: usize) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_be_bytes()[8 - width..].to_vec()).collect()
}

/// VTK writes numbers of the type `vtkIdType` in 4 bytes, other programs in 8. An array of a wrong width would hide the
/// regions after it.
#[test]
fn numbers_of_the_type_vtkidtype_have_4_or_8_bytes() {
    // The bytes of 35 and 10 are the start of a comment and a line end, and those of 1 and 2 count as blanks.
    for (width, ids) in [4, 8].into_iter().flat_map(|width| [(width, [1, 2]), (width, [35, 10])]) {
        let (ids_read, region) = (ids.map(|id| id as f64), whole(&[7, 9], 4));
        let bytes = whole(&ids, width);
        let array = |head: &str, end: &[u8]| [head.as_bytes(), &bytes, end].concat();
        let regions = [b"SCALARS MaterialIDs int 1\nLOOKUP_TABLE default\n", &region[..]].concat();
        let field = [b"MaterialIDs 1 2 int\n", &region[..], b"\n"].concat();
        let data = [
            array("CELL_DATA 2\nSCALARS id vtkIdType 1\nLOOKUP_TABLE default\n", b"\n"),
            array("CELL_DATA 2\nGLOBAL_IDS id vtkIdType\n", b"\n"),
            array("CELL_DATA 2\nFIELD FieldData 2\nid 1 2 vtkIdType\n", b"\n"),
            array(
                "CELL_DATA 2\nFIELD FieldData 2\nid 1 2 vtkIdType\n",
                b"METADATA\nINFORMATION 0\n\n",
            ),
        ];
        let follows = [&regions, &regions, &field, &field];
        let before = array("FIELD FieldData 1\ncycle 1 2 vtkIdType\n", b"\n");
        for (data, follows) in data.iter().zip(follows) {
            let file = legacy(&before, &[&data[..], follows].concat());
            let folder = Folder::new(&[]);
            folder.put("a.vtk", &file);
            let read = folder.read("a.vtk");
            assert_eq!(read.regions(), Some(&[0, 1][..]), "{width} bytes");
            let content = read.content().unwrap();
            let [data] = content.cell_data() else {
                panic!("{} arrays", content.cell_data().len())
            };
            assert_eq!((data.name(), data.values()), ("id", &ids_read[..]), "{width} bytes");
        }
        // The array may be the last of the file.
        let points = whole(&[4, 5, 6, 7], width);
        let last =
            [b"POINT_DATA 4\nSCALARS n vtkIdType\nLOOKUP_TABLE default\n", &points[..]].concat();
        let (content, _) = converted("a.vtk", legacy(&before, &last), Format::Vtk);
        assert_eq!(content.point_data()[0].values(), [4.0, 5.0, 6.0, 7.0], "{width} bytes");
    }
}

/// Returns name and values of each array of cell data.
fn cell_data(content: &Content) -> Vec<(&str, &[f64])> {
    content.cell_data().iter().map(|data| (data.name(), data.values())).collect()
}

/// Texts cannot be converted, and bits are numbers. Neither hides a later array.
#[test]
fn texts_of_a_legacy_vtk_are_losses_and_bits_are_numbers() {
    let string = |text: &str| [&[0xC0 | text.len() as u8][..], text.as_bytes()].concat();
    let (ab, long) = (string("ab"), string("a text"));
    let fields = |owners: &str, strings: &[&[u8]], bits: u8, region: &[i64]| {
        let count = strings.len();
        let head = format!("{owners} {count}\nFIELD FieldData 3\nname 1 {count} string\n");
        let (middle, end) = (format!("\nflag 1 {count} bit\n"), format!("\nn 1 {count} int\n"));
        let numbers = whole(region, 4);
        [
            head.as_bytes(),
            &strings.concat(),
            middle.as_bytes(),
            &[bits],
            end.as_bytes(),
            &numbers,
            b"\n",
        ]
        .concat()
    };
    let of_points = fields("POINT_DATA", &[&ab, &long, &ab, &ab], 0b0110_1111, &[4, 3, 2, 1]);
    let of_cells = fields("CELL_DATA", &[&long, &ab], 0b1000_0000, &[7, 8]);
    let binary = legacy(b"", &[of_points, of_cells].concat());
    let text = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
                0 0 0 1 0 0 1 1 0 0 1 0\nCELLS 2 8\n3 0 1 2 3 0 2 3\nCELL_TYPES 2\n5 5\nPOINT_DATA 4\nFIELD FieldData 3\n\
                name 1 4 string\nab\n3\n\nab\nflag 1 4 bit\n0 1 1 0\nn 1 4 int\n4 3 2 1\nCELL_DATA 2\nFIELD FieldData 3\n\
                name 1 2 string\n1\nab\nflag 1 2 bit\n1 0\nn 1 2 int\n7 8\n";
    for bytes in [binary, text.into()] {
        let (content, losses) = converted("a.vtk", bytes, Format::Vtu);
        let expected = "data of vertices that are text: name; data of elements that are text: name";
        assert_eq!(losses, expected);
        assert_eq!(cell_data(&content), [("flag", &[1.0, 0.0][..]), ("n", &[7.0, 8.0])]);
        let point_data = content.point_data().iter().map(|data| (data.name(), data.values()));
        let expected = [("flag", &[0.0, 1.0, 1.0, 0.0][..]), ("n", &[4.0, 3.0, 2.0, 1.0])];
        assert_eq!(point_data.collect::<Vec<_>>(), expected);
    }
}

/// Texts in text are numbers of characters, which must not become data or regions.
#[test]
fn texts_of_a_vtu_are_losses_and_bits_are_numbers() {
    let array = |kind: &str, name: &str, format: &str, content: &str| {
        format!("<Array type=\"{kind}\" Name=\"{name}\" format=\"{format}\">{content}</Array>\n")
    };
    let base64 =
        |bytes: &[u8]| STANDARD.encode([&(bytes.len() as u32).to_le_bytes()[..], bytes].concat());
    let texts = |format: &str| match format {
        "ascii" => "97 0 98 0".to_owned(),
        _ => base64(b"a\0b\0"),
    };
    for (format, flags) in [("ascii", "1 0".to_owned()), ("binary", base64(&[0b1000_0000]))] {
        let strings = array("String", "region", format, &texts(format));
        let bits = array("Bit", "flag", format, &flags);
        let data = format!(
            "<PointData>{}</PointData><CellData>{strings}{bits}</CellData>",
            array("String", "name", format, &texts(format))
        );
        let (content, losses) = converted("a.vtu", vtu(&data), Format::Vtk);
        let expected =
            "data of elements that are text: region; data of vertices that are text: name";
        assert_eq!(losses, expected, "{format}");
        assert_eq!(cell_data(&content), [("flag", &[1.0, 0.0][..])], "{format}");
        assert!(content.point_data().is_empty());
    }
}

/// VTK writes colors as bytes in binary, and as these bytes divided by 255 in text. A lookup table is no data, even if it
/// has as many colors as there are cells.
#[test]
fn colors_of_a_legacy_vtk_are_bytes_in_text_too() {
    let head = b"CELL_DATA 2\nCOLOR_SCALARS c 3\n";
    let table = b"\nSCALARS s int 1\nLOOKUP_TABLE t\n";
    let binary = [
        head,
        &[0, 51, 255, 1, 2, 3][..],
        table,
        &whole(&[5, 6], 4),
        b"\nLOOKUP_TABLE t 2\n",
        &[9; 8],
        b"\nSCALARS end int 1\nLOOKUP_TABLE default\n",
        &whole(&[7, 8], 4),
    ]
    .concat();
    let text = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
                0 0 0 1 0 0 1 1 0 0 1 0\nCELLS 2 8\n3 0 1 2 3 0 2 3\nCELL_TYPES 2\n5 5\nCELL_DATA 2\nCOLOR_SCALARS c 3\n\
                0 0.2 1 0.00392157 0.00784314 0.0117647\nSCALARS s int 1\nLOOKUP_TABLE t\n5 6\nLOOKUP_TABLE t 2\n0 0 0 1\n1 1 1 1\n\
                SCALARS end int 1\nLOOKUP_TABLE default\n7 8\n";
    for bytes in [legacy(b"", &binary), text.into()] {
        let (content, losses) = converted("a.vtk", bytes, Format::Vtu);
        let colors = [0.0, 51.0, 255.0, 1.0, 2.0, 3.0];
        let expected = [("c", &colors[..]), ("s", &[5.0, 6.0]), ("end", &[7.0, 8.0])];
        assert_eq!(cell_data(&content), expected);
        assert_eq!((content.cell_data()[0].is_real(), losses.as_str()), (false, ""));
    }
}

/// VTK 9.7 writes active scalars of the type `unsigned char` as colors, which may be regions.
#[test]
fn regions_of_a_legacy_vtk_may_be_colors() {
    let colors = "CELL_DATA 2\nCOLOR_SCALARS MaterialIDs 1\n0.027451 0.0352941 \n";
    let folder = Folder::new(&[("a.vtk", &legacy_text(colors))]);
    let file = folder.read("a.vtk");
    assert_eq!(file.regions(), Some(&[0, 1][..]));
    let tags: Vec<_> = file.groups().unwrap().iter().map(|group| group.tag).collect();
    assert_eq!(tags, [Some(7), Some(9)]);
}

/// Points of a pixel are in rows. DOLFINx writes linear cells as Lagrange cells of order 1.
#[test]
fn pixels_and_linear_lagrange_cells_are_read() {
    let vtk = |cells: &str, types: &str| {
        format!(
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n\
             0 0 5 1 0 5 0 1 5 1 1 5 2 0 5 2 1 5\nCELLS 3 {}\n{cells}\nCELL_TYPES 3\n{types}\n",
            cells.split_whitespace().count()
        )
    };
    let folder = Folder::new(&[]);
    folder.put("pixel.vtk", vtk("4 0 1 2 3\n3 1 4 5\n3 1 5 3", "8 5 5"));
    let file = folder.read("pixel.vtk");
    assert_eq!(file.quadrilaterals(), [[0, 1, 3, 2]]);
    folder.put("lagrange.vtk", vtk("4 0 1 3 2\n3 1 4 5\n3 1 5 3", "70 69 76"));
    let file = folder.read("lagrange.vtk");
    assert_eq!((file.quadrilaterals(), file.triangles().len()), (&[[0, 1, 3, 2]][..], 2));
    // The third coordinate that all points have is a loss too.
    let (_, losses) = converted("c.vtk", vtk("3 0 1 3\n3 1 4 5\n3 1 5 3", "5 5 5"), Format::Su2);
    assert_eq!(losses, "third coordinates");
}

/// Returns a text legacy VTK of two triangles, with data after the cells.
fn legacy_text(data: &str) -> String {
    format!(
        "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
         0 0 0 1 0 0 1 1 0 0 1 0\nCELLS 2 8\n3 0 1 2\n3 0 2 3\nCELL_TYPES 2\n5\n5\n{data}"
    )
}

/// VTK 9.7 writes the names of components a line each, and an empty line for a component without a name.
#[test]
fn metadata_with_empty_names_of_components_hides_no_later_array() {
    let names = "METADATA\nCOMPONENT_NAMES\n\n\nZ\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\n\
                 DATA 2 2.2 7 \n\n";
    let one = "METADATA\nCOMPONENT_NAMES\n\n\n";
    let text = format!(
        "CELL_DATA 2\nVECTORS a double\n0 1 2\n3 4 5\n{names}SCALARS b int\nLOOKUP_TABLE default\n1 2\n{one}\
         FIELD FieldData 3\nc 3 2 double\n0 1 2 3 4 5 \n{names}d 1 2 int\n3 4\n{one}MaterialIDs 1 2 int\n7 9\n{one}\
         POINT_DATA 4\nFIELD FieldData 1\nq 1 4 int\n1 2 3 4\n"
    );
    let text = legacy_text(&text);
    let before = format!("FIELD FieldData 2\ne 3 1 int\n1 2 3\n{names}f 1 1 int\n1\n{one}POINTS");
    let named = text.replace("POINTS", &before);
    let named = named.replace("CELLS", &format!("{names}CELLS"));
    for text in [text, named] {
        let folder = Folder::new(&[("a.vtk", &text)]);
        let read = folder.read("a.vtk");
        assert_eq!(read.regions(), Some(&[0, 1][..]));
        let content = read.content().unwrap();
        let arrays: Vec<_> = cell_data(&content).iter().map(|data| data.0).collect();
        assert_eq!(arrays, ["a", "b", "c", "d"]);
        assert_eq!(content.point_data()[0].values(), [1.0, 2.0, 3.0, 4.0]);
    }
    // In version 5, the lists of cells are arrays too.
    let cells = format!(
        "CELLS 3 6\nOFFSETS vtktypeint64\n0 3 6\n{one}CONNECTIVITY vtktypeint64\n0 1 2 0 2 3\n{one}CELL_TYPES"
    );
    let text = legacy_text("").replace("CELLS 2 8\n3 0 1 2\n3 0 2 3\nCELL_TYPES", &cells);
    let folder = Folder::new(&[("a.vtk", &text)]);
    assert_eq!(folder.read("a.vtk").triangles(), [[0, 1, 2], [0, 2, 3]]);
}

/// Some programs write information before the points, and behind the number of points or cells.
#[test]
fn metadata_in_other_places_is_passed_over() {
    let information = "METADATA\nINFORMATION 1\nNAME KEY LOCATION vtk\nDATA 5\n\n";
    let data = format!(
        "CELL_DATA 2\n{information}SCALARS a int\nLOOKUP_TABLE default\n1 2\nPOINT_DATA 4\n{information}\
         SCALARS b int\nLOOKUP_TABLE default\n1 2 3 4\n"
    );
    let text = legacy_text(&data).replace("POINTS", &format!("{information}POINTS"));
    let folder = Folder::new(&[("a.vtk", &text)]);
    let content = folder.read("a.vtk").content().unwrap();
    assert_eq!(cell_data(&content), [("a", &[1.0, 2.0][..])]);
    assert_eq!(content.point_data()[0].values(), [1.0, 2.0, 3.0, 4.0]);
}

/// A word behind the last array is a note. Only an attribute that has data is a loss.
#[test]
fn a_last_word_of_a_legacy_vtk_is_no_loss() {
    let array = "CELL_DATA 2\nSCALARS a int\nLOOKUP_TABLE default\n1 2\n";
    for (end, lost) in [
        ("END\n", ""),
        ("TWISTS t\n1 2\n", "data from the attribute `TWISTS` on, which is damaged or not known"),
    ] {
        let text = legacy_text(&format!("{array}{end}"));
        let (content, losses) = converted("a.vtk", text.clone(), Format::Vtu);
        assert_eq!((cell_data(&content), &*losses), (vec![("a", &[1.0, 2.0][..])], lost));
        let notes = Folder::new(&[("a.vtk", &text)]).read("a.vtk").remarks().len();
        assert_eq!(notes, 1, "{end}");
    }
}

/// VTK writes number signs in names as they are.
#[test]
fn number_signs_of_a_legacy_vtk_belong_to_names_not_to_comments() {
    let data = "CELL_DATA 2\nSCALARS a#1 int 1\nLOOKUP_TABLE #t\n1 2\nSCALARS #b int\nLOOKUP_TABLE default\n\
                3 4\nLOOKUP_TABLE #t 2\n0 0 0 1\n1 1 1 1\nFIELD #f 3\n# a comment of four\n#c 1 2 int\n5 6\n\n\
                c#d 1 2 int # values\n7 8\nMaterialIDs 1 2 int\n7 9\nPOINT_DATA 4\nVECTORS #q double\n\
                0 1 2 3 4 5 6 7 8 9 10 11\n";
    let field = "FIELD #f 1\n#e 1 2 int\n1 2\nPOINTS";
    let text = legacy_text(data).replace("POINTS", field);
    let folder = Folder::new(&[("a.vtk", &text)]);
    let read = folder.read("a.vtk");
    assert_eq!(read.regions(), Some(&[0, 1][..]));
    let content = read.content().unwrap();
    let expected: [(&str, &[f64]); 4] =
        [("a#1", &[1., 2.]), ("#b", &[3., 4.]), ("#c", &[5., 6.]), ("c#d", &[7., 8.])];
    assert_eq!(cell_data(&content), expected);
    assert_eq!(content.point_data()[0].name(), "#q");
    let whole = |numbers: &[i64]| whole(numbers, 4);
    let (ids, regions) = (whole(&[1, 2]), whole(&[7, 9]));
    let data = [b"CELL_DATA 2\nFIELD f 2\n#c 1 2 int\n", &ids[..], b"\nMaterialIDs 1 2 int\n"];
    let (content, _) =
        converted("a.vtk", legacy(b"", &[&data.concat(), &regions[..]].concat()), Format::Vtk);
    assert_eq!(cell_data(&content), [("#c", &[1.0, 2.0][..])]);
}

/// VTK numbers the cells of polygonal data by kind: vertices, lines, polygons. Lists may stand in another order.
#[test]
fn cell_data_of_polygonal_data_follow_the_order_of_vtk() {
    let points = "POINTS 4 double\n0 0 0 1 0 0 1 1 0 0 1 0\n";
    let polygons = "POLYGONS 2 8\n3 0 1 2\n3 0 2 3\n";
    let (lines, vertices) = ("LINES 1 3\n2 0 1\n", "VERTICES 1 2\n1 0\n");
    for lists in [[polygons, lines, vertices], [vertices, lines, polygons]] {
        let text = format!(
            "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\n{points}{}CELL_DATA 4\n\
             FIELD FieldData 2\nmaterialids 1 4 int\n1 2 7 9\nn 1 4 double\n10 20 30 40\n",
            lists.concat()
        );
        let folder = Folder::new(&[("a.vtk", &text)]);
        let read = folder.read("a.vtk");
        assert_eq!(read.regions(), Some(&[0, 1][..]));
        let content = read.content().unwrap();
        let vertices = content.cells().map(|cell| cell.vertices.to_vec());
        assert_eq!(content.cell_data()[0].name(), "n");
        let values = content.cell_data()[0].values().iter().copied();
        let expected =
            [(vec![0], 10.), (vec![0, 1], 20.), (vec![0, 1, 2], 30.), (vec![0, 2, 3], 40.)];
        assert_eq!(vertices.zip(values).collect::<Vec<_>>(), expected);
    }
}

/// Data may hold the regions, so data that are not read are a note and a loss.
#[test]
fn data_of_a_legacy_vtk_from_a_damaged_attribute_on_are_listed() {
    let end = "\nSCALARS MaterialIDs int\nLOOKUP_TABLE default\n7 9\n";
    for (attribute, keyword) in [
        ("SHAPES s int\n1 2", "SHAPES"),
        ("VECTORS v\n0 1 2 3 4 5", "VECTORS"),
        ("FIELD f 2\na 1 2 int\n1 2", "FIELD"),
    ] {
        let text = legacy_text(&format!("CELL_DATA 2\n{attribute}{end}"));
        let folder = Folder::new(&[("a.vtk", &text)]);
        let expected =
            format!("data from the attribute `{keyword}` on, which is damaged or not known");
        let read = folder.read("a.vtk");
        assert_eq!(remarks(&read), [format!("the file has {expected}: they are not read")]);
        let (_, losses) = converted("a.vtk", &text, Format::Vtu);
        assert_eq!(losses, expected);
    }
}

/// Note on regions that cannot be read.
const UNREAD: &str =
    "the cell data `region` number no regions, as not all are finite numbers that can be read";

/// Vertices between regions stay, so a reader must not drop regions without a word.
#[test]
fn regions_that_cannot_be_read_are_a_note() {
    for (numbers, notes) in [("1 2", &[][..]), ("1 none", &[UNREAD])] {
        let array = format!("<DataArray type=\"Int32\" Name=\"region\">{numbers}</DataArray>");
        let xdmf = format!(
            "<Xdmf><Domain><Grid><Topology TopologyType=\"Triangle\"><DataItem NumberType=\"Int\">0 1 2 0 2 3\
             </DataItem></Topology><Geometry GeometryType=\"XY\"><DataItem>0 0 1 0 1 1 0 1</DataItem></Geometry>\
             <Attribute Name=\"region\" Center=\"Cell\"><DataItem NumberType=\"Int\">{numbers}</DataItem></Attribute>\
             </Grid></Domain></Xdmf>"
        );
        let vtu = vtu(&format!("<CellData>{array}</CellData>"));
        let (head, piece) = vtu.split_once("<Piece").unwrap();
        let (piece, tail) = piece.split_once("</Piece>").unwrap();
        let first = piece.replace(numbers, "1 2");
        let pieces = format!("{head}<Piece{first}</Piece><Piece{piece}</Piece>{tail}");
        let folder = Folder::new(&[("a.vtu", &vtu), ("a.xdmf", &xdmf), ("pieces.vtu", &pieces)]);
        for name in ["a.vtu", "a.xdmf", "pieces.vtu"] {
            let file = folder.read(name);
            assert_eq!(remarks(&file), notes, "{name}");
            let has_regions = notes.is_empty() || name == "pieces.vtu";
            assert_eq!(file.regions().is_some(), has_regions, "{name}");
        }
    }
}

/// ParaView's filters write NaN where they have no number.
#[test]
fn regions_that_are_not_finite_hide_no_later_array() {
    let data = "CELL_DATA 2\nFIELD f 3\nregion 1 2 double\nnan 2\nMaterialIDs 1 2 int\n7 9\nn 1 2 int\n1 2\n";
    let folder = Folder::new(&[("a.vtk", &legacy_text(data))]);
    let file = folder.read("a.vtk");
    assert_eq!(file.regions(), Some(&[0, 1][..]));
    assert_eq!(remarks(&file), [UNREAD]);
    let content = file.content().unwrap();
    let names: Vec<_> = cell_data(&content).iter().map(|data| data.0).collect();
    assert_eq!(names, ["region", "n"]);
}
