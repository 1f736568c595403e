"""Supervision: every way in which a job's process can go wrong, cancel, limits, the queue."""
import contextlib
import os
import random
import re
import signal
import tempfile
import threading
import time
import unittest

from harness import EXECUTION, Server, ServerCase, WorkerRun, arc, main, unique_mesh

MISBEHAVIOUR = [  # way, kind of problem, starts
    ("memory", "memory-limit", 1),
    ("abort", "worker-crashed", 3),
    ("refuse", "unsupported-mesh", 1),
    ("nothing", "algorithm-failed", 1),
    ("exit", "algorithm-failed", 1),
    ("missing", "algorithm-failed", 1),
    ("link", "algorithm-failed", 1),
    ("twice", "algorithm-failed", 1),
    ("none", "algorithm-failed", 1),
    ("flood", "algorithm-failed", 1),
    ("fork", "algorithm-failed", 1),
    ("long-line", "algorithm-failed", 1),
    ("segv", "worker-crashed", 3),
    ("kill", "memory-limit", 3),
    ("spin", "time-limit", 1),
    ("deaf", "time-limit", 1),
]


class Misbehaviour(ServerCase):
    options = ("--slots", "8", "--job-seconds", "8", "--job-memory", "128")

    def test_every_way_is_told_apart_and_harms_nobody(self):
        pid = self.server.process.pid
        jobs = [(way, slug, starts, self.server.submit(name=f"{way}.obj")["jobID"]) for way, slug, starts in MISBEHAVIOUR]
        good = [self.server.submit()["jobID"] for _ in range(4)]
        for way, slug, starts, job_id in jobs:
            with self.subTest(way):
                job = self.server.wait(job_id)
                self.assertEqual(job["status"], "failed", job)
                self.assertTrue(job["exception"]["type"].endswith(slug), job["exception"])
                self.assertTrue(job["exception"]["detail"] and job["exception"]["fix"], job["exception"])
                self.assertEqual(job["attempt"], starts)
                self.assertNotIn("report", job)
        for job_id in good:
            self.assertEqual(self.server.wait(job_id)["status"], "successful")
        self.assertEqual(self.server.process.pid, pid)
        self.server.until_tidy()

    def test_crash_says_signal_and_stage(self):
        job = self.server.wait(self.server.submit(name="segv.obj")["jobID"])
        self.assertIn("signal 11", job["exception"]["detail"])
        self.assertIn("stage trace", job["exception"]["detail"])

    def test_a_silent_process_costs_the_server_nothing(self):
        job_id = self.server.submit(name="silent.obj")["jobID"]
        self.server.until("it falls silent", lambda: self.server.job(job_id)["progress"] >= 50)
        before = self.server.processor_seconds()
        time.sleep(1)
        self.assertLess(self.server.processor_seconds() - before, 0.3)
        self.assertEqual(self.server.wait(job_id)["status"], "failed")

    def test_nonsense_is_ignored(self):
        job = self.server.wait(self.server.submit(name="nonsense.obj")["jobID"])
        self.assertEqual(job["status"], "successful")

    def test_a_reader_that_dies_is_no_servers_death(self):
        answer = self.server.request("POST", f"{EXECUTION}?filename=inspect-segv.obj", unique_mesh())
        self.assert_problem(answer, 422, "unreadable-mesh")

    def nicer_child(self):
        """The child that has given way, and by how much; a child begins with the server's own niceness."""
        own, found = os.getpriority(os.PRIO_PROCESS, self.server.process.pid), {}

        def looked():
            for pid in self.server.children():
                with contextlib.suppress(ProcessLookupError):  # has ended meanwhile
                    found[pid] = os.getpriority(os.PRIO_PROCESS, pid) - own
            return any(found.values())
        self.server.until("a child gives way", looked)
        return next((pid, more) for pid, more in found.items() if more)

    def test_who_is_waited_for_comes_before_the_jobs(self):
        answers = []
        thread = threading.Thread(target=lambda: answers.append(
            self.server.request("POST", f"{EXECUTION}?filename=inspect-spin.obj", unique_mesh())))
        thread.start()
        pid, nice = self.nicer_child()
        os.kill(pid, signal.SIGKILL)
        thread.join()
        self.assertEqual(nice, min(5, 19 - os.nice(0)))
        self.assertEqual(answers[0].status, 422)
        job = self.server.submit(name="work-20000.obj")["jobID"]
        self.server.wait(job, until=("running",))
        self.assertEqual(self.nicer_child()[1], min(10, 19 - os.nice(0)))  # 19 is as nice as one can be
        self.server.request("DELETE", f"/api/v1/jobs/{job}")

    def test_progress_comes_in_order(self):
        job_id = self.server.submit(name="work-3000.obj")["jobID"]
        seen = []
        while True:
            job = self.server.job(job_id)
            if job["status"] == "successful":
                break
            if job["status"] == "running":
                seen.append(job["progress"])
            time.sleep(0.02)
        self.assertEqual(seen, sorted(seen))
        self.assertGreater(len(set(seen)), 8)
        self.assertEqual(job["progress"], 100)


