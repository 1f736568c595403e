// Choosing: a quick draft first, then the real thing; other tolerances as a curve whose points open their results.
import assert from "node:assert/strict";
import { after, before, it } from "node:test";
import { Window, launch } from "./support/browser.mjs";
import { tubeStl } from "./support/meshes.mjs";
import { Server } from "./support/server.mjs";

let server;
let browser;
let window;
let page;
before(async () => {
  server = await Server.start();
  browser = await launch();
  window = await Window.open(browser, server);
  page = window.page;
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

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
  await page.getByText("Quick draft.").waitFor();
  await window.shot("draft-1");
});

it("tries other tolerances and draws them", async () => {
  await page.getByRole("button", { name: "Try other tolerances" }).click();
  await page.waitForFunction(() => document.querySelectorAll(".chart a").length >= 4, null);
  await page.locator(".trade-off .busy").waitFor({ state: "detached" });
  await page.locator(".trade-off").scrollIntoViewIfNeeded();
  await window.shot("draft-2-curve");
  const points = await page.locator(".chart a").count();
  await page.getByRole("radio", { name: "Length to cut" }).check();
  await page.locator(".chart").getByText("metres to cut").waitFor();
  assert.equal(await page.locator(".chart a").count(), points);
  await window.shot("draft-3-cut");
});

it("opens the result of a point", async () => {
  const before = (await shownJob()).jobID;
  const coarsest = page.locator(".chart a:not([aria-current])").last();
  const href = await coarsest.getAttribute("href");
  await coarsest.focus();
  await page.keyboard.press("Enter");
  await page.waitForFunction((hash) => location.hash === hash, href);
  await window.ready();
  assert.notEqual((await shownJob()).jobID, before);
});

it("makes it properly from the draft", async () => {
  await page.getByRole("button", { name: "Make it properly" }).click();
  await page.getByText("Quick draft.").waitFor({ state: "detached" });
  await window.ready();
  const job = await shownJob();
  assert.equal(job.parameters.effort, "normal");
  assert.equal(job.status, "successful");
});

it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
