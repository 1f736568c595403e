"""Clients that mean harm: what they may not get hold of, and how little they may cost."""
import base64
import hashlib
import json
import os
import re
import shutil
import socket
import tempfile
import threading
import time
import unittest
import urllib.parse
from concurrent.futures import ThreadPoolExecutor

from harness import EXECUTION, FAKE_WORKER, PATIENCE, Server, ServerCase, arc, main, unique_mesh

POST = b"POST " + EXECUTION.encode() + b" HTTP/1.1\r\nHost: localhost\r\n"
ASK_HEALTH = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
BEGUN_UPLOAD = POST + b"Content-Length: 100000\r\n\r\nv 0 "


class HostileCase(ServerCase):
    def open(self, data=b"", server=None, receive_buffer=None):
        s = socket.socket()
        self.addCleanup(s.close)
        if receive_buffer:
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        s.settimeout(30)
        s.connect(("127.0.0.1", (server or self.server).port))
        s.sendall(data)
        return s

    def open_many(self, count, data=b""):
        opened = []
        for _ in range(count):
            try:
                opened.append(self.open(data))
            except OSError:
                pass  # turned away already
        return opened

    def gauge(self, name):
        text = self.server.request("GET", "/metrics", check=False).body.decode()
        return float(re.search(rf"^{name} (\S+)$", text, re.M).group(1))

    def is_closed(self, s):
        s.setblocking(False)
        try:
            return s.recv(1) == b""
        except BlockingIOError:
            return False
        except ConnectionResetError:
            return True


def links_of(pid):
    """What the descriptors of a process lead to, by number."""
    folder = f"/proc/{pid}/fd"
    links = {}
    for number in os.listdir(folder):
        try:
            links[int(number)] = os.readlink(f"{folder}/{number}")
        except FileNotFoundError:
            pass  # closed meanwhile
    return links


def sockets_of(pid):
    return {link for link in links_of(pid).values() if link.startswith("socket:")}


as_root = unittest.skipIf(os.geteuid() != 0, "a child that is closed in may be looked at by root alone")


