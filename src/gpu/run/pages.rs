//! Packs many arrays into few buffers, each no larger than the device's largest binding.

use wgpu::BufferUsages as Usage;

use crate::error::GpuError;
use crate::gpu::device::Gpu;
use crate::gpu::device::buffers::filled_with_pauses;
use crate::gpu::device::size::check_limit;
use crate::parallel::paced;

/// Number of elements that are copied between two pauses.
const CHUNK: usize = 1 << 16;

/// Arrays, grouped into pages. Each page becomes a buffer.
pub(crate) struct Pages<T> {
    what: &'static str,
    /// The largest size of a page, in bytes.
    most: u64,
    pages: Vec<Vec<T>>,
}

impl<T: bytemuck::NoUninit + Send + Sync> Pages<T> {
    /// Creates an empty set of pages. `what` names the content in labels and errors.
    pub(crate) fn new(gpu: &Gpu, what: &'static str) -> Self {
        let limits = gpu.device.limits();
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        Self { what, most, pages: vec![Vec::new()] }
    }

    /// Places arrays that a kernel binds together in one page. Returns the index of the page, and the offset of each
    /// array in the page, in elements.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the arrays together exceed a page.
    pub(crate) async fn place<const N: usize>(
        &mut self,
        arrays: [&[T]; N],
    ) -> Result<(usize, [u32; N]), GpuError> {
        let bytes = |length: usize| (length * size_of::<T>()) as u64;
        let length = arrays.iter().map(|array| array.len()).sum();
        let what = || format!("the {}", self.what);
        check_limit("max_storage_buffer_binding_size", self.most, &what, bytes(length))?;
        let mut last = self.pages.len() - 1;
        if bytes(self.pages[last].len() + length) > self.most {
            self.pages.push(Vec::with_capacity(length));
            last += 1;
        }
        let page = &mut self.pages[last];
        let mut places = [0; N];
        for (array, place) in arrays.into_iter().zip(&mut places) {
            *place = page.len() as u32;
            paced::in_order(array.len(), CHUNK, |range| page.extend_from_slice(&array[range]))
                .await;
        }
        Ok((last, places))
    }

    /// Uploads the pages.
    pub(crate) async fn upload(&self, gpu: &Gpu) -> Result<Vec<wgpu::Buffer>, GpuError> {
        let mut buffers = Vec::new();
        for page in &self.pages {
            buffers.push(filled_with_pauses(gpu, self.what, page, Usage::STORAGE).await?);
        }
        Ok(buffers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::pace::now;

    #[test]
    fn arrays_placed_together_are_in_one_page() {
        let mut pages = Pages { what: "numbers", most: 16, pages: vec![Vec::new()] };
        assert_eq!(now(pages.place([&[1u32, 2][..], &[3]])).unwrap(), (0, [0, 2]));
        assert_eq!(now(pages.place([&[4][..]])).unwrap(), (0, [3]));
        assert_eq!(now(pages.place([&[5][..], &[6, 7, 8]])).unwrap(), (1, [0, 1]));
        assert_eq!(now(pages.place([&[9][..]])).unwrap(), (2, [0]));
        assert_eq!(pages.pages, [vec![1, 2, 3, 4], vec![5, 6, 7, 8], vec![9]]);
        let error = now(pages.place([&[0; 3][..], &[0; 2]])).unwrap_err();
        assert!(matches!(error, GpuError::Limit { needed: 20, available: 16, .. }), "{error}");
    }
}
