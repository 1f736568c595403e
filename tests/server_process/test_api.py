"""The resources of the API: from upload to download, and every wrong turn."""
import base64
import hashlib
import io
import json
import time
import urllib.parse
import zipfile

from harness import EXECUTION, TRIANGLE, Contract, Server, ServerCase, arc, main, unique_mesh


def form(parts):
    """A multipart body: (name, filename or None, bytes)."""
    boundary = "----test1234567890"
    body = b""
    for name, filename, content in parts:
        disposition = f'form-data; name="{name}"' + (f'; filename="{filename}"' if filename is not None else "")
        body += f"--{boundary}\r\nContent-Disposition: {disposition}\r\n\r\n".encode() + content + b"\r\n"
    return body + f"--{boundary}--\r\n".encode(), f"multipart/form-data; boundary={boundary}"


class RealPipeline(ServerCase):
    fake = False

    def test_upload_to_result(self):
        mesh = arc()
        job = self.server.submit(mesh, name="arc.obj", e_max=0.02, tag="first")
        self.assertEqual(job["inputs"]["mesh"]["sha256"], hashlib.sha256(mesh).hexdigest())
        self.assertEqual((job["inputs"]["mesh"]["vertices"], job["inputs"]["mesh"]["faces"]), (54, 80))
        self.assertEqual(job["inputs"]["mesh"]["format"], "obj")
        self.assertEqual(job["parameters"]["e_max"], 0.02)
        self.assertEqual(job["tag"], "first")
        job = self.server.wait(job["jobID"])
        self.assertEqual(job["status"], "successful", job)
        self.assertEqual(job["progress"], 100)
        self.assertGreaterEqual(job["report"]["patches"], 1)
        results = self.server.get(f"/api/v1/jobs/{job['jobID']}/results").json()
        self.assertLessEqual({"ruled.obj", "layout.json", "layout.svg"}, set(results))
        for name, entry in results.items():
            content = self.server.get(entry["href"]).body
            self.assertEqual(len(content), entry["length"], name)
            self.assertEqual(hashlib.sha256(content).hexdigest(), entry["sha256"], name)
        layout = json.loads(self.server.get(results["layout.json"]["href"]).body)
        self.assertEqual(layout["schema"], "sheetform-layout/1")

    def test_inch_and_size_are_echoed(self):
        job = self.server.submit(arc(), name="arc.obj", scale=25.4)
        self.assertEqual(job["inputs"]["mesh"]["unitAssumed"], "1 unit = 25.4 mm")
        job = self.server.submit(arc(), name="arc.obj", target_size=500)
        self.assertAlmostEqual(max(job["inputs"]["mesh"]["sizeMm"]), 500, places=6)
        self.server.request("DELETE", f"/api/v1/jobs/{job['jobID']}")

    def test_sandbox_of_the_real_worker_refuses_everything(self):
        sandbox = self.server.get("/version").json()["sandbox"]
        self.assertEqual({k for k, refused in sandbox.items() if not refused}, set(), sandbox)


