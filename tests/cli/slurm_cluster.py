"""A Slurm of one node on the loopback interface, with its own configuration, key, state and logs in one folder."""
import contextlib
import itertools
import os
import pathlib
import re
import secrets
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol")
SEARCH = "/usr/sbin:/usr/bin:/sbin:/bin"

# cred_expire: a job that is put back into the queue waits so long. linuxproc, none: cgroups are not ours in a container.
CONF = """
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=2,bf_interval=2,batch_sched_delay=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
MailProg=/bin/true
ReturnToService=2
KillWait=2
SlurmdTimeout=4
BatchStartTimeout=2
MessageTimeout=3
GresTypes=gpu
NodeName=localhost NodeAddr=127.0.0.1 CPUs={cores} RealMemory={memory} Gres=gpu:2 State=UNKNOWN
PartitionName=test Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
# Two devices that every machine has stand for GPUs: Slurm only counts them.
GRES = "AutoDetect=off\nName=gpu File=/dev/null\nName=gpu File=/dev/zero\n"


def why_not():
    """Why this machine cannot run the cluster, or None."""
    missing = [program for program in PROGRAMS if not shutil.which(program, path=SEARCH)]
    if missing:
        return f"{', '.join(missing)} not installed"
    return None if os.getuid() == 0 else "Slurm's daemons need root"


class SlurmCluster:
    """Started by `with`; its daemons are gone afterwards."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.environment = os.environ | {"SLURM_CONF": str(self.folder / "slurm.conf"), "PATH": SEARCH}
        self.daemons = {}

    def __enter__(self):
        try:
            self.write_files()
            self.start_munge()
            self.start_controller()
            self.start_node()
            self.wait_for(lambda: "idle" in self.ask("sinfo", "-h", "-o", "%t"), "the node is not idle")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for name in ("slurmd", "slurmctld", "munged"):
            self.kill(name)

    def write_files(self):
        self.folder.chmod(0o755)  # munged wants its socket's folders open to all
        for name, mode in (("state", 0o755), ("spool", 0o755), ("munge", 0o755), ("key", 0o700)):
            (self.folder / name).mkdir(mode=mode)
        (self.folder / "key" / "key").write_bytes(secrets.token_bytes(128))
        (self.folder / "key" / "key").chmod(0o600)
        controller_port, node_port = free_ports(2)
        memory = int(re.search(r"MemTotal: +(\d+)", pathlib.Path("/proc/meminfo").read_text())[1]) // 1024
        conf = CONF.format(folder=self.folder, controller_port=controller_port, node_port=node_port, memory=memory - 64,
                           cores=os.cpu_count())  # fmt: skip
        (self.folder / "slurm.conf").write_text(conf)
        (self.folder / "gres.conf").write_text(GRES)

    def start(self, name, *arguments):
        """In the foreground, as our child, so that we know its process."""
        with open(self.folder / f"{name}.out", "a", encoding="utf-8") as out:
            program = shutil.which(name, path=SEARCH)
            self.daemons[name] = subprocess.Popen([program, *arguments], env=self.environment, stdout=out, stderr=out,
                                                  stdin=subprocess.DEVNULL)  # fmt: skip

    def start_munge(self):
        folder = self.folder / "munge"
        self.start("munged", "--foreground", f"--key-file={self.folder}/key/key", f"--socket={folder}/socket",
                   f"--pid-file={folder}/pid", f"--seed-file={folder}/seed", "--num-threads=2")  # fmt: skip
        self.wait_for(lambda: (folder / "socket").exists(), "munged does not listen")

    def start_controller(self):
        self.start("slurmctld", "-D")
        self.wait_for(lambda: "UP" in self.ask("scontrol", "ping"), "slurmctld does not answer")

    def configure(self, line):
        with open(self.folder / "slurm.conf", "a", encoding="utf-8") as conf:
            conf.write(f"{line}\n")
        assert self.ask("scontrol", "reconfigure") == "", "scontrol reconfigure"

    def start_node(self):
        self.start("slurmd", "-D", "-N", "localhost")

    def wait_for_save(self):
        """Until the controller has written what it knows now: within 5 s after a change, so that there has to be one."""
        saved, now = self.folder / "state" / "job_state", time.time() + 1
        job = self.ask("squeue", "-h", "-t", "PENDING", "-o", "%A").split()[-1]
        nices = itertools.count(1)
        self.wait_for(lambda: self.ask("scontrol", "update", f"jobid={job}", f"nice={next(nices)}") == "" and saved.stat().st_mtime > now,
                      "slurmctld does not save its state", 60)  # fmt: skip

    def kill(self, name):
        """With SIGKILL, and of the node also all that runs on it, as when its machine fails."""
        process = self.daemons.pop(name, None)
        if process is None:
            return
        victims = descendants(process.pid) | self.step_daemons() if name == "slurmd" else set()
        for number in (signal.SIGSTOP, signal.SIGKILL):  # so that none sees another die
            for pid in [process.pid, *victims]:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, number)
        process.wait()

    def step_daemons(self):
        """What outlives slurmd: each slurmstepd of this cluster, known by its configuration, and its children."""
        found = set()
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if b"slurmstepd" in (folder / "cmdline").read_bytes() and self.is_ours(folder):
                    found |= {int(folder.name)} | descendants(int(folder.name))
            except OSError:
                continue
        return found

    def is_ours(self, folder):
        return any(os.readlink(link).startswith(str(self.folder)) for link in (folder / "fd").iterdir())

    def ask(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=30).stdout

    def wait_for(self, condition, complaint, seconds=20):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise RuntimeError(f"{complaint} after {seconds} s\n{self.logs()}")
            time.sleep(0.05)

    def logs(self):
        return "\n".join(f"--- {path.name}\n{path.read_text()[-3000:]}" for path in sorted(self.folder.glob("*.[lo][ou]*")))


def descendants(pid):
    found = set()
    for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        for child in map(int, task.read_text().split()):
            found |= {child} | descendants(child)
    return found


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for open_socket in sockets:
        open_socket.bind(("127.0.0.1", 0))
    ports = [open_socket.getsockname()[1] for open_socket in sockets]
    for open_socket in sockets:
        open_socket.close()
    return ports
