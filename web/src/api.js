// The server's HTTP interface (proto/openapi.yaml) as functions. Every failure is a ProblemError.

const ROOT = "/api/v1";

/** An RFC 9457 problem: `problem` has title, detail, where, fix, status. */
export class ProblemError extends Error {
  constructor(problem) {
    super(problem.detail || problem.title);
    this.problem = problem;
  }

  /** Whether it is the server that is away or busy: the same may go well in a moment. */
  get passing() {
    const { status } = this.problem;
    return [0, 429, 502, 503, 504].includes(status);
  }
}

export const A_MOMENT = 2000; // milliseconds after which one tries again

/** The problem of a request that got no answer at all. */
function unreachable() {
  return new ProblemError({
    type: "about:blank",
    status: 0,
    title: "The server does not answer",
    detail: "The page cannot reach the sheetform server.",
    fix: "Check that it still runs; the page carries on by itself as soon as it answers.",
  });
}

async function problemOf(response) {
  try {
    const body = JSON.parse(await response.text());
    if (body && body.title) return new ProblemError({ status: response.status, ...body });
  } catch {
    /* not JSON: described below */
  }
  return new ProblemError({
    type: "about:blank",
    status: response.status,
    title: `The server answered ${response.status}`,
    detail: response.statusText || "No further words came with it.",
  });
}

async function request(path, options = {}) {
  let response;
  try {
    response = await fetch(path, { credentials: "same-origin", ...options });
  } catch {
    throw unreachable();
  }
  if (!response.ok) throw await problemOf(response);
  return response;
}

async function json(path, options) {
  return (await request(path, { headers: { Accept: "application/json" }, ...options })).json();
}

export const getProcess = () => json(`${ROOT}/processes/decompose`);
export const getLimits = () => json(`${ROOT}/limits`);
export const getJob = (id) => json(`${ROOT}/jobs/${encodeURIComponent(id)}`);
export const olderJobs = () => `${ROOT}/jobs?limit=100`;
/** A page of the list, newest first: {jobs, next}; next = where the page of older ones is, null at the end. */
export const listJobs = async (href = olderJobs()) => {
  const { jobs, links } = await json(href);
  return { jobs, next: links.find(({ rel }) => rel === "next")?.href ?? null };
};
export const dismissJob = (id) => json(`${ROOT}/jobs/${encodeURIComponent(id)}`, { method: "DELETE" });
export const retryJob = (id) => json(`${ROOT}/jobs/${encodeURIComponent(id)}/retry`, { method: "POST" });
/** Ends a running sweep with the points that are finished. */
export const finishJob = (id) => json(`${ROOT}/jobs/${encodeURIComponent(id)}/finish`, { method: "POST" });
/** A point of a sweep as a job of its own, without computing it again. */
export const openPoint = (sweep, point) =>
  json(`${ROOT}/jobs/${encodeURIComponent(sweep)}/points/${encodeURIComponent(point)}`, { method: "POST" });
export const getResults = (id) => json(`${ROOT}/jobs/${encodeURIComponent(id)}/results`);
export const getExports = (id) => json(`${ROOT}/jobs/${encodeURIComponent(id)}/exports`);
export const getJson = (href) => json(href);
export const fileHref = (id, name) => `${ROOT}/jobs/${encodeURIComponent(id)}/results/${name}?inline=1`;
/** What was drawn on the job's mesh, as it was sent; null when nothing was. */
export const getGuides = async (job) => {
  const link = job.links?.find(({ rel }) => rel === "guides");
  return link ? json(link.href) : null;
};
export const getText = async (href) => (await request(href)).text();
export const getInput = async (id) => (await request(`${ROOT}/jobs/${encodeURIComponent(id)}/input`)).blob();

export function openSession(token) {
  return request(`${ROOT}/session`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ token }),
  });
}

/** Parameters as the query wants them: booleans are on and off. */
export function queryOf(parameters) {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters)) {
    if (value === undefined || value === null || value === "") continue;
    query.set(name, typeof value === "boolean" ? (value ? "on" : "off") : String(value));
  }
  return query;
}

/**
 * Uploads a mesh and starts a job; resolves with its statusInfo.
 * onProgress(fraction) tells how much of the upload has left; `signal` aborts it. `guides`: what was drawn on the mesh, as
 * Guides.wire() says it, or null. XMLHttpRequest, because fetch does not report the progress of an upload.
 */
export function execute(mesh, parameters, options = {}) {
  const { process = "decompose", guides = null, tag, filename, onProgress, signal } = options;
  const query = queryOf({ ...parameters, tag, filename });
  return new Promise((resolve, reject) => {
    const xhr = new XMLHttpRequest();
    xhr.open("POST", `${ROOT}/processes/${process}/execution?${query}`);
    if (!guides) xhr.setRequestHeader("Content-Type", "application/octet-stream");
    xhr.setRequestHeader("Accept", "application/json");
    xhr.upload.onprogress = (event) => event.lengthComputable && onProgress?.(event.loaded / event.total);
    xhr.onload = async () => {
      const response = new Response(xhr.response, { status: xhr.status, statusText: xhr.statusText });
      if (xhr.status === 201) resolve(await response.json());
      else reject(await problemOf(response));
    };
    xhr.onerror = () => reject(unreachable());
    xhr.onabort = () => reject(new DOMException("stopped", "AbortError"));
    signal?.addEventListener("abort", () => xhr.abort());
    xhr.send(guides ? formOf(mesh, guides, filename) : mesh);
  });
}

function formOf(mesh, guides, filename) {
  const form = new FormData();
  form.append("mesh", mesh, filename || "mesh");
  form.append("guides", JSON.stringify(guides));
  return form;
}

/**
 * Follows all jobs: onSnapshot(jobs), onJob(job), onRemoved(id), onState("live" | "polling" | "lost").
 * Server-sent events while they work; while they do not, the list is asked for every two seconds. Returns a stop function.
 */
export function watchJobs({ onSnapshot, onJob, onRemoved, onState }) {
  let stopped = false;
  let timer = 0;
  let source = null;

  async function poll() {
    timer = 0;
    if (stopped) return;
    try {
      onSnapshot((await listJobs()).jobs);
      onState("polling");
    } catch (error) {
      onState("lost", error.problem);
    }
    if (!stopped && !timer) timer = setTimeout(poll, 2000);
  }
  function stopPolling() {
    clearTimeout(timer);
    timer = 0;
  }
  function connect() {
    source = new EventSource(`${ROOT}/events`);
    source.addEventListener("snapshot", (event) => {
      stopPolling();
      onState("live");
      onSnapshot(JSON.parse(event.data).jobs);
    });
    source.addEventListener("job", (event) => onJob(JSON.parse(event.data)));
    source.addEventListener("removed", (event) => onRemoved(JSON.parse(event.data).jobID));
    source.onerror = () => {
      if (!timer) poll();
      // A refusal (not a lost connection) closes the source for good: try again later.
      if (source.readyState === EventSource.CLOSED && !stopped) setTimeout(() => !stopped && connect(), 10000);
    };
  }
  connect();
  return () => {
    stopped = true;
    stopPolling();
    source?.close();
  };
}
