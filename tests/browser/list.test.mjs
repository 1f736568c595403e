// The list of jobs while much happens: cards are changed in place, nothing is asked for again, what one points at stays.
import assert from "node:assert/strict";
import { it } from "node:test";
import { Window } from "./support/browser.mjs";
import { ball, strip } from "./support/meshes.mjs";
import { PHONE, inWindow, onServer } from "./support/stand.mjs";

const BURST = 16;

let server;
let browser;
let window;
let page;
const stand = onServer((made) => ({ server, browser } = made));
inWindow(stand, (made) => ({ window, page } = made), { viewport: { width: 1280, height: 2600 } }); // all cards in sight

async function submit({ name, buffer }, query = "") {
  const url = `${server.url}api/v1/processes/decompose/execution?filename=${name}${query}`;
  const answer = await fetch(url, { method: "POST", body: buffer });
  assert.equal(answer.status, 201);
  return answer.json();
}

const several = (count, name) =>
  Promise.all(Array.from({ length: count }, (_, k) => submit(strip(`${name}-${k}.obj`, k), `&tag=${name}-${k}`)));

/** From now on: cards that go, and nodes that come or go within the cards there are. */
const watchCards = () =>
  page.evaluate(() => {
    const kept = [...document.querySelectorAll(".card")];
    const seen = (window.seen = { kept, gone: 0, within: 0 });
    new MutationObserver((records) => {
      for (const { target, addedNodes, removedNodes } of records) {
        const elements = [...addedNodes, ...removedNodes].filter((node) => node.nodeType === Node.ELEMENT_NODE);
        if (kept.some((card) => card.contains(target))) seen.within += elements.length;
        else seen.gone += [...removedNodes].filter((node) => kept.includes(node)).length;
      }
    }).observe(document.querySelector(".cards"), { childList: true, subtree: true });
  });

const told = () =>
  page.evaluate(() => ({
    gone: window.seen.gone,
    within: window.seen.within,
    same: window.seen.kept.every((card) => card.isConnected),
    focus: document.activeElement.getAttribute("href"),
  }));

it("keeps its cards, the focus and the pictures through a burst of other jobs", async () => {
  const first = await several(5, "before");
  await window.goto();
  await page.waitForFunction((n) => document.querySelectorAll(".card.successful .drawing svg").length === n, first.length);
  const focused = `#job/${first[2].jobID}`;
  await page.locator(`.card[href="${focused}"]`).focus();
  await watchCards();
  const asked = [];
  page.on("request", (request) => asked.push(new URL(request.url()).pathname));
  await several(BURST, "burst");
  await page.waitForFunction((n) => document.querySelectorAll(".card.successful .drawing svg").length === n, first.length + BURST);
  assert.deepEqual(await told(), { gone: 0, within: 0, same: true, focus: focused });
  // The events say all there is to know; each new drawing is fetched once, and none of the old ones.
  const drawings = asked.filter((path) => path.endsWith("/layout.svg"));
  assert.equal(new Set(drawings).size, drawings.length, "a drawing was fetched twice");
  for (const { jobID } of first) assert.ok(!drawings.some((path) => path.includes(jobID)), "an old drawing was fetched");
  assert.deepEqual(asked.filter((path) => !path.endsWith("/layout.svg")), []);
});

it("shows progress without taking the card from under the pointer", async () => {
  const { jobID } = await submit(ball("long.obj"), "&e_max=0.003");
  const card = page.locator(`.card[href="#job/${jobID}"]`);
  await card.locator("progress").waitFor();
  await card.hover();
  await watchCards();
  const value = () => card.locator("progress").evaluate((bar) => bar.value);
  const before = await value();
  await page.waitForFunction(
    ([id, old]) => document.querySelector(`.card[href="#job/${id}"] progress`)?.value > old,
    [jobID, before],
  );
  const { gone, within } = await told();
  assert.deepEqual({ gone, within }, { gone: 0, within: 0 });
  assert.ok(await card.evaluate((element) => element.matches(":hover")));
  await fetch(`${server.url}api/v1/jobs/${jobID}`, { method: "DELETE" });
  await page.locator(`.card.dismissed[href="#job/${jobID}"]`).waitFor();
  assert.equal(await card.locator("progress").count(), 0);
  assert.ok(await page.evaluate(() => window.seen.kept.every((element) => element.isConnected)));
});

it("takes a removed job away, and only that", async () => {
  const before = await page.locator(".card").count();
  const { jobs } = await (await fetch(`${server.url}api/v1/jobs?status=dismissed`)).json();
  await fetch(`${server.url}api/v1/jobs/${jobs[0].jobID}`, { method: "DELETE" });
  await page.locator(`.card[href="#job/${jobs[0].jobID}"]`).waitFor({ state: "detached" });
  assert.equal(await page.locator(".card").count(), before - 1);
});

it("shows on a phone what runs without scrolling, on a first visit, too", async () => {
  const { jobID } = await submit(ball("phone.obj", { wave: 0.15 }), "&e_max=0.003");
  await submit(strip("later.obj", 400));
  const phone = await Window.open(browser, server, PHONE);
  await phone.goto();
  const card = phone.page.locator(".home.compact .card").first();
  await card.waitFor();
  await phone.page.locator(`.card.running[href="#job/${jobID}"]`).waitFor();
  assert.equal(await card.getAttribute("href"), `#job/${jobID}`, "what runs stands first");
  const { y, height } = await card.boundingBox();
  assert.ok(y + height <= PHONE.viewport.height, `${y} + ${height}`);
  await phone.close();
  await fetch(`${server.url}api/v1/jobs/${jobID}`, { method: "DELETE" });
});

it("shows older jobs when asked, those too that the first answer of the server did not hold", async () => {
  const cancel = ({ jobID }) => fetch(`${server.url}api/v1/jobs/${jobID}`, { method: "DELETE" });
  const busy = await submit(ball("busy.obj", { wave: 0.16 }), "&e_max=0.003"); // none of the others ends before it is cancelled
  for (let k = 0; k < 110; k++) await cancel(await submit(strip(`old-${k}.obj`, 500 + k)));
  await cancel(busy);
  const { jobs } = await (await fetch(`${server.url}api/v1/jobs?limit=1000`)).json();
  await page.reload();
  const cards = page.locator(".card");
  const older = page.getByRole("button", { name: "Older jobs" });
  await cards.first().waitFor();
  assert.equal(await cards.count(), 60);
  for (const shown of [Math.min(120, jobs.length), jobs.length]) {
    const before = await cards.count();
    await older.click();
    await page.waitForFunction((n) => document.querySelectorAll(".card").length === n, shown);
    const focused = await page.evaluate(() => [...document.querySelectorAll(".card")].indexOf(document.activeElement));
    assert.equal(focused, before, "one goes on at the first of those that came");
  }
  assert.equal(await older.isVisible(), false);
  const ids = await cards.evaluateAll((list) => list.map((card) => card.getAttribute("href").slice(5)));
  const created = new Map(jobs.map((job) => [job.jobID, job.created]));
  assert.deepEqual([...ids].sort(), [...created.keys()].sort());
  const times = ids.map((id) => created.get(id)); // jobs of one millisecond have no order
  assert.deepEqual(times, [...times].sort().reverse(), "newest first");
});

it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
