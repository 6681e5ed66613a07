"""Files and new folders that are whole at every moment: made beside their place, then moved there.

Whatever stops a program (a kill, a full disk, a power cut), the file is the earlier one or the new
one, and never half of it. All of the package writes through here; a test looks for other ways.

A link in the place of a file is replaced by the file: what it points to stays as it was. A device
or a pipe is refused.
"""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

try:
    import fcntl
except ImportError:  # not there on Windows, where a file that is open cannot be removed anyway
    fcntl = None  # type: ignore[assignment]

__all__ = ["atomic_write", "create_text", "new_folder", "subfolder", "write_text"]

_DRAFT: Final = re.compile(r"\.stiction-[0-9a-f]{16}\.part")
"""Names of what is being written; short, for a long name of the file itself must still fit."""
_OLD: Final = 24 * 3600.0
"""Seconds after which nobody writes a draft any more, where no lock tells."""
_WITHOUT_LINKS: Final = {
    errno.EPERM,
    errno.ENOSYS,
    errno.ENOTSUP,
    errno.EOPNOTSUPP,
    errno.EMLINK,
    errno.EINVAL,
}
"""How file systems say that they have no second name for a file."""


def write_text(path: Path, text: str) -> None:
    """Write a text in UTF-8, in place of the file that is there.

    A character that is no text in any encoding, as in names of files, becomes the escape that JSON
    has for it.

    Raises
    ------
    OSError
        It cannot be written; names ``path``.
    """
    with atomic_write(path) as file:
        file.write(_encoded(text))


def create_text(path: Path, text: str) -> None:
    """Write a text as ``write_text`` does, where nothing is there yet.

    Raises
    ------
    FileExistsError
        There is a file, or a link that leads nowhere.
    OSError
        It cannot be written; names ``path``.
    """
    with _draft_for(path) as (draft, file):
        file.write(_encoded(text))
        _synced(file)
        try:
            os.link(draft, path)
        except FileExistsError:
            raise
        except (OSError, AttributeError) as error:
            if isinstance(error, OSError) and error.errno not in _WITHOUT_LINKS:
                raise
            if os.path.lexists(path):
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
            _moved(draft, file, path)


@contextmanager
def atomic_write(path: Path) -> Iterator[BinaryIO]:
    """A file to write, which takes the place of ``path`` once all of it is there.

    Parameters
    ----------
    path : Path
        Keeps its permissions where it is there already.

    Yields
    ------
    file
        Open for binary writing, and seekable.

    Raises
    ------
    OSError
        It cannot be written; names ``path``. What was there is there still.
    """
    with _draft_for(path) as (draft, file):
        kept = _permissions(path)
        yield file
        if kept is not None:
            os.chmod(draft, kept)
        _synced(file)
        _moved(draft, file, path)


@contextmanager
def new_folder(path: Path) -> Iterator[Path]:
    """A folder to fill, which gets its name once all of it is there.

    Parameters
    ----------
    path : Path
        Where nothing is yet, in a folder that is there.

    Yields
    ------
    Path
        Of the folder that is filled; gone with all that is in it where it was not moved.

    Raises
    ------
    FileExistsError
        Something is there already.
    OSError
        It cannot be written; names ``path``.
    """
    if os.path.lexists(path):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
    try:
        _clear(path.parent)
        with _draft_folder(path.parent) as draft:
            yield draft
            _sync_folder(draft)
            os.replace(draft, path)
        _sync_folder(path.parent)
    except OSError as error:
        # Callers know nothing of the draft.
        named = None if error.filename is None else Path(os.fsdecode(error.filename))
        if named is None or not any(_DRAFT.fullmatch(part) for part in named.parts):
            raise
        raise OSError(error.errno or errno.EIO, error.strerror or str(error), str(path)) from None


@contextmanager
def _draft_folder(folder: Path) -> Iterator[Path]:
    """A new folder, locked for as long as it is filled."""
    while True:
        draft = folder / f".stiction-{secrets.token_hex(8)}.part"
        draft.mkdir()
        with _locked(draft):
            # Another process may have taken it for a leftover before it was locked.
            if not draft.is_dir():
                continue
            try:
                yield draft
            finally:
                shutil.rmtree(draft, ignore_errors=True)
            return


