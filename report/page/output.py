"""Files that are whole or not there."""
import os
import tempfile
from pathlib import Path

from calibration import Complaint


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
