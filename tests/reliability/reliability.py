#!/usr/bin/env python3
"""How dependable the service is, with figures. Every trial starts real server processes and treats them badly.

    reliability.py [--short] [--only T1 T7 ...] [--seed N] [--kills N] [--drain] [--soak MINUTES] [--report FILE]

The long form takes about an hour and a half on two cores; --short is the part of it that the default tests run. In the
long form a missed bar (a promise about time or memory) is a failure too. Needs SHEETFORM, FAKE_WORKER, IO_FAULTS,
DISK_TRACE and STORE_LOAD in the environment (the programs and libraries that the build makes); the last three may be
empty, their trials are skipped then.

The server has no hooks for faults. The points between which it can fail (an upload is written, synced, named, its folder
synced, its row committed, the 201 sent; a job is claimed or put back; a result is read, stored in chunks, its row committed,
the folder of the attempt removed) are calls that reach the disk or a client, and the trials fail at those from outside: T4
at every sync, T4w at writes of every file by an error, for lack of room, half done or by SIGKILL; T6 starts on what is left
of every prefix of them, the sending of the 201 included; T12 has the ways in which a job's process ends or lies. So no
point is forgotten when their order changes, as one with a hook and a name of its own could be.
"""
import argparse
import json
import os
import platform
import sys
import time
import traceback

import bombs  # noqa: F401
import crowds
import kills
import power  # noqa: F401
import soak
import streams  # noqa: F401
import upgrades  # noqa: F401
import writes  # noqa: F401
from trials import TRIALS, Figures, Skip, seeded


def run(code, title, function, long, seed):
    figures, begun, verdict, why = Figures(), time.monotonic(), "passed", ""
    try:
        function(figures, long, seeded(seed, code))
        if long and figures.missed:
            verdict, why = "missed", "; ".join(figures.missed)
    except Skip as e:
        verdict, why = "skipped", str(e)
    except Exception as e:
        place = traceback.extract_tb(e.__traceback__)[-1]
        verdict, why = "FAILED", f"{os.path.basename(place.filename)}:{place.lineno}: {type(e).__name__}: {e}"[:1000]
    return {"code": code, "title": title, "verdict": verdict, "why": why, "seconds": round(time.monotonic() - begun, 1),
            "figures": figures.values}


def show(entry):
    print(f"{entry['code']:5} {entry['verdict']:8} {entry['seconds']:7.1f} s  {entry['title']}")
    print("      " + ", ".join(f"{name} {value}" for name, value in entry["figures"].items()))
    if entry["why"]:
        print("      " + entry["why"])
    sys.stdout.flush()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--only", nargs="+", metavar="CODE", default=[])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kills", type=int, default=kills.LONG_KILLS, help="of T1's long form; several runs with other seeds add up")
    parser.add_argument("--drain", action="store_true", help="T10's long form works off all of its 10,000 jobs: a quarter of an hour more")
    parser.add_argument("--soak", type=float, default=soak.MINUTES, metavar="MINUTES", help="of T20's long form")
    parser.add_argument("--report", help="JSON file to write")
    options = parser.parse_args()
    unknown = set(options.only) - {code for code, _, _ in TRIALS}
    if unknown:
        sys.exit(f"there is no trial {', '.join(sorted(unknown))}; there are {', '.join(code for code, _, _ in TRIALS)}")
    if not os.environ.get("SHEETFORM"):
        sys.exit("SHEETFORM must name the program")
    kills.LONG_KILLS = options.kills
    crowds.DRAIN_ALL = options.drain
    soak.MINUTES = options.soak
    entries = []
    for code, title, function in TRIALS:
        if not options.only or code in options.only:
            entries.append(run(code, title, function, not options.short, options.seed))
            show(entries[-1])
    if options.report:
        with open(options.report, "w") as f:
            json.dump({"form": "short" if options.short else "long", "seed": options.seed, "cores": os.cpu_count(),
                       "system": platform.platform(), "trials": entries}, f, indent=1)
    bad = [e["code"] for e in entries if e["verdict"] in ("FAILED", "missed")]
    print(f"{len(entries)} trials, {len(bad)} failed" + (": " + ", ".join(bad) if bad else ""))
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
