"""Results that appear whole or not at all."""

from __future__ import annotations

import errno
import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from gonio._native import FormatError


def sha256(path: str | os.PathLike[str]) -> str:
    """SHA-256 of a file, as 64 hexadecimal digits."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def replacing_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary path beside `path` that takes its place when the block ends without an error.

    On an error, also on Ctrl-C or a full disk, the temporary file is removed and an older file at `path`
    stays as it was. The directory of `path` must exist. A symbolic link stays; the file it names is replaced.
    """
    target = check_file(path)
    handle, name = tempfile.mkstemp(prefix=f".{target.name}.", suffix=".part", dir=target.parent)
    os.close(handle)
    staged = Path(name)
    try:
        yield staged
        staged.chmod(_default_mode(0o666))
        staged.replace(target)
    except BaseException as error:
        staged.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise _about(Path(path), staged, error) from error
        raise


def check_file(path: str | os.PathLike[str]) -> Path:
    """The file that `replacing_file` would write for `path`, links followed; its errors otherwise.

    Long work asks this first.

    Raises
    ------
    OSError
        `path` is a directory, a device or a pipe, or its parent does not exist.
    """
    given = Path(path)
    if given.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a directory, a file is needed", str(given))
    if given.exists() and not given.is_file():
        raise OSError(errno.EINVAL, "is a device or a pipe, a file is needed", str(given))
    target = Path(os.path.realpath(given))
    _existing_parent(target, path)
    return target


@contextmanager
def replacing_directory(
    path: str | os.PathLike[str], *, marker: str, owned: Sequence[str] = (), force: bool = False
) -> Iterator[Path]:
    """Give a temporary directory beside `path`; its files move to `path` when the block ends without error.

    A new directory appears in one step. Into an existing one the files are moved one by one over their older
    versions; files there that match a pattern of `owned` and were not written anew belonged to the earlier
    result and go, all others stay. An existing directory that is neither empty nor holds the file
    `marker` (so it is no earlier result of the same kind) is refused unless `force` is set.

    Raises
    ------
    FormatError
        `path` holds other people's files and `force` is not set.
    OSError
        The file system refuses (no such parent, no permission, disk full); nothing is left behind.
    """
    target = Path(path)
    parent = check_directory(target, marker=marker, force=force)
    staged = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=parent))
    try:
        yield staged
        if target.is_dir():
            new = set()
            for file in sorted(staged.iterdir(), key=lambda f: f.name == marker):
                file.replace(target / file.name)
                new.add(file.name)
            for old in {f for pattern in owned for f in target.glob(pattern)}:
                if old.name not in new:
                    old.unlink()
            staged.rmdir()
        else:
            staged.chmod(_default_mode(0o777))
            staged.rename(target)
    except BaseException as error:
        shutil.rmtree(staged, ignore_errors=True)
        if isinstance(error, OSError):
            raise _about(target, staged, error) from error
        raise


@contextmanager
def growing_directory(path: str | os.PathLike[str]) -> Iterator[None]:
    """Make the directory `path` with its parents for files that appear one after the other.

    What was made goes again when the block ends with an error. In a directory that was there before, files
    stay; an interruption then says so.
    """
    target = Path(path)
    new = [p for p in (target, *target.absolute().parents) if not p.exists()]
    try:
        target.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException as error:
        if target in new:
            shutil.rmtree(target, ignore_errors=True)
            for parent in new[1:]:
                with suppress(OSError):
                    parent.rmdir()
        elif isinstance(error, KeyboardInterrupt):
            raise KeyboardInterrupt(f"{target} may hold files of this run beside older ones") from error
        raise


def check_directory(path: str | os.PathLike[str], *, marker: str, force: bool = False) -> Path:
    """Parent of the directory `path`, when `replacing_directory` would write there; its errors otherwise.

    Long work asks this first.
    """
    target = Path(path)
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "is a file, a directory is needed", str(target))
    if target.is_dir() and not force and any(target.iterdir()) and not (target / marker).is_file():
        raise FormatError(
            f"{target}: found a directory with other files in it, allowed a new or empty directory or an "
            f"earlier result (one that holds {marker}); force=True (--force) writes there all the same"
        )
    return _existing_parent(target, path)


def _existing_parent(target: Path, given: str | os.PathLike[str]) -> Path:
    parent = target.absolute().parent
    if not parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"no such directory {parent} to write into", os.fspath(given))
    return parent


def _about(target: Path, staged: Path, error: OSError) -> OSError:
    """The refusal, with the name the user gave in place of that of the temporary file."""
    number = error.errno or errno.EIO
    reason = os.strerror(error.errno) if error.errno else str(error)
    return OSError(number, reason.replace(str(staged), str(target)), os.fspath(target))


def _default_mode(mode: int) -> int:
    """`mode` less the umask; temporary files start private."""
    umask = os.umask(0)
    os.umask(umask)
    return mode & ~umask
