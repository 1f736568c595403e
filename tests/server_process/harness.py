"""A real server process for the tests: started on a free port with a fresh data folder, spoken to by the standard
library, every answer held to proto/openapi.yaml (as the server itself serves it)."""
import base64
import errno
import fcntl
import hashlib
import http.client
import itertools
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.parse

PROGRAM = os.environ.get("SHEETFORM", "")
FAKE_WORKER = os.environ.get("FAKE_WORKER", "")
PATIENCE = 6 if os.environ.get("SHEETFORM_SANITIZED") else 1  # sanitizers make everything slow
EXECUTION = "/api/v1/processes/decompose/execution"

TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def arc(across=8, along=5, seed=0):
    """A quarter of a tube as OBJ: one sheet, decomposed in no time. seed makes each another mesh."""
    import math
    points = [(math.cos(math.pi / 2 * i / across), math.sin(math.pi / 2 * i / across), j / along * (1 + seed * 1e-4))
              for j in range(along + 1) for i in range(across + 1)]
    lines = ["v %.9f %.9f %.9f" % p for p in points]
    for j in range(along):
        for i in range(across):
            a = j * (across + 1) + i + 1
            b, c, d = a + 1, a + across + 2, a + across + 1
            lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    return ("\n".join(lines) + "\n").encode()


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    def json(self):
        return json.loads(self.body)

    def slug(self):
        """The kind of a problem, e.g. "unreadable-mesh"."""
        return re.split("[/:]", self.json()["type"])[-1]


