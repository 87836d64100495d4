#!/usr/bin/env python3
"""A sweep as a Slurm job array, against a controller and two node daemons on loopback, one of which dies in mid-array as a machine elsewhere
would; some variants can't be grown.
Emits TAP.

    test_slurm.py VENATION BATCH_SCRIPT

Needs Slurm and munge, and root to start them; skips without, unless VENATION_REQUIRE is all and Slurm is what is missing.
"""
import glob
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time

from command import *

SCRIPT = os.path.abspath(sys.argv[2])
PATIENCE = 180  # seconds for the cluster to do anything

LEAF = """\
[growth]
kind = isogonic
initial_length = 20
final_length = 200
step = 2
[sources]
density = 0.01
birth_distance_sources = 4
birth_distance_veins = 4
[veins]
kill_distance = 1.5
[texture]
size = 256
exr = none
"""
SWEEP = """\
[sweep]
params = leaf.ini
mode = sample
count = 48
seed = each
veins.kill_distance = uniform(1, 3)
growth.initial_length = choice(20; 20; 20; 20; 20; 20; 20; 300)
"""
PARTS = 6
CONF = """\
ClusterName=leaftest
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={d}/munge.socket
CredType=cred/munge
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPort={port}
StateSaveLocation={d}/state
SlurmdSpoolDir={d}/spool-%n
SlurmctldPidFile={d}/slurmctld.pid
SlurmdPidFile={d}/slurmd-%n.pid
SlurmctldLogFile={d}/slurmctld.log
SlurmdLogFile={d}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmdTimeout=6
KillWait=2
InactiveLimit=0
MinJobAge=300
JobRequeue=1
NodeName=leaf[1-2] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{second}] CPUs=1 State=UNKNOWN
PartitionName=test Nodes=leaf[1-2] Default=YES MaxTime=10 State=UP
"""


def free_ports(n):
    """Ports that nobody listens on, in a row."""
    for first in range(21000 + os.getpid() % 2000, 60000, n):
        held = []
        try:
            for port in range(first, first + n):
                held.append(socket.socket())
                held[-1].bind(("127.0.0.1", port))
            return first
        except OSError:
            continue
        finally:
            for s in held:
                s.close()
    raise Skip("no free ports")


def until(what, condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"waited {PATIENCE} s for {what}")
        time.sleep(0.2)


def children(process):
    """Process numbers below a process, itself last."""
    found = []
    for path in glob.glob(f"/proc/{process}/task/*/children"):
        try:
            with open(path, encoding="ascii") as file:
                below = file.read().split()
        except OSError:  # it has just ended
            continue
        for child in below:
            found += children(int(child))
    return found + [process]


class Cluster:
    def __init__(self, folder):
        self.d, self.started = folder, []
        host, port = socket.gethostname().split(".")[0], free_ports(3)
        os.makedirs(f"{folder}/state")
        write(f"{folder}/slurm.conf", CONF.format(d=folder, host=host, port=port, first=port + 1, second=port + 2))
        self.env = environment(SLURM_CONF=f"{folder}/slurm.conf", VENATION=VENATION)
        with open(f"{folder}/munge.key", "wb") as key:
            key.write(os.urandom(1024))
        os.chmod(f"{folder}/munge.key", 0o400)
        os.chmod(folder, 0o755)
        subprocess.run(["munged", f"--key-file={folder}/munge.key", f"--socket={folder}/munge.socket", f"--log-file={folder}/munged.log",
                        f"--pid-file={folder}/munged.pid", f"--seed-file={folder}/munged.seed", "--force"], check=True, stderr=subprocess.DEVNULL)
        self.daemon("slurmctld", "slurmctld")
        self.nodes = {name: self.daemon("slurmd", f"slurmd-{name}", "-N", name) for name in ("leaf1", "leaf2")}
        until("the nodes", lambda: self.says("sinfo", "-h", "-N", "-o", "%T").split() == ["idle", "idle"])

    def daemon(self, program, log, *args):
        out = open(f"{self.d}/{log}.out", "wb")
        process = subprocess.Popen([program, "-D", *args], env=self.env, stdout=out, stderr=out, stdin=subprocess.DEVNULL)
        self.started.append(process)
        return process

    def says(self, *command):
        return subprocess.run(command, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False).stdout.decode().strip()

    def status(self, job):
        """Exit status of a job that has ended."""
        return int(re.search(r"ExitCode=(\d+):0", self.says("scontrol", "show", "job", job)).group(1))

    def submit(self, *args):
        job = self.says("sbatch", "--parsable", *args)
        if not job.isdigit():
            raise AssertionError(f"sbatch {args}: {job!r}")
        return job

    def lose(self, name, out):
        """The node dies with all that runs on it: nobody gets a word out. What it had in hand in the output folder looks like another machine's then, since all
        nodes are one here, and it could be told by the numbers of its processes that they are dead. Returns the name of that folder, hidden."""
        orphan = []

        def stopped():
            """At work, in mid-leaf; what is stopped writes no more."""
            for process in self.doomed(name):
                for path in glob.glob(f"{out}/.venation-*-{process}-*/*"):
                    os.kill(process, signal.SIGSTOP)
                    time.sleep(0.1)  # for what it was about
                    orphan[:] = [os.path.dirname(path)] if os.path.isdir(path) else []
                    if orphan:
                        return True
                    os.kill(process, signal.SIGCONT)
            return False

        until("a leaf in hand of the node", stopped)
        away = f"{out}/.venation-far-away-1-" + orphan[0][-6:]
        os.rename(orphan[0], away)
        doomed = self.doomed(name)
        for number in (signal.SIGSTOP, signal.SIGKILL):  # so that none tells of another's death
            for process in doomed:
                try:
                    os.kill(process, number)
                except ProcessLookupError:
                    pass
        self.nodes[name].wait()
        return os.path.basename(away)

    def doomed(self, name):
        """All processes of a node."""
        doomed = children(self.nodes[name].pid)
        # Steps are daemons of their own, named after the node's spool.
        for path in glob.glob("/proc/[0-9]*/cmdline"):
            process = int(path.split("/")[2])
            try:
                with open(path, "rb") as file:
                    words = file.read()
                with open(f"/proc/{process}/environ", "rb") as file:
                    about = file.read()
            except OSError:
                continue
            mine = f"SLURM_CONF={self.d}/".encode() in about
            if mine and (b"slurmstepd" in words or f"SLURMD_NODENAME={name}".encode() in about):
                if b"slurmstepd" not in words or self.step_of(process, name):
                    doomed += children(process)
        return doomed

    @staticmethod
    def step_of(process, name):
        """Whether what a step daemon runs is on that node."""
        for child in children(process)[:-1]:
            try:
                with open(f"/proc/{child}/environ", "rb") as file:
                    if f"SLURMD_NODENAME={name}".encode() in file.read():
                        return True
            except OSError:
                pass
        return False

    def revive(self, name):
        self.nodes[name] = self.daemon("slurmd", f"slurmd-{name}", "-N", name)

    def hurry(self, array):
        """A task that is queued again waits two minutes, which a test needn't."""
        for task in self.says("squeue", "-h", "-r", "-t", "PENDING", "-j", array, "-o", "%i").split():
            self.says("scontrol", "update", f"JobId={task}", "StartTime=now")

    def stop(self):
        for process in reversed(self.started):
            if process.poll() is None:
                for one in children(process.pid):
                    os.kill(one, signal.SIGTERM)
        for process in self.started:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
        with open(f"{self.d}/munged.pid", encoding="ascii") as file:
            os.kill(int(file.read()), signal.SIGTERM)


