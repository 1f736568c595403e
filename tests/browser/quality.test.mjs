// Usable by everyone and quick: axe on every state in light and dark, weight of a first visit, cost of a frame.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { it } from "node:test";
import { Window } from "./support/browser.mjs";
import { gores } from "./support/gores.mjs";
import { cutShort, letter } from "./support/meshes.mjs";
import { inWindow, onServer } from "./support/stand.mjs";

const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const FIRST_VIEW_BYTES = 300 * 1024;
const FRAME_SCRIPT_MS = 8; // half of what 60 frames a second allow
const FRAMES = 20;

let server;
let browser;
let window;
let page;
let result; // the place of a result on the page
const stand = onServer((made) => ({ server, browser } = made));
inWindow(stand, (made) => ({ window, page } = made));

async function violations() {
  await page.evaluate(axe);
  const { violations: found } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  return found.map(
    ({ id, help, nodes }) => `${id}: ${help}: ${nodes.map((node) => node.html.slice(0, 160)).join(" | ")}`,
  );
}

/** Checks the state on show in both themes. */
async function accessible(what) {
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
    assert.deepEqual(await violations(), [], `${what}, ${colorScheme}`);
  }
}

it("a first visit up to the 3D view weighs less than 300 KB", async () => {
  const session = await page.context().newCDPSession(page);
  await session.send("Network.enable");
  let bytes = 0;
  session.on("Network.loadingFinished", ({ encodedDataLength }) => {
    bytes += encodedDataLength;
  });
  await window.goto();
  await page.getByRole("button", { name: "Ring", exact: true }).click();
  await page.getByRole("button", { name: "Make the sheets" }).waitFor();
  console.log(`first view: ${(bytes / 1024).toFixed(0)} KB`);
  assert.ok(bytes > 50 * 1024 && bytes < FIRST_VIEW_BYTES, `${bytes} bytes`);
  await session.detach();
});

it("settings are accessible", async () => {
  await page.getByText("More settings").click();
  await page.getByRole("radio", { name: "No seams" }).check();
  const box = await page.locator(".canvas3d").boundingBox();
  await page.mouse.move(box.x + 0.36 * box.width, box.y + 0.55 * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 0.6 * box.height, { steps: 5 });
  await page.mouse.up();
  await page.locator(".guide-list li").waitFor();
  await accessible("settings");
  await page.getByRole("button", { name: "Remove No seams 1" }).click();
});

it("the result is accessible", async () => {
  await page.getByRole("button", { name: "Make the sheets" }).click();
  await window.ready();
  result = new URL(page.url()).hash;
  await accessible("result");
  await page.getByRole("tab", { name: "Parts" }).click();
  await page.locator(".parts").getByRole("option").first().click();
  await accessible("parts");
  await page.getByRole("tab", { name: "Files" }).click();
  await page.locator(".sheet-preview img").waitFor();
  await page.getByText("More about the files").click();
  await accessible("files");
});

it("the comparison of tolerances is accessible", async () => {
  await page.getByRole("tab", { name: "Result" }).click();
  await page.getByRole("button", { name: "Compare tolerances" }).click();
  await page.getByText("Every point is a result").waitFor();
  await accessible("curve");
  const { jobs } = await (await fetch(`${server.url}api/v1/jobs?processID=sweep`)).json();
  await window.goto(`#job/${jobs[0].jobID}`);
  await page.locator(".points").waitFor();
  await accessible("sweep");
});

it("first page and errors are accessible", async () => {
  await window.goto("#");
  await page.getByRole("button", { name: "Choose a mesh" }).waitFor();
  await accessible("home");
  await page.locator("#file").setInputFiles(letter());
  await page.getByRole("alert").waitFor();
  await accessible("error");
  await window.goto("#");
  await page.locator("#file").setInputFiles(cutShort());
  await page.getByText(/marked in the view/).waitFor();
  await accessible("damaged file");
});

it("turning a result of 30 k triangles costs little script time a frame", async () => {
  const { obj, layout } = gores({ count: 60, rows: 250 });
  const large = await Window.open(browser, server);
  await large.page.addInitScript(() => {
    // There is no graphics card here: pixels are not what is measured.
    for (const draw of ["drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced"])
      WebGL2RenderingContext.prototype[draw] = () => {};
  });
  await large.page.route(/results\/ruled\.obj/, (route) => route.fulfill({ body: obj }));
  await large.page.route(/results\/layout\.json/, (route) => route.fulfill({ json: layout }));
  await large.goto(result);
  await large.ready();
  assert.equal(await large.page.locator(".flat .part").count(), 120);
  const milliseconds = await scriptTimeOfTurning(large.page);
  console.log(`script time a frame: ${milliseconds.toFixed(2)} ms`);
  assert.ok(milliseconds > 0 && milliseconds < FRAME_SCRIPT_MS, `${milliseconds} ms`);
  await findsByName(large.page);
  assert.deepEqual(large.complaints, []);
  await large.close();
});

/** Among many, a part or a seam is found by what is printed on it. */
async function findsByName(page) {
  await page.getByRole("tab", { name: "Parts" }).click();
  const find = page.getByLabel("Find a part or a seam");
  await find.fill("c2");
  assert.equal(await page.locator(".flat .part.chosen .part-label").textContent(), "C2");
  await find.fill("7");
  await page.getByRole("heading", { name: "Seam 7" }).waitFor();
  await find.fill("nowhere");
  await find.press("Enter");
  await page.getByText("Nothing here is called nowhere.").waitFor();
}

/** Drags the 3D view around; the script's own processor time for a frame, which other programs do not lengthen. */
async function scriptTimeOfTurning(page) {
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  const script = async () =>
    (await session.send("Performance.getMetrics")).metrics.find(({ name }) => name === "ScriptDuration").value * 1000;
  const box = await page.locator(".canvas3d").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  const begun = await script();
  for (let k = 1; k <= FRAMES; k++) {
    await page.mouse.move(x + 8 * k, y + k);
    await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  }
  const milliseconds = (await script()) - begun;
  await page.mouse.up();
  return milliseconds / FRAMES;
}
