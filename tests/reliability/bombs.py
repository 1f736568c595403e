"""Meshes made to exhaust whoever reads them: each is refused, or taken, at once and with little memory."""
import os
import signal
import struct
import sys
import tempfile

from trials import EXECUTION, Server, expect, trial

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server_process"))
from harness import WorkerRun  # noqa: E402
from test_meshes import BAD, OBJ, ply  # noqa: E402

REFUSED = ("unreadable-mesh", "unsupported-mesh", "mesh-limit-exceeded", "limit-exceeded")
JOB_SECONDS = 10  # of processor time
READ = (None,)  # a mesh like others; its job may find that it cannot be made of sheets


def lines(form, count):
    return b"".join(form % i for i in range(count))


def facet(*points):
    return struct.pack("<12fH", 0, 0, 0, *points, 0)


def stl(facets):
    return b"\0" * 80 + struct.pack("<I", len(facets)) + b"".join(facets)


def grid(n, step=1.0):
    """n x n vertices and the triangles between, as OBJ."""
    points = b"".join(b"v %g %g 0\n" % (i * step, j * step) for j in range(n) for i in range(n))
    faces = b"".join(b"f %d %d %d\nf %d %d %d\n" % (a, a + 1, a + n + 1, a, a + n + 1, a + n)
                     for j in range(n - 1) for a in range(j * n + 1, j * n + n))
    return points + faces


def bombs(n):
    """(name, what makes its bytes, what may come of it), of about n corners each. Made one at a time: a process that is
    begun counts the memory of who begins it as its own."""
    square = b"%d\n0 0 0\n1 0 0\n0 1 0\n"
    return [
        ("one face of all vertices", lambda: b"OFF\n%d 1 0\n" % (2 * n) + lines(b"%d 1 0\n", 2 * n) + b"%d " % (2 * n) + lines(b"%d ", 2 * n), REFUSED),
        ("one face, one vertex n times", lambda: OBJ + b"f " + b"1 " * (2 * n) + b"\n", REFUSED),
        ("one line", lambda: b"v " + b"1" * (8 * n), REFUSED),
        ("one comment", lambda: b"#" * (8 * n), REFUSED),
        ("one number of n digits", lambda: b"v " + b"0" * (4 * n) + b"1 0 0\n" + OBJ + b"f 1 2 3\n", READ + REFUSED),
        ("lines joined without end", lambda: b"f \\\n" * (2 * n), REFUSED),
        ("empty lines", lambda: b"\n" * (8 * n), REFUSED),
        ("vertices without faces", lambda: lines(b"v %d 0 0\n", n), REFUSED),
        ("degenerate faces", lambda: OBJ + b"f 1 1 2\n" * n, READ + REFUSED),
        ("the same face again and again", lambda: OBJ + b"f 1 2 3\n" * n, READ + REFUSED),
        ("a name a line", lambda: OBJ + lines(b"g %d\nusemtl m\no x\n", n // 2) + b"f 1 2 3\n", READ),
        ("all faces at one edge", lambda: OBJ[:16] + lines(b"v 0 1 %d\n", n // 2)
         + b"".join(b"f 1 2 %d\n" % (i + 3) for i in range(n // 2)), READ),
        ("all faces at one vertex", lambda: b"v 0 0 9\n" + b"".join(b"v %d %d 0\n" % (i, i * i % 97) for i in range(n // 2))
         + b"".join(b"f 1 %d %d\n" % (i + 2, i + 3) for i in range(n // 2 - 1)), READ),
        ("facets all alike", lambda: stl([facet(0, 0, 0, 1, 0, 0, 0, 1, 0)] * (n // 3)), READ + REFUSED),
        ("facets that hardly differ", lambda: stl([facet(0, 0, 0, 1, 0, 0, 0, 1, i * 1e-45) for i in range(n // 3)]), READ + REFUSED),
        ("facets in steps of powers of two", lambda: stl([facet(i * 1024, 0, 0, i * 1024 + 1, 0, 0, i * 1024, 1, 0)
                                                 for i in range(n // 3)]), READ),
        ("text stl without end", lambda: b"solid x\n" + b"facet normal 0 0 1\nouter loop\n" * (n // 8), REFUSED),
        ("ply of endless comments", lambda: b"ply\nformat ascii 1.0\n" + b"comment x\n" * n, REFUSED),
        ("ply of endless properties", lambda: ply(b"element vertex 3\n" + lines(b"property float p%d\n", n // 2)), REFUSED),
        ("ply of endless elements", lambda: ply(lines(b"element e%d 0\n", n // 2)), REFUSED),
        ("ply of elements without bytes", lambda: ply(b"element nothing 4000000000\n" + b"element vertex 1\nproperty float x\n"
                                             b"property float y\nproperty float z\n", b"0 0 0\n"), REFUSED),
        ("off of endless counts", lambda: b"OFF\n" + b"9" * n + b" 1 0\n", REFUSED),
        ("off that counts more corners than there are", lambda: b"OFF\n3 1 0\n" + square[3:] + b"2147483647 0 1 2\n", REFUSED),
        ("a good mesh of many faces", lambda: grid(int((n / 6) ** 0.5)), READ),
    ]


@trial("T24", "bombs for parsers: each is refused or taken within 1 s and 64 MiB, by the right problem")
def parser_bombs(figures, long, rng):
    size = 300_000 if long else 60_000
    tried, limited, slowest, largest = 0, [], (0, ""), (0, "")
    small, large = [(name, lambda mesh=mesh: mesh, REFUSED + READ) for name, mesh in BAD], bombs(size)
    for name, make, allowed in small + large:
        mesh = make()
        with tempfile.TemporaryDirectory() as folder:
            runs = [WorkerRun("inspect", mesh)]
            if long:
                runs.append(WorkerRun("decompose", mesh, folder=folder, timeout=JOB_SECONDS))
        run = runs[0]
        expect(run.status in (0, 65), f"{name}: the reader ended with {run.status}")
        expect(run.slug() in allowed, f"{name}: {run.problem()}")
        expect(run.problem() is None or (run.problem()["detail"] and run.problem()["fix"]), f"{name}: {run.problem()}")
        for job in runs[1:]:  # reading is quick; the job itself may take its time, but no more
            limited += [name] if job.status in (-signal.SIGXCPU, -signal.SIGKILL) and job.seconds >= JOB_SECONDS else []
            expect(job.status in (0, 65) or name in limited, f"{name}: the job ended with {job.status}, {job.seconds:.1f} s")
        slowest, largest = max(slowest, (run.seconds, name)), max(largest, (run.memory / 2**20, name))
        tried += 1
    figures.put(bombs=tried, slowest=slowest[1], largest=largest[1], jobs_ended_by_their_limit=str(limited))
    figures.bar("slowest_seconds", slowest[0], most=1)
    figures.bar("largest_mib", largest[0], most=64)
    with Server("--slots", "1", "--quiet", fake=False) as server:
        for name, make, allowed in large:
            if None not in allowed:
                answer = server.request("POST", EXECUTION, make(), check=False)
                expect((answer.status, answer.slug() in allowed) == (422, True), f"{name}: {answer.status} {answer.body[:300]}")
        figures.bar("server_mib", server.memory() / 2**20, most=64)