class Uploads(ServerCase):
    def test_multipart(self):
        body, kind = form([("mesh", "C:\\meshes\\work-20 \u202egpj.obj", unique_mesh()), ("e_max", None, b"0.1"),
                           ("tag", None, b"form"), ("seed", None, b"")])
        answer = self.server.request("POST", EXECUTION, body, {"Content-Type": kind})
        self.assertEqual(answer.status, 201)
        job = answer.json()
        self.assertEqual((job["parameters"]["e_max"], job["tag"]), (0.1, "form"))
        self.assertEqual(job["inputs"]["mesh"]["name"], "work-20 gpj.obj")

    def test_multipart_with_request_part(self):
        body, kind = form([("request", None, b'{"inputs": {"e_max": 0.05, "t_junctions": false}, "tag": "r"}'),
                           ("mesh", "a.obj", unique_mesh())])
        job = self.server.request("POST", EXECUTION, body, {"Content-Type": kind}).json()
        self.assertEqual((job["parameters"]["e_max"], job["parameters"]["t_junctions"], job["tag"]), (0.05, False, "r"))

    def test_json(self):
        mesh = unique_mesh()
        body = json.dumps({"inputs": {"mesh": {"value": base64.b64encode(mesh).decode(), "filename": "j.obj"},
                                      "creases": "off"}, "tag": "json"})
        job = self.server.request("POST", EXECUTION, body, {"Content-Type": "application/json"}).json()
        self.assertEqual(job["inputs"]["mesh"]["sha256"], hashlib.sha256(mesh).hexdigest())
        self.assertEqual((job["parameters"]["creases"], job["tag"]), ("off", "json"))

    def test_chunked(self):
        mesh = unique_mesh()
        def pieces():
            for i in range(0, len(mesh), 7):
                yield mesh[i:i + 7]
        answer = self.server.request("POST", EXECUTION, pieces(), {"Content-Type": "model/obj"})
        self.assertEqual(answer.status, 201)
        self.assertEqual(answer.json()["inputs"]["mesh"]["sha256"], hashlib.sha256(mesh).hexdigest())

    def test_location_leads_to_the_job(self):
        answer = self.server.request("POST", EXECUTION, unique_mesh())
        path = urllib.parse.urlparse(answer.headers["Location"]).path
        self.assertEqual(self.server.get(path).json()["jobID"], answer.json()["jobID"])

    def test_input_comes_back(self):
        mesh = unique_mesh()
        job = self.server.submit(mesh, name="back.obj")
        answer = self.server.get(f"/api/v1/jobs/{job['jobID']}/input")
        self.assertEqual(answer.body, mesh)
        self.assertIn('filename="back.obj"', answer.headers["Content-Disposition"])

    def test_digest_of_the_body(self):
        mesh = unique_mesh()
        right = base64.b64encode(hashlib.sha256(mesh).digest()).decode()
        wrong = base64.b64encode(hashlib.sha256(b"x").digest()).decode()
        headers = {"Content-Digest": f"sha-256=:{right}:"}
        self.assertEqual(self.server.request("POST", EXECUTION, mesh, headers).status, 201)
        headers = {"Content-Digest": f"sha-256=:{wrong}:"}
        self.assert_problem(self.server.request("POST", EXECUTION, mesh, headers), 400, "digest-mismatch")

    def test_wrong_bodies(self):
        js = {"Content-Type": "application/json"}
        body, kind = form([("e_max", None, b"0.1")])
        twice, _ = form([("mesh", "a.obj", TRIANGLE), ("mesh", "b.obj", TRIANGLE)])
        cases = [(b"{", js, 400, "malformed-request"),
                 (b'{"inputs":{}}', js, 400, "malformed-request"),
                 (b'{"inputs":{"mesh":"###"}}', js, 400, "malformed-request"),
                 (b'{"inputs":{"mesh":"","e_max":1,"e_max":2}}', js, 400, "malformed-request"),
                 (b'{"inputs":{"mesh":"QQ=="},"outputs":{"nix":{}}}', js, 400, "malformed-request"),
                 (b'{"inputs":{"mesh":"QQ=="},"response":"raw"}', js, 400, "malformed-request"),
                 (b"[" * 100000, js, 400, "malformed-request"),
                 (b'{"inputs":{"mesh":{"href":"http://169.254.169.254/"}}}', js, 422, "remote-input-disabled"),
                 (b"x", {"Content-Type": "image/png"}, 415, "unsupported-media-type"),
                 (b"x", {"Content-Encoding": "gzip"}, 415, "unsupported-media-type"),
                 (body, {"Content-Type": kind}, 400, "malformed-request"),
                 (twice, {"Content-Type": kind}, 400, "malformed-request"),
                 (body[:-10], {"Content-Type": kind}, 400, "malformed-request"),
                 (b"", {"Content-Type": "multipart/form-data"}, 400, "malformed-request")]
        for content, headers, status, slug in cases:
            with self.subTest(content=content[:60], headers=headers):
                self.assert_problem(self.server.request("POST", EXECUTION, content, headers), status, slug)

    def test_too_much_json_may_come_as_it_is(self):
        head = f"POST {EXECUTION} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 20000000\r\n\r\n"
        answer = self.server.raw(head.encode())
        self.assertIn(b" 413 ", answer.split(b"\r\n")[0])
        problem = json.loads(answer.split(b"\r\n\r\n", 1)[1])
        self.assertIn("20000000", problem["detail"])
        self.assertIn("in a form", problem["fix"])

    def test_wrong_parameters(self):
        for query, where in [("e_max=7", "e_max"), ("e_max=abc", "e_max"), ("emax=0.1", "emax"), ("e_max=0.1&e_max=0.2", "e_max"),
                             ("max_sides=9", "max_sides"), ("effort=extreme", "effort"), ("tag=" + "x" * 101, "tag"),
                             ("symmetry=1,2", "symmetry"), ("cache=never", "cache")]:
            with self.subTest(query=query):
                answer = self.server.request("POST", f"{EXECUTION}?{query}", TRIANGLE)
                self.assert_problem(answer, 422, "invalid-parameter")
                self.assertEqual(answer.json()["where"], where)
                self.assertTrue(answer.json()["fix"])


