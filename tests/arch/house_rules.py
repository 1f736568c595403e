#!/usr/bin/env python3
"""The rules of the house that a machine can check: which folder may include which, what the library must
never call, how long files and functions may grow, what must never be committed.

Usage: house_rules.py [ROOT]. Prints one line per finding (file:line: rule) and exits 1 when there is any.
Reads text only, needs nothing but the standard library, and takes well under a second.
"""
import os
import re
import subprocess
import sys

# One-way rule inside core: a folder includes itself and the folders before it in this list.
CORE_ORDER = ["base", "mesh", "field", "tracing", "layout", "ruling", "morph", "strip", "search", "blueprint"]
ROOT_ENTRIES = {"CMakeLists.txt", "core", "server", "proto", "web", "tests", "docker", "README.md", "LICENSE"}
MAX_FILE_LINES = 700
MAX_FUNCTION_LINES = 80

# Libraries that stay inside their folders. A file outside core, proto and server (tests, benchmarks) is free.
LIBRARIES = [
    ("Eigen", r"^(unsupported/)?Eigen/", lambda p: not p.startswith("proto/")),
    ("OpenMesh", r"^OpenMesh/", lambda p: p.startswith("core/sheetform/mesh/")),
    ("nlohmann-json", r"^nlohmann/", lambda p: re.match(r"(core/sheetform/blueprint/.*\.cpp$|proto/|server/)", p)),
    ("spdlog", r"^(spdlog|fmt)/", lambda p: p.startswith("server/")),
    ("SQLite", r"^(SQLiteCpp/|sqlite3)", lambda p: p.startswith("server/store/")),
    ("cpp-httplib", r"^httplib", lambda p: p.startswith("server/http/")),
]
# The stock server and client of cpp-httplib read what strangers send, and not strictly enough: nothing but writing
# answers is left to it, behind a base class that nobody can call, and one client that asks our own server for its health.
HTTPLIB = [
    (r"\bhttplib\s*::\s*\w*Client\w*", "server/http/health_client.cpp", "httplib's client has no place here"),
    (r"(?<!: private )\bhttplib\s*::\s*(SSL)?Server\b", None, "httplib's server is a private base class, or nothing"),
    (r": private httplib::Server\b", "server/http/guard_server.cpp", "httplib's server has no place here"),
    (r"\b(bind_to_(any_)?port|listen_after_bind|set_(file_)?mount_point|set_base_dir)\b", None, "httplib does not listen here"),
    (r"\busing\s+(namespace\s+httplib\b|httplib::\w+\s*;)|\bnamespace\s+\w+\s*=\s*httplib\b", None, "names of httplib are written out"),
]
# What a library must not do to the program it lives in, and what would make results differ from run to run.
FORBIDDEN_IN_CORE = [
    (r"(?<![\w.>])(std::)?(_?exit|quick_exit|abort|terminate)\s*\(", "ends the program"),
    (r"std::(cout|cerr|clog)\b|(?<!\w)(std::)?(f?printf|puts)\s*\(", "prints (report through RunContext)"),
    (r"(?<![\w:.>])(std::)?s?rand\s*\(|std::random_device|\brandom_shuffle\b", "random without a seed of ours"),
    (r"ffast-math|Ofast|fp-contract=fast|#pragma\s+(GCC|STDC)\s+(optimize|FP_CONTRACT)", "lets results vary"),
]
SOURCE = (".cpp", ".h")
TEXT = SOURCE + (".js", ".mjs", ".py", ".css", ".html", ".md", ".txt", ".json", ".yaml", ".yml", ".cmake", ".sh", "")
LEAKS = [
    (r"(^|[^\w.])/(work|home|root|Users)/[A-Za-z.]", "path of a machine"),
    (r'"resolved"\s*:\s*"http', "address of a package registry"),
    (r"https?://[^\s\"']*(registry|mirror)", "address of a package registry or mirror"),
]


def tracked_files(root):
    """Paths below root, with '/': what git tracks, or every file where root is no repository."""
    if os.path.exists(os.path.join(root, ".git")):  # a file in a second worktree
        listed = subprocess.run(["git", "-C", root, "ls-files", "-z"], stdout=subprocess.PIPE, check=True).stdout
        names = [name for name in listed.decode().split("\0") if name]
        return [name for name in names if os.path.isfile(os.path.join(root, name))]
    found = []
    for folder, folders, files in os.walk(root):
        folders[:] = sorted(f for f in folders if f not in ("build", "node_modules", "dist", ".git"))
        found += [os.path.relpath(os.path.join(folder, f), root).replace(os.sep, "/") for f in files]
    return sorted(found)


def without_comments(text):
    """C++ text with comments and string contents blanked, line numbers kept."""
    def blank(match):
        whole = match.group(0)
        if whole.startswith("/"):
            return re.sub(r"[^\n]", " ", whole)
        return whole[0] + " " * (len(whole) - 2) + whole[-1]
    pattern = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\''
    return re.sub(pattern, blank, text, flags=re.S)


def includes(text):
    for number, line in enumerate(text.split("\n"), 1):
        match = re.match(r'\s*#\s*include\s*[<"]([^>"]+)[>"]', line)
        if match:
            yield number, match.group(1)


def core_folder(path):
    match = re.match(r"(?:core/)?sheetform/(\w+)/", path)
    return match.group(1) if match else None


