// Before anything is computed: what was dropped, how large it becomes, of what, and how closely.
import { execute } from "../api.js";
import { freshId, h, replace } from "../dom.js";
import { drafts, extents, guessUp } from "../drafts.js";
import { bytes, count, millimetres } from "../format.js";
import { jobs } from "../jobs.js";
import { MATERIALS, OFFERED_SIZE, UNITS, materialOf, sizeWarning } from "../materials.js";
import { keepPicture, recall, remember } from "../prefs.js";
import { placesOf } from "../result/places.js";
import { guideList } from "./draw_tools.js";
import { fileHead } from "./file_head.js";
import { icon } from "./icons.js";
import { inPageWords, marked, problemBox } from "./problem.js";
import { SchemaForm } from "./schema_form.js";
import { sizeField } from "./size_field.js";
import { toleranceField } from "./tolerance_field.js";

/** Parameters that have a field of their own on this page. */
const OWN = new Set(["target_size", "scale", "e_max", "e_max_mm", "material", "up"]);

export function setupPage({ go, stage, process }) {
  const panel = h("section", { class: "panel", "aria-label": "Settings" });
  const main = h(
    "main",
    { class: "work", id: "main", tabindex: "-1" },
    h("h1", { class: "visually-hidden" }, "New job"),
    stage.element,
    panel,
  );
  const page = { panel, main, stage, process, go, sending: null };
  let shown = null;
  const update = () => {
    const draft = drafts.draft;
    if (!draft) return go("#");
    const rest = draft.error?.rest; // of a damaged file
    if (rest && shown !== rest)
      stage.showInput(rest, { up: guessUp(rest), scale: draft.scale, places: draft.error.places });
    if (draft.mesh && shown !== draft.mesh) {
      stage.showInput(draft.mesh, {
        up: draft.up,
        scale: draft.scale,
        guides: draft.guides,
        drawing: process.inputs.guides !== undefined,
        onUp: (up) => {
          draft.up = up;
          page.size?.setUp(up);
        },
      });
    }
    shown = draft.mesh ?? rest ?? null;
    if (!shown) stage.clear(draft.error ? "" : "Reading the mesh …");
    showPanel(page, draft);
  };
  const stop = drafts.onChange(update);
  update();
  return {
    title: "New job",
    element: main,
    dispose() {
      stop();
      page.drawn?.stop();
      stage.stopDrawing();
      page.sending?.abort();
    },
  };
}

