// Numbers and times as engineers read them.
export const dash = "–";

export function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return dash;
  if (value !== 0 && (Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3)) return value.toExponential(digits - 1);
  return String(Number(value.toPrecision(digits)));
}

export const percent = (value) => (value === null || value === undefined ? dash : `${Math.round(100 * value)} %`);

export function duration(seconds) {
  if (seconds === null || seconds === undefined) return dash;
  const steps = [[86400, "d"], [3600, "h"], [60, "min"]];
  for (const [size, unit] of steps) if (seconds >= 2 * size) return `${Math.floor(seconds / size)} ${unit}`;
  return `${Math.max(0, Math.round(seconds))} s`;
}

export function moment(seconds) {
  if (seconds === null || seconds === undefined) return dash;
  const date = new Date(1000 * seconds);
  const two = (value) => String(value).padStart(2, "0");
  const day = `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`;
  return `${day} ${two(date.getHours())}:${two(date.getMinutes())}`;
}

export const words = (text) => (text ?? "").replaceAll("_", " ");

/** Where a line begins, with a capital letter. */
export const sentence = (text) => (text ? text[0].toUpperCase() + text.slice(1) : "");

const MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];

/** A time as short as it can be: the hour of today, the day of this year, or the whole date. */
export function when(seconds) {
  if (seconds === null || seconds === undefined) return dash;
  const date = new Date(1000 * seconds);
  const now = new Date();
  const two = (value) => String(value).padStart(2, "0");
  const hour = `${two(date.getHours())}:${two(date.getMinutes())}`;
  if (date.toDateString() === now.toDateString()) return hour;
  const day = `${date.getDate()} ${MONTHS[date.getMonth()]}`;
  return date.getFullYear() === now.getFullYear() ? `${day}, ${hour}` : `${day} ${date.getFullYear()}`;
}