class Jobs(ServerCase):
    options = ("--slots", "2")

    def test_unknown_things(self):
        zero = "00000000-0000-0000-0000-000000000000"
        for path, slug in [("/api/v1/nothing", "not-found"), ("/api/v1/jobs/" + zero, "no-such-job"),
                           ("/api/v1/jobs/x'--", "no-such-job"), (f"/api/v1/jobs/{zero}/results", "no-such-job"),
                           ("/api/v1/processes/fold", "no-such-process")]:
            with self.subTest(path=path):
                self.assert_problem(self.server.get(path), 404, slug)
        self.assert_problem(self.server.request("POST", "/api/v1/processes/fold/execution", TRIANGLE), 404, "no-such-process")

    def test_wrong_method_says_what_is_allowed(self):
        answer = self.server.request("PUT", "/api/v1/jobs", b"x")
        self.assert_problem(answer, 405, "method-not-allowed")
        self.assertEqual(answer.headers["Allow"], "GET, HEAD")

    def pages(self, path, rel):
        """The page at `path` and those that its links of this kind lead to."""
        found = []
        while path:
            found.append(self.server.get(path).json())
            path = next((link["href"] for link in found[-1]["links"] if link["rel"] == rel), None)
        return found

    def test_list_filters_and_pages(self):
        tag = f"list-{time.time()}"
        ids = [self.server.submit(tag=tag)["jobID"] for _ in range(7)]
        for job_id in ids:
            self.server.wait(job_id)
        pages = self.pages(f"/api/v1/jobs?limit=3&tag={tag}", "next")
        self.assertEqual([len(p["jobs"]) for p in pages], [3, 3, 1])
        self.assertEqual([job["jobID"] for page in pages for job in page["jobs"]], ids[::-1])
        self.assertFalse(any(link["rel"] == "prev" for link in pages[0]["links"]))
        back = self.pages(next(link["href"] for link in pages[-1]["links"] if link["rel"] == "self"), "prev")
        self.assertEqual([[job["jobID"] for job in p["jobs"]] for p in back], [[job["jobID"] for job in p["jobs"]] for p in pages[::-1]])
        self.assertEqual(len(self.pages(next(l["href"] for l in back[-1]["links"] if l["rel"] == "self"), "next")), 3)
        count = lambda query: len(self.server.get(f"/api/v1/jobs?tag={tag}&limit=100&{query}").json()["jobs"])
        self.assertEqual(count("status=successful"), 7)
        self.assertEqual(count("status=failed,running"), 0)
        self.assertEqual(count("processID=decompose&type=process"), 7)
        self.assertEqual(count("processID=other"), 0)
        self.assertEqual(count("datetime=2020-01-01T00:00:00Z/.."), 7)
        self.assertEqual(count("datetime=../2020-01-01T00:00:00Z"), 0)
        self.assertEqual(count("minDuration=1000"), 0)
        self.assertEqual(count("maxDuration=1000"), 7)

    def test_wrong_queries(self):
        for query in ["limit=0", "limit=x", "limit=10001", "status=done", "datetime=yesterday", "foo=1", "cursor=zzz",
                      "type=coverage", "limit=1&limit=2", "minDuration=-1", "tag=%zz", "cursor=_1_"]:
            with self.subTest(query=query):
                self.assert_problem(self.server.get(f"/api/v1/jobs?{query}"), 400, "invalid-query-parameter-value")

    def test_cursor_belongs_to_its_filters(self):
        for _ in range(2):
            self.server.wait(self.server.submit(tag="cursor")["jobID"])
        page = self.server.get("/api/v1/jobs?limit=1&tag=cursor").json()
        following = next(link["href"] for link in page["links"] if link["rel"] == "next")
        self.assert_problem(self.server.get(following.replace("tag=cursor", "tag=other")), 400, "invalid-query-parameter-value")

    def test_results_before_the_end(self):
        job = self.server.submit(name="work-20000.obj")
        answer = self.server.get(f"/api/v1/jobs/{job['jobID']}/results")
        self.assert_problem(answer, 404, "result-not-ready")
        self.assertTrue(answer.json()["retryable"])
        self.server.request("DELETE", f"/api/v1/jobs/{job['jobID']}")

    def test_failed_job_answers_with_its_problem(self):
        job = self.server.wait(self.server.submit(name="refuse.obj")["jobID"])
        self.assertEqual(job["status"], "failed")
        self.assertEqual(job["exception"]["where"], "face 7")
        answer = self.server.get(f"/api/v1/jobs/{job['jobID']}/results")
        self.assertEqual((answer.status, answer.slug()), (422, "unsupported-mesh"))
        self.assertEqual(answer.json()["fix"], "cut it open")

    def test_dismiss_and_remove(self):
        job = self.server.submit(name="work-20000.obj")["jobID"]
        self.server.wait(job, until=("running",))
        answer = self.server.request("DELETE", f"/api/v1/jobs/{job}")
        self.assertEqual((answer.status, answer.json()["status"]), (200, "dismissed"))
        self.assertEqual(self.server.job(job)["status"], "dismissed")
        self.assertEqual(self.server.request("DELETE", f"/api/v1/jobs/{job}").status, 200)
        self.assert_problem(self.server.get(f"/api/v1/jobs/{job}"), 404, "no-such-job")
        self.assert_problem(self.server.request("DELETE", f"/api/v1/jobs/{job}"), 404, "no-such-job")

    def test_retry(self):
        job = self.server.wait(self.server.submit(name="refuse.obj")["jobID"])["jobID"]
        answer = self.server.request("POST", f"/api/v1/jobs/{job}/retry", b"")
        self.assertEqual(answer.status, 200)
        self.assertIn(answer.json()["status"], ("accepted", "running"))  # a free slot takes it at once
        self.assertEqual(self.server.wait(job)["attempt"], 2)
        good = self.server.wait(self.server.submit()["jobID"])["jobID"]
        self.assert_problem(self.server.request("POST", f"/api/v1/jobs/{good}/retry", b""), 409, "conflict")

    def test_prefer_wait(self):
        begun = time.monotonic()
        answer = self.server.request("POST", f"{EXECUTION}?filename=work-300.obj", unique_mesh(), {"Prefer": "respond-async, wait=20"})
        self.assertEqual(answer.json()["status"], "successful")
        self.assertEqual(answer.headers["Preference-Applied"], "wait=20")
        self.assertGreater(time.monotonic() - begun, 0.25)
        job = self.server.submit(name="work-20000.obj")["jobID"]
        self.server.wait(job, until=("running",))
        begun = time.monotonic()
        self.assertEqual(self.server.get(f"/api/v1/jobs/{job}", Prefer="wait=1").json()["status"], "running")
        self.assertGreater(time.monotonic() - begun, 0.9)
        self.server.request("DELETE", f"/api/v1/jobs/{job}")

    def test_idempotency(self):
        mesh = unique_mesh()
        send = lambda body, e_max: self.server.request("POST", f"{EXECUTION}?e_max={e_max}", body, {"Idempotency-Key": "key-1"})
        first, again = send(mesh, 0.1), send(mesh, 0.1)
        self.assertEqual((first.status, again.status), (201, 201))
        self.assertEqual(first.json()["jobID"], again.json()["jobID"])
        self.assertIsNone(first.headers["Idempotency-Replayed"])
        self.assertEqual(again.headers["Idempotency-Replayed"], "true")
        self.assert_problem(send(unique_mesh(), 0.1), 422, "idempotency-mismatch")
        self.assert_problem(send(mesh, 0.2), 422, "idempotency-mismatch")
        answer = self.server.request("POST", EXECUTION, mesh, {"Idempotency-Key": "has space"})
        self.assert_problem(answer, 400, "malformed-request")

    def test_result_is_reused(self):
        mesh = unique_mesh()
        first = self.server.wait(self.server.submit(mesh)["jobID"])
        second = self.server.submit(mesh)
        self.assertEqual((second["status"], second["reusedFrom"]), ("successful", first["jobID"]))
        a, b = (self.server.get(f"/api/v1/jobs/{j['jobID']}/results").json() for j in (first, second))
        self.assertEqual({n: e["sha256"] for n, e in a.items()}, {n: e["sha256"] for n, e in b.items()})
        self.assertNotIn("reusedFrom", self.server.submit(mesh, cache="refresh"))
        self.assertNotIn("reusedFrom", self.server.submit(mesh, e_max=0.3))
        # The result outlives the job that it was made by.
        self.server.request("DELETE", f"/api/v1/jobs/{first['jobID']}")
        self.assertEqual(self.server.get(b["big.bin"]["href"]).body[-3:], b"end")

    def test_log(self):
        job = self.server.wait(self.server.submit(name="refuse.obj")["jobID"])
        answer = self.server.get(f"/api/v1/jobs/{job['jobID']}/log")
        self.assertIn(b"start 1: refused", answer.body)


