// Elements by function call. Text is always set as text: nothing here ever parses HTML.

const SVG = "http://www.w3.org/2000/svg";

/** An HTML element: h("button", {class: "primary", onclick: go}, "Start", icon). Properties that are null are left out. */
export function h(tag, props = {}, ...children) {
  return fill(document.createElement(tag), props, children);
}

/** The same for SVG elements. */
export function s(tag, props = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), props, children);
}

function fill(element, props, children) {
  for (const [name, value] of Object.entries(props)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "class") element.setAttribute("class", value);
    else if (name === "value" || name === "checked" || name === "selected") element[name] = value;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  append(element, children);
  return element;
}

/** Appends texts, elements and (nested) lists of them; null is nothing. */
export function append(element, children) {
  for (const child of children.flat(Infinity)) {
    if (child !== null && child !== undefined && child !== false) element.append(child);
  }
  return element;
}

/** Replaces what `element` holds. */
export function replace(element, ...children) {
  element.replaceChildren();
  return append(element, children);
}

let lastId = 0;
/** An id no other element has, for labels and descriptions. */
export function freshId(prefix = "f") {
  return `${prefix}-${++lastId}`;
}

/** Says `text` to a screen reader without moving the focus. */
export function announce(text) {
  const region = document.getElementById("live");
  if (region) region.textContent = text;
}

/** Calls `work` once per frame at most, however often the returned function is called. */
export function oncePerFrame(work) {
  let pending = false;
  let last = [];
  return (...args) => {
    last = args;
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => {
      pending = false;
      work(...last);
    });
  };
}
