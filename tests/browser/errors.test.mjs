// What goes wrong is said in words: what, where, and what to do.
import assert from "node:assert/strict";
import { it } from "node:test";
import { ball, cutShort, finned, flatLine, letter, tubeStl } from "./support/meshes.mjs";
import { inWindow, onServer } from "./support/stand.mjs";

let server;
let browser;
let window;
let page;
const stand = onServer((made) => ({ server, browser } = made));
inWindow(stand, (made) => ({ window, page } = made));

it("a letter is not a mesh, and the page says so before anything is sent", async () => {
  await window.goto();
  await page.locator("#file").setInputFiles(letter());
  const words = await page.getByRole("alert").innerText();
  assert.match(words, /not a mesh/);
  assert.match(words, /STL, OBJ, PLY or OFF/);
  await window.shot("error-1-letter");
  await page.getByRole("button", { name: "Choose another file" }).click();
  await page.getByRole("button", { name: "Choose a mesh" }).waitFor();
});

it("a damaged file is shown as far as it goes, and where it is damaged", async () => {
  await window.goto("#");
  await page.locator("#file").setInputFiles(cutShort());
  const words = await page.getByRole("alert").innerText();
  assert.match(words, /cut short: of 2,304 triangles 1,727 are there/);
  assert.match(words, /marked in the view/);
  assert.match(words, /What to do/);
  assert.ok((await window.pixelsOf("--bad")) > 50, "no mark is seen");
  assert.equal(await page.getByRole("button", { name: "Make the sheets" }).count(), 0);
  await window.shot("error-4-damaged");
  await page.getByRole("button", { name: "Choose another file" }).click();
  await page.getByRole("button", { name: "Choose a mesh" }).waitFor();
});

it("one bad file among several spoils nothing", async () => {
  await page.locator("#file").setInputFiles([letter(), tubeStl("good.stl")]);
  await page.getByRole("alert").waitFor();
  await page.getByRole("button", { name: "good.stl" }).click();
  assert.ok(await page.getByRole("button", { name: "Make the sheets" }).isEnabled());
});

it("a mesh that the server refuses is explained with what to do", async () => {
  await window.goto("#");
  await page.locator("#file").setInputFiles(flatLine());
  await page.getByRole("button", { name: "Make the sheets" }).click();
  const box = page.locator(".problem");
  await box.waitFor();
  await box.getByText(/marked in the view/).waitFor();
  const words = await box.innerText();
  assert.match(words, /have no area/);
  assert.match(words, /on a line from \(0, 0, 0\) to \(3, 0, 0\)/i);
  assert.match(words, /What to do/);
  assert.ok((await window.pixelsOf("--bad")) > 50, "no mark is seen");
  await window.shot("error-2-refused");
});

it("a setting that does not fit the mesh is explained with the place, and can be changed", async () => {
  await window.goto("#");
  await page.locator("#file").setInputFiles(ball("lopsided.obj", { around: 48, up: 24, wave: 0.3 }));
  await page.getByText("More settings").click();
  await page.getByLabel("Symmetry", { exact: true }).selectOption("own value …");
  await page.getByLabel("Symmetry, value").fill("0,1,0,0");
  await page.getByRole("button", { name: "Make the sheets" }).click();
  const box = page.locator(".problem");
  await box.getByText(/marked in the view/).waitFor();
  const words = await box.innerText();
  assert.match(words, /not symmetric/);
  assert.match(words, /“Symmetry”, at \(/);
  assert.match(words, /a larger “Tolerance”/);
  assert.ok((await window.pixelsOf("--bad")) > 50, "no mark is seen");
  await window.shot("error-5-not-symmetric");
  await page.getByRole("button", { name: "Change settings" }).click();
  await page.getByRole("button", { name: "Make the sheets" }).waitFor();
  assert.equal(await page.getByLabel("Symmetry, value").inputValue(), "0,1,0,0");
  await page.getByText("More settings").click();
});

it("a number out of range is refused where it is typed", async () => {
  await window.goto("#");
  await page.locator("#file").setInputFiles(tubeStl());
  await page.getByText("More settings").click();
  await page.getByLabel("Most sides of a part").fill("9");
  await page.getByText("At most 6 is allowed.").waitFor();
  assert.ok(await page.getByRole("button", { name: "Make the sheets" }).isDisabled());
  await page.getByLabel("Most sides of a part").fill("5");
  assert.ok(await page.getByRole("button", { name: "Make the sheets" }).isEnabled());
  await page.getByText("More settings").click();
});

it("shows where a mesh was repaired", async () => {
  await window.goto("#");
  await page.locator("#file").setInputFiles(finned());
  await page.getByText(/8 edges of the mesh have more than two faces/).waitFor();
  await page.getByRole("button", { name: "Quick draft" }).click();
  await window.ready();
  const id = new URL(page.url()).hash.slice(5);
  const files = await (await fetch(`${server.url}api/v1/jobs/${id}/results`)).json();
  const { audit } = await (await fetch(new URL(files["layout.json"].href, server.url))).json();
  const finding = audit.findings.find(({ kind }) => kind === "non-manifold-edge");
  assert.equal(finding.places.length, 8);
  for (const [x] of finding.places) assert.equal(x, 40);
  const view = page.locator(".view3d");
  const before = await view.screenshot();
  const button = page.getByRole("button", { name: /Show where: 8 edges/ });
  await button.click();
  await window.drawn();
  assert.equal(await button.getAttribute("aria-pressed"), "true");
  const marked = await view.screenshot({ path: `${process.env.SHEETFORM_ARTEFACTS ?? "artefacts"}/error-3-repaired.png` });
  assert.ok(!marked.equals(before), "nothing was marked");
  await button.click();
  await window.drawn();
  assert.ok((await view.screenshot()).equals(before), "the marks stay");
});

it("a job that is not there is told apart from one that failed", async () => {
  await window.goto("#job/00000000-0000-4000-8000-000000000000");
  assert.match(await page.getByRole("alert").innerText(), /job/i);
  await page.getByRole("link", { name: "All jobs", exact: true }).click();
  await page.getByRole("button", { name: "Choose a mesh" }).waitFor();
});

it("had nothing else to complain about", () => {
  // The browser itself notes refused requests on its console.
  assert.deepEqual(window.complaintsBut(/Failed to load resource.*\b4\d\d\b/), []);
});
