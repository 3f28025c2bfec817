//! Large tables on large pages.

/// Tables of at least this many bytes are worth large pages.
const LARGE: usize = 8 << 20;

/// A copy of `table` for which large pages were asked, where it is large: rays jump about in it, and each jump to another
/// small page costs a look-up of its own.
pub(super) fn settled<T: Copy>(table: Vec<T>) -> Vec<T> {
    if size_of_val(table.as_slice()) < LARGE {
        return table;
    }
    let mut copy = Vec::with_capacity(table.len());
    advise(&copy);
    copy.extend_from_slice(&table);
    copy
}

/// Asks for large pages. A kernel that has none keeps to small ones: nothing depends on the answer.
#[cfg(target_os = "linux")]
fn advise<T>(table: &Vec<T>) {
    use rustix::mm::{Advice, madvise};
    const PAGE: usize = 4096;
    let start = table.as_ptr().addr();
    let end = start + table.capacity() * size_of::<T>();
    let first = start / PAGE * PAGE;
    let length = end.next_multiple_of(PAGE) - first;
    let first = table.as_ptr().with_addr(first).cast_mut();
    // SAFETY: this advice never changes what the pages hold, so it may also reach the parts of the first and last page
    // that are not the table's; the table's block is mapped, and whole pages are.
    let _ = unsafe { madvise(first.cast(), length, Advice::LinuxHugepage) };
}

#[cfg(not(target_os = "linux"))]
fn advise<T>(_: &Vec<T>) {}
