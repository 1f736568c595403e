"""What was acknowledged is never lost: restarts, kill -9, drain, replay of events, backup."""
import contextlib
import fcntl
import hashlib
import http.client
import json
import os
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time
import unittest

from harness import EXECUTION, PROGRAM, Server, arc, main, unique_mesh


def events_of(server, path, headers=None, last=lambda event: False, timeout=60):
    """Messages of a stream until it ends or last() holds of one: (id or None, event, data)."""
    received, current, deadline = [], {}, time.monotonic() + timeout
    with socket.create_connection(("127.0.0.1", server.port), timeout=timeout) as s:
        lines = "".join(f"{k}: {v}\r\n" for k, v in (headers or {}).items())
        s.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n{lines}\r\n".encode())
        stream = s.makefile("rb")
        status = int(stream.readline().split()[1])
        while stream.readline().strip():
            pass
        for line in stream:
            assert time.monotonic() < deadline, f"the stream goes on, without what was waited for: {received[-3:]}"
            line = line.decode().rstrip("\n")
            if line == "" and current:
                if "event" in current:
                    received.append((current.get("id"), current["event"], json.loads(current["data"])))
                    if last(received[-1]):
                        return status, received
                current = {}
            elif ": " in line:
                key, value = line.split(": ", 1)
                current[key] = value
    return status, received


