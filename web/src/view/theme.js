// Colours of what is drawn in WebGL and SVG, read from the style sheet so that light and dark have one source.

const cache = new Map();

/** Value of a custom property such as "--accent" in the theme in force. */
export function themeColor(name) {
  if (!cache.has(name)) cache.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  return cache.get(name);
}

/** The colours of parts, in the order of colour numbers. */
export const partColor = (number) => themeColor(`--part-${number % 8}`);

const listeners = new Set();
/** Calls listener() after a change between light and dark. */
export function onThemeChange(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

function changed() {
  cache.clear();
  for (const listener of listeners) listener();
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);

/** "light", "dark" or "auto" (as the system has it). */
export function setTheme(theme) {
  if (theme === "auto") document.documentElement.removeAttribute("data-theme");
  else document.documentElement.setAttribute("data-theme", theme);
  changed();
}

/** Colours of a scale from 0 to 1: calm to alarming, readable without telling red from green. */
const HEAT = [
  [0.17, 0.28, 0.53],
  [0.16, 0.47, 0.6],
  [0.27, 0.66, 0.55],
  [0.78, 0.8, 0.38],
  [0.96, 0.62, 0.24],
  [0.8, 0.2, 0.22],
];

export function heatColor(value) {
  const at = Math.min(0.99999, Math.max(0, value)) * (HEAT.length - 1);
  const k = Math.floor(at);
  return HEAT[k].map((c, channel) => c + (HEAT[k + 1][channel] - c) * (at - k));
}
