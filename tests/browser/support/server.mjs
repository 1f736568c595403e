// A real server process for the tests of the page: own port, own data folder, its output kept.
import { spawn } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const ROOT = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../..");
/** A page that is not the one built in, to look at changes at once. */
const PAGE = process.env.SHEETFORM_WEB_DIR ? ["--web-dir", process.env.SHEETFORM_WEB_DIR] : [];
const PROGRAM = process.env.SHEETFORM_PROGRAM ?? path.join(ROOT, "build/release/sheetform");

export class Server {
  /** Starts the program and resolves when it answers /healthz. */
  static async start(options = []) {
    const server = new Server();
    server.port = 0; // any that is free, and the same when it is started again
    server.data = await mkdtemp(path.join(tmpdir(), "sheetform-page-"));
    server.options = options;
    await server.begin();
    return server;
  }

  async begin() {
    this.output = "";
    this.process = spawn(
      PROGRAM,
      ["serve", "--listen", `127.0.0.1:${this.port}`, "--data", this.data, ...PAGE, ...this.options],
      { stdio: ["ignore", "pipe", "pipe"] },
    );
    this.ended = new Promise((resolve) => this.process.on("exit", resolve));
    this.process.on("error", (error) => {
      this.output += `${error}\n`;
    });
    for (const stream of [this.process.stdout, this.process.stderr])
      stream.on("data", (text) => {
        this.output += text;
      });
    for (let attempt = 0; attempt < 1200; attempt++) {
      if (this.process.exitCode !== null) break;
      this.port ||= Number(/"url":"http:\/\/127\.0\.0\.1:(\d+)"/.exec(this.output)?.[1] ?? 0);
      this.url = `http://127.0.0.1:${this.port}/`;
      try {
        if (this.port > 0 && (await fetch(`${this.url}healthz`)).ok) return;
      } catch {
        /* not yet listening */
      }
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    throw new Error(`${PROGRAM} does not serve:\n${this.output}`);
  }

  async end(signal = "SIGTERM") {
    if (this.process.exitCode === null && this.process.signalCode === null) this.process.kill(signal);
    await this.ended;
  }

  /** Ends the process and starts it again on the same data. */
  async restart(signal = "SIGTERM") {
    await this.end(signal);
    await this.begin();
  }

  async stop() {
    await this.end();
    await rm(this.data, { recursive: true, force: true });
  }
}
