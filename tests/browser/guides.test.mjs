// Seams and areas without seams, drawn on the shape: with a mouse, with a finger, taken back by keys, followed by the
// result, kept by the next job.
import assert from "node:assert/strict";
import { after, before, describe, it } from "node:test";
import { Window, launch } from "./support/browser.mjs";
import { tubeStl } from "./support/meshes.mjs";
import { Server } from "./support/server.mjs";

const RADIUS = 40;
const HEIGHT = 100;

let server;
let browser;
before(async () => {
  server = await Server.start();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

const tube = () => tubeStl("tube.stl", { radius: RADIUS, height: HEIGHT, around: 64, up: 24 });

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
  before(async () => {
    window = await Window.open(browser, server);
    page = window.page;
    await window.goto();
    await page.locator("#file").setInputFiles(tube());
    await page.getByRole("button", { name: "Make the sheets" }).waitFor();
  });
  after(() => window?.close());

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
    await page.waitForTimeout(300);
    await window.shot("guides-2-result");
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

describe("with fingers", () => {
  let window;
  let page;
  let touch;
  before(async () => {
    window = await Window.open(browser, server, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
    page = window.page;
    touch = await window.context.newCDPSession(page);
    await window.goto();
    await page.locator("#file").setInputFiles(tube());
    await page.getByRole("button", { name: "Make the sheets" }).waitFor();
  });
  after(() => window?.close());

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
