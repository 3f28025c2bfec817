//! The streaming reader.

mod basis;
mod state;
mod text;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use gonio_bsdf::Channel;
use quick_xml::Reader;
use quick_xml::events::Event;

use self::state::{Sink, State};
use super::RadianceXml;
use super::stream::{Lines, Stop, skip_text, tokens};
use crate::{IoError, excerpt};

/// Reads the data of `channel` ([`Channel::Photopic`] is the file's `Visible`) from a BSDF XML file: one layer, up to
/// four components. Data of other wavelengths, colour coordinates and absorptances are passed over.
///
/// # Errors
/// [`IoError`] with line and field: a file that cannot be opened, malformed XML, an unknown data structure or angle
/// basis, a value that is no BSDF, too few or too many values, two blocks for one component, or no data for `channel`
/// (the message lists the wavelengths that are there).
pub fn read(path: &Path, channel: Channel) -> Result<RadianceXml, IoError> {
    read_from(open(path)?, path, channel)
}

/// The channels that a BSDF XML file has scattering data for, in the order of the file; those that gonio has no name
/// for (colour coordinates) are left out. The numbers themselves are passed over unread.
///
/// # Errors
/// As [`read`], but for the data.
pub fn channels(path: &Path) -> Result<Vec<Channel>, IoError> {
    Ok(stream(open(path)?, path, None)?.channels)
}

fn open(path: &Path) -> Result<BufReader<File>, IoError> {
    let refused = |e| IoError::file(path, e);
    let file = File::open(path).map_err(refused)?;
    if file.metadata().map_err(refused)?.is_dir() {
        return Err(refused(std::io::ErrorKind::IsADirectory.into()));
    }
    Ok(BufReader::with_capacity(1 << 16, file))
}

/// [`read`] from any stream; `path` is only named in errors.
///
/// # Errors
/// As [`read`].
pub fn read_from(input: impl BufRead, path: &Path, channel: Channel) -> Result<RadianceXml, IoError> {
    stream(input, path, Some(channel))?.finish(channel)
}

/// The state at the end of the stream, with the data of `channel` or, without one, of none.
fn stream<'a>(input: impl BufRead, path: &'a Path, channel: Option<Channel>) -> Result<State<'a>, IoError> {
    let mut reader = Reader::from_reader(Lines::new(input));
    reader.config_mut().expand_empty_elements = true;
    let mut state = State::new(path, channel);
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        let line = reader.get_ref().line();
        let event = match reader.read_event_into(&mut buffer) {
            Err(quick_xml::Error::Io(e)) => {
                return Err(IoError::file(path, std::io::Error::new(e.kind(), e.to_string())));
            }
            Err(e) => {
                return Err(IoError::format(
                    path,
                    line,
                    "XML",
                    e.to_string(),
                    "well-formed XML in UTF-8",
                ));
            }
            Ok(event) => event,
        };
        match event {
            Event::Start(e) => {
                let name = e.local_name().into_inner().to_owned();
                state.start(&name, &e, line)?;
            }
            Event::End(_) => state.end(line)?,
            Event::Text(e) => state.text.push_str(&e.xml10_content()),
            Event::CData(e) => state.text.push_str(&e.into_inner()),
            Event::GeneralRef(e) => {
                let c = match e.resolve_char_ref() {
                    Ok(Some(c)) => Some(c),
                    _ => match &*e.xml10_content() {
                        "amp" => Some('&'),
                        "lt" => Some('<'),
                        "gt" => Some('>'),
                        "quot" => Some('"'),
                        "apos" => Some('\''),
                        _ => None,
                    },
                };
                match c {
                    Some(c) => state.text.push(c),
                    None => {
                        let found = excerpt(e.xml10_content().as_bytes());
                        return Err(IoError::format(
                            path,
                            line,
                            "entity",
                            found,
                            "amp, lt, gt, quot, apos or a number",
                        ));
                    }
                }
            }
            Event::Eof => {
                state.closed(line)?;
                return Ok(state);
            }
            Event::Empty(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => {}
        }
        if state.in_scattering_data() {
            let line = |r: &Reader<Lines<_>>| r.get_ref().line();
            let outcome = match state.sink.as_mut() {
                None => skip_text(&mut reader.stream()).map_err(Stop::Io),
                Some(Sink::Matrix(m)) => tokens(&mut reader.stream(), |t| m.push(t)),
                Some(Sink::Tree(t)) => tokens(&mut reader.stream(), |token| t.push(token)),
            };
            outcome.map_err(|stop| state.stopped(stop, line(&reader)))?;
        }
    }
}
