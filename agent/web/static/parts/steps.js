// The tree of steps, and the staircase of errors with the noise floor.
import { number } from "./format.js";
import { html } from "./html.js";

export function Tree({ state, busy, go }) {
  const children = (parent) => state.nodes.filter((each) => each.parent === parent);
  const branch = (parent) => {
    const own = children(parent);
    return own.length === 0 ? null : html`<ul>${own.map((each) => html`<li>
      <button type="button" class="wb-node" aria-current=${each.number === state.current ? "step" : undefined} disabled=${busy} onClick=${() => go(each.number)}>
        <span>${each.name}</span><span class="under">${number(each.rmse_held_out)}</span></button>${branch(each.number)}</li>`)}</ul>`;
  };
  return html`<nav class="wb-tree" aria-label="Steps">${branch(null)}</nav>`;
}

const HEIGHT = 150;

/** Held-out error of each step on the way to the one that is looked at; the band is the noise floor. */
export function Staircase({ state }) {
  const steps = state.path.map((each) => state.nodes[each]);
  const largest = Math.max(...steps.map((each) => each.rmse_held_out ?? 0)) || 1;
  const floor = state.found?.floor;
  const y = (value) => 8 + (HEIGHT - 30) * (1 - Math.min(value / largest, 1));
  const wide = 100 / steps.length;
  const text = steps.map((each) => `${each.name} ${number(each.rmse_held_out)}`).join(", ") + (floor ? `; noise floor ${number(floor.low)} to ${number(floor.high)}` : "");
  return html`<div data-testid="staircase" class="wb-stairs">
    <svg height=${HEIGHT} width="100%" role="img" aria-label=${`Held-out error: ${text}`}>
      ${floor && html`<rect x="0" width="100%" y=${y(floor.high)} height=${Math.max(2, y(floor.low) - y(floor.high))} class="floor" />`}
      ${steps.map((each, k) => html`<line x1=${`${k * wide}%`} x2=${`${(k + 1) * wide}%`} y1=${y(each.rmse_held_out)} y2=${y(each.rmse_held_out)} class="stair" />
        ${k > 0 && html`<line x1=${`${k * wide}%`} x2=${`${k * wide}%`} y1=${y(steps[k - 1].rmse_held_out)} y2=${y(each.rmse_held_out)} class="riser" />`}`)}
      <line x1="0" x2="100%" y1=${y(0)} y2=${y(0)} class="axis" />
    </svg>
    <ol>${steps.map((each, k) => html`<li data-step=${k} data-error=${each.rmse_held_out}><span>${each.name}</span> <strong>${number(each.rmse_held_out, 4)}</strong></li>`)}</ol>
    ${floor && html`<p class="quiet">Noise floor ${number(floor.low)} to ${number(floor.high)}, PV units</p>`}</div>`;
}
