// Headless Chromium that notes everything a good page never does: errors on the console, requests to other hosts.
import { mkdir } from "node:fs/promises";
import path from "node:path";
import { chromium } from "playwright-core";

const ARTEFACTS = process.env.SHEETFORM_ARTEFACTS ?? path.resolve("artefacts");
const EXECUTABLE = process.env.CHROMIUM ?? "/usr/bin/chromium";
/** Remarks of the software renderer, not of the page. */
const NOISE = /GPU stall due to ReadPixels|swiftshader|SwiftShader|GroupMarkerNotSet/;

/** Milliseconds a single step may take: only a defect takes that long, however busy the machine is. */
const PATIENCE = 300000;

export async function launch() {
  return chromium.launch({
    executablePath: EXECUTABLE,
    args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--force-color-profile=srgb"],
  });
}

/** Runs in the page. */
async function countPixels([picture, variable]) {
  const bytes = Uint8Array.from(atob(picture), (c) => c.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
  const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d", { willReadFrequently: true });
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(variable).trim();
  context.fillRect(0, 0, 1, 1);
  const wanted = context.getImageData(0, 0, 1, 1).data;
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
  let count = 0;
  for (let k = 0; k < data.length; k += 4) if ([0, 1, 2].every((c) => Math.abs(data[k + c] - wanted[c]) <= 4)) count++;
  return count;
}

export class Window {
  /** @param options of browser.newContext: viewport, colorScheme, hasTouch ... */
  static async open(browser, server, options = {}) {
    const window = new Window();
    window.server = server;
    window.context = await browser.newContext({
      viewport: { width: 1280, height: 800 },
      reducedMotion: "reduce",
      ...options,
    });
    window.page = await window.context.newPage();
    window.page.setDefaultTimeout(PATIENCE);
    window.complaints = [];
    window.expected = [];
    window.page.on("console", (message) => {
      if (["error", "warning"].includes(message.type()) && !NOISE.test(message.text()))
        window.complaints.push(`${message.type()}: ${message.text()}`);
    });
    window.page.on("pageerror", (error) => window.complaints.push(`uncaught: ${error.stack}`));
    window.page.on("request", (request) => {
      const { protocol, host } = new URL(request.url());
      if (protocol !== "blob:" && host !== new URL(server.url).host)
        window.complaints.push(`left the host: ${request.url()}`);
    });
    return window;
  }

  goto(hash = "") {
    return this.page.goto(this.server.url + hash);
  }

  async shot(name) {
    await mkdir(ARTEFACTS, { recursive: true });
    await this.page.screenshot({ path: path.join(ARTEFACTS, `${name}.png`) });
  }

  /** Waits until what was asked for is drawn. */
  drawn() {
    return this.page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  }

  /** Pixels of the 3D view that have the colour of a variable of the styles. */
  async pixelsOf(variable) {
    await this.drawn();
    const picture = await this.page.locator(".view3d").screenshot();
    return this.page.evaluate(countPixels, [picture.toString("base64"), variable]);
  }

  /** Waits until the result that the address names is drawn. */
  ready() {
    const drawn = () => location.hash === `#job/${document.documentElement.dataset.ready}`;
    return this.page.waitForFunction(drawn, null, { timeout: 2 * PATIENCE });
  }

  /** Complaints that match none of the patterns. */
  complaintsBut(...patterns) {
    return this.complaints.filter((text) => !patterns.some((pattern) => pattern.test(text)));
  }

  /** A range input moved as a person would see it move. */
  slide(label, value) {
    return this.page.getByLabel(label, { exact: true }).evaluate((input, to) => {
      input.value = String(to);
      input.dispatchEvent(new Event("input", { bubbles: true }));
    }, value);
  }

  /** Points at a part's label: it stands inside its part, which the centre of a curved part's box may not. */
  async hoverLabel(label) {
    const { x, y, width, height } = await label.boundingBox();
    await this.page.mouse.move(x + width / 2, y + height / 2);
  }

  close() {
    return this.context.close();
  }
}
