// Several files dropped at once, one of which stands on its side: what belongs to each, to all, and to whoever is shown it.
import assert from "node:assert/strict";
import { it } from "node:test";
import { Window } from "./support/browser.mjs";
import { tubeStl } from "./support/meshes.mjs";
import { inWindow, onServer } from "./support/stand.mjs";

let server;
let browser;
let window;
let page;
const stand = onServer((made) => ({ server, browser } = made));
inWindow(stand, (made) => ({ window, page } = made));

const FILES = [tubeStl("lying.stl", { radius: 40, height: 100 }), tubeStl("standing.stl", { radius: 30, height: 120 })];
const up = (on = page) => on.getByLabel("Which way is up");

it("takes several files dropped on the page", async () => {
  await window.goto();
  const files = await page.evaluateHandle((list) => {
    const carried = new DataTransfer();
    for (const [name, text] of list) carried.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
    return carried;
  }, FILES.map(({ name, buffer }) => [name, buffer.toString("base64")]));
  await page.dispatchEvent("body", "dragenter", { dataTransfer: files });
  await page.getByText("Drop to begin").waitFor();
  await page.dispatchEvent("body", "drop", { dataTransfer: files });
  await page.getByRole("button", { name: "Make sheets of 2 meshes" }).waitFor();
  assert.equal(await page.getByText("Drop to begin").isVisible(), false);
});

it("turns one upright, and gives all the same material", async () => {
  assert.equal(await up().inputValue(), "z");
  assert.equal(await page.locator(".axis.height").innerText(), "z ↕");
  const before = await page.locator(".canvas3d").screenshot();
  await up().selectOption("x");
  assert.equal(await page.locator(".axis.height").innerText(), "x ↕");
  assert.ok(!(await page.locator(".canvas3d").screenshot()).equals(before), "the shape did not turn");
  await page.getByRole("radio", { name: /Plywood/ }).check();
  await page.getByText("More settings").click();
  await page.getByLabel("Most sides of a part").fill("5");
  await page.getByText("1 changed").waitFor();
  await page.getByRole("button", { name: "standing.stl" }).click();
  assert.equal(await up().inputValue(), "z");
  assert.ok(await page.getByRole("radio", { name: /Plywood/ }).isChecked());
  assert.equal(await page.getByLabel("Most sides of a part").inputValue(), "5");
  await page.getByRole("button", { name: "Back to the usual settings" }).click();
  assert.equal(await page.getByLabel("Most sides of a part").inputValue(), "6");
  assert.equal(await page.getByText("1 changed").isVisible(), false);
  await page.getByText("More settings").click();
});

it("makes them all, and the list shows them", async () => {
  await page.getByRole("button", { name: "Make sheets of 2 meshes" }).click();
  for (const name of ["lying", "standing"]) await page.locator(".card.successful", { hasText: name }).waitFor();
  await page.locator(".card", { hasText: "lying" }).click();
  await window.ready();
  assert.equal(await up().inputValue(), "x");
});

/** Another device, on which `arrive` opens the result: it stands on the same axis and is of plywood there too. */
async function looksTheSameElsewhere(arrive, axis) {
  const other = await Window.open(browser, server);
  await arrive(other);
  await other.ready();
  assert.equal(await up(other.page).inputValue(), axis);
  await other.page.getByText(/plywood/).first().waitFor();
  assert.deepEqual(other.complaints, []);
  await other.close();
}

it("looks the same on another device", () => looksTheSameElsewhere((other) => other.goto(new URL(page.url()).hash), "x"));

it("prints the pictures that way up, and hands it on with the link", async () => {
  await page.getByRole("tab", { name: "Files" }).click();
  await page.locator(".sheet-preview img").waitFor();
  const pdf = () => page.locator(".files-list a", { hasText: "PDF" }).getAttribute("href");
  assert.match(await pdf(), /[?&]up=x/);
  await up().selectOption("-x");
  await page.waitForFunction(() => /up=-x/.test(document.querySelector(".files-list a[href]")?.href));
  assert.equal((await fetch(new URL(await pdf(), server.url))).status, 200);
  await page.getByText("Make it again").click();
  const link = await page.getByRole("group", { name: "Link to this result" }).innerText();
  await looksTheSameElsewhere((other) => other.page.goto(link), "-x");
});

it("begins again with the same", async () => {
  await page.getByRole("tab", { name: "Result" }).click();
  await page.getByRole("button", { name: "Run again with …" }).click();
  await page.getByRole("button", { name: "Make the sheets" }).waitFor();
  assert.equal(await up().inputValue(), "-x");
  assert.ok(await page.getByRole("radio", { name: /Plywood/ }).isChecked());
});

it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
