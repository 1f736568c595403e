"""What the trials share: the list of them, figures and bars, loads in processes of their own, a preloaded server."""
import errno
import multiprocessing
import os
import random
import struct
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server_process"))
from harness import EXECUTION, PROGRAM, Server, arc, unique_mesh  # noqa: E402,F401

IO_FAULTS = os.environ.get("IO_FAULTS", "")
STORE_LOAD = os.environ.get("STORE_LOAD", "")
TRIALS = []


class Skip(Exception):
    """The machine cannot do this; the text says why."""


class Figures:
    """What a trial measured. Bars are promises about time and memory: a busy machine may miss them, so only the long
    form holds a trial to them."""

    def __init__(self):
        self.values, self.missed = {}, []

    def put(self, **values):
        self.values.update({k: round(v, 4) if isinstance(v, float) else v for k, v in values.items()})

    def bar(self, name, value, most=None, least=None):
        self.put(**{name: value})
        if (most is not None and value > most) or (least is not None and value < least):
            self.missed.append(f"{name} {value:.4g}, bar {most if most is not None else least}")


def trial(code, title):
    """A function (figures, long, rng): raises AssertionError when a promise is broken."""
    def add(function):
        TRIALS.append((code, title, function))
        return function
    return add


def expect(good, text):
    if not good:
        raise AssertionError(text)


def percentile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(len(ordered) * share))]


def latencies(port, path, count):
    """Seconds of `count` requests one after the other, each on a connection of its own, from a process of its own (the
    load may come from threads of this one)."""
    def measure(i):
        import http.client
        times = []
        for _ in range(count):
            begun = time.monotonic()
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
            connection.request("GET", path)
            good = connection.getresponse().read() is not None
            connection.close()
            times.append(time.monotonic() - begun if good else 60.0)
        return times
    return in_processes(1, measure)[0]


def in_processes(count, work, meanwhile=lambda: None):
    """Calls work(i) in `count` processes, and meanwhile() here; the answers, or the first exception. Threads of one Python
    wait for each other, so that what they measure is not what the server took."""
    def call(i, pipe):
        try:
            pipe.send((True, work(i)))
        except BaseException as e:  # told by the one that started it
            pipe.send((False, f"{type(e).__name__}: {e}"))
    context, started = multiprocessing.get_context("fork"), []
    for i in range(count):
        mine, theirs = context.Pipe(False)
        started.append((context.Process(target=call, args=(i, theirs)), mine))
        started[-1][0].start()
        theirs.close()
    try:
        meanwhile()
    finally:
        told = [pipe.recv() for _, pipe in started]
        for process, _ in started:
            process.join()
    for good, answer in told:
        expect(good, answer)
    return [answer for _, answer in told]