class Server:
    """One server process and its data folder. Use as a context."""

    def __init__(self, *options, fake=True, data=None, env=None, wait=True, below=()):
        """below: a command that starts the program in surroundings of its own."""
        self.below = below
        self.data = data or tempfile.mkdtemp(prefix="sheetform-test-")
        self.own_data = data is None
        self.options = [*options] if "--log" in options else ["--log", "json", *options]
        if "--min-free" not in options:
            self.options += ["--min-free", "0"]
        if fake:
            self.options += ["--worker", FAKE_WORKER, "--no-sandbox"]
        self.env = dict(os.environ, **(env or {}))
        self.process = None
        self.port = 0
        self.contract = None
        self.start(wait)

    def start(self, wait=True):
        self.log = open(self.data + ".log", "ab")
        self.begin = self.log.tell()
        listen = next((o for i, o in enumerate(self.options) if self.options[i - 1] == "--listen"), None)
        options = self.options if listen else ["--listen", f"127.0.0.1:{self.port}", *self.options]
        self.process = subprocess.Popen([*self.below, PROGRAM, "serve", "--data", self.data, *options], stderr=self.log,
                                        stdout=subprocess.DEVNULL, env=self.env)
        if wait:
            self.find_port()

    def find_port(self):
        """Waits until the process of the last start() serves."""
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and self.process.poll() is None:
            match = re.search(rb'"msg":"serving".*?"url":"http://[^"]*:(\d+)"', self.log_bytes(self.begin))
            if match:
                self.port = int(match.group(1))
                return
            time.sleep(0.01)
        if self.process.poll() is not None and not port_is_free(self.port):
            self.port = 0  # somebody else got it while this server was down
            self.log.close()
            return self.start()
        raise AssertionError("the server did not start: " + self.log_bytes(self.begin).decode(errors="replace")[-2000:])

    def log_bytes(self, begin=0):
        with open(self.log.name, "rb") as f:
            f.seek(begin)
            return f.read()

    def log_lines(self):
        """What was logged; the last line only when it is whole."""
        whole = self.log_bytes().rpartition(b"\n")[0]
        return [json.loads(line) for line in whole.splitlines() if line.startswith(b"{")]

    def logged(self, request):
        """The lines about the request of this id, the one about its end included: it is written after the answer went."""
        told = lambda: [line for line in self.log_lines() if line.get("request") == request]
        self.until("the request is logged", lambda: any(line["msg"] == "request" for line in told()))
        return told()

    def stop(self, sig=signal.SIGTERM, timeout=40):
        """Ends the process; its exit status."""
        if self.process.poll() is None:
            self.process.send_signal(sig)
        status = self.process.wait(timeout)
        self.log.close()
        return status

    def restart(self, sig=signal.SIGKILL):
        self.stop(sig)
        self.start()

    def __enter__(self):
        return self

    def __exit__(self, *unused):
        if self.process.poll() is None:
            self.stop(signal.SIGKILL)
        if self.own_data:
            shutil.rmtree(self.data, ignore_errors=True)
            if os.path.exists(self.log.name):
                os.unlink(self.log.name)

    # --- requests
    def request(self, method, path, body=None, headers=None, timeout=60, check=True):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        try:
            try:
                connection.request(method, path, body=body, headers=headers or {})
            except (BrokenPipeError, ConnectionResetError):
                pass  # answered before all was sent; without an answer the next line fails
            response = connection.getresponse()
            data = response.read()
            answer = Answer(response.status, response.headers, data)
        finally:
            connection.close()
        if check:
            self.hold_to_contract(method, path, answer)
        return answer

    def get(self, path, **headers):
        return self.request("GET", path, headers={k.replace("_", "-"): v for k, v in headers.items()})

    def submit(self, mesh=None, name="work-20.obj", headers=None, **parameters):
        """A job by raw body; its status document. name: what the fake worker goes by."""
        query = urllib.parse.urlencode({"filename": name, **parameters})
        answer = self.request("POST", f"{EXECUTION}?{query}", mesh if mesh is not None else unique_mesh(), headers)
        if answer.status != 201:
            raise AssertionError(f"{answer.status}: {answer.body[:500]}")
        return answer.json()

    def job(self, job_id):
        return self.get(f"/api/v1/jobs/{job_id}").json()

    def wait(self, job_id, timeout=600, until=("successful", "failed", "dismissed")):
        """The job when it has come so far. Given up late: jobs give way, on a busy machine they get a tenth of a processor."""
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            job = self.job(job_id)
            if job["status"] in until:
                return job
            time.sleep(0.02)
        raise AssertionError(f"the job did not get to {until}: {job}")

    def until(self, what, good, timeout=300):
        """Waits until good() holds; `what` is told when it does not come to that."""
        deadline = time.monotonic() + timeout
        while not good():
            assert time.monotonic() < deadline, f"not within {timeout} s: {what}"
            time.sleep(0.02)

    def until_streams(self, count):
        """Waits until so many event streams are open."""
        told = f"sheetform_event_streams {count}\n".encode()
        self.until(f"{count} streams", lambda: told in self.request("GET", "/metrics", check=False).body)

    def until_tidy(self):
        """Waits until no job has a process or a folder."""
        self.until("nothing is left of the jobs", lambda: not self.children() and not os.listdir(self.data + "/work"))

    def raw(self, data, timeout=60, close_write=False):
        """Sends bytes as they are; everything that comes back until the connection ends."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=timeout) as s:
            try:
                s.sendall(data)
                if close_write:
                    s.shutdown(socket.SHUT_WR)
            except (BrokenPipeError, ConnectionResetError):
                pass  # answered before all was sent
            received = b""
            try:
                while True:
                    piece = s.recv(65536)
                    if not piece:
                        break
                    received += piece
            except ConnectionResetError:
                pass
            return received

    # --- contract
    def hold_to_contract(self, method, path, answer):
        if self.contract is None:
            described = self.request("GET", "/api/v1/api", check=False)
            if described.status != 200:
                return  # a server that asks for a token
            self.contract = Contract(json.loads(described.body))
        self.contract.check(method, path, answer)

    def children(self):
        """Process ids of the jobs' processes, those included that have ended a moment ago."""
        listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(self.process.pid)], stdout=subprocess.PIPE)
        return [int(p) for p in listed.stdout.split()]

    def processor_seconds(self):
        """Time that the server itself has used, its children not counted."""
        with open(f"/proc/{self.process.pid}/stat") as f:
            fields = f.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory(self):
        """Resident bytes of the server; 0 when most of them are a sanitizer's."""
        if os.environ.get("SHEETFORM_SANITIZED"):
            return 0
        with open(f"/proc/{self.process.pid}/status") as f:
            return int(re.search(r"VmRSS:\s+(\d+)", f.read()).group(1)) * 1024


