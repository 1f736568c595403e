"""Sudden ends: kill -9, failing syncs, a full disk, a clock that jumps."""
import hashlib
import http.client
import os
import random
import signal
import subprocess
import threading
import time

from trials import (EXECUTION, STORE_LOAD, FaultyServer, Server, Skip, all_jobs, expect, fill_queue, in_threads, integrity, percentile,
                    trial, unique_mesh, until_idle, verify_results)


LONG_KILLS = 2000  # reliability.py --kills
LONG_SERVERS = 4   # at the same time, each with its own folder: most of the time they wait for their disk


class Submitters:
    """Threads that send jobs as long as they may, and remember what was acknowledged."""

    def __init__(self, server, count, pause):
        self.server, self.pause = server, pause
        self.acknowledged, self.refused = {}, 0
        self.stop = threading.Event()
        self.threads = [threading.Thread(target=self.run) for _ in range(count)]

    def run(self):
        while not self.stop.wait(self.pause):
            mesh = unique_mesh()
            try:
                answer = self.server.request("POST", f"{EXECUTION}?filename=work-30.obj", mesh, timeout=20, check=False)
            except Exception:
                continue  # the server is down just now
            if answer.status == 201:
                self.acknowledged[answer.json()["jobID"]] = hashlib.sha256(mesh).hexdigest()
            else:
                self.refused += 1

    def wait_for_one(self, seconds):
        """Until another job is acknowledged, at most so long."""
        count, deadline = len(self.acknowledged), time.monotonic() + seconds
        while len(self.acknowledged) == count and time.monotonic() < deadline:
            time.sleep(0.005)

    def __enter__(self):
        for t in self.threads:
            t.start()
        return self

    def __exit__(self, *unused):
        self.stop.set()
        for t in self.threads:
            t.join()


def verify_acknowledged(server, acknowledged):
    """P1 to P4 of every acknowledged job; how many there were."""
    until_idle(server, 300 + len(acknowledged))
    jobs = all_jobs(server)
    lost = [i for i in acknowledged if i not in jobs]
    expect(not lost, f"{len(lost)} acknowledged jobs are lost: {lost[:3]}")
    for job_id, digest in acknowledged.items():
        job = jobs[job_id]
        expect(job["status"] == "successful", f"{job_id} is {job['status']}: {job.get('exception')}")
        expect(job["inputs"]["mesh"]["sha256"] == digest, f"{job_id} has another mesh")
        body = server.request("GET", f"/api/v1/jobs/{job_id}/input", check=False).body
        expect(hashlib.sha256(body).hexdigest() == digest, f"the upload of {job_id} is damaged")
        expect(verify_results(server, job_id) == 3, f"the result of {job_id} is not complete")
    return {"acknowledged": len(acknowledged), "lost": 0, "jobs": len(jobs),
            "unacknowledged": len(jobs) - len(acknowledged),
            "started_again": sum(job["attempt"] - 1 for job in jobs.values())}


def kill_one_server(kills, pause, rng):
    """Kills a server again and again; what was verified, and the seconds that each start took."""
    ready = []
    with Server("--slots", "2", "--quiet") as server:
        with Submitters(server, 4, pause) as submitters:
            for _ in range(kills):
                if rng.random() < 0.7:  # on a slow machine a server would else be killed before it can do anything
                    submitters.wait_for_one(5)
                time.sleep(rng.uniform(0.02, 0.4))
                server.stop(signal.SIGKILL)
                begun = time.monotonic()
                server.start()
                ready.append(time.monotonic() - begun)
        expect(submitters.acknowledged, "the server acknowledged nothing")
        verified = verify_acknowledged(server, submitters.acknowledged)
        server.stop()
        integrity(server.data)
    return verified, ready


