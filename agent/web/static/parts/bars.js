// Small pictures of a row: S with its interval as a bar, and the newest PV and OP as two lines.
import { dash, number } from "./format.js";
import { html } from "./html.js";

/** S with its 90 % interval on a scale from 0 to ``widest``, OP units. */
export function StickBand({ s, widest, doubt }) {
  if (!s || s.value === null) return html`<span class="quiet">${dash}</span>`;
  const place = (value) => `${(100 * Math.min(Math.max(value, 0) / (widest || 1), 1)).toFixed(1)}%`;
  const known = s.low !== null && s.high !== null;
  const text = known ? `${number(s.low)} to ${number(s.high)}` : "no interval";
  return html`<span class="band" title=${`S ${number(s.value)} OP units, 90 % interval ${text}`}>
    <span class="band-value">${number(s.value)}</span>
    <svg class="band-bar" height="14" aria-hidden="true">
      <line x1="0" x2="100%" y1="7" y2="7" class="scale" />
      ${known && html`<line x1=${place(s.low)} x2=${place(s.high)} y1="7" y2="7" class=${doubt ? "interval unsure" : "interval"} />
        <line x1=${place(s.low)} x2=${place(s.low)} y1="2.5" y2="11.5" class="end" /><line x1=${place(s.high)} x2=${place(s.high)} y1="2.5" y2="11.5" class="end" />`}
      <line x1=${place(s.value)} x2=${place(s.value)} y1="0.5" y2="13.5" class="value" />
    </svg>
    <span class="band-text">${text}${doubt ? `, ${doubt}` : ""}</span>
  </span>`;
}

function path(values) {
  let drawn = "";
  let pen = "M";
  values.forEach((value, k) => {
    if (value === null) {
      pen = "M";
      return;
    }
    drawn += `${pen}${((100 * k) / Math.max(values.length - 1, 1)).toFixed(1)} ${(22 - 0.2 * value).toFixed(1)}`;
    pen = "L";
  });
  return drawn;
}

export function Sparkline({ spark, loop }) {
  if (!spark) return html`<span class="quiet">${dash}</span>`;
  return html`<svg class="spark" viewBox="0 0 100 24" preserveAspectRatio="none" role="img" aria-label=${`Newest OP and PV of ${loop}`}>
    <path d=${path(spark.op)} class="op" vector-effect="non-scaling-stroke" /><path d=${path(spark.pv)} class="pv" vector-effect="non-scaling-stroke" /></svg>`;
}
