"""Many at once: slow and idle clients, a long queue, large uploads, crashing jobs, storms of cancels, busy slots."""
import hashlib
import itertools
import json
import math
import multiprocessing
import os
import random
import re
import signal
import socket
import subprocess
import tempfile
import threading
import time

from trials import (EXECUTION, STORE_LOAD, FaultyServer, Server, Skip, all_jobs, arc, expect, fill_queue, in_processes, in_threads, integrity,
                    latencies, percentile, trial, unique_mesh, until_idle)


DRAIN_ALL = False  # reliability.py --drain


def connect(server, data=b"", receive_buffer=None):
    s = socket.socket()
    if receive_buffer:
        s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
    s.settimeout(30)
    s.connect(("127.0.0.1", server.port))
    s.sendall(data)
    return s


def put_latencies(figures, name, times, most=None):
    figures.put(**{f"{name}_p50": percentile(times, 0.5)})
    figures.bar(f"{name}_p99", percentile(times, 0.99), most=most)


@trial("T7", "200 idle clients, 200 that send their head byte by byte, 32 slow uploads, 64 slow readers")
def slow_crowd(figures, long, rng):
    crowd = (200, 200, 32, 64) if long else (60, 60, 8, 16)
    with Server("--slots", "1", "--quiet") as server:
        job = server.wait(server.submit()["jobID"])["jobID"]
        put_latencies(figures, "alone", latencies(server.port, "/api/v1/jobs", 300 if long else 50))
        memory, stop = server.memory(), threading.Event()
        held = [connect(server) for _ in range(crowd[0])]
        dripping = [connect(server, b"GET /healthz HTTP/1.1\r\nHost: loc") for _ in range(crowd[1])]
        held += [connect(server, f"POST {EXECUTION} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\nv 0 ".encode())
                 for _ in range(crowd[2])]
        held += [connect(server, f"GET /api/v1/jobs/{job}/results/big.bin HTTP/1.1\r\nHost: localhost\r\n\r\n".encode(), 4096)
                 for _ in range(crowd[3])]

        def drip():
            while not stop.wait(0.5):
                for s in dripping:
                    try:
                        s.send(b"a")
                    except OSError:
                        pass  # given up by the server, as it should be
        thread = threading.Thread(target=drip)
        thread.start()
        try:
            times = latencies(server.port, "/api/v1/jobs", 1500 if long else 100)
        finally:
            stop.set()
            thread.join()
        put_latencies(figures, "beside", times, most=0.1)
        figures.bar("memory_growth_mib", (server.memory() - memory) / 2**20, most=64)
        for s in held + dripping:
            s.close()
        expect(server.get("/healthz").status == 200, "the server is not well afterwards")


@trial("T10", "a long queue: accepted quickly, listed quickly, ready quickly after kill -9, worked off in order")
def long_queue(figures, long, rng):
    count, clients = (10000, 8) if long else (60, 4)
    with Server("--slots", "1", "--quiet") as server:
        blocker = server.submit(name="work-800000.obj")["jobID"]
        server.wait(blocker, until=("running",))
        figures.bar("accepted_per_second", fill_queue(server, count, clients), least=300)
        figures.put(queued=count)
        put_latencies(figures, "list_of_100", latencies(server.port, "/api/v1/jobs?limit=100", 200 if long else 20), most=0.02)
        put_latencies(figures, "one_job", latencies(server.port, f"/api/v1/jobs/{blocker}", 200 if long else 20), most=0.05)
        figures.bar("memory_mib", server.memory() / 2**20, most=200)
        server.stop(signal.SIGKILL)
        begun = time.monotonic()
        server.start()
        figures.bar("ready_after_kill_seconds", time.monotonic() - begun, most=2)
        server.wait(blocker, until=("running",))
        server.request("DELETE", f"/api/v1/jobs/{blocker}", check=False)
        begun = time.monotonic()
        if long and not DRAIN_ALL:
            time.sleep(20)  # all of them would take a quarter of an hour
        else:
            until_idle(server, 300 + count)
        seconds, jobs = time.monotonic() - begun, all_jobs(server).values()
        jobs = [job for job in jobs if job["jobID"] != blocker]
        expect(len(jobs) == count, f"of {count} jobs {len(jobs)} are there")
        done = [job["created"] for job in jobs if job["status"] == "successful"]
        others = [job["created"] for job in jobs if job["status"] != "successful"]
        # Those of one millisecond have no order here.
        expect(done and (not others or max(done) <= min(others)), "jobs overtake each other")
        figures.put(worked_off_per_second=len(done) / seconds)


