// A picture of a result that this device has not shown yet: the outlines of its sheets, coloured.
import { fileHref, getText } from "../api.js";
import { h, replace, s } from "../dom.js";

const pictures = new Map(); // by job
const inSight = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (!isIntersecting) continue;
    inSight.unobserve(target);
    draw(target).catch(() => pictures.delete(target.dataset.job));
  }
});

/** The element of a successful job; its drawing is fetched when it comes in sight, once. */
export function cutPicture(id) {
  if (!pictures.has(id)) {
    const place = h("div", { class: "drawing", "data-job": id, "aria-hidden": "true" });
    pictures.set(id, place);
    inSight.observe(place);
  }
  return pictures.get(id);
}

async function draw(place) {
  const text = await getText(fileHref(place.dataset.job, "layout.svg"));
  const drawing = new DOMParser().parseFromString(text, "image/svg+xml");
  const outlines = [...drawing.querySelectorAll(".cut")].map((path) => path.getAttribute("d"));
  const box = drawing.documentElement.getAttribute("viewBox");
  replace(
    place,
    s(
      "svg",
      { viewBox: box },
      outlines.map((d, k) => s("path", { class: `color-${k % 8}`, d })),
    ),
  );
}
