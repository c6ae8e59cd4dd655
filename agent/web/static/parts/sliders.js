// Parameters of the model: with interval, and as sliders whose curve follows while they move.
import { send } from "./api.js";
import { number, words } from "./format.js";
import { html, useEffect, useRef, useState } from "./html.js";

const FINE = 1000;

export function Sliders({ base, state, busy, show, fit }) {
  const { parameters } = state.model;
  const [own, setOwn] = useState({});
  const running = useRef({ busy: false, next: null });
  useEffect(() => setOwn({}), [state.current, state.model]);
  const ask = async (values) => {
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
      ask(next);
    }
  };
  const move = (each, place) => {
    const values = { ...own, [each.name]: valueOf(each, place / FINE) };
    setOwn(values);
    ask(values);
  };
  const moved = Object.keys(own).length > 0;
  return html`<section class="card"><h2>Parameters</h2>
    ${parameters.map((each) => html`<label class="wb-slider" key=${each.name}>
      <span>${words(each.name)} <strong>${number(own[each.name] ?? each.value)}</strong> ${each.unit === "1" ? "" : each.unit} <small class="quiet">(${number(each.low)} to ${number(each.high)})${each.at_bound ? ", at the bound" : ""}</small></span>
      <input type="range" min="0" max=${FINE} step="1" disabled=${busy} value=${Math.round(FINE * placeOf(each, own[each.name] ?? each.fitted))} onInput=${(event) => move(each, Number(event.target.value))} /></label>`)}
    <p class="buttons"><button type="button" disabled=${busy || !moved} onClick=${() => fit(own)}>Fit from here</button>
      <button type="button" disabled=${!moved} onClick=${() => { setOwn({}); show(null); }}>Back to the fit</button></p></section>`;
}

const valueOf = (each, part) => (each.log ? each.low_bound * (each.high_bound / each.low_bound) ** part : each.low_bound + part * (each.high_bound - each.low_bound));
const placeOf = (each, value) => {
  const part = each.log ? Math.log(value / each.low_bound) / Math.log(each.high_bound / each.low_bound) : (value - each.low_bound) / (each.high_bound - each.low_bound);
  return Math.min(Math.max(Number.isFinite(part) ? part : 0, 0), 1);
};
