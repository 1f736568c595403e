#!/usr/bin/env python3
"""The test of the test: each rule finds a violation planted in a small tree, and a clean tree passes."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import house_rules


def rules_broken_by(files):
    """Findings of a tree that consists of `files` (path -> text), as 'path:line: rule' strings."""
    with tempfile.TemporaryDirectory() as root:
        for path, text in files.items():
            full = os.path.join(root, path)
            os.makedirs(os.path.dirname(full), exist_ok=True)
            with open(full, "w", encoding="utf-8") as stream:
                stream.write(text)
        return [f"{name}:{number}: {rule}" for name, number, rule in house_rules.findings(root)]


class HouseRules(unittest.TestCase):
    def assert_found(self, path, text, expected):
        found = rules_broken_by({path: text})
        self.assertEqual(len(found), 1, found)
        self.assertIn(expected, found[0])

    def assert_clean(self, path, text):
        self.assertEqual(rules_broken_by({path: text}), [])

    def test_arrow_upwards_in_core(self):
        self.assert_found("core/sheetform/mesh/a.h", '#include "sheetform/strip/strip_mesh.h"\n', "mesh may not include strip")
        self.assert_found("core/sheetform/strip/a.h", '#include "sheetform/search/b.h"\n', "strip may not include search")
        self.assert_clean("core/sheetform/search/a.h", '#include "sheetform/strip/strip_mesh.h"\n')

    def test_unknown_folder_of_core(self):
        self.assert_found("core/sheetform/extra/a.h", '#include "sheetform/mesh/a.h"\n', "without a place in the order")

    def test_facade_is_for_blueprint_sources(self):
        self.assert_clean("core/sheetform/blueprint/a.cpp", '#include "sheetform/decompose.h"\n')
        self.assert_found("core/sheetform/blueprint/a.h", '#include "sheetform/decompose.h"\n', "facade")
        self.assert_found("core/sheetform/search/a.cpp", '#include "sheetform/decompose.h"\n', "facade")

    def test_core_and_proto_are_strangers(self):
        self.assert_found("core/sheetform/base/a.h", '#include "sheetform_api/job.h"\n', "core includes only core")
        self.assert_found("proto/sheetform_api/a.h", '#include "sheetform/base/error.h"\n', "proto knows nothing")

    def test_only_mapping_knows_both(self):
        both = '#include "sheetform/decompose.h"\n#include "sheetform_api/job.h"\n'
        self.assert_found("server/jobs/a.cpp", both, "only server/mapping")
        self.assert_clean("server/mapping/a.cpp", both)

    def test_libraries_stay_in_their_folders(self):
        for path, header, name in [
                ("proto/sheetform_api/a.h", "Eigen/Dense", "Eigen"),
                ("core/sheetform/strip/a.cpp", "OpenMesh/Core/Mesh/Handles.hh", "OpenMesh"),
                ("core/sheetform/mesh/a.cpp", "nlohmann/json.hpp", "nlohmann"),
                ("core/sheetform/blueprint/a.h", "nlohmann/json.hpp", "nlohmann"),
                ("core/sheetform/base/a.cpp", "spdlog/spdlog.h", "spdlog"),
                ("server/jobs/a.cpp", "sqlite3.h", "SQLite"),
                ("server/jobs/b.cpp", "SQLiteCpp/Database.h", "SQLite"),
                ("server/jobs/c.cpp", "httplib.h", "httplib")]:
            self.assert_found(path, f"#include <{header}>\n", name)
        self.assert_clean("server/store/a.cpp", "#include <SQLiteCpp/Database.h>\n")

    def test_httplib_only_writes_answers(self):
        for line, rule in [("httplib::Client c(host);", "client"), ("httplib::SSLClient c(host);", "client"),
                           ("httplib::ClientImpl c(host);", "client"), ("httplib::Server s;", "private base"),
                           ("class A : public httplib::Server {", "private base"), ("std::unique_ptr<httplib::SSLServer> s;", "private base"),
                           ("class A : private httplib::Server {", "server has no place"), ("backend.bind_to_port(host, 80);", "listen"),
                           ("using namespace httplib;", "written out"), ("using httplib::Request;", "written out")]:
            self.assert_found("server/http/a.cpp", line + "\n", rule)
        self.assert_clean("server/http/guard_server.cpp", "class A : private httplib::Server {\n  using httplib::Stream::write;\n};\n")
        self.assert_clean("server/http/health_client.cpp", "httplib::Client c(host);\n")
        self.assert_found("server/http/guard_server.cpp", "httplib::Client c(host);\n", "client")
        self.assert_clean("tests/unit/server/a.cpp", "httplib::Client c(host);\n")

    def test_product_code_is_free_of_test_code(self):
        self.assert_found("core/sheetform/mesh/a.cpp", "#include <gtest/gtest.h>\n", "test code")

    def test_library_never_ends_prints_or_gambles(self):
        for line in ["std::exit(1);", "abort();", 'std::cout << "x";', 'printf("x");', "int r = rand();",
                     "std::random_device d;"]:
            found = rules_broken_by({"core/sheetform/mesh/a.cpp": f"void f() {{ {line} }}\n"})
            self.assertEqual(len(found), 1, (line, found))
        self.assert_clean("core/sheetform/mesh/a.cpp",
                          "// exit(1) and std::cout are words here\nvoid f() { operand(brand(2)); mesh.exit(); }\n")
        self.assert_found("core/CMakeLists.txt", "add_compile_options(-ffast-math)\n", "vary")
        self.assert_found("core/CMakeLists.txt", "file(GLOB sources *.cpp)\n", "listed by name")

    def test_sizes(self):
        self.assert_found("web/a.js", "x;\n" * 701, "file of 701 lines")
        body = "  step();\n" * 79
        self.assert_found("core/sheetform/mesh/a.cpp", "void f() {\n" + body + "}\n", "function of 81 lines")
        self.assert_found("core/sheetform/mesh/a.cpp", "void f(int a,\n       int b) {\n" + body + "}\n", "function of 82")
        self.assert_clean("core/sheetform/mesh/a.cpp", "void f() {\n" + "  step();\n" * 78 + "}\n")
        self.assert_clean("core/sheetform/mesh/a.h",
                          "class A {\n  void g() {\n    h();\n  }\n" + "  int member();\n" * 100 + "};\n")

    def test_what_must_never_be_committed(self):
        self.assert_found("README.md", "see /home" + "/somebody/notes\n", "path of a machine")
        self.assert_found("web/package-lock.json", '{"reso' + 'lved": "https:' + '//x.example/a.tgz"}\n', "registry")
        self.assert_found("docker/a.sh", "curl https:/" + "/mirror.example/x\n", "mirror")
        self.assert_found("core/sheetform/mesh/a.cpp", "// TO" + "DO later\n", "left open")

    def test_root_is_fixed(self):
        self.assert_found("scripts/a.sh", "true\n", "no place at the root")
        self.assert_clean(".ci/run", "true\n")


if __name__ == "__main__":
    unittest.main()
