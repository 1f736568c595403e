// Fewer parts or closer to the shape: all results of one mesh as points of a curve, those of its sweeps among them.

/**
 * Tolerances of a sweep, as fractions of the diagonal. One finer than these takes as long as all of them; only who has
 * asked for more than that is shown it, too.
 */
const SWEEP = [0.06, 0.04, 0.025, 0.015, 0.01];
const FINEST = 0.006;
export const sweepTolerances = (job) => (job.parameters?.e_max < 0.008 ? [...SWEEP, FINEST] : SWEEP);

export const isSweep = (job) => job.processID === "sweep";

const families = new WeakMap(); // of jobs: every event compares all of them

/**
 * What makes two jobs comparable: the mesh, its size however it was asked for, and all parameters but the tolerance, the
 * effort, the seed, and how it is looked at.
 */
function family(job) {
  if (!families.has(job)) families.set(job, familyOf(job));
  return families.get(job);
}

function familyOf(job) {
  const { e_max, e_max_mm, effort, seed, up, material, target_size, scale, ...rest } = job.parameters ?? {};
  void [e_max, e_max_mm, effort, seed, up, material, target_size];
  const { sha256, scale: inForce = scale ?? 1 } = job.inputs?.mesh ?? {};
  return `${sha256} ${Number(inForce).toPrecision(9)} ${JSON.stringify(Object.entries(rest).sort(([a], [b]) => (a < b ? -1 : 1)))}`;
}

/** The jobs of the same mesh and parameters as `job`, itself included. */
export function relatives(job, all) {
  const mine = family(job);
  return all.filter((other) => family(other) === mine);
}

/** What a result costs: its parts, or the length of all outlines in diagonals (a seam is cut twice). */
export const COSTS = {
  parts: ({ patches }) => patches,
  cut: ({ cut_length, border_length = 0 }) => 2 * cut_length + border_length,
};

/**
 * Every result that `job` can be compared with: {href, report, effort, own}. A point of a sweep opens as a job of its
 * own; once it has been opened it stands here as that job, not twice.
 */
export function results(job, all) {
  const found = relatives(job, all).filter((other) => other.status === "successful");
  const sweeps = found.filter(isSweep);
  const first = new Map(sweeps.map((sweep) => [sweep.jobID, sweep.reusedFrom ?? sweep.jobID]));
  const seen = new Set();
  const singles = found
    .filter((other) => !isSweep(other))
    .map((other) => {
      if (other.reusedFrom) seen.add(`${first.get(other.reusedFrom) ?? other.reusedFrom}/${other.parameters.e_max}`);
      return {
        href: `#job/${other.jobID}`,
        report: other.report,
        effort: other.parameters?.effort,
        own: other.jobID === job.jobID,
      };
    });
  const points = sweeps.flatMap((sweep) =>
    (sweep.report?.curve ?? []).flatMap((report) => {
      const key = `${first.get(sweep.jobID)}/${report.e_max}`;
      if (seen.has(key)) return [];
      seen.add(key);
      return { href: `#job/${sweep.jobID}/${report.point}`, report, effort: sweep.parameters?.effort, own: false };
    }),
  );
  return [...singles, ...points];
}

/**
 * Points of the curve: results() with error (fraction), cost and best, by growing error; `best` where no other point
 * has both less error and less cost. `measure` is a name of COSTS.
 */
export function curve(job, all, measure = "parts") {
  const points = results(job, all)
    .filter(({ report }) => Number.isFinite(report?.hausdorff))
    .map((result) => ({ ...result, error: result.report.hausdorff, cost: COSTS[measure](result.report) }))
    .filter(({ cost }) => Number.isFinite(cost))
    .sort((a, b) => a.error - b.error || a.cost - b.cost);
  let least = Infinity;
  for (const point of points) {
    point.best = point.cost < least;
    least = Math.min(least, point.cost);
  }
  return points;
}

/** The sweep of this mesh and way of cutting that is on its way or done; null when there is none. */
export function sweepOf(job, all) {
  const good = new Set(["accepted", "running", "successful"]);
  return relatives(job, all).find((other) => isSweep(other) && good.has(other.status)) ?? null;
}

/** Tolerances of sweeps that ended early which no other sweep has found. */
export function missingOf(job, all) {
  const sweeps = relatives(job, all).filter((other) => isSweep(other) && other.status === "successful");
  const found = new Set(sweeps.flatMap((sweep) => (sweep.report?.curve ?? []).map(({ e_max }) => e_max)));
  const missing = new Set(sweeps.flatMap((sweep) => sweep.report?.missing ?? []));
  return [...missing].filter((e_max) => !found.has(e_max)).sort((a, b) => b - a);
}

/** How many of its points are finished while it runs. */
export const finishedOf = (sweep) => Math.max(0, Number.parseInt(stepOf(sweep) || "1", 10) - 1);

/** How far a sweep has come, in words: "2 of 5"; empty as long as it does not say so. */
export const stepOf = (sweep) => /tolerance (\d+ of \d+)/.exec(sweep.message ?? "")?.[1] ?? "";
