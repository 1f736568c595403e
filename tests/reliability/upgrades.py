#!/usr/bin/env python3
"""Stores of every schema that was released, opened by this version and killed at any of its writes.

A new step of server/store/migrations.cpp needs a store of the schema before it: run this file with the last version that
has it (SHEETFORM and FAKE_WORKER as for reliability.py), it writes schemas/N.
"""
import hashlib
import http.client
import json
import os
import re
import signal
import sqlite3
import sys
import tempfile
import time

from kills import end_of
from trials import EXECUTION, FaultyServer, Server, expect, in_threads, integrity, trial, unique_mesh, until_idle, verify_results

SCHEMAS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "schemas")
KEYED = {"Idempotency-Key": "kept"}
AT_ONCE = 4  # servers, which mostly wait
DATABASES = ("sheetform", "blobs")
MOMENT = r"\b\d{16}\b"  # in microseconds
MINUTE = 60_000_000


def text_of(path):
    """A database as SQL."""
    connection = sqlite3.connect(path)
    value = lambda name: connection.execute(f"PRAGMA {name}").fetchone()[0]
    head = [f"PRAGMA {name}={value(name)};" for name in ("auto_vacuum", "application_id", "user_version")]
    text = "\n".join(head + list(connection.iterdump())) + "\n"
    connection.close()
    return text


def write_fixture():
    """Writes a store of the present schema: a job of each state and a key, without the large file of the results."""
    with Server("--slots", "1", "--quiet", "--keep-days", "36500") as server:
        jobs = {"successful": server.wait(server.submit(name="work-10.obj", headers=KEYED)["jobID"]),
                "failed": server.wait(server.submit(name="refuse.obj")["jobID"]),
                "running": server.wait(server.submit(name="work-300.obj")["jobID"], until=("running",)),
                "accepted": server.submit(name="work-10.obj")}
        server.stop(signal.SIGKILL)
        meta = sqlite3.connect(server.data + "/sheetform.db")
        version = meta.execute("PRAGMA user_version").fetchone()[0]
        meta.execute("DELETE FROM output WHERE name = 'big.bin'")
        meta.execute("DELETE FROM blob WHERE store = 'db' AND digest NOT IN (SELECT digest FROM output)")
        kept = [row[0] for row in meta.execute("SELECT digest FROM blob WHERE store = 'db'")]
        meta.commit(), meta.close()
        blobs = sqlite3.connect(server.data + "/blobs.db")
        blobs.execute(f"DELETE FROM chunk WHERE digest NOT IN ({', '.join('?' * len(kept))})", kept)
        blobs.commit(), blobs.close()
        folder = f"{SCHEMAS}/{version}"
        os.makedirs(folder)
        for name in DATABASES:
            with open(f"{folder}/{name}.sql", "w") as f:
                f.write(text_of(f"{server.data}/{name}.db"))
        meshes = [open(os.path.join(place, name)).read() for place, _, names in os.walk(server.data + "/blobs/in") for name in names]
        with open(folder + "/jobs.json", "w") as f:
            json.dump({"jobs": {state: job["jobID"] for state, job in jobs.items()}, "meshes": sorted(meshes)}, f, indent=1)
        print("wrote", folder)


def lay_out(schema):
    """A data folder with the store of a schema, as if it had been begun a minute ago, and what must be in it; nothing in
    a new one (schema None)."""
    data = tempfile.mkdtemp(prefix="sheetform-upgrade-")
    if schema is None:
        return data, None
    folder = f"{SCHEMAS}/{schema}"
    texts = {name: open(f"{folder}/{name}.sql").read() for name in DATABASES}
    begun = min(int(at) for at in re.findall(MOMENT, texts["sheetform"]))
    later = time.time_ns() // 1000 - MINUTE - begun  # keys are forgotten after a day
    for name, text in texts.items():
        connection = sqlite3.connect(f"{data}/{name}.db", isolation_level=None)
        connection.executescript(re.sub(MOMENT, lambda at: str(int(at[0]) + later), text))
        connection.close()
    with open(folder + "/jobs.json") as f:
        told = json.load(f)
    for mesh in told["meshes"]:
        digest = hashlib.sha256(mesh.encode()).hexdigest()
        os.makedirs(f"{data}/blobs/in/{digest[:2]}", exist_ok=True)
        with open(f"{data}/blobs/in/{digest[:2]}/{digest}", "w") as f:
            f.write(mesh)
    return data, told


def check(server, told):
    """Everything of the old store is there, and what it had not done is done."""
    if told:
        until_idle(server)
        for state, job_id in told["jobs"].items():
            job = server.request("GET", f"/api/v1/jobs/{job_id}", check=False).json()
            expect(job["status"] == ("failed" if state == "failed" else "successful"), f"{state}: {job}")
            if state == "failed":
                expect(job["exception"]["type"].endswith("unsupported-mesh"), f"another problem: {job}")
            else:
                expect(verify_results(server, job_id) == (2 if state == "successful" else 3), f"{state}: files are missing")
        done = told["jobs"]["successful"]
        mesh = server.request("GET", f"/api/v1/jobs/{done}/input", check=False).body
        again = server.request("POST", f"{EXECUTION}?filename=work-10.obj", mesh, KEYED, check=False)
        expect((again.status, again.json()["jobID"]) == (201, done), "the key of a request is forgotten")
    expect(server.wait(server.submit()["jobID"])["status"] == "successful", "no job runs")


def version_of(data):
    connection = sqlite3.connect(data + "/sheetform.db")
    version = connection.execute("PRAGMA user_version").fetchone()[0]
    connection.close()
    return version


def kill_at(schema, number):
    """Kills a server in the middle of a write, and holds the next start to what there was; whether it came to that write."""
    data, told = lay_out(schema)
    with FaultyServer("--slots", "1", "--quiet", data=data, write=number, form="kill", wait=False) as server:
        try:
            server.find_port()
            until_idle(server)
        except (AssertionError, OSError, ValueError, http.client.HTTPException):
            pass  # killed
        status = end_of(server, 5)
        expect(status == (-signal.SIGKILL if server.fired() else None), f"the status is {status}")
        fired = server.fired()
        server.stop(signal.SIGKILL)
        server.healthy()
        server.start()
        check(server, told)
        server.stop()
        integrity(data)
        return fired


@trial("T21", "a store of each schema that there was, and a new one, killed at any write of its opening: whole or as before")
def upgrades(figures, long, rng):
    schemas, killed = sorted(os.listdir(SCHEMAS), key=int), 0
    for schema in [None, *schemas]:
        data, told = lay_out(schema)
        with FaultyServer("--slots", "1", "--quiet", data=data, count_writes=True) as server:
            until_idle(server)
            writes = len(server.every_write())
            check(server, told)
            server.stop()
            newest = version_of(data)
        last = writes if schema is None else min(writes, 250)  # after that its jobs run, as T4w has it
        numbers = list(range(1, last + 1)) if long else rng.sample(range(1, last + 1), 2)
        several = lambda first: sum(kill_at(schema, number) for number in numbers[first::AT_ONCE])
        killed += sum(in_threads(AT_ONCE, several))
        figures.put(**{f"writes_of_schema_{schema or 'new'}": writes})
    expect(schemas and int(schemas[-1]) == newest, f"there is no store of schema {newest} among {schemas}: see upgrades.py")
    expect(killed > 0, "no server was killed")
    figures.put(newest_schema=newest, killed=killed)


if __name__ == "__main__":
    sys.exit(write_fixture())
