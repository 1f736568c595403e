// The curve of results, and the commands that make a result again.
import assert from "node:assert/strict";
import { it } from "node:test";
import { SWEEP, curve, missing, relatives } from "../../../web/src/result/trade_off.js";
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
    points.map((p) => p.job.jobID),
    ["d", "a", "c", "b"],
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
    curve(all[0], all, "cut").map((p) => [p.job.jobID, p.cost, p.best]),
    [
      ["a", 7, true],
      ["b", 5, true],
      ["c", 8, false],
    ],
  );
});

it("asks for no tolerance twice", () => {
  const a = job("a", SWEEP[0], 0.05, 3);
  const b = job("b", SWEEP[1], 0, 0, { status: "running" });
  const c = job("c", SWEEP[2], 0, 0, { status: "failed" });
  assert.deepEqual(missing(a, [a, b, c]), SWEEP.slice(2));
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
    "curl --data-binary @'my owl.stl' 'http://127.0.0.1:8080/api/v1/processes/decompose/execution?e_max=0.02&t_junctions=off'",
  );
  const evil = job("a", 0.02, 0, 0, { inputs: { mesh: { name: "x'; rm -rf ~; '.stl" } } });
  assert.match(commands(evil, process, "http://h").terminal, /'x'\\''; rm -rf ~; '\\''\.stl'/);
});
