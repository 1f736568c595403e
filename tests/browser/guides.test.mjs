// Seams and areas without seams, drawn on the shape: with a mouse, with a finger, taken back by keys, followed by the
// result, kept by the next job.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { describe, it } from "node:test";
import { tubeStl } from "./support/meshes.mjs";
import { PHONE, inWindow, onServer } from "./support/stand.mjs";

const RADIUS = 40;
const HEIGHT = 100;

let server;
const stand = onServer((made) => ({ server } = made));

const tube = () => tubeStl("tube.stl", { radius: RADIUS, height: HEIGHT, around: 64, up: 24 });

async function openTube(window) {
  await window.goto();
  await window.page.locator("#file").setInputFiles(tube());
  await window.page.getByRole("button", { name: "Make the sheets" }).waitFor();
}

/** Distance of a place from the tube's surface. */
const offTube = ([x, y, z]) => Math.max(Math.abs(Math.hypot(x, y) - RADIUS), -z, z - HEIGHT);

/** Presses at the first place, goes to the others and lets go; places are shares of the 3D window. */
async function drag(page, ...places) {
  const box = await page.locator(".canvas3d").boundingBox();
  const pixel = ([x, y]) => [box.x + box.width * x, box.y + box.height * y];
  await page.mouse.move(...pixel(places[0]));
  await page.mouse.down();
  for (const place of places.slice(1)) await page.mouse.move(...pixel(place), { steps: 8 });
  await page.mouse.up();
}

async function guidesOf(page) {
  const id = new URL(page.url()).hash.slice(5);
  const response = await fetch(`${server.url}api/v1/jobs/${id}/guides`);
  return { id, guides: response.ok ? await response.json() : null };
}