class Descriptors(HostileCase):
    @as_root
    def test_children_inherit_no_connection(self):
        self.look_at_child(self.server, unique_mesh(), "deaf.obj")

    @as_root
    def test_children_of_the_nursery_inherit_no_connection(self):
        with Server(fake=False) as server:
            self.look_at_child(server, arc(60, 60, seed=1), "arc.obj")

    def look_at_child(self, server, mesh, name):
        nursery = set(server.children())
        self.open(server=server)  # idle
        self.open(b"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n", server)
        self.open(BEGUN_UPLOAD, server)
        server.until_streams(1)
        held = sockets_of(server.process.pid)
        self.assertGreater(len(held), 3)  # the one that listens and three clients
        job = server.submit(mesh, name=name)["jobID"]
        seen = {}

        def looked():
            for pid in set(server.children()) - nursery:
                try:
                    before, links = links_of(pid), links_of(pid)
                except OSError:
                    continue  # has ended meanwhile
                # In its first moments it has not yet closed what it is not to have, and may do so while it is looked at.
                if links and links == before and max(links) <= 6:
                    seen[pid] = links
            return bool(seen)
        server.until("a child could be looked at", looked)
        for links in seen.values():
            self.assertEqual([link for link in links.values() if link.startswith("socket:")], [])
        for pid in nursery:
            self.assertEqual(sockets_of(pid) & held, set())
        server.request("DELETE", f"/api/v1/jobs/{job}")

    def test_every_descriptor_closes_itself_in_a_child(self):
        self.open(b"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        self.open(BEGUN_UPLOAD)
        self.open(b"GET ")
        self.server.until_streams(1)
        inherited, looked_at = [], 0
        for number, link in links_of(self.server.process.pid).items():
            if number <= 2:
                continue
            try:
                with open(f"/proc/{self.server.process.pid}/fdinfo/{number}") as f:
                    flags = int(re.search(r"flags:\s+(\d+)", f.read()).group(1), 8)
            except FileNotFoundError:
                continue  # closed meanwhile: the server does not stand still
            looked_at += 1
            if not flags & os.O_CLOEXEC:
                inherited.append(link)
        self.assertGreater(looked_at, 8)
        self.assertEqual(inherited, [])


class FewDescriptors(HostileCase):
    """A process that may have 128 of them, and clients that want more."""

    @classmethod
    def setUpClass(cls):
        cls.server = Server(below=("prlimit", "--nofile=128:128"))

    def assert_serves(self):
        self.assertEqual(self.server.get("/healthz").status, 200)
        self.assertEqual(self.server.wait(self.server.submit()["jobID"])["status"], "successful")

    def assert_rests(self):
        begun, used = time.monotonic(), self.server.processor_seconds()
        time.sleep(1)
        self.assertLess(self.server.processor_seconds() - used, 0.3 * (time.monotonic() - begun))

    def test_idle_connections_take_nothing_from_others(self):
        idle = self.open_many(300)
        self.server.until("the oldest went", lambda: self.gauge("sheetform_http_shed_total") >= 250)
        self.assert_rests()
        self.assert_serves()
        for s in idle:
            s.close()
        self.assert_serves()

    def test_busy_connections_take_nothing_from_jobs(self):
        job = self.server.submit(name="work-1500.obj")["jobID"]
        busy, told = [], b""
        deadline = time.monotonic() + 30
        # A burst may lose connections before they get a thread, or one that has no descriptor left for its file: they
        # come again until all threads are taken.
        while b" 503 " not in told and time.monotonic() < deadline:
            busy += self.open_many(200 if not busy else 20, BEGUN_UPLOAD)
            told = self.server.raw(ASK_HEALTH)
        self.assertIn(b'"fix":"try again in a second"', told)
        self.assert_rests()
        for s in busy:
            s.close()
        self.server.until("threads are free again", lambda: b" 200 " in self.server.raw(ASK_HEALTH))
        self.assertEqual(self.server.wait(job)["status"], "successful")
        self.assert_serves()


class Waiting(HostileCase):
    def test_the_oldest_of_more_than_2048_go(self):
        """All of them idle; a request among them is answered at once, and the last ones keep their place."""
        before = self.gauge("sheetform_http_shed_total")
        idle = self.open_many(2048 + 60)
        self.assertEqual(len(idle), 2048 + 60)
        # All within the time that the server gives idle connections.
        idle[-1].sendall(ASK_HEALTH)
        self.assertTrue(idle[-1].makefile("rb").readline().startswith(b"HTTP/1.1 200"))
        begun = time.monotonic()
        self.assertTrue(self.server.raw(ASK_HEALTH).startswith(b"HTTP/1.1 200"))
        self.assertLess(time.monotonic() - begun, 5)
        self.assertGreaterEqual(self.gauge("sheetform_http_shed_total") - before, 60)
        self.assertLessEqual(self.gauge("sheetform_http_waiting"), 2048)
        self.server.until("the first are closed", lambda: all(self.is_closed(s) for s in idle[:60]))


class Ranges(HostileCase):
    def test_many_ranges_get_the_whole_at_the_cost_of_one(self):
        job = self.server.wait(self.server.submit()["jobID"])["jobID"]
        path = f"/api/v1/jobs/{job}/results/big.bin"
        whole = self.server.get(path).body
        lists = [",".join("0-" for _ in range(5000)), ",".join(f"{i}-{i + 700000}" for i in range(900)), "-1," * 4000 + "-1",
                 "0-0," + ",".join(f"{i}-" for i in range(700000, 0, -500)), "0-1,", ",".join("9" * 100 + "-" for _ in range(100))]
        before = self.server.memory()

        def ask(ranges):
            answer = self.server.request("GET", path, headers={"Range": "bytes=" + ranges}, check=False)
            return answer.status, answer.body == whole
        for ranges in lists:
            self.assertLess(len(ranges), 15000)
            with ThreadPoolExecutor(20) as pool:
                self.assertEqual(set(pool.map(ask, [ranges] * 20)), {(200, True)}, ranges[:50])
        many = "".join(f"Range: bytes={i}-\r\n" for i in range(60)).encode()
        received = self.server.raw(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n".encode() + many + b"\r\n")
        self.assertTrue(received.startswith(b"HTTP/1.1 200") and received.endswith(whole))
        self.assertLess(self.server.memory() - before, 32 << 20)


class Forms(HostileCase):
    FORM = {"Content-Type": "multipart/form-data; boundary=b"}
    HEAD = b'--b\r\nContent-Disposition: form-data; name="mesh"; filename="a.obj"\r\n\r\n'
    END = b"\r\n--b--\r\n"

    def part(self, disposition, content=b""):
        return b"--b\r\nContent-Disposition: form-data; " + disposition.encode() + b"\r\n\r\n" + content + b"\r\n"

    def send(self, body, **headers):
        return self.server.request("POST", EXECUTION, body, {**self.FORM, **headers})

    def assert_refused(self, body, detail):
        answer = self.send(body)
        self.assert_problem(answer, 400, "malformed-request")
        self.assertIn(detail, answer.json()["detail"])
        self.assertIn("curl -F mesh=@", answer.json()["fix"])

    def test_many_parts_and_large_heads(self):
        before = self.server.memory()
        for _ in range(5):
            self.assert_refused(self.part('name="a"') * 10000, "more than 32 parts")
            self.assert_refused(self.part('name="%s"' % ("n" * 1000000)), "larger than 4096 bytes")
            self.assert_refused(self.part('name="mesh"; filename="%s"' % ("n" * 1000000)), "larger than 4096 bytes")
            self.assert_refused(self.part("name=mesh; filename*=UTF-8''" + "%41" * 100000), "larger than 4096 bytes")
            self.assert_refused(self.part("name=mesh" + "; a=b" * 100000), "larger than 4096 bytes")
            self.assert_refused(b"--b\r\n" + b"X: y\r\n" * 100000 + b"\r\n", "larger than 4096 bytes")
            self.assert_refused(b"--b" + b" " * 100000, "followed by something else")
        self.assertLess(self.server.memory() - before, 8 << 20)

    def test_names_that_break_lines_or_go_on_for_ever(self):
        self.assert_refused(self.part('name="mesh"; filename="a\r\nContent-Type: x/y\r\n.obj"', unique_mesh()) + self.END, "head of a part is malformed")
        for name, shown in (("a%0d%0ab.obj", "a%0d%0ab.obj"), ("n" * 3900 + ".obj", "n" * 128), ("\\" * 1000 + "x.obj", "x.obj")):
            answer = self.send(self.part(f'name="mesh"; filename="{name}"', unique_mesh()) + self.END)
            self.assertEqual((answer.status, answer.json()["inputs"]["mesh"]["name"]), (201, shown))
        for extended in ("UTF-8''" + "%41" * 1200, "UTF-8''%zz%", "'" * 3000, '"' + "\\" * 3000):
            answer = self.send(self.part(f"name=mesh; filename*={extended}", unique_mesh()) + self.END)
            self.assertIn(answer.status, (201, 400), extended[:20])  # RFC 7578 knows no filename*; it means nothing

    def test_media_types_that_go_on_for_ever(self):
        mesh = unique_mesh()
        for media in ("application/" + "a" * 10000, "model/" + "a" * 10000, "a" * 10000, "model/" + "a/" * 5000,
                      "x/y;" + "a=b;" * 3000):
            answer = self.server.request("POST", EXECUTION, mesh, {"Content-Type": media})
            self.assert_problem(answer, 415, "unsupported-media-type")
            self.assertLess(len(answer.body), 1000)
        answer = self.server.request("POST", EXECUTION, mesh, {"Content-Type": "model/" + "a" * 20000}, check=False)
        self.assert_problem(answer, 431, "headers-too-large")
        for parameters in ("boundary=" + "b" * 71, "a=b;" * 3000, 'boundary="' + "b" * 10000, "boundary=b;" * 1000):
            answer = self.server.request("POST", EXECUTION, mesh, {"Content-Type": "multipart/form-data; " + parameters})
            self.assert_problem(answer, 400, "malformed-request")
            self.assertIn("boundary", answer.json()["detail"])

    def test_a_body_that_comes_in_two_or_byte_by_byte(self):
        """The data holds what looks like the boundary; every cut of it, and all cuts at once, give the same file."""
        mesh = unique_mesh() + b"# \r\n--b\r\n--bx\r\n-\r\n\r\n--\r\r\n--b--\r\n--"
        body = self.HEAD.replace(b"--b", b"--bd") + mesh + self.END.replace(b"--b", b"--bd")
        head = POST + b"Content-Type: multipart/form-data; boundary=bd\r\nContent-Length: %d\r\n\r\n" % len(body)
        digest = hashlib.sha256(mesh).hexdigest()

        def upload(pieces):
            s = self.open(head)
            s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            for piece in pieces:
                s.sendall(piece)
                time.sleep(0.001)
            received = s.makefile("rb").read()
            self.assertTrue(received.startswith(b"HTTP/1.1 201"), received[:300])
            self.assertEqual(json.loads(received.split(b"\r\n\r\n", 1)[1])["inputs"]["mesh"]["sha256"], digest)
        for cut in range(len(body) - 60, len(body)):
            upload([body[:cut], body[cut:]])
        upload([body[i:i + 1] for i in range(len(body))])

    def test_uploads_cost_less_than_a_mebibyte_each(self):
        data = b"# " + b"x" * (1 << 20)
        chunked = b"Content-Type: multipart/form-data; boundary=b\r\nTransfer-Encoding: chunked\r\n\r\n900000\r\n"
        for kind in (b"Content-Length: 9000000\r\n\r\n", chunked + self.HEAD,
                     chunked + b'--b\r\nContent-Disposition: form-data; name="tag"\r\n\r\n'):
            before = self.server.memory()
            field = kind.endswith(b'"tag"\r\n\r\n')
            held = [self.open(POST + kind + (data[:60000] if field else data)) for _ in range(48)]
            self.server.until("all of them are read", lambda: self.gauge("sheetform_http_connections") >= len(held))
            time.sleep(0.5)
            self.assertLess(self.server.memory() - before, len(held) << 20)
            for s in held:
                s.close()
            self.server.until("all of them have gone", lambda: self.gauge("sheetform_http_connections") < 2)


class Speed(HostileCase):
    """Whoever is slower than 1 KiB/s, or stops, is given up after a while; whoever is just slow is not."""
    SECONDS = 75

    def read(self, job, rate):
        s = socket.socket()
        self.addCleanup(s.close)
        s.setsockopt(socket.IPPROTO_TCP, socket.TCP_MAXSEG, 1400)  # as on a network: on loopback one packet may have 64 KiB
        s.connect(("127.0.0.1", self.server.port))
        s.sendall(f"GET /api/v1/jobs/{job}/input HTTP/1.1\r\nHost: localhost\r\nX-Request-Id: reader-{rate}\r\n\r\n".encode())
        begun, got = time.monotonic(), 0
        while time.monotonic() - begun < self.SECONDS:
            wanted = int(rate * (time.monotonic() - begun)) - got
            piece = s.recv(wanted) if wanted > 0 else b""
            got += len(piece)
            time.sleep(0.05)
        s.close()

    def write(self, rate, seconds):
        """Drips an upload; what is answered, if anything, while it goes on."""
        s = self.open(POST + b"Content-Length: 10000000\r\n\r\n")
        s.settimeout(0.2)
        begun, sent = time.monotonic(), 0
        while time.monotonic() - begun < seconds:
            wanted = int(rate * (time.monotonic() - begun)) - sent
            try:
                sent += s.send(b"#" * wanted)
                return s.recv(65536), time.monotonic() - begun
            except TimeoutError:
                pass
        s.close()
        return None, seconds

    def test_slow_is_fair_and_too_slow_is_not(self):
        job = self.server.submit(b"# " + b"x" * (32 << 20) + b"\n" + unique_mesh())["jobID"]
        rates = [0, 300, 8000, 20000, 200000]
        readers = [threading.Thread(target=self.read, args=(job, rate)) for rate in rates]
        answers = {}
        writers = [threading.Thread(target=lambda r=rate: answers.update({r: self.write(r, 30)})) for rate in (0, 300, 4000)]
        for thread in readers + writers:
            thread.start()
        for thread in readers + writers:
            thread.join()
        for rate, least, most in ((0, 10, 25), (300, 9, 20)):
            answer, seconds = answers[rate]
            self.assertIn(b"HTTP/1.1 408", answer or b"", rate)
            self.assertTrue(least <= seconds <= most * PATIENCE, (rate, seconds))
        self.assertEqual(answers[4000], (None, 30))

        def ends():
            return {line["request"]: line["ms"] / 1000 for line in self.server.log_lines() if line.get("request", "").startswith("reader-")}
        self.server.until("all downloads have ended", lambda: len(ends()) == len(rates))
        for rate in (0, 300):
            self.assertTrue(58 <= ends()[f"reader-{rate}"] <= self.SECONDS - 5, ends())
        for rate in (8000, 20000, 200000):
            self.assertGreaterEqual(ends()[f"reader-{rate}"], self.SECONDS - 2, ends())


class Trailers(HostileCase):
    """Fields after a chunked body come after everything has been decided, and decide nothing."""
    TRAILERS = ["Content-Length: 5", "Host: evil.example.org", "Idempotency-Key: once", "X-Request-Id: trailer", "Prefer: wait=10",
                "Content-Digest: sha-256=:AAAA:", "Content-Type: application/json", "Content-Encoding: gzip", "Origin: http://evil.example.org",
                "Transfer-Encoding: identity", "Expect: 200-ok"]

    def post(self, trailers, mesh, *fields, server=None):
        chunk = b"%x\r\n" % len(mesh) + mesh + b"\r\n0\r\n"
        lines = "".join(line + "\r\n" for line in trailers) + "\r\n"
        head = "".join(line + "\r\n" for line in fields).encode()
        received = (server or self.server).raw(POST + head + b"Transfer-Encoding: chunked\r\n\r\n" + chunk + lines.encode())
        return received.split(b"\r\n\r\n", 1)

    def test_trailers_decide_nothing(self):
        jobs, mesh = [], unique_mesh()
        for _ in range(2):
            head, body = self.post(self.TRAILERS, mesh)
            self.assertIn(b"HTTP/1.1 201", head)
            self.assertNotRegex(head, b"trailer|evil|Idempotency-Replayed|Preference-Applied")
            job = json.loads(body)
            self.assertEqual(job["inputs"]["mesh"]["bytes"], len(mesh))
            jobs.append(job["jobID"])
        self.assertEqual(len(set(jobs)), 2)

    def test_a_token_in_a_trailer_is_none(self):
        key = "0123456789abcdef0123456789abcdef"
        with tempfile.NamedTemporaryFile() as f:
            f.write(key.encode())
            f.flush()
            with Server("--token-file", f.name) as server:
                for field in (f"Authorization: Bearer {key}", f"X-Api-Key: {key}", f"Cookie: sheetform={key}"):
                    self.assertIn(b"HTTP/1.1 401", self.post([field], unique_mesh(), server=server)[0], field)
                good = f"Authorization: Bearer {key}"
                self.assertIn(b"HTTP/1.1 201", self.post(["Authorization: Bearer wrong"], unique_mesh(), good, server=server)[0])


BREAKS = "\r\nSet-Cookie: a=b\r\n{\"level\":\"error\"}\n\x1b[31m\x00\x7f\u009b31m\u2028"


class Injection(HostileCase):
    """Line breaks and control characters, wherever a request may have them, end up in no header and no line of the log."""

    def tearDown(self):
        log = self.server.log_bytes().rpartition(b"\n")[0]  # whole lines
        for line in log.splitlines():
            self.assertLessEqual({"ts", "level", "msg"}, set(json.loads(line)), line)
            self.assertIsNone(re.search(rb"[^\x20-\x7e]", line), line)
            self.assertNotIn(b'"level":"error"', line)

    def assert_clean(self, received):
        head = received.split(b"\r\n\r\n", 1)[0]
        self.assertNotIn(b"set-cookie", head.lower())
        self.assertNotRegex(head, rb"[^\r\n\x20-\x7e]")
        self.assertTrue(received.startswith(b"HTTP/1.1 "), received)

    def ask(self, target, *fields, method="GET"):
        lines = [f"{method} {target} HTTP/1.1", "Host: localhost", *fields, "", ""]
        received = self.server.raw("\r\n".join(lines).encode("utf-8", "surrogateescape"))
        self.assert_clean(received)
        return received

    def test_paths_and_queries(self):
        for text in (BREAKS, *BREAKS, "\r\n", "\u0085", "\u202e"):
            escaped = urllib.parse.quote(text, safe="")
            job = self.ask(f"/api/v1/jobs/{escaped}")
            self.assertRegex(job, rb"^HTTP/1\.1 40[04] ")
            self.ask(f"/{escaped}")
            self.ask(f"/api/v1/jobs?tag={escaped}")
            self.ask(f"/api/v1/jobs?{escaped}=1")
            self.ask(f"/api/v1/processes/{escaped}/execution?filename={escaped}", method="POST")
        self.assertIn(b"40", self.ask("/api/v1/jobs/%c2%9b31m")[:20])  # is printed as bytes by some terminals

    def test_header_fields(self):
        for text in ("a%0d%0aSet-Cookie: a=b", "\u009b31m", "a\tb", "\x80"):
            for name in ("X-Request-Id", "Origin", "Prefer", "Range", "If-None-Match", "Accept", "Idempotency-Key", "Authorization",
                         "Cookie", "Last-Event-ID", "traceparent"):
                self.ask("/api/v1/limits", f"{name}: {text}")
            self.assert_clean(self.server.raw(f"GET / HTTP/1.1\r\nHost: {text}\r\n\r\n".encode()))
            self.assert_clean(self.server.raw(f"{text} / HTTP/1.1\r\nHost: localhost\r\n\r\n".encode()))

    def test_names_of_files(self):
        name = "a" + BREAKS + '";\\ filename*=x.obj'
        body = json.dumps({"inputs": {"mesh": {"value": base64.b64encode(unique_mesh()).decode(), "name": name}}})
        answer = self.server.request("POST", EXECUTION, body, {"Content-Type": "application/json"})
        self.check_name(answer)
        part = ('--b\r\nContent-Disposition: form-data; name="mesh"; filename="%s"\r\n\r\n%s\r\n--b--\r\n' %
                (name.replace("\r", "").replace("\n", "").replace("\0", "").replace('"', '\\"'), unique_mesh().decode()))
        answer = self.server.request("POST", EXECUTION, part.encode(), {"Content-Type": "multipart/form-data; boundary=b"})
        self.check_name(answer)

    def check_name(self, answer):
        self.assertEqual(answer.status, 201, answer.body)
        job = answer.json()
        self.assertNotRegex(job["inputs"]["mesh"]["name"], "[\x00-\x1f\x7f-\x9f/\u2028]")
        received = self.server.raw(f"GET /api/v1/jobs/{job['jobID']}/input HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        self.assert_clean(received)
        disposition = re.search(rb"Content-Disposition: ([^\r]*)", received).group(1)
        self.assertRegex(disposition, rb'^attachment; filename="[A-Za-z0-9 ._-]*"; filename\*=UTF-8\'\'[A-Za-z0-9%._-]*$')

    def test_titles_of_jobs(self):
        def send(tag):
            body = json.dumps({"inputs": {"mesh": base64.b64encode(unique_mesh()).decode()}, "tag": tag})
            form = f'--b\r\nContent-Disposition: form-data; name="tag"\r\n\r\n{tag}\r\n--b--\r\n'
            for text, kind in ((body, "application/json"), (form, "multipart/form-data; boundary=b")):
                yield self.server.request("POST", EXECUTION, text.encode(), {"Content-Type": kind})
        for character in "\r\n\t\0\x1b\x7f":
            for answer in send(f"a{character}b"):
                self.assert_problem(answer, 422, "invalid-parameter")
                self.assertEqual(answer.json()["where"], "tag")
                self.assertIn("control character", answer.json()["detail"])
        self.assertEqual(next(send("caf\u00e9 \u2713")).json()["tag"], "caf\u00e9 \u2713")

    def test_what_jobs_print(self):
        job = self.server.wait(self.server.submit(name="print.obj")["jobID"])["jobID"]
        self.assertRegex(self.server.get(f"/api/v1/jobs/{job}/log").body, rb"\nfirst\?\[31m\?\n\tsecond\n$")

    def test_the_log_for_people(self):
        with Server("--log", "text", "--listen", "127.0.0.1:0", wait=False) as server:
            server.until("it serves", lambda: b"serving" in server.log_bytes())
            server.port = int(re.search(rb'url="http://[^"]*:(\d+)"', server.log_bytes()).group(1))
            server.raw(b"GET /%c2%9b31m%e2%80%a8 HTTP/1.1\r\nHost: localhost\r\n\r\n")
            server.until("the request is logged", lambda: b"31m" in server.log_bytes())
            self.assertIsNone(re.search(rb"[^\n\x20-\x7e]", server.log_bytes()))


class Faults(unittest.TestCase):
    """A fault of ours: the client gets a number, whoever runs the server finds under it what happened."""

    def assert_tells_nothing(self, server, answer, reason):
        self.assertEqual((answer.status, answer.slug()), (500, "internal"))
        problem = answer.json()
        text = answer.body.decode() + str(answer.headers)
        for secret in (server.data, "/tmp", "spool", "worker", "No such file", "errno", "what()", "std::", "exception", ".cpp"):
            self.assertNotIn(secret, text)
        self.assertEqual(answer.headers["X-Request-Id"], problem["requestId"])
        self.assertIn("requestId", problem["fix"])
        told = server.logged(problem["requestId"])
        self.assertEqual((told[-1]["msg"], told[-1]["status"]), ("request", 500))
        reasons = [line["reason"] for line in server.log_lines() if line["level"] == "error"]
        self.assertTrue(reasons and reason in reasons[-1], reasons)
        return told

    def test_an_exception_is_logged_and_not_told(self):
        with Server() as server:
            os.rename(server.data + "/spool", server.data + "/elsewhere")
            answer = server.request("POST", EXECUTION, unique_mesh())
            told = self.assert_tells_nothing(server, answer, "No such file")
            self.assertEqual([line["level"] for line in told], ["error", "warning"])

    def test_a_job_without_a_program_is_logged_and_not_told(self):
        folder = tempfile.mkdtemp(prefix="sheetform-test-")
        worker = shutil.copy(FAKE_WORKER, folder + "/worker")
        with Server("--worker", worker, "--no-sandbox", fake=False) as server:
            shutil.rmtree(folder)
            answer = server.request("POST", EXECUTION, unique_mesh())
            self.assert_tells_nothing(server, answer, "No such file")


if __name__ == "__main__":
    main()
