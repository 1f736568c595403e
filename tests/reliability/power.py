"""The power goes: what the server does to its disk is written down (disk_trace.cpp), the order of it is held to the
promises, and servers are started on what is left at each moment when everything that was not synced is lost."""
import base64
import hashlib
import json
import os
import shutil
import signal
import struct
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

from trials import EXECUTION, PROGRAM, Server, Skip, expect, integrity, trial, unique_mesh, until_idle, verify_results

DISK_TRACE = os.environ.get("DISK_TRACE", "")
ENDED = ("successful", "failed", "dismissed")
SECTOR = 512
AT_ONCE = 4  # servers that are started on what is left


class Event:
    """One record of the log. op: see disk_trace.cpp."""
    HEAD = struct.Struct("=cQQII")

    def __init__(self, op, inode, offset, first, second):
        self.op, self.inode, self.offset, self.first, self.second = op.decode(), inode, offset, first, second
        self.path = first.decode() if self.op in "fdlrus" else None

    @classmethod
    def read_all(cls, path):
        with open(path, "rb") as f:
            log, at, events = f.read(), 0, []
        while at + cls.HEAD.size <= len(log):
            op, inode, offset, first, second = cls.HEAD.unpack_from(log, at)
            at += cls.HEAD.size
            events.append(cls(op, inode, offset, log[at:at + first], log[at + first:at + first + second]))
            at += first + second
        return events


