"""A cross field of the user's own, uploaded beside the mesh."""
import json

from harness import EXECUTION, ServerCase, arc, main
from test_api import form


def rosy(count, direction="0 0 1"):
    return (f"{count}\n4\n" + f"{direction}\n" * count).encode()


class UserField(ServerCase):
    fake = False

    def upload(self, *parts):
        body, kind = form(list(parts))
        return self.server.request("POST", EXECUTION, body, {"Content-Type": kind})

    def test_it_is_followed_and_the_mesh_stays_the_mesh(self):
        mesh = arc()
        faces = mesh.count(b"\nf ") + mesh.startswith(b"f ")
        for order in (0, 1):  # the field may come before the mesh
            parts = [("mesh", "arc.obj", mesh), ("field", "arc.rosy", rosy(faces))]
            answer = self.upload(*(parts[::-1] if order else parts), ("seed", None, b"%d" % order))
            self.assertEqual(answer.status, 201, answer.body)
            self.assertEqual(answer.json()["inputs"]["mesh"]["faces"], faces)
            job = self.server.wait(answer.json()["jobID"])
            self.assertEqual(job["status"], "successful", job)
            self.assertTrue(any("field" in note for note in job["report"]["notes"]), job["report"])
            self.assertEqual(self.server.get(f"/api/v1/jobs/{job['jobID']}/input").body, mesh)

    def test_the_same_mesh_with_another_field_is_another_job(self):
        mesh = arc()
        faces = mesh.count(b"\nf ") + mesh.startswith(b"f ")
        jobs = [self.upload(("mesh", "a.obj", mesh), ("effort", None, b"draft"), *field).json()
                for field in ([], [("field", None, rosy(faces))], [("field", None, rosy(faces, "1 0 1"))])]
        self.assertEqual(len({job["inputs"]["mesh"]["sha256"] for job in jobs}), 3)

    def test_a_field_that_does_not_fit_is_refused_with_where_and_fix(self):
        for field in (rosy(3), b"", b"nonsense", json.dumps([[1, 0, 0]]).encode(), b"\0" * 100):
            answer = self.upload(("mesh", "a.obj", arc()), ("field", "f.rosy", field))
            if not field:  # an empty part is a part left alone
                self.assertEqual(answer.status, 201)
                continue
            self.assert_problem(answer, 422, "invalid-parameter")
            problem = answer.json()
            self.assertIn("field", problem["where"])
            self.assertTrue(problem["fix"])

    def test_more_than_one_field_is_refused(self):
        answer = self.upload(("mesh", "a.obj", arc()), ("field", "f", rosy(3)), ("field", "f", rosy(3)))
        self.assert_problem(answer, 400, "malformed-request")


if __name__ == "__main__":
    main()
