//! Packs many arrays into few buffers, each no larger than the device's largest binding.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::filled_with_pauses;
use crate::gpu::device::size::check_limit;

/// Arrays, grouped into pages. Each page becomes a buffer, in which its arrays follow each other.
pub(crate) struct Pages<'a, T> {
    what: &'static str,
    /// The largest size of a page, in bytes.
    most: u64,
    pages: Vec<Page<'a, T>>,
}

struct Page<'a, T> {
    arrays: Vec<&'a [T]>,
    /// Number of elements of all arrays.
    length: usize,
}

impl<'a, T: bytemuck::NoUninit + Sync> Pages<'a, T> {
    /// Creates an empty set of pages. `what` names the content in labels and errors.
    pub(crate) fn new(gpu: &Gpu, what: &'static str) -> Self {
        let limits = gpu.device.limits();
        Self::of_size(what, limits.max_storage_buffer_binding_size.min(limits.max_buffer_size))
    }

    fn of_size(what: &'static str, most: u64) -> Self {
        Self { what, most, pages: vec![Page { arrays: Vec::new(), length: 0 }] }
    }

    /// Places arrays that a kernel binds together in one page. Returns the index of the page, and the offset of each
    /// array in the page, in elements.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the arrays together exceed a page.
    pub(crate) fn place<const N: usize>(
        &mut self,
        arrays: [&'a [T]; N],
    ) -> Result<(usize, [u32; N]), GpuError> {
        let bytes = |length: usize| (length * size_of::<T>()) as u64;
        let length = arrays.iter().map(|array| array.len()).sum();
        let what = || format!("the {}", self.what);
        check_limit("max_storage_buffer_binding_size", self.most, &what, bytes(length))?;
        let mut last = self.pages.len() - 1;
        if bytes(self.pages[last].length + length) > self.most {
            self.pages.push(Page { arrays: Vec::new(), length: 0 });
            last += 1;
        }
        let page = &mut self.pages[last];
        let places = arrays.map(|array| {
            let place = page.length as u32;
            page.arrays.push(array);
            page.length += array.len();
            place
        });
        Ok((last, places))
    }

    /// Uploads the pages.
    pub(crate) async fn upload(&self, gpu: &Gpu) -> Result<Vec<wgpu::Buffer>, GpuError> {
        let mut buffers = Vec::new();
        for page in &self.pages {
            buffers.push(filled_with_pauses(gpu, self.what, &page.arrays, Usage::STORAGE).await?);
        }
        Ok(buffers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_placed_together_are_in_one_page() {
        let mut pages = Pages::of_size("numbers", 16);
        assert_eq!(pages.place([&[1u32, 2][..], &[3]]).unwrap(), (0, [0, 2]));
        assert_eq!(pages.place([&[4][..]]).unwrap(), (0, [3]));
        assert_eq!(pages.place([&[5][..], &[6, 7, 8]]).unwrap(), (1, [0, 1]));
        assert_eq!(pages.place([&[9][..]]).unwrap(), (2, [0]));
        let contents: Vec<_> = pages.pages.iter().map(|page| page.arrays.concat()).collect();
        assert_eq!(contents, [vec![1, 2, 3, 4], vec![5, 6, 7, 8], vec![9]]);
        let error = pages.place([&[0; 3][..], &[0; 2]]).unwrap_err();
        assert!(matches!(error, GpuError::Limit { needed: 20, available: 16, .. }), "{error}");
    }
}
