// One person with a browser, for the trial of two browsers and ten scripts at once (tests/reliability):
//   node visitor.mjs URL MESH SECONDS
// Visits again and again as if for the first time, opens the newest job, and sends the mesh; prints the seconds that
// each of it took, and those that the browser waited for each kind of answer of the server, as one JSON object.
import { readFile } from "node:fs/promises";
import { Window, launch } from "./support/browser.mjs";

const [url, mesh, seconds] = process.argv.slice(2);
const buffer = await readFile(mesh);
const until = performance.now() + Number(seconds) * 1000;
const times = { page_load: [], list_shown: [], job_shown: [], sent: [], answers: [] };
const complaints = [];

async function timed(kind, work) {
  const begun = performance.now();
  await work();
  times[kind].push((performance.now() - begun) / 1000);
}

async function visit(browser, round) {
  const window = await Window.open(browser, { url });
  const { page } = window;
  await timed("page_load", () => window.goto());
  await timed("list_shown", () => page.locator(".card").first().waitFor());
  const job = await page.locator(".card.running").first().getAttribute("href");
  await timed("job_shown", async () => {
    await page.evaluate((hash) => (location.hash = hash), job);
    await page.locator(".progress-panel").waitFor();
  });
  await page.evaluate(() => (location.hash = "#"));
  const name = `visit-${process.pid}-${round}.obj`;
  const own = Buffer.concat([buffer, Buffer.from(`# ${name}\n`)]);
  await page.locator("#file").setInputFiles({ name, mimeType: "model/obj", buffer: own });
  const send = page.getByRole("button", { name: "Make the sheets" });
  await send.waitFor();
  await timed("sent", async () => {
    await send.click();
    await page.waitForURL(/#job\//);
  });
  times.answers.push(
    ...(await page.evaluate(() =>
      performance
        .getEntriesByType("resource")
        .filter(({ name: address, responseEnd }) => responseEnd > 0 && !address.endsWith("/events"))
        .map(({ requestStart, responseEnd }) => (responseEnd - requestStart) / 1000),
    )),
  );
  await page.evaluate(() => fetch(`/api/v1/jobs/${location.hash.slice(5)}`, { method: "DELETE" }));
  complaints.push(...window.complaints);
  await window.close();
}

const browser = await launch();
try {
  let round = 0;
  do await visit(browser, ++round);
  while (performance.now() < until);
} finally {
  await browser.close();
}
console.log(JSON.stringify({ times, complaints }));
