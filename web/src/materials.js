// What sheets are made of: thickness, the tightest bend that works dry and by hand, and a usual size of sheet.
// Bend radii of plywood: FAA AC 43.13-1B, bent along the grain direction that bends best; metal: rolled, not pressed.

export const MATERIALS = [
  {
    id: "paper",
    title: "Paper",
    text: "120 g, hand or plotter",
    thickness: 0.15,
    radius: 1,
    sheet: [210, 297],
    sheetName: "A4",
    preset: "a4",
    tolerance: 0.015,
  },
  {
    id: "card",
    title: "Card",
    text: "300 g to 1 mm board",
    thickness: 0.5,
    radius: 8,
    sheet: [297, 420],
    sheetName: "A3",
    preset: "a3",
    tolerance: 0.02,
  },
  {
    id: "plywood",
    title: "Plywood",
    text: "0.8 to 1 mm, laser",
    thickness: 0.9,
    stiff: true,
    radius: 28,
    sheet: [600, 400],
    sheetName: "600 × 400",
    preset: "600x400",
    tolerance: 0.025,
  },
  {
    id: "metal",
    title: "Sheet metal",
    text: "1 mm aluminium, rolled",
    thickness: 1,
    stiff: true,
    radius: 15,
    sheet: [1000, 500],
    sheetName: "1000 × 500",
    preset: "1000x500",
    tolerance: 0.02,
  },
];

/** Beds of usual lasers and sheets from the shop, in mm, offered beside the paper sizes. */
export const BEDS = ["600x300", "600x400", "900x600", "1000x500", "1220x610"];

export const materialOf = (id) => MATERIALS.find((material) => material.id === id) ?? MATERIALS[1];

export const UNITS = [
  { id: "mm", title: "mm", scale: 1 },
  { id: "cm", title: "cm", scale: 10 },
  { id: "in", title: "inch", scale: 25.4 },
  { id: "m", title: "m", scale: 1000 },
];

/** A size to offer when the file's own cannot be meant: it fits on a table. */
export const OFFERED_SIZE = 200;

const THUMBNAIL = 15;
const CAR = 5000;

/** Millimetres for one unit of a file whose own millimetres cannot be meant; null when they can. */
export function offeredScale(longest) {
  if (!(longest > 0) || (longest >= THUMBNAIL && longest <= CAR)) return null;
  return Number((OFFERED_SIZE / longest).toPrecision(12));
}

/** What is odd about a finished size in mm, in words; null when nothing is. */
export function sizeWarning(longest, material) {
  if (longest < THUMBNAIL)
    return "That is smaller than a thumbnail. Is the file in another unit, perhaps inches, centimetres or metres?";
  if (longest > CAR) return "That is larger than a car. Is the file in another unit, perhaps millimetres?";
  if (longest < 2.5 * material.radius)
    return `That is too small for ${material.title.toLowerCase()}, which cannot be bent tighter than a radius of about ${material.radius} mm.`;
  return null;
}
