// The same mesh again with other parameters, without uploading it from the person's disk.
import { execute, getInput } from "./api.js";
import { jobs } from "./jobs.js";
import { recall, remember } from "./prefs.js";

/** Parameters as they were asked for; what the server filled in by itself is left out. */
export function asAsked(parameters = {}) {
  return Object.fromEntries(
    Object.entries(parameters).filter(
      ([name, value]) => value !== null && name !== "e_max_mm" && name !== "target_size",
    ),
  );
}

/** Starts one job for each of `changes` (parameters that differ from those of `job`); resolves with the jobs. */
export async function startVariants(job, changes) {
  const mesh = await getInput(job.jobID);
  const known = recall("jobs", {});
  const started = [];
  for (const change of changes) {
    const next = await execute(
      mesh,
      { ...asAsked(job.parameters), ...change },
      { tag: job.tag, filename: job.inputs?.mesh?.name },
    );
    // The new job is of the same material and stands the same way up.
    known[next.jobID] = known[job.jobID] ?? {};
    remember("jobs", known);
    jobs.put(next);
    started.push(next);
  }
  return started;
}
