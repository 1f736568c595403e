// What the page remembers on this device: settings, and small pictures of jobs. Losing it loses nothing of the server's.

const PREFIX = "sheetform.";
const MAX_PICTURES = 80;

export function recall(name, fallback = null) {
  try {
    const text = localStorage.getItem(PREFIX + name);
    return text === null ? fallback : JSON.parse(text);
  } catch {
    return fallback;
  }
}

export function remember(name, value) {
  try {
    localStorage.setItem(PREFIX + name, JSON.stringify(value));
  } catch {
    /* storage is full or forbidden: the page works without */
  }
}

const MAX_JOBS = 300;

/** How a job is looked at on this device, where that is not what the job itself says: {material, up}. */
export const knownOf = (id) => recall("jobs", {})[id] ?? {};

export function rememberOf(id, more) {
  const { [id]: known, ...all } = recall("jobs", {});
  all[id] = { ...known, ...more };
  for (const old of Object.keys(all).slice(0, -MAX_JOBS)) delete all[old];
  remember("jobs", all);
}

let pictures = null; // read once: all of them together are large
globalThis.addEventListener?.("storage", () => (pictures = null)); // another window has kept one

const allPictures = () => (pictures ??= recall("pictures", {}));

/** Keeps a small picture (a data URL) of a job; the oldest go first. */
export function keepPicture(id, dataUrl) {
  if (!dataUrl) return;
  pictures = recall("pictures", {});
  delete pictures[id];
  pictures[id] = dataUrl;
  const ids = Object.keys(pictures);
  for (const old of ids.slice(0, Math.max(0, ids.length - MAX_PICTURES))) delete pictures[old];
  remember("pictures", pictures);
}

export const inheritPicture = (from, to) => keepPicture(to, allPictures()[to] ?? allPictures()[from]);

/** Whether there is one. */
export const hasPicture = (id) => Boolean(allPictures()[id]);

/** The picture as a Blob, or null. Decoded here because the page's policy allows no data: addresses. */
export function pictureOf(id) {
  const dataUrl = allPictures()[id];
  if (!dataUrl) return null;
  const comma = dataUrl.indexOf(",");
  const bytes = Uint8Array.from(atob(dataUrl.slice(comma + 1)), (c) => c.charCodeAt(0));
  return new Blob([bytes], { type: dataUrl.slice(5, dataUrl.indexOf(";")) });
}