@trial("T10r", "a store of many jobs: a page of the list, and the next job for a slot, come as quickly as from a small one")
def large_store(figures, long, rng):
    if not STORE_LOAD:
        raise Skip("STORE_LOAD does not name the program that fills a store")
    rows, waiting, claims = (100_000, 10_000, 2000) if long else (2000, 500, 50)
    with Server("--slots", "1", "--quiet") as server:
        server.stop()
        subprocess.run([STORE_LOAD, server.data, str(rows), "0", "0"], check=True)
        server.start()
        first = server.request("GET", "/api/v1/jobs?limit=100", check=False).json()
        expect(len(first["jobs"]) == 100, "a page is not full")
        after = next(link["href"] for link in first["links"] if link["rel"] == "next")
        for name, path, most in (("page", "?limit=100", 0.02), ("next_page", after[after.index("?"):], 0.02),
                                 ("one_state", "?limit=100&status=dismissed", 0.02),
                                 ("none_found", "?limit=100&status=running", 0.02)):
            put_latencies(figures, name, latencies(server.port, "/api/v1/jobs" + path, 300 if long else 30), most=most)
        figures.bar("memory_mib", server.memory() / 2**20, most=200)
        server.stop()
        told = subprocess.run([STORE_LOAD, server.data, "0", str(waiting), str(claims)], check=True, stdout=subprocess.PIPE)
        put_latencies(figures, "claim", [float(line) for line in told.stdout.split()], most=0.005)
        figures.put(rows=rows, waiting=waiting, claims=claims)
        integrity(server.data)


@trial("T10s", "uploads of many at a disk whose syncs take 10 ms: they share them")
def slow_disk(figures, long, rng):
    count, clients, slow = (1600, 16, 10) if long else (48, 8, 10)
    with FaultyServer("--slots", "1", "--quiet", slow=slow) as server:
        server.wait(server.submit(name="work-800000.obj")["jobID"], until=("running",))
        # One transaction each could not take more than 100 in a second, whatever the machine.
        figures.bar("accepted_per_second", fill_queue(server, count, clients), least=150)
        expect(len(all_jobs(server)) == count + 1, "a job is missing")


def disk_rate(folder, block, writers, blocks):
    """MiB a second of plain writers that sync at the end, each its own file, to compare with."""
    def write(i):
        with open(f"{folder}/spool/rate-{i}", "wb", buffering=0) as f:
            for _ in range(blocks):
                f.write(block)
            os.fsync(f.fileno())
    begun = time.monotonic()
    in_threads(writers, write)
    seconds = time.monotonic() - begun
    for i in range(writers):
        os.unlink(f"{folder}/spool/rate-{i}")
    return writers * blocks * len(block) / 2**20 / seconds


