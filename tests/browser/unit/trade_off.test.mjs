// The curve of results, and the commands that make a result again.
import assert from "node:assert/strict";
import { it } from "node:test";
import { curve, finishedOf, missingOf, relatives, results, stepOf, sweepOf, sweepTolerances } from "../../../web/src/result/trade_off.js";
import { asAsked } from "../../../web/src/variants.js";
import { askedFor, commands } from "../../../web/src/ui/reproduce.js";

const job = (id, e_max, hausdorff, patches, more = {}) => ({
  jobID: id,
  status: "successful",
  inputs: { mesh: { sha256: "m", name: "my owl.stl" } },
  report: { hausdorff, patches, cut_length: 3 },
  ...more,
  parameters: { e_max, t_junctions: true, effort: "normal", ...more.parameters },
});

it("takes results of the same mesh and the same way of cutting", () => {
  const a = job("a", 0.02, 0.018, 9);
  const others = [
    job("b", 0.05, 0.04, 4, { parameters: { effort: "draft" } }),
    job("c", 0.02, 0.01, 12, { parameters: { t_junctions: false } }),
    job("d", 0.02, 0.01, 12, { inputs: { mesh: { sha256: "other" } } }),
  ];
  assert.deepEqual(
    relatives(a, [a, ...others]).map((one) => one.jobID),
    ["a", "b"],
  );
});

it("knows a size however it was asked for", () => {
  const mesh = { sha256: "m", scale: 12.5 };
  const a = job("a", 0.02, 0.018, 9, { inputs: { mesh }, parameters: { scale: 1, target_size: 300 } });
  const same = job("b", 0.05, 0.04, 4, { inputs: { mesh }, parameters: { scale: 12.5 } });
  const other = job("c", 0.05, 0.04, 4, { inputs: { mesh: { ...mesh, scale: 25 } }, parameters: { scale: 25 } });
  assert.deepEqual(
    relatives(a, [a, same, other]).map((one) => one.jobID),
    ["a", "b"],
  );
});

it("marks what no other result beats", () => {
  const all = [
    job("a", 0.02, 0.018, 9),
    job("b", 0.05, 0.04, 4),
    job("c", 0.03, 0.03, 11),
    job("d", 0.01, 0.009, 20),
    job("e", 0.01, 0.02, 5, { status: "failed" }),
  ];
  const points = curve(all[0], all);
  assert.deepEqual(
    points.map((p) => p.href),
    ["#job/d", "#job/a", "#job/c", "#job/b"],
  );
  assert.deepEqual(
    points.map((p) => p.best),
    [true, true, false, true],
  );
});

it("measures the length to cut, each seam twice, and can judge by it", () => {
  const cut = (id, error, patches, cut_length, border_length) =>
    job(id, error, error, patches, { report: { hausdorff: error, patches, cut_length, border_length } });
  const all = [cut("a", 0.01, 4, 3, 1), cut("b", 0.02, 9, 2, 1), cut("c", 0.03, 2, 4, 0)];
  assert.deepEqual(
    curve(all[0], all, "cut").map((p) => [p.href, p.cost, p.best]),
    [
      ["#job/a", 7, true],
      ["#job/b", 5, true],
      ["#job/c", 8, false],
    ],
  );
});

const sweep = (id, tolerances, more = {}) => ({
  ...job(id, tolerances, 0, 0),
  processID: "sweep",
  report: {
    curve: tolerances.map((e_max) => ({ point: String(e_max), e_max, hausdorff: 0.9 * e_max, patches: 8 })),
  },
  ...more,
});

it("takes the points of sweeps, each once, and as a job once it has been opened", () => {
  const all = [
    job("a", 0.02, 0.018, 9),
    sweep("s", [0.01, 0.05]),
    sweep("t", [0.01, 0.05], { reusedFrom: "s" }),
    sweep("r", [0.01], { status: "running", report: undefined }),
    job("p", 0.05, 0.045, 8, { reusedFrom: "t" }),
  ];
  assert.deepEqual(
    results(all[0], all).map(({ href, own }) => [href, own]),
    [
      ["#job/a", true],
      ["#job/p", false],
      ["#job/s/0.01", false],
    ],
  );
  // The opened point stays when its sweep is gone, and a sweep looks at itself, too.
  assert.deepEqual(
    results(all[1], [all[1], all[4]]).map(({ href }) => href),
    ["#job/p", "#job/s/0.01", "#job/s/0.05"],
  );
});

