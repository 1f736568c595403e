#!/usr/bin/env python3
"""A mesh goes in, its sheets come out: client.py SERVER MESH FOLDER [name=value ...], e.g.
client.py http://127.0.0.1:8080 lamp.stl lamp e_max=0.02 target_size=300. Token: SHEETFORM_TOKEN."""
import json, os, sys, urllib.error, urllib.parse, urllib.request, uuid


def call(path, body=None, **headers):
    headers = {name.replace("_", "-"): value for name, value in headers.items()}
    if os.environ.get("SHEETFORM_TOKEN"):
        headers["Authorization"] = "Bearer " + os.environ["SHEETFORM_TOKEN"]
    try:
        return urllib.request.urlopen(urllib.request.Request(urllib.parse.urljoin(server, path), body, headers)).read()
    except urllib.error.HTTPError as answer:
        problem = json.load(answer)
        sys.exit("{}: {} {}".format(problem["title"], problem.get("detail", ""), problem.get("fix", "")))


if len(sys.argv) < 4: sys.exit(__doc__)
server, mesh, folder, *parameters = sys.argv[1:]
query = urllib.parse.urlencode({"filename": os.path.basename(mesh), **dict(p.split("=", 1) for p in parameters)})
with open(mesh, "rb") as file:  # the key makes it safe to send the same request again after a broken connection
    job = json.loads(call("/api/v1/processes/decompose/execution?" + query, file.read(),
                          Content_Type="application/octet-stream", Idempotency_Key=str(uuid.uuid4())))
while job["status"] in ("accepted", "running"):
    job = json.loads(call("/api/v1/jobs/" + job["jobID"], Prefer="wait=2"))  # answers at once when the state changes
    print(job["status"], job["progress"], "%", job.get("message", ""), file=sys.stderr)
os.makedirs(folder, exist_ok=True)
for name, entry in json.loads(call("/api/v1/jobs/" + job["jobID"] + "/results")).items():
    with open(os.path.join(folder, os.path.basename(name)), "wb") as file:
        file.write(call(entry["href"]))
