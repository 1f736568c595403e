"""Writes that the disk refuses, of every kind of file, while jobs are accepted and while results are stored."""
import collections
import errno
import itertools
import os
import signal

from kills import session, verify_acknowledged, with_a_fault
from trials import FaultyServer, all_jobs, expect, in_threads, integrity, trial, until_idle

UPLOADS = 7  # their results are more than SQLite keeps in its log: the databases themselves are written too
AT_ONCE = 4   # servers, which mostly wait
REFUSED_AT_START = 70
ENDED_BY_STORAGE = 74
FORMS = [(error, form) for error in (errno.EIO, errno.ENOSPC) for form in ("once", "torn", "on")]


def writes_of_a_session():
    """What a server writes from its start until the results of a session are stored, in order."""
    with FaultyServer("--slots", "1", "--quiet", count_writes=True) as server:
        before = len(server.every_write())
        expect(len(session(server, UPLOADS)) == UPLOADS, "an upload was not accepted")
        until_idle(server, 60)
        return server.every_write(), before


def chosen(kinds, started, rng, long):
    """Numbers of writes. Long: of each kind of file, before and after the server was ready, the first two, the last and five
    more; short: two from its start, and two of each kind after it."""
    places = collections.defaultdict(list)
    for i, kind in enumerate(kinds):
        places[kind, i >= started].append(i + 1)
    if long:
        return sorted({n for numbers in places.values() for n in numbers[:2] + numbers[-1:] + rng.sample(numbers, min(5, len(numbers)))})
    after = [n for (_, ready), numbers in sorted(places.items()) if ready for n in rng.sample(numbers, min(2, len(numbers)))]
    return sorted(rng.sample(range(1, started + 1), 2) + after)


def strike(number, error, form):
    """A server whose write fails, and its next start; (kind of the file, exit status or None, how many were acknowledged)."""
    with FaultyServer("--slots", "1", "--quiet", write=number, error=error, form=form, wait=False) as server:
        acknowledged, status = with_a_fault(server, UPLOADS)
        if not server.fired():
            return None, status, len(acknowledged)
        if status == REFUSED_AT_START:
            expect(not server.port and not acknowledged, "a server that had served ended as if it could not start")
            expect(b"sheetform: " in server.log_bytes().splitlines()[-1], "it was not told why the server does not start")
        else:
            expect(status in (None, ENDED_BY_STORAGE), f"the status is {status}")
        if status is None and form != "on":  # the disk is well again, and so is the server, with nobody's help
            until_idle(server, 60)
            jobs = all_jobs(server)
            wrong = [jobs.get(i) for i in acknowledged if i not in jobs or jobs[i]["status"] != "successful"]
            expect(not wrong, f"after one failed write: {wrong[:1]}")
        server.stop(signal.SIGKILL)
        struck = server.struck()
        server.healthy()
        server.start()
        verify_acknowledged(server, acknowledged)
        server.stop()
        integrity(server.data)
        expect(not os.listdir(server.data + "/spool"), "an unfinished upload is left")
        return struck, status, len(acknowledged)


def told_strike(kinds, number, error, form):
    try:
        return strike(number, error, form)
    except AssertionError as e:
        raise AssertionError(f"write {number} ({kinds[number - 1]}), {errno.errorcode[error]} {form}: {e}")


@trial("T4w", "a write fails, half of it or all that follow: nothing acknowledged is lost, the server goes on or ends with 74")
def failing_writes(figures, long, rng):
    kinds, started = writes_of_a_session()
    numbers = chosen(kinds, started, rng, long)
    tries = [(n, *fault) for n in numbers for fault in (FORMS if long else [rng.choice(FORMS)])]
    struck, ends, total = collections.Counter(), collections.Counter(), 0

    def several(first):
        return [told_strike(kinds, *fault) for fault in tries[first::AT_ONCE]]
    for kind, status, acknowledged in itertools.chain(*in_threads(AT_ONCE, several)):
        struck[kind] += 1
        ends["went on" if status is None else status] += 1
        total += acknowledged
    expect(sum(struck.values()) - struck[None] >= len(tries) / 2, "most of the faults never came")
    figures.put(writes_of_a_session=len(kinds), tried=len(tries), struck=str(dict(struck)), ends=str(dict(ends)),
                acknowledged=total, lost=0)
