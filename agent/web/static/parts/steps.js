// The tree of steps, and the staircase of errors with the noise floor.
import { number, sentence } from "./format.js";
import { html } from "./html.js";
import { plainly } from "./names.js";

const called = (each) => sentence(plainly(each.name)).replace(/^\+ (.)/, (_, letter) => `+ ${letter.toUpperCase()}`);

export function Tree({ state, busy, go }) {
  const children = (parent) => state.nodes.filter((each) => each.parent === parent);
  const branch = (parent) => {
    const own = children(parent);
    return own.length === 0 ? null : html`<ul>${own.map((each) => html`<li>
      <button type="button" class=${`wb-node ${state.path.includes(each.number) ? "on-path" : ""}`} aria-current=${each.number === state.current ? "step" : undefined} disabled=${busy} onClick=${() => go(each.number)}
        title=${`Go to this step: held-out error ${number(each.rmse_held_out)} PV units, fit ${number(each.fit_percent)} %`}>
        <span>${called(each)}</span><span class="wb-node-error">${number(each.rmse_held_out)}</span></button>${branch(each.number)}</li>`)}</ul>`;
  };
  return html`<nav class="wb-tree" aria-label="Steps">${branch(null)}</nav>
    ${state.nodes.length > 1 && html`<p class="quiet">Every step is kept: click one to go back to it.</p>`}`;
}

const SIZE = { width: 320, height: 190, left: 8, right: 8, top: 24, bottom: 26 };

/** Held-out error of each step on the way to the one that is looked at; the band is the noise floor. */
export function Staircase({ state }) {
  const steps = state.path.map((each) => state.nodes[each]);
  const floor = state.found?.floor;
  const largest = Math.max(...steps.map((each) => each.rmse_held_out ?? 0)) || 1;
  const bottom = SIZE.height - SIZE.bottom;
  const y = (value) => SIZE.top + (bottom - SIZE.top) * (1 - Math.min(value / largest, 1));
  const wide = (SIZE.width - SIZE.left - SIZE.right) / steps.length;
  const x = (k) => SIZE.left + k * wide;
  const text = steps.map((each) => `${called(each)} ${number(each.rmse_held_out)}`).join(", ") + (floor ? `; noise floor ${number(floor.low)} to ${number(floor.high)}` : "");
  return html`<div data-testid="staircase" class="wb-stairs">
    <svg viewBox=${`0 0 ${SIZE.width} ${SIZE.height}`} role="img" aria-label=${`Held-out error: ${text}`}>
      ${floor && html`<rect x=${SIZE.left} width=${SIZE.width - SIZE.left - SIZE.right} y=${y(floor.high)} height=${Math.max(2, y(floor.low) - y(floor.high))} class="floor" />
        <text x=${SIZE.width - SIZE.right - 5} y=${y(floor.low) - 6} text-anchor="end" class="floor-name">noise floor</text>`}
      ${steps.map((each, k) => html`<g key=${each.number} class="stair-step">
        ${k > 0 && html`<line x1=${x(k)} x2=${x(k)} y1=${y(steps[k - 1].rmse_held_out)} y2=${y(each.rmse_held_out)} class="riser" />`}
        <line x1=${x(k)} x2=${x(k + 1)} y1=${y(each.rmse_held_out)} y2=${y(each.rmse_held_out)} class="stair" />
        <text x=${x(k) + wide / 2} y=${y(each.rmse_held_out) - 7} text-anchor="middle" class="stair-value">${number(each.rmse_held_out)}</text></g>`)}
      <line x1=${SIZE.left} x2=${SIZE.width - SIZE.right} y1=${bottom} y2=${bottom} class="axis" />
      <text x=${SIZE.left} y=${bottom + 15}>0</text><text x=${SIZE.width - SIZE.right} y=${bottom + 15} text-anchor="end">steps ›</text>
    </svg>
    <ol>${steps.map((each, k) => html`<li data-step=${k} data-error=${each.rmse_held_out}><span>${called(each)}</span> <strong>${number(each.rmse_held_out, 4)}${k > 0 && steps[0].rmse_held_out ? html` <small>${change(each.rmse_held_out / steps[k - 1].rmse_held_out - 1)}</small>` : ""}</strong></li>`)}</ol>
    <p class="quiet">${floor ? `Noise floor ${number(floor.low)} to ${number(floor.high)}, PV units` : "RMSE, PV units"}</p></div>`;
}

const change = (part) => `${part < 0 ? "−" : "+"}${Math.abs(100 * part).toFixed(0)} %`;