@trial("T11", "32 large uploads at once: every digest right, memory flat, as fast as the disk or the processors")
def large_uploads(figures, long, rng):
    size, count = (200 << 20, 32) if long else (2 << 20, 8)
    block = random.Random(7).randbytes(1 << 20)
    whole = hashlib.sha256()
    for _ in range(size // len(block)):
        whole.update(block)
    with Server("--slots", "1", "--quiet") as server:
        peak, stop = [server.memory()], threading.Event()

        def watch():
            while not stop.wait(0.05):
                peak[0] = max(peak[0], server.memory())
        watcher = threading.Thread(target=watch)

        def send(i):
            def pieces():
                for _ in range(size // len(block)):
                    yield block
                yield b"%d" % i
            answer = server.request("POST", f"{EXECUTION}?filename=work-0.obj", pieces(), timeout=600, check=False)
            expect(answer.status == 201, f"an upload got {answer.status} {answer.body[:200]}")
            digest = whole.copy()
            digest.update(b"%d" % i)
            expect(answer.json()["inputs"]["mesh"]["sha256"] == digest.hexdigest(), "a digest is wrong")
            return answer.json()["jobID"]
        # A disk that others use, or that grants bursts, is another one from second to second: looked at on both sides.
        plain = [disk_rate(server.data, block, count, size >> 20)]
        watcher.start()
        used, begun = server.processor_seconds(), time.monotonic()
        jobs = in_threads(count, send)
        seconds, used = time.monotonic() - begun, server.processor_seconds() - used
        stop.set()
        watcher.join()
        plain.append(disk_rate(server.data, block, count, size >> 20))
        mib = count * (size >> 20)
        figures.put(uploads=count, mib_each=size >> 20, mib_per_second=mib / seconds, disk_before=plain[0], disk_after=plain[1],
                    share_of_disk=mib / seconds / (sum(plain) / 2))
        figures.bar("share_of_slower_disk", mib / seconds / min(plain), least=0.8)
        # Hashing a GiB takes 0.6 s of a processor, receiving and writing it about as much each.
        figures.bar("server_seconds_per_gib", used * 1024 / mib, most=3)
        figures.bar("memory_peak_mib", peak[0] / 2**20, most=150)
        expect(len(set(jobs)) == count, "two uploads became one job")


def upload_alone(server, block, blocks):
    """Sends so many blocks as one mesh by a single connection; (seconds until the 201, those of a processor that the server
    used for it)."""
    digest = hashlib.sha256()
    for _ in range(blocks):
        digest.update(block)
    used, begun = server.processor_seconds(), time.monotonic()
    head = f"POST {EXECUTION}?filename=work-0.obj HTTP/1.1\r\nHost: localhost\r\nContent-Length: {blocks * len(block)}\r\n\r\n"
    with connect(server, head.encode()) as s:
        s.settimeout(600)
        for _ in range(blocks):
            s.sendall(block)
        answer = b""
        while piece := s.recv(65536):
            answer += piece
    seconds = time.monotonic() - begun
    status, _, body = answer.partition(b"\r\n\r\n")
    expect(b" 201 " in status[:20], f"an upload got {answer[:200]}")
    expect(json.loads(body)["inputs"]["mesh"]["sha256"] == digest.hexdigest(), "a digest is wrong")
    return seconds, server.processor_seconds() - used


@trial("T11s", "one client with a large mesh: 500 MB a second into memory, and on the disk as fast as the disk")
def single_upload(figures, long, rng):
    blocks, block, memory = (240 if long else 16), random.Random(11).randbytes(1 << 20), "/dev/shm"
    if not os.access(memory, os.W_OK) or os.statvfs(memory).f_bavail * os.statvfs(memory).f_frsize < 4 * blocks << 20:
        memory = None
    for place, folder in (("memory", memory), ("disk", None)):
        if place == "memory" and memory is None:
            continue
        with Server("--slots", "1", "--quiet", data=tempfile.mkdtemp(prefix="sheetform-alone-", dir=folder)) as server:
            server.own_data = True
            plain = disk_rate(server.data, block, 1, blocks) * 2**20 / 1e6
            tries = [upload_alone(server, block[i:] + block[:i], blocks) for i in range(3 if long else 1)]
            rates = sorted(blocks * len(block) / 1e6 / seconds for seconds, _ in tries)
            figures.put(**{f"{place}_plain_mb_per_second": plain, f"{place}_processor_seconds": min(used for _, used in tries)})
            if place == "memory":
                figures.bar("memory_mb_per_second", rates[-1], least=500)
            else:
                figures.put(disk_mb_per_second=rates[-1])
                figures.bar("share_of_disk", rates[-1] / min(plain, 500), least=0.6)


WAYS = {"memory": "memory-limit", "abort": "worker-crashed", "refuse": "unsupported-mesh", "nothing": "algorithm-failed",
        "exit": "algorithm-failed", "fork": "algorithm-failed", "huge": "limit-exceeded", "missing": "algorithm-failed", "link": "algorithm-failed", "none": "algorithm-failed",
        "flood": "algorithm-failed", "segv": "worker-crashed", "kill": "memory-limit", "spin": "time-limit", "deaf": "time-limit"}


def strays(data):
    """Processes that hold a folder of a job, whoever their parent is."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            if os.readlink(f"/proc/{pid}/fd/4").startswith(data + "/work"):
                found.append(pid)
        except OSError:
            pass  # gone, or none of ours
    return found


@trial("T12", "jobs that crash, spin, flood and lie among good ones: each told apart, nobody else harmed")
def crashing_jobs(figures, long, rng):
    rounds, ways = (12, sorted(WAYS)) if long else (1, sorted(set(WAYS) - {"spin", "deaf", "huge"}))  # slow ones
    with Server("--slots", "8", "--job-seconds", "20" if long else "120", "--job-memory", "128", "--quiet") as server:
        pid, bad, good = server.process.pid, [], []
        for _ in range(rounds):
            for way in rng.sample(ways, len(ways)):
                bad.append((way, server.submit(name=f"{way}.obj")["jobID"]))
                good.append(server.submit(name="work-20.obj")["jobID"])
        for way, job_id in bad:
            job = server.wait(job_id, timeout=600)
            problem = job["exception"] if job["status"] == "failed" else {"type": ""}
            expect(problem["type"].endswith(WAYS[way]) and problem["detail"] and problem.get("fix"), f"{way}: {job}")
            expect(job["attempt"] <= 3, f"{way} was started {job['attempt']} times")
        for job_id in good:
            expect(server.wait(job_id, timeout=600)["status"] == "successful", "a good job was harmed")
        expect(server.process.pid == pid and server.process.poll() is None, "the server died")
        server.until_tidy()
        server.until("no process that a job had begun lives on", lambda: not strays(server.data))  # they were killed just now
        figures.put(bad=len(bad), good=len(good))


@trial("T13", "cancels at random moments and in storms: the job's process is gone within a second, nothing is left")
def cancels(figures, long, rng):
    gone = []
    with Server("--slots", "2", "--quiet") as server:
        for i in range(60 if long else 8):
            job_id = server.submit(name="deaf.obj" if i % 5 == 0 else "work-800.obj")["jobID"]
            time.sleep(rng.random() * 0.9)
            begun = time.monotonic()
            expect(server.request("DELETE", f"/api/v1/jobs/{job_id}", check=False).status == 200, "a cancel was refused")
            while server.children():
                time.sleep(0.005)
                expect(time.monotonic() - begun < 60, "a cancelled process does not end")
            gone.append(time.monotonic() - begun)
        figures.put(cancels=len(gone), gone_median=percentile(gone, 0.5))
        figures.bar("gone_worst_seconds", max(gone), most=1)
        storm = 200 if long else 40
        ids = in_threads(10, lambda i: [server.submit(name="work-300.obj")["jobID"] for _ in range(storm // 10)])
        ids = [i for some in ids for i in some]
        answers = in_threads(10, lambda i: [server.request("DELETE", f"/api/v1/jobs/{j}", check=False).status for j in ids[i::10]])
        expect({s for some in answers for s in some} == {200}, "a cancel of the storm was refused")
        until_idle(server)
        server.until_tidy()
        expect(server.wait(server.submit()["jobID"])["status"] == "successful", "no job runs any more")
        figures.put(storm=storm)


def for_seconds(seconds):
    until = time.monotonic() + seconds
    return lambda: time.monotonic() < until


def client_work(server, going, mesh=unique_mesh):
    """What a script does while going(): sends a mesh, looks after it and at the list, cancels it; the seconds that each
    request took, by kind."""
    times = {"submit": [], "look": [], "list": [], "cancel": []}

    def timed(kind, method, path, body=None):
        begun = time.monotonic()
        answer = server.request(method, path, body, check=False)
        times[kind].append(time.monotonic() - begun)
        expect(answer.status in (200, 201), f"{method} {path}: {answer.status}")
        return answer
    while going():
        job = timed("submit", "POST", EXECUTION, mesh()).json()["jobID"]
        for _ in range(5):
            timed("look", "GET", f"/api/v1/jobs/{job}")
            timed("list", "GET", "/api/v1/jobs?limit=100")
            time.sleep(0.05)
        timed("cancel", "DELETE", f"/api/v1/jobs/{job}")
    return times


@trial("T18", "all slots busy: other requests stay quick, those of ten clients at once too")
def busy_slots(figures, long, rng):
    slots = os.cpu_count() or 2
    with Server("--slots", str(slots), "--quiet") as server:
        spinning = [server.submit(name="spin.obj")["jobID"] for _ in range(slots)]
        for job_id in spinning:
            server.wait(job_id, until=("running",))
        count = 1000 if long else 60
        put_latencies(figures, "list", latencies(server.port, "/api/v1/jobs", count), most=0.05)
        put_latencies(figures, "health", latencies(server.port, "/healthz", count), most=0.05)
        told = in_processes(10, lambda i: client_work(server, for_seconds(20 if long else 1)))
        for kind, most in (("submit", 0.5), ("look", 0.1), ("list", 0.1), ("cancel", 0.1)):
            put_latencies(figures, f"ten_{kind}", [t for times in told for t in times[kind]], most=most)
        for job_id in spinning:
            expect(server.job(job_id)["status"] == "running", "a slot was free")
            server.request("DELETE", f"/api/v1/jobs/{job_id}", check=False)
        figures.put(slots=slots, requests=sum(len(times[kind]) for times in told for kind in times))


VISITOR = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "browser", "visitor.mjs")


def ring(around, across):
    """A torus as OBJ, of 2 * around * across triangles."""
    lines = []
    for i in range(around):
        for j in range(across):
            a, b = math.tau * i / around, math.tau * j / across
            r = 3 + math.cos(b)
            lines.append("v %.6f %.6f %.6f" % (r * math.cos(a), r * math.sin(a), math.sin(b)))
    for i in range(around):
        for j in range(across):
            a, b = i * across + j + 1, (i + 1) % around * across + j + 1
            c, d = (i + 1) % around * across + (j + 1) % across + 1, i * across + (j + 1) % across + 1
            lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    return ("\n".join(lines) + "\n").encode()


def give_way(parents):
    """Gives the sessions of the children of these processes (node starts a browser in one of its own) a third of the weight
    of ours. A nice value of a process counts only within its session, where the kernel groups processes by session."""
    while any(parent.poll() is None for parent in parents):
        for parent in parents:
            listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(parent.pid)], stdout=subprocess.PIPE)
            for pid in listed.stdout.split():
                try:
                    os.setpriority(os.PRIO_PROCESS, int(pid), 5)
                    with open(f"/proc/{int(pid)}/autogroup", "w") as group:
                        group.write("5")
                except OSError:
                    pass  # gone, or a kernel without such groups
        time.sleep(0.3)


def visitors(server, count, seconds):
    """Browsers that come again and again; all their times by kind. They draw without a graphics card, on the processors of
    the server, which those of visitors never do: so they give way to server and scripts, and what they have to wait for is
    mostly themselves: their times are told, those of the page's answers are measured by read_page()."""
    with tempfile.NamedTemporaryFile(suffix=".obj") as file:
        file.write(arc())
        file.flush()
        command = ["node", VISITOR, f"http://127.0.0.1:{server.port}/", file.name, str(seconds)]
        browsers = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=lambda: os.nice(5))
                    for _ in range(count)]
        threading.Thread(target=give_way, args=(browsers,), daemon=True).start()
        told = [browser.communicate(timeout=6000) for browser in browsers]
    for browser, (_, wrong) in zip(browsers, told):
        expect(browser.returncode == 0, f"a browser failed: {wrong.decode(errors='replace')[-600:]}")
    answers = [json.loads(out) for out, _ in told]
    expect(not any(a["complaints"] for a in answers), f"the page complains: {answers[0]['complaints'][:3]}")
    return {kind: [t for a in answers for t in a["times"][kind]] for kind in answers[0]["times"]}


