// The page's frame: header, routes (#, #new, #job/<id>, #job/<sweep>/<point>), files dropped anywhere, light and dark.
import { A_MOMENT, ProblemError, getProcess, openPoint, openSession } from "./api.js";
import { freshId, h, replace } from "./dom.js";
import { UPS, drafts } from "./drafts.js";
import { jobs } from "./jobs.js";
import { MATERIALS } from "./materials.js";
import { knownOf, recall, remember, rememberOf } from "./prefs.js";
import { homePage } from "./ui/home.js";
import { icon } from "./ui/icons.js";
import { problemBox } from "./ui/problem.js";
import { setTheme } from "./view/theme.js";
import { inherit } from "./variants.js";

const THEMES = ["auto", "light", "dark"];
const THEME_ICON = { auto: "auto", light: "sun", dark: "moon" };

class App {
  page = null;
  process = null;
  stage = null;

  start() {
    this.host = document.getElementById("page");
    replace(document.getElementById("top"), this.header());
    setTheme(recall("theme", "auto"));
    jobs.start();
    jobs.onChange(() => this.showConnection());
    addEventListener("hashchange", () => this.route());
    this.listenToDrops();
    // The address's hash names the page, so the skip link moves the focus by itself.
    document.querySelector(".skip").addEventListener("click", (event) => {
      event.preventDefault();
      document.getElementById("main")?.focus();
    });
    this.route();
  }

  header() {
    this.connection = h("p", { class: "connection", role: "status" });
    const theme = h("button", {
      type: "button",
      class: "quiet",
      onclick: () => {
        const next = THEMES[(THEMES.indexOf(recall("theme", "auto")) + 1) % THEMES.length];
        remember("theme", next);
        setTheme(next);
        showTheme();
      },
    });
    const showTheme = () => {
      const now = recall("theme", "auto");
      theme.setAttribute("aria-label", `Colours: ${now === "auto" ? "as the system has it" : now}`);
      theme.title = theme.getAttribute("aria-label");
      replace(theme, icon(THEME_ICON[now]));
    };
    showTheme();
    return [
      h(
        "a",
        { class: "brand", href: "#", "aria-label": "sheetform, all jobs" },
        icon("logo", 26),
        h("span", {}, "sheetform"),
      ),
      this.connection,
      h(
        "nav",
        { "aria-label": "Page" },
        h("a", { class: "button quiet", href: "#" }, icon("list", 18), h("span", {}, "Jobs")),
        theme,
      ),
    ];
  }

  go = (hash) => {
    if (location.hash === hash || (hash === "#" && location.hash === "")) this.route();
    else location.hash = hash;
  };

  async route() {
    const hash = location.hash;
    const turn = (this.turn = Symbol(hash));
    if (hash !== "#new" && !hash.startsWith("#job/")) return this.show(() => homePage(this));
    try {
      await this.load();
      if (this.turn !== turn) return;
      this.away = null;
      const [place, more] = hash.slice(5).split("?");
      const [id, point] = place.split("/").map(decodeURIComponent);
      if (more) takeAlong(id, place, more);
      if (point) return await this.toPoint(id, point);
      if (hash === "#new") this.show(() => (drafts.draft ? this.pages.setupPage(this) : homePage(this)));
      else this.show(() => this.pages.jobPage({ ...this, go: this.go, id }));
    } catch (error) {
      if (this.turn !== turn) return;
      if (!error.passing || this.away !== hash) this.showProblem(error);
      this.away = hash; // of this page it has been said
      if (error.passing) setTimeout(() => this.turn === turn && this.route(), A_MOMENT);
    }
  }

  /** A point of a sweep becomes a job, and its page takes the place of this one. */
  async toPoint(sweep, point) {
    const job = await openPoint(sweep, point);
    inherit(sweep, job.jobID);
    jobs.put(job);
    location.replace(`#job/${job.jobID}`);
  }

