// Loops that oscillate together, as of the newest look at the whole plant: each group with its likeliest root and the path from it.
import { get } from "./api.js";
import { number, percent, sentence, when } from "./format.js";
import { html, useEffect, useState } from "./html.js";

const AGAIN = 60000; // ms; the agent looks once an hour

export function PlantGroups() {
  const [found, set] = useState(null);
  useEffect(() => {
    const stop = new AbortController();
    const load = () => get("/api/work-list/groups", stop.signal).then(set, () => {});
    load();
    const timer = setInterval(load, AGAIN);
    return () => {
      stop.abort();
      clearInterval(timer);
    };
  }, []);
  if (!found) return null;
  if (!found.groups.length) return html`<p class="quiet together-none" data-testid="groups">${none(found)}</p>`;
  return html`<details class="card together" data-testid="groups">
    <summary>${headline(found)}<span class="under">${basis(found)}</span></summary>
    <ol>${found.groups.map((group) => html`<${Group} key=${`${group.root} ${group.period_s}`} group=${group} />`)}</ol>
  </details>`;
}

function Group({ group }) {
  const odds = new Map(group.loops.map((each) => [each.loop, each.probability]));
  const next = new Map();
  for (const [from, to] of group.path) next.set(from, [...(next.get(from) ?? []), to]);
  return html`<li data-group-root=${group.root}>
    <p><strong>Period ${number(group.period_s)} s</strong>, ${group.loops.length} loops. Likeliest root <${Loop} name=${group.root} />, ${percent(odds.get(group.root))}: ${group.reasons.join("; ")}.</p>
    <ul class="path" aria-label=${`Path from ${group.root}`}><${Branch} name=${group.root} next=${next} odds=${odds} /></ul>
  </li>`;
}

/** A loop of the path, and below it those that it passes the oscillation on to. */
function Branch({ name, next, odds }) {
  const below = next.get(name) ?? [];
  return html`<li><${Loop} name=${name} /> <span class="odds" title="Probability that the oscillation begins here">${percent(odds.get(name))}</span>
    ${below.length > 0 && html`<ul>${below.map((each) => html`<${Branch} key=${each} name=${each} next=${next} odds=${odds} />`)}</ul>`}</li>`;
}

const Loop = ({ name }) => html`<a href=${`/loops/${encodeURIComponent(name)}`}>${name}</a>`;

function headline({ groups }) {
  const loops = new Set(groups.flatMap((group) => group.loops.map((each) => each.loop))).size;
  return groups.length === 1 ? `${loops} loops oscillate together` : `${loops} loops oscillate together, in ${groups.length} groups`;
}

function none(found) {
  if (found.time === null) return "Loops are compared with each other once an hour; not yet since the start.";
  return `No loops were found to oscillate together. ${sentence(basis(found))}.`;
}

function basis({ compared, left_out: out, time }) {
  return `${compared.length} loops compared at ${when(time)}${out ? `, ${out} not (old values, or beyond the most that are compared)` : ""}`;
}
