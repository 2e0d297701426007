"""Files that appear whole or not at all, locks, and signals for those who wait for them."""
import contextlib
import fcntl
import json
import os
import pathlib
import signal
import tempfile
import time
import unicodedata

from planner.errors import FILE_ACCESS, SIGNALLED, PlanError

POLL_SECONDS = 0.02
GRACE_SECONDS = 5  # for a tool that was told to end


def is_printable(name):
    """No control characters, and nothing that was not UTF-8 or that XML cannot hold."""
    return not any(unicodedata.category(c) in ("Cc", "Cs") or c in "\ufffe\uffff" for c in name)


def printable(text):
    """What terminals and XML take without doing something else."""
    return "".join(c if c in "\n\t" or is_printable(c) else "\N{REPLACEMENT CHARACTER}" for c in text)


def parse_json(text, **more):
    """The content. Throws ValueError for all that is none, also what is nested too deeply."""
    try:
        return json.loads(text, **more)
    except RecursionError:
        raise ValueError("is nested too deeply") from None


def read_text(path):
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PlanError(FILE_ACCESS, f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def write_whole(path, text, executable=False, locked=False):
    """A reader sees the old file or the new one, also after a crash. A file that holds the text already stays as it is.

    `locked`: nobody else writes it meanwhile, so that what a writer that was killed left is used again.
    """
    content = text.encode()
    with contextlib.suppress(OSError):
        if path.read_bytes() == content:
            return
    with replacement(path, content, executable, locked) as replace:
        replace()


@contextlib.contextmanager
def replacement(path, content, executable=False, locked=False):
    """Writes the content beside `path`; gives a function that puts it there. What was not put there is removed."""
    with says_what(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        if locked:
            name = f"{path}.tmp"
            handle = os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
        else:
            handle, name = tempfile.mkstemp(dir=path.parent, prefix=path.name[:50] + ".tmp.")

    def replace():
        with says_what(path):
            os.replace(name, path)

    try:
        with says_what(path), os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
            os.fchmod(file.fileno(), 0o755 if executable else 0o644)
        yield replace
    finally:
        pathlib.Path(name).unlink(missing_ok=True)


@contextlib.contextmanager
def says_what(path):
    try:
        yield
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


class Running:
    """The tools that run now, and the signals that came meanwhile."""

    def __init__(self):
        self.processes = set()
        self.signals = []

    def end(self, number, _):
        if not self.signals:
            signal.setitimer(signal.ITIMER_REAL, GRACE_SECONDS)
        self.signals.append(number)
        for process in list(self.processes):
            process.terminate()  # it may have been started with Ctrl-C ignored

    def kill(self, *_):
        for process in list(self.processes):
            process.kill()

    def check(self):
        if self.signals:
            raise PlanError(SIGNALLED + self.signals[0], "interrupted")

    def wait(self, process):
        """Its exit code."""
        self.processes.add(process)
        try:
            if self.signals:  # that came before it was here to be ended
                process.terminate()
            return process.wait()
        finally:
            self.processes.discard(process)

    def wait_for(self, condition):
        """The first result of the condition that is true."""
        while True:
            self.check()
            found = condition()
            if found:
                return found
            time.sleep(POLL_SECONDS)


@contextlib.contextmanager
def passed_on():
    """Ctrl-C and being told to end go to the tools that run, so that they end first or are killed; gives Running."""
    running = Running()
    numbers = [number for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP) if signal.getsignal(number) != signal.SIG_IGN]
    before = {number: signal.signal(number, running.end) for number in numbers}
    before[signal.SIGALRM] = signal.signal(signal.SIGALRM, running.kill)
    try:
        yield running
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in before.items():
            signal.signal(number, handler)


def tail(path, lines=40):
    """The end of a log, or nothing if there is none."""
    try:
        return "\n".join(path.read_text(encoding="utf-8", errors="replace").splitlines()[-lines:])
    except OSError:
        return ""