def in_threads(count, work):
    """Calls work(i) in `count` threads; the answers, or the first exception."""
    answers, faults = [None] * count, []

    def run(i):
        try:
            answers[i] = work(i)
        except BaseException as e:  # told by the caller's thread
            faults.append(e)
    threads = [threading.Thread(target=run, args=(i,)) for i in range(count)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    if faults:
        raise faults[0]
    return answers


def fill_queue(server, count, clients):
    """Sends `count` small jobs, by so many clients at once; jobs a second."""
    def send(i):
        for _ in range(count // clients):
            answer = server.request("POST", f"{EXECUTION}?filename=work-0.obj", unique_mesh(), check=False)
            expect(answer.status == 201, f"an upload got {answer.status} {answer.body[:200]}")
    begun = time.monotonic()
    in_threads(clients, send)
    return count / (time.monotonic() - begun)


def all_jobs(server):
    jobs, path = [], "/api/v1/jobs?limit=1000"
    while path:
        page = server.request("GET", path, check=False).json()
        jobs += page["jobs"]
        path = next((link["href"] for link in page["links"] if link["rel"] == "next"), None)
    return {job["jobID"]: job for job in jobs}


def until_idle(server, seconds=300):
    """Waits until no job waits or runs."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if not server.request("GET", "/api/v1/jobs?status=accepted,running&limit=1", check=False).json()["jobs"]:
            return
        time.sleep(0.1)
    raise AssertionError(f"jobs still wait or run after {seconds} s")


def verify_results(server, job_id):
    """Every file of a result against its digest; how many."""
    import hashlib
    results = server.request("GET", f"/api/v1/jobs/{job_id}/results", check=False)
    expect(results.status == 200, f"no result of {job_id}: {results.status} {results.body[:200]}")
    for entry in results.json().values():
        body = server.request("GET", entry["href"], check=False).body
        expect(hashlib.sha256(body).hexdigest() == entry["sha256"], f"{entry['href']} does not have its digest")
    return len(results.json())


class FaultyServer(Server):
    """A server under io_faults.cpp: its sync number `sync` fails, or its write number `write` with `error` in one of the
    forms of the library, or each sync takes `slow` milliseconds more. count_writes: every_write() tells them. full(True)
    fills its disk, clock(s) puts its clock forward by s seconds."""

    def __init__(self, *options, sync=None, write=None, error=errno.EIO, form="once", count_writes=False, slow=None, **others):
        if not IO_FAULTS or "libasan" in os.environ.get("LD_PRELOAD", ""):
            raise Skip("IO_FAULTS does not name the library to preload")
        import tempfile
        self.control = tempfile.mkdtemp(prefix="sheetform-faults-")
        self.fired_mark, self.full_mark = self.control + "/fired", self.control + "/full"
        self.clock_file = self.control + "/clock"
        self.clock(0)
        data = others.setdefault("data", tempfile.mkdtemp(prefix="sheetform-test-"))
        env = {"LD_PRELOAD": IO_FAULTS, "FAULT_FIRED": self.fired_mark, "FAULT_FULL": self.full_mark,
               "FAULT_FOLDER": data, "FAULT_CLOCK": self.clock_file}
        if sync:
            env["FAULT_SYNC"] = str(sync)
        if write:
            env.update(FAULT_WRITE=str(write), FAULT_ERROR=str(error), FAULT_FORM=form)
        if count_writes:
            env["FAULT_WRITES"] = self.control + "/writes"
        if slow:
            env["FAULT_SLOW"] = str(slow)
        super().__init__(*options, env=env, **others)
        self.own_data = True

    def healthy(self):
        """No more faults from the next start on."""
        self.env = {k: v for k, v in self.env.items() if k not in ("LD_PRELOAD", "FAULT_SYNC", "FAULT_WRITE")}

    def full(self, state):
        if state:
            open(self.full_mark, "w").close()
        elif os.path.exists(self.full_mark):
            os.unlink(self.full_mark)

    def clock(self, seconds):
        with open(self.clock_file, "r+b" if os.path.exists(self.clock_file) else "wb") as f:
            f.write(struct.pack("=q", int(seconds * 1e9)))

    def fired(self):
        return os.path.exists(self.fired_mark)

    def struck(self):
        """Which file the fault has struck: "sheetform.db-wal", "part" for an upload, ..."""
        with open(self.fired_mark) as f:
            return kind_of(f.readline())

    def every_write(self):
        """The files that were written so far, in order, named as by struck()."""
        with open(self.control + "/writes") as f:
            return [kind_of(line) for line in f]

    def __exit__(self, *unused):
        super().__exit__()
        import shutil
        shutil.rmtree(self.control, ignore_errors=True)


def kind_of(path):
    name = os.path.basename(path.strip())
    return "part" if name.endswith(".part") else name


def integrity(data):
    """SQLite's own check of both databases of a stopped server."""
    import sqlite3
    for name in ("sheetform.db", "blobs.db"):
        connection = sqlite3.connect(os.path.join(data, name))
        found = connection.execute("PRAGMA integrity_check").fetchall()
        connection.close()
        expect(found == [("ok",)], f"{name}: {found[:3]}")


def seeded(seed, code):
    return random.Random(f"{seed} {code}")
