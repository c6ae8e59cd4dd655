// The residual against an axis that one chooses: points, bin means, and the band of no relation.
import { get } from "./api.js";
import { number, words } from "./format.js";
import { html, useEffect, useState } from "./html.js";

const SIZE = { width: 640, height: 240, left: 46, right: 8, top: 8, bottom: 34 };

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
      ${axes.map((each) => html`<option value=${each.axis}>${words(each.axis)}: ${number(100 * each.share)} %, p = ${number(each.p, 2)}</option>`)}</select></label>
    ${panel?.axis === axis && html`<${Panel} panel=${panel} stretch=${stretch} />`}</section>`;
}

function Panel({ panel, stretch }) {
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
  const text = `Mean residual in ${panel.means.length} bins of ${words(panel.axis)}; ${number(100 * panel.share)} % of the variance, p = ${number(panel.p, 2)}`;
  return html`<svg class="wb-panel" viewBox=${`0 0 ${SIZE.width} ${SIZE.height}`} role="img" aria-label=${text}>
      <path d=${`${steps(panel.high)}${back}Z`} class="band-area" />
      ${panel.x.map((x, k) => x !== null && panel.residual[k] !== null && html`<circle cx=${sx(x)} cy=${sy(panel.residual[k])} r=${lit(panel.time[k]) ? 2.6 : 1.4} class=${lit(panel.time[k]) ? "lit" : "dot"} />`)}
      <line x1=${SIZE.left} x2=${SIZE.width - SIZE.right} y1=${sy(0)} y2=${sy(0)} class="axis" />
      <path d=${steps(panel.means)} class=${fails ? "means fails" : "means"} />
      <text x=${SIZE.left} y=${SIZE.height - 18}>${number(x0)}</text><text x=${SIZE.width - SIZE.right} y=${SIZE.height - 18} text-anchor="end">${number(x1)}</text>
      <text x=${SIZE.width / 2} y=${SIZE.height - 4} text-anchor="middle">${words(panel.axis)}, ${panel.unit}</text>
      <text x=${SIZE.left - 6} y=${sy(reach) + 10} text-anchor="end">${number(reach, 2)}</text><text x=${SIZE.left - 6} y=${sy(-reach)} text-anchor="end">${number(-reach, 2)}</text>
    </svg>
    <p>${fails ? `The model fails here: ${number(100 * panel.share)} % of the residual, p = ${number(panel.p, 2)}. Such a pattern is made by ${panel.causes}.` : `No failure beyond chance on this axis, p = ${number(panel.p, 2)}. The band holds the mean where residual and axis are not related.`}</p>`;
}
