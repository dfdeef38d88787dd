//! Finds the cell data that number the regions of a mesh, in files that name no regions.

use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::visit::cell_values::cell_values;
use crate::visit::items::CellKind;
use crate::visit::parsed_mesh::ParsedMesh;
use crate::visit::reader::ReaderFunctions;
use std::collections::HashMap;

/// Largest number of regions that an array without a usual name may have.
const MAX_REGIONS: usize = 1000;
/// Smallest mean number of triangles in the connected parts of regions, unless each region is connected. Flags of single
/// elements, such as marks for refinement, have smaller parts.
const MIN_PART: usize = 8;

/// Sets the regions of a mesh by cell data: by the array that the options of reading name, else, if the file has no
/// region under a usual name, by the first array that looks like regions. A remark names the arrays that look like
/// regions.
///
/// # Errors
/// If the options name an array that the file lacks, or that has other than whole numbers. If the file cannot be read.
pub(super) fn find(
    parsed: &mut ParsedMesh,
    reader: &ReaderFunctions,
    source: &Source,
) -> Result<(), ReadError> {
    if let Some(name) = &source.options.regions {
        let (values, of_quadrilaterals) = both(parsed, reader, source, name)?;
        if values.is_empty() && of_quadrilaterals.is_empty() {
            return Err(source.error(format!("it has no cell data `{name}`"), known(parsed)));
        }
        let Some((regions, others)) = numbered_both(&values, &of_quadrilaterals) else {
            let problem = format!("the cell data `{name}` are not a whole number for each element");
            return Err(source.error(problem, known(parsed)));
        };
        parsed.regions = regions.iter().any(|&region| region != 0).then_some(regions);
        parsed.region_array = Some(name.clone());
        parsed.quadrilateral_regions = others;
        return Ok(());
    }
    let is_whole = |name: &&String| !parsed.fractional.contains(*name);
    let names: Vec<String> = parsed.cell_arrays.iter().filter(is_whole).cloned().collect();
    if names.is_empty() {
        return Ok(());
    }
    if parsed.triangles.is_empty() {
        return find_alone(parsed, reader, source, names);
    }
    let all = cell_values(reader, source, &names, CellKind::Triangle)?;
    let mut found = names.into_iter().zip(all).filter_map(|(name, values)| {
        let regions = numbered(&values)?;
        looks_like_regions(&regions, &parsed.triangles).then_some((name, regions))
    });
    if let Some(own) = &parsed.regions {
        let divides = |(_, regions): &(String, Vec<u32>)| divides(regions, own, &parsed.triangles);
        let others: Vec<_> = found.filter(divides).map(|(name, _)| name).collect();
        if !others.is_empty() {
            parsed.remarks.push(Remark::FurtherRegionArrays(others));
        }
    } else if let Some((array, regions)) = found.next() {
        let others = found.map(|(name, _)| name).collect();
        let (values, of_quadrilaterals) = both(parsed, reader, source, &array)?;
        if let Some((_, numbers)) = numbered_both(&values, &of_quadrilaterals) {
            parsed.quadrilateral_regions = numbers;
        }
        parsed.regions = Some(regions);
        parsed.region_array = Some(array.clone());
        parsed.remarks.push(Remark::RegionArray { array, others });
    }
    Ok(())
}

/// Sets the regions of a mesh of quadrilaterals alone by the first of the named arrays that looks like regions, unless elements
/// have regions under a usual name.
fn find_alone(
    parsed: &mut ParsedMesh,
    reader: &ReaderFunctions,
    source: &Source,
    names: Vec<String>,
) -> Result<(), ReadError> {
    let own = &parsed.quadrilateral_regions;
    if own.iter().any(|region| *region != own[0]) {
        return Ok(());
    }
    let all = cell_values(reader, source, &names, CellKind::Quadrilateral)?;
    let mut found = names.into_iter().zip(all).filter_map(|(name, values)| {
        let regions = numbered(&values)?;
        looks_like_regions(&regions, &parsed.quadrilaterals).then_some((name, regions))
    });
    if let Some((array, regions)) = found.next() {
        let others = found.map(|(name, _)| name).collect();
        parsed.quadrilateral_regions = regions;
        parsed.region_array = Some(array.clone());
        parsed.remarks.push(Remark::RegionArray { array, others });
    }
    Ok(())
}

/// Returns the values of an array at the triangles and at the quadrilaterals.
fn both(
    parsed: &ParsedMesh,
    reader: &ReaderFunctions,
    source: &Source,
    name: &str,
) -> Result<(Vec<f64>, Vec<f64>), ReadError> {
    let wanted = [name.to_owned()];
    let of = |kind| cell_values(reader, source, &wanted, kind).map(|all| all.concat());
    let of_quadrilaterals = match parsed.quadrilaterals.is_empty() {
        true => Vec::new(),
        false => of(CellKind::Quadrilateral)?,
    };
    Ok((of(CellKind::Triangle)?, of_quadrilaterals))
}

/// Numbers the values of triangles and then of quadrilaterals by first occurrence, from 0. `None` if a value is not a whole
/// number.
fn numbered_both(triangles: &[f64], quadrilaterals: &[f64]) -> Option<(Vec<u32>, Vec<u32>)> {
    let mut numbers = numbered(&[triangles, quadrilaterals].concat())?;
    let of_quadrilaterals = numbers.split_off(triangles.len());
    Some((numbers, of_quadrilaterals))
}

