"""Bad meshes: each gets a clear problem at once, and the server stays up."""
import struct
import time

from harness import PATIENCE, EXECUTION, ServerCase, arc, main

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
STL_FACET = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)


def ply(header, body=b""):
    return b"ply\nformat ascii 1.0\n" + header + b"end_header\n" + body


# name, bytes
BAD = [
    ("nothing", b""),
    ("one byte", b"v"),
    ("text", b"This is a letter, not a mesh.\nBest regards\n"),
    ("html", b"<!doctype html><html><body>404</body></html>"),
    ("zip", b"PK\x03\x04" + b"\0" * 100),
    ("gzip", b"\x1f\x8b\x08" + b"\0" * 100),
    ("zeros", b"\0" * 10000),
    ("utf-16", OBJ.decode().encode("utf-16")),
    ("obj without faces", OBJ),
    ("obj with NaN", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("obj with infinity", b"v 1e999 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("obj with commas", b"v 0,5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("obj index 0", OBJ + b"f 0 1 2\n"),
    ("obj index too large", OBJ + b"f 1 2 99\n"),
    ("obj index overflow", OBJ + b"f 1 2 99999999999999999999\n"),
    ("obj empty corner", OBJ + b"f /1/1 2 3\n"),
    ("obj texture index out of range", OBJ + b"vt 0.5 0.5\nf 99999999/1 2 3\n"),
    ("stl announces too many", b"\0" * 80 + struct.pack("<I", 0xffffffff) + b"\0" * 50),
    ("stl cut off", b"\0" * 80 + struct.pack("<I", 4) + STL_FACET * 3),
    ("stl with NaN", b"\0" * 80 + struct.pack("<I", 1) + struct.pack("<12fH", 0, 0, 1, float("nan"), 0, 0, 1, 0, 0, 0, 1, 0, 0)),
    ("stl of no facets", b"\0" * 80 + struct.pack("<I", 0)),
    ("ply header without end", b"ply\nformat ascii 1.0\nelement vertex 3\n"),
    ("ply announces too many", ply(b"element vertex 4294967295\nproperty float x\nproperty float y\nproperty float z\n", b"0 0 0\n")),
    ("ply list bomb", ply(b"element vertex 0\nproperty float x\nelement face 1\nproperty list int int vertex_indices\n", b"2147483647 1\n")),
    ("off announces too many", b"OFF\n4294967295 1 0\n0 0 0\n"),
    ("off negative valence", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"),
    ("only degenerate faces", OBJ + b"f 1 1 2\nf 2 2 2\n"),
]


class BadMeshes(ServerCase):
    fake = False

    def test_each_gets_a_clear_problem_at_once(self):
        for name, mesh in BAD:
            with self.subTest(name):
                begun = time.monotonic()
                answer = self.server.request("POST", EXECUTION, mesh)
                if answer.status == 201:  # read as a mesh; then the job itself must say what is wrong
                    job = self.server.wait(answer.json()["jobID"])
                    self.assertEqual(job["status"], "failed", job)
                    problem = job["exception"]
                else:
                    problem = answer.json()
                self.assertEqual(problem["status"], 422, problem)
                self.assertRegex(problem["type"], "(unreadable-mesh|unsupported-mesh|limit-exceeded)$")
                self.assertTrue(problem["detail"] and problem["fix"], problem)
                self.assertFalse(problem["retryable"])
                self.assertLess(time.monotonic() - begun, 20 * PATIENCE)  # tests/reliability holds them to a second

    def test_what_curl_does_wrong_is_told_as_such(self):
        form = {"Content-Type": "application/x-www-form-urlencoded"}  # what curl calls every body
        answer = self.server.request("POST", EXECUTION, arc(3, 2).replace(b"\n", b""), form)
        self.assertIn("--data-binary", answer.json()["fix"])
        answer = self.server.request("POST", EXECUTION, arc(3, 2).replace(b"f", b"q"), form)
        self.assertNotIn("--data-binary", answer.json()["fix"], "the line breaks are all there")
        answer = self.server.request("POST", EXECUTION, b"", form)
        self.assertIn("no body", answer.json()["detail"])
        answer = self.server.request("PUT", EXECUTION, arc(3, 2))  # curl -T
        self.assertIn("POST", answer.json()["fix"])
        answer = self.server.request("POST", "/api/v1/jobs", arc(3, 2))
        self.assertIn("/api/v1/processes/decompose/execution", answer.json()["fix"])

    def test_no_file_is_opened_for_a_mesh(self):
        mesh = b"mtllib /dev/zero\nmtllib ../../etc/passwd\n" + arc(3, 2)
        job = self.server.submit(mesh, name="m.obj")
        self.assertEqual(job["inputs"]["mesh"]["faces"], 12)
        self.server.request("DELETE", f"/api/v1/jobs/{job['jobID']}")

    def test_a_large_file_is_refused_before_it_is_sent(self):
        answer = self.server.request("POST", EXECUTION, iter([]), {"Content-Length": str(300 << 20)})
        self.assert_problem(answer, 413, "payload-too-large")

    def test_meshes_that_need_repair_are_taken(self):
        fan = OBJ + b"v 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"  # three faces at one edge
        job = self.server.submit(fan, name="fan.obj")
        job = self.server.wait(job["jobID"])
        self.assertIn(job["status"], ("successful", "failed"))
        if job["status"] == "failed":
            self.assertEqual(job["exception"]["status"], 422, job)


if __name__ == "__main__":
    main()
