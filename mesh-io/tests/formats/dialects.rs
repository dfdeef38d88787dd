//! Layouts of formats that programs write and that the formats' manuals do not have.

use super::Folder;
use super::made::base;
use super::made::binary::selafin;
use mesh_io::Precision;

#[test]
fn the_length_of_records_decides_the_precision_of_a_selafin_whatever_its_title() {
    let mesh = base();
    for precision in [Precision::Single, Precision::Double] {
        for big in [false, true] {
            for title in ["SERAFIN ", "SERAFIND", "        ", "written"] {
                let mut made = selafin(&mesh, precision, big, 1);
                made.bytes[76..84].copy_from_slice(format!("{title:<8}").as_bytes());
                let folder = Folder::new(&[]);
                folder.put("in.slf", &made.bytes);
                let file = folder.read("in.slf");
                assert_eq!((file.precision(), file.points()), (precision, &made.points()[..]));
                file.write(&folder.path("out.slf"), file.points()).unwrap();
                assert!(std::fs::read(folder.path("out.slf")).unwrap() == made.bytes);
            }
        }
    }
}
