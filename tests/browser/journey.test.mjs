// The whole way in a real browser against a real server: from a mesh to files, on a wide window and on a phone.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { tubeStl } from "./support/meshes.mjs";
import { PHONE, inWindow, onServer } from "./support/stand.mjs";

let server;
const stand = onServer((made) => ({ server } = made));

/** The result's own files, fetched beside the page. */
async function resultFiles(page) {
  const id = new URL(page.url()).hash.slice(5);
  const files = await (await fetch(`${server.url}api/v1/jobs/${id}/results`)).json();
  return { id, files, layout: await (await fetch(new URL(files["layout.json"].href, server.url))).json() };
}

describe("on a wide window", () => {
  let window;
  let page;
  inWindow(stand, (made) => ({ window, page } = made), { viewport: { width: 1440, height: 900 } });

  it("shows the first page under a strict policy", async () => {
    const response = await window.goto();
    const policy = response.headers()["content-security-policy"] ?? "";
    assert.match(policy, /default-src 'none'|default-src 'self'/);
    assert.doesNotMatch(policy, /unsafe-inline|unsafe-eval|\*/);
    await page.getByRole("button", { name: "Choose a mesh" }).waitFor();
    await window.shot("wide-1-home");
  });

  it("shows a sample in 3D with its size before anything is sent", async () => {
    await page.getByRole("button", { name: "Wavy vase" }).click();
    await page.getByRole("button", { name: "Make the sheets" }).waitFor();
    assert.equal(await page.locator(".size-label").count(), 3);
    assert.match(await page.locator(".file-head").innerText(), /10,400 triangles/);
    await window.shot("wide-2-settings");
  });

  it("warns of a size that cannot be meant, and takes a size in millimetres", async () => {
    await page.getByRole("radio", { name: "m", exact: true }).check();
    await page.getByText(/larger than a car/).waitFor();
    await page.getByLabel("Size along z in millimetres").fill("150");
    await page.getByText(/larger than a car/).waitFor({ state: "detached" });
    assert.match(await page.locator(".size-label.axis-z").innerText(), /150 mm/);
  });

  it("makes the form from the schema", async () => {
    await page.getByText("More settings").click();
    const process = await (await fetch(`${server.url}api/v1/processes/decompose`)).json();
    for (const [name, input] of Object.entries(process.inputs)) {
      if (["mesh", "guides", "scale", "target_size", "e_max", "e_max_mm", "material", "up"].includes(name)) continue;
      assert.ok((await page.locator(".schema-form").getByText(input.title, { exact: true }).count()) >= 1, name);
    }
    await page.getByText("More settings").click();
  });

  it("runs, and shows shape and sheets side by side", async () => {
    await page.getByRole("button", { name: "Make the sheets" }).click();
    await window.ready();
    const { layout } = await resultFiles(page);
    assert.equal(await page.locator(".flat .part").count(), layout.patches.length);
    assert.match(await page.locator(".figures").innerText(), new RegExp(`Parts\\s+${layout.patches.length}\\b`));
    assert.equal(
      await page.locator(".certificate li.not .hint").count(),
      0,
      await page.locator(".certificate").innerText(),
    );
    const tallest = Math.max(
      ...(await (await fetch(`${server.url}api/v1/jobs/${(await resultFiles(page)).id}`)).json()).inputs.mesh.sizeMm,
    );
    assert.ok(Math.abs(tallest - 150) < 0.1, `${tallest} mm instead of 150`);
    await window.shot("wide-3-result");
  });

  it("lights up a part and a seam in all views", async () => {
    await page.getByRole("tab", { name: "Parts" }).click();
    await page.locator(".parts").getByRole("option").first().click();
    assert.equal(await page.locator(".flat .part.chosen").count(), 1);
    const numbers = await page.locator(".seam-list .tag").allInnerTexts();
    const inFlat = await page.locator(".flat .part.chosen .seam-name:visible").allTextContents();
    const inSpace = await page.locator(".seam-tag").allTextContents();
    assert.deepEqual(new Set(inFlat), new Set(numbers));
    assert.deepEqual(new Set(inSpace), new Set(numbers));
    await window.shot("wide-4-part");
    await page.locator(".seam-list button").first().click();
    assert.ok((await page.locator(".flat .seam.lit").count()) >= 1);
    await page.keyboard.press("Escape");
    assert.equal(await page.locator(".flat .seam.lit").count(), 0);
    await window.hoverLabel(page.locator(".flat .part-label").first());
    await page.locator(".part-row.lit").waitFor();
  });

  it("unfolds, moves apart, and shows error and bending", async () => {
    await window.slide("Unfold", 0.5);
    await window.shot("wide-5-half");
    await window.slide("Unfold", 1);
    await window.shot("wide-6-flat");
    await window.slide("Unfold", 0);
    await window.slide("Apart", 0.6);
    await window.shot("wide-7-apart");
    await window.slide("Apart", 0);
    await page.getByRole("radio", { name: "Error" }).check();
    await page.getByText(/Worst place \(marked\)/).waitFor();
    await window.shot("wide-8-error");
    await page.getByRole("radio", { name: "Tilt" }).check();
    await page.getByText(/Largest \(marked\)/).waitFor();
    await page.getByRole("radio", { name: "Bend" }).check();
    await page.getByText(/Bend radius in/).waitFor();
    await window.shot("wide-9-bend");
  });

  it("draws the files for another sheet and machine, and says what does not fit", async () => {
    const jobs = async () => (await (await fetch(`${server.url}api/v1/jobs`)).json()).jobs.length;
    const before = await jobs();
    await page.getByRole("tab", { name: "Result" }).click();
    await page.getByRole("button", { name: "Get the files" }).click();
    assert.equal(await page.getByRole("tab", { name: "Files" }).getAttribute("aria-selected"), "true");
    await page.getByRole("img", { name: "Sheet 1 of 1" }).waitFor();
    await window.shot("wide-10-files");
    await page.getByLabel("Sheet", { exact: true }).selectOption("own value …");
    await page.getByLabel("Sheet, own value").fill("110x110");
    await page.getByText(/is larger than a sheet of 110 x 110 mm/).waitFor();
    assert.equal(await page.getByLabel("Sheet, own value").getAttribute("aria-invalid"), "true");
    assert.equal(await page.locator(".exports a[href]").count(), 0);
    await page.getByLabel("If a part is larger").selectOption("split it");
    await page.getByText("Sheet 1 of").waitFor();
    await page.getByRole("button", { name: "Next sheet" }).click();
    await page.getByText("Sheet 2 of").waitFor();
    await window.shot("wide-10-split");
    assert.equal(await jobs(), before);
  });

  it("hands out the files", async () => {
    await page.getByLabel("Machine", { exact: true }).selectOption("lightburn");
    await page.getByLabel("Kerf").fill("0,2");
    await page.getByLabel("Sheet", { exact: true }).selectOption("as large as needed");
    const link = page.getByRole("link", { name: /Sheets to cut, true to scale/ });
    await page.waitForFunction(() => /kerf=0.2/.test(document.querySelector(".files-list a[href]")?.href));
    await page.getByRole("img", { name: "Sheet 1 of 1" }).waitFor();
    const [download] = await Promise.all([page.waitForEvent("download"), link.click()]);
    assert.match(download.suggestedFilename(), /sheet-1\.svg$/);
    const chunks = [];
    for await (const chunk of await download.createReadStream()) chunks.push(chunk);
    const svg = Buffer.concat(chunks).toString();
    assert.match(svg, /<svg/);
    assert.match(svg, /kerf=0\.2/);
    assert.match(svg, /profile=lightburn/);
  });

  it("lists the job with its picture, in dark as well", async () => {
    await page.getByRole("link", { name: "Jobs", exact: true }).click();
    await page.locator(".card.successful img").first().waitFor();
    await page.emulateMedia({ colorScheme: "dark" });
    await window.shot("wide-11-jobs-dark");
  });

  // The browser itself notes on its console that a sheet was refused.
  it("had nothing else to complain about", () => assert.deepEqual(window.complaintsBut(/status of 400/), []));
});

