//! Memory for long columns.
//!
//! Most of the time of filling fresh memory goes into the page faults of 4 KiB each. Linux serves 2 MiB at a time
//! where a program asks for it; a column of 1,000,000 numbers then takes 4 faults instead of 2000.

/// Bytes of a huge page.
const HUGE: usize = 2 << 20;
/// Bytes that the allocator puts before a block of its own pages, and some room.
const HEADER: usize = 64;

/// An empty column with room for at least `length` numbers. Long ones are asked for as whole huge pages, so that the
/// last of them is complete too; what is not written to takes no memory.
pub fn column(length: usize) -> Vec<f64> {
    let bytes = length.saturating_mul(size_of::<f64>());
    if bytes < 2 * HUGE {
        return Vec::with_capacity(length);
    }
    let whole = (bytes + HEADER).next_multiple_of(HUGE) - HEADER;
    let column = Vec::with_capacity(whole / size_of::<f64>());
    advise(&column);
    column
}

/// Asks for huge pages below a column. A kernel that has none keeps to small ones: nothing depends on the answer.
#[cfg(target_os = "linux")]
fn advise(column: &Vec<f64>) {
    use rustix::mm::{Advice, madvise};
    const PAGE: usize = 4096;
    let start = column.as_ptr().addr();
    let end = start + column.capacity() * size_of::<f64>();
    let first = start / PAGE * PAGE;
    let length = end.next_multiple_of(PAGE) - first;
    let first = column.as_ptr().with_addr(first).cast_mut();
    // SAFETY: this advice never changes what the pages hold, so it may also reach the parts of the first and last page
    // that are not the column's; the column's block is mapped, and whole pages are.
    let _ = unsafe { madvise(first.cast(), length, Advice::LinuxHugepage) };
}

#[cfg(not(target_os = "linux"))]
fn advise(_: &Vec<f64>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_and_short_columns_have_the_room_asked_for() {
        for length in [0, 1, 1000, 1 << 19, (1 << 19) + 1, 1_234_567] {
            let mut values = column(length);
            assert!(values.capacity() >= length);
            values.extend((0..length).map(|k| k as f64));
            assert!(values.iter().enumerate().all(|(k, v)| *v == k as f64));
        }
    }
}
