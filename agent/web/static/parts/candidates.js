// Effects to tick: what each would gain, and what rejects it.
import { number, words } from "./format.js";
import { html } from "./html.js";

export function Candidates({ state, busy, tick, untick }) {
  const { found, model } = state;
  const ticked = model.effects;
  const tried = found ? found.candidates : [];
  const verdict = found?.verdict;
  const alike = new Set(verdict?.effect ? [verdict.effect, ...verdict.indistinguishable] : []);
  return html`<section class="card"><h2>Effects</h2>
    ${ticked.map((each) => html`<${Row} key=${each} effect=${each} on=${true} busy=${busy} change=${() => untick(each)} note="in the model" />`)}
    ${!found && html`<p class="quiet" role="status">Each effect is being tried</p>`}
    ${tried.map((each) => html`<${Row} key=${each.effect} effect=${each.effect} on=${false} busy=${busy} change=${() => tick(each.effect)} each=${each} loud=${each.effect === verdict?.effect} />`)}
    ${alike.size > 1 && html`<p class="quiet">This record cannot distinguish ${[...alike].map(words).join(" from ")}. In manual, step OP up and down by less and by more than the stick band, each side of a reversal: they differ in the first slip.</p>`}
    ${found && !verdict.effect && html`<p class="quiet">Nothing more is confirmed.</p>`}</section>`;
}

function Row({ effect, on, busy, change, each, note, loud }) {
  const place = (value) => `${Math.min(Math.max(value, 0), 100)}%`;
  return html`<label class=${`wb-effect ${loud ? "loud" : ""}`} data-effect=${effect}>
    <input type="checkbox" checked=${on} disabled=${busy} onChange=${change} />
    <span class="wb-name">${words(effect)}</span>
    ${each ? html`<span class="wb-gain">${each.percent.toFixed(1)} % <small>(${each.low.toFixed(1)} to ${each.high.toFixed(1)}), p = ${number(each.p, 2)}</small></span>
      <svg class="wb-bar" height="8" width="100%" aria-hidden="true"><line x1="0" x2="100%" y1="4" y2="4" class="scale" />
        <line x1=${place(each.low)} x2=${place(each.high)} y1="4" y2="4" class="interval" /><line x1=${place(each.percent)} x2=${place(each.percent)} y1="0" y2="8" class="value" /></svg>
      ${each.objection && html`<small class="wb-why">rejected: ${each.objection}</small>`}` : html`<span class="quiet">${note}</span>`}
  </label>`;
}
