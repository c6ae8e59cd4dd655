// Effects to tick: what each would gain, what rejects it, and which of them this record cannot distinguish.
import { sentence } from "./format.js";
import { html } from "./html.js";
import { named, plainly } from "./names.js";

const SEEN = 1; // %: a smaller fall of the error is none

export function Candidates({ state, busy, tick, untick }) {
  const { found, model } = state;
  const tried = found ? found.candidates : [];
  const verdict = found?.verdict;
  const alike = new Set(verdict?.effect && verdict.indistinguishable.length ? [verdict.effect, ...verdict.indistinguishable] : []);
  const together = tried.filter((each) => alike.has(each.effect));
  const others = tried.filter((each) => !alike.has(each.effect));
  const row = (each) => html`<${Row} key=${each.effect} effect=${each.effect} on=${false} busy=${busy} change=${() => tick(each.effect)} each=${each} loud=${each.effect === verdict?.effect} />`;
  return html`<section class="card wb-candidates"><h2>Effects</h2>
    <p class="quiet">Tick one: everything is fitted again. An effect that nothing in the residual hints at is fitted only when you tick it. The bar is how far the held-out squared error is expected to fall, with its 90 % interval; the odds say how much likelier the record is with the effect.</p>
    ${model.effects.map((each) => html`<${Row} key=${each} effect=${each} on=${true} busy=${busy} change=${() => untick(each)} note="in the model" />`)}
    ${!found && html`<p class="quiet working" role="status">Each effect is being tried</p>`}
    ${together.length > 0 && html`<div class="wb-alike" role="group" aria-label="Effects that this record cannot distinguish"><p class="wb-alike-title">This record cannot distinguish these</p>
      ${together.map(row)}
      ${verdict.test && html`<p class="quiet"><strong>The test that would:</strong> ${verdict.test}</p>`}</div>`}
    ${others.map(row)}
    ${found && found.not_fitted.map((each) => html`<${Row} key=${each} effect=${each} on=${false} busy=${busy} change=${() => tick(each)} note="not fitted: no hint" />`)}
    ${found && found.not_shown.map((each) => html`<${Row} key=${each.effect} effect=${each.effect} on=${false} busy=${busy} change=${() => tick(each.effect)} why=${`This record cannot show it: ${each.why}`} />`)}
    ${found && !verdict.effect && html`<p class="quiet">Nothing more is confirmed.</p>`}</section>`;
}

function Row({ effect, on, busy, change, each, note, why, loud }) {
  const place = (value) => `${Math.min(Math.max(value, 0), 100)}%`;
  const idle = each && each.percent < SEEN;
  return html`<label class=${`wb-effect ${loud ? "loud" : ""} ${idle ? "idle" : ""}`} data-effect=${effect}>
    <input type="checkbox" checked=${on} disabled=${busy} onChange=${change} />
    <span class="wb-name">${named(effect)}${loud && html` <span class="tag">proposed</span>`}</span>
    ${each ? html`<span class="wb-gain">${fall(each.percent)}${!idle && html`<small>${fall(each.low)} to ${fall(each.high)}${beside(each) && `, ${each.evidence}`}</small>`}</span>
      ${!idle && html`<svg class="wb-bar" height="8" width="100%" role="img" aria-label=${`Error falls by ${fall(each.percent)}, ${fall(each.low)} to ${fall(each.high)}`}><line x1="0" x2="100%" y1="4" y2="4" class="scale" />
        <line x1=${place(each.low)} x2=${place(each.high)} y1="4" y2="4" class="interval" /><line x1=${place(each.percent)} x2=${place(each.percent)} y1="0" y2="8" class="value" /></svg>`}
      ${!idle && !beside(each) && html`<small class="wb-why">${sentence(plainly(each.evidence))}</small>`}` : html`${note && html`<span class="quiet">${note}</span>`}${why && html`<small class="wb-why">${sentence(plainly(why))}</small>`}`}
  </label>`;
}

const fall = (value) => (Math.abs(value) < 0.5 ? "0 %" : `${value < 0 ? "−" : ""}${Math.abs(value).toFixed(0)} %`);
const beside = (each) => each.evidence.startsWith("p "); // else words, in a line of their own