@contextmanager
def _locked(folder: Path, *, needed: bool = False) -> Iterator[None]:
    """Hold the lock of a folder, where the system has one."""
    if fcntl is None:
        yield
        return
    opened = os.open(folder, os.O_RDONLY)
    try:
        _lock(opened, wait=not needed, needed=needed)
        yield
    finally:
        os.close(opened)


def subfolder(folder: Path, name: str) -> Path:
    """A folder within one that is written to, made where it is not there.

    Raises
    ------
    OSError
        It cannot be made, or a link is there, which would lead what is written to another place.
    """
    path = folder / name
    if path.is_symlink():
        raise OSError(errno.ELOOP, "a link is there, and is not written through", str(path))
    path.mkdir(parents=True, exist_ok=True)
    return path


@contextmanager
def _draft_for(path: Path) -> Iterator[tuple[Path, BinaryIO]]:
    """An open file beside ``path``; gone at the end where it was not moved."""
    try:
        _clear(path.parent)
        draft, file = _opened(path.parent)
        try:
            with file:
                yield draft, file
        finally:
            with suppress(OSError):
                draft.unlink()
        _sync_folder(path.parent)
    except OSError as error:
        # Callers know nothing of the draft, and writing into an open file names none.
        named = None if error.filename is None else Path(os.fsdecode(error.filename))
        if named is not None and named != path and not _DRAFT.fullmatch(named.name):
            raise
        raise OSError(error.errno or errno.EIO, error.strerror or str(error), str(path)) from None


def _opened(folder: Path) -> tuple[Path, BinaryIO]:
    """A new draft in a folder, locked for as long as it is open."""
    while True:
        draft = folder / f".stiction-{secrets.token_hex(8)}.part"
        file = draft.open("xb")
        try:
            _lock(file.fileno(), wait=True)
            # Another process may have taken it for a leftover before it was locked.
            if fcntl is None or os.fstat(file.fileno()).st_nlink:
                return draft, file
        except BaseException:
            file.close()
            draft.unlink(missing_ok=True)
            raise
        file.close()


def _clear(folder: Path) -> None:
    """Remove drafts that a killed program left: nobody holds their lock any more."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if not _DRAFT.fullmatch(entry.name) or entry.is_symlink():
                continue
            with suppress(OSError):
                if fcntl is None and time.time() - entry.stat().st_mtime < _OLD:
                    continue
                if entry.is_dir():
                    with _locked(Path(entry.path), needed=True):
                        shutil.rmtree(entry.path, ignore_errors=True)
                    continue
                with open(entry.path, "rb") as left:
                    _lock(left.fileno(), wait=False, needed=True)
                    os.unlink(entry.path)


def _lock(opened: int, *, wait: bool, needed: bool = False) -> None:
    """Lock an open file; not every file system can, which matters where it is ``needed``."""
    if fcntl is None:
        return
    try:
        fcntl.flock(opened, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        if needed:
            raise


def _permissions(path: Path) -> int | None:
    """Those of the file that is there; None where none is, or a link.

    Raises
    ------
    OSError
        No file may be written there.
    """
    try:
        found = os.lstat(path)
        linked = stat.S_ISLNK(found.st_mode)
        led_to = os.stat(path) if linked else found
    except FileNotFoundError:
        return None
    if stat.S_ISDIR(led_to.st_mode) and not linked:
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not (stat.S_ISREG(led_to.st_mode) or stat.S_ISDIR(led_to.st_mode)):
        raise OSError(errno.EINVAL, "it is a device or a pipe, not a file", str(path))
    if linked:
        return None
    # Moving a file there needs no right to write to the one that goes.
    if not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    return stat.S_IMODE(found.st_mode)


def _moved(draft: Path, file: BinaryIO, path: Path) -> None:
    # The lock is held until it is moved, except where an open file cannot be moved.
    if fcntl is None:
        file.close()
    os.replace(draft, path)


def _synced(file: BinaryIO) -> None:
    file.flush()
    os.fsync(file.fileno())


def _sync_folder(folder: Path) -> None:
    """Put the names in a folder on the disk, where the system has a way to."""
    with suppress(OSError):
        opened = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(opened)
        finally:
            os.close(opened)


def _encoded(text: str) -> bytes:
    return text.encode("utf-8", "backslashreplace")
