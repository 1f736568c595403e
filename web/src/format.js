// Numbers as people write them. One place, so that the same length reads the same everywhere.

const number = (digits) => new Intl.NumberFormat("en", { maximumFractionDigits: digits });
const grouped = new Intl.NumberFormat("en");

export function count(value, singular, plural = `${singular}s`) {
  return `${grouped.format(value)} ${value === 1 ? singular : plural}`;
}

/** Millimetres with as many digits as a workshop can use: < 0.01 mm, 0.04 mm, 3.2 mm, 148 mm, 2.35 m. */
export function millimetres(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size >= 2000) return `${number(2).format(value / 1000)} m`;
  if (size >= 100) return `${number(0).format(value)} mm`;
  if (size >= 10) return `${number(1).format(value)} mm`;
  if (size >= 0.01 || size === 0) return `${number(2).format(value)} mm`;
  return "< 0.01 mm";
}

/** Width by depth, and height, with one unit: 313 × 141 mm. */
export function extent(...sizes) {
  const most = Math.max(...sizes);
  const digits = most >= 100 ? 0 : most >= 10 ? 1 : 2;
  return `${sizes.map((size) => number(digits).format(size)).join(" × ")} mm`;
}

/** A length that adds up over a whole job: metres from one metre on. */
export function metres(value) {
  return Math.abs(value) >= 1000 ? `${number(2).format(value / 1000)} m` : millimetres(value);
}

/** Square millimetres as mm², cm² or m². */
export function area(value) {
  if (value < 100) return `${number(1).format(value)} mm²`;
  return value >= 1e6
    ? `${number(2).format(value / 1e6)} m²`
    : `${number(value < 1000 ? 1 : 0).format(value / 100)} cm²`;
}

export function percent(fraction, digits = 2) {
  return `${number(digits).format(fraction * 100)} %`;
}

export function bytes(value) {
  if (value < 1000) return `${value} B`;
  if (value < 1e6) return `${number(0).format(value / 1000)} KB`;
  return `${number(1).format(value / 1e6)} MB`;
}

export function duration(seconds) {
  if (seconds < 10) return `${number(1).format(Math.max(0, seconds))} s`;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${number(1).format(seconds / 3600)} h`;
}

/** "just now", "5 min ago", "yesterday", or the date. */
export function ago(time, now = Date.now()) {
  const seconds = (now - new Date(time).getTime()) / 1000;
  if (!Number.isFinite(seconds)) return "";
  if (seconds < 60) return "just now";
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ago`;
  if (seconds < 86400) return `${Math.floor(seconds / 3600)} h ago`;
  if (seconds < 2 * 86400) return "yesterday";
  return new Date(time).toLocaleDateString("en", { day: "numeric", month: "short", year: "numeric" });
}

/** At most `digits` significant digits, without trailing zeros, for input fields. */
export function significant(value, digits = 4) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : "";
}
