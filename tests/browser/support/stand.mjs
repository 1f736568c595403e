// What the tests of the page stand on: a server of their own with a browser, and windows that are closed again.
import { after, before } from "node:test";
import { Window, launch } from "./browser.mjs";
import { Server } from "./server.mjs";

/** A window like a phone's. */
export const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

/** For all tests of a file: take({server, browser}) once both are there. Returns what inWindow wants. */
export function onServer(take) {
  const stand = {};
  stand.ready = new Promise((resolve, reject) => {
    before(async () => {
      try {
        stand.server = await Server.start();
        stand.browser = await launch();
        resolve(take(stand));
      } catch (error) {
        reject(error);
        throw error;
      }
    });
  });
  stand.ready.catch(() => {}); // the hook tells it
  after(async () => {
    await stand.browser?.close();
    await stand.server?.stop();
  });
  return stand;
}

/**
 * For the tests of a file or a describe: take({window, page}), then begin() is awaited. Hooks of a file all begin at
 * once, so what has to come first is waited for.
 */
export function inWindow(stand, take, options = {}, begin = () => {}) {
  let window;
  before(async () => {
    await stand.ready;
    window = await Window.open(stand.browser, stand.server, options);
    take({ window, page: window.page });
    await begin();
  });
  after(() => window?.close());
}
