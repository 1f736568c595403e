"""Malformed and hostile HTTP, byte for byte: each row of what the stock library gets wrong, and more. A request is
answered with the right status or the connection ends; the server lives on."""
import json
import random
import re
import socket
import threading
import time

from harness import EXECUTION, TRIANGLE, Server, ServerCase, main

OK = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
POST = b"POST " + EXECUTION.encode() + b" HTTP/1.1\r\nHost: localhost\r\n"


def head(*lines):
    return b"\r\n".join([line.encode("latin-1") if isinstance(line, str) else line for line in lines]) + b"\r\n\r\n"


def get(target="/healthz", *fields, version="HTTP/1.1", method="GET"):
    return head(f"{method} {target} {version}", "Host: localhost", *fields)


def status_of(received):
    match = re.match(rb"HTTP/1\.1 (\d{3}) ", received)
    return int(match.group(1)) if match else None


# name, bytes, status (None: the connection ends without an answer)
TABLE = [
    ("plain", OK, 200),
    ("1.0 without host", b"GET /healthz HTTP/1.0\r\n\r\n", 200),
    ("empty lines first", b"\r\n\r\n" + OK, 200),
    ("lower-case field names", head("GET /healthz HTTP/1.1", "host: localhost"), 200),
    # the request line
    ("no version", b"GET /healthz\r\nHost: localhost\r\n\r\n", 400),
    ("two spaces", head("GET  /healthz HTTP/1.1", "Host: localhost"), 400),
    ("tab between", head("GET\t/healthz\tHTTP/1.1", "Host: localhost"), 400),
    ("space at the end", head("GET /healthz HTTP/1.1 ", "Host: localhost"), 400),
    ("space in the target", head("GET /health z HTTP/1.1", "Host: localhost"), 400),
    ("version 2", get(version="HTTP/2.0"), 505),
    ("version 0.9", get(version="HTTP/0.9"), 505),
    ("version 1.10", get(version="HTTP/1.10"), 400),
    ("version lower", get(version="http/1.1"), 400),
    ("version letters", get(version="HTTP/x.y"), 400),
    ("method lower", get(method="get"), 501),
    ("method CONNECT", head("CONNECT localhost:80 HTTP/1.1", "Host: localhost"), 501),
    ("method TRACE", get(method="TRACE"), 501),
    ("method unknown", get(method="BREW"), 501),
    ("method with bracket", get(method="GE(T"), 400),
    ("method empty", b" / HTTP/1.1\r\nHost: localhost\r\n\r\n", 400),
    ("absolute form", get("http://localhost/healthz"), 400),
    ("asterisk", get("*"), 400),
    ("authority", get("localhost:8080"), 400),
    ("long path", get("/" + "a" * 600), 414),
    ("long target", get("/healthz?" + "a" * 4200), 414),
    ("8 KB path", get("/" + "a/" * 4000), 414),
    ("zero in the target", head(b"GET /health\0z HTTP/1.1", "Host: localhost"), 400),
    ("fragment", get("/healthz#x"), 400),
    ("latin-1 in the target", head(b"GET /caf\xe9 HTTP/1.1", "Host: localhost"), 400),
    ("broken escape", get("/%zz"), 400),
    ("cut escape", get("/%4"), 400),
    ("escaped zero", get("/health%00z"), 400),
    ("escaped newline", get("/healthz%0d%0aX:%201"), 400),
    ("dot segments", get("/api/../healthz"), 400),
    ("escaped dot segments", get("/api/%2e%2e/healthz"), 400),
    ("one dot", get("/./healthz"), 400),
    ("double slash", get("//healthz"), 400),
    ("backslash", get("/..\\..\\etc"), 404),
    # line ends
    ("bare LF", b"GET /healthz HTTP/1.1\nHost: localhost\n\n", None),
    ("bare LF inside", b"GET /healthz HTTP/1.1\r\nHost: localhost\nX: 1\r\n\r\n", 400),
    ("bare CR inside", b"GET /healthz HTTP/1.1\r\nHost: localhost\rX: 1\r\n\r\n", 400),
    ("folded field", head("GET /healthz HTTP/1.1", "Host: localhost", "X: a", " b"), 400),
    ("folded first field", head("GET /healthz HTTP/1.1", " Host: localhost"), 400),
    # fields
    ("no host", b"GET /healthz HTTP/1.1\r\n\r\n", 400),
    ("two hosts", head("GET /healthz HTTP/1.1", "Host: localhost", "Host: localhost"), 400),
    ("space before colon", head("GET /healthz HTTP/1.1", "Host : localhost"), 400),
    ("no colon", head("GET /healthz HTTP/1.1", "Host: localhost", "nonsense"), 400),
    ("empty name", head("GET /healthz HTTP/1.1", "Host: localhost", ": x"), 400),
    ("zero in a value", head("GET /healthz HTTP/1.1", "Host: localhost", b"X: a\0b"), 400),
    ("control in a value", head("GET /healthz HTTP/1.1", "Host: localhost", b"X: a\x01b"), 400),
    ("delete in a value", head("GET /healthz HTTP/1.1", "Host: localhost", b"X: a\x7fb"), 400),
    ("utf-8 in a value", head("GET /healthz HTTP/1.1", "Host: localhost", "X: caf\u00e9"), 200),
    ("63 more fields", head("GET /healthz HTTP/1.1", "Host: localhost", *[f"X{i}: 1" for i in range(63)]), 200),
    ("64 more fields", head("GET /healthz HTTP/1.1", "Host: localhost", *[f"X{i}: 1" for i in range(64)]), 431),
    ("17 KB of fields", head("GET /healthz HTTP/1.1", "Host: localhost", *[f"X{i}: " + "a" * 1000 for i in range(17)]), 431),
    ("one long field", head("GET /healthz HTTP/1.1", "Host: localhost", "X: " + "a" * 20000), 431),
    ("endless line", b"GET /" + b"a" * 40000, 431),
    ("escaped CR LF in a value", get("/healthz", "X-Request-Id: a%0d%0aSet-Cookie: x=1"), 200),
    ("forged address fields", get("/healthz", "REMOTE_ADDR: 10.0.0.1", "X-Forwarded-For: 10.0.0.1"), 200),
    ("connection upgrade", get("/healthz", "Connection: Upgrade", "Upgrade: websocket"), 200),
    ("accept anything coded", get("/healthz", "Accept-Encoding: br, gzip, zstd"), 200),
    # bodies
    ("get with length", get("/healthz", "Content-Length: 5") + b"abcde", 400),
    ("get with length 0", get("/healthz", "Content-Length: 0"), 200),
    ("get with chunks", get("/healthz", "Transfer-Encoding: chunked") + b"0\r\n\r\n", 400),
    ("smuggled second request", get("/healthz", "Content-Length: 45") + OK, 400),
    ("pipelined second request", OK + OK, 200),
    ("two lengths", POST + b"Content-Length: 3\r\nContent-Length: 3\r\n\r\nabc", 400),
    ("two different lengths", POST + b"Content-Length: 3\r\nContent-Length: 4\r\n\r\nabcd", 400),
    ("list of lengths", POST + b"Content-Length: 3, 3\r\n\r\nabc", 400),
    ("length with plus", POST + b"Content-Length: +3\r\n\r\nabc", 400),
    ("negative length", POST + b"Content-Length: -1\r\n\r\n", 400),
    ("hex length", POST + b"Content-Length: 0x3\r\n\r\nabc", 400),
    ("empty length", POST + b"Content-Length: \r\n\r\n", 400),
    ("length with space", POST + b"Content-Length: 1 2\r\n\r\n", 400),
    ("huge length", POST + b"Content-Length: 99999999999999999999\r\n\r\n", 400),
    ("length beyond the limit", POST + b"Content-Length: 999999999999\r\n\r\n", 413),
    ("length and chunks", POST + b"Content-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
    ("chunks twice", POST + b"Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
    ("gzip and chunks", POST + b"Transfer-Encoding: gzip, chunked\r\n\r\n0\r\n\r\n", 501),
    ("coding identity", POST + b"Transfer-Encoding: identity\r\n\r\n", 501),
    ("coding with tab", POST + b"Transfer-Encoding:\tchunked\r\n\r\n0\r\n\r\n", 201),
    ("coding xchunked", POST + b"Transfer-Encoding: xchunked\r\n\r\n", 501),
    ("chunks in 1.0", b"POST " + EXECUTION.encode() + b" HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
    ("no length at all", POST + b"\r\n", 201),
    ("chunk size -2", POST + b"Transfer-Encoding: chunked\r\n\r\n-2\r\nab\r\n0\r\n\r\n", 400),
    ("chunk size +2", POST + b"Transfer-Encoding: chunked\r\n\r\n+2\r\nab\r\n0\r\n\r\n", 400),
    ("chunk size 0x2", POST + b"Transfer-Encoding: chunked\r\n\r\n0x2\r\nab\r\n0\r\n\r\n", 400),
    ("chunk size empty", POST + b"Transfer-Encoding: chunked\r\n\r\n\r\nab\r\n0\r\n\r\n", 400),
    ("chunk size of 9 digits", POST + b"Transfer-Encoding: chunked\r\n\r\n000000002\r\nab\r\n0\r\n\r\n", 400),
    ("chunk size huge", POST + b"Transfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\nab\r\n0\r\n\r\n", 400),
    ("chunk size with space", POST + b"Transfer-Encoding: chunked\r\n\r\n2 \r\nab\r\n0\r\n\r\n", 400),
    ("chunk ends with LF", POST + b"Transfer-Encoding: chunked\r\n\r\n2\nab\r\n0\r\n\r\n", 400),
    ("chunk too short", POST + b"Transfer-Encoding: chunked\r\n\r\n5\r\nab\r\n0\r\n\r\nxyz", 400),
    ("chunk too long", POST + b"Transfer-Encoding: chunked\r\n\r\n1\r\nab\r\n0\r\n\r\n", 400),
    ("chunk with extension", POST + b"Transfer-Encoding: chunked\r\n\r\n2;a=b\r\nv \r\n0\r\n\r\n", 201),
    ("endless extension", POST + b"Transfer-Encoding: chunked\r\n\r\n2;" + b"a" * 5000 + b"\r\nab\r\n0\r\n\r\n", 400),
    ("trailers", POST + b"Transfer-Encoding: chunked\r\n\r\n2\r\nv \r\n0\r\nX: 1\r\n\r\n", 201),
    ("endless trailers", POST + b"Transfer-Encoding: chunked\r\n\r\n0\r\n" + b"X: 1\r\n" * 2000 + b"\r\n", 400),
    ("expect something else", POST + b"Expect: 200-ok\r\nContent-Length: 3\r\n\r\nabc", 400),
    ("post without route", b"POST /nothing HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000000\r\n\r\n", 404),
    ("put to a route of get", b"PUT /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000000\r\n\r\n", 405),
    ("delete with a body", b"DELETE /api/v1/session HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\n\r\nabc", 204),
    # other protocols
    ("TLS", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"\r\n\r\n", 400),
    ("HTTP/2 preface", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 505),
    ("SSH", b"SSH-2.0-OpenSSH_9.2\r\n\r\n", 400),
    ("nothing but zeros", b"\0" * 64 + b"\r\n\r\n", 400),
    # queries
    ("broken escape in the query", get("/api/v1/jobs?tag=%"), 400),
    ("control in the query", get("/api/v1/jobs?tag=%07"), 400),
    ("65 parameters", get("/api/v1/jobs?" + "&".join("a=1" for _ in range(65))), 400),
]


class Malformed(ServerCase):
    def test_table(self):
        for name, data, expected in TABLE:
            with self.subTest(name):
                received = self.server.raw(data, close_write=expected is None)
                self.assertEqual(status_of(received), expected, received[:300])
                self.assertLessEqual(len(re.findall(rb"HTTP/1\.1 [1-5]\d\d ", received)), 1, "more than one answer")
                if (expected or 0) >= 400:
                    problem = json.loads(received.split(b"\r\n\r\n", 1)[1])
                    self.assertTrue(problem["detail"] and problem["fix"], problem)
                self.assertIsNone(self.server.process.poll())
        self.assertEqual(self.server.get("/healthz").status, 200)

    def test_nothing_is_echoed_into_headers(self):
        received = self.server.raw(get("/healthz", "X-Request-Id: a%0d%0aSet-Cookie: x=1"))
        self.assertNotIn(b"Set-Cookie", received)

    def test_errors_tell_nothing_about_the_inside(self):
        for name, data, expected in TABLE:
            received = self.server.raw(data, close_write=expected is None)
            self.assertNotRegex(received, rb"EXCEPTION_WHAT|terminate|/work/|\.cpp|std::", name)

    def test_every_prefix_of_a_request(self):
        mesh = TRIANGLE
        whole = POST + b"Content-Length: %d\r\n\r\n" % len(mesh) + mesh
        for cut in range(len(whole)):
            received = self.server.raw(whole[:cut], close_write=True)
            self.assertIn(status_of(received), (None, 400), (cut, received[:200]))
        self.assertEqual(status_of(self.server.raw(whole)), 201)

    def test_mutations(self):
        rng = random.Random(7)
        seeds = [data for _, data, _ in TABLE if len(data) < 3000] + [OK, POST + b"Content-Length: 3\r\n\r\nabc"]
        for _ in range(600):
            data = bytearray(rng.choice(seeds))
            for _ in range(rng.randint(1, 6)):
                at = rng.randrange(len(data) + 1)
                kind = rng.randrange(4)
                if kind == 0:
                    data[at:at] = bytes([rng.randrange(256)])
                elif kind == 1 and at < len(data):
                    del data[at]
                elif kind == 2 and at < len(data):
                    data[at] = rng.choice([0, 10, 13, 32, 37, 58, 255, rng.randrange(256)])
                else:
                    other = rng.choice(seeds)
                    cut = rng.randrange(len(other))
                    data[at:at] = other[cut:cut + 20]
            received = self.server.raw(bytes(data), close_write=True)
            status = status_of(received)
            self.assertTrue(status is None or status < 500 or status in (501, 503, 505), (bytes(data), received[:200]))
        self.assertEqual(self.server.get("/healthz").status, 200)


class Advice(ServerCase):
    """Common slips, each with what to do instead."""

    def told(self, method, path, body=None, **headers):
        answer = self.server.request(method, path, body, headers, check=False)
        self.assertGreaterEqual(answer.status, 400)
        problem = answer.json()
        return f"{problem['detail']} / {problem['fix']} / {problem.get('where')}"

    def test_addresses(self):
        for path in ("/api/v1/jobs/", "/api/v1/processes/", "/metrics/", "/api/v1/jobs/x/events/"):
            self.assertIn("leave out the / at the end", self.told("GET", path))
        self.assertNotIn("leave out", self.told("GET", "/nothing/"))
        for method in ("POST", "PUT"):
            self.assertIn("by POST to " + EXECUTION, self.told(method, "/lamp.stl", b"x"))
        self.assertIn("512 bytes", self.told("GET", "/" + "a" * 600))
        self.assertIn("4096 bytes", self.told("GET", "/?" + "a" * 5000))
        self.assertIn("64 header fields", self.told("GET", "/", **{f"X{i}": "1" for i in range(70)}))
        self.assertIn("16384 bytes", self.told("GET", "/", X="a" * 16400))

    def test_queries(self):
        self.assertIn("as %25 / query", self.told("POST", EXECUTION + "?e_max=2%", TRIANGLE))
        self.assertIn("control character", self.told("GET", "/api/v1/jobs?tag=%0a"))
        self.assertIn("64 at most", self.told("GET", "/api/v1/jobs?" + "a=1&" * 70))

    def test_senders(self):
        self.assertIn("localhost", self.told("GET", "/api/v1/jobs", Host="evil.example.org"))
        self.assertIn("send it whole", self.told("GET", "/api/v1/jobs", Authorization="Bearer sf_no"))

    def test_archives_are_no_lines_of_text(self):
        with Server(fake=False) as server:
            for content, word in ((b"PK\x03\x04" + b"a" * 40, "unpack it"), (b"v 0 0 0v 1 0 0", "line breaks")):
                answer = server.request("POST", EXECUTION, content, {"Content-Type": "application/x-www-form-urlencoded"})
                self.assertIn(word, answer.json()["fix"])

    def test_files_of_other_formats(self):
        job = self.server.wait(self.server.submit()["jobID"])["jobID"]
        self.assertIn(".../exports", self.told("GET", f"/api/v1/jobs/{job}/results/layout.dxf"))


class Expect(ServerCase):
    def test_refusal_comes_before_the_body(self):
        with socket.create_connection(("127.0.0.1", self.server.port), timeout=60) as s:
            s.sendall(b"POST /nothing HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5000000\r\nExpect: 100-continue\r\n\r\n")
            self.assertTrue(s.makefile("rb").readline().startswith(b"HTTP/1.1 404"))

    def test_continue_then_answer(self):
        with socket.create_connection(("127.0.0.1", self.server.port), timeout=60) as s:
            s.sendall(POST + b"Content-Length: %d\r\nExpect: 100-continue\r\n\r\n" % len(TRIANGLE))
            answer = s.makefile("rb")
            self.assertEqual(answer.readline() + answer.readline(), b"HTTP/1.1 100 Continue\r\n\r\n")
            s.sendall(TRIANGLE)
            self.assertTrue(answer.readline().startswith(b"HTTP/1.1 201"))


class Sizes(ServerCase):
    options = ("--max-upload", "1")

    def test_declared_and_undeclared_sizes(self):
        big = b"#" * (1 << 20) + b"\n"
        self.assert_problem(self.server.request("POST", EXECUTION, big), 413, "payload-too-large")
        chunked = self.server.request("POST", EXECUTION, iter([big[i:i + 65536] for i in range(0, len(big), 65536)]))
        self.assert_problem(chunked, 413, "payload-too-large")

    def test_endless_chunks_do_not_fill_memory(self):
        before = self.server.memory()
        chunk = b"10000\r\n" + b"x" * 65536 + b"\r\n"
        received = self.server.raw(POST + b"Transfer-Encoding: chunked\r\n\r\n" + chunk * 200)
        self.assertEqual(status_of(received), 413)
        received = self.server.raw(b"POST /nothing HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n" + chunk * 200)
        self.assertEqual(status_of(received), 404)
        self.assertLess(self.server.memory() - before, 20 << 20)

    def test_multipart_fields_and_parts_are_bounded(self):
        def send(body):
            return self.server.request("POST", EXECUTION, body, {"Content-Type": "multipart/form-data; boundary=b"})
        def part(name, content):
            return b'--b\r\nContent-Disposition: form-data; name="' + name + b'"\r\n\r\n' + content + b"\r\n"
        end = b"--b--\r\n"
        self.assert_problem(send(part(b"tag", b"x" * 70000) + end), 400, "malformed-request")
        self.assert_problem(send(part(b"a", b"") * 40 + end), 400, "malformed-request")
        self.assert_problem(send(part(b"n" * 5000, b"") + end), 400, "malformed-request")
        self.assert_problem(send(b"x" * 10000 + part(b"mesh", TRIANGLE) + end), 400, "malformed-request")
        self.assertEqual(send(b"preamble\r\n" + part(b"mesh", TRIANGLE) + end + b"epilogue").status, 201)


class Slow(ServerCase):
    def open(self, data=b""):
        s = socket.create_connection(("127.0.0.1", self.server.port), timeout=60)
        s.sendall(data)
        self.addCleanup(s.close)
        return s

    def worst_of(self, count=60):
        """Seconds that 99 of 100 requests stay below. The bar is 0.1 (tests/reliability holds the server to it); here only
        waiting for the crowd is told from a busy machine."""
        times = []
        for _ in range(count):
            begun = time.monotonic()
            self.assertEqual(self.server.get("/api/v1/jobs").status, 200)
            times.append(time.monotonic() - begun)
        return sorted(times)[int(count * 0.99) - 1]

    def test_200_idle_and_200_slow_heads_harm_nobody(self):
        memory = self.server.memory()
        idle = [self.open() for _ in range(200)]
        slow = [self.open(b"GET /healthz HTTP/1.1\r\nHost: loc") for _ in range(200)]
        stop = threading.Event()
        def drip():
            while not stop.wait(0.5):
                for s in slow:
                    try:
                        s.send(b"a")
                    except OSError:
                        pass
        thread = threading.Thread(target=drip)
        thread.start()
        try:
            self.assertLess(self.worst_of(), 5)
        finally:
            stop.set()
            thread.join()
        self.assertLess(self.server.memory() - memory, 64 << 20)
        self.assertEqual(len(idle), 200)

    def test_slow_bodies_and_slow_readers_harm_nobody(self):
        job = self.server.wait(self.server.submit()["jobID"])["jobID"]
        uploads = [self.open(POST + b"Content-Length: 100000\r\n\r\nv 0 ") for _ in range(32)]
        readers = []
        for _ in range(64):
            s = socket.socket()
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            s.connect(("127.0.0.1", self.server.port))
            s.sendall(f"GET /api/v1/jobs/{job}/results/big.bin HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
            self.addCleanup(s.close)
            readers.append(s)
        self.assertLess(self.worst_of(), 5)
        self.assertEqual((len(uploads), len(readers)), (32, 64))

    def test_more_uploads_than_threads_are_told_to_come_again(self):
        def problem():
            received = self.server.raw(OK)
            if status_of(received) == 200:
                return None
            header, body = received.split(b"\r\n\r\n", 1)
            self.assertEqual(int(re.search(rb"Content-Length: (\d+)", header).group(1)), len(body))
            self.assertIn(b"Retry-After: 1", header)
            return json.loads(body)
        uploads = [self.open(POST + b"Content-Length: 100000\r\n\r\nv 0 ") for _ in range(520)]
        deadline = time.monotonic() + 60
        while (told := problem()) is None and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertEqual((told["status"], told["type"]), (503, "urn:sheetform:problem:overloaded"))
        self.assertTrue(told["detail"] and told["fix"])
        for s in uploads:
            s.close()
        deadline = time.monotonic() + 60
        while problem() is not None and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertIsNone(problem(), "the server does not recover")

    def test_who_speaks_tls_is_told_at_once(self):
        begun = time.monotonic()
        hello = b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(64))
        s = self.open(hello)  # and keeps the connection open, as a browser does
        received = b""
        while b"http://" not in received and (piece := s.recv(4096)):  # head and body may come one by one
            received += piece
        self.assertTrue(received.startswith(b"HTTP/1.1 400"), received)
        self.assertIn(b"http://", received)
        self.assertLess(time.monotonic() - begun, 5)

    def test_a_head_that_does_not_come_is_given_up(self):
        s = self.open(b"GET /healthz HTTP/1.1\r\nHost: loc")
        idle = self.open()
        begun = time.monotonic()
        received = s.makefile("rb").readline()
        self.assertTrue(received.startswith(b"HTTP/1.1 408"), received)
        self.assertLess(time.monotonic() - begun, 29)
        self.assertEqual(idle.recv(4096), b"")


if __name__ == "__main__":
    main()
