// The page's picture of a result: parts, seams, folding without stretch, its own measuring of the promises.
import { spread } from "../../../web/src/result/spread.js";
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { bendColors, bendRadii } from "../../../web/src/result/bend.js";
import { countInner, measureSeams, measureStretch, partsThatCross } from "../../../web/src/result/checks.js";
import { foldPart, foldSteps, hinges } from "../../../web/src/result/fold.js";
import { labelPlace } from "../../../web/src/result/label_place.js";
import { colorsOf, parseResult } from "../../../web/src/result/parse_result.js";
import { seamPlaces } from "../../../web/src/result/seam_places.js";
import { gores } from "../support/gores.mjs";

const FRAME = { origin: [5, -3, 2], x: [0, 1, 0], y: [0, 0, 1] };

function model(options) {
  const { obj, layout } = gores(options);
  return parseResult(obj, layout);
}

describe("numbers of seams", () => {
  it("stand half way along each run, wherever the outline begins", () => {
    const points = [0, 0, 4, 0, 4, 2, 0, 2];
    const square = { outline: [0, 1, 2, 3], outlineSeams: [7, 7, -1, 9] };
    assert.deepEqual(seamPlaces(square, points, 2), [
      { seam: 7, at: [3, 0], vertex: 0 },
      { seam: 9, at: [0, 1], vertex: 3 },
    ]);
    const turned = { outline: [1, 2, 3, 0], outlineSeams: [7, -1, 9, 7] };
    assert.deepEqual(
      seamPlaces(turned, points, 2).sort((a, b) => a.seam - b.seam),
      seamPlaces(square, points, 2),
    );
  });
  it("one seam all around has one place, a part joined to itself two", () => {
    const points = [0, 0, 1, 0, 1, 1, 0, 1];
    const places = (outlineSeams) => seamPlaces({ outline: [0, 1, 2, 3], outlineSeams }, points, 2);
    assert.deepEqual(places([5, 5, 5, 5]), [{ seam: 5, at: [1, 1], vertex: 1 }]);
    assert.deepEqual(
      places([5, 1, 5, 2]).filter(({ seam }) => seam === 5),
      [
        { seam: 5, at: [0.5, 0], vertex: 0 },
        { seam: 5, at: [0.5, 1], vertex: 2 },
      ],
    );
  });
});

/** A cone of paper: its seam with itself ends at the apex, a vertex with one place in the sheet. */
function cone(sides) {
  const obj = [`v 0 0 2`, `vt 0 0`];
  for (let k = 0; k <= sides; k++) {
    const a = (2 * Math.PI * k) / sides;
    if (k < sides) obj.push(`v ${Math.cos(a)} ${Math.sin(a)} 0`);
    obj.push(`vt ${Math.cos(a / 3)} ${Math.sin(a / 3)}`);
  }
  obj.push("g patch_0");
  for (let k = 0; k < sides; k++) obj.push(`f 1/1 ${k + 2}/${k + 2} ${((k + 1) % sides) + 2}/${k + 3}`);
  const rim = Array.from({ length: sides + 1 }, (_, k) => (k % sides) + 1);
  const layout = {
    patches: [{ id: 0, rulings: [] }],
    arches: [
      { id: 0, vertices: rim, patches: [0, null] },
      { id: 1, vertices: [1, 0], patches: [0, 0] },
    ],
  };
  return parseResult(obj.join("\n"), layout);
}

describe("a seam that ends inside its part", () => {
  const paper = cone(9);
  it("has a number on either side, none at its tip", () => {
    for (const [points, size] of [[paper.flat, 2], [paper.position, 3]]) {
      const tip = Array.from(points.slice(0, size));
      const numbers = seamPlaces(paper.parts[0], points, size).filter(({ seam }) => seam === 1);
      assert.equal(numbers.length, 2);
      for (const { at } of numbers) assert.ok(Math.hypot(...at.map((x, k) => x - tip[k])) > 0.4);
    }
  });
  it("is one seam of the part with itself", () => {
    assert.deepEqual([...paper.parts[0].seams].sort(), [0, 1]);
    assert.deepEqual(paper.parts[0].tips, [paper.parts[0].begin]);
    assert.ok(paper.seams[1].self);
  });
});

describe("parsing", () => {
  const it16 = model({ scale: 2 });
  it("finds parts, outlines, rulings and seams", () => {
    assert.equal(it16.parts.length, 16);
    for (const part of it16.parts) {
      assert.equal(part.outline.length, 14); // 7 rows, two sides
      assert.equal(part.rulingCount, 5);
      assert.ok(part.rulings.length / 2 <= 5);
      assert.equal(part.seams.length, 4);
    }
    assert.equal(it16.seams.filter((seam) => seam.border).length, 16);
    assert.equal(it16.seams.length, 16 + 16 + 8);
  });
  it("measures areas in mm² of the finished object", () => {
    const once = model({ scale: 1 });
    it16.parts.forEach((part, k) => assert.ok(Math.abs(part.area / once.parts[k].area - 4) < 1e-9));
  });
  it("gives neighbours different colours", () => {
    const { layout } = it16;
    for (const {
      patches: [p, q],
    } of layout.arches) {
      if (q !== null) assert.notEqual(it16.colors[it16.partIndex.get(p)], it16.colors[it16.partIndex.get(q)]);
    }
    assert.deepEqual(colorsOf(layout), it16.colors);
  });
});

