// Headless Chromium that notes everything a good page never does: errors on the console, requests to other hosts.
import { mkdir } from "node:fs/promises";
import path from "node:path";
import { chromium } from "playwright-core";

const ARTEFACTS = process.env.SHEETFORM_ARTEFACTS ?? path.resolve("artefacts");
const EXECUTABLE = process.env.CHROMIUM ?? "/usr/bin/chromium";
/** Remarks of the software renderer, not of the page. */
const NOISE = /GPU stall due to ReadPixels|swiftshader|SwiftShader|GroupMarkerNotSet/;

export async function launch() {
  return chromium.launch({
    executablePath: EXECUTABLE,
    args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--force-color-profile=srgb"],
  });
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
    window.page.setDefaultTimeout(60000);
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

  /** Waits until a result is drawn. */
  ready() {
    return this.page.waitForFunction(() => document.documentElement.dataset.ready, null, { timeout: 120000 });
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

  close() {
    return this.context.close();
  }
}
