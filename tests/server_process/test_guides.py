"""Strokes drawn on the mesh, uploaded beside it."""
import base64
import json
import os
import subprocess
import tempfile

from harness import EXECUTION, PROGRAM, ServerCase, arc, main
from test_api import form


class UserGuides(ServerCase):
    fake = False

    def upload(self, *parts):
        body, kind = form(list(parts))
        return self.server.request("POST", EXECUTION, body, {"Content-Type": kind})

    @staticmethod
    def middle(mesh):
        """A stroke through a vertex in the middle of the mesh and on to another one."""
        points = [[float(x) for x in line.split()[1:4]] for line in mesh.decode().splitlines() if line[:2] == "v "]
        low, high = points[0], points[-1]
        return {"seams": [{"points": [low, high], "closed": False}]}

    def test_they_are_followed_recorded_and_the_mesh_stays_the_mesh(self):
        mesh = arc()
        guides = self.middle(mesh)
        guides["keep_out"] = [{"points": guides["seams"][0]["points"][:1], "radius": 0.01}]
        parts = [("mesh", "arc.obj", mesh), ("guides", "guides.json", json.dumps(guides).encode())]
        for order in (0, 1):  # the guides may come before the mesh
            answer = self.upload(*(parts[::-1] if order else parts), ("seed", None, b"%d" % order))
            self.assertEqual(answer.status, 201, answer.body)
            job = self.server.wait(answer.json()["jobID"])
            self.assertEqual(job["status"], "successful", job)
            self.assertTrue(any("guides" in note for note in job["report"]["notes"]), job["report"])
            root = f"/api/v1/jobs/{job['jobID']}"
            self.assertEqual(self.server.get(f"{root}/input").body, mesh)
            self.assertEqual(self.server.get(f"{root}/guides").body, parts[1][2])
            self.assertEqual(job["inputs"]["mesh"]["guides"], {"seams": 1, "keepOut": 1})
            self.assertIn(f"{root}/guides", [link["href"] for link in job["links"] if link["rel"] == "guides"])
            layout = self.server.get(f"{root}/results/layout.json").json()
            self.assertEqual(layout["guides"], guides)
            self.assertTrue(any(arch["drawn"] for arch in layout["arches"]))
            self.assertIn("bend_radius_mm", job["report"])

    def test_guides_in_a_text_part_and_with_a_field(self):
        mesh = arc()
        faces = mesh.count(b"\nf ") + mesh.startswith(b"f ")
        field = (f"{faces}\n4\n" + "0 0 1\n" * faces).encode()
        answer = self.upload(("mesh", "a.obj", mesh), ("field", "f.rosy", field),
                             ("guides", None, json.dumps(self.middle(mesh)).encode()))
        self.assertEqual(answer.status, 201, answer.body)
        job = self.server.wait(answer.json()["jobID"])
        self.assertEqual(job["status"], "successful", job)
        self.assertEqual(self.server.get(f"/api/v1/jobs/{job['jobID']}/guides").json(), self.middle(mesh))
        notes = " ".join(job["report"]["notes"])
        self.assertIn("field", notes)
        self.assertIn("guides", notes)

    def test_the_same_mesh_with_other_guides_is_another_job(self):
        mesh = arc()
        one, two = self.middle(mesh), self.middle(mesh)
        two["seams"][0]["points"].reverse()
        jobs = [self.upload(("mesh", "a.obj", mesh), ("effort", None, b"draft"), *part).json()
                for part in ([], [("guides", None, json.dumps(one).encode())],
                             [("guides", None, json.dumps(two).encode())])]
        self.assertEqual(len({job["inputs"]["mesh"]["sha256"] for job in jobs}), 3)

    def test_wrong_guides_are_refused_with_where_and_fix(self):
        far = {"seams": [{"points": [[0, 0, 0], [1e6, 0, 0]]}]}
        for guides, where in ((b"nonsense", "guides"), (b"\0" * 100, "guides"), (b"{}", "guides"),
                              (b'{"seams":[{"points":[[0,0,0]]}]}', "guides, seams[0]"),
                              (b'{"keep_out":[{"points":[[0,0,0]],"radius":0}]}', "guides, keep_out[0]"),
                              (json.dumps(far).encode(), "guides, seams[0], point")):
            answer = self.upload(("mesh", "a.obj", arc()), ("guides", "g.json", guides))
            self.assert_problem(answer, 422, "invalid-parameter")
            problem = answer.json()
            self.assertIn(where, problem["where"])
            self.assertTrue(problem["fix"])
        empty = self.upload(("mesh", "a.obj", arc()), ("guides", "g.json", b""))
        self.assertEqual(empty.status, 201)  # an empty part is a part left alone

    def test_on_the_command_line(self):
        mesh, guides = arc(), self.middle(arc())
        with tempfile.TemporaryDirectory() as folder:
            path = lambda name: os.path.join(folder, name)
            for name, content in (("arc.obj", mesh), ("good.json", json.dumps(guides).encode()), ("empty.json", b""),
                                  ("bad.json", b'{"seams":[{"points":[[0,0,0],[1,null,0]]}]}')):
                with open(path(name), "wb") as f:
                    f.write(content)
            run = lambda *more: subprocess.run([PROGRAM, *more], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                               timeout=900)
            done = run("decompose", path("arc.obj"), "-o", path("out"), "--guides", path("good.json"), "-q")
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(path("out/layout.json")) as f:
                self.assertEqual(json.load(f)["guides"], {**guides, "keep_out": []})
            self.assertEqual(run("verify", path("arc.obj"), path("out")).returncode, 0)
            done = run("sweep", path("arc.obj"), "-o", path("sweep"), "--e-max", "0.05,0.02", "--guides",
                       path("good.json"), "-q")
            self.assertEqual(done.returncode, 0, done.stderr)
            for step in ("0.05", "0.02"):
                with open(path(f"sweep/{step}/layout.json")) as f:
                    self.assertTrue(any(arch["drawn"] for arch in json.load(f)["arches"]))
            for name, words in (("bad.json", b"guides, seams[0], point 1"), ("empty.json", b"--guides")):
                done = run("decompose", path("arc.obj"), "-o", path("no"), "--guides", path(name), "-q")
                self.assertEqual(done.returncode, 64)
                self.assertIn(words, done.stderr)
                self.assertFalse(os.path.exists(path("no")))

    def test_guides_in_an_ogc_request(self):
        guides = self.middle(arc())
        document = {"inputs": {"mesh": base64.b64encode(arc()).decode(), "effort": "draft", "guides": guides}}
        answer = self.server.request("POST", EXECUTION, json.dumps(document), {"Content-Type": "application/json"})
        self.assertEqual(answer.status, 201, answer.body)
        root = f"/api/v1/jobs/{answer.json()['jobID']}"
        self.assertEqual(self.server.get(f"{root}/guides").json(), guides)
        self.assertEqual(self.server.get(f"{root}/input").body, arc())
        document["inputs"]["guides"] = 7
        answer = self.server.request("POST", EXECUTION, json.dumps(document), {"Content-Type": "application/json"})
        self.assert_problem(answer, 422, "invalid-parameter")

    def test_a_job_without_guides_has_none_to_give(self):
        faces = arc().count(b"\nf ")
        field = ("field", None, (f"{faces}\n4\n" + "0 0 1\n" * faces).encode())
        for more in ([], [field]):
            job = self.upload(("mesh", "a.obj", arc()), ("effort", None, b"draft"), *more).json()
            self.assert_problem(self.server.get(f"/api/v1/jobs/{job['jobID']}/guides"), 404, "no-such-output")
            self.assertNotIn("guides", [link["rel"] for link in job["links"]])

    def test_more_than_one_part_and_too_large_a_part_are_refused(self):
        guides = json.dumps(self.middle(arc())).encode()
        answer = self.upload(("mesh", "a.obj", arc()), ("guides", "f", guides), ("guides", "f", guides))
        self.assert_problem(answer, 400, "malformed-request")
        answer = self.upload(("mesh", "a.obj", arc()), ("guides", "f", b" " * (5 << 20)))
        self.assert_problem(answer, 400, "malformed-request")


if __name__ == "__main__":
    main()