class TheRealProcess(unittest.TestCase):
    """The job's own process, without a server."""

    def test_a_result_that_is_too_large_is_told_at_once(self):
        with tempfile.TemporaryDirectory() as folder:
            run = WorkerRun("decompose", arc(), name="arc.obj", folder=folder, fileBytes=1000)
        self.assertEqual((run.status, run.slug()), (65, "limit-exceeded"), run.told)
        self.assertIn("1000 bytes", run.problem()["detail"])
        self.assertTrue(run.problem()["where"] and run.problem()["fix"])

    def test_a_result_that_fits_is_made(self):
        with tempfile.TemporaryDirectory() as folder:
            run = WorkerRun("decompose", arc(), name="arc.obj", folder=folder)
            self.assertIn("layout.svg", os.listdir(folder))
        self.assertEqual((run.status, run.problem()), (0, None))


class Cancel(ServerCase):
    options = ("--slots", "2")

    def test_cancel_at_random_moments(self):
        rng = random.Random(3)
        for i in range(15):
            name = "deaf.obj" if i % 5 == 0 else "work-800.obj"
            job_id = self.server.submit(name=name)["jobID"]
            time.sleep(rng.random() * 0.9)
            answer = self.server.request("DELETE", f"/api/v1/jobs/{job_id}")
            self.assertEqual(answer.status, 200)
            self.server.until("its process is gone", lambda: not self.server.children())
            job = self.server.get(f"/api/v1/jobs/{job_id}")
            if job.status == 200:  # else it had ended before, and was removed
                self.assertEqual(job.json()["status"], "dismissed")
                self.assertEqual(self.server.get(f"/api/v1/jobs/{job_id}/results").status, 404)
        self.server.until_tidy()

    def test_cancel_storm(self):
        ids = [self.server.submit(name="work-300.obj")["jobID"] for _ in range(30)]
        threads = [threading.Thread(target=self.server.request, args=("DELETE", f"/api/v1/jobs/{i}")) for i in ids]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        # 404: had ended already, and was removed instead.
        self.assertLessEqual({self.server.job(i)["status"] for i in ids}, {"dismissed", 404})
        self.assertEqual(self.server.wait(self.server.submit()["jobID"])["status"], "successful")


class Queue(ServerCase):
    options = ("--slots", "1", "--queue", "3")

    def test_full_queue_is_told(self):
        running = self.server.submit(name="work-60000.obj")["jobID"]
        self.server.wait(running, until=("running",))
        waiting = [self.server.submit(name="work-60000.obj") for _ in range(3)]
        self.assertEqual([self.server.job(j["jobID"])["queuePosition"] for j in waiting], [1, 2, 3])
        answer = self.server.request("POST", EXECUTION, unique_mesh())
        self.assert_problem(answer, 503, "queue-full")
        self.assertTrue(answer.headers["Retry-After"])
        for job in waiting:
            self.server.request("DELETE", f"/api/v1/jobs/{job['jobID']}")
        self.server.request("DELETE", f"/api/v1/jobs/{running}")
        self.assertEqual(self.server.wait(self.server.submit()["jobID"])["status"], "successful")


class Idempotency(ServerCase):
    def test_parallel_requests_with_one_key_make_one_job(self):
        mesh, answers = unique_mesh(), []
        def send():
            answers.append(self.server.request("POST", EXECUTION, mesh, {"Idempotency-Key": "parallel"}))
        threads = [threading.Thread(target=send) for _ in range(40)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual(len({a.json()["jobID"] for a in answers if a.status == 201}), 1)
        self.assertLessEqual({a.status for a in answers}, {201, 409})
        self.assertEqual(sum(a.status == 201 and not a.headers["Idempotency-Replayed"] for a in answers), 1)


class Quota(ServerCase):
    options = ("--slots", "1", "--quota", "2")

    def test_the_oldest_go_as_soon_as_there_is_too_much(self):
        stored = lambda: int(re.search(rb"\nsheetform_stored_bytes (\d+)", self.server.get("/metrics").body).group(1))
        jobs, meshes = [], [unique_mesh() + b"# " + os.urandom(300_000).hex().encode() + b"\n" for _ in range(4)]
        for mesh in meshes:
            jobs.append(self.server.submit(mesh)["jobID"])
            self.server.wait(jobs[-1])
        self.server.until("the quota is kept", lambda: stored() <= 2 << 20)
        kept = [self.server.get(f"/api/v1/jobs/{job}").status for job in jobs]
        self.assertEqual((kept[0], kept[-1]), (404, 200))
        self.assertEqual(kept, sorted(kept, reverse=True))
        self.assertEqual(self.server.get(f"/api/v1/jobs/{jobs[-1]}/input").body, meshes[-1])
        self.assertEqual(self.server.get(f"/api/v1/jobs/{jobs[-1]}/results/big.bin").body[-3:], b"end")
        files = lambda: sum(len(names) for _, _, names in os.walk(self.server.data + "/blobs/in"))
        self.server.until("the uploads have gone with their jobs", lambda: files() == kept.count(200))


class DiskFull(ServerCase):
    options = ("--min-free", "1000000000")

    def test_uploads_are_refused_and_reading_goes_on(self):
        self.assert_problem(self.server.request("POST", EXECUTION, unique_mesh()), 507, "disk-full")
        self.assertEqual(self.server.get("/api/v1/jobs").status, 200)
        self.assertEqual(self.server.get("/healthz").status, 200)
        self.assertEqual(self.server.get("/readyz").status, 503)
        self.assertEqual(os.listdir(os.path.join(self.server.data, "spool")), [])


if __name__ == "__main__":
    main()