it("knows the sweep that need not be asked for again", () => {
  const a = job("a", 0.02, 0.018, 9);
  assert.equal(sweepOf(a, [a, sweep("s", [0.01], { status: "failed" })]), null);
  assert.equal(sweepOf(a, [a, sweep("s", [0.01], { status: "running" })]).jobID, "s");
  assert.equal(sweepOf(a, [sweep("s", [0.01], { parameters: { t_junctions: false } })]), null);
});

it("knows what a sweep whose time ran out has not found, until another one has", () => {
  const a = job("a", 0.02, 0.018, 9);
  const partial = sweep("s", [0.01, 0.015]);
  partial.report.missing = [0.025, 0.04];
  assert.deepEqual(missingOf(a, [a, partial]), [0.04, 0.025]);
  assert.deepEqual(missingOf(a, [a, partial, sweep("t", [0.04])]), [0.025]);
  assert.deepEqual(missingOf(a, [a, partial, sweep("t", [0.025, 0.04])]), []);
  assert.deepEqual(missingOf(a, [a, sweep("s", [0.01])]), []);
  assert.equal(stepOf({ message: "tolerance 2 of 5, checking" }), "2 of 5");
  assert.equal(stepOf({ message: "waits" }), "");
  assert.equal(finishedOf({ message: "tolerance 3 of 5" }), 2);
  assert.equal(finishedOf({ message: "" }), 0);
});

it("looks closer only where one has asked for more", () => {
  assert.equal(Math.min(...sweepTolerances(job("a", 0.02))), 0.01);
  assert.equal(Math.min(...sweepTolerances(job("a", 0.006))), 0.006);
});

it("asks again with size and tolerance as they were in force", () => {
  const asked = job("a", 0.02, 0, 0, {
    inputs: { mesh: { sha256: "m", scale: 4, bboxDiagonal: 10 } },
    parameters: { e_max_mm: 2, target_size: 30, scale: 1, normal_deviation: null },
  });
  assert.deepEqual(asAsked(asked), { e_max: 0.05, t_junctions: true, effort: "normal", scale: 4 });
});

it("writes commands with what differs from the defaults, safely quoted", () => {
  const process = {
    inputs: {
      e_max: { schema: { default: 0.02 } },
      t_junctions: { schema: { default: true } },
      effort: { schema: { default: "normal" } },
    },
  };
  const one = job("a", 0.02, 0, 0, { parameters: { t_junctions: false } });
  assert.deepEqual(askedFor(one, process), [
    ["e_max", 0.02],
    ["t_junctions", false],
  ]);
  const { terminal, curl } = commands(one, process, "http://127.0.0.1:8080");
  assert.equal(terminal, "sheetform decompose 'my owl.stl' -o 'my owl' --e-max 0.02 --t-junctions off");
  assert.equal(
    curl,
    "curl --data-binary '@my owl.stl' 'http://127.0.0.1:8080/api/v1/processes/decompose/execution?e_max=0.02&t_junctions=off'",
  );
  const evil = job("a", 0.02, 0, 0, { inputs: { mesh: { name: "x'; rm -rf ~; '.stl" } } });
  assert.match(commands(evil, process, "http://h").terminal, /'x'\\''; rm -rf ~; '\\''\.stl'/);
});

it("takes what was drawn into the commands", () => {
  const process = { inputs: {} };
  const links = [{ rel: "guides", href: "/api/v1/jobs/a/guides" }];
  const drawn = (name) => commands(job("a", 0.02, 0, 0, { links, inputs: { mesh: { name } } }), process, "http://h:8");
  const { guides, terminal, curl } = drawn("owl.stl");
  assert.equal(guides, "curl -o guides.json http://h:8/api/v1/jobs/a/guides");
  assert.match(terminal, / --guides guides\.json$/);
  assert.match(curl, /^curl -F mesh=@owl\.stl -F guides=@guides\.json 'http:\/\/h:8\/api\/v1\/processes\/decompose\/execution\?/);
  assert.match(drawn('a, "b".stl').curl, /-F 'mesh=@"a, \\"b\\"\.stl"'/);
  assert.equal(commands(job("a", 0.02, 0, 0), process, "http://h").guides, null);
});
