// Choosing: a quick draft first, then the real thing; other tolerances as a curve whose points open their results.
import assert from "node:assert/strict";
import { it } from "node:test";
import { ball, tubeStl } from "./support/meshes.mjs";
import { inWindow, onServer } from "./support/stand.mjs";

let server;
let window;
let page;
const stand = onServer((made) => ({ server } = made));
inWindow(stand, (made) => ({ window, page } = made));

let draft; // the first job
const shownJob = async () => {
  const id = new URL(page.url()).hash.slice(5);
  return (await fetch(`${server.url}api/v1/jobs/${id}`)).json();
};

it("makes a quick draft that says so", async () => {
  await window.goto();
  await page.locator("#file").setInputFiles(tubeStl("tube.stl", { radius: 40, height: 100, around: 64, up: 24 }));
  await page.getByRole("button", { name: "Quick draft" }).click();
  await window.ready();
  assert.equal((await shownJob()).parameters.effort, "draft");
  draft = (await shownJob()).jobID;
  await page.getByText("Quick draft.").waitFor();
  await window.shot("draft-1");
});

it("compares tolerances in one job and draws them", async () => {
  await page.getByRole("button", { name: "Compare tolerances" }).click();
  await page.getByText("Every point is a result").waitFor();
  await page.locator(".trade-off").scrollIntoViewIfNeeded();
  await window.shot("draft-2-curve");
  const points = await page.locator(".chart a").count();
  const sweeps = (await (await fetch(`${server.url}api/v1/jobs?processID=sweep`)).json()).jobs;
  assert.equal(sweeps.length, 1);
  assert.equal(points, 1 + sweeps[0].report.curve.length);
  assert.equal(sweeps[0].parameters.effort, "normal", "drafts are no use where it gets fine");
  assert.equal(await page.getByRole("button", { name: "Compare tolerances" }).count(), 0);
  await page.getByRole("radio", { name: "Length to cut" }).check();
  await page.locator(".chart").getByText("metres to cut").waitFor();
  assert.equal(await page.locator(".chart a").count(), points);
  await window.shot("draft-3-cut");
});

it("opens the result of a point, which is not computed again", async () => {
  const before = (await shownJob()).jobID;
  const points = await page.locator(".chart a").count();
  const coarsest = page.locator(".chart a:not([aria-current])").last();
  const href = await coarsest.getAttribute("href");
  await coarsest.focus();
  await page.keyboard.press("Enter");
  await page.waitForFunction((old) => !location.hash.includes(old) && location.hash.split("/").length === 2, before);
  await window.ready();
  const job = await shownJob();
  assert.equal(`#job/${job.reusedFrom}/${job.parameters.e_max}`, href);
  assert.equal(job.attempt, 0);
  assert.equal(await page.locator(".flat .part").count(), job.report.patches);
  // It is a point of the same curve, now as the one that is shown.
  assert.equal(await page.locator(".chart a").count(), points);
  assert.match(await page.locator(".chart a[aria-current]").getAttribute("aria-label"), /shown now/);
  await window.shot("draft-4-point");
});

it("shows the sweep itself as a list, from which the way back leads", async () => {
  const { reusedFrom, jobID, parameters } = await shownJob();
  await window.goto(`#job/${reusedFrom}`);
  await page.locator(".points").waitFor();
  assert.equal(await page.locator(".points tbody tr").count(), 5);
  await window.shot("draft-5-sweep");
  await page.locator(`.points a[href="#job/${reusedFrom}/${parameters.e_max}"]`).click();
  await page.waitForFunction((id) => location.hash === `#job/${id}`, jobID);
  await window.ready();
});

it("makes it properly from the draft, to which the curve leads back", async () => {
  await page.getByRole("link", { name: /quick draft/ }).focus();
  await page.keyboard.press("Enter");
  await page.waitForFunction((id) => location.hash === `#job/${id}`, draft);
  await window.ready();
  await page.getByRole("button", { name: "Make it properly" }).click();
  await page.getByText("Quick draft.").waitFor({ state: "detached" });
  await window.ready();
  const job = await shownJob();
  assert.equal(job.parameters.effort, "normal");
  assert.equal(job.status, "successful");
});

it("stops a comparison and keeps what is finished, then makes the rest", async () => {
  await window.goto("#");
  await page.locator("#file").setInputFiles(ball("stop.obj", { around: 64, up: 32, wave: 0.1 }));
  await page.getByRole("button", { name: "Quick draft" }).click();
  await window.ready();
  await page.getByRole("button", { name: "Compare tolerances" }).click();
  await page.getByRole("button", { name: /Stop, keep the/ }).click();
  const rest = page.getByRole("button", { name: /Make the (\d )?missing ones?/ });
  await rest.waitFor();
  const sweeps = async () =>
    (await (await fetch(`${server.url}api/v1/jobs?processID=sweep&limit=50`)).json()).jobs.filter(
      (job) => job.inputs.mesh.name === "stop.obj",
    );
  const [stopped] = await sweeps();
  assert.equal(stopped.status, "successful");
  assert.ok(stopped.report.stopped);
  const { curve, missing } = stopped.report;
  assert.ok(curve.length > 0 && missing.length > 0);
  assert.equal(await page.locator(".chart a").count(), 1 + curve.length);
  await page.getByText(/Not made:/).waitFor();
  await rest.scrollIntoViewIfNeeded();
  await window.shot("draft-6-stopped");
  await rest.click();
  await page.getByText("Every point is a result. Choose one").waitFor();
  assert.equal(await page.locator(".chart a").count(), 1 + curve.length + missing.length);
  const [second] = await sweeps();
  assert.deepEqual(
    second.report.curve.map(({ e_max }) => e_max),
    missing,
  );
});

it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