class FirstSteps(ServerCase):
    """What new users of curl do wrong; each answer says what to do instead."""
    fake = False

    def fix(self, body, query="", **headers):
        answer = self.server.request("POST", EXECUTION + query, body, {k.replace("_", "-"): v for k, v in headers.items()})
        self.assertGreaterEqual(answer.status, 400)
        return answer.json()["fix"]

    def test_form_data_of_curl(self):
        body = arc().replace(b"\n", b"")  # as `curl -d @mesh.obj` sends it
        self.assertIn("--data-binary", self.fix(body, Content_Type="application/x-www-form-urlencoded"))

    def test_part_of_another_name(self):
        part = b'--b\r\nContent-Disposition: form-data; name="file"; filename="a.obj"\r\n\r\n' + arc() + b"\r\n--b--\r\n"
        self.assertIn("-F mesh=@", self.fix(part, Content_Type="multipart/form-data; boundary=b"))

    def test_misspelt_parameter(self):
        self.assertIn("e_max", self.fix(arc(), "?emax=0.1"))

    def test_parameter_by_another_name(self):
        for name, meant in [("unit", "scale (Millimetres for one unit)"), ("units", "scale"), ("tolerance", "e_max (Tolerance)"),
                            ("size", "target_size")]:
            self.assertIn("may mean " + meant, self.fix(arc(), f"?{name}=1"))
            document = json.dumps({"inputs": {"mesh": base64.b64encode(arc()).decode(), name: 1}}).encode()
            self.assertIn(meant, self.fix(document, Content_Type="application/json"))
        self.assertNotIn("may mean", self.fix(arc(), "?colour=red"))

    def test_percent_and_units(self):
        self.assertIn("0.02 is 2 %", self.fix(arc(), "?e_max=2"))
        self.assertIn("(mm)", self.fix(arc(), "?target_size=300mm"))

    def test_name_of_the_file_instead_of_the_file(self):
        part = b'--b\r\nContent-Disposition: form-data; name="mesh"\r\n\r\nmy lamp.STL\r\n--b--\r\n'
        self.assertIn("with the @", self.fix(part, Content_Type="multipart/form-data; boundary=b"))

    def test_mesh_called_json(self):
        self.assertIn("--data-binary", self.fix(arc(), Content_Type="application/json"))

    def test_empty_variable_in_an_address(self):
        answer = self.server.get("/api/v1/jobs//results")
        self.assert_problem(answer, 400, "malformed-request")
        self.assertIn("variable", answer.json()["fix"])

    def test_picture(self):
        picture = b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 4
        answer = self.server.request("POST", EXECUTION, picture)
        self.assert_problem(answer, 422, "unreadable-mesh")
        self.assertIn("picture", answer.json()["detail"])

    def test_path_instead_of_content(self):
        self.assertIn("base64", self.fix(b'{"inputs":{"mesh":"arc.obj"}}', Content_Type="application/json"))

    def test_nothing_at_all(self):
        self.assertIn("OBJ", self.fix(b""))


