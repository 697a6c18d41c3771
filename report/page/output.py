"""Files that are whole or not there."""
import os
import tempfile
from pathlib import Path

from calibration import Complaint


def check_outputs(outputs: list[Path | None], inputs: list[Path | None]) -> None:
    """Raises Complaint where a file to be written is no file, is written twice, or is what is read."""
    taken = {each.resolve() for each in inputs if each}
    for file in filter(None, outputs):
        if file.exists() and not file.is_file():
            raise Complaint(f"{file}: it is no file that could be replaced; give the name of a file")
        if file.resolve() in taken:
            raise Complaint(f"{file}: it is read or written by the same command; give each file a name of its own")
        taken.add(file.resolve())


def write_whole(file: Path, content: bytes) -> None:
    """To a temporary name beside it, then renamed: an interrupted run leaves the old file."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name[:100]}.")
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(content)
            os.chmod(name, 0o666 & ~_umask())
            os.replace(name, file)
        except BaseException:
            os.unlink(name)
            raise
    except OSError as error:
        raise Complaint(f"{file}: {error.strerror}; it was not written") from None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
