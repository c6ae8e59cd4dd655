// Parameters of the model: with interval, and as sliders whose curve follows while they move.
import { send } from "./api.js";
import { number, sentence } from "./format.js";
import { html, useEffect, useRef, useState } from "./html.js";
import { parameterWords } from "./names.js";

const FINE = 1000;

export function Sliders({ base, state, busy, show, fit }) {
  const { parameters } = state.model;
  const [own, setOwn] = useState({});
  const running = useRef({ busy: false, next: null });
  useEffect(() => setOwn({}), [state.current, state.model]);
  const simulate = async (values) => {
    const at = running.current;
    if (at.busy) {
      at.next = values;
      return;
    }
    at.busy = true;
    try {
      show((await send(`${base}/simulate`, { values })).pv);
    } catch { /* the session reports what is wrong */ }
    at.busy = false;
    if (at.next) {
      const next = at.next;
      at.next = null;
      simulate(next);
    }
  };
  const move = (each, place) => {
    const values = { ...own, [each.name]: valueOf(each, place / FINE) };
    setOwn(values);
    simulate(values);
  };
  const moved = Object.keys(own).length > 0;
  const groups = new Map();
  for (const each of parameters) {
    const [effect] = parameterWords(each.name);
    groups.set(effect, [...(groups.get(effect) ?? []), each]);
  }
  return html`<section class="card"><h2>Parameters</h2><p class="quiet">Move one: the curve follows.</p>
    ${[...groups].map(([effect, rows]) => html`<fieldset class="group" key=${effect}><legend>${effect || "Process"}</legend>
      ${rows.map((each) => html`<label class=${`wb-slider ${each.name in own ? "moved" : ""}`} key=${each.name}>
        <span class="wb-slider-line"><span>${sentence(parameterWords(each.name)[1])}</span><span><strong>${number(own[each.name] ?? each.value)}</strong> ${each.unit === "1" ? "" : each.unit}</span></span>
        <input type="range" min="0" max=${FINE} step="1" disabled=${busy} value=${Math.round(FINE * placeOf(each, own[each.name] ?? each.fitted))} onInput=${(event) => move(each, Number(event.target.value))} />
        <small class="quiet">90 % interval ${number(each.low)} to ${number(each.high)}${each.at_bound ? ", at the bound" : ""}</small></label>`)}</fieldset>`)}
    <p class="buttons"><button type="button" class=${moved ? "primary" : ""} disabled=${busy || !moved} onClick=${() => fit(own)}>Fit from here</button>
      <button type="button" disabled=${!moved} onClick=${() => { setOwn({}); show(null); }}>Back to the fit</button></p></section>`;
}

const valueOf = (each, part) => (each.log ? each.low_bound * (each.high_bound / each.low_bound) ** part : each.low_bound + part * (each.high_bound - each.low_bound));
const placeOf = (each, value) => {
  const part = each.log ? Math.log(value / each.low_bound) / Math.log(each.high_bound / each.low_bound) : (value - each.low_bound) / (each.high_bound - each.low_bound);
  return Math.min(Math.max(Number.isFinite(part) ? part : 0, 0), 1);
};
