"""Every operation of proto/openapi.yaml is called, and every response that it describes is given and is as described.

That nothing else is answered is seen by all tests (harness.Contract); that every route is described and nothing more, by
tests/unit/server/contract_test.cpp.
"""
import concurrent.futures
import contextlib
import http.client
import json
import socket
import subprocess
import unittest

from harness import EXECUTION, PROGRAM, TRIANGLE, Answer, Contract, Server, arc, main, unique_mesh
from test_api import form

SWEEP = "/api/v1/processes/sweep/execution"
NOBODY = "01900000-0000-7000-8000-000000000000"
# Nothing that a client does brings it about: only a store that cannot be read, or an accept loop that stands still.
NOT_TO_BE_HAD = {("/healthz", "GET", "503")}


class EveryResponse(unittest.TestCase):
    seen, contract = set(), None

    @contextlib.contextmanager
    def server(self, *options, **others):
        with Server("--slots", "1", *options, **others) as server:
            if EveryResponse.contract is None:
                EveryResponse.contract = Contract(server.request("GET", "/api/v1/api", check=False).json())
            server.contract = EveryResponse.contract  # also of those that ask for a token
            yield server

    def expect(self, server, status, method, path, body=None, headers=None, check=True):
        answer = server.request(method, path, body, headers, check=check)
        self.assertEqual(answer.status, status, f"{method} {path}: {answer.body[:300]}")
        return answer

    def test_1_service_and_jobs(self):
        with self.server("--max-upload", "1") as server:
            get = lambda status, path, **headers: self.expect(server, status, "GET", path, None, {k.replace("_", "-"): v for k, v in headers.items()})
            for path in ("", "conformance", "api", "processes", "processes/decompose", "jobs", "limits"):
                get(200, "/api/v1/" + path)
            for path in ("/healthz", "/readyz", "/version", "/metrics"):
                get(200, path)
            get(400, "/api/v1/processes?limit=x")
            get(404, "/api/v1/processes/nothing")
            get(400, "/api/v1/jobs?limit=x")
            self.expect(server, 204, "DELETE", "/api/v1/session")
            self.expect(server, 401, "POST", "/api/v1/session", b'{"token": "unknown"}')
            self.wrong_uploads(server)
            failed = server.wait(server.submit(name="refuse.obj")["jobID"])["jobID"]
            done = server.wait(server.submit()["jobID"])["jobID"]
            self.jobs(server, get, done, failed)
            self.files(get, f"/api/v1/jobs/{done}/results/big.bin")
            self.files(get, f"/api/v1/jobs/{done}/input")
            self.files(get, f"/api/v1/jobs/{done}/results?f=zip")

    def wrong_uploads(self, server):
        post = lambda status, path, body, **headers: self.expect(server, status, "POST", path, body, {k.replace("_", "-"): v for k, v in headers.items()})
        post(400, EXECUTION + "?filename=%", b"x")
        post(403, EXECUTION, b"x", Origin="https://elsewhere.example.org")
        post(404, "/api/v1/processes/nothing/execution", b"x")
        post(413, EXECUTION, b"x" * (1 << 21))
        post(415, EXECUTION, b"x", Content_Type="video/mp4")
        post(422, EXECUTION + "?e_max=-1", b"x")

    def jobs(self, server, get, done, failed):
        job = f"/api/v1/jobs/{done}"
        get(304, job, If_None_Match=get(200, job).headers["ETag"])
        for path in ("", "/results", "/results/big.bin", "/exports", "/exports/pdf", "/input", "/guides", "/log", "/events"):
            get(404, f"/api/v1/jobs/{NOBODY}{path}")
        get(400, job + "/results?f=x")
        get(400, job + "/results/big.bin?inline=x")
        for path in ("/results", "/results/big.bin", "/exports", "/exports/pdf"):
            get(422, f"/api/v1/jobs/{failed}{path}")
        get(200, job + "/log")
        events = get(200, job + "/events").body
        get(204, job + "/events", Last_Event_ID=str(events.count(b"\nid: ") + events.startswith(b"id: ")))
        for action in ("retry", "finish"):
            self.expect(server, 404, "POST", f"/api/v1/jobs/{NOBODY}/{action}")
            self.expect(server, 409, "POST", f"{job}/{action}")
        self.expect(server, 200, "POST", f"/api/v1/jobs/{failed}/retry")
        self.expect(server, 404, "DELETE", f"/api/v1/jobs/{NOBODY}")
        crashed = server.wait(server.submit(name="exit.obj")["jobID"])["jobID"]
        get(500, f"/api/v1/jobs/{crashed}/exports/pdf")
        sweep = self.expect(server, 201, "POST", SWEEP + "?e_max=0.02,0.05&filename=refuse.obj", unique_mesh()).json()["jobID"]
        server.wait(sweep)
        self.expect(server, 422, "POST", f"/api/v1/jobs/{sweep}/points/0.02")
        self.expect(server, 200, "DELETE", f"/api/v1/jobs/{sweep}")

    def files(self, get, path):
        """What every download can answer."""
        tag = get(200, path).headers["ETag"]
        get(206, path, Range="bytes=0-1")
        get(304, path, If_None_Match=tag)
        get(412, path, If_Match='"another"')
        get(416, path, Range="bytes=99999999-")

    def test_2_real_results(self):
        with self.server(fake=False) as server:
            get = lambda status, path, **headers: self.expect(server, status, "GET", path, None, {k.replace("_", "-"): v for k, v in headers.items()})
            guides = {"seams": [{"points": [[1, 0, 0], [0, 1, 1]], "closed": False}]}
            body, kind = form([("mesh", "arc.obj", arc()), ("guides", "g.json", json.dumps(guides).encode())])
            done = self.expect(server, 201, "POST", EXECUTION, body, {"Content-Type": kind}).json()["jobID"]
            server.wait(done)
            get(200, f"/api/v1/jobs/{done}/guides")
            exports = f"/api/v1/jobs/{done}/exports"
            get(200, exports)
            self.files(get, exports + "/pdf")
            get(400, exports + "/pdf?kerf=x")
            get(404, exports + "/nothing")
            self.too_many_exports(server, exports)
            sweep = self.expect(server, 201, "POST", SWEEP + "?e_max=0.02,0.05&effort=draft", arc(seed=3)).json()["jobID"]
            server.wait(sweep)
            self.expect(server, 200, "POST", f"/api/v1/jobs/{sweep}/finish")
            self.expect(server, 201, "POST", f"/api/v1/jobs/{sweep}/points/0.02")
            self.expect(server, 200, "POST", f"/api/v1/jobs/{sweep}/points/0.02")
            self.expect(server, 404, "POST", f"/api/v1/jobs/{sweep}/points/0.03")

    def too_many_exports(self, server, exports):
        answers = self.at_once(80, lambda i: server.request("GET", f"{exports}/pdf?kerf={0.01 + i / 1e4:.4f}").status)
        self.assertEqual(set(answers), {200, 429})

    @staticmethod
    def at_once(count, work):
        with concurrent.futures.ThreadPoolExecutor(count) as pool:
            return list(pool.map(work, range(count)))

    def test_3_tokens(self):
        with self.server("--require-token") as server:
            made = subprocess.run([PROGRAM, "token", "add", "anna", "--data", server.data], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
            token = made.stdout.decode().strip()
            self.expect(server, 401, "POST", EXECUTION, TRIANGLE)
            server.until("the token is known", lambda: server.request("POST", "/api/v1/session", json.dumps({"token": token})).status == 204)

    def test_4_what_is_too_much(self):
        with self.server("--submits-per-minute", "2", "--queue", "1") as server:
            server.submit(name="deaf.obj")
            server.until("it runs", lambda: server.children())
            server.submit()
            self.expect(server, 429, "POST", EXECUTION, unique_mesh())
        with self.server("--queue", "1") as server:
            server.submit(name="deaf.obj")
            server.until("it runs", lambda: server.children())
            job = server.submit()["jobID"]
            self.expect(server, 503, "POST", EXECUTION, unique_mesh())
            self.too_many_streams(server, job)
        with self.server("--min-free", str(1 << 30)) as server:
            self.expect(server, 507, "POST", EXECUTION, unique_mesh())
            self.expect(server, 503, "GET", "/readyz")

    def too_many_streams(self, server, job):
        most = server.get("/api/v1/limits").json()["eventStreams"]
        with contextlib.ExitStack() as stack:
            for i in range(most):
                connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60)
                stack.callback(connection.close)
                connection.request("GET", "/api/v1/events")
                begun = connection.getresponse()
                stack.callback(begun.close)  # else the stream ends when the next one is begun
                self.contract.check("GET", "/api/v1/events", Answer(begun.status, begun.headers, b""))
                self.assertEqual(begun.status, 200)
            self.expect(server, 429, "GET", "/api/v1/events")
            self.expect(server, 429, "GET", f"/api/v1/jobs/{job}/events")

    def test_5_slow_and_doubled_requests(self):
        with self.server() as server, socket.create_connection(("127.0.0.1", server.port), timeout=60) as slow:
            head = f"POST {EXECUTION}?filename=work-3000.obj HTTP/1.1\r\nHost: localhost\r\n"
            slow.sendall((head + "Content-Length: 100000\r\n\r\nv 0 0").encode())
            for key in map(str, range(50)):
                if 409 in self.at_once(10, lambda _: server.request("POST", EXECUTION, TRIANGLE, {"Idempotency-Key": key}).status):
                    break
            response = http.client.HTTPResponse(slow)
            response.begin()
            answer = Answer(response.status, response.headers, response.read())
            self.assertEqual(answer.status, 408)
            self.contract.check("POST", EXECUTION, answer)

    def test_9_nothing_was_left_out(self):
        described = self.contract.responses()
        missing = sorted(described - self.contract.seen - NOT_TO_BE_HAD)
        self.assertEqual(missing, [], f"{len(missing)} of {len(described)} described responses were never given")
        self.assertLessEqual(NOT_TO_BE_HAD, described)
        self.assertFalse(NOT_TO_BE_HAD & self.contract.seen, "it can be had after all")


if __name__ == "__main__":
    main()
