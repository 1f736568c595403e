"""Writes that the disk refuses, while jobs are accepted and while results are stored: by a fault, or for lack of room."""
import collections
import errno
import itertools
import os
import signal
import socket
import subprocess
import tempfile
import time

from kills import session, verify_acknowledged, with_a_fault
from trials import (EXECUTION, FaultyServer, Server, Skip, all_jobs, expect, in_threads, integrity, latencies, percentile, trial,
                    unique_mesh, until_idle, verify_results)

FEW, MANY = 5, 20  # uploads; many make more changes than SQLite keeps in its log: the database itself is written, too
AT_ONCE = 4   # servers, which mostly wait
REFUSED_AT_START = 70
ENDED_BY_STORAGE = 74
FORMS = [(error, form) for error in (errno.EIO, errno.ENOSPC) for form in ("once", "torn", "on")] + [(errno.EIO, "kill")]


def writes_of_a_session(uploads):
    """What a server writes from its start until the results of a session are stored, in order."""
    with FaultyServer("--slots", "1", "--quiet", count_writes=True) as server:
        before = len(server.every_write())
        expect(len(session(server, uploads)) == uploads, "an upload was not accepted")
        until_idle(server)
        return server.every_write(), before


def chosen(kinds, started, rng, long):
    """Numbers of writes. Long: of each kind of file the first, the last and one more of the start, and after it the first two,
    the last and ten more; short: two of the start, and two of each kind after it."""
    places = collections.defaultdict(list)
    for i, kind in enumerate(kinds):
        places[kind, i >= started].append(i + 1)
    some = lambda numbers, count: rng.sample(numbers, min(count, len(numbers)))
    if not long:
        return sorted(some(range(1, started + 1), 2) + [n for (_, ready), all_of_it in sorted(places.items()) if ready for n in some(all_of_it, 2)])
    return sorted({n for (_, ready), all_of_it in sorted(places.items())
                   for n in all_of_it[:2 if ready else 1] + all_of_it[-1:] + some(all_of_it, 10 if ready else 1)})


def strike(number, error, form, uploads):
    """A server whose write fails, and its next start; (kind of the file, exit status or None, how many were acknowledged)."""
    with FaultyServer("--slots", "1", "--quiet", write=number, error=error, form=form, wait=False) as server:
        acknowledged, status = with_a_fault(server, uploads)
        if not server.fired():
            return None, status, len(acknowledged)
        if status == REFUSED_AT_START:
            expect(not server.port and not acknowledged, "a server that had served ended as if it could not start")
            expect(b"sheetform: " in server.log_bytes().splitlines()[-1], "it was not told why the server does not start")
        else:
            expect(status in ((-signal.SIGKILL,) if form == "kill" else (None, ENDED_BY_STORAGE)), f"the status is {status}")
        if status is None and form != "on":  # the disk is well again, and so is the server, with nobody's help
            until_idle(server)
            jobs = all_jobs(server)
            wrong = [jobs.get(i) for i in acknowledged if i not in jobs or jobs[i]["status"] != "successful"]
            expect(not wrong, f"after one failed write: {wrong[:1]}")
        server.stop(signal.SIGKILL)
        struck = server.struck()
        server.healthy()
        server.start()
        verify_acknowledged(server, acknowledged)
        server.stop()
        integrity(server.data)
        expect(not os.listdir(server.data + "/spool"), "an unfinished upload is left")
        return struck, status, len(acknowledged)


def told_strike(kinds, uploads, number, error, form):
    try:
        return strike(number, error, form, uploads)
    except AssertionError as e:
        raise AssertionError(f"write {number} ({kinds[number - 1]}), {errno.errorcode[error]} {form}: {e}")


@trial("T4w", "a write fails, half of it, all that follow, or kills: nothing acknowledged is lost, the server goes on or ends with 74")
def failing_writes(figures, long, rng):
    uploads = MANY if long else FEW
    kinds, started = writes_of_a_session(uploads)
    numbers = chosen(kinds, started, rng, long)
    tries = [(n, *fault) for n in numbers for fault in (FORMS if long else [rng.choice(FORMS)])]
    struck, ends, total = collections.Counter(), collections.Counter(), 0

    def several(first):
        return [told_strike(kinds, uploads, *fault) for fault in tries[first::AT_ONCE]]
    for kind, status, acknowledged in itertools.chain(*in_threads(AT_ONCE, several)):
        struck[kind] += 1
        ends["went on" if status is None else status] += 1
        total += acknowledged
    expect(sum(struck.values()) - struck[None] >= len(tries) / 2, "most of the faults never came")
    figures.put(writes_of_a_session=len(kinds), tried=len(tries), struck=str(dict(struck)), ends=str(dict(ends)),
                acknowledged=total, lost=0)