def leaves():
    return glob.glob("out/leaves/*/sweep.json")


def test_array_with_a_node_that_dies():
    need("slurmctld", "slurmd", "munged", "sbatch")
    if os.geteuid() != 0:
        raise Skip("needs root")
    write("leaf.ini", LEAF)
    write("many.ini", SWEEP)
    what = ("many.ini", "--dataset", "--size", "64")
    same(run("sweep", *what, "-q", "-o", "alone").status, 3)
    with open("alone/manifest.jsonl", encoding="utf-8") as file:
        bad = [row["index"] for row in map(json.loads, file) if row["outcome"] == "failed"]
    parts = {index % PARTS + 1 for index in bad}
    same(0 < len(bad) < 24 and 0 < len(parts) < PARTS, True, "some parts have variants that can't be grown, and some have none")
    cluster = Cluster(os.path.join(os.getcwd(), "cluster"))
    try:
        array = cluster.submit(f"--array=1-{PARTS}", SCRIPT, *what, "-o", "out")
        last = cluster.submit(f"--dependency=afterany:{array}", SCRIPT, *what, "-o", "out")
        until("the first leaves", lambda: len(leaves()) >= 3)
        orphan = cluster.lose("leaf2", "out")
        before = len(leaves())
        until("the loss of the node to be noticed", lambda: "down" in cluster.says("sinfo", "-h", "-n", "leaf2", "-o", "%T"))
        cluster.revive("leaf2")
        until("the array and the collection", lambda: cluster.hurry(array) or not cluster.says("squeue", "-h", "-j", f"{array},{last}"))
        told = cluster.says("scontrol", "show", "job", array)
        ended = {task: cluster.status(f"{array}_{task}") for task in range(1, PARTS + 1)}
        collected = cluster.status(last)
    finally:
        cluster.stop()
    same(before < 48, True, "the node died in mid-array")
    holds(told, "Restarts=1")
    made = {name: data for name, data in contents("out").items() if not name.startswith(orphan + "/")}
    same(sorted(made), files("alone"))
    same(made == contents("alone"), True, "what the array made is what one process makes")
    same([name for name in os.listdir("out") if name.startswith(".")], [orphan], "hidden folders")
    same(ended, {task: 3 if task in parts else 0 for task in ended}, "exit status of the parts")
    same(collected, 3, "exit status of the collection")
    same(len(os.listdir("out/failed")), len(bad))
    with open(f"venation-{last}-4294967294.log", encoding="utf-8") as file:
        log = file.read()
    holds(log, f"out: 1 hidden folder is of another run, at work or killed: {orphan}; remove")
    for name in sorted(os.listdir("out/failed"))[:3]:  # the first few are named
        holds(log, name.removesuffix(".json") + ": growth.final_length = 200 must not be below")


if __name__ == "__main__":
    sys.exit(main(globals()))
