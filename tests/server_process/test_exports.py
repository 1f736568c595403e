"""Exports: a stored result drawn for other machines and sheets, without computing it again."""
import hashlib
import io
import json
import re
import os
import tempfile
import time
import unittest
import urllib.parse
import zipfile

from harness import EXECUTION, Server, ServerCase, arc, main, unique_mesh


class Exports(ServerCase):
    fake = False

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.job = cls.server.wait(cls.server.submit(arc(), name="my arc.obj", target_size=100)["jobID"])
        assert cls.job["status"] == "successful", cls.job
        cls.base = f"/api/v1/jobs/{cls.job['jobID']}/exports"

    def export(self, kind, headers=None, **query):
        return self.server.request("GET", f"{self.base}/{kind}?{urllib.parse.urlencode(query)}", headers=headers)

    def test_the_job_leads_to_them(self):
        links = {link["rel"]: link["href"] for link in self.job["links"]}
        self.assertEqual(links["exports"], self.base)
        results = self.server.get(f"/api/v1/jobs/{self.job['jobID']}/results")
        self.assertIn(f'<{self.base}>; rel="exports"', results.headers["Link"])

    def test_every_format_can_be_had(self):
        starts = {"svg": b"<?xml", "dxf": b"999", "pdf": b"%PDF", "parts-svg": b"<?xml", "parts-dxf": b"999", "fold": b"{", "obj": b"#",
                  "frame": b"sheetform", "parts-json": b"{", "parts-csv": b"label", "zip": b"PK"}
        listed = self.server.get(self.base).json()["formats"]
        self.assertEqual({f["format"] for f in listed}, set(starts))
        described = json.loads(self.server.get("/api/v1/api").body)["paths"]["/api/v1/jobs/{jobID}/exports/{format}"]["parameters"]
        self.assertEqual(set(described[1]["schema"]["enum"]), set(starts))
        for entry in listed:
            answer = self.server.get(entry["href"])
            self.assertEqual(answer.status, 200, answer.body[:300])
            self.assertTrue(answer.body.startswith(starts[entry["format"]]), entry)
            self.assertEqual(answer.headers["ETag"], f'"sha256-{hashlib.sha256(answer.body).hexdigest()}"')
            self.assertIn('filename="my arc-', answer.headers["Content-Disposition"])

    def test_defaults_that_are_listed_are_the_defaults(self):
        parameters = self.server.get(self.base).json()["parameters"]
        named = {p["name"]: p["default"] for p in parameters if p["default"]}
        plain, told = self.export("parts-json"), self.export("parts-json", **named)
        self.assertEqual(told.status, 200, told.body)
        drop = lambda answer: {k: v for k, v in answer.json().items() if "link" not in json.dumps(k) and k != "origin"}
        self.assertEqual(drop(plain).keys(), drop(told).keys())
        self.assertEqual(self.export("svg").body.count(b"<path"), self.export("svg", **named).body.count(b"<path"))

    def test_pictures_stand_as_the_job_says(self):
        job = self.server.wait(self.server.submit(arc(seed=77), up="-y", material="plywood")["jobID"])
        self.assertEqual([job["parameters"][name] for name in ("up", "material")], ["-y", "plywood"])
        base = f"/api/v1/jobs/{job['jobID']}/exports"
        usual = {p["name"]: p["default"] for p in self.server.get(base).json()["parameters"]}
        self.assertEqual(usual["up"], "-y")
        drawn = {up: self.server.get(f"{base}/pdf{up}").body for up in ("", "?up=-y", "?up=z")}
        self.assertEqual(drawn[""], drawn["?up=-y"])
        self.assertNotEqual(drawn[""], drawn["?up=z"])

    def test_the_query_changes_the_file(self):
        plain = self.export("svg").body
        for name, value in [("profile", "lightburn"), ("kerf", "0.5"), ("rulings", "none"), ("sheet_size", "a3"), ("copies", "2")]:
            answer = self.export("svg", **{name: value})
            self.assertEqual(answer.status, 200, answer.body[:300])
            self.assertNotEqual(answer.body, plain, name)

    def test_files_tell_where_they_come_from(self):
        text = self.export("svg", kerf="0.5", profile="boxes").body.decode()
        for part in [self.job["jobID"], self.job["inputs"]["mesh"]["sha256"], f"http://127.0.0.1:{self.server.port}{self.base}/svg?kerf=0.5"]:
            self.assertIn(part, text)

    def test_conditions_and_ranges(self):
        whole = self.export("pdf")
        tag = whole.headers["ETag"]
        same = self.export("pdf", {"If-None-Match": tag})
        self.assertEqual((same.status, same.body), (304, b""))
        self.assertEqual(self.export("pdf", {"If-Modified-Since": "Mon, 01 Jan 2035 00:00:00 GMT"}).status, 200)
        self.assertEqual(self.export("pdf", {"If-Match": '"other"'}).status, 412)
        part = self.export("pdf", {"Range": "bytes=100-199", "If-Range": tag})
        self.assertEqual((part.status, part.body), (206, whole.body[100:200]))
        self.assertEqual(self.export("pdf", {"Range": "bytes=99999999-"}).status, 416)
        head = self.server.request("HEAD", self.base + "/pdf")
        self.assertEqual((head.body, head.headers["Content-Length"]), (b"", str(len(whole.body))))
        self.assertEqual(self.export("pdf", inline="1").headers["Content-Disposition"].split(";")[0], "inline")

    def test_several_sheets_are_one_archive(self):
        answer = self.export("svg", sheet_size="210x297", copies="8")
        self.assertEqual(answer.headers["Content-Type"], "application/zip")
        with zipfile.ZipFile(io.BytesIO(answer.body)) as archive:
            self.assertIsNone(archive.testzip())
            names = archive.namelist()
        self.assertGreater(len(names), 1)
        one = self.export("svg", sheet_size="210x297", copies="8", sheet="2")
        self.assertEqual(one.headers["Content-Type"], "image/svg+xml")

    def test_wrong_wishes(self):
        for query in [{"kerf": "x"}, {"kerf": "-1"}, {"nonsense": "1"}, {"tabs": "yes"}, {"sheet_size": "5x5"}, {"profile": "nobody"},
                      {"material": "cheese"}, {"sheet_size": "20x20"}, {"turns": "1e9"}, {"page_margin": "1e300"}]:
            with self.subTest(query=query):
                answer = self.export("pdf", **query)
                self.assert_problem(answer, 400, "invalid-query-parameter-value")
                self.assertTrue(answer.json()["where"])
        self.assert_problem(self.export("svg", sheet="99"), 400, "invalid-query-parameter-value")
        self.assert_problem(self.export("parts-dxf", part="Z9"), 400, "invalid-query-parameter-value")
        self.assert_problem(self.server.get(self.base + "/svg?kerf=1&kerf=2"), 400, "invalid-query-parameter-value")
        self.assert_problem(self.export("exe"), 404, "no-such-output")
        self.assert_problem(self.server.get("/api/v1/jobs/00000000-0000-7000-8000-000000000000/exports/svg"), 404, "no-such-job")

    def test_the_parameter_that_was_meant_is_told(self):
        for name, meant in [("kerfs", "kerf"), ("kref", "kerf"), ("paper", "thickness"), ("sheetsize", "sheet_size"),
                            ("ruling", "rulings"), ("sheet_siez", "sheet_size"), ("nonsense", None), ("x" * 500, None)]:
            with self.subTest(name=name[:20]):
                problem = self.server.get(f"{self.base}/svg?{name}=1").json()
                self.assertEqual((problem["status"], problem["where"]), (400, name[:60]))
                self.assertIn("there are ", problem["fix"])
                told = re.findall(r"\w+", problem["fix"].split("; ")[0]) if "may mean" in problem["fix"] else [None]
                self.assertIn(meant, told)

    def test_malicious_texts_stay_texts(self):
        answer = self.export("svg", part="<script>alert(1)</script>")
        self.assertNotIn(b"<script>", answer.body)

    def test_many_at_once(self):
        from concurrent.futures import ThreadPoolExecutor
        with ThreadPoolExecutor(12) as pool:
            answers = list(pool.map(lambda i: self.export("svg", kerf=str(i / 100 + 0.01)), range(12)))
        self.assertEqual({a.status for a in answers}, {200})
        self.assertEqual(len({a.body for a in answers}), 12)