class HalfAnUpload:
    """An upload that has begun; the rest of it comes when it is asked for."""

    def __init__(self, server):
        self.rest = b"# " + b"x" * 2_000_000 + b"\n"
        self.socket = socket.create_connection(("127.0.0.1", server.port), timeout=60)
        mesh = unique_mesh()
        head = f"POST {EXECUTION} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {len(mesh) + len(self.rest)}\r\n\r\n"
        self.socket.sendall(head.encode() + mesh)

    def status(self):
        """Sends the rest; the status of the answer."""
        with self.socket as s:
            try:
                s.sendall(self.rest)
            except (BrokenPipeError, ConnectionResetError):
                pass  # answered before all was sent
            return int(s.makefile("rb").readline().split()[1])


def while_full(server, old, seconds):
    """What clients see on a full disk for so long; how many uploads were refused."""
    begun, refused = time.monotonic(), 0
    while time.monotonic() - begun < seconds:
        answer = server.request("POST", EXECUTION, unique_mesh() + b"# " + b"x" * 300_000, check=False)
        expect((answer.status, answer.slug()) == (507, "disk-full"), f"an upload got {answer.status} {answer.body[:200]}")
        refused += 1
        expect(verify_results(server, old) == 3, "the old result cannot be read")
        expect(server.request("GET", "/api/v1/jobs", check=False).status == 200, "the list cannot be read")
        expect(server.request("GET", "/healthz", check=False).status == 200, "a full disk is no bad health")
        time.sleep(0.05)
    return refused


def hold_to_full_disk(figures, server, fill, empty, data, long):
    """What must hold of a server whose disk fill() fills and empty() empties again."""
    old = server.wait(server.submit()["jobID"])["jobID"]
    for _ in range(40):  # SQLite has then written room for more than it needs just now
        server.submit(name="work-0.obj")
    until_idle(server)
    count, path = 300 if long else 60, f"/api/v1/jobs/{old}"
    before = latencies(server.port, path, count)
    running = [server.submit(name="work-4000.obj")["jobID"] for _ in range(2)]  # they end while the disk is full
    waiting = [server.submit()["jobID"] for _ in range(3)]
    for job_id in running:
        server.wait(job_id, until=("running",))
    upload = HalfAnUpload(server)
    server.until("the upload has begun", lambda: os.listdir(data + "/spool"))
    fill()
    expect(upload.status() == 507, "an upload that finds no more room is not told so")
    full = latencies(server.port, path, count)
    refused = while_full(server, old, 120 if long else 5)
    server.until("no unfinished upload is left", lambda: not os.listdir(data + "/spool"))
    states = {server.job(i)["status"] for i in running + waiting}
    expect(states <= {"accepted", "running"}, f"jobs ended on a full disk: {states}")
    empty()
    begun = time.monotonic()
    server.until("uploads are taken again", lambda: server.request("POST", EXECUTION, unique_mesh(), check=False).status == 201)
    taken = time.monotonic() - begun
    server.until("a job ends", lambda: "successful" in {server.job(i)["status"] for i in running + waiting})
    figures.bar("uploads_again_seconds", taken, most=5)
    figures.bar("jobs_again_seconds", time.monotonic() - begun, most=5)
    for job_id in running + waiting:
        job = server.wait(job_id, timeout=600)
        expect(job["status"] == "successful", f"after the disk had room again: {job}")
    figures.put(uploads_refused=refused, all_ended_seconds=time.monotonic() - begun, get_before_p99=percentile(before, 0.99),
                computed_twice=sum(server.job(i)["attempt"] - 1 for i in running + waiting))
    # The same as before, but for what the machine does beside.
    figures.bar("get_full_p99", percentile(full, 0.99), most=0.01 + 2 * percentile(before, 0.99))


@trial("T5", "a full disk: uploads are refused, reading goes on, jobs wait for room and then end well")
def full_disk(figures, long, rng):
    with FaultyServer("--slots", "2", "--quiet") as server:
        hold_to_full_disk(figures, server, lambda: server.full(True), lambda: server.full(False), server.data, long)
        server.stop()
        integrity(server.data)


SMALL_DISK = ["unshare", "-m", "sh", "-c", 'mount -t tmpfs -o size=64m none "$0" && exec "$@"']


def fill_up(path):
    """Writes a file until nothing more fits."""
    with open(path, "wb", buffering=0) as f:
        for size in (1 << 20, 4096, 1):
            try:
                while True:
                    f.write(b"x" * size)
            except OSError as e:
                expect(e.errno == errno.ENOSPC, str(e))


@trial("T5t", "the same on a real disk of 64 MiB")
def small_disk(figures, long, rng):
    data = tempfile.mkdtemp(prefix="sheetform-small-")
    if subprocess.run([*SMALL_DISK, data, "true"], stderr=subprocess.DEVNULL).returncode != 0:
        raise Skip("nothing can be mounted here")
    with Server("--slots", "2", "--quiet", data=data, below=[*SMALL_DISK, data]) as server:
        server.own_data = True
        folder = os.open(f"/proc/{server.process.pid}/root{data}", os.O_RDONLY)  # it is there as long as this is open
        within = f"/proc/self/fd/{folder}"
        try:
            hold_to_full_disk(figures, server, lambda: fill_up(within + "/ballast"), lambda: os.unlink(within + "/ballast"),
                              within, long)
            server.stop()
            integrity(within)
        finally:
            os.close(folder)