describe("folding", () => {
  const result = model({ scale: 2.5 });
  const fold = (part, share) => {
    const out = new Float64Array(result.position.length);
    foldPart(
      part,
      hinges(part, result.position, result.flat),
      result.position,
      result.flat,
      result.scale,
      typeof share === "number" ? { bend: share, travel: share } : share,
      FRAME,
      out,
    );
    return out;
  };
  const edges = (part) =>
    Array.from({ length: part.triangles.length }, (_, k) => [
      part.triangles[k],
      part.triangles[k % 3 === 2 ? k - 2 : k + 1],
    ]);
  const length = (p, a, b) => Math.hypot(p[3 * a] - p[3 * b], p[3 * a + 1] - p[3 * b + 1], p[3 * a + 2] - p[3 * b + 2]);

  it("keeps every length at every step", () => {
    for (const part of result.parts) {
      for (const share of [0, 0.13, 0.5, 0.9, { bend: 0.3, travel: 0.8 }, { bend: 0, travel: 1 }, foldSteps(0.4)]) {
        const out = fold(part, share);
        for (const [a, b] of edges(part)) assert.ok(Math.abs(length(out, a, b) - length(result.position, a, b)) < 1e-9);
      }
    }
  });
  it("ends in the shape", () => {
    for (const part of result.parts) {
      const out = fold(part, 1 - 1e-9);
      for (let k = 3 * part.begin; k < 3 * part.end; k++)
        assert.ok(Math.abs(out[k] - result.position[k]) < 1e-5, `${part.label}`);
    }
  });
  it("begins in the layout", () => {
    for (const part of result.parts) {
      const out = fold(part, 0);
      for (let v = part.begin; v < part.end; v++) {
        for (let axis = 0; axis < 3; axis++) {
          const wanted =
            FRAME.origin[axis] +
            (result.flat[2 * v] * FRAME.x[axis] + result.flat[2 * v + 1] * FRAME.y[axis]) / result.scale;
          assert.ok(Math.abs(out[3 * v + axis] - wanted) < 1e-9);
        }
      }
    }
  });
});

describe("the page's own measuring", () => {
  it("finds a true result true", () => {
    const result = model({ scale: 3 });
    assert.ok(measureStretch(result).share < 1e-12);
    assert.ok(measureSeams(result) < 1e-9);
    assert.deepEqual(partsThatCross(result), []);
    assert.equal(countInner(result), 0);
  });
  it("finds a stretched sheet", () => {
    const result = model();
    result.flat[0] += 0.01;
    assert.ok(measureStretch(result).absolute > 0.005);
    assert.ok(measureSeams(result) > 1e-5);
  });
  it("finds a sheet that crosses itself", () => {
    const result = model();
    const part = result.parts[3];
    // Left and right change places in one row: the outline crosses itself.
    const [a, b] = [2 * part.outline[2], 2 * part.outline[11]];
    for (const k of [0, 1]) [result.flat[a + k], result.flat[b + k]] = [result.flat[b + k], result.flat[a + k]];
    assert.deepEqual(partsThatCross(result), [part.label]);
  });
});

describe("bending", () => {
  // A profile along a circle of radius 100: the gores bend with that radius, whatever the reach.
  const round = model({ rows: 80, height: 120, radius: (t) => 10 + Math.sqrt(100 ** 2 - (120 * t - 60) ** 2) });
  for (const reach of [1, 6, 20]) {
    it(`finds the radius of a circle with a reach of ${reach} mm`, () => {
      const radii = round.parts
        .flatMap((part) => bendRadii(part, round.position, round.flat, reach))
        .filter((r) => r < 1000)
        .sort((a, b) => a - b);
      const middle = radii[radii.length >> 1];
      // A window holds a whole number of hinges, which costs up to a fifth.
      assert.ok(Math.abs(middle - 100) < 20, String(middle));
    });
  }
  it("judges by the material", () => {
    const result = model();
    assert.match(bendColors(result, { title: "Paper", radius: 0.001 }).text, /can do that/);
    assert.match(bendColors(result, { title: "Plank", radius: 1e4 }).text, /thinner stock/);
    assert.equal(bendColors(result, { title: "Paper", radius: 0.001 }).easy, 1);
  });
  it("tells how much of the sheets bends easily", () => {
    // All of it lies on a circle of radius 100; towards the ends a window holds a hinge less and finds more.
    assert.ok(bendColors(round, { title: "Card", radius: 50 }).easy > 0.999);
    const hard = bendColors(round, { title: "Plank", radius: 200 }).easy;
    assert.ok(hard >= 0 && hard < 0.1, String(hard));
  });
});

describe("places of labels", () => {
  it("lie in the middle of a square", () => {
    const place = labelPlace(Uint32Array.of(0, 1, 2, 3), Float64Array.of(0, 0, 10, 0, 10, 10, 0, 10));
    assert.ok(Math.hypot(place.x - 5, place.y - 5) < 0.4 && place.room > 4.6);
  });
  it("lie inside an L", () => {
    const place = labelPlace(Uint32Array.of(0, 1, 2, 3, 4, 5), Float64Array.of(0, 0, 10, 0, 10, 2, 2, 2, 2, 10, 0, 10));
    assert.ok(place.room > 0.8);
  });
});

it("pushes numbers apart that would lie on each other, and leaves the others alone", () => {
  const places = [[0, 0], [1, 0], [1, 0], [50, 50]];
  const moved = spread(places, 10);
  for (let i = 0; i < 4; i++)
    for (let j = 0; j < i; j++) {
      const gap = Math.hypot(moved[i][0] - moved[j][0], moved[i][1] - moved[j][1]);
      assert.ok(gap > 9, `${i} and ${j} are ${gap} apart`);
    }
  assert.deepEqual(moved[3], [50, 50]);
  assert.ok(Math.hypot(...moved[0]) < 20);
  assert.deepEqual(spread([], 10), []);
});
