// Fewer parts or closer to the shape: all results of one mesh as points of a curve.

/** Tolerances of a sweep, as fractions of the diagonal, coarse first: the quick ones answer first. */
export const SWEEP = [0.06, 0.04, 0.025, 0.015, 0.01, 0.006];

/** Parameters that make two jobs comparable: all but the tolerance, the effort and the seed. */
function family(job) {
  const { e_max, e_max_mm, effort, seed, ...rest } = job.parameters ?? {};
  void [e_max, e_max_mm, effort, seed];
  return `${job.inputs?.mesh?.sha256} ${JSON.stringify(Object.entries(rest).sort(([a], [b]) => (a < b ? -1 : 1)))}`;
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
 * Points of the curve: {job, error (fraction), cost, best} by growing error; `best` where no other point has both less
 * error and less cost. `measure` is a name of COSTS.
 */
export function curve(job, all, measure = "parts") {
  const points = relatives(job, all)
    .filter((other) => other.status === "successful" && Number.isFinite(other.report?.hausdorff))
    .map((other) => ({ job: other, error: other.report.hausdorff, cost: COSTS[measure](other.report) }))
    .filter(({ cost }) => Number.isFinite(cost))
    .sort((a, b) => a.error - b.error || a.cost - b.cost);
  let least = Infinity;
  for (const point of points) {
    point.best = point.cost < least;
    least = Math.min(least, point.cost);
  }
  return points;
}

/** Tolerances of the sweep that no job of the family has asked for yet. */
export function missing(job, all) {
  const asked = relatives(job, all)
    .filter((other) => other.status !== "failed" && other.status !== "dismissed")
    .map((other) => other.parameters.e_max);
  return SWEEP.filter((e) => !asked.some((other) => Math.abs(other / e - 1) < 0.02));
}
