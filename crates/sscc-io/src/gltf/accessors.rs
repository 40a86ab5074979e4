//! Reader for accessors of a glTF file: plain, strided and sparse.

use super::buffers::Buffers;
use super::component::Component;
use super::json::{Accessor, Root};
use super::role::Role;
use crate::FormatError;
use crate::allowance::Allowance;

/// Reads accessors within a memory allowance.
pub(super) struct Accessors<'a> {
    root: &'a Root,
    buffers: Buffers<'a>,
    pub allowance: Allowance,
}

impl<'a> Accessors<'a> {
    /// Creates a reader of these accessors; [`Accessors::load`] adds others. `size` is the size of the glTF file.
    pub fn new(
        root: &'a Root,
        buffers: Buffers<'a>,
        accessors: impl Iterator<Item = usize>,
        size: u64,
    ) -> Result<Self, FormatError> {
        let mut reader = Self { root, buffers, allowance: Allowance::new(size, u64::MAX) };
        reader.load(accessors)?;
        Ok(reader)
    }

    /// Loads the buffers of these accessors. Accessors that do not exist are skipped.
    pub fn load(&mut self, accessors: impl Iterator<Item = usize>) -> Result<(), FormatError> {
        let (root, before) = (self.root, self.buffers.external_size());
        for accessor in accessors.filter_map(|index| root.accessors.get(index)) {
            let sparse = accessor.sparse.iter().flat_map(|s| [s.indices.buffer_view, s.values.buffer_view]);
            for view in accessor.buffer_view.into_iter().chain(sparse) {
                if let Some(view) = root.buffer_views.get(view) {
                    self.buffers.load(view.buffer)?;
                }
            }
        }
        self.allowance.add(self.buffers.external_size() - before);
        Ok(())
    }

    /// Returns the count of an accessor, not yet checked against the file.
    pub fn count(&self, index: usize) -> Result<usize, FormatError> {
        Ok(self.accessor(index)?.count)
    }

    /// Refuses an accessor without a view: its numbers exist only in compressed form.
    pub fn check_uncompressed(&self, index: usize, part: &str) -> Result<(), FormatError> {
        if self.accessor(index)?.buffer_view.is_some() {
            return Ok(());
        }
        let cause = "its numbers exist only compressed by the extension KHR_draco_mesh_compression, which is not supported: \
                     save the file without it";
        Err(FormatError::part(part, cause))
    }

    /// Returns all numbers of an accessor, item after item.
    pub fn read(&mut self, index: usize, role: Role) -> Result<Vec<f64>, FormatError> {
        let refused = |cause| FormatError::part(format!("accessors[{index}]"), cause);
        let accessor = self.accessor(index)?;
        let width = role.width();
        let component = Component::from_code(accessor.component_type)
            .filter(|component| role.accepts(accessor.kind, *component, accessor.normalized));
        let Some(component) = component else {
            return Err(refused(role.requirement().into()));
        };
        if accessor.count == 0 {
            return Err(refused("it has no items".into()));
        }
        self.allowance.take(accessor.count as u64, 8 * width as u64).map_err(refused)?;
        let layout = Layout { component, width, normalized: accessor.normalized };
        let mut values = match accessor.buffer_view {
            Some(view) => self.numbers(view, accessor.byte_offset, accessor.count, layout)?,
            None => {
                let len = accessor.count.checked_mul(width);
                vec![0.0; len.ok_or_else(|| refused("it has more numbers than memory has bytes".into()))?]
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let Some(of_index) = Component::from_code(sparse.indices.component_type).filter(|c| c.is_index())
            else {
                return Err(refused("sparse indices must be unsigned integers".into()));
            };
            if sparse.count > accessor.count {
                return Err(refused("it has more sparse items than items".into()));
            }
            let plain = Layout { component: of_index, width: 1, normalized: false };
            let (indices, items) = (&sparse.indices, &sparse.values);
            let indices = self.numbers(indices.buffer_view, indices.byte_offset, sparse.count, plain)?;
            let items = self.numbers(items.buffer_view, items.byte_offset, sparse.count, layout)?;
            if indices.windows(2).any(|pair| pair[0] >= pair[1])
                || indices.last().is_some_and(|last| *last >= accessor.count as f64)
            {
                return Err(refused("sparse indices must ascend and be below the count".into()));
            }
            for (at, item) in indices.iter().zip(items.chunks_exact(width)) {
                values[*at as usize * width..][..width].copy_from_slice(item);
            }
        }
        Ok(values)
    }

    /// As [`Accessors::read`]; NaN and infinite numbers are errors.
    pub fn read_finite(&mut self, index: usize, role: Role) -> Result<Vec<f64>, FormatError> {
        let values = self.read(index, role)?;
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => {
                let cause = format!("item {} (counted from 0) is not finite", at / role.width());
                Err(FormatError::part(format!("accessors[{index}]"), cause))
            }
            None => Ok(values),
        }
    }

    fn accessor(&self, index: usize) -> Result<&'a Accessor, FormatError> {
        let missing = || FormatError::part(format!("accessors[{index}]"), "there is no such accessor");
        self.root.accessors.get(index).ok_or_else(missing)
    }

    /// Reads `count` items in a view from an offset. They lie within the view's bytes, so the size of the file bounds
    /// their number.
    fn numbers(
        &self,
        index: usize,
        offset: usize,
        count: usize,
        layout: Layout,
    ) -> Result<Vec<f64>, FormatError> {
        let part = || format!("bufferViews[{index}]");
        let refused = |cause: String| Err(FormatError::part(part(), cause));
        let Some(view) = self.root.buffer_views.get(index) else {
            return refused("there is no such view".into());
        };
        let buffer = self.buffers.get(view.buffer);
        let end = view.byte_offset.checked_add(view.byte_length);
        let Some(bytes) = end.and_then(|end| buffer.get(view.byte_offset..end)) else {
            return refused(format!(
                "{} bytes from byte {} on are not within buffers[{}] of {} bytes",
                view.byte_length,
                view.byte_offset,
                view.buffer,
                buffer.len()
            ));
        };
        let size = layout.component.size() * layout.width;
        // Some exporters write 0 for items without gaps, as an older version of the format did.
        let stride = view.byte_stride.filter(|stride| *stride > 0).unwrap_or(size);
        if stride < size {
            return refused(format!("the stride of {stride} bytes is shorter than an item of {size} bytes"));
        }
        // The last item may end before the stride ends.
        let needed = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size));
        let Some(bytes) =
            bytes.get(offset..).filter(|rest| needed.is_some_and(|needed| needed <= rest.len()))
        else {
            return refused(format!(
                "{count} items of {size} bytes with a stride of {stride} do not fit into it from byte {offset} on"
            ));
        };
        let item = |item: usize| bytes[item * stride..][..size].chunks_exact(layout.component.size());
        let value = |bytes| layout.component.decode(bytes, layout.normalized);
        Ok((0..count).flat_map(|n| item(n).map(value)).collect())
    }
}

#[derive(Clone, Copy)]
struct Layout {
    component: Component,
    /// Count of numbers in one item.
    width: usize,
    normalized: bool,
}
