"""Several tolerances in one job: the curve, and its points as jobs of their own."""
import base64
import csv
import hashlib
import io
import json
import re
import signal
import time

from harness import ServerCase, arc, main
from test_api import form

SWEEP = "/api/v1/processes/sweep/execution"
TOLERANCES = [0.005, 0.02, 0.06]
QUERY = "?e_max=0.02,0.005,0.06&effort=draft"


def bowl(around=16, up=5):
    """A shallow cap: more parts the closer one looks."""
    import math
    points = [(0, 0, 1.0)]
    for j in range(1, up + 1):
        for i in range(around):
            a, b = 2 * math.pi * i / around, 1.2 * j / up
            points.append((math.sin(b) * math.cos(a), math.sin(b) * math.sin(a), math.cos(b)))
    lines = ["v %.9f %.9f %.9f" % p for p in points]
    for i in range(around):
        n = (i + 1) % around
        lines.append(f"f 1 {2 + i} {2 + n}")
        for j in range(up - 1):
            a, b = 2 + j * around, 2 + (j + 1) * around
            lines += [f"f {a + i} {b + i} {b + n}", f"f {a + i} {b + n} {a + n}"]
    return ("\n".join(lines) + "\n").encode()


class Sweep(ServerCase):
    fake = False

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        answer = cls.server.request("POST", SWEEP + QUERY + "&tag=cap&filename=cap.obj", bowl())
        assert answer.status == 201, answer.body
        cls.accepted = answer.json()
        cls.job = cls.server.wait(answer.json()["jobID"])
        cls.base = f"/api/v1/jobs/{cls.job['jobID']}"

    def open(self, point, status):
        answer = self.server.request("POST", f"{self.base}/points/{point}")
        self.assertEqual(answer.status, status, answer.body)
        job = answer.json()
        self.assertTrue(answer.headers["Location"].endswith("/jobs/" + job["jobID"]))
        return job

    def test_the_job_shows_the_curve(self):
        self.assertEqual((self.accepted["processID"], self.accepted["parameters"]["e_max"]), ("sweep", TOLERANCES))
        self.assertEqual(self.job["status"], "successful", self.job)
        curve = self.job["report"]["curve"]
        self.assertEqual([p["point"] for p in curve], ["0.005", "0.02", "0.06"])
        for point, e_max in zip(curve, TOLERANCES):
            self.assertEqual(point["e_max"], e_max)
            self.assertTrue(point["e_max_met"])
            self.assertLessEqual(point["hausdorff"], e_max)
            self.assertGreater(point["cut_length"], 0)
        parts = [p["patches"] for p in curve]
        self.assertEqual(parts, sorted(parts, reverse=True))
        self.assertGreater(parts[0], parts[-1])

    def test_files_of_every_point_and_the_curve_as_files(self):
        files = self.server.get(self.base + "/results").json()
        each = [f"{p}-{n}" for p in ("0.005", "0.02", "0.06") for n in ("ruled.obj", "layout.json", "layout.svg")]
        self.assertEqual(set(files), {"sweep.json", "sweep.csv", *each})
        self.assertTrue(all(f["title"] for f in files.values()))
        document = self.server.get(files["sweep.json"]["href"]).json()
        self.assertEqual(document["schema"], "sheetform-sweep/1")
        rows = list(csv.DictReader(io.StringIO(self.server.get(files["sweep.csv"]["href"]).body.decode())))
        for point, row, told in zip(document["curve"], rows, self.job["report"]["curve"]):
            for name in ("e_max", "patches", "cut_length", "hausdorff", "e_max_met"):
                self.assertEqual(point[name], told[name])
                self.assertEqual(json.loads(row[name]), told[name])
            layout = self.server.get(files[point["point"] + "-layout.json"]["href"]).json()
            self.assertEqual(len(layout["patches"]), point["patches"])
            self.assertEqual(layout["parameters"]["e_max"], point["e_max"])

    def test_a_point_opens_as_a_job_without_being_computed_again(self):
        job = self.open("0.02", 201)
        self.assertEqual((job["status"], job["processID"], job["tag"]), ("successful", "decompose", "cap"))
        self.assertEqual(job["reusedFrom"], self.job["jobID"])
        self.assertEqual(job["attempt"], 0)
        self.assertEqual(job["parameters"], {**self.job["parameters"], "e_max": 0.02})
        told = dict(self.job["report"]["curve"][1])
        told.pop("point")
        self.assertEqual(job["report"], told)
        self.assertEqual(job["inputs"], self.job["inputs"])
        mine = self.server.get(f"/api/v1/jobs/{job['jobID']}/results").json()
        all_files = self.server.get(self.base + "/results").json()
        self.assertEqual(set(mine), {"ruled.obj", "layout.json", "layout.svg"})
        for name, file in mine.items():
            self.assertEqual(file["sha256"], all_files["0.02-" + name]["sha256"])
        self.assertEqual(self.open("0.02", 200)["jobID"], job["jobID"])
        pdf = self.server.get(f"/api/v1/jobs/{job['jobID']}/exports/pdf")
        self.assertTrue(pdf.body.startswith(b"%PDF"))

    def test_a_point_outlives_its_sweep(self):
        answer = self.server.request("POST", SWEEP + QUERY, bowl(around=15))
        sweep = self.server.wait(answer.json()["jobID"])
        point = self.server.request("POST", f"/api/v1/jobs/{sweep['jobID']}/points/0.06").json()
        self.server.request("DELETE", f"/api/v1/jobs/{sweep['jobID']}")
        files = self.server.get(f"/api/v1/jobs/{point['jobID']}/results").json()
        self.assertIn(b"<svg", self.server.get(files["layout.svg"]["href"]).body)
        gone = self.server.request("POST", f"/api/v1/jobs/{sweep['jobID']}/points/0.06")
        self.assert_problem(gone, 404, "no-such-job")

    def test_a_job_alone_does_not_get_the_result_of_a_sweep(self):
        """Same mesh and parameters give the same bytes: those of a decomposition on its own."""
        point = self.open("0.06", 201)
        alone = self.server.submit(bowl(), name="cap.obj", e_max=0.06, effort="draft")
        self.assertNotIn("reusedFrom", alone)
        self.server.wait(alone["jobID"])
        self.assertEqual(self.open("0.06", 200)["jobID"], point["jobID"])

    def test_the_same_sweep_again_is_answered_at_once(self):
        again = self.server.request("POST", SWEEP + "?e_max=0.06,0.02,0.005&effort=draft", bowl()).json()
        self.assertEqual((again["status"], again["reusedFrom"]), ("successful", self.job["jobID"]))
        self.assertEqual(again["report"], self.job["report"])

    def test_what_is_no_point(self):
        for point in ("0.03", "0.020", "", "../results", "0.02-layout.svg", "%00", "x" * 300):
            with self.subTest(point=point):
                self.assertIn(self.server.request("POST", f"{self.base}/points/{point}").status, (400, 404, 405))
        plain = self.server.submit(arc())
        self.server.wait(plain["jobID"])
        answer = self.server.request("POST", f"/api/v1/jobs/{plain['jobID']}/points/0.02")
        self.assert_problem(answer, 404, "no-such-output")
        for export in ("", "/pdf"):
            answer = self.server.get(self.base + "/exports" + export)
            self.assert_problem(answer, 404, "no-such-output")
            self.assertIn("point", answer.json()["fix"])
        self.assertNotIn("exports", [link["rel"] for link in self.job["links"]])

    def test_wrong_tolerances_are_refused_with_where_and_fix(self):
        for query in ("", "?e_max=", "?e_max=0.02,", "?e_max=0.02,0.02", "?e_max=0.02,0.7", "?e_max=a",
                      "?e_max=0.02&e_max_mm=1", "?e_max=" + ",".join(str(0.01 * k) for k in range(1, 12))):
            with self.subTest(query=query):
                answer = self.server.request("POST", SWEEP + query, arc())
                self.assert_problem(answer, 422, "invalid-parameter")
                self.assertIn(answer.json()["where"], ("e_max", "e_max_mm"))
                self.assertTrue(answer.json()["fix"])
        self.assert_problem(self.server.request("POST", "/api/v1/processes/decompose/execution?e_max=0.02,0.05", arc()),
                            422, "invalid-parameter")

    def test_the_three_forms_of_a_request(self):
        body, kind = form([("e_max", None, b"0.03,0.05"), ("mesh", "a.obj", arc(seed=7))])
        by_form = self.server.request("POST", SWEEP, body, {"Content-Type": kind})
        document = {"inputs": {"mesh": base64.b64encode(arc(seed=7)).decode(), "e_max": [0.05, 0.03]}}
        by_json = self.server.request("POST", SWEEP, json.dumps(document), {"Content-Type": "application/json"})
        for answer in (by_form, by_json):
            self.assertEqual(answer.status, 201, answer.body)
            self.assertEqual(answer.json()["parameters"]["e_max"], [0.03, 0.05])
        self.assert_problem(self.server.request("POST", SWEEP, *_without_tolerances()), 422, "invalid-parameter")

    def test_listed_by_process(self):
        for process in ("sweep", "decompose"):
            listed = self.server.get(f"/api/v1/jobs?processID={process}").json()["jobs"]
            self.assertTrue(all(job["processID"] == process for job in listed))
        self.assertTrue(self.server.get("/api/v1/jobs?processID=sweep").json()["jobs"])

    def test_a_killed_server_takes_the_sweep_up_again(self):
        answer = self.server.request("POST", SWEEP + "?e_max=0.01,0.02,0.04", bowl(around=24, up=8))
        self.server.wait(answer.json()["jobID"], until=("running", "successful"))
        self.server.restart(signal.SIGKILL)
        job = self.server.wait(answer.json()["jobID"])
        self.assertEqual(job["status"], "successful", job)
        self.assertEqual(len(job["report"]["curve"]), 3)


