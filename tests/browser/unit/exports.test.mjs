// What a download shall be: fields from the server's parameters, and the query that is asked for.
import assert from "node:assert/strict";
import { it } from "node:test";
import {
  hintOf,
  hrefOf,
  kindOf,
  queryOfWish,
  sortedFields,
  titleOf,
  unitOf,
  usualWish,
  wordOf,
} from "../../../web/src/result/export_wish.js";

const parameters = [
  { name: "sheet_size", default: "auto", text: "Sheet: a preset", choices: ["auto", "a4"], open: true },
  { name: "kerf", default: "0", text: "mm, full width of the cut" },
  { name: "cover", default: "on", text: "PDF: cover", choices: ["on", "off"] },
  { name: "profile", default: "makerspace", text: "Colours", choices: ["makerspace", "lightburn"] },
  { name: "part", default: "", text: "Label of one part alone" },
  { name: "brand_new", default: "", text: "Something of tomorrow" },
];

it("makes a field of every kind", () => {
  assert.deepEqual(parameters.map(kindOf), ["open-choice", "number", "switch", "choice", "text", "text"]);
  assert.equal(unitOf(parameters[1]), "mm");
  assert.equal(unitOf(parameters[0]), "");
  assert.deepEqual(parameters.slice(0, 3).map(hintOf), ["Sheet: a preset", "Full width of the cut", "PDF: cover"]);
  assert.equal(hintOf({ text: "How lines are drawn: none, score", choices: ["none", "score"] }), "How lines are drawn");
});

it("shows every parameter once, those that are chosen elsewhere never", () => {
  const { first, groups } = sortedFields(parameters);
  assert.deepEqual(
    first.map(({ name }) => name),
    ["profile", "sheet_size", "kerf"],
  );
  assert.deepEqual(
    groups.map(([title, list]) => [title, list.map(({ name }) => name)]),
    [
      ["Files", ["cover"]],
      ["Other", ["brand_new"]],
    ],
  );
  assert.equal(titleOf("brand_new"), "Brand new");
  assert.equal(wordOf("sheet_size", "a4"), "A4");
  assert.equal(wordOf("sheet_size", "600x400"), "600 × 400 mm");
});

it("asks only for what differs from the defaults", () => {
  const values = { kerf: " 0.2 ", cover: "on", profile: "", part: "A1", unknown: "x" };
  const query = queryOfWish(parameters, values, { sheet: 2 });
  assert.equal(String(query), "kerf=0.2&sheet=2");
  assert.equal(hrefOf("/svg", query), "/svg?kerf=0.2&sheet=2");
  assert.equal(hrefOf("/svg", queryOfWish(parameters, {})), "/svg");
});

it("takes the material's sheet when the parts fit, turned if need be", () => {
  const paper = { id: "paper", sheet: [210, 297], preset: "a4" };
  const part = (w, d) => ({ box: [10, 10, 10 + w, 10 + d] });
  assert.deepEqual(usualWish(paper, [part(280, 190)]), { sheet_size: "a4", page: "a4" });
  assert.deepEqual(usualWish(paper, [part(280, 190), part(290, 20)]), { sheet_size: "auto", page: "a4" });
  const card = { id: "card", sheet: [297, 420], preset: "a3" };
  assert.deepEqual(usualWish(card, [part(400, 20)]), { sheet_size: "a3", page: "sheet" });
});
