// Usable by everyone and quick: axe on every state in light and dark, weight of a first visit, cost of a frame.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { after, before, it } from "node:test";
import { Window, launch } from "./support/browser.mjs";
import { letter } from "./support/meshes.mjs";
import { Server } from "./support/server.mjs";

const FIRST_VIEW_BYTES = 300 * 1024;
const FRAME_SCRIPT_MS = 8; // half of what 60 frames a second allow

let server;
let browser;
let window;
let page;
let axe;
before(async () => {
  axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
  server = await Server.start();
  browser = await launch();
  window = await Window.open(browser, server);
  page = window.page;
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

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
  assert.ok(bytes > 50 * 1024 && bytes < FIRST_VIEW_BYTES, `${bytes} bytes`);
  await session.detach();
});

it("settings are accessible", async () => {
  await page.getByText("More settings").click();
  await accessible("settings");
});

it("the result is accessible", async () => {
  await page.getByRole("button", { name: "Make the sheets" }).click();
  await window.ready();
  await accessible("result");
  await page.getByRole("tab", { name: "Parts" }).click();
  await page.getByRole("option").first().click();
  await accessible("parts");
  await page.getByRole("tab", { name: "Files" }).click();
  await accessible("files");
});

it("turning the result costs little script time a frame", async () => {
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable");
  const script = async () =>
    (await session.send("Performance.getMetrics")).metrics.find(({ name }) => name === "ScriptDuration").value * 1000;
  const box = await page.locator(".canvas3d").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.evaluate(() => {
    window.countedFrames = 0;
    const count = () => {
      window.countedFrames++;
      window.counting = requestAnimationFrame(count);
    };
    count();
  });
  const begun = await script();
  for (let k = 0; k < 40; k++) await page.mouse.move(x + 4 * k, y + k);
  const spent = (await script()) - begun;
  const frames = await page.evaluate(() => {
    cancelAnimationFrame(window.counting);
    return window.countedFrames;
  });
  await page.mouse.up();
  assert.ok(
    frames > 3 && spent / frames < FRAME_SCRIPT_MS,
    `${(spent / frames).toFixed(2)} ms script a frame over ${frames} frames`,
  );
  console.log(`script time a frame: ${(spent / frames).toFixed(2)} ms over ${frames} frames`);
});

it("first page and errors are accessible", async () => {
  await window.goto("#");
  await page.getByRole("button", { name: "Choose a mesh" }).waitFor();
  await accessible("home");
  await page.locator("#file").setInputFiles(letter());
  await page.getByRole("alert").waitFor();
  await accessible("error");
});
