// Pictures of every state of the page in four widths and both themes, to be looked at by a person:
//   node gallery.mjs FOLDER [STATE ...]
// Needs the programs that the tests of the server build (SHEETFORM_PROGRAM, SHEETFORM_FAKE_WORKER); SHEETFORM_WEB_DIR names
// another page than the one that is built in.
import { mkdir } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { Window, launch } from "./support/browser.mjs";
import { gores } from "./support/gores.mjs";
import { ball, cutShort, finned, flatLine, letter, strip, tubeStl } from "./support/meshes.mjs";
import { Server } from "./support/server.mjs";

const ROOT = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const FAKE = process.env.SHEETFORM_FAKE_WORKER ?? path.join(ROOT, "build/release/tests/server_process/fake_worker");
const SIZES = {
  phone: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
  tablet: { viewport: { width: 800, height: 1100 }, hasTouch: true },
  laptop: { viewport: { width: 1280, height: 800 } },
  wide: { viewport: { width: 1920, height: 1080 } },
};
const LONG = "a-very-long-name-of-a-file-that-nobody-would-type-by-hand-but-that-a-program-for-scans-makes-of-the-date-2026-11-28T23-59-59_final_final(3)";

const [folder, ...wanted] = process.argv.slice(2);
const started = [];
const serve = async (...options) => {
  const server = await Server.start(options);
  started.push(server);
  return server;
};

async function submit(server, { name, buffer }, query = "", process = "decompose") {
  const url = `${server.url}api/v1/processes/${process}/execution?filename=${encodeURIComponent(name)}${query}`;
  const answer = await fetch(url, { method: "POST", body: buffer });
  const job = await answer.json();
  if (answer.status !== 201) throw new Error(JSON.stringify(job));
  return job.jobID;
}