def port_is_free(port):
    """Whether a server may listen there; 0 always is. SO_REUSEADDR, as the server has it: old connections do not count."""
    with socket.socket() as s:
        s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            s.bind(("127.0.0.1", port))
            return True
        except OSError as e:
            if e.errno != errno.EADDRINUSE:
                raise
            return False


def default_parameters():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "proto", "schemas", "parameters.schema.json")
    with open(path) as f:
        properties = json.load(f)["properties"]
    return {name: definition["default"] for name, definition in properties.items() if "default" in definition}


class WorkerRun:
    """The real process of one job without a server: what it said, how it ended, what it used. mode: "inspect", or
    "decompose" into `folder`."""

    def __init__(self, mode, mesh, name="mesh", folder="/dev/null", timeout=60, **request):
        asked = {"mode": mode, "name": name, "parameters": default_parameters(), "threads": 1, "memory": 1 << 32, "fileBytes": 1 << 28,
                 "cpuSeconds": timeout, "sandbox": True, **request}
        reader, writer = os.pipe()
        with tempfile.TemporaryFile() as given, tempfile.TemporaryFile() as question, os.fdopen(reader, "rb") as told:
            given.write(mesh), question.write(json.dumps(asked).encode())
            for file in (given, question):
                file.flush(), file.seek(0)
            place = os.open(folder, os.O_RDONLY)
            numbers = [given.fileno(), place, writer, question.fileno()]  # become 3, 4, 5 and 6

            def put_in_place():
                copies = [fcntl.fcntl(n, fcntl.F_DUPFD, 20) for n in numbers]
                for i, copy in enumerate(copies):
                    os.dup2(copy, 3 + i)
            begun = time.monotonic()
            process = subprocess.Popen([PROGRAM, "worker"], preexec_fn=put_in_place, close_fds=False,
                                       stderr=subprocess.DEVNULL, env={"MALLOC_ARENA_MAX": "2"})
            os.close(writer)
            self.told = [json.loads(line) for line in told if line.endswith(b"\n")]  # until its end
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.seconds, self.memory = time.monotonic() - begun, usage.ru_maxrss * 1024
            self.status = process.returncode
            os.close(place)

    def problem(self):
        """The problem it told, or None."""
        return next((line["problem"] for line in self.told if "problem" in line), None)

    def slug(self):
        return re.split("[/:]", self.problem()["type"])[-1] if self.problem() else None


_counter = itertools.count(1)  # also for threads


def unique_mesh():
    return TRIANGLE + f"# {os.getpid()} {next(_counter)}\n".encode()


