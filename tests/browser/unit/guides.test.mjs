// What is drawn on a mesh: strokes from places, undo, what is sent; and the places that the server talks about.
import assert from "node:assert/strict";
import { it } from "node:test";
import { Guides, Trail, alongStroke, distance, lengthOf, thinned, toSegment } from "../../../web/src/guides.js";
import { placesOf, repairsOf } from "../../../web/src/result/places.js";

const seam = { kind: "seam", points: [[0, 0, 0], [1, 0, 0]], closed: false };
const area = { kind: "keep_out", points: [[0, 0, 1]], radius: 0.5 };

/** Places on a circle, from angle 0 to `turn`. */
const circle = (turn, n = 90, radius = 10) =>
  Array.from({ length: n + 1 }, (_, k) => [
    radius * Math.cos((turn * k) / n),
    radius * Math.sin((turn * k) / n),
    0,
  ]);

function trailOf(places, step = 0.5, leap = 3) {
  const trail = new Trail(step, leap);
  for (const place of places) trail.add(place);
  return trail;
}

it("sends seams and areas as they travel, and reads them back", () => {
  const guides = new Guides();
  assert.equal(guides.wire(), null);
  guides.add(area, seam);
  const wire = guides.wire();
  assert.deepEqual(wire, {
    seams: [{ points: seam.points, closed: false }],
    keep_out: [{ points: area.points, radius: 0.5 }],
  });
  assert.deepEqual(new Guides(JSON.parse(JSON.stringify(wire))).wire(), wire);
  assert.equal(new Guides({ seams: [] }).wire(), null);
});

it("takes back every change, one at a time", () => {
  const guides = new Guides();
  let changes = 0;
  guides.onChange(() => changes++);
  guides.add(seam);
  guides.add(area);
  guides.remove(0);
  guides.clear();
  assert.equal(guides.empty, true);
  guides.clear(); // nothing to do is no change
  const seen = [];
  for (let k = 0; k < 5; k++) {
    guides.undo();
    seen.push(guides.list.map(({ kind }) => kind).join());
  }
  assert.deepEqual(seen, ["keep_out", "seam,keep_out", "seam", "", ""]);
  assert.equal(changes, 8);
});

it("makes one stroke of a smooth way, with few points and within a small error", () => {
  const places = circle(Math.PI, 400);
  const strokes = trailOf(places).strokes("seam");
  assert.equal(strokes.length, 1);
  const [{ points, closed }] = strokes;
  assert.equal(closed, false);
  assert.ok(points.length < 40, `${points.length} points`);
  assert.deepEqual(points[0], places[0]);
  for (const place of places.slice(0, -20)) {
    const off = Math.min(...points.slice(1).map((p, k) => toSegment(place, points[k], p)));
    assert.ok(off < 0.5, `${off}`);
  }
  assert.ok(Math.abs(lengthOf(strokes[0]) - 10 * Math.PI) < 0.7);
});

it("closes a line that comes back to its beginning", () => {
  assert.equal(trailOf(circle(2 * Math.PI * 0.98)).strokes("seam")[0].closed, true);
  assert.equal(trailOf(circle(2 * Math.PI * 0.8)).strokes("seam")[0].closed, false);
  assert.equal(trailOf([[0, 0, 0], [0.6, 0, 0], [1.2, 0, 0]]).strokes("seam")[0].closed, false);
});

it("begins another stroke where the pointer left the surface or jumped", () => {
  const there = [[0, 0, 0], [1, 0, 0], [2, 0, 0]];
  const beyond = [[20, 0, 5], [21, 0, 5]];
  assert.equal(trailOf([...there, ...beyond]).strokes("seam").length, 2);
  assert.equal(trailOf([...there, null, [4, 0, 0], [5, 0, 0]]).strokes("seam").length, 2);
  // A pixel beside the edge is no gap.
  assert.equal(trailOf([...there, null, [2.6, 0, 0], [3.2, 0, 0]]).strokes("seam").length, 1);
});

it("a tap paints a dab but draws no seam", () => {
  const trail = trailOf([[1, 2, 3], [1, 2, 3.01]]);
  assert.deepEqual(trail.strokes("seam"), []);
  assert.deepEqual(trail.strokes("keep_out", 4), [{ kind: "keep_out", points: [[1, 2, 3]], radius: 4 }]);
});

it("sets the brush down without gaps", () => {
  const places = alongStroke([[0, 0, 0], [10, 0, 0], [10, 1, 0]], 3);
  assert.deepEqual(places[0], [0, 0, 0]);
  assert.deepEqual(places.at(-1), [10, 1, 0]);
  for (let k = 1; k < places.length; k++) assert.ok(distance(places[k - 1], places[k]) <= 3);
  assert.deepEqual(alongStroke([[5, 5, 5]], 1), [[5, 5, 5]]);
});

it("thins a straight line to its ends and keeps a corner", () => {
  const line = Array.from({ length: 50 }, (_, k) => [k, 0, 0]);
  assert.deepEqual(thinned(line, 0.1), [line[0], line[49]]);
  assert.deepEqual(thinned([[0, 0, 0], [5, 5, 0], [10, 0, 0]], 0.1).length, 3);
});

it("finds the places that a problem names", () => {
  const mesh = {
    center: [1, 1, 1],
    positions: Float32Array.from([0, 0, 0, 3, 0, 0, 0, 3, 0]),
    indices: Uint32Array.from([0, 1, 2]),
  };
  assert.deepEqual(placesOf({ where: "at (1, 2.5, -3e1)" }, mesh), [[0, 1.5, -31]]);
  assert.deepEqual(placesOf({ where: "face 0" }, mesh), [[1, 1, 0]]);
  assert.deepEqual(placesOf({ where: "face 7" }, mesh), []);
  assert.deepEqual(placesOf({ where: "line 12", errors: [{ detail: "(2,2,2)" }] }, mesh), [[1, 1, 1]]);
  assert.deepEqual(placesOf(undefined, mesh), []);
});

it("finds the places of repairs, without those that every STL has", () => {
  const findings = [
    { kind: "duplicate-vertex", text: "9 merged", places: [[0, 0, 0]] },
    { kind: "non-manifold-edge", text: "2 cut open", places: [[1, 2, 3], [4, 5, 6]] },
    { kind: "inside-out", text: "1 inward" },
  ];
  assert.deepEqual(repairsOf({ audit: { findings } }, [1, 1, 1]), [
    { text: "2 cut open", places: [[0, 1, 2], [3, 4, 5]] },
  ]);
  assert.deepEqual(repairsOf({}, [0, 0, 0]), []);
});