class Restart(unittest.TestCase):
    def test_queued_and_running_jobs_survive_kill_9(self):
        with Server("--slots", "1") as server:
            done = server.wait(server.submit()["jobID"])
            running = server.submit(name="work-6000.obj")["jobID"]
            server.wait(running, until=("running",))
            queued = [server.submit()["jobID"] for _ in range(5)]
            gone = server.submit()["jobID"]
            server.request("DELETE", f"/api/v1/jobs/{gone}")
            begun = time.monotonic()
            server.restart(signal.SIGKILL)
            self.assertEqual(server.get("/readyz").status, 200)
            self.assertLess(time.monotonic() - begun, 20)
            self.assertEqual(server.job(gone)["status"], "dismissed")
            job = server.wait(running)
            self.assertEqual((job["status"], job["attempt"]), ("successful", 2))
            for job_id in queued:
                self.assertEqual(server.wait(job_id)["attempt"], 1)
            again = server.get(f"/api/v1/jobs/{done['jobID']}/results/big.bin")
            self.assertEqual(len(again.body), 700003)
            self.assertEqual(server.children(), [])

    def test_children_die_with_the_server(self):
        with Server("--slots", "2") as server:
            for _ in range(2):
                server.wait(server.submit(name="deaf.obj")["jobID"], until=("running",))
            server.until("both have a process", lambda: len(server.children()) == 2)  # the state comes first
            children = server.children()
            server.stop(signal.SIGKILL)
            server.until("the children are gone", lambda: not any(os.path.exists(f"/proc/{c}") for c in children))

    def test_those_who_look_at_uploads_die_with_the_server(self):
        with Server(fake=False) as server:
            nursery = server.children()
            self.assertEqual(len(nursery), 1)
            upload = threading.Thread(target=self.send_and_lose, args=(server,))
            upload.start()
            # Children of the server both, so that it learns how they end.
            server.until("the mesh is looked at", lambda: len(server.children()) == 2)
            family = server.children()
            reader = next(pid for pid in family if pid not in nursery)
            server.until("it leads a group of its own", lambda: os.getpgid(reader) == reader)
            os.kill(reader, signal.SIGSTOP)  # else it might have ended before it is looked at
            self.assertEqual(os.getpgid(nursery[0]), nursery[0])
            if subprocess.run(["unshare", "--net", "true"], stderr=subprocess.DEVNULL).returncode == 0:
                # Leaving the network takes longer than looking at a small mesh: done once, for all of them.
                ours, theirs, its = (os.readlink(f"/proc/{pid}/ns/net") for pid in (server.process.pid, nursery[0], reader))
                self.assertNotEqual(ours, theirs)
                self.assertEqual(its, theirs)
            os.kill(reader, signal.SIGCONT)
            server.stop(signal.SIGKILL)
            upload.join()
            server.until("all of them are gone", lambda: not any(os.path.exists(f"/proc/{pid}") for pid in family))

    @staticmethod
    def send_and_lose(server):
        facet = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
        mesh = b"x" * 80 + struct.pack("<I", 1_000_000) + facet * 1_000_000
        with contextlib.suppress(OSError, http.client.HTTPException):
            server.request("POST", f"{EXECUTION}?filename=large.stl", mesh, check=False)

    def test_uploads_are_looked_at_without_the_nursery_too(self):
        with Server(fake=False) as server:
            (nursery,) = server.children()
            server.submit(arc(), name="first.obj")
            os.kill(nursery, signal.SIGKILL)
            for seed in range(1, 4):
                answer = server.submit(arc(seed=seed), name="second.obj")
                self.assertEqual(answer["inputs"]["mesh"]["vertices"], 54)
            self.assertTrue([line for line in server.log_lines() if "nursery is gone" in line["msg"]])
            bad = server.request("POST", f"{EXECUTION}?filename=bad.obj", b"v 0 0 zero\n")
            self.assertEqual((bad.status, bad.slug()), (422, "unreadable-mesh"))

    def test_as_the_first_process_of_a_container(self):
        ways = (["unshare", "--pid", "--fork", "--mount-proc", "--kill-child"],
                ["unshare", "--user", "--map-root-user", "--pid", "--fork", "--mount-proc", "--kill-child"])
        below = next((w for w in ways if subprocess.run([*w, "true"], stderr=subprocess.DEVNULL).returncode == 0), None)
        if below is None:
            self.skipTest("no namespaces here")
        for fake in (True, False):
            with Server(fake=fake, below=below) as server:
                self.assertEqual(server.wait(server.submit(arc(), name="arc.obj")["jobID"])["status"], "successful")

    def test_one_server_a_data_folder(self):
        with Server() as server:
            other = subprocess.run([PROGRAM, "serve", "--data", server.data, "--listen", "127.0.0.1:0"],
                                   stderr=subprocess.PIPE, timeout=300)
            self.assertNotEqual(other.returncode, 0)
            self.assertEqual(other.returncode, 64)
            self.assertRegex(other.stderr.splitlines()[-1], rb"^sheetform: another sheetform server uses the data folder .*; stop it")
            self.assertEqual(server.get("/healthz").status, 200)

    def test_a_lock_that_is_let_go_in_a_moment_is_waited_for(self):
        """A child that a killed server was just about to start has it until it has become another program."""
        with Server() as server:
            server.stop(signal.SIGKILL)
            with open(server.data + "/.lock") as held:
                fcntl.flock(held, fcntl.LOCK_EX)
                server.start(wait=False)
                time.sleep(1)  # it waits three seconds
                self.assertIsNone(server.process.poll())
            server.find_port()
            self.assertEqual(server.get("/healthz").status, 200)

    def test_unfinished_uploads_are_swept(self):
        with Server() as server:
            with socket.create_connection(("127.0.0.1", server.port)) as s:
                s.sendall(f"POST {EXECUTION} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\nv 0 0 0".encode())
                server.until("the upload has begun", lambda: os.listdir(server.data + "/spool"))
                self.assertEqual(len(os.listdir(server.data + "/spool")), 1)
                server.restart(signal.SIGKILL)
            self.assertEqual(os.listdir(server.data + "/spool"), [])

    def test_foreign_and_newer_databases_are_refused(self):
        for pragma in ("application_id=7; PRAGMA user_version=1", "user_version=99"):
            with tempfile.TemporaryDirectory() as data:
                server = Server(data=data)
                server.stop()
                subprocess.run(["python3", "-c", f"import sqlite3; sqlite3.connect('{data}/sheetform.db').executescript('PRAGMA {pragma};')"], check=True)
                again = subprocess.run([PROGRAM, "serve", "--data", data, "--listen", "127.0.0.1:0"], stderr=subprocess.PIPE, timeout=300)
                self.assertNotEqual(again.returncode, 0)
                self.assertIn(b"database", again.stderr.splitlines()[-1])
                os.unlink(server.log.name)