class OutOfTime(ServerCase):
    """A sweep whose time runs out: the limit is so many times what one tolerance takes here and now. On a machine that
    others use now is soon over; then another mesh is tried."""
    fake = False
    TOLERANCES = [0.002 + 0.0001 * k for k in range(10)]  # each as much work as the other

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        unlimited = cls.server.options
        for around in range(64, 68):
            cls.mesh, begun = bowl(around=around, up=24), time.monotonic()
            cls.server.wait(cls.server.submit(cls.mesh, name="cap.obj", e_max=cls.TOLERANCES[0])["jobID"])
            seconds = time.monotonic() - begun
            cls.server.options = [*unlimited, "--job-seconds", str(max(1, round(3.5 * seconds)))]
            cls.server.restart(signal.SIGTERM)
            cls.job = cls.server.wait(cls.submit()["jobID"])
            if cls.job.get("report", {}).get("missing"):
                return

    @classmethod
    def submit(cls):
        query = "?e_max=" + ",".join(f"{e:.4f}" for e in cls.TOLERANCES)
        return cls.server.request("POST", SWEEP + query, cls.mesh).json()

    def test_the_finished_points_are_its_result(self):
        self.assertEqual(self.job["status"], "successful", self.job)
        curve, missing = self.job["report"]["curve"], self.job["report"]["missing"]
        self.assertGreater(len(curve), 0)
        self.assertGreater(len(missing), 0)
        self.assertEqual([p["e_max"] for p in curve] + missing, [round(e, 4) for e in self.TOLERANCES])
        self.assertIn(f"{len(curve)} of 10", self.job["message"])
        self.assertIn(f"{len(curve)} of 10", self.job["report"]["notes"][0])
        files = self.server.get(f"/api/v1/jobs/{self.job['jobID']}/results").json()
        self.assertEqual(len(files), 2 + 3 * len(curve))
        for file in files.values():
            self.assertEqual(hashlib.sha256(self.server.get(file["href"]).body).hexdigest(), file["sha256"])
        self.assertEqual(self.server.get(files["sweep.json"]["href"]).json()["missing"], missing)

    def test_a_finished_point_opens_and_a_missing_one_does_not(self):
        base = f"/api/v1/jobs/{self.job['jobID']}/points/"
        opened = self.server.request("POST", base + self.job["report"]["curve"][0]["point"])
        self.assertEqual((opened.status, opened.json()["status"]), (201, "successful"))
        gone = self.server.request("POST", base + str(self.job["report"]["missing"][0]))
        self.assert_problem(gone, 404, "no-such-output")

    def test_it_is_not_the_answer_to_the_same_sweep_again(self):
        again = self.submit()
        self.assertNotIn("reusedFrom", again)
        self.server.request("DELETE", f"/api/v1/jobs/{again['jobID']}")


