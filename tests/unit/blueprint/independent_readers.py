#!/usr/bin/env python3
"""Reads what write_exports wrote with programs that are not ours and compares what they find.

Usage: independent_readers.py WRITE_EXPORTS FOLDER. Needs python3-ezdxf, xmllint, pdfinfo, pdftotext, qpdf; a reader that
is missing is named and counts as a failure, so that a pass means that all of them have read everything.
"""
import json
import math
import os
import re
import shutil
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

failures = []


def expect(holds, what):
    if not holds:
        failures.append(what)


def run(*command):
    if shutil.which(command[0]) is None:
        expect(False, "the reader %s is missing" % command[0])
        return ""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    expect(done.returncode == 0, "%s: %s" % (" ".join(command), done.stderr.decode(errors="replace").strip()))
    return done.stdout.decode(errors="replace")


def check_svg(folder, parts):
    for name in ("layout.svg", "sheet.svg", "tabs.svg"):
        run("xmllint", "--noout", "--nonet", os.path.join(folder, name))
    root = ElementTree.parse(os.path.join(folder, "sheet.svg")).getroot()
    box = [float(x) for x in root.get("viewBox").split()]
    expect(box == [0, 0, float(root.get("width")[:-2]), float(root.get("height")[:-2])], "sheet.svg: a unit is no millimetre")
    total, ids = 0, [e.get("id") for e in root.iter() if e.get("id")]
    expect(len(ids) == len(set(ids)), "sheet.svg: an id twice")
    for path in root.iterfind(".//{*}g[@data-op='cut_outer']/{*}path"):
        numbers = [float(x) for x in re.findall(r"-?[0-9.]+", path.get("d"))]
        points = list(zip(numbers[::2], numbers[1::2]))
        expect(path.get("d").endswith("Z"), "sheet.svg: an open cut")
        expect(all(0 <= x <= box[2] and 0 <= y <= box[3] for x, y in points), "sheet.svg: a cut off the page")
        total += length(points, True)
    expect(abs(total - parts["totals"]["cut_mm"]) < 0.01, "sheet.svg: %.4f mm of cut" % total)


def length(points, closed):
    ends = points[1:] + (points[:1] if closed else [])
    return sum(math.dist(a, b) for a, b in zip(points, ends))


def check_dxf(folder, parts):
    try:
        import ezdxf
    except ImportError:
        return expect(False, "the reader ezdxf is missing")
    for name, layer in (("sheet.r12.dxf", "CUT"), ("sheet.r2000.dxf", "IV_OUTER_PROFILE")):
        path = os.path.join(folder, name)
        document = ezdxf.readfile(path)
        audit = document.audit()
        expect(not audit.errors and not audit.fixes, "%s: ezdxf finds %d errors" % (path, len(audit.errors) + len(audit.fixes)))
        expect(document.units == 4, "%s: units are not millimetres" % path)
        cuts = []
        for entity in document.modelspace():
            expect(entity.dxf.color == 256 and entity.dxf.layer in document.layers, "%s: an entity is not by layer" % path)
            if entity.dxf.layer != layer:
                continue
            if entity.dxftype() == "POLYLINE":
                cuts.append(([tuple(v.dxf.location)[:2] for v in entity.vertices], entity.is_closed))
            else:
                cuts.append(([p[:2] for p in entity.get_points("xy")], entity.closed))
        expect(all(closed for _, closed in cuts), "%s: an open cut" % path)
        expect(len(cuts) == len(parts["parts"]), "%s: %d cuts" % (path, len(cuts)))
        total = sum(length(points, closed) for points, closed in cuts)
        expect(abs(total - parts["totals"]["cut_mm"]) < 0.01, "%s: %.4f mm of cut" % (path, total))


def longest_dark_run(rows):
    """Of pixels one beside the other, over all rows of a grey picture."""
    return max(len(run) for row in rows for run in re.findall(rb"[\x00-\x80]+", row))


def check_scale_box(path):
    """The box on the cover, measured on the page as poppler draws it at ten pixels a millimetre."""
    picture = path + ".cover"
    run("pdftoppm", "-r", "254", "-f", "1", "-l", "1", "-gray", "-singlefile", path, picture)
    with open(picture + ".pgm", "rb") as file:
        kind, size, _, pixels = file.read().split(b"\n", 3)
    width, height = [int(x) for x in size.split()]
    expect(kind == b"P5" and len(pixels) == width * height, path + ": no picture of the cover")
    upper = [pixels[y * width : (y + 1) * width] for y in range(height // 3)]
    expect(abs(longest_dark_run(upper) - 1000) <= 5, "%s: the box of 100 mm is %.1f mm wide" % (path, longest_dark_run(upper) / 10))
    columns = [bytes(row[x] for row in upper) for x in range(width // 2)]
    expect(abs(longest_dark_run(columns) - 500) <= 5, "%s: the box of 50 mm is %.1f mm high" % (path, longest_dark_run(columns) / 10))


def check_pdf(folder, parts):
    for name in ("sheet.pdf", "tiles.pdf"):
        path = os.path.join(folder, name)
        run("qpdf", "--check", path)
        text = run("pdftotext", "-layout", path, "-")
        for part in parts["parts"]:
            expect(part["label"] in text, "%s: part %s is in no list" % (path, part["label"]))
        expect("100 x 50 mm" in text, "%s: no scale box" % path)
        check_scale_box(path)
        expect('a "model" & more' in run("pdfinfo", path), "%s: another title" % path)
    sizes = set(re.findall(r"size:\s+([\d.]+) x ([\d.]+)", run("pdfinfo", "-f", "1", "-l", "99", os.path.join(folder, "tiles.pdf"))))
    expect(sizes == {("595.276", "841.89")}, "tiles.pdf: pages of %s points" % sizes)


def check_fold(folder):
    with open(os.path.join(folder, "all.fold"), encoding="utf-8") as file:
        fold = json.load(file)
    flat, solid = fold["vertices_coords"], fold["file_frames"][0]["vertices_coords"]
    for a, b in fold["edges_vertices"]:
        expect(abs(math.dist(flat[a], flat[b]) - math.dist(solid[a], solid[b])) < 1e-6, "all.fold: an edge changes its length")
    expect(len(fold["edges_vertices"]) == len(fold["edges_assignment"]) == len(fold["edges_foldAngle"]), "all.fold: lists of different length")


def check_zip(folder):
    with zipfile.ZipFile(os.path.join(folder, "all.zip")) as archive:
        expect(archive.testzip() is None, "all.zip: a broken member")
        names = archive.namelist()
        for wanted in ("sheet-1.svg", "sheet-1.dxf", "parts/A1.dxf", "blueprint.pdf", "blueprint.fold", "blueprint.obj", "result/ruled.obj", "result/layout.json", "frame.stl", "parts.json", "parts.csv"):
            expect(wanted in names, "all.zip: no " + wanted)


def main():
    writer, folder = sys.argv[1:]
    shutil.rmtree(folder, ignore_errors=True)
    subprocess.run([writer, folder], check=True)
    for model in sorted(os.listdir(folder)):
        here = os.path.join(folder, model)
        with open(os.path.join(here, "parts.json"), encoding="utf-8") as file:
            parts = json.load(file)
        check_svg(here, parts)
        check_dxf(here, parts)
        check_pdf(here, parts)
        check_fold(here)
        check_zip(here)
    for failure in failures[:20]:
        print(failure)
    print("%d failure(s)" % len(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