class Downloads(ServerCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.job = cls.server.wait(cls.server.submit()["jobID"])["jobID"]
        cls.base = f"/api/v1/jobs/{cls.job}/results"
        cls.big = cls.base + "/big.bin"
        cls.content = b"x" * 700000 + b"end"

    def test_tag_and_conditions(self):
        answer = self.server.get(self.big)
        tag = answer.headers["ETag"]
        self.assertEqual(answer.body, self.content)
        self.assertEqual(tag, f'"sha256-{hashlib.sha256(self.content).hexdigest()}"')
        for headers, status in [({"If-None-Match": tag}, 304), ({"If-None-Match": "W/" + tag}, 304), ({"If-None-Match": "*"}, 304),
                                ({"If-None-Match": '"a", ' + tag}, 304), ({"If-None-Match": '"a"'}, 200),
                                ({"If-Match": tag}, 200), ({"If-Match": '"a"'}, 412), ({"If-Match": "W/" + tag}, 412),
                                ({"If-Modified-Since": answer.headers["Last-Modified"]}, 304),
                                ({"If-Modified-Since": "Mon, 01 Jan 2001 00:00:00 GMT"}, 200)]:
            with self.subTest(headers=headers):
                again = self.server.request("GET", self.big, headers=headers)
                self.assertEqual(again.status, status)
                if status == 304:
                    self.assertEqual(again.body, b"")
                    self.assertEqual(again.headers["ETag"], tag)
                    self.assertIsNone(again.headers["Content-Length"])

    def test_ranges(self):
        n, whole = len(self.content), self.content
        for field, expected in [("bytes=0-0", whole[:1]), ("bytes=10-19", whole[10:20]), (f"bytes={n - 5}-", whole[-5:]),
                                ("bytes=-3", b"end"), (f"bytes=-{n + 10}", whole), (f"bytes=262140-262150", whole[262140:262151]),
                                (f"bytes={n - 1}-99999999999999999999999", whole[-1:]), ("bytes=0-", whole)]:
            with self.subTest(field=field):
                answer = self.server.get(self.big, Range=field)
                self.assertEqual((answer.status, answer.body), (206, expected))
                begin = n - len(expected) if field.startswith("bytes=-") else int(field[6:].split("-")[0])
                self.assertEqual(answer.headers["Content-Range"], f"bytes {begin}-{begin + len(expected) - 1}/{n}")
        for field in [f"bytes={n}-", f"bytes={n + 100}-{n + 200}", "bytes=-0", "bytes=99999999999999999999-"]:
            with self.subTest(field=field):
                answer = self.server.get(self.big, Range=field)
                self.assert_problem(answer, 416, "range-not-satisfiable")
                self.assertEqual(answer.headers["Content-Range"], f"bytes */{n}")
        for field in ["bytes=0-1,5-6", "items=0-1", "bytes=5-2", "bytes=a-b", "bytes=", "bytes=--1", "bytes=1", ""]:
            with self.subTest(field=field):
                self.assertEqual(self.server.get(self.big, Range=field).body, whole)

    def test_if_range(self):
        tag = self.server.get(self.big).headers["ETag"]
        self.assertEqual(self.server.get(self.big, Range="bytes=0-4", If_Range=tag).status, 206)
        self.assertEqual(self.server.get(self.big, Range="bytes=0-4", If_Range='"old"').status, 200)

    def test_head(self):
        answer = self.server.request("HEAD", self.big)
        self.assertEqual((answer.status, answer.body, answer.headers["Content-Length"]), (200, b"", str(len(self.content))))

    def test_empty_file(self):
        answer = self.server.get(self.base + "/empty.txt")
        self.assertEqual((answer.status, answer.body, answer.headers["Content-Length"]), (200, b"", "0"))
        self.assertEqual(self.server.get(self.base + "/empty.txt", Range="bytes=0-").status, 416)

    def test_zip(self):
        for path, headers in [(self.base + "?f=zip", {}), (self.base, {"Accept": "application/zip"})]:
            answer = self.server.request("GET", path, headers=headers)
            self.assertEqual(answer.headers["Content-Type"], "application/zip")
            with zipfile.ZipFile(io.BytesIO(answer.body)) as archive:
                self.assertIsNone(archive.testzip())
                self.assertEqual(archive.namelist(), ["layout.svg", "big.bin", "empty.txt"])
                self.assertEqual(archive.read("big.bin"), self.content)
        part = self.server.get(self.base + "?f=zip", Range="bytes=1000-1999")
        self.assertEqual(part.body, answer.body[1000:2000])
        some = self.server.get(self.base + "?f=zip&outputs=layout.svg").body
        self.assertEqual(zipfile.ZipFile(io.BytesIO(some)).namelist(), ["layout.svg"])

    def test_choice_of_outputs(self):
        self.assertEqual(list(self.server.get(self.base + "?outputs=big.bin").json()), ["big.bin"])
        self.assert_problem(self.server.get(self.base + "?outputs=passwd"), 404, "no-such-output")
        self.assert_problem(self.server.get(self.base + "/passwd"), 404, "no-such-output")

    def test_disposition_and_policy(self):
        answer = self.server.get(self.base + "/layout.svg")
        self.assertTrue(answer.headers["Content-Disposition"].startswith('attachment; filename="layout.svg"'))
        self.assertIn("sandbox", answer.headers["Content-Security-Policy"])
        shown = self.server.get(self.base + "/layout.svg?inline=1")
        self.assertTrue(shown.headers["Content-Disposition"].startswith("inline"))
        kept = self.server.get(self.base + "/big.bin?inline=1")
        self.assertTrue(kept.headers["Content-Disposition"].startswith("attachment"))
        self.assertEqual(answer.headers["X-Content-Type-Options"], "nosniff")


class Description(ServerCase):
    def test_landing_page_leads_everywhere(self):
        page = self.server.get("/api/v1/").json()
        for link in page["links"]:
            if link["href"] != "/":
                self.assertEqual(self.server.get(link["href"]).status, 200, link)

    def test_conformance(self):
        classes = self.server.get("/api/v1/conformance").json()["conformsTo"]
        for name in ("core", "json", "oas30", "job-list", "dismiss", "ogc-process-description"):
            self.assertIn(f"http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/{name}", classes)

    def test_process(self):
        process = self.server.get("/api/v1/processes/decompose").json()
        self.assertEqual(process["jobControlOptions"], ["async-execute", "dismiss"])
        self.assertEqual(process["inputs"]["e_max"]["schema"]["default"], 0.02)
        listed = self.server.get("/api/v1/processes").json()["processes"]
        self.assertEqual([p["id"] for p in listed], ["decompose", "sweep"])

    def places(self):
        """Every described GET that needs a token where there are tokens: its address for a finished job, its parameters."""
        job = self.server.wait(self.server.submit()["jobID"])
        fill = {"jobID": job["jobID"], "processID": "decompose", "output": "big.bin", "format": "svg"}
        contract = json.loads(self.server.get("/api/v1/api").body)
        resolve = Contract(contract).resolve
        for path, item in contract["paths"].items():
            if "get" not in item or item["get"].get("security") == [{}]:
                continue
            parameters = [resolve(p) for p in item.get("parameters", []) + item["get"].get("parameters", [])]
            yield path.format(**fill), [p for p in parameters if p["in"] == "query"]

    def test_queries_hold_what_is_described_and_nothing_else(self):
        def refused(address, where):
            answer = self.server.get(address)
            self.assert_problem(answer, 400, "invalid-query-parameter-value")
            self.assertEqual(answer.json()["where"], where, address)
        checked = 0
        for path, parameters in self.places():
            if path.endswith("/guides"):
                continue  # there are none
            refused(f"{path}?nix=1", "nix")
            is_open = any(p["schema"]["type"] == "object" for p in parameters)
            for p in parameters:
                name, schema = p["name"], p["schema"]
                good = schema.get("enum", [])
                bad = ["nix"] if good else []
                if schema["type"] == "integer":
                    good = [str(schema["minimum"]), str(schema["maximum"])]
                    bad = ["x", "", "1.5", str(schema["minimum"] - 1), str(schema["maximum"] + 1)]
                for value in bad:
                    refused(f"{path}?{name}={value}", name)
                for value in [] if is_open else good:
                    self.assertEqual(self.server.get(f"{path}?{name}={value}").status, 200, f"{path} {name}={value}")
                    refused(f"{path}?{name}={value}&{name}={value}", name)
                    checked += 1
        self.assertGreater(checked, 15)
        self.assertEqual(self.server.get("/healthz?at=12").status, 200)

    def test_length_of_the_list_of_processes(self):
        self.assertEqual([p["id"] for p in self.server.get("/api/v1/processes?limit=1").json()["processes"]], ["decompose"])

    def test_limits_and_health(self):
        limits = self.server.get("/api/v1/limits").json()
        self.assertEqual(limits["uploadBytes"], 256 << 20)
        described = json.loads(self.server.get("/api/v1/api").body)["components"]["schemas"]["Limits"]["properties"]
        self.assertEqual(set(limits), set(described))
        self.assertEqual(self.server.get("/healthz").json()["status"], "ok")
        self.assertEqual(self.server.get("/readyz").json()["status"], "ok")

    def test_metrics(self):
        self.server.wait(self.server.submit()["jobID"])
        upload = 'sheetform_http_requests_total{route="/api/v1/processes/{processID}/execution",method="POST",code="201"}'
        self.server.until("the upload is counted", lambda: upload in self.server.get("/metrics").body.decode())  # after its answer
        text = self.server.get("/metrics").body.decode()
        for state in ("accepted", "running", "successful", "failed", "dismissed"):
            self.assertIn(f'sheetform_jobs{{state="{state}"}}', text)
        for line in text.splitlines():
            self.assertRegex(line, r'^(# (HELP|TYPE) .+|[a-z_]+(\{([a-z]+="[^"]*",?)*\})? [0-9.e+-]+)$')

    def test_request_ids(self):
        self.assertEqual(self.server.get("/healthz", X_Request_Id="my-id.7").headers["X-Request-Id"], "my-id.7")
        strange = self.server.get("/healthz", X_Request_Id="a b").headers["X-Request-Id"]
        self.assertRegex(strange, "^[0-9a-f]{16}$")
        self.assertNotEqual(strange, self.server.get("/healthz").headers["X-Request-Id"])


class Page(ServerCase):
    def test_policy_and_tags(self):
        answer = self.server.get("/")
        if answer.status == 404:
            self.skipTest("built without a page")
        self.assertEqual(answer.headers["Content-Type"], "text/html; charset=utf-8")
        self.assertIn("default-src 'none'", answer.headers["Content-Security-Policy"])
        again = self.server.get("/", If_None_Match=answer.headers["ETag"])
        self.assertEqual((again.status, again.body), (304, b""))

    def test_only_files_of_the_page(self):
        for path in ["/../etc/passwd", "/%2e%2e/etc/passwd", "/index.html/..", "/assets/", "/.lock", "/sheetform.db"]:
            with self.subTest(path=path):
                self.assertIn(self.server.get(path).status, (400, 404))


if __name__ == "__main__":
    main()