function showPanel(page, draft) {
  page.drawn?.stop();
  page.main.classList.toggle("alone", Boolean(draft.error && !draft.error.rest)); // there is nothing to see
  if (draft.error)
    return replace(
      page.panel,
      fileList(),
      fileHead(draft.name),
      problemBox(
        marked(draft.error, draft.error.places),
        h("button", { type: "button", class: "primary", onclick: () => page.go("#") }, "Choose another file"),
      ),
    );
  if (!draft.mesh) return replace(page.panel, fileList(), h("p", { class: "busy" }, `Reading ${draft.name} …`));
  const note = h("div", { class: "note-place" });
  const refresh = () => {
    const odd = sizeWarning(longest(draft), materialOf(draft.material));
    const { offered } = draft;
    replace(
      note,
      offered?.scale === draft.scale &&
        h(
          "p",
          { class: "note" },
          `In millimetres the file would be ${millimetres(offered.longest)} long, which can hardly be meant. It begins at ${OFFERED_SIZE} mm; choose its unit or a size if you know better.`,
        ),
      odd &&
        warning(
          odd,
          h(
            "button",
            { type: "button", class: "small", onclick: () => size.setLongest(OFFERED_SIZE) },
            `Make it ${OFFERED_SIZE} mm`,
          ),
        ),
      meshWarnings(draft.mesh).map((text) => warning(text)),
    );
  };
  const tolerance = toleranceField(page.process.inputs.e_max?.schema ?? {}, draft);
  const size = sizeField(draft, UNITS, () => {
    tolerance.update();
    page.stage.setScale(draft.scale);
    page.drawn.update();
    refresh();
  });
  page.size = size;
  size.setUp(draft.up);
  const form = new SchemaForm(page.process, { own: OWN, values: draft.values, onChange: () => showSend() });
  const others = h("span", { class: "hint" });
  const usual = h("button", { type: "button", class: "small" }, "Back to the usual settings");
  usual.addEventListener("click", () => {
    setOthers(draft.values, {});
    showPanel(page, draft);
    page.panel.querySelector(".more > summary").focus();
  });
  page.drawn = guideList(
    draft.guides,
    () => draft.scale,
    (stroke) => page.stage.chooseStroke(stroke),
  );
  const send = h("div", { class: "send" });
  const showSend = () => {
    setOthers(draft.values, form.changed());
    const changed = Object.keys(draft.values).filter((name) => !OWN.has(name)).length;
    others.textContent = changed > 0 ? ` ${changed} changed` : "";
    usual.hidden = changed === 0;
    replace(send, sendControls(page, draft, form));
  };
  replace(
    page.panel,
    fileList(),
    fileFacts(draft),
    h("fieldset", { class: "group" }, h("legend", {}, "Size when finished"), size.element, note),
    h(
      "fieldset",
      { class: "group" },
      h("legend", {}, "Material"),
      materialCards(draft, () => {
        tolerance.update();
        refresh();
      }),
    ),
    h("fieldset", { class: "group" }, h("legend", {}, "Tolerance"), tolerance.element),
    page.drawn.element,
    h(
      "details",
      { class: "more", open: recall("more", false), ontoggle: (event) => remember("more", event.target.open) },
      h("summary", {}, "More settings", others),
      usual,
      form.element,
      nameField(draft),
    ),
    send,
  );
  refresh();
  showSend();
}

/** What is chosen below “More settings”, of all files alike: they share `values`. */
function setOthers(values, chosen) {
  for (const name of Object.keys(values)) if (!OWN.has(name)) delete values[name];
  for (const [name, value] of Object.entries(chosen)) if (!OWN.has(name)) values[name] = value;
}

function fileList() {
  if (drafts.list.length < 2) return null;
  const chips = drafts.list.map((draft, k) =>
    h(
      "button",
      { type: "button", class: "chip", "aria-pressed": String(k === drafts.current), onclick: () => drafts.select(k) },
      draft.error && icon("warn", 16),
      draft.name,
    ),
  );
  return h(
    "div",
    { class: "files-open" },
    h("div", { class: "files", role: "group", "aria-label": "Files" }, chips),
    h("p", { class: "hint" }, "Each has its own size and drawing; material and settings are those of all."),
  );
}

function fileFacts(draft) {
  const { mesh } = draft;
  const facts = [
    count(mesh.faces, "triangle"),
    bytes(draft.file.size),
    mesh.borderEdges === 0 ? "closed" : "open",
    mesh.pieces > 1 && count(mesh.pieces, "piece"),
  ].filter(Boolean);
  return fileHead(draft.name, facts);
}

const longest = (draft) => Math.max(...extents(draft.mesh)) * draft.scale;

const warning = (text, action = null) =>
  h("div", { class: "warning" }, icon("warn", 18), h("div", {}, h("p", {}, text), action));

function meshWarnings(mesh) {
  return [
    mesh.crowdedEdges > 0 &&
      `${count(mesh.crowdedEdges, "edge")} of the mesh ${mesh.crowdedEdges === 1 ? "has" : "have"} more than two faces (red in the view). They will be cut open.`,
    mesh.insideOut &&
      "The faces of the mesh look inwards. The layout shows the side they look to, so the marks will be inside; turn the faces around in your modelling program if you want them outside.",
    mesh.pieces > 40 && `The mesh consists of ${mesh.pieces} separate pieces; each is cut on its own.`,
  ].filter(Boolean);
}

