//! Finds the cell data that number the regions of a mesh, in files that name no regions.

use crate::content::remark::Remark;
use crate::disk::source::Source;
use crate::error::ReadError;
use crate::format::Format;
use crate::visit::cell_values::cell_values;
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
    let triangles = parsed.triangles.len();
    if let Some(name) = &source.options.regions {
        let values = cell_values(reader, source, std::slice::from_ref(name))?.concat();
        if values.is_empty() {
            return Err(source.error(format!("it has no cell data `{name}`"), known(parsed)));
        }
        let is_complete = !values.iter().any(|value| value.is_nan());
        let Some(numbers) = numbered(&values, triangles).filter(|_| is_complete) else {
            let problem = format!("the cell data `{name}` are not a whole number for each element");
            return Err(source.error(problem, known(parsed)));
        };
        set(parsed, name, numbers);
        return Ok(());
    }
    let is_whole = |name: &&String| !parsed.fractional.contains(*name);
    let names: Vec<String> = parsed.cell_arrays.iter().filter(is_whole).cloned().collect();
    if names.is_empty() {
        return Ok(());
    }
    let all = cell_values(reader, source, &names)?;
    let mut found = names.into_iter().zip(all).filter_map(|(name, values)| {
        let numbers = numbered(&values, triangles)?;
        looks_like_regions(&numbers, parsed.elements()).then_some((name, numbers))
    });
    if let Some(own) = own_regions(parsed) {
        let divides = |(_, numbers): &(_, Vec<u32>)| divides(numbers, &own, parsed.elements());
        let others: Vec<String> = found.filter(divides).map(|(name, _)| name).collect();
        if !others.is_empty() {
            parsed.remarks.push(Remark::FurtherRegionArrays(others));
        }
    } else if let Some((array, numbers)) = found.next() {
        let others = found.map(|(name, _)| name).collect();
        set(parsed, &array, numbers);
        parsed.remarks.push(Remark::RegionArray { array, others });
    }
    Ok(())
}

/// Returns the region of each element; `None` if the file has no regions under a usual name.
fn own_regions(parsed: &ParsedMesh) -> Option<Vec<u32>> {
    let regions: Vec<u32> = parsed.element_regions().collect();
    let differ = |regions: &[u32]| regions.iter().any(|region| *region != regions[0]);
    let (triangles, quadrilaterals) = regions.split_at(parsed.triangles.len());
    let is_divided = match parsed.format {
        // A block or section has elements of one kind, so that one for each kind is no division by the user.
        Format::Exodus | Format::Cgns => differ(triangles) || differ(quadrilaterals),
        _ => differ(&regions),
    };
    is_divided.then_some(regions)
}

/// Sets the regions of a mesh to the numbers of the cell data `array`, those of triangles first.
fn set(parsed: &mut ParsedMesh, array: &str, mut numbers: Vec<u32>) {
    parsed.quadrilateral_regions = numbers.split_off(parsed.triangles.len());
    parsed.regions = Some(numbers).filter(|all| all.iter().any(|&region| region != 0));
    parsed.region_array = Some(array.to_owned());
}

/// Returns whether two elements with a common edge have one region of `regions`, but two different numbers.
fn divides<'e>(
    numbers: &[u32],
    regions: &[u32],
    elements: impl Iterator<Item = &'e [u32]> + Clone,
) -> bool {
    let mut both: HashMap<[u32; 2], u32> = HashMap::new();
    let pairs = numbers.iter().zip(regions).map(|(&number, &region)| {
        let next = both.len() as u32;
        *both.entry([number, region]).or_insert(next)
    });
    let together: Vec<u32> = pairs.collect();
    connected_parts(&together, elements.clone()) > connected_parts(regions, elements)
}

/// Returns the remedy that lists the cell data of a mesh.
fn known(parsed: &ParsedMesh) -> String {
    match &parsed.cell_arrays[..] {
        [] => "The file has no cell data with one number per cell".to_owned(),
        names => format!("Its cell data are `{}`", names.join("`, `")),
    }
}

/// Numbers the values of elements by first occurrence, from 0; the first `triangles` values are those of triangles. If all
/// elements of one kind lack values, they have a number of their own. `None` if another value is not a whole number.
fn numbered(values: &[f64], triangles: usize) -> Option<Vec<u32>> {
    let (of_triangles, of_quadrilaterals) = values.split_at_checked(triangles)?;
    let mut numbers: HashMap<Option<i64>, u32> = HashMap::new();
    let mut all = Vec::with_capacity(values.len());
    for values in [of_triangles, of_quadrilaterals] {
        // Exodus and gmsh may have values for the elements of one kind alone.
        let is_missing = values.iter().all(|value| value.is_nan());
        for value in values {
            // Whole numbers up to 2^53 are exact.
            let is_whole = value.fract() == 0.0 && value.abs() <= 9.0e15;
            if !is_whole && !is_missing {
                return None;
            }
            let next = numbers.len() as u32;
            all.push(*numbers.entry(is_whole.then_some(*value as i64)).or_insert(next));
        }
    }
    Some(all)
}