def read_page(server, going):
    """Asks for all that a browser asks for on a visit, but draws nothing; the seconds that each answer took."""
    page = server.request("GET", "/", check=False).body.decode()
    files = sorted(set(re.findall(r'(?:src|href)="/?([^":#]+)"', page)))
    paths = ["/", *("/" + name for name in files), "/api/v1/limits", "/api/v1/processes/decompose", "/api/v1/jobs?limit=100"]
    times = []
    while going():
        for path in paths:
            begun = time.monotonic()
            answer = server.request("GET", path, check=False)
            times.append(time.monotonic() - begun)
            expect(answer.status == 200, f"GET {path}: {answer.status}")
        time.sleep(0.1)
    return times


@trial("T25", "two browsers and ten scripts at once, the real program, all slots busy")
def company(figures, long, rng):
    if not long and not os.environ.get("SHEETFORM_BROWSERS"):
        raise Skip("needs node, Chromium and the packages of tests/browser; set SHEETFORM_BROWSERS")
    slots, seconds, over = os.cpu_count() or 2, 40 if long else 3, multiprocessing.get_context("fork").Event()
    with Server("--slots", str(slots), "--quiet", fake=False) as server:
        work = ring(400, 160) if long else ring(200, 100)  # minutes of work at this tolerance
        busy = [server.submit(work + b"# %d\n" % i, name=f"ring-{i}.obj", e_max=0.001)["jobID"] for i in range(slots)]
        for job_id in busy:
            server.wait(job_id, timeout=600, until=("running",))
        visited = {}

        def script(i):
            seeds = itertools.count(1 + 10000 * i)
            if i == 0:
                return {"answers": read_page(server, lambda: not over.is_set())}
            return client_work(server, lambda: not over.is_set(), lambda: arc(seed=next(seeds)))

        def watch_browsers():
            try:
                visited.update(visitors(server, 2, seconds))
            finally:
                over.set()
        page, *told = in_processes(11, script, watch_browsers)
        for kind, times in visited.items():
            put_latencies(figures, f"browser_{kind}", times)
        put_latencies(figures, "page_answers", page["answers"], most=0.1)
        for kind, most in (("submit", 0.5), ("look", 0.1), ("list", 0.1), ("cancel", 0.1)):
            put_latencies(figures, f"ten_{kind}", [t for times in told for t in times[kind]], most=most)
        figures.put(slots=slots, visits=len(visited["page_load"]), requests=sum(len(t[k]) for t in told for k in t))
        for job_id in busy:
            expect(server.job(job_id)["status"] == "running", "a slot was free")
            server.request("DELETE", f"/api/v1/jobs/{job_id}", check=False)