class OtherJobs(ServerCase):
    def test_results_that_have_nothing_to_draw(self):
        job = self.server.wait(self.server.submit()["jobID"])["jobID"]
        self.assert_problem(self.server.get(f"/api/v1/jobs/{job}/exports/svg"), 404, "no-such-output")
        waiting = self.server.submit(name="work-5000.obj")["jobID"]
        self.assert_problem(self.server.get(f"/api/v1/jobs/{waiting}/exports"), 404, "result-not-ready")
        failed = self.server.wait(self.server.submit(name="refuse.obj")["jobID"])["jobID"]
        self.assert_problem(self.server.get(f"/api/v1/jobs/{failed}/exports/svg"), 422, "unsupported-mesh")


class OwnProfiles(unittest.TestCase):
    def test_the_operators_own(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "profiles.json")
            with open(path, "w") as f:
                json.dump({"profiles": [{"name": "our-laser", "text": "The one by the door", "like": "boxes",
                                         "layers": {"cut_outer": {"colour": "#12ab34"}}}]}, f)
            with Server("--profiles", path, fake=False) as server:
                job = server.wait(server.submit(arc())["jobID"])["jobID"]
                drawn = server.get(f"/api/v1/jobs/{job}/exports/svg?profile=our-laser")
                self.assertIn(b"#12ab34", drawn.body)
                listed = server.get(f"/api/v1/jobs/{job}/exports").json()["parameters"]
                self.assertIn("our-laser", next(p for p in listed if p["name"] == "profile")["choices"])


if __name__ == "__main__":
    main()
