"""Spreads steps over the devices of this machine: one lock for each, held by whoever uses it."""
import contextlib
import os
import pathlib

from planner.errors import FILE_ACCESS, USAGE, PlanError
from planner.files import open_lock, try_lock


def device_slots(environment):
    """[(slot, device)]: of RT_DEVICES, of the GPUs that Slurm gave this job, or one: RT_DEVICE, or what rt-trace finds itself ("").

    A device may be named several times, and then takes so many steps at once. Empty where Slurm alone decides what runs.
    """
    text = environment.get("RT_DEVICES", "")
    if text:
        devices = [device.strip() for device in text.split(",")]
        if not all(devices):
            raise PlanError(USAGE, f"RT_DEVICES: '{text}' has an empty name; wanted is a list like cuda:0,cuda:1")
        return [(f"{device}#{devices[:i].count(device) + 1}", device) for i, device in enumerate(devices)]
    if "SLURM_JOB_ID" in environment:
        gpus = [gpu for gpu in environment.get("SLURM_JOB_GPUS", "").split(",") if gpu]
        # CUDA_VISIBLE_DEVICES, which Slurm sets, makes CUDA count the job's own GPUs from 0.
        own = "CUDA_VISIBLE_DEVICES" in environment
        return [(f"cuda:{gpu}#1", f"cuda:{i if own else gpu}") for i, gpu in enumerate(gpus)]
    device = environment.get("RT_DEVICE", "")
    return [(f"{device or 'auto'}#1", device)]


def are_of_a_kind(slot, slots):
    """Whether a picture that was made in a slot might be made in one of the others: rt-trace tells software from hardware."""
    return slot.startswith("software#") in {device == "software" for _, device in slots}


def lock_folder(environment):
    """Of this machine, not of the pipeline: two pipelines share the devices too."""
    folder = pathlib.Path(environment.get("RT_DEVICE_LOCKS") or f"/tmp/rt-devices-{os.getuid()}")
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise PlanError(FILE_ACCESS, f"{folder}: cannot be made: {error.strerror}") from None
    if folder.stat().st_uid != os.getuid():
        raise PlanError(FILE_ACCESS, f"{folder}: belongs to another user; name a folder in RT_DEVICE_LOCKS")
    return folder


@contextlib.contextmanager
def device(environment, running):
    """Waits for a free slot; gives (slot, device, handle of its lock), or ("", "", None) where there is nothing to lock."""
    slots = device_slots(environment)
    folder = lock_folder(environment)
    handles = []
    try:
        for slot, name in slots:
            handles.append((open_lock(folder / (slot.replace("/", "_") + ".lock")), slot, name))
        yield running.wait_for(lambda: free_one(handles)) if handles else ("", "", None)
    finally:
        for handle, _, _ in handles:
            os.close(handle)


def free_one(handles):
    return next(((slot, name, handle) for handle, slot, name in handles if try_lock(handle)), None)