class Contract:
    """The description of the API, and whether an answer keeps to it."""

    def __init__(self, description):
        self.description = description
        self.seen = set()  # (path, method, status) of every answer that was found to be as described

    def operation(self, method, path):
        path = urllib.parse.unquote(path.split("?")[0])
        for template, item in self.description["paths"].items():
            pattern = re.sub(r"\{[^}]*\}", "[^/]+", template)
            if re.fullmatch(pattern, path) and (method.lower() in item or method == "HEAD"):
                return template, item.get(method.lower() if method != "HEAD" else "get")
        return None, None

    def responses(self):
        """(path, method, status) of every response that is described."""
        return {(path, method.upper(), status) for path, item in self.description["paths"].items()
                for method, operation in item.items() if method != "parameters" for status in operation["responses"]}

    def check(self, method, path, answer):
        if answer.headers.get("Content-Type") == "application/problem+json" and method != "HEAD":
            for member in ("title", "detail", "fix", "requestId"):  # what, where, how to mend it, which one
                assert answer.json().get(member), f"{method} {path} -> {answer.status}: no {member} in {answer.body[:300]}"
        digest = answer.headers.get("Repr-Digest")
        if method == "GET" and answer.status == 200 and digest:
            own = base64.b64encode(hashlib.sha256(answer.body).digest()).decode()
            assert digest == f"sha-256=:{own}:", f"{method} {path}: Repr-Digest is not that of the body"
        template, operation = self.operation(method, path)
        if operation is None:
            return
        self.hold(operation, method, path, answer)
        self.seen.add((template, method, str(answer.status)))

    def hold(self, operation, method, path, answer):
        declared = operation["responses"]
        where = f"{method} {path} -> {answer.status}"
        # What every address can answer, whatever it is for.
        if str(answer.status) not in declared and answer.status in (400, 401, 403, 408, 421, 429, 500, 503):
            self.validate(answer.json(), {"$ref": "#/components/schemas/Problem"}, where)
            return
        assert str(answer.status) in declared, f"{where}: status not described"
        response = self.resolve(declared[str(answer.status)])
        if method == "HEAD":
            return
        content = response.get("content", {})
        kind = answer.headers.get("Content-Type")
        if not content:
            assert answer.body == b"", f"{where}: a body that is not described"
            return
        plain = {k.replace(" ", "") for k in content}
        assert kind is not None and (kind.replace(" ", "") in plain or kind.split(";")[0] in plain or "*/*" in content), \
            f"{where}: type {kind} is not described"
        if kind.split(";")[0] in ("application/json", "application/problem+json") and kind in content:
            self.validate(answer.json(), content[kind]["schema"], where)

    def resolve(self, node):
        while "$ref" in node:
            target = self.description
            for key in node["$ref"].lstrip("#/").split("/"):
                target = target[key]
            node = target
        return node

    TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float)}

    def members(self, schema):
        """The names that an object may have, and whether it may have others."""
        schema = self.resolve(schema)
        parts = [self.members(part) for part in schema.get("allOf", [])]
        names = set(schema.get("properties", {})).union(*(known for known, _ in parts))
        return names, "additionalProperties" in schema or not names or any(is_open for _, is_open in parts)

    def validate(self, value, schema, where, whole=False):
        """whole: the value is seen against all of allOf elsewhere."""
        schema = self.resolve(schema)
        if isinstance(value, dict) and not whole:
            known, is_open = self.members(schema)
            undescribed = [] if is_open else sorted(set(value) - known)
            assert not undescribed, f"{where}: {undescribed} are not described"
        for part in schema.get("allOf", []):
            self.validate(value, part, where, True)
        if "type" in schema:
            kind = self.TYPES[schema["type"]]
            good = isinstance(value, kind) and not (schema["type"] in ("integer", "number") and isinstance(value, bool))
            assert good, f"{where}: {value!r:.80} is no {schema['type']}"
        if "enum" in schema:
            assert value in schema["enum"], f"{where}: {value!r} is none of {schema['enum']}"
        for bound, wrong in (("minimum", lambda v, b: v < b), ("maximum", lambda v, b: v > b)):
            assert not (bound in schema and wrong(value, schema[bound])), f"{where}: {value} breaks {bound}"
        if isinstance(value, dict):
            properties = schema.get("properties", {})
            for name in schema.get("required", []):
                assert name in value, f"{where}: {name} is missing in {str(value)[:200]}"
            for name, member in value.items():
                if name in properties:
                    self.validate(member, properties[name], f"{where} .{name}")
                elif isinstance(schema.get("additionalProperties"), dict):
                    self.validate(member, schema["additionalProperties"], f"{where} .{name}")
        if isinstance(value, list) and "items" in schema:
            for item in value:
                self.validate(item, schema["items"], where + "[]")


class ServerCase(unittest.TestCase):
    """One server for all tests of the class."""
    options = ()
    fake = True

    @classmethod
    def setUpClass(cls):
        cls.server = Server(*cls.options, fake=cls.fake)

    @classmethod
    def tearDownClass(cls):
        alive = cls.server.process.poll() is None
        cls.server.__exit__()
        assert alive, "the server died during the tests"

    def assert_problem(self, answer, status, slug):
        self.assertEqual((answer.status, answer.slug()), (status, slug), answer.body[:500])
        self.assertEqual(answer.headers["Content-Type"], "application/problem+json")
        self.assertTrue(answer.json()["detail"])


def main():
    if not PROGRAM:
        sys.exit("SHEETFORM must name the program")
    unittest.main(verbosity=2)
