"""A long time of everything at a modest rate: nothing grows that should not."""
import os
import random
import re
import subprocess
import threading
import time

from trials import EXECUTION, STORE_LOAD, Server, Skip, expect, in_threads, integrity, percentile, trial, unique_mesh, until_idle, verify_results

MINUTES = 15  # reliability.py --soak
QUOTA_MIB = 64
BAD = ("refuse.obj", "exit.obj", "missing.obj", "nonsense.obj", "memory.obj")


def folder_bytes(path):
    return sum(os.path.getsize(os.path.join(place, name)) for place, _, names in os.walk(path) for name in names)


class Watch:
    """What the server uses, looked at every few seconds."""

    def __init__(self, server):
        self.server, self.begun = server, time.monotonic()
        self.samples = []  # (seconds, memory, bytes of both WAL files, of the databases, of the uploads)
        self.descriptors = []  # those of the databases, and all others, at quiet moments

    def look(self):
        data = self.server.data
        size = lambda name: os.path.getsize(f"{data}/{name}") if os.path.exists(f"{data}/{name}") else 0
        self.samples.append((time.monotonic() - self.begun, self.server.memory(), max(size("sheetform.db-wal"), size("blobs.db-wal")),
                             size("sheetform.db") + size("blobs.db"), self.uploads()))

    def uploads(self):
        try:
            return folder_bytes(self.server.data + "/blobs/in")
        except OSError:  # a file went while it was looked at
            return self.samples[-1][4] if self.samples else 0

    def count_descriptors(self):
        """When nobody asks anything, and all connections have ended. The store keeps up to 16 connections to each database."""
        self.server.until("all connections are closed", lambda: b"sheetform_event_streams 0\n" in
                          self.server.request("GET", "/metrics", check=False).body)
        time.sleep(3)
        folder = f"/proc/{self.server.process.pid}/fd"
        names = [os.readlink(f"{folder}/{fd}") for fd in os.listdir(folder)]
        stores = sum(".db" in os.path.basename(name) for name in names)
        self.descriptors.append((stores, len(names) - stores))

    def slope(self, column):
        """Units an hour, by least squares, of all after the first third."""
        rows = self.samples[len(self.samples) // 3:]
        times, values = [r[0] / 3600 for r in rows], [r[column] for r in rows]
        middle, mean = sum(times) / len(times), sum(values) / len(values)
        return sum((t - middle) * (v - mean) for t, v in zip(times, values)) / sum((t - middle) ** 2 for t in times)


class Visitor:
    """One of those who use the server all the time, each in a way of their own."""

    def __init__(self, server, seed, until):
        self.server, self.rng, self.until, self.mine, self.done = server, random.Random(seed), until, [], 0

    def ask(self, method, path, body=None, headers=None, allowed=(200, 404)):
        answer = self.server.request(method, path, body, headers, check=False)
        expect(answer.status in allowed, f"{method} {path}: {answer.status} {answer.body[:200]}")
        self.done += 1
        return answer

    def send(self):
        name = self.rng.choice(BAD) if self.rng.random() < 0.1 else f"work-{self.rng.choice((10, 50, 400))}.obj"
        mesh = unique_mesh() + b"# " + self.rng.randbytes(self.rng.choice((100, 50_000, 400_000))).hex().encode() + b"\n"
        headers = self.rng.choice(({}, {"Prefer": "wait=2"}, {"Idempotency-Key": f"{self.rng.random()}"}))
        path = f"{EXECUTION}?filename={name}"
        job = self.ask("POST", path, mesh, headers, (201,)).json()["jobID"]
        if "Idempotency-Key" in headers:
            expect(self.ask("POST", path, mesh, headers, (201,)).json()["jobID"] == job, "a key made two jobs")
        self.mine = self.mine[-30:] + [job]

    def turn(self):
        job = f"/api/v1/jobs/{self.rng.choice(self.mine)}" if self.mine else "/api/v1/jobs"
        kind = self.rng.randrange(8)
        if kind < 2 or not self.mine:
            self.send()
        elif kind == 2:
            self.ask("DELETE", job)
        elif kind == 3:
            self.ask("GET", job + "/events", allowed=(200, 204, 404))
        elif kind == 4:
            self.ask("GET", job + "/results?f=zip", allowed=(200, 404, 422, 500))
        elif kind == 5:
            self.ask("GET", job + "/results/big.bin", headers={"Range": "bytes=1000-5000"}, allowed=(206, 404, 422, 500))
        elif kind == 6:
            self.ask("GET", job + "/input")
        else:
            self.ask("GET", "/api/v1/jobs?limit=100")
            self.ask("GET", job)

    def run(self):
        while time.monotonic() < self.until:
            self.turn()
            time.sleep(self.rng.uniform(0.1, 0.5))
        return self.done


def visit(server, watch, seconds, rng):
    """Six visitors for so long; how many requests they made."""
    until, seeds = time.monotonic() + seconds, [rng.random() for _ in range(6)]
    done, counts = threading.Event(), []

    def look():
        while not done.wait(5):
            watch.look()
    watcher = threading.Thread(target=look)
    watcher.start()
    try:
        counts += in_threads(len(seeds), lambda i: Visitor(server, seeds[i], until).run())
    finally:
        done.set()
        watcher.join()
    return sum(counts)


def fill_caches(server):
    """Gives the server a history, and has it read by many at once: SQLite keeps 2 MiB of it for each of its connections, which
    would look like a leak until it is there."""
    server.stop()
    subprocess.run([STORE_LOAD, server.data, "2000", "0", "0"], check=True)
    server.start()

    def leaf_through(i):
        path = "/api/v1/jobs?limit=500"
        while path:
            links = server.request("GET", path, check=False).json()["links"]
            path = next((link["href"] for link in links if link["rel"] == "next"), None)
    in_threads(12, leaf_through)


def stored(server):
    return int(re.search(rb"\nsheetform_stored_bytes (\d+)", server.request("GET", "/metrics", check=False).body).group(1))


@trial("T20", "a quarter of an hour or more of everything: memory, descriptors, logs of changes and store stay as they are")
def soak(figures, long, rng):
    if not long:
        raise Skip("the long form alone has the time")
    if not STORE_LOAD:
        raise Skip("STORE_LOAD does not name the program that fills a store")
    with Server("--slots", "2", "--job-memory", "128", "--quota", str(QUOTA_MIB), "--quiet") as server:
        fill_caches(server)
        watch, requests = Watch(server), 0
        for _ in range(3):
            requests += visit(server, watch, MINUTES * 20, rng)
            until_idle(server)
            watch.count_descriptors()
        hours = watch.samples[-1][0] / 3600
        figures.put(minutes=hours * 60, requests=requests, jobs_left=len(server.request("GET", "/api/v1/jobs?limit=10000", check=False).json()["jobs"]))
        figures.put(memory_mib=watch.samples[-1][1] / 2**20, memory_median_mib=percentile([s[1] for s in watch.samples], 0.5) / 2**20)
        sixth = max(1, len(watch.samples) // 6)
        medians = [percentile([s[1] for s in watch.samples[k:k + sixth]], 0.5) / 2**20 for k in range(0, len(watch.samples), sixth)]
        figures.put(memory_of_each_sixth_mib=str([round(m, 1) for m in medians]))
        slope = watch.slope(1) / 2**20
        figures.put(memory_mib_per_hour=slope)
        # One MiB an hour, and the caches of further connections (two descriptors, 2 MiB each); a short time tells less, for
        # what the allocator keeps comes and goes.
        caches = watch.descriptors[-1][0] - watch.descriptors[0][0]
        figures.bar("memory_growth_mib", slope * hours, most=2 + hours + caches)
        figures.put(descriptors_of_databases_and_others=str(watch.descriptors))
        figures.bar("descriptors_more", watch.descriptors[-1][1] - watch.descriptors[0][1], most=0)
        figures.bar("descriptors_of_databases", watch.descriptors[-1][0], most=2 * 3 * 17)
        figures.bar("wal_worst_mib", max(s[2] for s in watch.samples) / 2**20, most=64)
        # The oldest jobs have no content, and go one by one.
        figures.bar("uploads_worst_mib", max(s[4] for s in watch.samples) / 2**20, most=QUOTA_MIB + 32)
        figures.put(databases_first_mib=watch.samples[len(watch.samples) // 3][3] / 2**20)
        figures.bar("databases_last_mib", watch.samples[-1][3] / 2**20, most=QUOTA_MIB + 16)
        server.until("the quota is kept", lambda: stored(server) <= QUOTA_MIB << 20, 300)
        figures.put(stored_mib=stored(server) / 2**20)
        for job in server.request("GET", "/api/v1/jobs?status=successful&limit=20", check=False).json()["jobs"]:
            expect(verify_results(server, job["jobID"]) == 3, "a result that was kept is not complete")
        server.stop()
        integrity(server.data)
        expect(not os.listdir(server.data + "/spool"), "unfinished uploads are left")
