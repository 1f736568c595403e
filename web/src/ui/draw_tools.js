// Seams and areas without seams, drawn on the shape before it is cut: the tools over the 3D view, the list in the panel.
import { announce, freshId, h, replace } from "../dom.js";
import { millimetres } from "../format.js";
import { lengthOf } from "../guides.js";
import { icon } from "./icons.js";

const MODES = [
  ["turn", "Turn", "hand", ""],
  ["seam", "Draw seam", "pen", "Draw where a seam shall run. Drag beside the shape to turn it."],
  ["keep_out", "No seams", "brush", "Paint where no seam may run. Drag beside the shape to turn it."],
];
const KEYS =
  "Arrow keys move the cross, Enter sets a point, Backspace takes it back, Escape ends the line. Shift + arrow keys turn the shape.";
const BY_KEYS = "Enter: draw by keys.";
const [FINEST, WIDEST] = [0.02, 0.6]; // brush, as shares of the mesh's radius

/** @param pen of the view  @param scale() millimetres for one unit */
export function drawTools(pen, guides, scale) {
  const name = freshId("pen");
  const hint = h("p", { class: "draw-hint", role: "status" });
  const size = h("input", {
    type: "range",
    min: "0",
    max: "1",
    step: "0.01",
    "aria-label": "Size of the brush",
    value: String(Math.log(pen.radius / pen.input.radius / FINEST) / Math.log(WIDEST / FINEST)),
    oninput: () => setSize(),
  });
  const sizeText = h("span", { class: "hint" });
  const brush = h("label", { class: "brush", hidden: true }, sizeText, size);
  function setSize() {
    pen.radius = pen.input.radius * FINEST * (WIDEST / FINEST) ** Number(size.value);
    sizeText.textContent = `⌀ ${millimetres(2 * pen.radius * scale())}`;
    size.setAttribute("aria-valuetext", millimetres(2 * pen.radius * scale()));
  }
  const radios = MODES.map(([mode, title]) =>
    h("input", {
      type: "radio",
      name,
      value: mode,
      checked: mode === pen.mode,
      "aria-label": title,
      onchange: () => setMode(mode),
      onfocus: () => showUndo(),
      onblur: () => showUndo(),
      onkeydown: (event) => {
        if (event.key !== "Enter") return;
        event.preventDefault();
        pen.viewport.canvas.focus({ focusVisible: true });
      },
    }),
  );
  function setMode(mode) {
    pen.setMode(mode);
    brush.hidden = mode !== "keep_out";
    setSize();
    showUndo();
  }
  const undo = h(
    "button",
    { type: "button", class: "tool", title: "Undo (Ctrl Z)", "aria-label": "Undo", onclick: () => guides.undo() },
    icon("undo", 18),
  );
  const words = () => {
    if (pen.keys.shown) return KEYS;
    if (pen.mode !== "turn" && radios.some((radio) => radio.matches(":focus-visible"))) return BY_KEYS;
    // Once something is drawn, it is known how.
    return undo.hidden ? MODES.find(([mode]) => mode === pen.mode)[3] : "";
  };
  const showUndo = () => {
    undo.hidden = guides.past.length === 0;
    hint.textContent = words();
    hint.hidden = !hint.textContent;
  };
  pen.keys.onShown = showUndo;
  const stop = guides.onChange(showUndo);
  const onKey = (event) => {
    if (event.target.closest?.("input[type=text], textarea, select")) return;
    if (event.key === "Escape" && pen.mode !== "turn") {
      radios[0].checked = true;
      setMode("turn");
    }
    if (event.key.toLowerCase() === "z" && (event.ctrlKey || event.metaKey) && !event.shiftKey) {
      event.preventDefault();
      guides.undo();
    }
  };
  addEventListener("keydown", onKey);
  setMode(pen.mode);
  return {
    element: h(
      "div",
      { class: "draw-tools" },
      h(
        "div",
        { class: "segments small", role: "radiogroup", "aria-label": "What the pointer does" },
        MODES.map(([, title, glyph], k) =>
          h("label", { title }, radios[k], h("span", {}, icon(glyph, 17), h("span", { class: "word" }, title))),
        ),
      ),
      undo,
      brush,
      hint,
    ),
    update: setSize,
    dispose() {
      stop();
      removeEventListener("keydown", onKey);
    },
  };
}

/** What has been drawn, with a way to take each away again. @param onChosen(stroke or null) to light it up */
export function guideList(guides, scale, onChosen) {
  const list = h("ul", { class: "guide-list" });
  const remove = (k, what) => {
    guides.remove(k);
    announce(`${what} removed`);
    // The focus stays in the list: on what has moved up, or on the way back.
    (list.querySelectorAll("button")[Math.min(k, guides.list.length - 1)] ?? undo).focus();
  };
  const undo = h("button", { type: "button", class: "small", onclick: () => guides.undo() }, "Undo");
  const clear = h("button", { type: "button", class: "small", onclick: () => guides.clear() }, "Remove all");
  const element = h(
    "fieldset",
    { class: "group guides" },
    h("legend", {}, "Drawn on the shape"),
    list,
    h("div", { class: "row" }, undo, clear),
  );
  const update = () => {
    element.hidden = guides.empty && guides.past.length === 0;
    undo.hidden = guides.past.length === 0;
    clear.hidden = guides.list.length < 2;
    const count = { seam: 0, keep_out: 0 };
    replace(
      list,
      guides.list.map((stroke, k) => {
        const number = ++count[stroke.kind];
        const what = stroke.kind === "seam" ? `Seam ${number}` : `No seams ${number}`;
        return h(
          "li",
          { onpointerenter: () => onChosen(stroke), onpointerleave: () => onChosen(null) },
          icon(stroke.kind === "seam" ? "pen" : "brush", 17),
          h("span", {}, what),
          h("span", { class: "hint" }, sizeOf(stroke, scale())),
          h(
            "button",
            {
              type: "button",
              class: "quiet small right",
              "aria-label": `Remove ${what}`,
              title: `Remove ${what}`,
              onfocus: () => onChosen(stroke),
              onblur: () => onChosen(null),
              onclick: () => remove(k, what),
            },
            icon("trash", 17),
          ),
        );
      }),
    );
  };
  update();
  return { element, update, stop: guides.onChange(update) };
}

function sizeOf(stroke, scale) {
  if (stroke.kind === "keep_out") return `⌀ ${millimetres(2 * stroke.radius * scale)}`;
  return `${millimetres(lengthOf(stroke) * scale)}${stroke.closed ? ", closed" : ""}`;
}
