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
  toRemember,
  firstValues,
  wordOf,
} from "../../../web/src/result/export_wish.js";

const parameters = [
  { name: "sheet_size", default: "auto", text: "Sheet", type: "size", group: "sheet", choices: ["auto"], open: true },
  { name: "kerf", default: "0", text: "Width of the cut (mm)", type: "number", unit: "mm", group: "joints" },
  { name: "cover", default: "on", text: "Cover: on or off", type: "switch", group: "file", choices: ["on", "off"] },
  { name: "profile", default: "", text: "Colours: a, b", type: "choice", group: "file", choices: ["a", "b"] },
  { name: "part", default: "", text: "Label of one part alone", type: "text", group: "sheet" },
  { name: "tab_angle", default: "60", text: "Flanks", type: "number", unit: "degrees", group: "joints" },
  { name: "brand_new", default: "", text: "Something of tomorrow", type: "text", group: "tomorrow" },
];

it("makes a field of every kind", () => {
  assert.deepEqual(parameters.map(kindOf), [
    "open-choice",
    "number",
    "switch",
    "choice",
    "text",
    "number",
    "text",
  ]);
  assert.deepEqual(parameters.map(unitOf), ["", "mm", "", "", "", "°", ""]);
  assert.deepEqual(parameters.slice(1, 4).map(hintOf), ["Width of the cut", "Cover", "Colours"]);
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
      ["Joints and material", ["tab_angle"]],
      ["Other", ["brand_new"]],
    ],
  );
  assert.equal(titleOf("brand_new"), "Brand new");
  assert.equal(wordOf("sheet_size", "a4"), "A4");
  assert.equal(wordOf("sheet_size", "600x400"), "600 × 400 mm");
  assert.match(wordOf("profile", "makerspace"), /red cuts/);
  assert.equal(wordOf("profile", "of-this-workshop"), "of-this-workshop");
  assert.equal(wordOf("rulings", "none"), "none");
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
  const printed = { ruling_step: "10", profile: "print", tabs: "one" };
  const fits = { sheet_size: "a4", page: "sheet", margin: "10", ...printed };
  assert.deepEqual(usualWish(paper, [part(260, 170)]), fits, "a page a sheet, not four");
  const large = { sheet_size: "auto", page: "a4", ...printed };
  assert.deepEqual(usualWish(paper, [part(260, 170), part(280, 20)]), large);
  const card = { id: "card", sheet: [297, 420], preset: "a3" };
  assert.deepEqual(usualWish(card, [part(400, 20)]), { sheet_size: "a3", page: "sheet", ruling_step: "10" });
  const plywood = { id: "plywood", sheet: [600, 400], preset: "600x400", stiff: true };
  assert.deepEqual(usualWish(plywood, [part(400, 20)]), { sheet_size: "600x400", page: "sheet", rulings: "ticks" });
});

it("remembers the workshop's choices, not the model's", () => {
  const usual = { sheet_size: "a4", page: "sheet", profile: "print", tabs: "one" };
  const chosen = { ...usual, sheet_size: "a3", profile: "silhouette", copies: "3" };
  const kept = toRemember(chosen);
  assert.deepEqual(kept, { profile: "silhouette", tabs: "one" });
  assert.deepEqual(firstValues(usual, kept), { ...usual, profile: "silhouette" });
});