async function ended(server, id) {
  for (;;) {
    const job = await (await fetch(`${server.url}api/v1/jobs/${id}`)).json();
    if (!["accepted", "running"].includes(job.status)) return job;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

const drop = (server, id) => fetch(`${server.url}api/v1/jobs/${id}`, { method: "DELETE" });
const done = async (server, mesh, query, process) => {
  const id = await submit(server, mesh, query, process);
  await ended(server, id);
  return id;
};

/** The job's page, once something is there. */
const opened = (locator) => async ({ window, id }) => {
  await window.goto(`#job/${id}`);
  await window.page.locator(locator).first().waitFor();
};
const tab = (name, proof) => async ({ window, id }) => {
  await window.goto(`#job/${id}`);
  await window.ready();
  await window.page.getByRole("tab", { name, exact: true }).click();
  if (proof) await window.page.locator(proof).first().waitFor();
};
const result = async ({ window, id }) => {
  await window.goto(`#job/${id}`);
  await window.ready();
  await window.page.waitForTimeout(200);
};
const chosen = (file) => async ({ window }) => {
  await window.goto();
  await window.page.locator("#file").setInputFiles(file());
};

/** Another result in the place of the job's own. */
const instead = (change) => async ({ window, id, server }) => {
  const { obj, layout, report } = change();
  const job = await (await fetch(`${server.url}api/v1/jobs/${id}`)).json();
  const told = { ...job, report: { ...job.report, ...report } };
  await window.page.route(/results\/ruled\.obj/, (route) => (obj ? route.fulfill({ body: obj }) : route.continue()));
  await window.page.route(/results\/layout\.json/, async (route) => {
    if (layout) return route.fulfill({ json: layout });
    const own = await (await route.fetch()).json();
    return route.fulfill({ json: { ...own, report: { ...own.report, ...report } } });
  });
  await window.page.route(/api\/v1\/events$/, (route) =>
    route.fulfill({ contentType: "text/event-stream", body: `event: snapshot\ndata: ${JSON.stringify({ jobs: [told] })}\n\n` }),
  );
  await result({ window, id });
};

async function crowd(server) {
  await drop(server, await submit(server, ball("cancelled.obj", { wave: 0.2 }), "&e_max=0.003"));
  for (let k = 0; k < 24; k++) await done(server, strip(`strip ${k}.obj`, k));
  await done(server, ball("ball.obj", { around: 40, up: 20 }), "&effort=draft");
  await done(server, ball("sweep.obj", { around: 40, up: 20 }), "&e_max=0.06,0.04&effort=draft", "sweep");
  await done(server, strip(`${LONG}.obj`, 99));
  await submit(server, ball("running.obj"), "&e_max=0.003");
  await submit(server, strip("waiting.obj", 200));
  await submit(server, ball("waiting too.obj", { wave: 0.3 }), `&tag=${encodeURIComponent("The lamp for the hall, second try")}`);
}

const plain = () => serve();
const withJob = (make, ...options) => async () => {
  const server = await serve(...options);
  return { server, id: await make(server) };
};
const failing = (name, ...options) => withJob((server) => done(server, strip(`${name}.obj`)), "--worker", FAKE, ...options);

/** make(): {server, id}, once for all windows (a name: that of another state); arrange({window, server, id}) in each. */
const STATES = {
  "home-empty": { make: async () => ({ server: await plain() }), arrange: ({ window }) => window.goto() },
  "home-30": {
    make: async () => {
      const server = await plain();
      await crowd(server);
      return { server };
    },
    arrange: async ({ window }) => {
      await window.goto();
      await window.page.locator(".card").first().waitFor();
      await window.page.waitForTimeout(700);
    },
  },
  setup: {
    make: async () => ({ server: await plain() }),
    arrange: async (at) => {
      await chosen(() => tubeStl(`${LONG}.stl`))(at);
      await at.window.page.getByRole("button", { name: "Make the sheets" }).waitFor();
    },
  },
  "setup-more": {
    make: async () => ({ server: await plain() }),
    arrange: async (at) => {
      await chosen(() => finned())(at);
      await at.window.page.getByText("More settings").click();
    },
  },
  letter: {
    make: async () => ({ server: await plain() }),
    arrange: async (at) => {
      await chosen(() => letter())(at);
      await at.window.page.getByRole("alert").waitFor();
    },
  },
  damaged: {
    make: async () => ({ server: await plain() }),
    arrange: async (at) => {
      await chosen(() => cutShort())(at);
      await at.window.page.getByRole("alert").waitFor();
      await at.window.page.waitForTimeout(300);
    },
  },
  refused: {
    make: async () => ({ server: await plain() }),
    arrange: async (at) => {
      await chosen(() => flatLine())(at);
      await at.window.page.getByRole("button", { name: "Make the sheets" }).click();
      await at.window.page.locator(".problem").waitFor();
    },
  },
  running: {
    make: withJob((server) => submit(server, ball(`${LONG}.obj`), "&e_max=0.002")),
    arrange: async (at) => {
      await opened(".progress-panel")(at);
      await at.window.page.waitForTimeout(800);
    },
  },
  waiting: {
    make: withJob(async (server) => {
      await submit(server, ball("before.obj"), "&e_max=0.002");
      return submit(server, ball("after.obj", { wave: 0.2 }));
    }),
    arrange: opened(".progress-panel"),
  },
  cancelled: {
    make: withJob(async (server) => {
      const id = await submit(server, ball("cancelled.obj"), "&e_max=0.003");
      await drop(server, id);
      return id;
    }),
    arrange: async (at) => {
      await opened(".ended")(at);
      await at.window.page.waitForTimeout(500);
    },
  },
  "failed-crash": { make: failing("segv"), arrange: opened(".problem") },
  "failed-memory": { make: failing("memory"), arrange: opened(".problem") },
  "failed-killed": { make: failing("kill"), arrange: opened(".problem") },
  "failed-mesh": { make: failing("refuse"), arrange: opened(".problem") },
  "failed-time": {
    make: withJob((server) => done(server, ball(), "&e_max=0.002"), "--job-seconds", "1"),
    arrange: async (at) => {
      await opened(".problem")(at);
      await at.window.page.waitForTimeout(500);
    },
  },
  "failed-symmetry": {
    make: withJob((server) => done(server, ball("lopsided.obj", { around: 60, up: 30, wave: 0.3 }), "&symmetry=0,1,0,0")),
    arrange: async (at) => {
      await opened(".problem")(at);
      await at.window.page.waitForTimeout(500);
    },
  },
  "sweep-running": {
    make: withJob((server) => submit(server, ball(), "&e_max=0.06,0.04,0.02,0.01,0.005", "sweep")),
    arrange: opened(".progress-panel"),
  },
  sweep: {
    make: withJob((server) => done(server, ball("ball.obj", { around: 60, up: 30 }), "&e_max=0.06,0.04,0.025,0.015", "sweep")),
    arrange: async (at) => {
      await opened(".points")(at);
      await at.window.page.waitForTimeout(500);
    },
  },
  "sweep-failed": {
    make: withJob((server) => done(server, ball(), "&e_max=0.002,0.003", "sweep"), "--job-seconds", "1"),
    arrange: opened(".problem"),
  },
  "no-job": {
    make: async () => ({ server: await plain(), id: "00000000-0000-4000-8000-000000000000" }),
    arrange: opened(".problem"),
  },
  offline: {
    make: withJob((server) => done(server, strip())),
    arrange: async ({ window, server }) => {
      if (server.process.exitCode !== null) await server.begin();
      await window.goto();
      await window.page.locator(".card").first().waitFor();
      await server.end();
      await window.page.getByText(/No connection/).waitFor();
    },
  },
  "offline-setup": {
    make: withJob((server) => done(server, strip())),
    arrange: async ({ window, server }) => {
      if (server.process.exitCode !== null) await server.begin();
      await window.goto();
      await window.page.locator("#file").setInputFiles(tubeStl());
      await window.page.getByRole("button", { name: "Make the sheets" }).waitFor();
      await server.end();
      await window.page.getByRole("button", { name: "Make the sheets" }).click();
      await window.page.locator(".problem").waitFor();
    },
  },
  "sign-in": {
    make: async () => ({ server: await serve("--require-token", "--make-token") }),
    arrange: async ({ window }) => {
      await window.goto();
      await window.page.getByLabel("Token").waitFor();
    },
  },
  "sign-in-wrong": {
    make: async () => ({ server: await serve("--require-token", "--make-token") }),
    arrange: async ({ window }) => {
      await window.goto();
      await window.page.getByLabel("Token").fill("nonsense");
      await window.page.getByRole("button", { name: "Sign in" }).click();
      await window.page.getByText(/not known here/).waitFor();
    },
  },
  result: { make: withJob((server) => done(server, ball("ball.obj", { around: 80, up: 40 }))), arrange: result },
  "result-flat": { make: "result", arrange: tab("Result", ".figures") },
  "result-parts": {
    make: "result",
    arrange: async (at) => {
      await tab("Parts", ".part-row")(at);
      await at.window.page.locator(".part-row").nth(1).click();
    },
  },
  "result-files": {
    make: "result",
    arrange: async (at) => {
      await tab("Files", ".sheet-preview img")(at);
      await at.window.page.waitForTimeout(400);
    },
  },
  "one-part": { make: withJob((server) => done(server, strip(`${LONG}.obj`))), arrange: result },
  "one-part-figures": { make: "one-part", arrange: tab("Result", ".figures") },
  "many-parts": { make: withJob((server) => done(server, strip())), arrange: instead(() => gores({ count: 150, rows: 12 })) },
  "many-parts-list": {
    make: "many-parts",
    arrange: async (at) => {
      await instead(() => gores({ count: 150, rows: 12 }))(at);
      await at.window.page.getByRole("tab", { name: "Parts", exact: true }).click();
    },
  },
  symmetry: {
    make: withJob((server) => done(server, ball("ball.obj", { around: 60, up: 30, wave: 0 }), "&symmetry=auto&effort=draft")),
    arrange: async (at) => {
      await tab("Parts", ".part-row")(at);
      await at.window.page.locator(".part-row").nth(1).click();
    },
  },
  missed: {
    make: "result",
    arrange: async (at) => {
      await instead(() => ({ report: { e_max_met: false, hausdorff: 0.031, hausdorff_at_most: 0.0312 } }))(at);
      await at.window.page.getByRole("tab", { name: "Result", exact: true }).click();
    },
  },
  draft: { make: withJob((server) => done(server, ball("ball.obj", { around: 80, up: 40 }), "&effort=draft")), arrange: tab("Result", ".figures") },
};

await mkdir(folder, { recursive: true });
const browser = await launch();
const made = {};
try {
  for (const name of wanted.length ? wanted : Object.keys(STATES)) {
    const source = typeof STATES[name].make === "string" ? STATES[name].make : name;
    made[source] ??= await STATES[source].make();
    for (const [size, options] of Object.entries(SIZES)) {
      const window = await Window.open(browser, made[source].server, { ...options, colorScheme: "light" });
      window.page.setDefaultTimeout(20000);
      try {
        await STATES[name].arrange({ window, ...made[source] });
      } catch (error) {
        console.log(`${name}, ${size}: ${String(error).slice(0, 300)}`);
      }
      for (const colorScheme of ["light", "dark"]) {
        await window.page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
        await window.page.waitForTimeout(120);
        await window.page.screenshot({ path: path.join(folder, `${name}-${size}-${colorScheme}.png`) });
      }
      const wide = await window.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      if (wide > 0) console.log(`${name}, ${size}: scrolls sideways by ${wide}`);
      const said = window.complaintsBut(/Failed to load resource|ERR_/);
      if (said.length) console.log(`${name}, ${size}: ${said.join("\n")}`);
      await window.close();
    }
  }
} finally {
  await browser.close();
  for (const server of started) await server.stop();
}