class File:
    """Bytes as they are, as they are on the platter, and what lies between: (offset, bytes) or (size, None)."""

    def __init__(self):
        self.now, self.kept, self.pending = bytearray(), bytearray(), []

    @staticmethod
    def apply(content, offset, data):
        if data is None:
            del content[offset:]
            content.extend(bytes(offset - len(content)))
        else:
            content.extend(bytes(max(0, offset - len(content))))
            content[offset:offset + len(data)] = data

    def change(self, offset, data):
        self.apply(self.now, offset, data)
        self.pending.append((offset, data))

    def sync(self):
        for change in self.pending:
            self.apply(self.kept, *change)
        self.pending = []

    def left(self, rng):
        content = bytearray(self.kept)
        for offset, data in self.pending if rng else []:
            if rng.random() < 0.5:
                whole = data is None or rng.random() < 0.7
                self.apply(content, offset, data if whole else data[:SECTOR * rng.randrange(1 + len(data) // SECTOR)])
        return bytes(content)


class Folder:
    """Names as they are, as they are on the platter, and the changes between, in their order."""

    def __init__(self):
        self.now, self.kept, self.pending = {}, {}, []

    @staticmethod
    def apply(names, name, node):
        if node is None:
            names.pop(name, None)
        else:
            names[name] = node

    def change(self, name, node):
        self.apply(self.now, name, node)
        self.pending.append((name, node))

    def sync(self):
        self.kept, self.pending = dict(self.now), []

    def left(self, rng):
        names = dict(self.kept)
        for name, node in self.pending[:rng.randrange(len(self.pending) + 1)] if rng else []:
            self.apply(names, name, node)
        return names


class Disk:
    """The folder `root`, empty at first, under the events of a log."""

    def __init__(self, root):
        self.root, self.top, self.nodes = root, Folder(), {}

    def rename(self, path, node):
        names = os.path.relpath(path, self.root).split("/")
        folder = self.top
        for name in names[:-1]:
            folder = folder.now[name]
        old = folder.now.get(names[-1])
        folder.change(names[-1], node)
        return old

    def replay(self, event):
        node = self.nodes.get(event.inode)
        if event.op in "fd":
            self.nodes[event.inode] = File() if event.op == "f" else Folder()
            self.rename(event.path, self.nodes[event.inode])
        elif event.op == "l":
            self.rename(event.path, node)
        elif event.op == "u":
            self.rename(event.path, None)
        elif event.op == "r":
            self.rename(event.second.decode(), self.rename(event.path, None))
        elif event.op == "w" and node:
            node.change(event.offset, event.first)
        elif event.op == "t" and node:
            node.change(event.offset, None)
        elif event.op == "s":
            node = self.top if event.path == self.root else node
            if node:
                node.sync()

    def tree(self, names, read, at=""):
        """{path: bytes, None for a folder}, without what does not outlive a process anyway."""
        found = {}
        for name, node in names(self.top if at == "" else at[1]).items():
            path = name if at == "" else f"{at[0]}/{name}"
            if name.endswith("-shm") or os.path.basename(path) == "work":
                continue
            if isinstance(node, Folder):
                found[path] = None
                found.update(self.tree(names, read, (path, node)))
            else:
                found[path] = read(node)
        return found

    def now(self):
        return self.tree(lambda folder: folder.now, lambda file: bytes(file.now))

    def left(self, rng=None):
        """What is left when the power goes now: what was synced and, with rng, a random part of the rest."""
        return self.tree(lambda folder: folder.left(rng), lambda file: file.left(rng))


def tree_of(root):
    found = {}
    for folder, folders, files in os.walk(root):
        folders[:] = [name for name in folders if name != "work"]
        for name in folders + files:
            path = os.path.join(folder, name)
            if not name.endswith("-shm"):
                found[os.path.relpath(path, root)] = None if name in folders else open(path, "rb").read()
    return found


class Promises:
    """What clients were told: (index of the event, job, what) with what "accepted" or an end."""

    def __init__(self, events):
        self.list, heads = [], {}
        for i, event in enumerate(events):
            if event.op != "o":
                continue
            if event.first.startswith(b"HTTP/1.1 "):
                heads[event.inode] = (i, event.first)
            elif event.inode in heads:
                heads[event.inode] = (heads[event.inode][0], heads[event.inode][1] + event.first)
            begun, data = heads.get(event.inode, (i, b""))
            self.take(begun, *data.partition(b"\r\n\r\n")[::2])

    def take(self, begun, head, body):
        try:
            job = json.loads(body)
        except ValueError:
            return
        if not isinstance(job, dict) or "jobID" not in job:
            return
        if head.startswith(b"HTTP/1.1 201"):
            self.list.append((begun, job, "accepted"))
        if job["status"] in ENDED:
            self.list.append((begun, job, job["status"]))

    def until(self, moment):
        """{job: (status document, the last thing told)} of all that was told before."""
        told = {}
        for begun, job, what in self.list:
            if begun <= moment:
                told[job["jobID"]] = (job, what)
        return told


class Recording:
    """A server whose disk is written down, in a folder `root` that holds its data folder; use as a context."""

    def __init__(self):
        if not DISK_TRACE or "libasan" in os.environ.get("LD_PRELOAD", ""):
            raise Skip("DISK_TRACE does not name the library to preload")
        self.root = tempfile.mkdtemp(prefix="sheetform-disk-")
        self.log = self.root + ".trace"
        self.data = self.root + "/store"
        self.server = None

        self.env = {"LD_PRELOAD": DISK_TRACE, "TRACE_FILE": self.log, "TRACE_FOLDER": self.root}

    def start(self):
        self.server = Server("--slots", "2", "--quiet", data=self.data, env=self.env)
        return self.server

    def command(self, *arguments):
        done = subprocess.run([PROGRAM, *arguments], env=dict(os.environ, **self.env), stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)
        expect(done.returncode == 0, f"sheetform {' '.join(arguments)}: {done.stdout.decode()}")

    def finish(self):
        """The events, after the server's end; the replay of all of them is the real folder."""
        self.server.stop()
        events, disk = Event.read_all(self.log), Disk(self.root)
        for event in events:
            disk.replay(event)
        mine, real = disk.now(), tree_of(self.root)
        mine.pop("store.log", None), real.pop("store.log", None)  # the server's own log
        different = [path for path in sorted(set(mine) | set(real)) if mine.get(path, 1) != real.get(path, 1)]
        expect(not different, f"the log of the disk is not complete: {different[:5]}")
        return events

    def __enter__(self):
        return self

    def __exit__(self, *unused):
        if self.server and self.server.process.poll() is None:
            self.server.stop(signal.SIGKILL)
        shutil.rmtree(self.root, ignore_errors=True)
        if os.path.exists(self.log):
            os.unlink(self.log)


def form(mesh):
    lines = ["--b", 'Content-Disposition: form-data; name="mesh"; filename="work-10.obj"', "", mesh.decode(), "--b--", ""]
    return "\r\n".join(lines).encode()


def every_way_in(server):
    """Jobs by every way in which they can be sent; {jobID: what to send again with its key}."""
    named = f"{EXECUTION}?filename=work-10.obj"
    mesh, keyed = unique_mesh(), unique_mesh()
    inline = {"inputs": {"mesh": {"value": base64.b64encode(unique_mesh()).decode(), "mediaType": "model/obj"}}}
    sent = [
        (named, mesh, {}),
        (EXECUTION, form(unique_mesh()), {"Content-Type": "multipart/form-data; boundary=b"}),
        (EXECUTION, json.dumps(inline).encode(), {"Content-Type": "application/json"}),
        (named, iter([unique_mesh()]), {}),  # in chunks
        (named, keyed, {"Idempotency-Key": "once"}),
        (named, unique_mesh(), {"Prefer": "wait=10"}),
        (named + "&cache=refresh", mesh, {}),  # the same bytes once more: their file is there already
        (named, unique_mesh() + b"# " + b"x" * 600_000, {}),  # many writes
    ]
    repeat = {}
    for path, body, headers in sent:
        answer = server.request("POST", path, body, headers, check=False)
        expect(answer.status == 201, f"{path}: {answer.status} {answer.body[:300]}")
        if "Idempotency-Key" in headers:
            repeat[answer.json()["jobID"]] = (path, body, headers)
    first = server.wait(server.submit(mesh, name="work-10.obj", cache="refresh")["jobID"])
    expect(server.submit(mesh, name="work-10.obj")["status"] == "successful", "no result was used again")
    expect(first["status"] == "successful", "a job failed")
    return repeat


class Order:
    """Questions about the order of a log."""

    def __init__(self, events, root):
        self.events, self.root = events, root

    def first(self, after, before, test):
        return next((i for i in range(after + 1, before) if test(self.events[i])), None)

    def last(self, before, test):
        return next((i for i in range(before - 1, -1, -1) if test(self.events[i])), None)

    def synced(self, inode, after, before):
        return self.first(after, before, lambda e: e.op == "s" and e.inode == inode) is not None

    def kept(self, path, before):
        """The name of a file or folder, and those of the folders above, are on the platter; since when."""
        made = self.last(before, lambda e: (e.op in "fdl" and e.path == path) or (e.op == "r" and e.second.decode() == path))
        above = os.path.dirname(path)
        since = self.first(-1 if made is None else made, before, lambda e: e.op == "s" and e.path == above)
        expect(since is not None, f"the folder of {os.path.relpath(path, self.root)} was not synced")
        return since if above == self.root else max(since, self.kept(above, before))

    def check_accepted(self, begun, job):
        """Data on the platter before its name, its name before the row, the row before the answer."""
        digest = job["inputs"]["mesh"]["sha256"]
        file = f"{self.root}/store/blobs/in/{digest[:2]}/{digest}"
        linked = self.last(begun, lambda e: e.op == "l" and e.path == file)
        expect(linked is not None, "an upload has no name")
        inode = self.events[linked].inode
        written = self.last(linked, lambda e: e.op == "w" and e.inode == inode)
        expect(self.synced(inode, written, linked), "an upload was not synced before it got its name")
        named = self.first(-1, begun, lambda e: e.op == "w" and job["jobID"].encode() in e.first)
        expect(named is not None and self.kept(file, begun) < named, "the row was written before the upload was safe")
        expect(self.synced(self.events[named].inode, named, begun), "the row was not synced before the answer")


@trial("T3", "the order of the disk: upload synced, named, its folder synced, the row synced, then the 201")
def order(figures, long, rng):
    accepted = 0
    for folders in ("none", "left by a server that was killed"):
        with Recording() as recording:
            if folders != "none":
                for i in range(256):
                    os.makedirs(f"{recording.data}/blobs/in/{i:02x}")
            every_way_in(recording.start())
            recording.server.stop()
            events = Event.read_all(recording.log)
            for begun, job, what in Promises(events).list:
                if what == "accepted":
                    Order(events, recording.root).check_accepted(begun, job)
                    accepted += 1
    expect(accepted >= 20, "too few jobs were accepted")
    figures.put(accepted=accepted, events=len(events), syncs=sum(e.op == "s" for e in events))


@trial("T3b", "tokens, backups and restored stores are on the platter when the command has ended")
def commands(figures, long, rng):
    with Recording() as recording:
        server = recording.start()
        server.wait(server.submit()["jobID"])
        recording.command("token", "add", "anna", "--data", recording.data)
        recording.command("backup", recording.root + "/copy", "--data", recording.data)
        server.stop()
        shutil.rmtree(recording.data)  # the trace does not see it, and need not
        begun = len(Event.read_all(recording.log))
        recording.command("restore", recording.root + "/copy", "--data", recording.root + "/again")
        events = Event.read_all(recording.log)
        order, files = Order(events, recording.root), 0
        order.kept(recording.data + "/tokens.json", begun)
        for folder, before in (("copy", begun), ("again", len(events))):
            for path, content in tree_of(f"{recording.root}/{folder}").items():
                whole = f"{recording.root}/{folder}/{path}"
                order.kept(whole, before)
                files += content is not None
                expect(content is None or order.first(-1, before, lambda e: e.op == "s" and e.path == whole) is not None
                       or any(e.op == "l" and e.path == whole for e in events), f"{path} of {folder} was not synced")
        figures.put(files=files)


def write_tree(root, tree):
    for path, content in sorted(tree.items()):
        whole = os.path.join(root, path)
        if content is None:
            os.makedirs(whole, exist_ok=True)
        else:
            with open(whole, "wb") as f:
                f.write(content)


def check_what_is_left(tree, told, repeat):
    """P1 to P4 and P7, on what a power cut left: what was told holds, and no hand is needed. In memory where there is
    such a folder: this time no power fails."""
    root = tempfile.mkdtemp(prefix="sheetform-cut-", dir="/dev/shm" if os.access("/dev/shm", os.W_OK) else None)
    try:
        write_tree(root, tree)
        with Server("--slots", "2", "--quiet", data=root + "/store") as server:
            for job_id, (document, what) in told.items():
                check_promise(server, job_id, document, what)
            for job_id in set(repeat) & set(told):
                path, body, headers = repeat[job_id]
                answer = server.request("POST", path, body, headers, check=False)
                expect(answer.status == 201 and answer.json()["jobID"] == job_id, "the key of a request is forgotten")
            until_idle(server)
            jobs = server.request("GET", "/api/v1/jobs?limit=1000", check=False).json()["jobs"]
            for job in jobs:
                if job["status"] == "successful":
                    expect(verify_results(server, job["jobID"]) == 3, "a result is not complete")
            expect(server.wait(server.submit()["jobID"])["status"] == "successful", "no job runs any more")
            server.stop()
            integrity(server.data)
    finally:
        shutil.rmtree(root, ignore_errors=True)


def check_promise(server, job_id, document, what):
    answer = server.request("GET", f"/api/v1/jobs/{job_id}", check=False)
    expect(answer.status == 200, f"{job_id}, {what}, is lost: {answer.status}")
    job = answer.json()
    digest = document["inputs"]["mesh"]["sha256"]
    body = server.request("GET", f"/api/v1/jobs/{job_id}/input", check=False).body
    expect(hashlib.sha256(body).hexdigest() == digest, f"the upload of {job_id} is damaged")
    if what in ENDED:
        expect(job["status"] == what, f"{job_id} was told to be {what} and is {job['status']}")
    else:
        expect(server.wait(job_id)["status"] in ENDED, f"{job_id} does not end")


def cuts(events):
    """Moments at which a cut makes a difference: just before each sync, when most was told, and the end."""
    return [i for i in range(len(events) - 1) if events[i + 1].op == "s"] + [len(events) - 1]


@trial("T6", "a power cut at every moment: what was not synced is dropped, whole or in part, and all promises hold")
def power_cuts(figures, long, rng):
    with Recording() as recording:
        server = recording.start()
        repeat = every_way_in(server)
        server.restart(signal.SIGKILL)
        gone = server.submit(name="work-3000.obj")["jobID"]
        server.request("DELETE", f"/api/v1/jobs/{gone}")
        server.wait(server.submit(name="refuse.obj")["jobID"])
        until_idle(server)
        for job in server.get("/api/v1/jobs?limit=100").json()["jobs"]:
            server.job(job["jobID"])
        events = recording.finish()
        promises, disk = Promises(events), Disk(recording.root)
        moments = cuts(events)
        chosen = set(moments if long else rng.sample(moments, 6) + moments[-1:])
        checks = []
        with ThreadPoolExecutor(AT_ONCE) as pool:
            for i, event in enumerate(events):
                disk.replay(event)
                for part in (None, rng) if i in chosen else ():
                    checks.append(pool.submit(check_what_is_left, disk.left(part), promises.until(i), repeat))
                    if len(checks) > 2 * AT_ONCE:
                        checks[-2 * AT_ONCE].result()  # not all the states at once in memory, and stop at a failure
        for check in checks:
            check.result()
        figures.put(events=len(events), moments=len(moments), cuts=2 * len(chosen), promises=len(promises.list), broken=0)
