//! Commands of scene text, taken apart; none is ever run.

/// The words of each stage of a pipeline; `text` is the line without its `!`.
///
/// # Errors
/// What is found and what is allowed, for anything of a shell but words, quotes and pipes.
pub(super) fn stages(text: &str) -> Result<Vec<Vec<String>>, (String, &'static str)> {
    let mut stages = vec![Vec::new()];
    let mut word: Option<String> = None;
    let mut characters = text.chars();
    let push = |stages: &mut Vec<Vec<String>>, word: &mut Option<String>| {
        if let (Some(w), Some(stage)) = (word.take(), stages.last_mut()) {
            stage.push(w);
        }
    };
    while let Some(c) = characters.next() {
        match c {
            '\'' | '"' => {
                let open = word.get_or_insert_default();
                loop {
                    match characters.next() {
                        Some(q) if q == c => break,
                        Some('$' | '`') if c == '"' => return Err(shell('$')),
                        Some(other) => open.push(other),
                        None => return Err((text.into(), "closed quotes")),
                    }
                }
            }
            '\\' => match characters.next() {
                Some(next) => word.get_or_insert_default().push(next),
                None => return Err((text.into(), "a character after the backslash")),
            },
            '|' => {
                push(&mut stages, &mut word);
                stages.push(Vec::new());
            }
            ';' | '&' | '<' | '>' | '$' | '`' | '(' | ')' | '*' | '?' => return Err(shell(c)),
            '#' if word.is_none() => break,
            c if c.is_whitespace() => push(&mut stages, &mut word),
            c => word.get_or_insert_default().push(c),
        }
    }
    push(&mut stages, &mut word);
    if stages.iter().any(Vec::is_empty) {
        return Err((text.into(), "a command, and one on each side of |"));
    }
    Ok(stages)
}

fn shell(c: char) -> (String, &'static str) {
    (
        format!("{c:?}"),
        "words, quotes and pipes: commands are not run by a shell",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_quotes_and_pipes_are_told_apart_and_a_shell_is_refused() {
        assert_eq!(
            stages("genbox 'a b' n 1 1 1|xform -t 0 0 1 # up").unwrap(),
            [
                vec!["genbox", "a b", "n", "1", "1", "1"],
                vec!["xform", "-t", "0", "0", "1"]
            ]
        );
        for bad in [
            "a; b",
            "a && b",
            "a > b",
            "xform `x`",
            "xform \"$HOME\"",
            "",
            "a |",
            "xform 'a",
        ] {
            assert!(stages(bad).is_err(), "{bad}");
        }
    }
}
