"""Files that appear whole or not at all, locks, and signals for those who hold them."""
import contextlib
import fcntl
import os
import signal
import tempfile

from planner.errors import FILE_ACCESS, PlanError


def read_text(path):
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PlanError(FILE_ACCESS, f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def write_whole(path, text, executable=False):
    """A reader sees the old file or the new one, also after a crash. A file that holds the text already stays as it is."""
    with contextlib.suppress(OSError):
        if path.read_text(encoding="utf-8") == text:
            return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name + ".tmp.")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
                os.fchmod(file.fileno(), 0o755 if executable else 0o644)
            os.replace(name, path)
        except BaseException:
            os.unlink(name)
            raise
    except OSError as error:
        raise PlanError(FILE_ACCESS, f"{path}: cannot be written: {error.strerror}") from None


def open_lock(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    return os.open(path, os.O_RDWR | os.O_CREAT, 0o644)


def try_lock(handle, how=fcntl.LOCK_EX):
    """Whether the lock was free. Its holders are the processes that have the handle: it is released when the last ends."""
    try:
        fcntl.flock(handle, how | fcntl.LOCK_NB)
        return True
    except BlockingIOError:
        return False


@contextlib.contextmanager
def passed_on(process):
    """Ctrl-C and being told to end go to the process, so that it ends first; gives the list of signals that came."""
    signals = []

    def pass_on(number, _):
        signals.append(number)
        process.terminate()  # it may have been started with Ctrl-C ignored

    before = {number: signal.signal(number, pass_on) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield signals
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def tail(path, lines=40):
    """The end of a log, or nothing if there is none."""
    try:
        return "\n".join(path.read_text(encoding="utf-8", errors="replace").splitlines()[-lines:])
    except OSError:
        return ""
