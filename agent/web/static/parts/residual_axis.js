// The residual against an axis that one chooses: points, bin means, and the band of no relation.
import { get } from "./api.js";
import { number, words } from "./format.js";
import { html, useEffect, useState } from "./html.js";
import { named, plainly } from "./names.js";
import { useWidth } from "./width.js";

const FRAME = { height: 270, left: 54, right: 10, top: 8, bottom: 38 };

export function ResidualAxis({ base, state, stretch }) {
  const axes = state.found?.axes ?? [];
  const [chosen, choose] = useState(null);
  const axis = axes.some((each) => each.axis === chosen) ? chosen : axes[0]?.axis;
  const [panel, setPanel] = useState(null);
  useEffect(() => {
    if (!axis) return undefined;
    const left = new AbortController();
    get(`${base}/axis/${axis}`, left.signal).then(setPanel, () => {});
    return () => left.abort();
  }, [axis, state.found]);
  if (!axis) return null;
  return html`<section class="card"><h2>Where it fails</h2>
    <label class="field wb-axis">Residual against<select data-testid="axis" value=${axis} onChange=${(event) => choose(event.target.value)}>
      ${axes.map((each) => html`<option value=${each.axis}>${named(each.axis)}: ${number(100 * each.share)} %, p = ${number(each.p, 2)}</option>`)}</select></label>
    ${panel?.axis === axis && html`<${Panel} panel=${panel} stretch=${stretch} />`}</section>`;
}

function Panel({ panel, stretch }) {
  const [place, width] = useWidth();
  const SIZE = { ...FRAME, width: Math.max(width, 240) };
  const finite = (values) => values.filter((value) => value !== null);
  const x0 = panel.edges[0];
  const x1 = panel.edges.at(-1);
  const reach = Math.max(...finite([...panel.residual, ...panel.means, ...panel.low, ...panel.high]).map(Math.abs)) || 1;
  const sx = (value) => SIZE.left + ((SIZE.width - SIZE.left - SIZE.right) * (value - x0)) / (x1 - x0 || 1);
  const sy = (value) => SIZE.top + (SIZE.height - SIZE.top - SIZE.bottom) * (0.5 - 0.5 * (value / reach));
  const lit = (time) => stretch && time >= stretch[0] && time <= stretch[1];
  const steps = (values) => values.map((value, k) => `${k ? "L" : "M"}${sx(panel.edges[k])} ${sy(value)}L${sx(panel.edges[k + 1])} ${sy(value)}`).join("");
  const back = [...panel.low].map((value, k) => [k, value]).reverse().map(([k, value]) => `L${sx(panel.edges[k + 1])} ${sy(value)}L${sx(panel.edges[k])} ${sy(value)}`).join("");
  const fails = panel.p < 0.05;
  const bottom = SIZE.height - SIZE.bottom;
  const text = `Mean residual in ${panel.means.length} bins of ${words(panel.axis)}; ${number(100 * panel.share)} % of the variance, p = ${number(panel.p, 2)}`;
  return html`<div ref=${place}><svg class="wb-panel" viewBox=${`0 0 ${SIZE.width} ${SIZE.height}`} role="img" aria-label=${text}>
      ${ticks(-reach, reach, 5).map((value) => html`<line x1=${SIZE.left} x2=${SIZE.width - SIZE.right} y1=${sy(value)} y2=${sy(value)} class=${value === 0 ? "axis" : "grid"} /><text x=${SIZE.left - 6} y=${sy(value) + 4} text-anchor="end">${number(value, 2)}</text>`)}
      ${ticks(x0, x1, SIZE.width / 80).map((value) => html`<line x1=${sx(value)} x2=${sx(value)} y1=${SIZE.top} y2=${bottom} class="grid" /><text x=${sx(value)} y=${bottom + 15} text-anchor="middle">${number(value)}</text>`)}
      <path d=${`${steps(panel.high)}${back}Z`} class="band-area" />
      ${panel.x.map((x, k) => x !== null && panel.residual[k] !== null && html`<circle cx=${sx(x)} cy=${sy(panel.residual[k])} r=${lit(panel.time[k]) ? 2.6 : 1.4} class=${lit(panel.time[k]) ? "lit" : "dot"} />`)}
      <path d=${steps(panel.means)} class=${fails ? "means fails" : "means"} />
      <text x=${(SIZE.left + SIZE.width) / 2} y=${SIZE.height - 4} text-anchor="middle">${words(panel.axis)}, ${panel.unit}</text>
      <text transform=${`translate(11 ${(SIZE.top + bottom) / 2}) rotate(-90)`} text-anchor="middle">residual, PV units</text>
    </svg></div>
    <ul class="key"><li><i class=${fails ? "model" : "ink"}></i>mean of each bin</li><li><i class="band-key"></i>where the mean lies if the two are not related</li></ul>
    <p>${fails ? html`<strong>The model fails here:</strong> ${number(100 * panel.share)} % of the residual, p = ${number(panel.p, 2)}. Such a pattern is made by ${plainly(panel.causes)}.` : `No failure beyond chance on this axis, p = ${number(panel.p, 2)}.`}</p>`;
}

/** Round values between two ends, about ``count`` of them. */
function ticks(low, high, count) {
  const rough = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(k * step);
  return found;
}