@trial("T1", "kill -9 at random moments: nothing acknowledged is lost")
def kill_loop(figures, long, rng):
    kills, servers = (LONG_KILLS, LONG_SERVERS) if long else (10, 1)
    seeds = [random.Random(rng.random()) for _ in range(servers)]
    told = in_threads(servers, lambda i: kill_one_server(kills // servers, 0.2 if long else 0.01, seeds[i]))
    ready = sorted(seconds for _, list_of_one in told for seconds in list_of_one)
    figures.put(kills=len(ready), servers=servers, ready_median=percentile(ready, 0.5), ready_worst=ready[-1])
    figures.put(**{name: sum(verified[name] for verified, _ in told) for name in told[0][0]})


def forget_pages(folder):
    """Has the system read the files there from the disk again."""
    for place, _, names in os.walk(folder):
        for name in names:
            file = os.open(os.path.join(place, name), os.O_RDONLY)
            os.fsync(file)  # only what is written can be forgotten
            os.posix_fadvise(file, 0, 0, os.POSIX_FADV_DONTNEED)
            os.close(file)


@trial("T2", "10,000 jobs in the queue and a gigabyte of results: ready, and the running job running again, soon after any end")
def restarts(figures, long, rng):
    if not STORE_LOAD:
        raise Skip("STORE_LOAD does not name the program that fills a store")
    queued, results = (10000, 1024) if long else (80, 16)
    with Server("--slots", "1", "--drain", "0", "--quiet") as server:
        server.stop()
        subprocess.run([STORE_LOAD, server.data, "0", "0", "0", str(results)], check=True)
        server.start()
        running = server.submit(name="work-800000.obj")["jobID"]
        server.wait(running, until=("running",))
        fill_queue(server, queued, 8)
        for end, signal_number in (("stop", signal.SIGTERM), ("kill", signal.SIGKILL)):
            for pages in ("cached", "forgotten"):
                server.stop(signal_number)
                if pages == "forgotten":
                    forget_pages(server.data)
                begun = time.monotonic()
                server.start()
                expect(server.request("GET", "/readyz", check=False).status == 200, "it serves, but is not ready")
                figures.bar(f"ready_after_{end}_{pages}_seconds", time.monotonic() - begun, most=2)
                server.wait(running, until=("running",))
                figures.bar(f"running_after_{end}_{pages}_seconds", time.monotonic() - begun, most=2)
        jobs = all_jobs(server)
        waiting = [job for job in jobs.values() if job["status"] == "accepted"]
        expect(len(waiting) == queued and len(jobs) == queued + results + 1, f"of {queued} jobs {len(waiting)} wait")
        done = [i for i, job in jobs.items() if job["status"] == "successful"]
        for job_id in rng.sample(done, min(20, results)):
            expect(verify_results(server, job_id) == 1, "a result is not complete")
        figures.put(queued=queued, results_mib=os.path.getsize(server.data + "/blobs.db") / 2**20)


def session(server, count):
    """Sends jobs until the server refuses or dies; what was acknowledged."""
    acknowledged = {}
    for _ in range(count):
        mesh = unique_mesh()
        try:
            answer = server.request("POST", f"{EXECUTION}?filename=work-10.obj", mesh, timeout=20, check=False)
            if answer.status == 201:
                acknowledged[answer.json()["jobID"]] = hashlib.sha256(mesh).hexdigest()
            else:
                expect(answer.status in (500, 503, 507), f"a failing disk is told by {answer.status}")
        except (OSError, http.client.HTTPException):
            break
    return acknowledged


def with_a_fault(server, uploads=4):
    """A session over which the disk fails: what was acknowledged, and the exit status (None: the server lives on)."""
    acknowledged = {}
    try:
        server.find_port()
        acknowledged = session(server, uploads)
        active = lambda: server.request("GET", "/api/v1/jobs?status=accepted,running&limit=1", check=False).json()["jobs"]
        server.until("the jobs end, or the fault comes", lambda: server.fired() or not active(), 60)
    except (AssertionError, OSError, ValueError, http.client.HTTPException):
        pass  # it died while it was being asked
    return acknowledged, end_of(server, 5)


def end_of(server, seconds):
    """The exit status of a server that a fault has struck; None when it does not end within so long."""
    deadline = time.monotonic() + seconds
    while server.fired() and server.process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    return server.process.poll()


@trial("T4", "the N-th sync fails: the process ends with status 74, nothing acknowledged is lost")
def failing_syncs(figures, long, rng):
    ended, lived_on, total, number = {}, [], 0, 0
    for number in range(1, 1000) if long else sorted(rng.sample(range(1, 40), 6)):
        with FaultyServer("--slots", "1", "--quiet", sync=number, wait=False) as server:
            acknowledged, status = with_a_fault(server)
            fired = server.fired()
            if status is not None:
                expect(fired and status == 74, f"the status is {status}, and sync {number} failed: {fired}")
                ended[status] = ended.get(status, 0) + 1
            elif fired:
                lived_on.append(number)  # SQLite does without some syncs of folders; nothing may be lost by it
            server.stop(signal.SIGKILL)
            server.healthy()
            server.start()
            verify_acknowledged(server, acknowledged)
            server.stop()
            integrity(server.data)
            total += len(acknowledged)
        if long and not fired:
            break
    expect(ended.get(74, 0) > 0, f"no failed sync ended the server, it went on after those of {lived_on}")
    figures.put(syncs_tried=number, ended=str(ended), lived_on=str(lived_on), acknowledged=total)


HOUR = 3600


@trial("T19", "the clock jumps an hour either way: nothing runs twice, stays behind or runs out of time")
def clock_jumps(figures, long, rng):
    with FaultyServer("--slots", "2", "--job-seconds", "1000", "--quiet") as server:
        silent = server.submit(name="deaf.obj")["jobID"]  # by the clock its time would be up, and it says nothing
        server.wait(silent, until=("running",))
        jobs = []
        for step in ([HOUR, -HOUR, 0, 2 * HOUR, -24 * HOUR] if long else [-HOUR, HOUR]):
            running = server.submit(name="work-2000.obj")["jobID"]
            jobs += [running, server.submit()["jobID"]]
            server.wait(running, until=("running",))
            server.clock(step)
            jobs.append(server.submit()["jobID"])
            for job_id in jobs:
                expect(server.wait(job_id)["status"] == "successful", "a job did not end")
        attempts = [server.job(i)["attempt"] for i in jobs]
        expect(set(attempts) == {1}, f"jobs ran again: {attempts}")
        job = server.job(silent)
        expect((job["status"], job["attempt"]) == ("running", 1), f"the clock ended a job: {job}")
        figures.put(jobs=len(jobs))


def after_housekeeping(server, step):
    """Sets the clock, starts the server anew and waits until its housekeeping has been: until a job of two days ago is gone."""
    server.clock(step - 48 * HOUR)
    old = server.wait(server.submit()["jobID"])["jobID"]
    server.clock(step)
    server.restart()
    server.until("the housekeeping", lambda: server.request("GET", f"/api/v1/jobs/{old}", check=False).status == 404)


@trial("T19r", "the clock jumps: nothing expires before its day is over, and then it does")
def clock_and_retention(figures, long, rng):
    with FaultyServer("--slots", "1", "--keep-days", "1", "--quiet") as server:
        mesh, key = unique_mesh(), {"Idempotency-Key": "of-the-day"}
        send = lambda: server.submit(mesh, headers=key)["jobID"]
        kept = [server.wait(send())["jobID"], server.submit()["jobID"]]
        server.wait(kept[1])
        kept.append(server.submit(name="deaf.obj")["jobID"])
        server.request("DELETE", f"/api/v1/jobs/{kept[2]}", check=False)
        status = lambda: [server.request("GET", f"/api/v1/jobs/{i}", check=False).status for i in kept]
        steps = [HOUR, -HOUR, 0, HOUR, 23.9 * HOUR] if long else [HOUR, -HOUR]
        for step in steps:
            after_housekeeping(server, step)
            expect(status() == [200] * 3, f"by a step to {step / HOUR} h jobs are gone: {status()}")
            expect(verify_results(server, kept[0]) == 3, "a result is gone")
            expect(send() == kept[0], "the key of a request is forgotten")
        after_housekeeping(server, 24.1 * HOUR)
        expect(status() == [404] * 3, f"jobs outlive their day: {status()}")
        expect(send() != kept[0], "the key of a request outlives its day")
        figures.put(steps_hours=str([step / HOUR for step in steps]), expired_early=0)
