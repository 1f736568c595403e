// A reload, a cancelled job and a server that goes away and comes back: nothing is lost.
import assert from "node:assert/strict";
import { it } from "node:test";
import { ball } from "./support/meshes.mjs";
import { inWindow, onServer } from "./support/stand.mjs";

let server;
let window;
let page;
const stand = onServer((made) => ({ server } = made));
inWindow(stand, (made) => ({ window, page } = made));

/** Sends a mesh and waits until its job is under way; the closer the sheets shall come, the longer it takes. */
async function begin(name, mesh, percent = 2) {
  await window.goto("#");
  await page.locator("#file").setInputFiles(ball(name, mesh));
  await page.getByLabel("Tolerance in per cent of the diagonal").fill(String(percent));
  await page.getByRole("button", { name: "Make the sheets" }).click();
  await page.locator(".progress-panel").waitFor();
}

it("a reload in mid-job comes back to the job, and to its result", async () => {
  await begin("reload.obj", { around: 80, up: 40, wave: 0.11 });
  await page.reload();
  await page.locator(".progress-panel, .figures").first().waitFor();
  await window.shot("interruption-1-reloaded");
  await window.ready();
  await page.reload();
  await window.ready();
  assert.ok((await page.locator(".flat .part").count()) > 0);
});

it("cancel stops the job and offers a way on", async () => {
  await begin("cancel.obj", { wave: 0.12 }, 0.3);
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("heading", { name: "Cancelled" }).waitFor();
  await page.getByRole("button", { name: "Try again" }).click();
  await page.getByRole("heading", { name: /Making the sheets|Waits/ }).waitFor();
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("heading", { name: "Cancelled" }).waitFor();
  await page.getByRole("button", { name: "Change settings" }).click();
  await page.getByRole("button", { name: "Make the sheets" }).waitFor();
  assert.match(await page.locator(".file-head").innerText(), /cancel\.obj/);
});

it("a server restart in mid-job is survived without a hand's turn", async () => {
  await begin("restart.obj", { around: 80, up: 40, wave: 0.13 });
  await server.end("SIGKILL"); // a server that is asked to stop lets the job end first
  await page.getByText(/No connection to the server/).waitFor();
  await window.shot("interruption-2-server-gone");
  await server.begin();
  await window.ready();
  assert.equal(await page.getByText(/No connection to the server/).count(), 0);
});

it("a result that could not be fetched is fetched as soon as the server answers", async () => {
  let missed = 0;
  for (const what of ["results", "results/layout.json*", "input"])
    await page.route(`**/api/v1/jobs/*/${what}`, (route) => (missed++ < 3 ? route.abort() : route.continue()));
  await page.reload();
  await page.getByText("The server does not answer").waitFor();
  await window.ready();
  await page.getByRole("radio", { name: "Error" }).check();
  await page.getByText(/Worst place \(marked\)/).waitFor();
  assert.ok(missed >= 3);
  await page.unrouteAll();
});

it("the list of jobs survives, too", async () => {
  await window.goto("#");
  for (const name of ["reload", "cancel", "restart"]) await page.locator(".card", { hasText: name }).first().waitFor();
  await page.locator(".card.successful", { hasText: "restart" }).locator("img").first().waitFor();
});

it("had nothing else to complain about", () => {
  // Which of its errors of the network a browser gives depends on what a broken connection was at: any of them will do.
  assert.deepEqual(window.complaintsBut(/Failed to load resource: net::ERR_/, /ERR_INCOMPLETE_CHUNKED_ENCODING/, /\b503\b/), []);
});
