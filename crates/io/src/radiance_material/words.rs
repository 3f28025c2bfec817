//! Words of scene text with their lines.

/// A word and the line it starts on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Word {
    /// The bytes, quotes removed.
    pub(super) bytes: Vec<u8>,
    /// Counted from 1.
    pub(super) line: u64,
}

/// What stands where an item could begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Next {
    /// An item.
    Item,
    /// A command line.
    Command,
    /// Nothing.
    End,
}

/// A reader of words.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
}

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        const MARK: &[u8] = b"\xef\xbb\xbf";
        Words {
            bytes: bytes.strip_prefix(MARK).unwrap_or(bytes),
            at: 0,
            line: 1,
        }
    }

    /// The line of the place reached.
    pub(super) fn line(&self) -> u64 {
        self.line
    }

    /// The line from the place reached, without its end; a backslash before the end of a line joins the next one to it.
    pub(super) fn command(&mut self) -> Vec<u8> {
        let mut text = Vec::new();
        while let Some(b) = self.take() {
            match b {
                b'\n' if text.last() == Some(&b'\\') => {
                    text.pop();
                }
                b'\n' => break,
                b'\r' => {}
                _ => text.push(b),
            }
        }
        text
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn take(&mut self) -> Option<u8> {
        let b = self.peek()?;
        self.at += 1;
        self.line += u64::from(b == b'\n');
        Some(b)
    }

    fn skip_space(&mut self) {
        while self.peek().is_some_and(is_space) {
            self.take();
        }
    }

    /// Past white space and comments.
    fn skip_comments(&mut self) {
        self.skip_space();
        while self.peek() == Some(b'#') {
            while self.take().is_some_and(|b| b != b'\n') {}
            self.skip_space();
        }
    }

    /// What stands next, comments apart.
    pub(super) fn next(&mut self) -> Next {
        self.skip_comments();
        match self.peek() {
            None => Next::End,
            Some(b'!') => Next::Command,
            Some(_) => Next::Item,
        }
    }

    /// The next word; quotes of either kind hold white space together and are dropped. `#` has no meaning here.
    pub(super) fn word(&mut self) -> Option<Word> {
        self.skip_space();
        let line = self.line;
        self.peek()?;
        let mut word = Vec::new();
        let mut quote = None;
        while let Some(b) = self.peek() {
            match quote {
                Some(q) if b == q => quote = None,
                Some(_) => word.push(b),
                None if b == b'"' || b == b'\'' => quote = Some(b),
                None if is_space(b) => break,
                None => word.push(b),
            }
            self.take();
        }
        Some(Word { bytes: word, line })
    }

    /// The next number as text, past comments; it ends at white space or `#`.
    pub(super) fn value(&mut self) -> Option<Word> {
        self.skip_comments();
        let line = self.line;
        let start = self.at;
        while self.peek().is_some_and(|b| !is_space(b) && b != b'#') {
            self.take();
        }
        (self.at > start).then(|| Word {
            bytes: self.bytes[start..self.at].to_vec(),
            line,
        })
    }
}

/// White space of the C library: blank, tab, line feed, vertical tab, form feed, carriage return.
fn is_space(b: u8) -> bool {
    matches!(b, b' ' | b'\t'..=b'\r')
}