describe("on a phone", () => {
  let window;
  let page;
  inWindow(stand, (made) => ({ window, page } = made), { ...PHONE, colorScheme: "dark" });

  it("takes an STL in inches", async () => {
    await window.goto();
    await page.locator("#file").setInputFiles(tubeStl());
    await page.getByRole("button", { name: "Make the sheets" }).waitFor();
    // 5 mm are not meant: what is offered fits on a table.
    assert.equal(await page.getByLabel("Size along z in millimetres").inputValue(), "200");
    await page.getByText(/the file would be 5 mm long/).waitFor();
    await page.getByRole("radio", { name: "inch" }).check();
    await page.getByText(/the file would be/).waitFor({ state: "detached" });
    assert.equal(await page.getByLabel("Size along z in millimetres").inputValue(), "127");
    await window.shot("phone-1-settings");
  });

  it("never scrolls sideways", async () => {
    const [wide, view] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(wide <= view, `${wide} > ${view}`);
  });

  it("shows shape, flat layout, figures, parts and files in turn", async () => {
    await page.getByRole("button", { name: "Make the sheets" }).click();
    await window.ready();
    await window.shot("phone-2-shape");
    for (const [name, proof] of [
      ["Flat", ".flat .part"],
      ["Result", ".figures"],
      ["Parts", ".part-row"],
      ["Files", ".sheet-preview img"],
    ]) {
      await page.getByRole("tab", { name }).click();
      await page.locator(proof).first().waitFor();
      await window.shot(`phone-3-${name.toLowerCase()}`);
    }
  });

  it("fits the shape into the window when a link leads to it", async () => {
    await page.getByRole("tab", { name: "Shape" }).click();
    await page.getByRole("button", { name: "Show all" }).click();
    const fitted = await page.locator(".view3d").screenshot();
    await page.reload();
    await window.ready();
    const opened = await page.locator(".view3d").screenshot();
    assert.ok(opened.equals(fitted), "the first view is another one");
  });

  it("had nothing to complain about", () => assert.deepEqual(window.complaints, []));
});