  /** What the work pages need: 3D and the description of the parameters. Fetched once. */
  async load() {
    const [pages, process] = await Promise.all([import("./pages.js"), this.process ?? getProcess()]);
    this.pages = pages;
    this.process = process;
    this.stage ??= new pages.Stage();
  }

  /** The old page goes before the new one is made: they share the stage. */
  show(makePage) {
    this.page?.dispose?.();
    const page = (this.page = makePage());
    document.title = page.title ? `${page.title} · sheetform` : "sheetform: from mesh to sheets";
    replace(this.host, page.element);
    delete document.documentElement.dataset.ready;
    window.scrollTo(0, 0);
  }

  showProblem(error) {
    const unknown = error instanceof ProblemError && error.problem.status === 401;
    const again = h("button", { type: "button", class: "primary", onclick: () => this.route() }, "Try again");
    this.show(() => ({
      title: "",
      element: h(
        "main",
        { class: "home", id: "main", tabindex: "-1" },
        h("h1", { class: "visually-hidden" }, "sheetform"),
        unknown ? signIn(() => location.reload()) : problemBox(error, again),
      ),
    }));
  }

  showConnection() {
    const lost = jobs.connection === "lost";
    this.connection.classList.toggle("lost", lost && jobs.problem?.status !== 401);
    this.connection.textContent = lost
      ? jobs.problem?.status === 401
        ? "Signed out"
        : "No connection to the server, trying again …"
      : "";
    if (lost && jobs.problem?.status === 401 && !this.asked) {
      this.asked = true;
      this.showProblem(new ProblemError(jobs.problem));
    }
  }

  listenToDrops() {
    const veil = h(
      "div",
      { class: "veil", hidden: true, "aria-hidden": "true" },
      h("p", {}, icon("upload", 40), "Drop to begin"),
    );
    document.body.append(veil);
    let depth = 0;
    const carriesFiles = (event) => event.dataTransfer?.types.includes("Files");
    addEventListener("dragenter", (event) => {
      if (carriesFiles(event)) {
        depth++;
        veil.hidden = false;
      }
    });
    addEventListener("dragleave", (event) => {
      if (carriesFiles(event) && --depth <= 0) {
        depth = 0;
        veil.hidden = true;
      }
    });
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      depth = 0;
      veil.hidden = true;
      if (event.dataTransfer.files.length > 0) {
        drafts.open(event.dataTransfer.files);
        this.go("#new");
      }
    });
  }
}

/** A link may say how a result was looked at (#job/<id>?up=y&material=paper); what is known here already stays. */
function takeAlong(id, place, more) {
  const told = new URLSearchParams(more);
  const known = { up: UPS, material: MATERIALS.map((material) => material.id) };
  const wanted = Object.entries(known).filter(([name, values]) => values.includes(told.get(name)));
  rememberOf(id, { ...Object.fromEntries(wanted.map(([name]) => [name, told.get(name)])), ...knownOf(id) });
  history.replaceState(null, "", `#job/${place}`);
}

/** Asks for the server's token and opens a session; the problem's own words are for programs. */
function signIn(done) {
  return h(
    "section",
    { class: "sign-in" },
    h("h2", {}, "Sign in"),
    h("p", {}, "This server asks for a token. Whoever runs it gives you one; paste it here, once on this device."),
    tokenForm(done),
  );
}

function tokenForm(done) {
  const id = freshId("token");
  const input = h("input", { type: "password", autocomplete: "current-password", id, required: true });
  const error = h("p", { class: "field-error", role: "alert" });
  return h(
    "form",
    {
      onsubmit: async (event) => {
        event.preventDefault();
        try {
          await openSession(input.value.trim());
          done();
        } catch (problem) {
          error.textContent =
            problem.problem?.status === 401 ? "This token is not known here. Is it complete?" : problem.message;
        }
      },
    },
    h("label", { for: id }, "Token"),
    h("div", { class: "row" }, input, h("button", { class: "primary" }, "Sign in")),
    error,
  );
}

new App().start();
