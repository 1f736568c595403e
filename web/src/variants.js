// The same mesh again with other parameters, without uploading it from the person's disk.
import { execute, getGuides, getInput } from "./api.js";
import { jobs } from "./jobs.js";
import { inheritPicture, knownOf, rememberOf } from "./prefs.js";

/** Millimetres for one unit of the mesh, as in force. */
export const scaleOf = (job) => job.inputs?.mesh?.scale ?? job.parameters?.scale ?? 1;

/** How a job is looked at: {up, material}. What was chosen on this device since, or came with a link, wins. */
export function viewOf(job) {
  const { up, material } = job.parameters ?? {};
  return { up, material, ...knownOf(job.jobID) };
}

/** Parameters as they were asked for, with size and tolerance as in force: a scale and a fraction of the diagonal. */
export function asAsked(job) {
  const { e_max_mm, target_size, ...rest } = job.parameters ?? {};
  void target_size;
  const asked = { ...rest, ...viewOf(job), scale: scaleOf(job) };
  const diagonal = (job.inputs?.mesh?.bboxDiagonal ?? 0) * asked.scale;
  if (e_max_mm && diagonal) asked.e_max = Number((e_max_mm / diagonal).toPrecision(6));
  return Object.fromEntries(Object.entries(asked).filter(([, value]) => value !== null && value !== undefined));
}

/** Starts a job of the mesh of `job` with parameters that differ in `change`; resolves with the new job. */
async function again(job, change, options = {}) {
  const [mesh, guides] = await Promise.all([getInput(job.jobID), getGuides(job)]);
  const next = await execute(
    mesh,
    { ...asAsked(job), ...change },
    { guides, tag: job.tag, filename: job.inputs?.mesh?.name, ...options },
  );
  inheritPicture(job.jobID, next.jobID);
  jobs.put(next);
  return next;
}

/** A point of a sweep is looked at like the sweep. */
export function inherit(sweep, point) {
  rememberOf(point, { ...knownOf(sweep), ...knownOf(point) });
  inheritPicture(sweep, point);
}

export const startVariant = (job, change) => again(job, change);

/** One job for several tolerances (fractions of the diagonal); drafts would be no use at the fine ones. */
export const startSweep = (job, tolerances) =>
  again(job, { e_max: tolerances.join(","), effort: "normal" }, { process: "sweep" });
