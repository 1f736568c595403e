// Small drawings, made of strokes in the colour of the text.
import { s } from "../dom.js";

const PATHS = {
  logo: "M4 17.5 9 4.5l6 2.2 5-1.7-5 13-6 1.8zM9 4.5 9 19.8M15 6.7v11.3",
  upload: "M12 15V4m0 0L7.5 8.5M12 4l4.5 4.5M4 15v4a1 1 0 0 0 1 1h14a1 1 0 0 0 1-1v-4",
  download: "M12 4v11m0 0 4.5-4.5M12 15l-4.5-4.5M4 19h16",
  back: "M19 12H5m0 0 6-6m-6 6 6 6",
  check: "M4.5 12.5 10 18 19.5 7",
  warn: "M12 9v4.5m0 3v.01M10.4 4.6 3 17.6A1.8 1.8 0 0 0 4.6 20.4h14.8a1.8 1.8 0 0 0 1.6-2.8L13.6 4.6a1.8 1.8 0 0 0-3.2 0z",
  close: "M6 6l12 12M18 6 6 18",
  play: "M8 5.5v13l10-6.5z",
  fit: "M4 9V5a1 1 0 0 1 1-1h4m6 0h4a1 1 0 0 1 1 1v4m0 6v4a1 1 0 0 1-1 1h-4m-6 0H5a1 1 0 0 1-1-1v-4",
  sun: "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8zM12 2.5V5m0 14v2.5M2.5 12H5m14 0h2.5M5.3 5.3 7 7m10 10 1.7 1.7M18.7 5.3 17 7M7 17l-1.7 1.7",
  moon: "M20 14.2A8.2 8.2 0 0 1 9.8 4a8.2 8.2 0 1 0 10.2 10.2z",
  auto: "M12 4a8 8 0 1 0 0 16zM12 4a8 8 0 0 1 0 16",
  trash: "M5 7h14M10 7V4.5h4V7m-7.5 0 .8 12a1 1 0 0 0 1 1h7.4a1 1 0 0 0 1-1l.8-12M10 11v5m4-5v5",
  again: "M4.5 12a7.5 7.5 0 1 0 2.4-5.5M4 4v4.5h4.5",
  cube: "M12 3.5 4.5 7.6v8.8l7.5 4.1 7.5-4.1V7.6zM4.5 7.6 12 11.8l7.5-4.2M12 11.8v8.7",
  flat: "M3.5 6.5 10 4l4 3 6.5-2v12.5L14 20l-4-3-6.5 2.5zM10 4v13m4-10v13",
  list: "M9 6h11M9 12h11M9 18h11M4.5 6v.01M4.5 12v.01M4.5 18v.01",
  info: "M12 11v6m0-9.5v.01M12 3.5a8.5 8.5 0 1 0 0 17 8.5 8.5 0 0 0 0-17z",
};

export function icon(name, size = 20) {
  return s(
    "svg",
    { class: "icon", viewBox: "0 0 24 24", width: size, height: size, "aria-hidden": "true" },
    s("path", { d: PATHS[name] }),
  );
}