describe("with a mouse", () => {
  let window;
  let page;
  inWindow(stand, (made) => ({ window, page } = made), {}, () => openTube(window));

  it("a drag on the shape draws, beside it turns", async () => {
    const view = page.locator(".view3d");
    assert.equal(await page.locator(".guide-list li").count(), 0);
    await drag(page, [0.5, 0.4], [0.5, 0.7]);
    assert.equal(await page.locator(".guide-list li").count(), 0, "drawn though the pointer turns");
    await page.getByRole("button", { name: "Show all" }).click();
    await page.getByRole("radio", { name: "Draw seam" }).check();
    const plain = await view.screenshot();
    await drag(page, [0.47, 0.35], [0.47, 0.75]);
    await page.getByRole("button", { name: "Remove Seam 1" }).waitFor();
    const drawn = await view.screenshot();
    assert.ok(!drawn.equals(plain));
    await drag(page, [0.05, 0.5], [0.1, 0.5]);
    assert.equal(await page.locator(".guide-list li").count(), 1);
    assert.ok(!(await view.screenshot()).equals(drawn), "a drag beside the shape turns it");
    await page.getByRole("button", { name: "Show all" }).click();
  });

  it("paints areas as wide as the brush", async () => {
    await page.getByRole("radio", { name: "No seams" }).check();
    await window.slide("Size of the brush", 0.4);
    const brush = await page.locator(".brush .hint").innerText();
    await drag(page, [0.57, 0.5], [0.57, 0.62]);
    const row = page.locator(".guide-list li").last();
    assert.match(await row.innerText(), /No seams 1/);
    assert.ok((await row.innerText()).includes(brush), `${await row.innerText()} and ${brush}`);
    await window.shot("guides-1-drawn");
  });

  it("takes back with keys alone", async () => {
    await drag(page, [0.53, 0.5], [0.53, 0.6]);
    assert.equal(await page.locator(".guide-list li").count(), 3);
    await page.keyboard.press("Control+z");
    assert.equal(await page.locator(".guide-list li").count(), 2);
    await page.getByRole("button", { name: "Remove Seam 1" }).focus();
    await page.keyboard.press("Enter");
    assert.equal(await page.locator(".guide-list li").count(), 1);
    // The focus stays where it can go on.
    assert.equal(await page.evaluate(() => document.activeElement.getAttribute("aria-label")), "Remove No seams 1");
    await page.keyboard.press("Control+z");
    assert.equal(await page.locator(".guide-list li").count(), 2);
    await page.keyboard.press("Escape");
    assert.ok(await page.getByRole("radio", { name: "Turn" }).isChecked());
  });

  it("sends them with the mesh, and the result follows them", async () => {
    await page.getByRole("button", { name: "Quick draft" }).click();
    await window.ready();
    const { id, guides } = await guidesOf(page);
    assert.equal(guides.seams.length, 1);
    assert.equal(guides.keep_out.length, 1);
    const places = [...guides.seams, ...guides.keep_out].flatMap(({ points }) => points);
    for (const place of places) assert.ok(offTube(place) < 0.5, `${place} is ${offTube(place)} off the tube`);
    const [low, high] = [guides.seams[0].points.at(-1)[2], guides.seams[0].points[0][2]];
    assert.ok(high - low > HEIGHT / 4, `the seam runs from ${low} to ${high}`);
    const files = await (await fetch(`${server.url}api/v1/jobs/${id}/results`)).json();
    const layout = await (await fetch(new URL(files["layout.json"].href, server.url))).json();
    assert.deepEqual(layout.guides, guides);
    assert.ok(layout.arches.some((arch) => arch.drawn));
    await page.getByRole("checkbox", { name: "Your mesh" }).check();
    await window.drawn();
    await window.shot("guides-2-result");
  });

  it("gives commands that make the same job again, drawing included", async () => {
    const first = await guidesOf(page);
    await page.getByRole("tab", { name: "Files" }).click();
    await page.getByText("Make it again").click();
    const command = (name) => page.getByRole("group", { name }).innerText();
    const folder = await mkdtemp(path.join(tmpdir(), "sheetform-again-"));
    await writeFile(path.join(folder, "tube.stl"), tube().buffer);
    const run = (line) => execFileSync("/bin/sh", ["-c", line.replace(/^curl/, "curl -sS --fail")], { cwd: folder });
    run(await command("Fetch it"));
    const again = JSON.parse(run(await command("Over HTTP")));
    await rm(folder, { recursive: true });
    assert.equal(again.reusedFrom, first.id, "the same mesh, drawing and settings");
    const guides = await (await fetch(`${server.url}api/v1/jobs/${again.jobID}/guides`)).json();
    assert.deepEqual(guides, first.guides);
    await page.getByRole("tab", { name: "Result" }).click();
  });

  it("keeps them when the job is run again with other settings", async () => {
    const before = await guidesOf(page);
    await page.getByRole("button", { name: "Run again with …" }).click();
    await page.getByRole("button", { name: "Remove Seam 1" }).waitFor();
    await page.getByRole("button", { name: "Remove No seams 1" }).click();
    await page.getByRole("button", { name: "Quick draft" }).click();
    await page.waitForFunction((id) => location.hash.startsWith("#job/") && !location.hash.includes(id), before.id);
    await window.ready();
    const now = await guidesOf(page);
    assert.deepEqual(now.guides, { seams: before.guides.seams, keep_out: [] });
    await page.getByRole("button", { name: "Make it properly" }).click();
    await page.waitForFunction((id) => !location.hash.includes(id), now.id);
    assert.deepEqual((await guidesOf(page)).guides, now.guides);
  });

  it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
});