/// Returns whether numbers of elements look like regions: several numbers, but few, whose elements are connected in large
/// parts.
fn looks_like_regions<'e>(numbers: &[u32], elements: impl Iterator<Item = &'e [u32]>) -> bool {
    let count = numbers.iter().max().map_or(0, |&most| most as usize + 1);
    let is_few = (2..=MAX_REGIONS).contains(&count) && count * 2 <= numbers.len();
    is_few && {
        let parts = connected_parts(numbers, elements);
        parts == count || parts * MIN_PART <= numbers.len()
    }
}

/// Returns the number of parts of elements that are connected across edges and have equal regions.
fn connected_parts<'e>(regions: &[u32], elements: impl Iterator<Item = &'e [u32]>) -> usize {
    let mut parent: Vec<u32> = (0..regions.len() as u32).collect();
    fn root(parent: &mut [u32], mut t: u32) -> u32 {
        while parent[t as usize] != t {
            parent[t as usize] = parent[parent[t as usize] as usize];
            t = parent[t as usize];
        }
        t
    }
    let mut parts = regions.len();
    // A triangle has one and a half edges of its own, a quadrilateral two.
    let mut edges: HashMap<[u32; 2], u32> = HashMap::with_capacity(regions.len() * 3 / 2);
    for (t, element) in (0..).zip(elements) {
        for (k, &p) in element.iter().enumerate() {
            let q = element[(k + 1) % element.len()];
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

    /// A strip of `count` elements, of which every other one is a quadrilateral.
    fn strip(count: u32) -> Vec<Vec<u32>> {
        let (mut end, mut next) = ([0, 1], 2);
        let element = |t: u32| {
            let ([a, b], new) = (end, next);
            if t.is_multiple_of(2) {
                (end, next) = ([b, new], new + 1);
                vec![a, b, new]
            } else {
                (end, next) = ([new, new + 1], new + 2);
                vec![a, b, new + 1, new]
            }
        };
        (0..count).map(element).collect()
    }

    #[test]
    fn few_whole_numbers_in_large_parts_look_like_regions() {
        let looks = |number: &dyn Fn(u32) -> f64, count| {
            let values: Vec<f64> = (0..count).map(number).collect();
            let strip = strip(count);
            numbered(&values, 7).is_some_and(|numbers| {
                looks_like_regions(&numbers, strip.iter().map(Vec::as_slice))
            })
        };
        assert!(looks(&|t| f64::from(t / 20), 40));
        assert!(looks(&|t| f64::from(t / 10 % 2) - 5.0, 40), "two regions of two parts");
        assert!(looks(&|t| f64::from(t / 4), 8), "small but connected");
        assert!(!looks(&|t| f64::from(t), 40), "a number of its own for each element");
        assert!(!looks(&|t| f64::from(t % 2), 40), "flags of single elements");
        assert!(!looks(&|_| 3.0, 40), "one region");
        assert!(!looks(&|t| 0.5 + f64::from(t / 20), 40), "fractions");
        assert!(!looks(&|t| if t < 20 { 1.0 } else { f64::NAN }, 40), "missing values");
        assert!(looks(&|t| if t < 7 { 1.0 } else { f64::NAN }, 40), "no values of one kind");
    }

    #[test]
    fn numbers_divide_regions_that_they_cut() {
        let strip = strip(40);
        let by = |size: u32| (0..40).map(|t| t / size).collect::<Vec<u32>>();
        let divides = |numbers: u32, regions: u32| {
            divides(&by(numbers), &by(regions), strip.iter().map(Vec::as_slice))
        };
        assert!(divides(10, 20) && !divides(20, 10));
        assert!(!divides(20, 20) && divides(8, 20));
    }

    #[test]
    fn parts_are_connected_across_edges() {
        let parts = |regions: &[u32], elements: &[Vec<u32>]| {
            connected_parts(regions, elements.iter().map(Vec::as_slice))
        };
        assert_eq!(parts(&[0; 5], &strip(5)), 1);
        assert_eq!(parts(&[0, 0, 1, 0, 0], &strip(5)), 3);
        let apart = [vec![0, 1, 2], vec![2, 3, 4, 5]];
        assert_eq!(parts(&[0, 0], &apart), 2, "a common vertex alone");
    }
}
