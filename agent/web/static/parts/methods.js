// What each method says of the newest window: for, against, undecided and why, with its picture.
import { number, sentence } from "./format.js";
import { html, useEffect, useRef, useState } from "./html.js";
import { Shape } from "./marks.js";
import { named, plainly } from "./names.js";

const SAYS = { stiction: ["sticks", "For"], no_stiction: ["healthy", "Against"], undecided: ["undecided", "Undecided"], not_applicable: ["not_testable", "Not applicable"] };

export function Methods({ base, methods }) {
  const [seen, look] = useState(null);
  const order = Object.keys(SAYS);
  const rows = Object.entries(methods).sort((a, b) => order.indexOf(a[1].verdict) - order.indexOf(b[1].verdict));
  if (!rows.length) return null;
  const count = (verdict) => rows.filter(([, each]) => each.verdict === verdict).length;
  return html`<details class="methods-all"><summary>${rows.length} methods: ${count("stiction")} for stiction, ${count("no_stiction")} against, ${count("undecided")} undecided, ${count("not_applicable")} not applicable</summary>
    <div class="scroll" tabindex="0" role="group" aria-label="Table"><table class="methods"><caption class="unseen">Methods</caption>
      <thead><tr><th scope="col">Method</th><th scope="col">Says</th><th scope="col" class="number">Index</th><th scope="col" class="why">Why</th><th scope="col"><span class="unseen">Picture</span></th></tr></thead>
      <tbody>${rows.map(([name, each]) => html`<tr><th scope="row">${named(name)}</th><td class="says"><${Shape} group=${SAYS[each.verdict][0]} size=${13} /> ${SAYS[each.verdict][1]}</td>
        <td class="number">${number(each.index)}</td><td class="quiet why">${sentence(plainly(each.reason))}</td><td>${each.verdict !== "not_applicable" && html`<button type="button" class="small" onClick=${() => look(name)}>Picture<span class="unseen"> of ${named(name)}</span></button>`}</td></tr>`)}</tbody></table></div>
    ${seen && html`<${Picture} address=${`${base}/methods/${seen}.svg`} name=${named(seen)} says=${methods[seen]} close=${() => look(null)} />`}</details>`;
}

function Picture({ address, name, says, close }) {
  const dialog = useRef(null);
  const [missing, set] = useState(false);
  useEffect(() => dialog.current.showModal(), []);
  return html`<dialog ref=${dialog} onClose=${close} aria-label=${`What ${name} saw`}><h2>${name}</h2>
    ${says?.reason && html`<p class="quiet">${SAYS[says.verdict][1]}: ${plainly(says.reason)}</p>`}
    ${missing ? html`<p class="quiet">This method left no picture.</p>` : html`<img class="picture" src=${address} alt=${`What ${name} saw in this window`} onError=${() => set(true)} />`}
    <p><button type="button" onClick=${() => dialog.current.close()}>Close</button></p></dialog>`;
}