describe("by keys alone", () => {
  let window;
  let page;
  inWindow(stand, (made) => ({ window, page } = made), {}, () => openTube(window));

  const said = () => page.locator("#live").innerText();
  const rows = () => page.locator(".guide-list li");
  const press = async (key, times = 1) => {
    for (let k = 0; k < times; k++) await page.keyboard.press(key);
  };

  it("a way of drawing leads to the cross on the shape", async () => {
    await page.getByRole("radio", { name: "Turn" }).focus();
    await press("ArrowRight");
    assert.match(await page.locator(".draw-hint").innerText(), /Enter/);
    await press("Enter");
    assert.ok(await page.locator(".canvas3d").evaluate((canvas) => canvas === document.activeElement));
    assert.ok(await page.locator(".cross").isVisible());
    assert.equal(await page.locator(".canvas3d").getAttribute("role"), "application");
    assert.match(await page.locator(".draw-hint").innerText(), /Backspace takes it back, Escape ends/);
  });

  it("arrows move, Enter sets, Backspace takes back, and each is told", async () => {
    await press("Enter");
    assert.match(await said(), /First point/);
    await press("ArrowDown", 10);
    await press("Enter");
    assert.match(await said(), /Point 2, .* mm long/);
    await press("ArrowRight", 5);
    await press("Enter");
    await press("Backspace");
    assert.match(await said(), /taken back, 2 left/);
    await press("ArrowLeft", 80);
    await press("Enter");
    assert.match(await said(), /beside the shape/);
    await press("ArrowRight", 80);
    assert.equal(await rows().count(), 0, "not yet ended");
    await window.shot("guides-5-keys");
    await press("Backspace", 2);
    assert.match(await said(), /none left/);
  });

  it("the line goes on after the shape was turned, and Escape ends it", async () => {
    await press("Home"); // the view; the cross stays where it is
    const box = await page.locator(".canvas3d").boundingBox();
    await press("ArrowLeft", Math.ceil(box.width / 8));
    await press("ArrowUp", Math.ceil(box.height / 8));
    await press("ArrowRight", Math.round(box.width / 16));
    await press("ArrowDown", Math.round(box.height / 16));
    await press("Enter");
    await press("Shift+ArrowLeft", 3);
    await press("ArrowRight", 2);
    await press("Enter");
    assert.match(await said(), /Point 2, .* mm long/);
    await press("Escape");
    assert.match(await said(), /Seam drawn/);
    assert.equal(await rows().count(), 1);
    assert.ok(await page.getByRole("radio", { name: "Draw seam" }).isChecked(), "the next line may follow");
    await press("Escape");
    assert.ok(await page.getByRole("radio", { name: "Turn" }).isChecked());
    assert.ok(!(await page.locator(".cross").isVisible()));
    assert.equal(await page.locator(".canvas3d").getAttribute("role"), "img");
  });

  it("a line that comes back to its beginning is closed", async () => {
    await page.getByRole("radio", { name: "Turn" }).focus();
    await press("ArrowRight");
    await press("Enter");
    for (const key of ["ArrowRight", "ArrowDown", "ArrowLeft"]) {
      await press("Enter");
      await press(key, 6);
    }
    await press("Enter");
    await press("ArrowUp", 6);
    await press("Enter");
    assert.match(await rows().last().innerText(), /closed/);
  });

  it("paints areas, and what was drawn lies on the shape", async () => {
    await page.getByRole("radio", { name: "Draw seam" }).focus();
    await press("ArrowRight");
    await press("Enter");
    await press("ArrowUp", 8);
    await press("Enter");
    await press("ArrowUp", 4);
    await window.shot("guides-6-keys-area");
    await press("Enter");
    await press("Escape");
    assert.equal(await rows().count(), 3);
    await page.getByRole("button", { name: "Quick draft" }).click();
    await window.ready();
    const { guides } = await guidesOf(page);
    assert.deepEqual(guides.seams.map(({ closed }) => closed), [false, true]);
    assert.equal(guides.keep_out.length, 1);
    for (const place of [...guides.seams, ...guides.keep_out].flatMap(({ points }) => points))
      assert.ok(offTube(place) < 0.5, `${place} is ${offTube(place)} off the tube`);
  });

  it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
});

describe("with fingers", () => {
  let window;
  let page;
  let touch;
  inWindow(stand, (made) => ({ window, page } = made), PHONE, async () => {
    touch = await window.context.newCDPSession(page);
    await openTube(window);
  });

  /** Fingers at places (shares of the 3D window), step by step; each step is a list of places. */
  async function fingers(...steps) {
    const box = await page.locator(".canvas3d").boundingBox();
    const points = (places) => places.map(([x, y], id) => ({ x: box.x + box.width * x, y: box.y + box.height * y, id }));
    let down = 0;
    for (const places of steps) {
      const type = places.length > down ? "touchStart" : "touchMove";
      down = places.length;
      await touch.send("Input.dispatchTouchEvent", { type, touchPoints: points(places) });
    }
    await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  }

  it("one finger draws", async () => {
    await page.getByRole("radio", { name: "Draw seam" }).check({ force: true });
    await fingers([[0.47, 0.4]], [[0.47, 0.5]], [[0.47, 0.6]], [[0.47, 0.7]]);
    await page.locator(".guide-list li").waitFor();
    assert.equal(await page.locator(".guide-list li").count(), 1);
    await window.shot("guides-3-phone");
  });

  it("two fingers zoom and draw nothing", async () => {
    const view = page.locator(".view3d");
    const before = await view.screenshot();
    await fingers(
      [[0.47, 0.5]],
      [[0.47, 0.5], [0.53, 0.5]],
      [[0.4, 0.5], [0.6, 0.5]],
      [[0.3, 0.5], [0.7, 0.5]],
    );
    assert.equal(await page.locator(".guide-list li").count(), 1);
    assert.ok(!(await view.screenshot()).equals(before), "the view has not changed");
    await window.shot("guides-4-zoomed");
  });

  it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
});
