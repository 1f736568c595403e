"""The lines of the README and the client in Python, as they stand there, against a real server."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

from harness import ServerCase, arc, main

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
CLIENT = os.path.join(ROOT, "proto", "client.py")


def readme_lines(start):
    with open(os.path.join(ROOT, "README.md")) as f:
        return [line.strip() for line in f if line.startswith("    " + start)]


class Readme(ServerCase):
    fake = False

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        with open(os.path.join(self.folder.name, "lamp.stl"), "wb") as f:
            f.write(arc(seed=1))  # the format is found from the bytes, not from the name

    def tearDown(self):
        self.folder.cleanup()

    def shell(self, line, job=""):
        line = line.replace("127.0.0.1:8080", f"127.0.0.1:{self.server.port}").replace("proto/client.py", CLIENT)
        line = re.sub(r"^curl", "curl -sS --fail-with-body --max-time 600", line)
        done = subprocess.run(["bash", "-c", line], cwd=self.folder.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              env=dict(os.environ, JOB=job), timeout=900)
        self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout.decode()}\n{done.stderr.decode()}")
        return done.stdout

    def content(self, name):
        with open(os.path.join(self.folder.name, name), "rb") as f:
            return f.read()

    def test_lines_of_curl(self):
        lines = readme_lines("curl ")
        self.assertGreater(len(lines), 8)
        job = json.loads(self.shell(lines[0]))["jobID"]
        answers = [self.shell(line, job) for line in lines[1:]]
        self.assertIn(b"successful", answers[0])  # the events, to their end
        self.assertEqual(json.loads(answers[1])["status"], "successful")
        self.assertIn("layout.svg", json.loads(answers[2]))
        self.assertEqual(json.loads(answers[-1])["status"], "dismissed")
        self.assertIn(b"<svg", self.content("layout.svg"))
        self.assertTrue(self.content("all.zip").startswith(b"PK"))
        self.assertTrue(self.content("pages.pdf").startswith(b"%PDF"))

    def test_client(self):
        with open(CLIENT) as f:
            self.assertLessEqual(len(f.readlines()), 30)
        (line,) = readme_lines("python3 proto/client.py")
        self.shell(line)
        names = os.listdir(os.path.join(self.folder.name, "lamp"))
        self.assertEqual(set(names), {"layout.svg", "layout.json", "ruled.obj"})
        self.assertIn(b"<svg", self.content("lamp/layout.svg"))

    def test_client_says_what_is_wrong(self):
        run = lambda *arguments: subprocess.run(
            [sys.executable, CLIENT, f"http://127.0.0.1:{self.server.port}", *arguments], cwd=self.folder.name,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=900)
        done = run("lamp.stl", "out", "e_max=-1")
        self.assertEqual(done.returncode, 1)
        self.assertIn(b"e_max", done.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.folder.name, "out")))
        with open(os.path.join(self.folder.name, "letter.stl"), "wb") as f:
            f.write(b"Dear Sir or Madam\n")
        self.assertIn(b"mesh", run("letter.stl", "out").stderr)


if __name__ == "__main__":
    main()
