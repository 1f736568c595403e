"""server/run: what it makes of its options. The build and the program are stand-ins, the script is the real one."""
import os
import shutil
import subprocess
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


class Run(unittest.TestCase):
    def setUp(self):
        self.root = tempfile.mkdtemp(prefix="sheetform-run-")
        self.addCleanup(shutil.rmtree, self.root)
        os.makedirs(self.root + "/server")
        shutil.copy(ROOT + "/server/run", self.root + "/server/run")
        self.put("docker/install-packages", "")
        self.put("web/build", "")
        self.put("bin/cmake", "")
        self.put("build/release/build.ninja", "")
        self.put("build/release/sheetform", 'printf "%s\\n" "$@" > arguments\n')

    def put(self, path, script):
        whole = os.path.join(self.root, path)
        os.makedirs(os.path.dirname(whole), exist_ok=True)
        with open(whole, "w") as f:
            f.write("#!/bin/sh\n" + script)
        os.chmod(whole, 0o755)

    def arguments(self, *options, **environment):
        """What the program is started with."""
        env = dict({k: v for k, v in os.environ.items() if not k.startswith("SHEETFORM_")}, HOME=self.root + "/user",
                   PATH=f"{self.root}/bin:{os.environ['PATH']}", **environment)
        env.pop("XDG_DATA_HOME", None)
        done = subprocess.run([self.root + "/server/run", *options], env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.said = done.stdout.decode()
        self.assertEqual(done.returncode, 0, self.said)
        with open(self.root + "/arguments") as f:
            return f.read().splitlines()

    def value(self, arguments, option):
        self.assertEqual(sum(a == option or a.startswith(option + "=") for a in arguments), 1, arguments)
        at = next(i for i, a in enumerate(arguments) if a.startswith(option))
        return arguments[at].split("=", 1)[1] if "=" in arguments[at] else arguments[at + 1]

    def test_without_options_it_serves_this_machine(self):
        arguments = self.arguments()
        self.assertEqual(arguments[0], "serve")
        self.assertEqual(self.value(arguments, "--listen"), "127.0.0.1:8080")
        self.assertEqual(self.value(arguments, "--data"), self.root + "/user/.local/share/sheetform")

    def test_an_option_of_the_user_wins(self):
        for option in (["--listen", "127.0.0.1:9000"], ["--listen=127.0.0.1:9000"]):
            arguments = self.arguments(*option, "--slots", "2", SHEETFORM_LISTEN="127.0.0.1:7000")
            self.assertEqual(self.value(arguments, "--listen"), "127.0.0.1:9000")
            self.assertEqual(self.value(arguments, "--slots"), "2")
            self.assertIn("http://127.0.0.1:9000,", self.said)
        folder = self.root + "/a folder"
        self.assertEqual(self.value(self.arguments("--data", folder), "--data"), folder)
        self.assertTrue(os.path.isdir(folder))

    def test_the_environment_is_next(self):
        arguments = self.arguments(SHEETFORM_LISTEN="127.0.0.1:7000", SHEETFORM_DATA=self.root + "/store")
        self.assertEqual(self.value(arguments, "--listen"), "127.0.0.1:7000")
        self.assertEqual(self.value(arguments, "--data"), self.root + "/store")

    def test_build_only_serves_nothing(self):
        with self.assertRaises(FileNotFoundError):
            self.arguments("--build-only")


if __name__ == "__main__":
    unittest.main(verbosity=2)
