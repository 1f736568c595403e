"""What goes on over time: draining with downloads in flight, event streams over restarts, repeated requests, ranges."""
import hashlib
import json
import signal
import socket
import threading
import time

from trials import EXECUTION, Server, expect, in_threads, latencies, percentile, trial, unique_mesh


def stream(server, path, last_id=None, most_seconds=120):
    """Everything that an event stream sends until it ends: [(id or None, event, data)]."""
    head = f"GET {path} HTTP/1.1\r\nHost: localhost\r\n" + (f"Last-Event-ID: {last_id}\r\n" if last_id else "") + "\r\n"
    data = b""
    try:
        with socket.create_connection(("127.0.0.1", server.port), timeout=most_seconds) as s:
            s.sendall(head.encode())
            while piece := s.recv(65536):
                data += piece
    except OSError:
        pass  # the server was killed
    events = []
    for block in data.decode().split("\r\n\r\n", 1)[-1].split("\n\n")[:-1]:
        fields = dict(line.split(": ", 1) for line in block.splitlines() if ": " in line and not line.startswith(":"))
        if "event" in fields:
            events.append((fields.get("id"), fields["event"], json.loads(fields["data"])))
    return events


@trial("T14", "drain with running jobs, downloads and streams: all complete, exit status 0, no attempt counted")
def drain(figures, long, rng):
    downloads, streams = (20, 50) if long else (6, 10)
    with Server("--slots", "4", "--drain", "20", "--quiet") as server:
        done = server.wait(server.submit()["jobID"])["jobID"]
        running = [server.submit(name="work-3000.obj")["jobID"] for _ in range(4)]
        waiting = server.submit(name="work-3000.obj")["jobID"]
        for job_id in running:
            server.wait(job_id, until=("running",))
        began = threading.Barrier(downloads + 1)

        def download():
            s = socket.socket()
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8192)
            s.settimeout(60)
            s.connect(("127.0.0.1", server.port))
            s.sendall(f"GET /api/v1/jobs/{done}/results/big.bin HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
            received = s.recv(4096)
            began.wait()
            while piece := s.recv(20000):
                received += piece
                time.sleep(0.02)
            return received.split(b"\r\n\r\n", 1)[1] == b"x" * 700000 + b"end"
        results = []
        threads = [threading.Thread(target=lambda: results.append(download())) for _ in range(downloads)]
        told = []
        threads += [threading.Thread(target=lambda: told.append(stream(server, "/api/v1/events"))) for _ in range(streams)]
        for t in threads:
            t.start()
        began.wait()
        server.until_streams(streams)
        begun = time.monotonic()
        expect(server.stop(signal.SIGTERM) == 0, "the exit status is not 0")
        figures.bar("seconds", time.monotonic() - begun, most=22)
        for t in threads:
            t.join()
        expect(results == [True] * downloads, f"{results.count(False)} downloads are not complete")
        expect(all(events and events[-1][1] == "shutdown" for events in told), "a stream was not told")
        server.start()
        for job_id in running:
            job = server.job(job_id)
            expect((job["status"], job["attempt"]) == ("successful", 1), f"a running job did not get its time: {job}")
        expect(server.wait(waiting)["attempt"] == 1, "a waiting job was started")
        figures.put(downloads=downloads, streams=streams)


@trial("T16", "event streams over kill -9: no gap, no duplicate, in order")
def replay(figures, long, rng):
    rounds, events = (50 if long else 3), 0
    with Server("--slots", "1", "--quiet") as server:
        for _ in range(rounds):
            job_id = server.submit(name="work-600.obj")["jobID"]
            path, seen, last = f"/api/v1/jobs/{job_id}/events", [], None
            cutter = threading.Timer(rng.uniform(0.1, 0.7), server.restart, [signal.SIGKILL])
            cutter.start()
            deadline = time.monotonic() + 300
            while time.monotonic() < deadline:
                for number, _, data in stream(server, path, last):
                    if number:
                        seen.append(int(number))
                        last, state = number, data["status"]
                if seen and state == "successful":
                    break
                time.sleep(0.02)
            cutter.join()
            expect(seen == list(range(1, len(seen) + 1)), f"a gap or a duplicate: {seen}")
            expect(state == "successful", f"the last event is {state}")
            again = [int(number) for number, _, _ in stream(server, path) if number]
            expect(again == seen, "another replay tells another story")
            events += len(seen)
        figures.put(rounds=rounds, events=events)


@trial("T16b", "200 event streams at once: all hear all, memory flat")
def many_streams(figures, long, rng):
    count = 190 if long else 30
    with Server("--slots", "1", "--quiet") as server:
        memory = server.memory()
        job_id = server.submit(name="work-9000.obj" if long else "work-6000.obj")["jobID"]
        told, peak, times = [], [], []
        crowd = threading.Thread(target=lambda: told.extend(
            in_threads(count, lambda i: stream(server, f"/api/v1/jobs/{job_id}/events"))))
        crowd.start()
        server.until_streams(count)
        peak.append(server.memory())
        times += latencies(server.port, "/api/v1/jobs", 200 if long else 10)
        crowd.join()
        expect(len(told) == count, "a stream could not be read")
        figures.put(beside_p50=percentile(times, 0.5))
        figures.bar("beside_p99", percentile(times, 0.99), most=0.05)
        kept = {tuple(int(number) for number, _, _ in events if number) for events in told}
        expect(len(kept) == 1, f"the streams tell {len(kept)} different stories")
        expect(all(events[-1][2]["status"] == "successful" for events in told), "a stream ended early")
        figures.bar("memory_growth_mib", (peak[0] - memory) / 2**20, most=32)
        figures.put(streams=count)


def follow(server, job_id, seconds):
    """Reads a job's stream to its end, over restarts, as an EventSource does; [number of the event] and the last state."""
    path, seen, last, state = f"/api/v1/jobs/{job_id}/events", [], None, None
    deadline = time.monotonic() + seconds
    while state not in ("successful", "failed") and time.monotonic() < deadline:
        for number, _, data in stream(server, path, last):
            if number:
                seen.append(int(number))
                last, state = number, data["status"]
        time.sleep(0.05)
    return seen, state


@trial("T16c", "200 event streams, the server is killed in the middle of the job: each goes on where it was")
def many_cut_streams(figures, long, rng):
    count = 200 if long else 40
    with Server("--slots", "1", "--quiet") as server:
        server.get("/healthz")
        memory = server.memory()
        job_id = server.submit(name="work-6000.obj")["jobID"]
        told = []
        crowd = threading.Thread(target=lambda: told.extend(in_threads(count, lambda i: follow(server, job_id, 300))))
        crowd.start()
        server.until_streams(count)
        figures.bar("memory_growth_mib", (server.memory() - memory) / 2**20, most=32)
        times = latencies(server.port, f"/api/v1/jobs/{job_id}", 300 if long else 20)
        server.until("the middle of the job", lambda: server.job(job_id)["progress"] >= 30)
        begun = time.monotonic()
        server.restart(signal.SIGKILL)
        server.until_streams(count)
        figures.put(all_back_seconds=time.monotonic() - begun)
        times += latencies(server.port, f"/api/v1/jobs/{job_id}", 300 if long else 20)
        crowd.join()
        figures.put(streams=count, beside_p50=percentile(times, 0.5))
        figures.bar("beside_p99", percentile(times, 0.99), most=0.005)
        job = server.job(job_id)
        expect((job["status"], job["attempt"]) == ("successful", 2), f"the job was not cut: {job}")
        whole = [int(number) for number, _, _ in stream(server, f"/api/v1/jobs/{job_id}/events") if number]
        expect(whole == list(range(1, len(whole) + 1)), f"the story has gaps: {whole}")
        wrong = [(seen, state) for seen, state in told if seen != whole or state != "successful"]
        expect(len(told) == count and not wrong, f"{len(wrong)} of {count} streams tell another story: {wrong[:1]}, not {whole}")
        figures.put(events_each=len(whole), gaps=0, duplicates=0)


@trial("T15", "100 requests with one key, and again after kill -9: one job")
def idempotency(figures, long, rng):
    with Server("--slots", "1", "--quiet") as server:
        for i in range(20 if long else 2):
            mesh, key = unique_mesh(), f"key-{i}"
            send = lambda _: server.request("POST", EXECUTION, mesh, {"Idempotency-Key": key}, check=False)
            answers = in_threads(100 if long else 20, send)
            expect({a.status for a in answers} <= {201, 409}, f"{ {a.status for a in answers} }")
            server.restart(signal.SIGKILL)
            answers.append(send(0))
            expect(answers[-1].status == 201, f"after the restart: {answers[-1].status}")
            expect(len({a.json()["jobID"] for a in answers if a.status == 201}) == 1, "one key made two jobs")
        figures.put(keys=i + 1)


@trial("T17", "random ranges against the whole file: byte for byte")
def ranges(figures, long, rng):
    with Server("--slots", "1", "--quiet") as server:
        path = f"/api/v1/jobs/{server.wait(server.submit()['jobID'])['jobID']}/results/big.bin"
        whole = b"x" * 700000 + b"end"
        n, count = len(whole), (3000 if long else 60)
        expect(hashlib.sha256(server.get(path).body).digest() == hashlib.sha256(whole).digest(), "the file is another one")
        for _ in range(count):
            first = rng.choice([rng.randrange(n), n - 1, n, n + 5, 0, 2**63, 2**64 + 1])
            last = rng.choice([first, rng.randrange(n), n, 2**64, 10**30, first + rng.randrange(300000)])
            answer = server.request("GET", path, headers={"Range": f"bytes={first}-{last}"}, check=False)
            if first >= 2**64:  # beyond what is counted: refused or not understood, but never a part
                expect(answer.status in (200, 416), f"{first}-{last}: {answer.status}")
            elif last < first:
                expect((answer.status, answer.body) == (200, whole), f"{first}-{last}: {answer.status}")
            elif first >= n:
                expect(answer.status == 416, f"{first}-{last}: {answer.status}")
            else:
                expect((answer.status, answer.body) == (206, whole[first:last + 1]), f"{first}-{last}: {answer.status}")
        figures.put(ranges=count)