class Drain(unittest.TestCase):
    def test_running_jobs_get_their_time(self):
        with Server("--slots", "2", "--drain", "10") as server:
            job = server.submit(name="work-1000.obj")["jobID"]
            server.wait(job, until=("running",))
            self.assertEqual(server.stop(signal.SIGTERM), 0)
            server.start()
            self.assertEqual(server.job(job)["status"], "successful")
            self.assertEqual(server.job(job)["attempt"], 1)

    def test_jobs_that_do_not_end_in_time_wait_for_the_next_start(self):
        with Server("--slots", "1", "--drain", "0") as server:
            job = server.submit(name="work-1500.obj")["jobID"]
            waiting = server.submit()["jobID"]
            server.wait(job, until=("running",))
            begun = time.monotonic()
            self.assertEqual(server.stop(signal.SIGTERM), 0)
            self.assertLess(time.monotonic() - begun, 20)
            server.start()
            first, second = server.wait(job), server.wait(waiting)
            self.assertEqual((first["status"], second["status"]), ("successful", "successful"))
            self.assertLess(first["finished"], second["finished"])  # it has kept its place in the line

    def test_downloads_finish_and_streams_are_told(self):
        with Server("--slots", "1", "--drain", "10") as server:
            job = server.wait(server.submit()["jobID"])["jobID"]
            slow, sizes, streams = server.submit(name="work-4000.obj")["jobID"], [], []
            server.wait(slow, until=("running",))
            began = threading.Barrier(11)
            def download():
                with socket.create_connection(("127.0.0.1", server.port), timeout=60) as s:
                    s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8192)
                    s.sendall(f"GET /api/v1/jobs/{job}/results/big.bin HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
                    total = len(s.recv(100))
                    began.wait(60)
                    while piece := s.recv(50000):
                        total += len(piece)
                        time.sleep(0.01)
                    sizes.append(total)
            threads = [threading.Thread(target=download) for _ in range(10)]
            threads += [threading.Thread(target=lambda: streams.append(events_of(server, "/api/v1/events"))) for _ in range(10)]
            for t in threads:
                t.start()
            began.wait(60)
            server.until_streams(10)
            self.assertEqual(server.stop(signal.SIGTERM), 0)
            for t in threads:
                t.join()
            self.assertEqual((len(sizes), len(streams)), (10, 10))
            self.assertTrue(all(s > 700003 for s in sizes), sizes)
            self.assertTrue(all(received[-1][1] == "shutdown" for _, received in streams), streams)

    def test_no_new_jobs_while_stopping(self):
        with Server("--slots", "1", "--drain", "30") as server:
            job = server.submit(name="work-8000.obj")["jobID"]
            server.wait(job, until=("running",))
            server.process.send_signal(signal.SIGTERM)
            server.until("not ready", lambda: server.request("GET", "/readyz", check=False).status == 503)
            answer = server.request("POST", EXECUTION, unique_mesh(), check=False)
            self.assertEqual((answer.status, answer.slug()), (503, "draining"))
            self.assertEqual(server.process.wait(60), 0)


class Events(unittest.TestCase):
    def test_replay_without_gap_or_duplicate(self):
        with Server("--slots", "1") as server:
            job = server.submit(name="work-3000.obj")["jobID"]
            path = f"/api/v1/jobs/{job}/events"
            first = []
            thread = threading.Thread(target=lambda: first.append(self.until_cut(server, path)))
            thread.start()
            server.until_streams(1)
            server.until("some events", lambda: server.job(job)["progress"] >= 20)
            server.restart(signal.SIGKILL)
            thread.join()
            seen = [int(i) for i, _, _ in first[0] if i]
            status, rest = events_of(server, path, {"Last-Event-ID": str(seen[-1])})
            seen += [int(i) for i, _, _ in rest if i]
            self.assertEqual(seen, list(range(1, len(seen) + 1)))
            self.assertEqual(rest[-1][2]["status"], "successful")
            self.assertEqual(events_of(server, path, {"Last-Event-ID": str(seen[-1])})[0], 204)
            self.assertEqual([int(i) for i, _, _ in events_of(server, path)[1] if i], seen)

    def until_cut(self, server, path):
        received = []
        with socket.create_connection(("127.0.0.1", server.port), timeout=60) as s:
            s.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
            data = b""
            try:
                while True:
                    piece = s.recv(65536)
                    if not piece:
                        break
                    data += piece
            except OSError:
                pass
        for block in data.decode().split("\r\n\r\n", 1)[-1].split("\n\n")[:-1]:
            fields = dict(line.split(": ", 1) for line in block.splitlines() if ": " in line and not line.startswith(":"))
            if "event" in fields:
                received.append((fields.get("id"), fields["event"], json.loads(fields["data"])))
        return received

    def test_list_stream_tells_every_change(self):
        with Server("--slots", "1") as server:
            old = server.wait(server.submit()["jobID"])["jobID"]
            got, told, job = [], set(), None

            def all_told(event):
                told.add((event[1], event[2].get("jobID"), event[2].get("status")))
                return told >= {("job", job, "successful"), ("removed", old, None)}  # in either order
            thread = threading.Thread(target=lambda: got.append(events_of(server, "/api/v1/events", last=all_told)))
            thread.start()
            server.until_streams(1)
            job = server.submit(name="work-200.obj")["jobID"]
            server.wait(job)
            server.request("DELETE", f"/api/v1/jobs/{old}")
            thread.join()
            events = got[0][1]
            self.assertEqual(events[0][1], "snapshot")
            self.assertEqual([j["jobID"] for j in events[0][2]["jobs"]], [old])
            self.assertLessEqual({e[2]["jobID"] for e in events[1:]}, {job, old})

    def test_what_runs_is_told_however_many_jobs_came_after_it(self):
        with Server("--slots", "1") as server:
            running = server.submit(name="work-60000.obj")["jobID"]
            server.wait(running, until=("running",))
            newer = [server.submit(name="work-0.obj")["jobID"] for _ in range(101)]
            jobs = [j["jobID"] for j in events_of(server, "/api/v1/events", last=lambda e: True)[1][0][2]["jobs"]]
            self.assertEqual(jobs[-1], running)
            self.assertEqual(jobs[:-1], newer[:0:-1])


class Backup(unittest.TestCase):
    def test_backup_of_a_running_server_and_restore(self):
        with Server("--slots", "2") as server, tempfile.TemporaryDirectory() as folder:
            jobs = [server.wait(server.submit()["jobID"]) for _ in range(3)]
            queued = server.submit(name="work-3000.obj")["jobID"]
            run = lambda *a: subprocess.run([PROGRAM, *a], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
            copied = run("backup", folder + "/copy", "--data", server.data)
            self.assertEqual(copied.returncode, 0, copied.stderr)
            restored = run("restore", folder + "/copy", "--data", folder + "/data")
            self.assertEqual(restored.returncode, 0, restored.stderr)
            for made in ("copy", "data"):  # as private as what they were made from
                found = [os.path.join(f, name) for f, folders, files in os.walk(f"{folder}/{made}") for name in folders + files]
                self.assertEqual([path for path in found if os.stat(path).st_mode & 0o077], [])
            again = Server("--slots", "2", data=folder + "/data")
            with again:
                for job in jobs:
                    results = again.get(f"/api/v1/jobs/{job['jobID']}/results").json()
                    for entry in results.values():
                        self.assertEqual(hashlib.sha256(again.get(entry["href"]).body).hexdigest(), entry["sha256"])
                self.assertEqual(again.wait(queued)["status"], "successful")
            self.assertEqual(run("backup", folder + "/copy", "--data", server.data).returncode, 65)

    @unittest.skipIf(os.geteuid() != 0, "only root can give files away")
    def test_a_store_that_root_restores_belongs_to_the_folders_owner(self):
        with Server() as server, tempfile.TemporaryDirectory() as folder:
            server.wait(server.submit()["jobID"])
            os.mkdir(folder + "/data", 0o770)
            os.chown(folder + "/data", 10001, 10002)
            for command in (("backup", folder + "/copy", "--data", server.data), ("restore", folder + "/copy", "--data", folder + "/data")):
                subprocess.run([PROGRAM, *command], check=True, stdout=subprocess.DEVNULL, timeout=300)
            found = [os.path.join(f, name) for f, folders, files in os.walk(folder + "/data") for name in folders + files]
            self.assertGreater(len(found), 4)
            self.assertEqual({(os.stat(path).st_uid, os.stat(path).st_gid) for path in found}, {(10001, 10002)})

    def test_damage_is_found(self):
        with Server() as server, tempfile.TemporaryDirectory() as folder:
            server.wait(server.submit()["jobID"])
            run = lambda *a: subprocess.run([PROGRAM, *a], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
            for victim in ("sheetform.db", "blobs.db", "blobs/in", "manifest.json"):
                copy = folder + "/" + victim.replace("/", "-")
                self.assertEqual(run("backup", copy, "--data", server.data).returncode, 0)
                path = os.path.join(copy, victim)
                while os.path.isdir(path):
                    path = os.path.join(path, os.listdir(path)[0])
                with open(path, "rb") as f:
                    content = bytearray(f.read())
                content[len(content) // 2] ^= 1
                os.unlink(path)  # a hard link to the upload of the running server
                with open(path, "wb") as f:
                    f.write(content)
                answer = run("restore", copy, "--data", folder + "/data")
                self.assertEqual(answer.returncode, 65, victim)
                self.assertFalse(os.path.exists(folder + "/data"))
            self.assertEqual(run("backup", folder + "/x", "--data", folder).returncode, 65)


if __name__ == "__main__":
    main()
