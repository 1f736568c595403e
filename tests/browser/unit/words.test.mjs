// How numbers, parameters and places are put into words.
import assert from "node:assert/strict";
import { it } from "node:test";
import { queryOf } from "../../../web/src/api.js";
import {
  area,
  ago,
  bytes,
  count,
  duration,
  metres,
  millimetres,
  percent,
  significant,
} from "../../../web/src/format.js";
import { secondsLeft, titleOf } from "../../../web/src/jobs.js";
import { materialOf, offeredScale, sizeWarning } from "../../../web/src/materials.js";
import { inPageWords } from "../../../web/src/ui/problem.js";
import { kindOf, readNumber } from "../../../web/src/ui/number_range.js";

it("writes lengths as a workshop does", () => {
  assert.deepEqual([0, 0.04, 3.2, 14.26, 148.4, 2354].map(millimetres), [
    "0 mm",
    "0.04 mm",
    "3.2 mm",
    "14.3 mm",
    "148 mm",
    "2.35 m",
  ]);
  assert.equal(metres(1400), "1.4 m");
  assert.equal(area(61700), "617 cm²");
  assert.equal(area(2.5e6), "2.5 m²");
  assert.equal(millimetres(undefined), "–");
  assert.equal(millimetres(0.0024), "< 0.01 mm");
});

it("writes shares, counts, sizes and times", () => {
  assert.equal(percent(0.0153), "1.53 %");
  assert.equal(count(1, "part"), "1 part");
  assert.equal(count(12345, "triangle"), "12,345 triangles");
  assert.equal(bytes(331000), "331 KB");
  assert.deepEqual([3.24, 45, 300, 7200].map(duration), ["3.2 s", "45 s", "5 min", "2 h"]);
  assert.equal(ago("2026-01-01T10:00:00Z", Date.parse("2026-01-01T10:05:00Z")), "5 min ago");
  assert.equal(significant(128.1984), "128.2");
});

it("sends booleans as on and off and leaves out what is not set", () => {
  assert.equal(
    queryOf({ e_max: 0.02, t_junctions: false, self_seams: true, tag: "", target_size: undefined }).toString(),
    "e_max=0.02&t_junctions=off&self_seams=on",
  );
});

it("says the server's problems in the page's words", () => {
  const inputs = { e_max: { title: "Tolerance" }, symmetry: { title: "Symmetry" } };
  const said = (problem) => inPageWords({ title: "No", ...problem }, inputs);
  const wrong = said({ where: "symmetry, at (1.5, -2, 3e4)", fix: "give another plane, a larger e_max, or use auto" });
  assert.equal(wrong.where, "“Symmetry”, at (1.5, -2, 3e4)");
  assert.equal(wrong.fix, "give another plane, a larger “Tolerance”, or use auto");
  assert.equal(said({ fix: "allow a larger tolerance (e_max), or less" }).fix, "allow a larger tolerance, or less");
  const died = said({ detail: "it died of signal 11 (Segmentation fault) in stage trace", where: "trace" });
  assert.equal(died.detail, "it died of signal 11 (Segmentation fault) at the stage “Tracing possible seams”");
  assert.equal(died.where, "");
  assert.equal(said({ where: "line 12" }).where, "line 12");
});

it("guesses the time that is left only when a guess is worth something", () => {
  const started = new Date(Date.parse("2026-01-01T10:00:00Z")).toISOString();
  const now = Date.parse("2026-01-01T10:00:10Z");
  assert.equal(secondsLeft({ status: "running", started, progress: 25 }, now), 30);
  assert.equal(secondsLeft({ status: "running", started, progress: 1 }, now), null);
  assert.equal(secondsLeft({ status: "accepted", progress: 0 }, now), null);
});

it("calls a job by its tag, or its file", () => {
  assert.equal(titleOf({ tag: "lamp", inputs: { mesh: { name: "x.stl" } } }), "lamp");
  assert.equal(titleOf({ inputs: { mesh: { name: "owl.v2.STL" } } }), "owl.v2");
});

it("warns of sizes that are no sizes", () => {
  assert.match(sizeWarning(3, materialOf("card")), /unit/);
  assert.match(sizeWarning(9000, materialOf("card")), /unit/);
  assert.match(sizeWarning(60, materialOf("plywood")), /bent/);
  assert.equal(sizeWarning(200, materialOf("card")), null);
});

it("reads numbers within the schema's range", () => {
  const schema = { type: "number", exclusiveMinimum: 0, maximum: 0.5, default: 0.02 };
  assert.deepEqual(readNumber(" 0,1 ", schema), [0.1, null]);
  for (const wrong of ["0", "0.6", "x", ""]) assert.ok(readNumber(wrong, schema)[1]);
  assert.deepEqual(readNumber("", { type: "number" }), [undefined, null]);
  assert.ok(readNumber("1.5", { type: "integer", default: 1 })[1]);
});

it("knows the field for each kind of parameter", () => {
  assert.equal(kindOf({ oneOf: [{ type: "number" }, { const: "off" }] }), "number-or-off");
  assert.equal(kindOf({ oneOf: [{ enum: ["off", "auto"] }, { type: "string" }] }), "words-or-text");
  assert.equal(kindOf({ enum: ["a", "b"] }), "choice");
  assert.equal(kindOf({ type: "boolean" }), "switch");
  assert.equal(kindOf({ type: "integer" }), "number");
});

it("offers a size where that of the file cannot be meant", () => {
  assert.equal(offeredScale(1.6), 125);
  assert.equal(offeredScale(20000), 0.01);
  for (const longest of [15, 210, 5000, 0, NaN]) assert.equal(offeredScale(longest), null);
});
