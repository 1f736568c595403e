// The jobs as the page knows them, kept up to date by the server's events.
import { dismissJob, finishJob, listJobs, olderJobs, retryJob, watchJobs } from "./api.js";
import { Observable } from "./listeners.js";

export const ACTIVE = new Set(["accepted", "running"]);

export const STAGES = [
  ["read", "Reading the mesh"],
  ["prepare", "Preparing the surface"],
  ["field", "Finding out how it bends"],
  ["trace", "Tracing possible seams"],
  ["insert", "Placing seams"],
  ["remove", "Removing seams that are not needed"],
  ["final", "Fitting and flattening the sheets"],
  ["write", "Writing the files"],
];

const step = ({ status }) => ({ accepted: 0, running: 1 })[status] ?? 2;

/** Whether `job` tells of an earlier time than `known`; within a millisecond the status decides. */
function isOlder(job, known) {
  if (!known) return false;
  return job.updated === known.updated ? step(job) < step(known) : job.updated < known.updated;
}

const PAUSE = 100; // milliseconds between two tellings of changes: others may be busy, too
const MOST = 2000; // jobs that are kept, about; a page may stay open for weeks

/** Newest first. */
const byAge = (a, b) => (a.created < b.created ? 1 : a.created > b.created ? -1 : a.jobID < b.jobID ? 1 : -1);

class Jobs extends Observable {
  list = new Map();
  known = false; // whether the server's list has arrived
  connection = ""; // "live", "polling", "lost"
  open = null; // id of the job that is looked at: it is never forgotten
  older = olderJobs(); // where jobs are that the list does not hold yet

  start() {
    watchJobs({
      onSnapshot: (jobs) => {
        // What is older than the newest hundred is kept; what should be among them and is not was removed.
        const listed = new Set(jobs.map((job) => job.jobID));
        const oldest = jobs[99]?.created ?? "";
        for (const [id, { created }] of this.list) if (created > oldest && !listed.has(id)) this.list.delete(id);
        for (const job of jobs) this.take(job);
        this.known = true;
        this.changed();
      },
      onJob: (job) => this.put(job),
      onRemoved: (id) => this.drop(id),
      onState: (state, problem) => {
        if (state === this.connection) return;
        this.connection = state;
        this.problem = problem;
        this.changed();
      },
    });
  }

  get(id) {
    return this.list.get(id) ?? null;
  }

  newestFirst() {
    return [...this.list.values()].sort(byAge);
  }

  /** Tells at once; then, while events pour in, now and then, of all that came since. */
  changed() {
    if (this.pause) return (this.behind = true);
    this.behind = false;
    this.pause = setTimeout(() => {
      this.pause = null;
      if (this.behind) this.changed();
    }, PAUSE);
    super.changed();
  }

  put(job) {
    this.take(job);
    this.changed();
  }

  /** An event may overtake the answer to a request: what is known to be newer stays. */
  take(job) {
    if (!isOlder(job, this.list.get(job.jobID))) this.list.set(job.jobID, job);
    if (this.list.size > 1.25 * MOST)
      for (const old of this.newestFirst().slice(MOST))
        if (old.jobID !== this.open && old.jobID !== job.jobID && !ACTIVE.has(old.status)) this.list.delete(old.jobID);
  }

  /** Fetches jobs that are older than those known; false when there are none. */
  async more() {
    for (const before = this.list.size; this.older && this.list.size === before; ) {
      const { jobs, next } = await listJobs(this.older);
      this.older = next;
      for (const job of jobs) this.take(job);
    }
    this.changed();
    return Boolean(this.older);
  }

  drop(id) {
    if (this.list.delete(id)) this.changed();
  }

  /** Cancels a job that waits or runs; removes one that has ended. */
  async dismiss(id) {
    const active = ACTIVE.has(this.get(id)?.status);
    const job = await dismissJob(id);
    if (active) this.put(job);
    else this.drop(id);
  }

  /** Ends a sweep with what it has found. */
  async finish(id) {
    this.put(await finishJob(id));
  }

  async retry(id) {
    this.put(await retryJob(id));
  }
}

export const jobs = new Jobs();

/** What a person calls the job: its tag, or the file's name without its ending. */
export function titleOf(job) {
  return job.tag || (job.inputs?.mesh?.name ?? "").replace(/\.(stl|obj|ply|off)$/i, "") || "Unnamed shape";
}

/** Seconds that are left, guessed from the share that is done; null as long as a guess would be worthless. */
export function secondsLeft(job, now = Date.now()) {
  if (job.status !== "running" || !job.started || job.progress < 4) return null;
  const elapsed = (now - new Date(job.started).getTime()) / 1000;
  if (elapsed < 1.5) return null;
  return (elapsed * (100 - job.progress)) / job.progress;
}