def check_core_include(path, target):
    """The rule broken by a file of core that includes `target`, or None."""
    if target.startswith("sheetform_api/") or re.match(r"(server|proto|web)/", target):
        return "core includes only core"
    mine, theirs = core_folder(path), core_folder(target)
    if target == "sheetform/decompose.h":
        allowed = mine is None or (mine == "blueprint" and path.endswith(".cpp"))
        return None if allowed else "only blueprint/*.cpp may include the facade decompose.h"
    if theirs is None or mine is None:
        return None
    if theirs not in CORE_ORDER or mine not in CORE_ORDER:
        return "folder of core without a place in the order (tests/arch/house_rules.py)"
    if CORE_ORDER.index(theirs) > CORE_ORDER.index(mine):
        return f"{mine} may not include {theirs}: the arrows point from {theirs} to {mine}"
    return None


def check_include(path, target):
    if path.startswith("core/"):
        broken = check_core_include(path, target)
        if broken:
            return broken
    if path.startswith("proto/") and re.match(r"(sheetform|server|web)/", target):
        return "proto knows nothing of core, server or web"
    if path.startswith(("core/", "proto/", "server/")):
        for name, pattern, allowed in LIBRARIES:
            if re.match(pattern, target) and not allowed(path):
                return f"{name} has no place here"
        if target.startswith(("tests/", "support/", "gtest/", "gmock/")):
            return "product code includes test code"
    return None


def check_both_sides(path, targets):
    """server/mapping alone knows both core's data and the messages of proto."""
    if not path.startswith("server/") or path.startswith("server/mapping/"):
        return None
    core = [t for t in targets if t.startswith("sheetform/") and not t.startswith("sheetform/base/")]
    wire = [t for t in targets if t.startswith("sheetform_api/")]
    if core and wire:
        return f"includes {core[0]} and {wire[0]}: only server/mapping knows both core and proto"
    return None


def long_functions(text):
    """(line, length) of functions at column 0 (namespaces are not indented) longer than allowed."""
    start = head = None  # the body's function; a signature that goes on over several lines
    for number, line in enumerate(text.split("\n"), 1):
        ends_open = line.rstrip().endswith("{")
        if line.startswith("}"):
            if start is not None and number - start + 1 > MAX_FUNCTION_LINES:
                yield start, number - start + 1
            start = head = None
        elif start is None and re.match(r"[A-Za-z~]", line):
            opens = not re.match(r"(namespace|struct|class|enum|union|extern|using)\b", line) and "(" in line
            head = number if opens else None
            if head and ends_open:
                start = head
        elif start is None and head and ends_open:
            start = head
        elif start is None and line.rstrip().endswith(";"):
            head = None


def check_source(path, text):
    bare = without_comments(text)
    targets = list(includes(text))
    for number, target in targets:
        broken = check_include(path, target)
        if broken:
            yield number, f"{broken} (#include {target})"
    broken = check_both_sides(path, [target for _, target in targets])
    if broken:
        yield 1, broken
    if path.startswith("core/"):
        for number, line in enumerate(bare.split("\n"), 1):
            for pattern, why in FORBIDDEN_IN_CORE:
                if re.search(pattern, line):
                    yield number, f"{why}: {line.strip()[:60]}"
    if path.startswith(("core/", "proto/", "server/")):
        for number, line in enumerate(bare.split("\n"), 1):
            for pattern, home, why in HTTPLIB:
                if path != home and re.search(pattern, line):
                    yield number, f"{why}: {line.strip()[:60]}"
        for number, length in long_functions(bare):
            yield number, f"function of {length} lines (at most {MAX_FUNCTION_LINES})"


def check_text(path, text):
    lines = text.split("\n")
    if path.endswith(SOURCE + (".js", ".mjs", ".py", ".css")) and len(lines) - 1 > MAX_FILE_LINES:
        yield len(lines) - 1, f"file of {len(lines) - 1} lines (at most {MAX_FILE_LINES})"
    for number, line in enumerate(lines, 1):
        for pattern, why in LEAKS:
            if re.search(pattern, line):
                yield number, f"{why}: {line.strip()[:60]}"
        if re.search(r"\b(TO" r"DO|FIX" r"ME)\b", line):
            yield number, "left open: say it in an issue, not in the tree"


def check_build_file(path, text):
    if not path.startswith("core/"):
        return
    for number, line in enumerate(text.split("\n"), 1):
        line = line.split("#")[0]
        if re.search(r"ffast-math|-Ofast|fp-contract=fast|-march=native", line):
            yield number, "lets results vary from machine to machine"
        if re.search(r"file\s*\(\s*GLOB", line):
            yield number, "sources are listed by name, not globbed"


def check_root(names):
    for name in sorted({n.split("/")[0] for n in names}):
        if name not in ROOT_ENTRIES and not name.startswith("."):
            yield name, 0, "no place at the root (fixed by the owner)"


def findings(root):
    names = tracked_files(root)
    yield from check_root(names)
    for name in names:
        extension = os.path.splitext(name)[1]
        if extension not in TEXT or name == "LICENSE" or name.startswith("tests/data/"):
            continue
        try:
            with open(os.path.join(root, name), encoding="utf-8") as stream:
                text = stream.read()
        except UnicodeDecodeError:
            continue
        for number, rule in check_text(name, text):
            yield name, number, rule
        if extension in SOURCE:
            for number, rule in check_source(name, text):
                yield name, number, rule
        if name.endswith(("CMakeLists.txt", ".cmake")):
            for number, rule in check_build_file(name, text):
                yield name, number, rule


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(__file__), "..", "..")
    found = list(findings(os.path.abspath(root)))
    for name, number, rule in found:
        print(f"{name}:{number}: {rule}")
    print(f"house rules: {len(found)} finding(s)")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