/// Returns whether two triangles with a common edge have one region of `regions`, but two different numbers.
fn divides(numbers: &[u32], regions: &[u32], triangles: &[[u32; 3]]) -> bool {
    let mut both: HashMap<[u32; 2], u32> = HashMap::new();
    let pairs = numbers.iter().zip(regions).map(|(&number, &region)| {
        let next = both.len() as u32;
        *both.entry([number, region]).or_insert(next)
    });
    let together: Vec<u32> = pairs.collect();
    connected_parts(&together, triangles) > connected_parts(regions, triangles)
}

/// Returns the remedy that lists the cell data of a mesh.
fn known(parsed: &ParsedMesh) -> String {
    match &parsed.cell_arrays[..] {
        [] => "The file has no cell data with one number per cell".to_owned(),
        names => format!("Its cell data are `{}`", names.join("`, `")),
    }
}

/// Numbers the values of triangles by first occurrence, from 0. `None` if a value is not a whole number.
fn numbered(values: &[f64]) -> Option<Vec<u32>> {
    let mut numbers: HashMap<i64, u32> = HashMap::new();
    let number = |&value: &f64| {
        // Whole numbers up to 2^53 are exact.
        let is_whole = value.fract() == 0.0 && value.abs() <= 9.0e15;
        let next = numbers.len() as u32;
        is_whole.then(|| *numbers.entry(value as i64).or_insert(next))
    };
    (!values.is_empty()).then(|| values.iter().map(number).collect())?
}

/// Returns whether numbers of elements look like regions: several numbers, but few, whose elements are connected in large
/// parts.
fn looks_like_regions<const N: usize>(regions: &[u32], elements: &[[u32; N]]) -> bool {
    let count = regions.iter().max().map_or(0, |&most| most as usize + 1);
    let is_few = (2..=MAX_REGIONS).contains(&count) && count * 2 <= regions.len();
    is_few && {
        let parts = connected_parts(regions, elements);
        parts == count || parts * MIN_PART <= regions.len()
    }
}

/// Returns the number of parts of elements that are connected across edges and have equal regions.
fn connected_parts<const N: usize>(regions: &[u32], elements: &[[u32; N]]) -> usize {
    let mut parent: Vec<u32> = (0..elements.len() as u32).collect();
    fn root(parent: &mut [u32], mut t: u32) -> u32 {
        while parent[t as usize] != t {
            parent[t as usize] = parent[parent[t as usize] as usize];
            t = parent[t as usize];
        }
        t
    }
    let mut parts = elements.len();
    let mut edges: HashMap<[u32; 2], u32> = HashMap::with_capacity(elements.len() * N / 2);
    for (t, element) in (0..).zip(elements) {
        for k in 0..N {
            let (p, q) = (element[k], element[(k + 1) % N]);
            let other = *edges.entry([p.min(q), p.max(q)]).or_insert(t);
            if regions[other as usize] == regions[t as usize] {
                let (one, two) = (root(&mut parent, other), root(&mut parent, t));
                if one != two {
                    parent[two as usize] = one;
                    parts -= 1;
                }
            }
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of `count` triangles.
    fn strip(count: u32) -> Vec<[u32; 3]> {
        (0..count).map(|t| [t, t + 1, t + 2]).collect()
    }

    #[test]
    fn few_whole_numbers_in_large_parts_look_like_regions() {
        let looks = |number: &dyn Fn(u32) -> f64, count| {
            let values: Vec<f64> = (0..count).map(number).collect();
            numbered(&values).is_some_and(|regions| looks_like_regions(&regions, &strip(count)))
        };
        assert!(looks(&|t| f64::from(t / 20), 40));
        assert!(looks(&|t| f64::from(t / 10 % 2) - 5.0, 40), "two regions of two parts");
        assert!(looks(&|t| f64::from(t / 2), 4), "small but connected");
        assert!(!looks(&|t| f64::from(t), 40), "a number of its own for each triangle");
        assert!(!looks(&|t| f64::from(t % 2), 40), "flags of single triangles");
        assert!(!looks(&|_| 3.0, 40), "one region");
        assert!(!looks(&|t| 0.5 + f64::from(t / 20), 40), "fractions");
        assert!(!looks(&|t| if t < 20 { 1.0 } else { f64::NAN }, 40), "missing values");
    }

    #[test]
    fn numbers_divide_regions_that_they_cut() {
        let strip = strip(40);
        let by = |size: u32| (0..40).map(|t| t / size).collect::<Vec<u32>>();
        assert!(divides(&by(10), &by(20), &strip) && !divides(&by(20), &by(10), &strip));
        assert!(!divides(&by(20), &by(20), &strip) && divides(&by(8), &by(20), &strip));
    }

    #[test]
    fn parts_are_connected_across_edges() {
        assert_eq!(connected_parts(&[0; 5], &strip(5)), 1);
        assert_eq!(connected_parts(&[0, 0, 1, 0, 0], &strip(5)), 3);
        assert_eq!(connected_parts(&[0, 0], &[[0, 1, 2], [2, 3, 4]]), 2, "a common vertex alone");
    }
}