class Finished(ServerCase):
    """A sweep that is ended by wish keeps its points; a cancelled one has none."""
    fake = False
    options = ("--slots", "1")
    TOLERANCES = [0.016 + 0.0005 * k for k in range(8)]  # each about half a second of work

    def begin(self, seed):
        """A sweep that runs, and a function that waits until it has come to its k-th tolerance."""
        query = "?e_max=" + ",".join(f"{e:.4f}" for e in self.TOLERANCES)
        job = self.server.request("POST", SWEEP + query, bowl(around=36 + seed, up=12)).json()["jobID"]
        self.server.wait(job, until=("running",))

        def at(k):
            while True:
                now = self.server.job(job)
                self.assertEqual(now["status"], "running", "it was too quick for this test")
                step = re.search(r"tolerance (\d+) of", now.get("message", ""))
                if step and int(step.group(1)) >= k:
                    return
                time.sleep(0.02)
        return job, at

    def finish(self, job):
        return self.server.request("POST", f"/api/v1/jobs/{job}/finish")

    def test_what_is_found_is_kept(self):
        job, at = self.begin(0)
        at(2)
        self.assertEqual(self.finish(job).status, 200)
        ended = self.server.wait(job)
        self.assertEqual(ended["status"], "successful", ended)
        report = ended["report"]
        self.assertTrue(report["stopped"])
        self.assertGreaterEqual(len(report["curve"]), 1)
        self.assertGreater(len(report["missing"]), 0)
        self.assertEqual([p["e_max"] for p in report["curve"]] + report["missing"], [round(e, 4) for e in self.TOLERANCES])
        self.assertIn("stopped", ended["message"])
        self.assertIn("stopped after", report["notes"][0])
        files = self.server.get(f"/api/v1/jobs/{job}/results").json()
        self.assertEqual(len(files), 2 + 3 * len(report["curve"]))
        opened = self.server.request("POST", f"/api/v1/jobs/{job}/points/{report['curve'][0]['point']}")
        self.assertEqual((opened.status, opened.json()["status"]), (201, "successful"))
        self.assertEqual(self.finish(job).json()["status"], "successful", "asked once too often")

    def test_before_the_first_point_it_ends_with_that(self):
        job, _ = self.begin(1)
        self.assertEqual(self.finish(job).status, 200)
        report = self.server.wait(job)["report"]
        self.assertEqual((len(report["curve"]), report["stopped"]), (1, True))

    def test_a_restart_forgets_the_wish_and_loses_no_point(self):
        job, at = self.begin(4)
        at(2)
        self.assertEqual(self.finish(job).status, 200)
        self.server.restart(signal.SIGKILL)
        ended = self.server.wait(job)
        if ended["attempt"] == 1:
            self.skipTest("it had ended before the kill")
        self.assertEqual(len(ended["report"]["curve"]), len(self.TOLERANCES))
        self.assertNotIn("stopped", ended["report"])

    def test_a_cancel_still_cancels(self):
        job, at = self.begin(2)
        at(2)
        self.finish(job)
        self.assertIn(self.server.request("DELETE", f"/api/v1/jobs/{job}").json()["status"], ("dismissed", "successful"))

    def test_what_cannot_be_finished(self):
        job, _ = self.begin(3)
        waits = self.server.request("POST", SWEEP + QUERY, bowl(around=21)).json()["jobID"]
        plain = self.server.submit(bowl(around=22), e_max=0.02)["jobID"]
        for other, words in ((waits, "accepted"), (plain, "no sweep")):
            answer = self.finish(other)
            self.assert_problem(answer, 409, "conflict")
            self.assertIn(words, answer.json()["detail"])
            self.assertIn("DELETE", answer.json()["fix"])
        for one in (waits, plain, job):
            self.server.request("DELETE", f"/api/v1/jobs/{one}")
        self.assert_problem(self.finish(job), 409, "conflict")
        self.assert_problem(self.finish("00000000-0000-4000-8000-000000000000"), 404, "no-such-job")


def _without_tolerances():
    body, kind = form([("mesh", "a.obj", arc())])
    return body, {"Content-Type": kind}


if __name__ == "__main__":
    main()
