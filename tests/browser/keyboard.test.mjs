// The whole way once more without a pointer: everything can be reached and done by keys alone.
import assert from "node:assert/strict";
import { it } from "node:test";
import { inWindow, onServer } from "./support/stand.mjs";

let server;
let window;
let page;
const stand = onServer((made) => ({ server } = made));
inWindow(stand, (made) => ({ window, page } = made), {}, async () => {
  await window.goto();
  await page.getByRole("button", { name: "Choose a mesh" }).waitFor();
});

const focused = () =>
  page.evaluate(() => {
    const e = document.activeElement;
    return `${e.tagName.toLowerCase()} ${e.getAttribute("aria-label") ?? ""} ${e.textContent.trim().slice(0, 60)}`.replace(
      /\s+/g,
      " ",
    );
  });

/** Presses Tab until the focus is on something that matches; fails when the way round does not lead there. */
async function tabTo(pattern, key = "Tab") {
  const way = [];
  for (let k = 0; k < 90; k++) {
    await page.keyboard.press(key);
    const now = await focused();
    if (pattern.test(now)) return;
    way.push(now);
  }
  assert.fail(`the focus never came to ${pattern}:\n${way.join("\n")}`);
}

it("chooses a shape", async () => {
  await tabTo(/Cooling tower/);
  await page.keyboard.press("Enter");
  await page.getByRole("button", { name: "Make the sheets" }).waitFor();
});

/** Down the middle of what is seen. */
async function drawSeam() {
  await tabTo(/^input Turn/, "Shift+Tab");
  await page.keyboard.press("ArrowRight");
  await tabTo(/^canvas/);
  await page.keyboard.press("Enter");
  for (let k = 0; k < 12; k++) await page.keyboard.press("ArrowDown");
  for (const key of ["Enter", "Escape", "Escape"]) await page.keyboard.press(key);
  await page.getByText("Drawn on the shape").waitFor();
  assert.equal(await page.locator(".guide-list li").count(), 1);
}

it("turns the view, draws a seam, chooses a material and starts", async () => {
  await tabTo(/^canvas/);
  for (const key of ["ArrowLeft", "ArrowUp", "+", "0"]) await page.keyboard.press(key);
  await drawSeam();
  await tabTo(/^input/); // the unit
  await page.getByRole("radio", { name: /Card/ }).focus();
  await page.keyboard.press("ArrowDown");
  assert.ok(await page.getByRole("radio", { name: /Plywood/ }).isChecked());
  await tabTo(/Make the sheets/);
  await page.keyboard.press("Enter");
  await window.ready();
  const id = new URL(page.url()).hash.slice(5);
  const files = await (await fetch(`${server.url}api/v1/jobs/${id}/results`)).json();
  const layout = await (await fetch(new URL(files["layout.json"].href, server.url))).json();
  assert.equal(layout.guides.seams.length, 1);
  assert.ok(layout.arches.some((arch) => arch.drawn));
});

it("goes through tabs and parts by arrow keys", async () => {
  await tabTo(/^button Result/);
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.getByRole("tab", { name: "Parts" }).getAttribute("aria-selected"), "true");
  await tabTo(/^div Parts/);
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("ArrowDown");
  assert.equal(await page.locator(".part-row[aria-selected=true]").count(), 1);
  const parts = await page.locator(".parts").getByRole("option").count();
  assert.equal(await page.locator(".flat .part.chosen").getAttribute("data-part"), String(1 % parts));
  await page.keyboard.press("Escape");
  assert.equal(await page.locator(".flat .part.chosen").count(), 0);
});

it("moves and zooms the flat layout", async () => {
  const place = () => page.locator(".flat > g").nth(1).getAttribute("transform");
  const before = await place();
  await page.locator(".flat").focus();
  for (const key of ["+", "ArrowLeft"]) await page.keyboard.press(key);
  await page.waitForFunction(
    (old) => document.querySelectorAll(".flat > g")[1].getAttribute("transform") !== old,
    before,
  );
  await page.keyboard.press("0");
  await page.waitForFunction(
    (old) => document.querySelectorAll(".flat > g")[1].getAttribute("transform") === old,
    before,
  );
});

it("shows where the focus is", async () => {
  await tabTo(/^a|^button|^input/);
  const seen = await page.evaluate(() => {
    const e = document.activeElement;
    const near = [e, e.nextElementSibling].filter(Boolean).map((x) => getComputedStyle(x));
    return near.some(
      (style) => (style.outlineStyle !== "none" && style.outlineWidth !== "0px") || style.boxShadow !== "none",
    );
  });
  assert.ok(seen);
});

it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
