"""Whether a step must be called again: by what its record says of its tool and files, more than time stamps can tell.

A file that was written, replaced or given another time stamp has another change time or inode, which nobody can set. Whether its
content is another one too is left to the tool (--if-changed).
"""
import os

from planner.devices import are_of_a_kind


def signatures(folder, files):
    """{file: its signature}."""
    return {file: signature(folder / file) for file in files}


def signature(path):
    try:
        status = os.stat(path)
    except OSError:
        return None
    return [status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino]


def is_current(folder, step, record, version, slots):
    """Whether the step, of which this is the record or None, need not be called where there are these devices."""
    if step.stage == "import":
        return False  # only rt-import knows which files a model leads to, and which were not there
    if not record or record["state"] not in ("done", "skipped") or record.get("version") != version:
        return False
    if step.resources["gpus"] and slots and not are_of_a_kind(record["attempts"][-1]["slot"], slots):
        return False
    return untouched(folder, record, [*step.inputs, *step.outputs])


def untouched(folder, record, files):
    """Whether all are still what they were when the step ended."""
    known = record.get("files", {})
    return all(known.get(file) and known[file] == signature(folder / file) for file in files)