function materialCards(draft, onChange) {
  const name = freshId("material");
  return h(
    "div",
    { class: "materials", role: "radiogroup", "aria-label": "Material" },
    MATERIALS.map((material) =>
      h(
        "label",
        { class: "material" },
        h("input", {
          type: "radio",
          name,
          value: material.id,
          checked: material.id === draft.material,
          onchange: () => {
            for (const each of drafts.list) each.material = material.id;
            draft.values.e_max = material.tolerance;
            remember("material", material.id);
            onChange();
          },
        }),
        h(
          "span",
          { class: "material-card" },
          h("strong", {}, material.title),
          h("span", { class: "hint" }, material.text),
        ),
      ),
    ),
  );
}

function nameField(draft) {
  const id = freshId("tag");
  return h(
    "fieldset",
    { class: "group" },
    h("legend", {}, "Job"),
    h(
      "div",
      { class: "field" },
      h("div", { class: "field-head" }, h("label", { for: id }, "Name")),
      h("input", {
        type: "text",
        id,
        maxlength: "100",
        value: draft.tag,
        placeholder: draft.name.replace(/\.\w+$/, ""),
        oninput: (event) => {
          draft.tag = event.target.value;
        },
      }),
    ),
  );
}

function sendControls(page, draft, form) {
  const ready = drafts.list.filter((item) => item.mesh);
  const wrong = form.errors.size > 0;
  const label = ready.length > 1 ? `Make sheets of ${ready.length} meshes` : "Make the sheets";
  const disabled = wrong || ready.length < drafts.list.filter((item) => !item.error).length;
  const button = (look, change, text) =>
    h(
      "button",
      {
        type: "button",
        class: look,
        disabled,
        onclick: (event) => start(page, ready, form, event.target.closest(".send"), change),
      },
      text,
    );
  return [
    wrong && h("p", { class: "field-error" }, "Some settings above need another value."),
    h(
      "div",
      { class: "send-row" },
      form.schemas.effort?.enum?.includes("draft") && button("large", { effort: "draft" }, "Quick draft"),
      button("primary large", {}, label),
    ),
  ];
}

/** Elsewhere the page carries on by itself; to send is the person's own decision. */
const NOTHING_LOST = { fix: "nothing is lost here: send it again as soon as the server answers" };

/** Sends every mesh; the first job opens, errors stay here. */
async function start(page, ready, form, place, change) {
  const abort = new AbortController();
  page.sending = abort;
  let first = null;
  for (const draft of ready) {
    const bar = h("progress", { max: "1", "aria-label": "Upload" });
    replace(
      place,
      h("p", { class: "hint" }, `Sending ${draft.name}`),
      bar,
      h("button", { type: "button", onclick: () => abort.abort() }, "Stop"),
    );
    try {
      const job = await execute(
        draft.file,
        { ...parametersOf(draft, form), ...change },
        {
          guides: draft.guides.wire(),
          tag: draft.tag.trim(),
          filename: draft.name,
          signal: abort.signal,
          onProgress: (share) => {
            bar.value = share;
          },
        },
      );
      jobs.put(job);
      remember("values", forTheNext(form.changed()));
      if (draft === drafts.draft) keepPicture(job.jobID, page.stage.viewport?.picture());
      first ??= job;
    } catch (error) {
      page.sending = null;
      if (error.name === "AbortError") return replace(place, sendControls(page, draft, form));
      const places = placesOf(error.problem, draft.mesh);
      page.stage.markPlaces(places);
      page.stage.turnTo(places);
      const problem = { ...inPageWords(error, page.process.inputs), ...(error.problem?.status === 0 && NOTHING_LOST) };
      return replace(place, problemBox(marked(problem, places)), sendControls(page, draft, form));
    }
  }
  page.sending = null;
  page.go(ready.length > 1 ? "#" : `#job/${first.jobID}`);
}

/** Size, tolerance and a plane of symmetry belong to one mesh; the rest is offered again for the next. */
function forTheNext({ symmetry, ...values }) {
  const kept = ["off", "auto"].includes(symmetry) ? { ...values, symmetry } : values;
  return Object.fromEntries(Object.entries(kept).filter(([name]) => !OWN.has(name)));
}

function parametersOf({ values, scale, material, up }, form) {
  return { ...form.changed(), e_max: values.e_max, scale: scale === 1 ? undefined : scale, material, up };
}
